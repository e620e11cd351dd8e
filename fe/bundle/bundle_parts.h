/* A bundle cut along its axis into parts, one a thread, of all ranks (fe/team/team.h).
 *
 * A part (fe/bundle/bundle_part.h) has the stations that it owns and, towards either neighbour, a
 * halo of stations that the neighbour owns. All is computed there as in the whole; what a part
 * counts and what it hands out is of its own stations. After every step the
 * neighbours swap the positions of the stations in each other's halo, and no more than these:
 * elements, friction and bonds in a halo are computed by both sides, with histories of their own.
 *
 * The halo is so wide that the forces on a part's own stations are those of the whole: elements
 * need one station; contact of wires that have slipped past each other by s stations what is s + 3
 * away (places of contact lie s / 2 off, on either wire, between two stations, and their tangents
 * are differences to the next); the tape's contact six. How far wires slip is estimated from the
 * deflection, and watched. Parts begin where a vector of the kernels does in the whole, so that
 * the arithmetic is the same but for a few vectors at borders, and sums.
 *
 * The row belongs to a part that has all stations, the whole: it has the account of the last step,
 * the fields of the tip, and all other fields once wb_bundle_parts_gather() was called. In a row of
 * one the whole itself is the part that is computed.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_PARTS_H
#define WB_FE_BUNDLE_BUNDLE_PARTS_H

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle_part.h"

struct wb_bundle_parts; /* opaque */

/* Into how many parts, of all ranks, a bundle would be cut. `mesh` may be NULL: the model's own. */
int wb_bundle_parts_of(const struct wb_bundle_model *model, const char *mesh, int threads);

/* Of a whole that has not moved and must outlive it. `count` as of wb_bundle_parts_of(). */
WB_MUST_CHECK enum wb_status wb_bundle_parts_create(struct wb_bundle_parts **out,
                                                    struct wb_bundle_part *whole, int count);
void wb_bundle_parts_destroy(struct wb_bundle_parts *parts); /* accepts NULL */

int wb_bundle_parts_count(const struct wb_bundle_parts *parts);

/* `n` steps of all parts; the whole's clock and account follow. Where the run is lost `reason` gets
 * why, NULL: the log gets it. */
WB_MUST_CHECK enum wb_status wb_bundle_parts_advance(struct wb_bundle_parts *parts, int n,
                                                     struct wb_reason *reason);

/* All that moves stands still. */
void wb_bundle_parts_stop(struct wb_bundle_parts *parts);

/* Sums over all parts, J. */
double wb_bundle_parts_potential(struct wb_bundle_parts *parts);
double wb_bundle_parts_plastic_work(struct wb_bundle_parts *parts);

/* Share of the tape's bonded area whose bond is broken. */
double wb_bundle_parts_debonded(struct wb_bundle_parts *parts);

/* Brings fields and the states of materials of all parts into the whole, if there was a step since.
 */
void wb_bundle_parts_gather(struct wb_bundle_parts *parts);

/* Saves or restores the state of all parts, of all ranks. */
void wb_bundle_parts_visit(struct wb_bundle_parts *parts, struct wb_checkpoint *checkpoint);

#endif
