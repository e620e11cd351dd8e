/* Three-point bending tests of one wire, each left out in turn: what the law of the others says of
 * it, beside what the others' own curves say.
 *
 * All curves are forces over the deflection beyond the first contact that the readings show; the
 * part of it that the fits put elsewhere is the others', too, so nothing of the test left out
 * enters its prediction. The others' mean curve misses the test left out by sqrt(n / (n - 1)) s
 * from the scatter s between tests alone, and a model cannot do better but by chance. What it adds
 * is its bias, the model's curve against the mean of the curves that it was made from.
 */
#ifndef WB_ANALYSIS_VALIDATION_LEFT_OUT_H
#define WB_ANALYSIS_VALIDATION_LEFT_OUT_H

#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "base/reason.h"
#include "base/status.h"

enum {
    WB_LEFT_OUT_GRID = 41
};

struct wb_left_out {
    int n;               /* tests */
    double scatter;      /* N: s, root mean square over deflections */
    double expected;     /* N: sqrt(n / (n - 1)) s */
    double rms;          /* N: of model minus test left out, pooled over tests and deflections */
    double bias;         /* N: root mean square over deflections of what stands in `offset` */
    double of_max_force; /* N: largest of `mean` */
    /* Evenly over the deflections that all tests have, m: the tests' mean, their s, and the model
     * minus the mean of the others, mean over the tests left out; N. */
    double deflection[WB_LEFT_OUT_GRID];
    double mean[WB_LEFT_OUT_GRID], deviation[WB_LEFT_OUT_GRID], offset[WB_LEFT_OUT_GRID];
};

/* WB_ERR_DATA with fewer than two fitted tests or no deflections that all have, WB_ERR_CONVERGENCE
 * where the beam does not come to the end; the reason goes to `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_left_out_run(struct wb_left_out *result,
                                             const struct wb_three_point_calibration *calibration,
                                             int n_elements, struct wb_reason *why);

#endif
