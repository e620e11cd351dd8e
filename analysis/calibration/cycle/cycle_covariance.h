/* Covariance of the free parameters of a fit to one specimen.
 *
 * The readings contribute by the jackknife (Tukey 1958), which leaves out each group of residuals
 * once; the priors contribute by their standard deviations. If the form of the law cannot describe
 * the test, neighbouring residuals are large and of one sign, and the parameters that depend on
 * them are uncertain, others are not. Parameters that the readings do not determine, such as the
 * virgin curve below the curvature of the wire at zero deflection, depend on the priors. For pure
 * noise, groups by sign overestimate a standard error by half.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_COVARIANCE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_COVARIANCE_H

#include <stdbool.h>

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>

#include "analysis/calibration/cycle/cycle_data.h"

/* Fills the lower half of the covariance (n, n) of n free parameters, at most WB_FIT_MOST_FREE. `f`
 * are the residuals at the end of the search: of the points, then of each marker's places followed
 * by the prior of its offset, then, if `has_held`, of the dwell's periods, then of the other
 * priors; `J` (residuals, n) is their Jacobian. False if it cannot be computed. */
bool wb_cycle_covariance_find(const struct wb_cycle_data *data, bool has_held, const gsl_vector *f,
                              const gsl_matrix *J, gsl_matrix *covariance);

#endif
