/* Standard uncertainties of calibrated properties from the scatter between samples.
 *
 * Jackknife: each sample is left out once and the others are calibrated again, from the optimum of
 * all; the deviation is sqrt((n - 1)/n sum (theta_i - mean)^2). E and sigma_Y come from eqs. 10 and
 * 11 as ever; K and n are refitted by Gauss-Newton steps with Levenberg's damping, which need some
 * fifteen runs a sample, where a simplex would need dozens and, with a looser tolerance, stop early
 * in the narrow valley that K and n share.
 */
#ifndef WB_ANALYSIS_JACKKNIFE_H
#define WB_ANALYSIS_JACKKNIFE_H

#include "analysis/calibrate.h"
#include "analysis/dataset.h"
#include "base/status.h"

/* deviation: of E, sigma_Y, ln K, n in SI; NaN where it cannot be told: with one sample, or when
 * leaving one out made the data unusable, or (K and n) a refit did not settle. `optimum` is the
 * calibrated law of all. *evaluations is increased by the beam runs made. */
WB_MUST_CHECK enum wb_status wb_jackknife_run(double deviation[4],
                                              const struct wb_dataset *const *datasets, int n,
                                              const struct wb_calibrate_settings *settings,
                                              const struct wb_material *optimum, int *evaluations);

#endif
