/* The uncertainty of a calibration's numbers, as the GUM (JCGM 100:2008) combines it: standard
 * uncertainties of the logarithm, from the scatter between specimens, from what a fit leaves open,
 * from the form of the law, and from what the files state of what all specimens share.
 *
 * Only the first shrinks with more specimens: what the law does not follow is the same in all.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BUDGET_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BUDGET_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "base/json.h"

/* Numbers whose budgets are printed: the moment at a tenth of the largest curvature and there, both
 * stiffnesses at 1 /m, or as far as there are data, and the residual curvature ratio. */
enum {
    WB_BUDGET_COLUMNS = 5,
    WB_BUDGET_TEXT = 80
};
struct wb_budget_column {
    char name[WB_BUDGET_TEXT]; /* "M at 2.97 /m" */
    enum wb_cycle_number number;
};
int wb_cycle_budget_columns(const struct wb_cycle_calibration *calibration,
                            struct wb_budget_column columns[WB_BUDGET_COLUMNS]);

/* Whether the moments, the unloading stiffness over 1 /m and the residual curvature ratio are known
 * within a part of them, with 95 %; `name` receives which is known worst, *known how well. What no
 * file states is not asked for. One specimen knows nothing of the product: infinite. */
bool wb_cycle_budget_is_within(const struct wb_cycle_calibration *calibration, double part,
                               char name[WB_BUDGET_TEXT], double *known);

/* Whether the tests have such a row: one without a counterweight has none of it. */
bool wb_cycle_budget_has(const struct wb_cycle_calibration *calibration, enum wb_contribution row);

/* "gain of the load cell, 0.5 %"; of one that no file states "free length, not stated: per 1 %". */
void wb_cycle_budget_row(const struct wb_cycle_calibration *calibration, enum wb_contribution row,
                         char name[WB_BUDGET_TEXT]);
/* A standard uncertainty of the logarithm; of one that no file states what 1 % of it does, of the
 * markers 0.1 mm, and *is_stated is false. NaN: unknown. */
double wb_cycle_budget_cell(const struct wb_budget *budget, enum wb_contribution row,
                            bool *is_stated);

/* Appends an object for each number to an array. */
void wb_cycle_budget_put(struct wb_json *array, const struct wb_cycle_calibration *calibration);

/* Mean of a candidate's number over the specimens (of the logarithms), and their deviation or the
 * pooled one of the settings; no interval. */
void wb_cycle_average(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                      enum wb_cycle_number number,
                      const struct wb_cycle_calibrate_settings *settings,
                      struct wb_estimate *estimate);

/* The chosen law's number with its budget and interval, and the range over the candidates that
 * count, each with two standard errors of its fits. */
void wb_cycle_estimate(const struct wb_cycle_calibration *calibration, enum wb_cycle_number number,
                       const struct wb_cycle_calibrate_settings *settings,
                       struct wb_estimate *estimate, struct wb_budget *budget);

#endif
