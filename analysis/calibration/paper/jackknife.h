/* Standard uncertainties of calibrated properties from the scatter between samples.
 *
 * Jackknife: each sample is left out once and the others are calibrated again, starting from the
 * optimum of all; the deviation is sqrt((n - 1)/n sum (theta_i - mean)^2).
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_JACKKNIFE_H
#define WB_ANALYSIS_CALIBRATION_PAPER_JACKKNIFE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/material.h"

/* Calibration of a subset of the samples. */
struct wb_jackknife_refit {
    /* `material` is the law of all samples on entry, and that of these `n` on return. *converged: K
     * and n converged. WB_ERR_DATA: these samples cannot be calibrated. */
    enum wb_status (*run)(void *context, const struct wb_dataset *const *datasets, int n,
                          struct wb_material *material, bool *converged, struct wb_reason *why);
    void *context;
};

/* deviation: of E, sigma_Y, ln K, n in SI; NaN if unknown: with one sample, if a subset is
 * unusable, or (K and n) if a refit did not converge. `optimum` is the calibrated law of all
 * samples. `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_jackknife_run(double deviation[4],
                                              const struct wb_dataset *const *datasets, int n,
                                              const struct wb_material *optimum,
                                              const struct wb_jackknife_refit *refit,
                                              struct wb_reason *why);

#endif
