/* Whether the result of a calibration on whole cycles can be used: one judgement, from which exit
 * code, warnings and the last lines of `wirebench calibrate` and the library's result are read.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VERDICT_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_VERDICT_H

#include "analysis/calibration/cycle/cycle_budget.h"
#include "analysis/calibration/cycle/cycle_check.h"

/* What restricts the use of a calibration, the most severe first. */
enum wb_cycle_restriction {
    WB_CYCLE_STOPPED,        /* interrupted before all laws were fitted to all specimens */
    WB_CYCLE_NOT_CONVERGED,  /* the chosen law's fit of a specimen */
    WB_CYCLE_NO_LAW_FITS,    /* none fits loading and unloading */
    WB_CYCLE_DOUBTFUL,       /* the checks of the data raised doubts */
    WB_CYCLE_UNCERTAIN,      /* more than `at_most` of the settings */
    WB_CYCLE_LOADING_ONLY,   /* no unloading was measured: the hardening rule is not tested */
    WB_CYCLE_SCATTER_UNKNOWN /* one specimen, and no pooled deviation */
};

enum {
    WB_CYCLE_RESTRICTIONS = WB_CYCLE_SCATTER_UNKNOWN + 1
};

struct wb_cycle_verdict {
    bool has[WB_CYCLE_RESTRICTIONS];
    int first;                  /* the most severe; WB_CYCLE_RESTRICTIONS: there is none */
    int n_doubts;               /* remarks of severity WB_CHECK_DOUBT */
    char worst[WB_BUDGET_TEXT]; /* of WB_CYCLE_UNCERTAIN: the quantity, */
    double known;               /* its expanded uncertainty, 95 %, and */
    double at_most;             /* the largest one that was allowed */
};

/* `remarks` are those of wb_cycle_check_calibrate(). */
struct wb_cycle_verdict wb_cycle_verdict(const struct wb_cycle_calibration *calibration,
                                         const struct wb_cycle_remarks *remarks,
                                         const struct wb_cycle_calibrate_settings *settings);

/* Whether the calibration came to its end and found what was asked for: exit code 0, else 3. Doubts
 * and tests that lack unloading or more specimens do not count. */
bool wb_cycle_verdict_is_complete(const struct wb_cycle_verdict *verdict);

#endif
