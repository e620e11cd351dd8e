/* Internal forces of a tape round a bundle: 4-node shells between a ring of nodes and the stations,
 * for explicit dynamics.
 *
 * The ring lies on the tape's middle surface and is repeated at all stations, straight (a sleeve)
 * or winding (a helix); it is closed, or open with two free edges. Besides its position a node has
 * a director, a vector across the tape whose length a stiff spring keeps at 1. Both are node fields
 * and are integrated alike, directors with the inertia of wb_swept_tape_masses().
 *
 * Membrane and bending are taken at one point in the plane, with several points of plane stress
 * through the thickness (J2 with isotropic hardening, logarithmic strains); transverse shear is
 * taken from the edges and is elastic. So is the hourglass stiffness, against bending of an element
 * in its plane and against what its directors do likewise. Total Lagrangian: only the plastic
 * strain is integrated in time. Stresses are those of Kirchhoff, per reference area: as plastic
 * flow keeps the volume, they include that a stretched tape gets thinner. Details are in
 * swept_tape_kernel.c.
 *
 * The logarithm is a polynomial: at a strain of 10 % it is 0.03 % off, forces 0.2 %. Elements with
 * a larger strain are counted; the caller reports their number.
 *
 * Node fields are those of fe/swept/swept.h, forces float or, of a model of double precision,
 * double. Fields must come from wb_swept_allocate(): what lies behind the last number is read.
 */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_H
#define WB_FE_SWEPT_SWEPT_TAPE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "fe/material/material.h"
#include "fe/swept/swept.h"

#define WB_SWEPT_TAPE_STRAIN_LIMIT 0.1

struct wb_swept_tape_model {
    struct wb_material material; /* one whose yield surface does not move */
    double density;              /* kg/m3 */
    double thickness;            /* m, of all layers */
    int sheets; /* into which it is split in bending, that slide on each other freely; 0: 1, layers
                   that stick together. The membrane does not know of it */
    int points; /* through the thickness, of Gauss, 2 to 5; 0: 3 */
    double hourglass; /* coefficient, 1; 0: 0.1. 1 gives an element that is bent in its plane its
                         elastic stiffness */
    struct wb_swept_layout layout;
    const double *position; /* of the reference state; read at creation only. From node to node of
                               the ring so that axis x ring points outwards */
    double spacing;         /* of the stations along the axis, m: what masses per length refer to */
    struct wb_swept_range counted; /* in sums and the plastic work, also of what is made for this
                                      tape (cohesion, contact); all is computed */
    bool closed;                   /* the last node of the ring is joined to the first */
    bool double_precision;
    enum wb_swept_instructions instructions;
};

struct wb_swept_tape_sums {
    double stored, artificial; /* J: elastic and of the hourglass stiffness */
    double largest_strain;     /* at least the largest principal strain (Green's) in size */
    long long beyond_limit;    /* elements with one beyond the limit, or not finite */
};

struct wb_swept_tape;       /* opaque: constants; not changed after creation */
struct wb_swept_tape_state; /* opaque: plastic histories, workspace */

/* WB_ERR_UNSUPPORTED when the processor does not have the instructions, or for laws that
 * fe/material/hardening.h cannot tabulate; WB_ERR_ARGUMENT also for elements that are not convex.
 */
WB_MUST_CHECK enum wb_status wb_swept_tape_create(struct wb_swept_tape **out,
                                                  const struct wb_swept_tape_model *model);
void wb_swept_tape_destroy(struct wb_swept_tape *tape);

/* As given, with a copy of the positions, and with defaults and instructions filled in. */
const struct wb_swept_tape_model *wb_swept_tape_get_model(const struct wb_swept_tape *tape);
int wb_swept_tape_blocks(const struct wb_swept_tape *tape);   /* of WB_SWEPT_LANES stations */
int wb_swept_tape_elements(const struct wb_swept_tape *tape); /* round the ring */

/* Directors of the reference state (a field): the mean of the adjoining elements' normals, in the
 * plane of the section. */
const double *wb_swept_tape_directors(const struct wb_swept_tape *tape);

/* Area of the middle surface that goes with a node, m2. */
double wb_swept_tape_area(const struct wb_swept_tape *tape, int node, int station);

/* Masses and rotary inertias of directors per length, one of each a node of the ring (n_nodes),
 * kg/m and kg m: means over the stations. The rotary inertia is the tape's own and an eighth of an
 * element's area times its mass, so that directors do not govern the step (T. Belytschko, J. I.
 * Lin, C.-S. Tsay, CMAME 42 (1984) 225). */
void wb_swept_tape_masses(const struct wb_swept_tape *tape, double *mass, double *inertia);

/* An upper bound of the squared frequencies with these masses and without selective mass scaling,
 * 1/s2, in the reference state: that of the fastest element alone. Cohesion and contact add to it
 * (fe/swept/swept_cohesion.h). Mass scaling divides it by f_m. */
WB_MUST_CHECK enum wb_status wb_swept_tape_stiffness_per_mass(const struct wb_swept_tape *tape,
                                                              double *largest);

/* Histories of one tape, virgin. The tape must outlive it. */
struct wb_swept_tape_state *wb_swept_tape_state_create(const struct wb_swept_tape *tape);
void wb_swept_tape_state_destroy(struct wb_swept_tape_state *state);

/* What a checkpoint keeps of a state: `bytes` at the address returned. */
void *wb_swept_tape_state_data(struct wb_swept_tape_state *state, size_t *bytes);

struct wb_swept_tape_fields {
    const double *position, *director;
    void *force;  /* N, written: float, or double of double precision */
    void *moment; /* on the directors, N m, the same */
};

/* Writes forces and moments (less the energy's derivatives) at the stations of blocks `first` to
 * `end` - 1 and takes the histories there to the present state. The blocks of a step go in order,
 * each once, in one call or several: forces of a block are complete when it is done, and its
 * positions are not read again. `sums`, when not NULL, are added to. Threads may work on different
 * states. */
void wb_swept_tape_forces(struct wb_swept_tape_state *state,
                          const struct wb_swept_tape_fields *fields, int first, int end,
                          struct wb_swept_tape_sums *sums);

/* Plastic work so far, hardening included, J. Takes about as long as ten steps. */
double wb_swept_tape_plastic_work(const struct wb_swept_tape_state *state);

/* --- stresses ---
 *
 * Asked one element at a time: the kernels' law once more, slowly and in double, from positions,
 * directors and the plastic strains kept. Positions must be those of the last forces, or of the
 * step after them; then the plastic strains go with them but for a step's strain (some 1e-7). */

enum {
    WB_SWEPT_TAPE_STRESS_MOST = 5 /* points through the thickness */
};

struct wb_swept_tape_stress {
    double stress[3]; /* Pa, per reference area (of Kirchhoff): 11, 22, 12 in the element's frame,
                         1 along the tape's stations; without the transverse shear */
    double plastic;   /* accumulated plastic strain */
};

/* Points through the thickness. */
int wb_swept_tape_stress_points(const struct wb_swept_tape *tape);

/* Of the element between nodes `element` and the next of the ring, stations `along` and the next:
 * its points from the inside. `state` is not changed. */
void wb_swept_tape_stress_find(const struct wb_swept_tape *tape, struct wb_swept_tape_state *state,
                               const double *position, const double *director, int element,
                               int along,
                               struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST]);

/* Von Mises stress of plane stress, Pa. */
double wb_swept_tape_stress_von_mises(const double stress[3]);

#endif
