/* A bundle is a row of one or more parts along its axis, one for each thread of each rank
 * (fe/team/team.h).
 *
 * A part (fe/bundle/bundle_part.h) has the stations that it owns and, towards each neighbour, a
 * halo of stations that the neighbour owns. It computes all of them, but counts only its own. After
 * every step neighbours send each other only the positions of the stations in the other's halo:
 * both sides compute elements, friction and bonds in a halo, each with its own state.
 *
 * The halo is wide enough for the forces on a part's own stations to be those of the complete
 * bundle. Elements need one station. Wires that have slipped past each other by s stations need s +
 * 3 (contact points are s / 2 away on either wire, between two stations, and their tangents are
 * differences to the next station). The tape's contact needs six. The slip is estimated from the
 * deflection, and checked. Parts begin where a vector of the kernels begins in the complete bundle,
 * so that the arithmetic is the same except for a few vectors at borders, and sums.
 *
 * The row belongs to a part with all stations, called the whole. After each advance the whole has
 * the account of the last step and the fields at the tip; wb_bundle_whole() copies all other
 * fields. With one part the whole itself is computed.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_PARTS_H
#define WB_FE_BUNDLE_BUNDLE_PARTS_H

#include "fe/model/bundle_model.h"

/* Number of parts, in all ranks, into which a bundle would be cut. `mesh` NULL: the model's own. */
int wb_bundle_parts_of(const struct wb_bundle_model *model, const char *mesh, int threads);

#endif
