/* Three-point bending tests of one wire, each left out in turn: the prediction by the law of the
 * other tests, compared with the curves of those tests.
 *
 * All curves are forces over the deflection beyond the first contact that the readings show. The
 * fitted first contact differs from it; the mean difference of the other tests is used, so that the
 * test left out does not affect its own prediction. The mean curve of the others deviates from the
 * test left out by sqrt(n / (n - 1)) s because of the scatter s between tests alone, and a model
 * can be better only by chance. The model adds its bias: its curve minus the mean of the curves
 * from which it was made.
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
    int n;           /* tests */
    double scatter;  /* N: s, root mean square over deflections */
    double expected; /* N: sqrt(n / (n - 1)) s */
    double rms;      /* N: of model minus the test left out, pooled over tests and deflections */
    double bias;     /* N: root mean square of `offset` over the deflections */
    double of_max_force; /* N: largest of `mean` */
    /* At WB_LEFT_OUT_GRID equal steps of the deflections that all tests have, m: mean of the tests,
     * their s, and model minus mean of the other tests, averaged over the tests left out; N. */
    double deflection[WB_LEFT_OUT_GRID];
    double mean[WB_LEFT_OUT_GRID], deviation[WB_LEFT_OUT_GRID], offset[WB_LEFT_OUT_GRID];
};

/* WB_ERR_DATA: fewer than two fitted tests, or no deflections that all have; WB_ERR_CONVERGENCE:
 * the beam does not reach the last deflection. `why` receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_left_out_run(struct wb_left_out *result,
                                             const struct wb_three_point_calibration *calibration,
                                             int n_elements, struct wb_reason *why);

#endif
