/* Standard uncertainties of calibrated properties from the scatter between samples.
 *
 * Jackknife: each sample is left out once and the others are calibrated again, from the optimum of
 * all; the deviation is sqrt((n - 1)/n sum (theta_i - mean)^2).
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_JACKKNIFE_H
#define WB_ANALYSIS_CALIBRATION_PAPER_JACKKNIFE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/material.h"

/* How samples are calibrated again. */
struct wb_jackknife_refit {
    /* Takes the law of all samples and gives that of these `n`. *settled: K and n were found.
     * WB_ERR_DATA: these samples cannot be calibrated. */
    enum wb_status (*run)(void *context, const struct wb_dataset *const *datasets, int n,
                          struct wb_material *material, bool *settled, struct wb_reason *why);
    void *context;
};

/* deviation: of E, sigma_Y, ln K, n in SI; NaN where it is not known: with one sample, or when
 * the others without one are unusable, or (K and n) when a refit did not settle. `optimum` is the
 * calibrated law of all. `why` receives why it failed; NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_jackknife_run(double deviation[4],
                                              const struct wb_dataset *const *datasets, int n,
                                              const struct wb_material *optimum,
                                              const struct wb_jackknife_refit *refit,
                                              struct wb_reason *why);

#endif
