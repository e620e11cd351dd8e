/* Uncertainty of the results of a calibration, combined as in the GUM (JCGM 100:2008): standard
 * uncertainties of the logarithm, from the scatter between specimens, from the fits, from the form
 * of the law, and from the stated uncertainties of the quantities that all specimens share.
 *
 * Only the first contribution shrinks with more specimens, because the misfit of the law is the
 * same in all of them.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BUDGET_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BUDGET_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/keys/keys.h"
#include "base/json.h"

/* Results whose budgets are printed: the moment at a tenth of the largest curvature and at the
 * largest one, both stiffnesses at 1 /m or at the largest curvature of the data, and the residual
 * curvature ratio. */
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

/* Whether the expanded uncertainties (95 %) of the moments, of the unloading stiffness over 1 /m
 * and of the residual curvature ratio are at most `part` of their values. `name` receives the
 * result with the largest relative uncertainty, *known this uncertainty. Uncertainties that no file
 * states are not included. Infinite with one specimen, which cannot show how specimens differ. */
bool wb_cycle_budget_is_within(const struct wb_cycle_calibration *calibration, double part,
                               char name[WB_BUDGET_TEXT], double *known);

/* Whether a row applies to the tests; that of the counterweight does not apply to a test without
 * one. */
bool wb_cycle_budget_has(const struct wb_cycle_calibration *calibration, enum wb_contribution row);

/* Label of a row: "gain of the load cell, 0.5 %"; if no file states the uncertainty, "free length,
 * not stated: per 1 %". */
void wb_cycle_budget_row(const struct wb_cycle_calibration *calibration, enum wb_contribution row,
                         char name[WB_BUDGET_TEXT]);
/* Standard uncertainty of the logarithm. If no file states the uncertainty, *is_stated is false and
 * the value is the effect of 1 %, of the markers of 0.1 mm. NaN: unknown. */
double wb_cycle_budget_cell(const struct wb_budget *budget, enum wb_contribution row,
                            bool *is_stated);

/* Keys of an item of `budget`. */
extern const struct wb_keys wb_cycle_budget_keys;

/* Appends an object for each result to an array. */
void wb_cycle_budget_put(struct wb_json *array, const struct wb_cycle_calibration *calibration);

/* Mean of a candidate's result over the specimens (of the logarithms), and their standard deviation
 * or the pooled one; no interval. */
void wb_cycle_average(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                      enum wb_cycle_number number, struct wb_estimate *estimate);

/* Result of the chosen law with its budget and interval, and the range over the candidates that
 * count, each widened by two standard errors of its fits. */
void wb_cycle_estimate(const struct wb_cycle_calibration *calibration, enum wb_cycle_number number,
                       struct wb_estimate *estimate, struct wb_budget *budget);

#endif
