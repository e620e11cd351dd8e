/* A part of curve.c that tests call by itself. */
#ifndef WB_ANALYSIS_CURVE_PRIVATE_H
#define WB_ANALYSIS_CURVE_PRIVATE_H

#include "analysis/curve.h"

/* Linear interpolation of the mean force at a deflection within 0..max_deflection; NaN outside, and
 * for a follower's curve. */
double wb_curve_force(const struct wb_curve *curve, double deflection);

#endif
