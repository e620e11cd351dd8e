/* Where the wires of a harness touch obstacles: at the minima of the gap along each element, which
 * move along the wire as it moves, and at the joints, between which the wire may lie flat.
 *
 * The force of such a place is a multiplier by the augmented Lagrangian: f = max(0, m - p g) for
 * the gap g, where the multiplier m becomes f each time that the forces balance. In the end the gap
 * is 0, whatever the stiffness p; p is small at first, so that an iteration from far away arrives.
 * Friction is Coulomb's with a presliding distance (Dahl 1968): it grows in proportion to the
 * motion since the touch, up to its coefficient times a force that follows m; its direction lies in
 * the plane that was tangent when m was taken. For given m, force and plane all forces have a
 * potential: the stiffness is symmetric, and a line search finds where the wire sticks. Forces act
 * at the wire's axis; friction does not twist the wire.
 */
#ifndef WB_FE_HARNESS_HARNESS_CONTACT_H
#define WB_FE_HARNESS_HARNESS_CONTACT_H

#include "fe/harness/harness_state.h"

/* Finds the places that touch in the trial state, with their forces. */
void wb_harness_contact_find(struct wb_harness *harness);

/* The same, and adds the forces to the residuals of the nodes. */
void wb_harness_contact_add_forces(struct wb_harness *harness, struct wb_harness_balance *balance);

/* Adds what the places of an element change of its stiffness. */
void wb_harness_contact_add_stiffness(const struct wb_harness *harness, int element,
                                      struct wb_rod_element_stiffness *stiffness);

/* Takes from the increment what the forces of the places will be. */
void wb_harness_contact_advance(struct wb_harness *harness);

/* Commits the places that the trial state last evaluated touches, or goes back to the committed. */
void wb_harness_contact_commit(struct wb_harness *harness);
void wb_harness_contact_revert(struct wb_harness *harness);

#endif
