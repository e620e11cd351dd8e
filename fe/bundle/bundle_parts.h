/* A bundle as a row of one or more parts along its axis, one for each thread of each rank
 * (fe/team/team.h).
 *
 * A part (fe/bundle/bundle_part.h) has the stations that it owns and, towards each neighbour, a
 * halo of stations that the neighbour owns. It computes all of them, and counts only its own. After
 * every step neighbours send each other the positions of the stations in the other's halo, and
 * nothing else: both sides compute elements, friction and bonds in a halo, each with its own state.
 *
 * The halo is so wide that the forces on a part's own stations are those of the whole bundle.
 * Elements need one station. Wires that have slipped past each other by s stations need s + 3
 * (places of contact lie s / 2 away on either wire, between two stations, and their tangents are
 * differences to the next one). The tape's contact needs six. The slip is estimated from the
 * deflection, and checked. Parts begin where a vector of the kernels begins in the whole, so that
 * the arithmetic is the same but for a few vectors at borders, and sums.
 *
 * The row belongs to a part that has all stations, the whole. After each advance the whole has the
 * account of the last step and the fields at the tip; wb_bundle_parts_gather() brings all other
 * fields. In a row of one the whole itself is computed.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_PARTS_H
#define WB_FE_BUNDLE_BUNDLE_PARTS_H

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle_part.h"

struct wb_bundle_parts; /* opaque */

/* The number of parts, in all ranks, into which a bundle would be cut. `mesh` NULL: the model's
 * own.
 */
int wb_bundle_parts_of(const struct wb_bundle_model *model, const char *mesh, int threads);

/* Cuts a whole that has not moved yet and must outlive the row. `count` is that of
 * wb_bundle_parts_of(). */
WB_MUST_CHECK enum wb_status wb_bundle_parts_create(struct wb_bundle_parts **out,
                                                    struct wb_bundle_part *whole, int count);
void wb_bundle_parts_destroy(struct wb_bundle_parts *parts); /* accepts NULL */

int wb_bundle_parts_count(const struct wb_bundle_parts *parts);

/* Makes `n` steps with all parts; the whole's clock and account follow. On failure
 * `reason` holds the reason; where it is NULL, that is logged. */
WB_MUST_CHECK enum wb_status wb_bundle_parts_advance(struct wb_bundle_parts *parts, int n,
                                                     struct wb_reason *reason);

/* Sets all velocities to zero. */
void wb_bundle_parts_stop(struct wb_bundle_parts *parts);

/* Sums over all parts, J. */
double wb_bundle_parts_potential(struct wb_bundle_parts *parts);
double wb_bundle_parts_plastic_work(struct wb_bundle_parts *parts);

/* Share of the tape's bonded area whose bond is broken. */
double wb_bundle_parts_debonded(struct wb_bundle_parts *parts);

/* Copies fields and the states of materials from all parts into the whole, if there was a step
 * since the last call. */
void wb_bundle_parts_gather(struct wb_bundle_parts *parts);

/* Saves or restores the state of all parts in all ranks. */
void wb_bundle_parts_visit(struct wb_bundle_parts *parts, struct wb_checkpoint *checkpoint);

#endif
