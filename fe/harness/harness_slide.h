/* Clips through which the wire of a harness slides. The place s of the wire in the clip and the
 * clip's force f on it are unknowns: the wire's position at s is the clip's, and the force along
 * the wire is zero, or the friction. Where it sticks, or at an end of the branch, s is prescribed.
 */
#ifndef WB_FE_HARNESS_HARNESS_SLIDE_H
#define WB_FE_HARNESS_HARNESS_SLIDE_H

#include "fe/harness/harness_state.h"

/* The equations of a clip. */
void wb_harness_slide_equations(const struct wb_harness *harness,
                                const struct wb_harness_clip *clip,
                                struct wb_harness_equation equations[WB_HARNESS_CLIP]);

/* Adds the forces of all clips to the residuals of the nodes. */
void wb_harness_slide_add_forces(struct wb_harness *harness);

/* A clip's unbalanced force along the wire, N, and the distance of the wire from it, m. */
double wb_harness_slide_unbalanced(const struct wb_harness *harness,
                                   const struct wb_harness_clip *clip, double *distance);

/* See wb_harness_adapt(); forces below `small` (N) are zero. */
int wb_harness_slide_adapt(struct wb_harness *harness, double small);

#endif
