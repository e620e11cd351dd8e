/* The outline of a bundle: the convex hull of its wires, as a taut tape lies round them. Arcs on
 * the wires that it touches alternate with straight pieces between them.
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

/* Where the outline lies on a wire. A wire that it only touches on its way between two others has
 * an arc of no length; a thick wire may have several. */
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

/* A wire up to `tolerance` (m) within a straight piece touches it, too. */
WB_MUST_CHECK enum wb_status wb_hull_find(struct wb_hull *hull, const struct wb_packing *packing,
                                          double tolerance);

/* Of the outline, m. */
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

/* The point at the length s (m, any: a whole outline more is the same point) from the beginning of
 * the first arc. */
struct wb_hull_point wb_hull_at(const struct wb_hull *hull, double offset, double s);

#endif
