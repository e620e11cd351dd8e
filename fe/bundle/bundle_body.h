/* The bodies of a bundle, or of a part of it along its axis: wires, and the tape's ring with its
 * directors, as swept meshes with their fields and steps.
 *
 * Contact, bonds and the capped end are separate objects that act on bodies. Bodies are independent
 * of each other and of parts (fe/bundle/bundle_part.h).
 */
#ifndef WB_FE_BUNDLE_BUNDLE_BODY_H
#define WB_FE_BUNDLE_BUNDLE_BODY_H

#include <stdbool.h>
#include <stddef.h>

#include "base/checkpoint.h"
#include "base/memory.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"
#include "fe/swept/swept.h"
#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_kernel.h"
#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape.h"

enum {
    WB_BUNDLE_MOST_BODIES = WB_PACKING_MOST + 2 /* wires, the tape's ring and its directors */
};

/* --- one body --- */

struct wb_bundle_body {
    struct wb_swept_layout layout;
    double *position, *velocity;
    void *force; /* float; double in a run with double precision */
    bool is_double;
    struct wb_swept_step *step;
    const double *node_mass; /* (n_nodes) kg/m, of directors kg m; unscaled */
    double mass;             /* kg/m, unscaled; 0 for directors */
    double start;            /* m: mean height of the section, by unscaled masses */
};

/* The force at an index of the field, N. */
double wb_bundle_body_force(const struct wb_bundle_body *body, size_t at);
void wb_bundle_body_add_force(struct wb_bundle_body *body, size_t at, double force);

/* --- all bodies --- */

/* Data shared by the wires of one type. */
struct wb_bundle_type {
    struct wb_swept_section section;
    struct wb_swept_hex *hex;
    struct wb_swept_step *step;
    double *node_mass; /* (n_nodes) kg/m, owned by the bodies */
};

/* The stations that the bodies have, out of those of the complete bundle. */
struct wb_bundle_extent {
    /* First station, in numbers of the complete bundle; number of stations. */
    int first, n_stations;
    int n_whole;               /* number of stations of the complete bundle */
    struct wb_swept_range own; /* stations of these that are counted and moved. The others belong to
                                  neighbours and are only computed */
};

struct wb_bundle_bodies {
    const struct wb_bundle_model *model; /* borrowed */
    const struct wb_bundle_mesh *mesh;
    struct wb_bundle_extent extent;
    double spacing;   /* m, of stations */
    double gravity;   /* m/s2, downwards */
    double time_step; /* s */

    struct wb_bundle_type type[WB_BUNDLE_MODEL_TYPES];
    int n_wires;
    struct wb_bundle_body wire[WB_PACKING_MOST];
    struct wb_swept_hex_state *wire_state[WB_PACKING_MOST]; /* of their material */
    const double *positions[WB_PACKING_MOST]; /* the wires' positions, one pointer each */
    void *forces[WB_PACKING_MOST];
    bool is_large; /* the fields do not fit into a core's cache */

    bool has_tape;
    struct wb_swept_tape *tape;
    struct wb_swept_tape_state *tape_state; /* of its material */
    struct wb_bundle_body ring, directors;
    struct wb_memory memory; /* of all fields and masses */
};

/* Creates the wires, straight and at rest; wb_bundle_tape_create() adds the tape. Release the
 * bodies also after a failure. */
WB_MUST_CHECK enum wb_status wb_bundle_bodies_init(struct wb_bundle_bodies *bodies,
                                                   const struct wb_bundle_model *model,
                                                   const struct wb_bundle_mesh *mesh,
                                                   const struct wb_bundle_extent *extent);
/* Frees wires and tape; accepts zeroed bodies. */
void wb_bundle_bodies_release(struct wb_bundle_bodies *bodies);

/* Creates zeroed fields for another body, owned by the bodies; creates the integrator of a body,
 * which the caller destroys. */
void wb_bundle_bodies_create_fields(struct wb_bundle_bodies *bodies, struct wb_bundle_body *body,
                                    struct wb_swept_layout layout);
WB_MUST_CHECK enum wb_status wb_bundle_bodies_create_step(const struct wb_bundle_bodies *bodies,
                                                          struct wb_swept_layout layout,
                                                          const double *node_mass, double gravity,
                                                          struct wb_swept_step **out);

/* Describes the wires for contact and cohesion; arrays are borrowed. */
void wb_bundle_bodies_describe(const struct wb_bundle_bodies *bodies,
                               struct wb_swept_wire wires[WB_PACKING_MOST]);

/* Fixes all nodes of a station. */
void wb_bundle_bodies_hold(const struct wb_bundle_bodies *bodies, int station);

/* Lists wires, ring and directors; returns their number. */
int wb_bundle_bodies_list(struct wb_bundle_bodies *bodies,
                          struct wb_bundle_body *body[WB_BUNDLE_MOST_BODIES]);

/* The last station of the complete bundle that the clamp fixes. */
int wb_bundle_bodies_last_held(const struct wb_bundle_bodies *bodies);

/* True if the tip is one of their own stations. */
bool wb_bundle_bodies_have_tip(const struct wb_bundle_bodies *bodies);

/* Mass of a body at a station, kg, scaled; half at the ends of the bundle. */
double wb_bundle_bodies_station_mass(const struct wb_bundle_bodies *bodies,
                                     const struct wb_bundle_body *body, int station);

/* Sets all velocities to zero. */
void wb_bundle_bodies_stop(struct wb_bundle_bodies *bodies);

/* The weight's potential and the plastic work, J, of their own stations. */
double wb_bundle_bodies_potential(const struct wb_bundle_bodies *bodies);
double wb_bundle_bodies_plastic_work(const struct wb_bundle_bodies *bodies);

/* Saves or restores fields and material states. */
void wb_bundle_bodies_visit(struct wb_bundle_bodies *bodies, struct wb_checkpoint *checkpoint);

#endif
