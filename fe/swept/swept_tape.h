/* Internal forces of a tape around a bundle: 4-node shells between a ring of nodes and the
 * stations, for explicit dynamics.
 *
 * The ring lies on the tape's middle surface and is repeated at all stations, straight (a sleeve)
 * or winding (a helix); it is closed, or open with two free edges. Besides its position a node has
 * a director, a vector through the tape's thickness whose length a stiff spring keeps at 1. Both
 * are node fields and are integrated in the same way, directors with the inertia of
 * wb_swept_tape_masses().
 *
 * Membrane and bending are taken at one point in the plane, with several points of plane stress
 * through the thickness (J2 with isotropic hardening, logarithmic strains); transverse shear is
 * taken from the edges and is elastic. The hourglass stiffness against bending of an element in its
 * plane, and the corresponding motion of its directors, is also elastic. Total Lagrangian: only the
 * plastic strain is integrated in time. Stresses are Kirchhoff stresses, per reference area:
 * because plastic flow is isochoric, they include the thinning of a stretched tape. Details are in
 * swept_tape_kernel.c.
 *
 * The logarithm is approximated by a polynomial: at a strain of 10 % its error is 0.03 %, that of
 * forces 0.2 %. Elements with a larger strain are counted; the caller reports their number.
 *
 * Node fields are those of fe/swept/swept.h, forces float or, in double precision, double. Fields
 * must be allocated by wb_swept_allocate(), because entries after the last value are read.
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
    struct wb_material material; /* with isotropic hardening or none */
    double density;              /* kg/m3 */
    double thickness;            /* m, of all layers */
    int sheets; /* number of sheets that slide on each other freely in bending; 0: 1, layers bonded
                   together. Does not affect the membrane */
    int points; /* Gauss points through the thickness, 2 to 5; 0: 3 */
    double hourglass; /* coefficient; 0: 0.1. 1 gives an element bent in its plane its elastic
                         stiffness */
    struct wb_swept_layout layout;
    const double *position; /* of the reference state; read only during creation. The nodes of the
                               ring are ordered so that axis x ring points outwards */
    double spacing; /* of the stations along the axis, m: reference length of masses per length */
    struct wb_swept_range counted; /* in sums and the plastic work, also of this tape's cohesion and
                                      contact; all stations are computed */
    bool closed;                   /* the last node of the ring is connected to the first */
    bool double_precision;
    enum wb_swept_instructions instructions;
};

struct wb_swept_tape_sums {
    double stored, artificial; /* J: elastic, and of the hourglass stiffness */
    double largest_strain;  /* upper bound of the largest principal strain (Green's) in magnitude */
    long long beyond_limit; /* number of elements beyond the strain limit, or not finite */
};

struct wb_swept_tape;       /* opaque: constants; not changed after creation */
struct wb_swept_tape_state; /* opaque: plastic histories, workspace */

/* WB_ERR_UNSUPPORTED if the processor does not have the instructions, or for laws that
 * fe/material/hardening.h cannot tabulate; WB_ERR_ARGUMENT also for elements that are not
 * convex. */
WB_MUST_CHECK enum wb_status wb_swept_tape_create(struct wb_swept_tape **out,
                                                  const struct wb_swept_tape_model *model);
void wb_swept_tape_destroy(struct wb_swept_tape *tape);

/* The model, with a copy of the positions, and with defaults and instructions filled in. */
const struct wb_swept_tape_model *wb_swept_tape_get_model(const struct wb_swept_tape *tape);
int wb_swept_tape_blocks(const struct wb_swept_tape *tape);   /* of WB_SWEPT_LANES stations */
int wb_swept_tape_elements(const struct wb_swept_tape *tape); /* around the ring */

/* Directors of the reference state (a field): the mean of the adjoining elements' normals, in the
 * plane of the section. */
const double *wb_swept_tape_directors(const struct wb_swept_tape *tape);

/* Tributary area of a node on the middle surface, m2. */
double wb_swept_tape_area(const struct wb_swept_tape *tape, int node, int station);

/* Masses and rotary inertias of directors per length, one of each per node of the ring (n_nodes),
 * kg/m and kg m: means over the stations. The rotary inertia is the tape's own plus an eighth of an
 * element's area times its mass, so that directors do not determine the stable step (T. Belytschko,
 * J. I. Lin, C.-S. Tsay, CMAME 42 (1984) 225). */
void wb_swept_tape_masses(const struct wb_swept_tape *tape, double *mass, double *inertia);

/* An upper bound of the squared frequencies with these masses and without selective mass scaling,
 * 1/s2, in the reference state: that of the element with the largest frequency. Cohesion and
 * contact add to it (fe/swept/swept_cohesion.h). Mass scaling divides it by f_m. */
WB_MUST_CHECK enum wb_status wb_swept_tape_stiffness_per_mass(const struct wb_swept_tape *tape,
                                                              double *largest);

/* Virgin histories of one tape. The tape must outlive the state. */
struct wb_swept_tape_state *wb_swept_tape_state_create(const struct wb_swept_tape *tape);
void wb_swept_tape_state_destroy(struct wb_swept_tape_state *state);

/* State for a checkpoint: `bytes` at the returned address. */
void *wb_swept_tape_state_data(struct wb_swept_tape_state *state, size_t *bytes);

struct wb_swept_tape_fields {
    const double *position, *director;
    void *force;  /* N, overwritten: float, or double in double precision */
    void *moment; /* on the directors, N m, the same type */
};

/* Writes forces and moments (negative derivatives of the energy) at the stations of blocks `first`
 * to `end` - 1 and updates the histories there to the current state. The blocks of a step are
 * computed in order, each once, in one call or several: the forces of a block are complete after
 * its call, and its positions are not read again. `sums`, if not NULL, are added to. Threads may
 * work on different states. */
void wb_swept_tape_forces(struct wb_swept_tape_state *state,
                          const struct wb_swept_tape_fields *fields, int first, int end,
                          struct wb_swept_tape_sums *sums);

/* Plastic work so far, hardening included, J. Costs as much as ten steps. */
double wb_swept_tape_plastic_work(const struct wb_swept_tape_state *state);

/* --- stresses ---
 *
 * One element at a time: the kernels' law, implemented simply and in double, from positions,
 * directors and stored plastic strains. Positions must be those of the last force computation, or
 * of the step after it; the plastic strains then lag by at most one step's strain (about 1e-7). */

enum {
    WB_SWEPT_TAPE_STRESS_MOST = 5 /* points through the thickness */
};

struct wb_swept_tape_stress {
    double stress[3]; /* Kirchhoff stress, Pa, per reference area: 11, 22, 12 in the element's
                         frame, 1 along the tape's stations; without transverse shear */
    double plastic;   /* accumulated plastic strain */
};

/* Number of points through the thickness. */
int wb_swept_tape_stress_points(const struct wb_swept_tape *tape);

/* Stresses of the element between nodes `element` and the next of the ring, stations `along` and
 * the next, at its points from the inside. */
void wb_swept_tape_stress_find(const struct wb_swept_tape *tape,
                               const struct wb_swept_tape_state *state, const double *position,
                               const double *director, int element, int along,
                               struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST]);

/* Von Mises stress of plane stress, Pa. */
double wb_swept_tape_stress_von_mises(const double stress[3]);

#endif
