#include "analysis/report/verdict.h"

#include <stddef.h>

const char *const wb_verdict_rules[] = {"simple", "guarded", NULL};

const char *wb_verdict_rule_text(enum wb_verdict_rule rule)
{
    return rule == WB_RULE_GUARDED
               ? "guarded acceptance: a limit is met if the value plus its uncertainty U is at "
                 "most the limit (ILAC-G8:09/2019, guard band U)"
               : "simple acceptance: a limit is met if the value is at most the limit; its "
                 "uncertainty U is stated but not taken into account (ILAC-G8:09/2019, no guard "
                 "band)";
}

bool wb_verdict_keeps(enum wb_verdict_rule rule, double value, double expanded, double limit)
{
    return rule == WB_RULE_GUARDED ? value + expanded <= limit : value <= limit;
}

void wb_verdict_add(struct wb_verdict *verdicts, int *n, const struct wb_verdict *verdict)
{
    if (!(verdict->limit > 0.0))
        return;
    verdicts[*n] = *verdict;
    /* False if the value is NaN. */
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
