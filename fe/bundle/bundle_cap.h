/* The capped end of a bundle: all nodes of the last station move as one rigid body.
 *
 * The cap has the masses of the last station. With selective mass scaling its rotary inertia is
 * that of the mass matrix M' (fe/swept/swept_step.h) for rigid motion: the cap is only a constraint
 * and increases no frequency. The tape's directors rotate with the cap and add to its inertia.
 *
 * The steps are those of central differences with this constraint. Let r be a position relative to
 * the centre of mass, which a step rotates by exp(t x), and a = sin|t| / |t|, b = (1 - cos|t|) /
 * |t|^2, J = tr S - S; then
 *
 *     sum M' r x (exp(t x) r - r) = a J t + b S t x t = dt (angular momentum),  S = sum M' r r^T,
 *
 * gives t (J. Moser, A. P. Veselov, Commun. Math. Phys. 139 (1991) 217). Momentum and angular
 * momentum are conserved to round-off, energy as well as by central differences.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_CAP_H
#define WB_FE_BUNDLE_BUNDLE_CAP_H

#include "base/checkpoint.h"
#include "fe/bundle/bundle_body.h"

struct wb_bundle_cap; /* opaque */

/* Creates the cap of straight bodies, wires and tape, and fixes their last station. The bodies must
 * outlive it. */
struct wb_bundle_cap *wb_bundle_cap_create(struct wb_bundle_bodies *bodies);
void wb_bundle_cap_destroy(struct wb_bundle_cap *cap); /* accepts NULL */

/* Makes one step of the cap under the forces in the bodies' fields, and sets the velocities of the
 * last station, with which the bodies are then updated. `half` is 0.5 in the first step from rest,
 * otherwise 1. */
void wb_bundle_cap_advance(struct wb_bundle_cap *cap, double half);

/* Kinetic energy in the last step, J: 1/2 v-.M' v+ of the velocities before and after. */
double wb_bundle_cap_kinetic(const struct wb_bundle_cap *cap);

/* Sets its velocities to zero. */
void wb_bundle_cap_stop(struct wb_bundle_cap *cap);

/* Saves or restores position and velocities. */
void wb_bundle_cap_visit(struct wb_bundle_cap *cap, struct wb_checkpoint *checkpoint);

#endif
