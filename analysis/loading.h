/* The first loading of one sample, as points of what a curve's grid steps through and what it
 * holds: deflection and force, or force and deflection of a follower test. Used by curve.c only. */
#ifndef WB_ANALYSIS_LOADING_H
#define WB_ANALYSIS_LOADING_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/curve.h"
#include "analysis/dataset.h"
#include "base/status.h"

/* Fewer points than this are no curve. */
#define WB_LOADING_FEWEST_POINTS 10
/* A bin without rows is interpolated between rows this many steps apart at most: a marker hidden
 * for 1.5 s leaves 1.5 mm and a row at either end. */
#define WB_LOADING_LONGEST_GAP 4.0

/* `at` is what the grid steps through, `value` what the curve holds. */
struct wb_loading_point {
    double at, value;
};

struct wb_loading {
    size_t n;
    struct wb_loading_point *points; /* (n) by ascending `at`; owned */
};

/* Takes the rows of the first loading up to the grid's largest deflection, of a follower test up to
 * its largest force. WB_ERR_DATA when they are no curve; release it then, too. */
WB_MUST_CHECK enum wb_status wb_loading_extract(struct wb_loading *loading,
                                                const struct wb_dataset *dataset,
                                                const struct wb_curve_grid *grid);
void wb_loading_release(struct wb_loading *loading); /* accepts a zeroed one */

/* Value at grid point i: of a straight line fitted to the points around it, or between the nearest.
 * False where there are none near enough. */
bool wb_loading_value(const struct wb_loading *loading, int i, double step, double *value);

#endif
