/* Room for legends and insets: which part of a plot is taken by data, and where a box fits.
 *
 * The plot is a grid of small square cells; whatever is drawn marks the cells it touches. A box is
 * free when none of its cells is marked. All lengths in points, from the plot's upper left corner.
 */
#ifndef WB_ANALYSIS_PLOT_PLACE_H
#define WB_ANALYSIS_PLOT_PLACE_H

#include <stdbool.h>

struct wb_place; /* opaque */

struct wb_place_box {
    double x, y, width, height;
};

/* An empty plot of that size, pt. */
struct wb_place *wb_place_create(double width, double height);
void wb_place_destroy(struct wb_place *place); /* accepts NULL */

/* Marks a segment with half a width around it; a point is a segment of no length. Parts outside of
 * the plot are ignored, as are NaN. */
void wb_place_mark_segment(struct wb_place *place, double x0, double y0, double x1, double y1,
                           double half_width);
/* The same for a box. */
void wb_place_mark_box(struct wb_place *place, const struct wb_place_box *box);

/* Finds room for a box of the given size with `gap` around it: the corner with the most room, else
 * the free spot nearest to a corner, within a third of the plot's diagonal. False when there is
 * none. */
bool wb_place_find(const struct wb_place *place, double width, double height, double gap,
                   struct wb_place_box *box);

#endif
