/* Comparison of two calibrated batches: EI, residual curvature ratio and moments, of two suppliers,
 * lots or temperatures, with the scatter of the specimens from their properties files.
 *
 * Means of logarithms over specimens are compared (welch.h), so that the difference is the
 * logarithm of the ratio B over A. Residual curvature ratios and moments are compared at the same
 * curvatures, up to the smaller of the two largest ones: each file's value at its own curvature,
 * times the ratio of the law's values at the two curvatures. Errors that both batches have in
 * common on one bench (gain of the cell, lengths, diameter) cancel in the ratio; errors that differ
 * between two benches do not.
 */
#ifndef WB_ANALYSIS_COMPARE_COMPARE_H
#define WB_ANALYSIS_COMPARE_COMPARE_H

#include <stdbool.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/properties/quantity.h"
#include "analysis/compare/welch.h"
#include "base/json.h"
#include "base/status.h"

enum {
    WB_COMPARE_SIDES = 2,
    WB_COMPARE_QUANTITIES = 3 + WB_CYCLE_MOMENTS
};

/* Significance level of each verdict; the intervals are of 1 - 2 alpha. */
#define WB_COMPARE_ALPHA 0.05

struct wb_compare_quantity {
    char name[WB_QUANTITY_LABEL];  /* including the curvature */
    const struct wb_quantity *row; /* with its unit */
    const char *reason; /* why it is not compared; NULL: compared, and only then the rest is set */
    struct wb_welch_group groups[WB_COMPARE_SIDES]; /* of logarithms of SI values */
    struct wb_welch welch;                          /* of the logarithm of B over A */
    enum wb_verdict_of_groups verdict;
    int more; /* more specimens of each batch for a decision, if undecided (wb_welch_more()) */
};

struct wb_compare {
    double within;    /* limit of the logarithm of the ratio */
    double curvature; /* 1/m, up to which both are measured */
    struct wb_compare_quantity quantities[WB_COMPARE_QUANTITIES];
    int n_compared;
    enum wb_verdict_of_groups verdict; /* overall: different if any is, equivalent if all are */
    int more; /* the largest of the undecided ones; 0: see wb_welch_more() */
};

/* Compares two properties files from calibrations on whole cycles or three-point bending, whose
 * values have intervals; WB_ERR_DATA for others, and if nothing can be compared. `names` are for
 * messages. */
WB_MUST_CHECK enum wb_status wb_compare_run(struct wb_compare *compare,
                                            const struct wb_properties *const *properties,
                                            const char *const *names, double within);

/* "equivalent", "different", "cannot tell". */
const char *wb_compare_word(enum wb_verdict_of_groups verdict);

/* All values, with units in the keys. */
struct wb_json *wb_compare_json(const struct wb_compare *compare,
                                const struct wb_properties *const *properties,
                                const char *const *names);

#endif
