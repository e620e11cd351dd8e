/* Errors between a measured and a computed loading curve: eqs. 17 to 19 of the paper, on an equally
 * spaced deflection grid, integrated by the trapezoid rule.
 *
 * F_max is the largest force of the measured (averaged) curve in all errors: the paper divides by
 * F_max without defining it, and its eq. 17 is not normalised. For follower tests, whose curves are
 * deflections over forces, it is the largest deflection. Pure functions; `n` is at least 2 and
 * `step` positive. A NaN in a curve makes the result NaN. */
#ifndef WB_ANALYSIS_DATASET_ERRORS_H
#define WB_ANALYSIS_DATASET_ERRORS_H

/* E_L2 of eq. 17 as printed: square root of the integral of the squared difference, N m^(1/2). */
double wb_errors_l2(int n, double step, const double *measured, const double *computed);

/* The same over F_max sqrt(delta_max): comparable with the RMS of eq. 19, and equal to it on one
 * grid. */
double wb_errors_relative_l2(int n, double step, const double *measured, const double *computed,
                             double max_force);

/* Eq. 18 at each point, into `error` (n). */
void wb_errors_curve(int n, const double *measured, const double *computed, double max_force,
                     double *error);

/* Root mean square of n values of equal spacing by the trapezoid rule: eq. 19 for an error curve of
 * eq. 18. */
double wb_errors_rms(int n, const double *error);

/* Largest of n values; NaN if one is. */
double wb_errors_largest(int n, const double *error);

#endif
