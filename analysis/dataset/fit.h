/* Straight lines and parabolas through measured points, medians, search in sorted values, branches
 * of values that rise and fall, and the limit of an F-test. GSL's error handler, which aborts, must
 * be off. */
#ifndef WB_ANALYSIS_DATASET_FIT_H
#define WB_ANALYSIS_DATASET_FIT_H

#include <stdbool.h>
#include <stddef.h>

/* Least-squares line through n points: value at x = 0, slope, standard errors, standard deviation
 * of the points from the line. */
struct wb_fit_line {
    double value, slope, value_deviation, slope_deviation, residual;
};

/* False with fewer than three points, or where the result is not finite. */
bool wb_fit_line(const double *x, const double *y, size_t n, struct wb_fit_line *line);

/* Least squares of c[0] + c[1] x + c[2] x^2 through n points; `deviation` is the standard error of
 * c[0]. False with fewer than four points, or where the result is not finite. */
bool wb_fit_parabola(const double *x, const double *y, size_t n, double c[3], double *deviation);

/* Ascending. */
void wb_fit_sort(double *values, size_t n);

/* Sorts the values; NaN when n is 0. */
double wb_fit_median(double *values, size_t n);

/* Median and the quantiles `tail` and 1 - `tail` of n (at least 1) values, which are sorted. */
struct wb_fit_band {
    double median, low, high;
};
struct wb_fit_band wb_fit_band(double *values, size_t n, double tail);

/* Robust standard deviation from absolute deviations, by their median (scaled for a normal
 * distribution), so that outliers have little effect. Sorts the deviations; NaN when n is 0. */
double wb_fit_usual_size(double *sizes, size_t n);

/* Value that Fisher's F with these degrees of freedom (1 or more) exceeds with the probability
 * `level`, within (0, 1). */
double wb_fit_fisher_limit(double level, double numerator, double denominator);

/* Index of the first of n ascending values that is not below `at`; n when all are. Each lies
 * `stride` bytes after the one before: in an array of structs, the struct's size. */
size_t wb_fit_first_at(const double *values, size_t stride, size_t n, double at);

/* Linear between v0 at t0 and v1 at t1; v0 if t0 and t1 are equal. */
double wb_fit_between(double t, double t0, double v0, double t1, double v1);

/* Cuts n values, each `stride` bytes after the one before, into branches that rise and fall in
 * turn. The branch from index `begin` ends after its farthest value, once the values have come back
 * from it by more than `back` (negative: of a falling branch). Returns the index of the first value
 * of the next branch; n if the values do not turn. */
size_t wb_fit_branch_end(const double *values, size_t stride, size_t n, size_t begin, double back);

#endif
