/* The capped end of a bundle: all that is at its last station moves as one rigid body.
 *
 * Its masses are those of the last station; with selective mass scaling its rotary inertia is that
 * of the mass matrix M' (fe/swept/swept_step.h) for rigid motion, so that the cap is a constraint
 * on the bundle without it, and no frequency rises by it. Directors turn with it and have part in
 * it.
 *
 * The steps are those of central differences with such a constraint: with r a place beside the
 * centre of mass, from step to step turned by exp(t x), and a = sin|t| / |t|,
 * b = (1 - cos|t|) / |t|^2, J = tr S - S,
 *
 *     sum M' r x (exp(t x) r - r) = a J t + b S t x t = dt (angular momentum),  S = sum M' r r^T,
 *
 * for t (J. Moser, A. P. Veselov, Commun. Math. Phys. 139 (1991) 217): momentum and angular
 * momentum are kept to round-off, energy as by central differences.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_CAP_H
#define WB_FE_BUNDLE_BUNDLE_CAP_H

#include "base/checkpoint.h"
#include "base/status.h"
#include "fe/bundle/bundle_body.h"

struct wb_bundle_cap; /* opaque */

/* For bodies that are straight, wires and tape; holds their last station. They must outlive it. */
WB_MUST_CHECK enum wb_status wb_bundle_cap_create(struct wb_bundle_cap **out,
                                                  const struct wb_bundle_bodies *bodies);
void wb_bundle_cap_destroy(struct wb_bundle_cap *cap); /* accepts NULL */

/* One step under the forces of the bodies' fields: velocities of the last station, for the update
 * of its bodies. `half` is 0.5 in the first step from rest, else 1. */
void wb_bundle_cap_advance(struct wb_bundle_cap *cap, double half);

/* Kinetic energy in the last step, J: 1/2 v-.M' v+ of the velocities before and after. */
double wb_bundle_cap_kinetic(const struct wb_bundle_cap *cap);

/* Brings it to rest where it is. */
void wb_bundle_cap_stop(struct wb_bundle_cap *cap);

/* Saves or restores its motion. */
void wb_bundle_cap_visit(struct wb_bundle_cap *cap, struct wb_checkpoint *checkpoint);

#endif
