/* The lag of the force behind the motion at one reversal, from both signals together.
 *
 * The motion is two straight lines with a rest between them that may be short: h = h0 + v1 min(0, t
 * - t1) + v2 max(0, t - t2). The force follows with the lag: F = F0 + a polynomial of second degree
 * in min(0, t - t1 - lag) + another in max(0, t - t2 - lag). All parameters are found together by
 * least squares, each signal weighted by its noise. The rest matters: a stage waits a tenth of a
 * second for its next command, and the force, steeper on the return, then has its corner nearer to
 * the end of the rest than the motion.
 *
 * A long rest is treated as two separate corners: the lines of one side are then those of the rest,
 * during which the force may change.
 *
 * Three delays of a first-order filter after the rest are left out of the force, until the filter
 * has settled.
 */
#ifndef WB_ANALYSIS_IMPORT_REVERSAL_LAG_H
#define WB_ANALYSIS_IMPORT_REVERSAL_LAG_H

#include <stdbool.h>

#include "analysis/import/signal.h"

enum wb_turn {
    WB_TURN_BACK,     /* directly, or after less than a second of rest */
    WB_TURN_TO_REST,  /* the motion stops; the force may still decrease */
    WB_TURN_FROM_REST /* the motion starts again */
};

struct wb_reversal {
    double from, at, until; /* s: beginning of the first branch, approximate turn, end of the second
                               branch; a rest may take the place of a branch */
    enum wb_turn turn;
};

struct wb_reversal_lag {
    double lag;         /* s */
    double uncertainty; /* s, standard: from the curvature of the misfit, enlarged if the misfit
                           exceeds the noise, and at least the change of the lag with a shorter
                           window */
};

/* The reversals of a turn that the motion reaches at `arrival` and leaves at `departure` (s): one
 * from its branch to the next, or two if the rest between them is longer than 0.7 s. Returns their
 * number. */
int wb_reversal_list(struct wb_reversal reversals[2], double from, double arrival, double departure,
                     double until);

/* False if there are too few samples, or if they do not determine the parameters. */
bool wb_reversal_lag_find(struct wb_reversal_lag *result, const struct wb_signal *motion,
                          const struct wb_signal *force, const struct wb_reversal *reversal,
                          double filter_delay);

/* Mean over lags, each weighted by its uncertainty; initialise with zeros. */
struct wb_reversal_mean {
    int n;
    double weights, sum, squares;
};

void wb_reversal_mean_add(struct wb_reversal_mean *mean, double lag, double uncertainty);
/* The mean of at least one lag. Its standard uncertainty is enlarged if the lags differ by more
 * than theirs. */
void wb_reversal_mean_find(const struct wb_reversal_mean *mean, double *lag, double *uncertainty);

#endif
