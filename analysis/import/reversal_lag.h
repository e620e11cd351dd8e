/* The lag of the force behind the motion at one reversal, from both signals at once.
 *
 * The motion is two straight lines with a rest between them that may be short: h = h0 + v1 min(0, t
 * - t1) + v2 max(0, t - t2). The force follows it, later by the lag: F = F0 + a polynomial of
 * second degree in min(0, t - t1 - lag) + another in max(0, t - t2 - lag). All numbers are found
 * together by least squares, each signal weighted by its noise. The rest matters: a stage waits a
 * tenth of a second for its next command, and the force, steeper on the return, then has its
 * corner nearer to the end of the rest than the motion.
 *
 * Where the rest is long, the two corners are looked at by themselves: the lines of one way are
 * then those of the rest, in which the force may go on.
 *
 * Left out of the force is what a filter of first order still remembers: three of its delays after
 * the rest.
 */
#ifndef WB_ANALYSIS_IMPORT_REVERSAL_LAG_H
#define WB_ANALYSIS_IMPORT_REVERSAL_LAG_H

#include <stdbool.h>

#include "analysis/import/signal.h"

enum wb_turn {
    WB_TURN_BACK,     /* at once, or after less than a second of rest */
    WB_TURN_TO_REST,  /* the motion stops; the force may still fall */
    WB_TURN_FROM_REST /* it moves again */
};

struct wb_reversal {
    double from, at, until; /* s: where the way there begins, about where it turns, where the way
                               back ends; or the rest in place of one of them */
    enum wb_turn turn;
};

struct wb_reversal_lag {
    double lag;         /* s */
    double uncertainty; /* s, standard: curvature of the misfit, enlarged where the model leaves
                           more than noise, and at least by how much a shorter window moves it */
    double rest;        /* s, between the two ways */
};

/* False where there are too few samples, or the numbers are not determined. */
bool wb_reversal_lag_find(struct wb_reversal_lag *result, const struct wb_signal *motion,
                          const struct wb_signal *force, const struct wb_reversal *reversal,
                          double filter_delay);

/* Mean over lags, each weighted by its uncertainty; begins as zeros. */
struct wb_reversal_mean {
    int n;
    double weights, sum, squares;
};

void wb_reversal_mean_add(struct wb_reversal_mean *mean, double lag, double uncertainty);
/* Of at least one. Its standard uncertainty is enlarged where the lags differ by more than theirs.
 */
void wb_reversal_mean_find(const struct wb_reversal_mean *mean, double *lag, double *uncertainty);

#endif
