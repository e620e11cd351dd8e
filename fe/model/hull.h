/* The outline of a bundle: the convex hull of its wires, which a taut tape follows. Arcs on the
 * wires that it touches alternate with straight pieces.
 *
 * Directions are angles from +z towards +y; the outline runs counter-clockwise as seen with z to
 * the right and y up. The outline `offset` farther out (of a tape's middle, or of its outside) has
 * the same straight pieces, and arcs whose radius is larger by `offset`.
 */
#ifndef WB_FE_MODEL_HULL_H
#define WB_FE_MODEL_HULL_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/model/packing.h"

enum {
    WB_HULL_MOST = 3 * WB_PACKING_MOST /* arcs */
};

/* An arc of the outline on a wire. A wire that is only touched by a straight piece has an arc of
 * zero length; a thick wire may have several arcs. */
struct wb_hull_arc {
    int wire;
    double from, to; /* rad, of the outward normal; from <= to, the next arc's from is this one's
                        to; all within a turn from the first one's, which is from -pi to pi */
    double straight; /* m, of the piece that follows */
};

struct wb_hull {
    struct wb_packing packing;
    int n_arcs;
    struct wb_hull_arc arc[WB_HULL_MOST];
};

/* A wire up to `tolerance` (m) inside a straight piece counts as touching it. */
WB_MUST_CHECK enum wb_status wb_hull_find(struct wb_hull *hull, const struct wb_packing *packing,
                                          double tolerance);

/* Length of the outline, m. */
double wb_hull_length(const struct wb_hull *hull, double offset);

/* Integrals over the outline: of 1, y, z, y^2, z^2 (m, m2, m3). */
struct wb_hull_moments {
    double length, y, z, yy, zz;
};
struct wb_hull_moments wb_hull_moments(const struct wb_hull *hull, double offset);

/* The angle over which the outline lies on a wire, rad, and whether it touches it at all. */
double wb_hull_contact(const struct wb_hull *hull, int wire, bool *touches);

/* A point of the outline. */
struct wb_hull_point {
    double y, z;   /* m */
    double normal; /* rad, outwards */
    int wire;      /* on whose arc it lies; -1: on a straight piece */
};

/* The point at the arc length s (m, periodic with the outline's length) from the beginning of the
 * first arc. */
struct wb_hull_point wb_hull_at(const struct wb_hull *hull, double offset, double s);

#endif
