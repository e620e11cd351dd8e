/* Shared by bundle.c (the run), bundle_create.c, bundle_bond.c, bundle_cap.c, bundle_tape.c and
 * test_bundle_cap.c; nobody else. */
#ifndef WB_FE_BUNDLE_BUNDLE_PRIVATE_H
#define WB_FE_BUNDLE_BUNDLE_PRIVATE_H

#include "base/checkpoint.h"
#include "fe/bundle/bundle.h"
#include "fe/bundle/bundle_bond.h"
#include "fe/bundle/bundle_cap.h"
#include "fe/bundle/bundle_parts.h"
#include "fe/swept/swept_contact.h"
#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_step.h"
#include "fe/swept/swept_tape.h"

enum {
    WB_BUNDLE_MOST_PARTS = 1024
};

/* One body: its fields and how they are stepped. */
struct wb_bundle_body {
    struct wb_swept_layout layout;
    double *position, *velocity;
    void *force; /* float, or double of a run in double precision */
    bool is_double;
    const struct wb_swept_step *step; /* owned elsewhere */
    const double *node_mass;          /* (n_nodes) kg/m, unscaled; owned elsewhere */
    double mass;                      /* kg/m, unscaled */
    double start;                     /* m: mean height of the section, unscaled masses */
};

/* What the wires of one type share. */
struct wb_bundle_type {
    struct wb_swept_section section;
    struct wb_swept_hex *hex;
    struct wb_swept_step *step;
    double *node_mass; /* (n_nodes) kg/m */
};

struct wb_bundle {
    const struct wb_bundle_model *model; /* borrowed */
    const struct wb_bundle_mesh *mesh;
    struct wb_bundle_settings settings;
    int n_stations;
    double spacing;

    /* Of a part of another bundle (fe/bundle/bundle_parts.h); of a whole one, all. */
    const struct wb_bundle *whole; /* NULL: it is one */
    int first, n_whole;            /* station of the whole that is this one's first; all of them */
    struct wb_swept_range own;     /* stations that it counts and leads; others are only computed */
    struct wb_bundle_parts *parts; /* that it is computed in; NULL: none */

    struct wb_bundle_type type[WB_BUNDLE_MODEL_TYPES];
    int n_wires;
    struct wb_bundle_body wire[WB_PACKING_MOST];
    struct wb_swept_hex_state *history[WB_PACKING_MOST];
    struct wb_swept_contact *contact; /* NULL with one wire */
    const double *positions[WB_PACKING_MOST];
    void *forces[WB_PACKING_MOST];
    bool is_large; /* its fields do not stay in a core's cache from step to step */

    bool has_tape;
    struct wb_swept_tape *tape;
    struct wb_swept_tape_state *tape_history;
    struct wb_swept_step *tape_step, *director_step;
    double *tape_mass, *tape_inertia; /* (ring nodes) */
    struct wb_bundle_body ring, directors;
    struct wb_bundle_bond *bond; /* between tape and wires */

    struct wb_bundle_cap *cap; /* NULL: the tip is free */

    double time_step;
    double gravity; /* m/s2, downwards */

    /* The way of the tip: a smooth step from `from` to `to`. */
    double from, to, way_start, way_duration;
    bool let_go; /* of the tip: no force acts there */
    double time; /* s, of all steps since creation but settling */
    long long steps;
    bool has_moved; /* velocities are half a step behind positions */

    /* Of the last step. */
    double tension, vertical;
    double pull[3]; /* N, on the tip */
    bool slack;
    double tip_work, friction_work;
    double kinetic;
    struct wb_swept_contact_energies touching;
    struct wb_swept_hex_sums wires;
    struct wb_swept_tape_sums shells;
    struct wb_bundle_bond_energies bonded;
    double damage_work;
    double weight_zero; /* J: potential of the weight at the start */
};

/* Kilograms of a body's station, scaled, half at the ends. */
double wb_bundle_station_mass(const struct wb_bundle *bundle, const struct wb_bundle_body *body,
                              int station);

/* Zeroed fields of a body; its steps. */
WB_MUST_CHECK enum wb_status wb_bundle_create_fields(const struct wb_bundle *bundle,
                                                     struct wb_bundle_body *body,
                                                     struct wb_swept_layout layout);
WB_MUST_CHECK enum wb_status wb_bundle_create_step(const struct wb_bundle *bundle,
                                                   struct wb_swept_layout layout,
                                                   const double *node_mass, double gravity,
                                                   struct wb_swept_step **out);

/* A place of the force field, N; bytes of one. */
double wb_bundle_force_at(const struct wb_bundle_body *body, size_t at);
void wb_bundle_add_force(struct wb_bundle_body *body, size_t at, double force);
size_t wb_bundle_force_size(const struct wb_bundle_body *body);

/* The last station that the clamp holds, of the whole. */
int wb_bundle_last_held(const struct wb_bundle *bundle);

/* One step; `look` keeps what energies need. */
WB_MUST_CHECK enum wb_status wb_bundle_step(struct wb_bundle *bundle, bool look);
/* All that moves stands still. */
void wb_bundle_stop(struct wb_bundle *bundle);
/* The weight's potential and the plastic work, J, of its own stations. */
double wb_bundle_potential(const struct wb_bundle *bundle);
double wb_bundle_plastic_work(const struct wb_bundle *bundle);

/* A part of a whole from its station `first` on. */
WB_MUST_CHECK enum wb_status wb_bundle_create_part(struct wb_bundle **out,
                                                   const struct wb_bundle *whole, int first,
                                                   int n_stations, struct wb_swept_range own);

/* Fields, histories and contacts, without the scalars, to a checkpoint or back. */
void wb_bundle_visit_fields(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint);

#endif
