/* Parts of curve.c that tests call by themselves. */
#ifndef WB_ANALYSIS_CURVE_PRIVATE_H
#define WB_ANALYSIS_CURVE_PRIVATE_H

#include "analysis/curve.h"

/* wb_curve_average_on() with a deflection step only; failures are logged. */
WB_MUST_CHECK enum wb_status wb_curve_average(struct wb_curve *curve,
                                              const struct wb_dataset *const *datasets, int n,
                                              double step);

/* Linear interpolation of the mean force at a deflection within 0..max_deflection; NaN outside, and
 * for a follower's curve. */
double wb_curve_force(const struct wb_curve *curve, double deflection);

#endif
