/* Internal forces of a wire of 8-node hexahedra swept along its axis, for explicit dynamics.
 *
 * Total Lagrangian, logarithmic strain, J2 plasticity with isotropic hardening. Only the plastic
 * strain is integrated in time, so rigid motions cause no stress in any number of steps. There are
 * two formulations:
 *
 * - four points (2x2x1, the default): the axial strain and the two transverse shear strains are
 *   evaluated at 2 x 2 points, each with its own plastic history; the strains within the section
 *   are evaluated at the centre. One hourglass vector remains, that of the section.
 * - one point: mean gradients (Flanagan and Belytschko 1981), four hourglass vectors.
 *
 * The hourglass stiffness is elastic. Plastic bending is accurate with a few elements per section
 * with four points, but needs about 60 with one point. Details are in swept_hex_kernel.c.
 *
 * The logarithm is approximated by a polynomial: forces are wrong by 0.2 % at an axial strain of 5
 * %, by 1.3 % at a shear strain of 5 %, and by 0.04 and 0.5 % at strains of 3 %. Elements with a
 * component of Green's strain beyond WB_SWEPT_HEX_STRAIN_LIMIT are counted; the caller reports
 * their number.
 *
 * Node fields are those of fe/swept/swept.h, stations `element_length` apart in the reference
 * state, forces float or, in double precision, double. Fields must be allocated by
 * wb_swept_allocate(), because entries after the last value are read.
 */
#ifndef WB_FE_SWEPT_SWEPT_HEX_H
#define WB_FE_SWEPT_SWEPT_HEX_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "fe/material/material.h"
#include "fe/swept/swept.h"
#include "fe/swept/swept_section.h"

#define WB_SWEPT_HEX_STRAIN_LIMIT 0.05

enum wb_swept_hex_formulation {
    WB_SWEPT_HEX_FOUR_POINTS,
    WB_SWEPT_HEX_ONE_POINT
};

struct wb_swept_hex_model {
    const struct wb_swept_section *section; /* borrowed; must outlive the hex */
    struct wb_material material;            /* isotropic or no hardening */
    int n_elements;                         /* along the axis */
    double element_length;                  /* m */
    enum wb_swept_hex_formulation formulation;
    struct wb_swept_range counted; /* elements that count in sums and plastic work; forces are
                                      computed for all */
    double hourglass; /* coefficient; 0: the default, 0.05. With one point, 1 gives the bending
                         modes of an element their elastic stiffness */
    bool double_precision;
    enum wb_swept_instructions instructions;
};

struct wb_swept_hex_fields {
    const double *position;
    void *force;        /* float, or double in double precision */
    const double *soon; /* NULL, or a field that the caller reads next, such as velocities: it is
                           prefetched into the cache, block by block */
};

struct wb_swept_hex_sums {
    double stored, artificial; /* J: elastic energy, and that of the hourglass stiffness */
    double largest_strain;     /* largest magnitude of a component of Green's strain */
    long long beyond_limit;    /* number of elements beyond the strain limit, or not finite */
};

struct wb_swept_hex;       /* opaque: model, constants; not changed after creation */
struct wb_swept_hex_state; /* opaque: plastic histories of one wire, workspace */

/* WB_ERR_UNSUPPORTED if the processor does not have the instructions, or the table of the hardening
 * law is less accurate than 1e-5 of the stress (exponents below about 0.15). */
WB_MUST_CHECK enum wb_status wb_swept_hex_create(struct wb_swept_hex **out,
                                                 const struct wb_swept_hex_model *model);
void wb_swept_hex_destroy(struct wb_swept_hex *hex);

const struct wb_swept_hex_model *wb_swept_hex_get_model(const struct wb_swept_hex *hex);
struct wb_swept_layout wb_swept_hex_layout(const struct wb_swept_hex *hex);
int wb_swept_hex_blocks(const struct wb_swept_hex *hex); /* of WB_SWEPT_LANES stations */
/* Stiffnesses of the four hourglass vectors of an element, N/m: that of the section, then the axial
 * ones, xi, eta and xi eta, which are 0 with four points. */
void wb_swept_hex_hourglass(const struct wb_swept_hex *hex, int quad, double stiffness[4]);

/* Creates the state of one wire without plastic strain. The hex must outlive the state. */
struct wb_swept_hex_state *wb_swept_hex_state_create(const struct wb_swept_hex *hex);
void wb_swept_hex_state_destroy(struct wb_swept_hex_state *state);

/* State for a checkpoint: `bytes` at the returned address. */
void *wb_swept_hex_state_data(struct wb_swept_hex_state *state, size_t *bytes);

/* A component of the plastic history at a point (0 to 3, or 0) of a section's element: plastic
 * strain 11, 22, 12, 13, 23, accumulated plastic strain. */
enum {
    WB_SWEPT_HEX_ACCUMULATED = 5
};
double wb_swept_hex_history(const struct wb_swept_hex_state *state, int quad, int element,
                            int point, int component);

/* Computes the forces on the nodes (negative derivatives of the energy) at the stations of blocks
 * `first` to `end` - 1, and updates the plastic histories there to the current positions. Forces on
 * the section's nodes before wb_swept_hex_first_added() are overwritten. The nodes from there on
 * include the whole outline and may have contact forces, to which the forces are added. The blocks
 * of a step must be computed in order, each once, in one call or several: after its call the forces
 * of a block are complete, and its positions are not read again. `sums` (NULL: none) is increased
 * by the sums of these blocks. Threads may work on different states. */
int wb_swept_hex_first_added(const struct wb_swept_hex *hex);
void wb_swept_hex_add_forces(struct wb_swept_hex_state *state,
                             const struct wb_swept_hex_fields *fields, int first, int end,
                             struct wb_swept_hex_sums *sums);

/* Plastic work so far, including hardening, J. Takes as long as ten steps. */
double wb_swept_hex_plastic_work(const struct wb_swept_hex_state *state);

/* Scales the mesh of a circular section so that its second moment of area is pi d^4 / 64. With 4,
 * 12 and 84 elements its area is then 1.2, 0.5 and 0.1 % smaller than pi d^2 / 4 with four points,
 * and 17, 4.8 and 0.6 % larger with one point. The caller must correct the masses for this. */
void wb_swept_hex_fit_circle(struct wb_swept_section *section, double diameter,
                             enum wb_swept_hex_formulation formulation,
                             const struct wb_material *material);

#endif
