/* A taped bundle of wires, clamped at one end and bent at the other, in explicit dynamics: section
 * 5 of the paper.
 *
 * Wires are meshes of hexahedra swept along the axis (fe/swept/swept_hex.h); the tape is a sleeve
 * or a helix of shells (fe/swept/swept_tape.h). Wires contact each other with friction
 * (fe/swept/swept_contact.h). A cohesive interface bonds the tape to the wires
 * (fe/swept/swept_cohesion.h); where there is no bond, or it is broken, tape and wires have contact
 * with friction (fe/swept/swept_tape_contact.h). Time is integrated by central differences
 * (fe/swept/swept_step.h); masses are scaled by f_m, the weight is not.
 *
 * The clamp fixes all stations within its length. A vertical force, or a strand that only pulls,
 * moves the mean height of the tip along a smooth step from one deflection to the next. The tip is
 * free, or capped: then it is one rigid body (fe/bundle/bundle_cap.h), loaded at its centre of
 * mass.
 *
 * The bundle may be cut along its axis into parts, which threads and the ranks of an MPI run
 * compute in parallel (fe/bundle/bundle_parts.h). With several ranks every rank calls each function
 * that takes a bundle, and gets the same results. The number of parts changes results by round-off
 * only.
 *
 * Use: create a bundle, settle it (the weight is applied while the tip is held at zero), then move
 * the tip and advance step by step. The caller's loop chooses durations and records results.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_H
#define WB_FE_BUNDLE_BUNDLE_H

#include <stdbool.h>

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

struct wb_bundle_settings {
    const char *mesh;   /* name; NULL: the model's own */
    double duration;    /* s, for the path from zero to the full deflection; > 0 */
    double step_safety; /* time step over the stable time step; 0: 0.9 */
    int threads;        /* per rank; 0: 1. Fewer are started if parts would be too short */
};

/* Energies since the bundle was straight and free of stress, J. */
struct wb_bundle_energies {
    double kinetic; /* of the scaled masses */
    double stored;  /* elastic, of wires and tape */
    double plastic;
    double artificial; /* of the hourglass stiffness */
    double contact;    /* stored in contact, normal and tangential */
    double friction;   /* dissipated */
    double cohesive;   /* stored in the interface, and dissipated by its damage */
    double external;   /* work of the tip's force, of the weight, and of stopping a slack tip */
};
/* The internal energy: stored + plastic + contact + cohesive. */
double wb_bundle_internal(const struct wb_bundle_energies *energies);
/* The external work minus all other energies: zero except for the integration error. */
double wb_bundle_imbalance(const struct wb_bundle_energies *energies);

/* The bundle at the current time. */
struct wb_bundle_state {
    double time;       /* s, since the end of settling */
    long long steps;   /* in all */
    double deflection; /* m: mean height of the tip, weighted by mass */
    double target;     /* m: prescribed deflection; a tip with a slack strand is elsewhere */
    double tip[3];     /* m: mean position of the tip */
    double tension;    /* N: strand tension, or the vertical force, in the last step */
    double vertical;   /* N: its vertical component */
    bool slack;
};

struct wb_bundle; /* opaque */
struct wb_bundle_part;

/* Creates a straight bundle at rest. `model` is borrowed and must outlive it. On failure *out is
 * NULL. */
WB_MUST_CHECK enum wb_status wb_bundle_create(struct wb_bundle **out,
                                              const struct wb_bundle_model *model,
                                              const struct wb_bundle_settings *settings);
void wb_bundle_destroy(struct wb_bundle *bundle); /* accepts NULL */

/* Number of parts that compute the bundle, in all ranks. */
int wb_bundle_parts(const struct wb_bundle *bundle);

/* The complete bundle as one part, with fields and material states at all stations. Collects them
 * from all parts if there was a step since the last call. */
const struct wb_bundle_part *wb_bundle_whole(const struct wb_bundle *bundle);

/* Saves the state, or restores that of a bundle with the same model, settings and number of parts,
 * which then continues bit for bit. */
void wb_bundle_visit(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint);

double wb_bundle_time_step(const struct wb_bundle *bundle); /* s */
long wb_bundle_hexahedra(const struct wb_bundle *bundle);
int wb_bundle_shells(const struct wb_bundle *bundle);

/* Called repeatedly while a bundle is damped to rest. False stops before rest is reached. */
struct wb_bundle_watch {
    bool (*should_continue)(void *context);
    void *context;
};

/* Applies the weight while the tip is held at zero, and damps the bundle to rest: velocities are
 * set to zero whenever the kinetic energy begins to decrease, until it is small. Does nothing to a
 * bundle without weight. WB_ERR_CONVERGENCE if it does not come to rest; WB_ERR_DATA as from
 * wb_bundle_advance(). On failure `reason` receives the reason; if it is NULL, the reason is
 * logged. `watch` may be NULL. */
WB_MUST_CHECK enum wb_status wb_bundle_settle(struct wb_bundle *bundle,
                                              const struct wb_bundle_watch *watch,
                                              struct wb_reason *reason);

/* Releases the tip, as a slack strand does, and damps the bundle to rest under the weight alone as
 * wb_bundle_settle() does; the energy removed counts as external work. The tip's target is then its
 * position at rest. Fails as wb_bundle_settle() does. */
WB_MUST_CHECK enum wb_status wb_bundle_release_tip(struct wb_bundle *bundle,
                                                   const struct wb_bundle_watch *watch,
                                                   struct wb_reason *reason);

/* Moves the tip along a smooth step from its current target to `deflection` (m), within `duration`
 * (s), in the following steps. */
void wb_bundle_move_tip(struct wb_bundle *bundle, double deflection, double duration);

/* Makes `n` steps. WB_ERR_DATA if the run fails (a value is not finite, or wires penetrate each
 * other completely): `reason` receives the reason; if it is NULL, the reason is logged. */
WB_MUST_CHECK enum wb_status wb_bundle_advance(struct wb_bundle *bundle, int n,
                                               struct wb_reason *reason);

void wb_bundle_get_state(const struct wb_bundle *bundle, struct wb_bundle_state *state);

/* All energies after the last step; costs as much as about ten steps. */
void wb_bundle_get_energies(const struct wb_bundle *bundle, struct wb_bundle_energies *energies);

/* The bundle's axis at n arc lengths s (m): the centre of mass of all wires' sections. */
void wb_bundle_shape(const struct wb_bundle *bundle, int n, const double *s, double (*shape)[3]);

/* How close the bundle is to the limits of its model, in the last step of an advance. */
struct wb_bundle_limits {
    /* Number of elements with strains beyond the range of the kernels' logarithm. */
    long long beyond;
    double largest_strain; /* of any element */
    double deepest;        /* m: penetration of wires into each other */
    double tape_deepest;   /* m: penetration of the tape into wires, where it is not bonded */
    double debonded;       /* fraction of the bonded area whose bond is broken */
};
void wb_bundle_get_limits(const struct wb_bundle *bundle, struct wb_bundle_limits *limits);

#endif
