/* What a limit of a campaign says of results: whether the value that it bounds keeps it. */
#ifndef WB_ANALYSIS_REPORT_VERDICT_H
#define WB_ANALYSIS_REPORT_VERDICT_H

#include <stdbool.h>

struct wb_verdict {
    const char *what;    /* that is bounded; markup */
    const char *key;     /* of the limit in the campaign file: "rms_max" */
    const char *label;   /* of what the value belongs to, plain text; NULL: there is only one */
    double value, limit; /* 1; a value that is NaN is not known */
    bool kept;
};

/* Adds a verdict, with `kept` set, to the *n that are there; nothing where `limit` is 0: none. A
 * value that is not known does not keep a limit. */
void wb_verdict_add(struct wb_verdict *verdicts, int *n, const struct wb_verdict *verdict);

/* Whether all are kept. */
bool wb_verdict_all_kept(const struct wb_verdict *verdicts, int n);

#endif
