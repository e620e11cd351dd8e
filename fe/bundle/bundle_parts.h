/* A bundle cut along its axis into parts, one a thread, of all ranks (fe/team/team.h).
 *
 * A part is a bundle of its own over some of the whole's stations: those it owns and, towards
 * either neighbour, a halo of stations that the neighbour owns. All is computed there as in the
 * whole; what a part counts and what it hands out is of its own stations. After every step the
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
 * The whole bundle stays as it is: it has the scalars of the last step, the fields of the tip, and
 * all others once wb_bundle_parts_gather() was called.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_PARTS_H
#define WB_FE_BUNDLE_BUNDLE_PARTS_H

#include "base/checkpoint.h"
#include "base/status.h"
#include "fe/bundle/bundle.h"

struct wb_bundle_parts; /* opaque */

/* For estimates: stations of the largest of so many parts, with its halos, 0 where there is no room
 * for them; and the bytes that two neighbours send each other in a step. */
int wb_bundle_parts_largest(const struct wb_bundle_model *model, const char *mesh, int count);
size_t wb_bundle_parts_bytes(const struct wb_bundle *whole);

/* Of a bundle that is made and has not moved. `count` as of wb_bundle_parts_of(), above 1. */
WB_MUST_CHECK enum wb_status wb_bundle_parts_create(struct wb_bundle_parts **out,
                                                    struct wb_bundle *whole, int count);
void wb_bundle_parts_destroy(struct wb_bundle_parts *parts); /* accepts NULL */

int wb_bundle_parts_count(const struct wb_bundle_parts *parts);

/* `n` steps of all parts; the whole's scalars follow. */
WB_MUST_CHECK enum wb_status wb_bundle_parts_advance(struct wb_bundle_parts *parts, int n);

/* All that moves stands still. */
void wb_bundle_parts_stop(struct wb_bundle_parts *parts);

/* Sums over all parts, J. */
double wb_bundle_parts_potential(struct wb_bundle_parts *parts);
double wb_bundle_parts_plastic_work(struct wb_bundle_parts *parts);

/* Adds the tape's areas that were bonded at first, and whose bond broke, m2. */
void wb_bundle_parts_add_bonds(struct wb_bundle_parts *parts, double area[2]);

/* Fields and histories of all parts into the whole's, if there was a step since. */
void wb_bundle_parts_gather(struct wb_bundle_parts *parts);

/* Saves or restores the parts' own states, of all ranks. */
void wb_bundle_parts_visit(struct wb_bundle_parts *parts, struct wb_checkpoint *checkpoint);

#endif
