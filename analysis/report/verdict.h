/* Verdict of a campaign's limit: whether the value that it bounds keeps it. */
#ifndef WB_ANALYSIS_REPORT_VERDICT_H
#define WB_ANALYSIS_REPORT_VERDICT_H

#include <stdbool.h>

/* How a value with an uncertainty is compared with a limit, after ILAC-G8:09/2019. */
enum wb_verdict_rule {
    WB_RULE_SIMPLE, /* kept: the value is at most the limit; the uncertainty is only stated */
    WB_RULE_GUARDED /* kept: the value and its uncertainty U are at most the limit */
};
extern const char *const wb_verdict_rules[]; /* of a campaign file; NULL at the end */
/* The rule in a sentence, plain text. */
const char *wb_verdict_rule_text(enum wb_verdict_rule rule);

/* Whether a value keeps a limit. `expanded` is its U, of a coverage of 95 %; NaN: not known, which
 * keeps none by the guarded rule. A value that is NaN keeps none by any. */
bool wb_verdict_keeps(enum wb_verdict_rule rule, double value, double expanded, double limit);

struct wb_verdict {
    const char *what;    /* that is bounded; markup */
    const char *key;     /* of the limit in the campaign file: "rms_max" */
    const char *label;   /* of the thing that has the value, plain text; NULL: there is only one */
    double value, limit; /* 1; a value that is NaN is not known */
    bool kept;
};

/* Adds a verdict, with `kept` set, to the *n that are there; nothing where `limit` is 0: none. A
 * value that is not known does not keep a limit. */
void wb_verdict_add(struct wb_verdict *verdicts, int *n, const struct wb_verdict *verdict);

/* Whether all are kept. */
bool wb_verdict_all_kept(const struct wb_verdict *verdicts, int n);

#endif
