/* Clips through which the wire of a harness slides. The place s of the wire in the clip and the
 * clip's force f on it are unknowns: the wire's position at s is the clip's, and the force along
 * the wire is zero, or the friction: Coulomb's, with a presliding distance (Dahl 1968) of 1e-6 of
 * the harness's length, over which it grows to its limit. At an end of the branch s is prescribed.
 */
#ifndef WB_FE_HARNESS_HARNESS_SLIDE_H
#define WB_FE_HARNESS_HARNESS_SLIDE_H

#include "fe/harness/harness_state.h"

/* The equations of a clip. */
void wb_harness_slide_equations(const struct wb_harness *harness,
                                const struct wb_harness_clip *clip,
                                struct wb_harness_equation equations[WB_HARNESS_CLIP]);

/* Adds the forces of all clips to the residuals of the nodes, and to `balance` their unbalanced
 * forces along the wire and the distances of the wire from them. */
void wb_harness_slide_add_forces(struct wb_harness *harness, struct wb_harness_balance *balance);

#endif
