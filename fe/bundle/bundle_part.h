/* A part of a bundle: its bodies over some of the stations, with contact, bonds of the tape, and
 * the capped end, and their time integration.
 *
 * A bundle is a row of one or more parts (fe/bundle/bundle_parts.h); the part that owns the last
 * station drives the tip. A part is independent of its neighbours: it also computes a halo of
 * stations that they own, whose positions bundle.c copies.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_PART_H
#define WB_FE_BUNDLE_BUNDLE_PART_H

#include <stdbool.h>

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle_body.h"
#include "fe/bundle/bundle_bond.h"
#include "fe/bundle/bundle_cap.h"
#include "fe/swept/swept_contact.h"

/* Path of the tip: a smooth step from one deflection to another. */
struct wb_bundle_tip_path {
    double from, to;        /* m */
    double start, duration; /* s */
    bool tip_is_free;       /* no force acts on the tip */
};

/* Progress of the time integration. */
struct wb_bundle_clock {
    double time; /* s, sum of all steps since creation except for settling */
    long long steps;
    bool has_moved; /* velocities are half a step behind positions */
};

/* Forces and energies of the last step; works are sums over all steps. */
struct wb_bundle_account {
    double tension, vertical; /* N */
    double pull[3];           /* N, on the tip */
    bool slack;
    double tip_work, friction_work, damage_work; /* J */
    double kinetic;                              /* J */
    struct wb_swept_contact_energies touching;
    struct wb_swept_hex_sums wires;
    struct wb_swept_tape_sums shells;
    struct wb_bundle_bond_energies bonded;
};

struct wb_bundle_part {
    struct wb_bundle_bodies bodies;
    struct wb_swept_contact *contact; /* NULL with one wire */
    struct wb_bundle_bond *bond;      /* NULL without tape */
    struct wb_bundle_cap *cap;        /* NULL: the tip is free, or belongs to another part */
    struct wb_bundle_tip_path tip_path;
    struct wb_bundle_clock clock;
    struct wb_bundle_account account;
    struct wb_reason reason; /* why the last step failed */
};

/* Creates the complete bundle as one part, straight and at rest. Its time step is `safety` times
 * the stable one. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_bundle_part_create_whole(struct wb_bundle_part **out,
                                                         const struct wb_bundle_model *model,
                                                         const struct wb_bundle_mesh *mesh,
                                                         double safety);
/* Creates a part with `n_stations` of the complete bundle from `first` on, which owns the range
 * `own` of these. Its time step is that of the complete bundle. */
WB_MUST_CHECK enum wb_status wb_bundle_part_create(struct wb_bundle_part **out,
                                                   const struct wb_bundle_part *whole, int first,
                                                   int n_stations, struct wb_swept_range own);
void wb_bundle_part_destroy(struct wb_bundle_part *part); /* accepts NULL */

/* Makes one step; with `look` also updates the terms of the energies in the account. WB_ERR_DATA if
 * the run fails: part->reason says why. */
WB_MUST_CHECK enum wb_status wb_bundle_part_step(struct wb_bundle_part *part, bool look);

/* Sets all velocities to zero. */
void wb_bundle_part_stop(struct wb_bundle_part *part);

/* The centre of mass of the tip, m; its height relative to that in the straight bundle. */
void wb_bundle_part_tip(const struct wb_bundle_part *part, double position[3]);

/* Prescribed deflection of the tip at a time, m. */
double wb_bundle_part_target(const struct wb_bundle_part *part, double time);

/* Saves or restores fields and the states of materials and contacts. */
void wb_bundle_part_visit_fields(struct wb_bundle_part *part, struct wb_checkpoint *checkpoint);

#endif
