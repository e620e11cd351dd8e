/* Names beside marks of a drawing, each placed where it covers the least of lines and marks; a line
 * leads to a name that stands farther away. A name without a place beside the others is left out.
 * Coordinates are those of the panel; the caller knows its scale. */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_LABELS_H
#define WB_ANALYSIS_HARNESS_HARNESS_LABELS_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/plot/figure.h"

struct wb_harness_labels_box {
    double low[2], high[2];
    bool is_name;
};

/* Starts with zeroes, the scale and the panel's range. */
struct wb_harness_labels {
    double scale;                       /* panel's units for a point of 1/72 inch */
    struct wb_harness_labels_box panel; /* its range */
    size_t n_points, x_room, y_room;
    double *x, *y; /* (n_points) not to be covered; owned */
    size_t n_boxes, room;
    struct wb_harness_labels_box *boxes; /* (n_boxes) of marks and names; owned */
};

void wb_harness_labels_release(struct wb_harness_labels *labels);

/* A point of a line, or a mark, that names should not cover. */
void wb_harness_labels_add_point(struct wb_harness_labels *labels, double x, double y);
void wb_harness_labels_add_mark(struct wb_harness_labels *labels, double x, double y);

/* Adds a plain text beside a point of the panel; false: there is no place for it. */
bool wb_harness_labels_put(struct wb_harness_labels *labels, struct wb_panel *panel, double x,
                           double y, const char *plain, bool is_italic);

#endif
