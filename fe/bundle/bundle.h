/* A taped bundle bent as a cantilever, in explicit dynamics: section 5 of the paper.
 *
 * Wires are swept hexahedra (fe/swept/swept_hex.h), the tape a sleeve of shells
 * (fe/swept/swept_tape.h), with contact and friction between wires (fe/swept/swept_contact.h),
 * cohesion between tape and wires (fe/swept/swept_cohesion.h), and contact and friction between
 * them where they are not bonded, or no longer (fe/swept/swept_tape_contact.h). Central differences
 * (fe/swept/swept_step.h), masses scaled by f_m, the weight not. The clamp holds all that is at its
 * end; the mean height of the other end is led along a smooth step by one vertical force, or by a
 * strand that only pulls; it is free, or capped: one rigid body (fe/bundle/bundle_cap.h), pulled at
 * its centre of mass.
 *
 * It may be computed in parts along its axis, by threads and by the ranks of an MPI run
 * (fe/bundle/bundle_parts.h). With several ranks all call the functions that take a bundle alike,
 * and get the same; results do not depend on the number of parts but for round-off.
 *
 * Use: create, settle (the weight comes on, at zero deflection), then advance step by step; the
 * caller owns the loop, rows and the choice of the duration.
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
    double duration;    /* s, of a way from zero to the deflection; > 0 */
    double step_safety; /* of the stable step's bound; 0: 0.9 */
    int threads;        /* of each rank; 0: 1. More than there is room for are not started */
};

/* J, since the virgin bundle. */
struct wb_bundle_energies {
    double kinetic; /* of the scaled masses */
    double stored;  /* elastic, of wires and tape */
    double plastic;
    double artificial; /* of the hourglass stiffness */
    double contact;    /* stored in contact, normal and tangential */
    double friction;   /* dissipated */
    double cohesive;   /* stored in the interface, and dissipated by its damage */
    double external;   /* work of the tip's force, of the weight, of what stops a slack tip */
};
/* stored + plastic + contact + cohesive. */
double wb_bundle_internal(const struct wb_bundle_energies *energies);
/* external less all the others: zero but for the integration's error. */
double wb_bundle_imbalance(const struct wb_bundle_energies *energies);

/* The bundle at the present time. */
struct wb_bundle_state {
    double time;       /* s, since the end of settling */
    long long steps;   /* in all */
    double deflection; /* m: mean height of the tip, over masses */
    double target;     /* m: where it is led to; a slack strand leaves the tip above it */
    double tip[3];     /* m: mean position of the tip */
    double tension;    /* N, of the strand, or the vertical force, in the last step */
    double vertical;   /* N, its vertical part */
    bool slack;
};

struct wb_bundle; /* opaque */
struct wb_bundle_part;

/* `model` is borrowed and must outlive it. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_bundle_create(struct wb_bundle **out,
                                              const struct wb_bundle_model *model,
                                              const struct wb_bundle_settings *settings);
void wb_bundle_destroy(struct wb_bundle *bundle); /* accepts NULL */

/* Into how many parts it is cut, of all ranks (fe/bundle/bundle_parts.h). */
int wb_bundle_parts(const struct wb_bundle *bundle);

/* All stations with fields and the states of materials, brought together from all parts where there
 * was a step since. */
const struct wb_bundle_part *wb_bundle_whole(const struct wb_bundle *bundle);

/* Saves the state, or restores that of a bundle of the same model, settings and number of parts,
 * which then goes on bit for bit. */
void wb_bundle_visit(struct wb_bundle *bundle, struct wb_checkpoint *checkpoint);

double wb_bundle_time_step(const struct wb_bundle *bundle); /* s */
long wb_bundle_hexahedra(const struct wb_bundle *bundle);
int wb_bundle_shells(const struct wb_bundle *bundle);

/* Asked again and again while a bundle comes to rest; false: it stays as it is, not at rest. */
struct wb_bundle_watch {
    bool (*goes_on)(void *context);
    void *context;
};

/* Brings the weight on with the tip held at zero, at rest: motion is stopped whenever its energy
 * begins to fall, until it is small. Nothing without weight. WB_ERR_CONVERGENCE when it does not
 * come to rest, WB_ERR_DATA as of wb_bundle_advance(). `watch` may be NULL, and `reason`, which
 * gets why it failed: then the log gets it. */
WB_MUST_CHECK enum wb_status wb_bundle_settle(struct wb_bundle *bundle,
                                              const struct wb_bundle_watch *watch,
                                              struct wb_reason *reason);

/* Lets go of the tip, as a slack strand does: it comes to rest where nothing acts on it but the
 * weight. Motion is stopped as in settling; the energy this takes is counted as work from outside.
 * The tip's target is where it rests. Failures as of wb_bundle_settle(). */
WB_MUST_CHECK enum wb_status wb_bundle_let_go(struct wb_bundle *bundle,
                                              const struct wb_bundle_watch *watch,
                                              struct wb_reason *reason);

/* Leads the tip from its present target to `deflection` (m) within the time given (s), by a smooth
 * step, from now on. */
void wb_bundle_lead(struct wb_bundle *bundle, double deflection, double duration);

/* `n` steps. WB_ERR_DATA when the run is lost (a number is not finite, wires pass through each
 * other): `reason` gets why, NULL: the log gets it. */
WB_MUST_CHECK enum wb_status wb_bundle_advance(struct wb_bundle *bundle, int n,
                                               struct wb_reason *reason);

void wb_bundle_get_state(const struct wb_bundle *bundle, struct wb_bundle_state *state);

/* All energies as of the last step; costs about ten steps. */
void wb_bundle_get_energies(const struct wb_bundle *bundle, struct wb_bundle_energies *energies);

/* Axis of the bundle at n arc lengths s (m): mean of the wires' section centres, over masses. */
void wb_bundle_shape(const struct wb_bundle *bundle, int n, const double *s, double (*shape)[3]);

/* Elements whose strain went beyond what the kernels' logarithm is made for, in the last step that
 * was looked at; the largest strain. */
struct wb_bundle_limits {
    long long beyond;
    double largest_strain;
    double deepest;      /* m: penetration of wires into each other */
    double tape_deepest; /* m: of the tape into wires, where it is not bonded */
    double debonded;     /* share of the bonded area whose bond is broken */
};
void wb_bundle_get_limits(const struct wb_bundle *bundle, struct wb_bundle_limits *limits);

#endif
