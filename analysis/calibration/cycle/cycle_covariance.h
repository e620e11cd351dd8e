/* How well the free numbers of a fit to one specimen are known.
 *
 * The covariance is, of the readings, by the jackknife (Tukey 1958), each group of
 * residuals left out once, and of the priors. Where the law's form cannot follow the test, large
 * residuals of one sign stand side by side, and the numbers that hang on them are uncertain; others
 * need not be. What the readings do not reach, as the virgin curve below the curvature that a wire
 * has at zero deflection, hangs on the priors. Of noise alone, groups by sign make a standard error
 * half as large again as it is.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_COVARIANCE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_COVARIANCE_H

#include <stdbool.h>

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "analysis/calibration/cycle/cycle_data.h"

/* Of n free numbers, at most WB_FIT_MOST_FREE: `f` are the residuals at the end of the search, of
 * the points, then of each marker's places with the prior of its offset behind them, then, if
 * `has_held`, of the dwell's periods, then of the other priors; `J` (residuals, n) their slopes.
 * Fills the lower half of `covariance` (n, n). False where it cannot be computed. */
bool wb_cycle_covariance_find(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                              const gsl_matrix *J, gsl_matrix *covariance);

#endif
