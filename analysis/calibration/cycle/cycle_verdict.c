#include "analysis/calibration/cycle/cycle_verdict.h"

#include <math.h>

static int count_doubts(const struct wb_cycle_remarks *remarks)
{
    int n = 0;
    for (int i = 0; i < remarks->n; i++)
        n += remarks->items[i].severity == WB_CHECK_DOUBT;
    return n;
}

struct wb_cycle_verdict wb_cycle_verdict(const struct wb_cycle_calibration *c,
                                         const struct wb_cycle_remarks *remarks,
                                         const struct wb_cycle_calibrate_settings *settings)
{
    struct wb_cycle_verdict v = {.n_doubts = count_doubts(remarks), .at_most = settings->at_most};
    v.has[WB_CYCLE_STOPPED] = c->is_stopped;
    v.has[WB_CYCLE_NOT_CONVERGED] = !wb_cycle_calibrate_is_converged(c);
    v.has[WB_CYCLE_NO_LAW_FITS] = c->has_unloading && !c->is_followed && !c->is_stopped;
    v.has[WB_CYCLE_DOUBTFUL] = v.n_doubts > 0;
    v.has[WB_CYCLE_UNCERTAIN] =
        v.at_most > 0.0 && !wb_cycle_budget_is_within(c, v.at_most, v.worst, &v.known);
    v.has[WB_CYCLE_LOADING_ONLY] = !c->has_unloading;
    v.has[WB_CYCLE_SCATTER_UNKNOWN] = !isfinite(c->rigidity.deviation);
    while (v.first < WB_CYCLE_RESTRICTIONS && !v.has[v.first])
        v.first++;
    return v;
}

bool wb_cycle_verdict_is_complete(const struct wb_cycle_verdict *v)
{
    return !v->has[WB_CYCLE_STOPPED] && !v->has[WB_CYCLE_NOT_CONVERGED] &&
           !v->has[WB_CYCLE_NO_LAW_FITS] && !v->has[WB_CYCLE_UNCERTAIN];
}
