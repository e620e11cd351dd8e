/* Filled contours of a field on 8-node faces: for every level the region in which the value reaches
 * it. Drawn from the lowest level up, each region over the ones below, they show the field without
 * seams, in as many colours as there are levels.
 *
 * A face has corners 0 to 3 around and midside nodes 0-1, 1-2, 2-3, 3-0; position and value are
 * those of its shape functions. Faces that share nodes with equal positions and values join; where
 * only the positions are equal the field jumps between them.
 */
#ifndef WB_ANALYSIS_PLOT_CONTOUR_H
#define WB_ANALYSIS_PLOT_CONTOUR_H

#include "base/status.h"

struct wb_contour_face {
    double x[8], y[8], value[8];
};

/* Level k begins at low + k (high - low) / n_levels; all of level 0 counts as reached, so that it
 * is the outline of the faces. */
struct wb_contour_levels {
    double low, high; /* low < high */
    int n;            /* from 1 */
};

/* A closed line; the region lies on its left where x is to the right and y upwards. */
struct wb_contour_loop {
    int level, first, n; /* its points */
};

struct wb_contour {
    int n_loops, n_points;
    struct wb_contour_loop *loops; /* (n_loops), ascending levels, owned */
    double (*points)[2];           /* (n_points), owned */
};

/* Faces with a coordinate or value that is not finite are left out. Points are left out where the
 * line strays by less than 1.5e-4 of the faces' extent. On a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_contour_create(struct wb_contour *contour, int n_faces,
                                               const struct wb_contour_face *faces,
                                               const struct wb_contour_levels *levels);
/* Leaves points of a closed line out as long as it strays by less than `most`; returns how many
 * stay, at the begin of `points`. */
int wb_contour_thin(double (*points)[2], int n, double most);

void wb_contour_release(struct wb_contour *contour); /* accepts a zeroed one */

#endif
