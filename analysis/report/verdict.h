/* Verdict on a limit of a campaign: whether a value meets the limit. */
#ifndef WB_ANALYSIS_REPORT_VERDICT_H
#define WB_ANALYSIS_REPORT_VERDICT_H

#include <stdbool.h>

/* How a value with an uncertainty is compared with a limit, after ILAC-G8:09/2019. */
enum wb_verdict_rule {
    WB_RULE_SIMPLE, /* met if the value is at most the limit; the uncertainty is only stated */
    WB_RULE_GUARDED /* met if the value plus its uncertainty U is at most the limit */
};
extern const char *const wb_verdict_rules[]; /* names in a campaign file; NULL at the end */
/* The rule in a sentence, plain text. */
const char *wb_verdict_rule_text(enum wb_verdict_rule rule);

/* Whether a value meets a limit. `expanded` is its uncertainty U with 95 % coverage; if it is NaN
 * (unknown), no limit is met by the guarded rule. A NaN value meets no limit by either rule. */
bool wb_verdict_keeps(enum wb_verdict_rule rule, double value, double expanded, double limit);

struct wb_verdict {
    const char *what;    /* the limited quantity; markup */
    const char *key;     /* of the limit in the campaign file: "rms_max" */
    const char *label;   /* of the wire, bundle or run, plain text; NULL: there is only one */
    double value, limit; /* dimensionless; value NaN: unknown */
    bool kept;
};

/* Appends a verdict to an array of *n and sets its `kept`, by simple acceptance. No verdict is
 * added if `limit` is 0 (no limit). An unknown value does not meet a limit. */
void wb_verdict_add(struct wb_verdict *verdicts, int *n, const struct wb_verdict *verdict);

/* Whether all limits are met. */
bool wb_verdict_all_kept(const struct wb_verdict *verdicts, int n);

#endif
