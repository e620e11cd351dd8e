#include "analysis/report/verdict.h"

void wb_verdict_add(struct wb_verdict *verdicts, int *n, const struct wb_verdict *verdict)
{
    if (!(verdict->limit > 0.0))
        return;
    verdicts[*n] = *verdict;
    /* So that a NaN is not kept. */
    verdicts[(*n)++].kept = verdict->value <= verdict->limit;
}

bool wb_verdict_all_kept(const struct wb_verdict *verdicts, int n)
{
    for (int i = 0; i < n; i++) {
        if (!verdicts[i].kept)
            return false;
    }
    return true;
}
