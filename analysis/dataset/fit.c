#include "analysis/dataset/fit.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_statistics_double.h>

#include "base/memory.h"

bool wb_fit_line(const double *x, const double *y, size_t n, struct wb_fit_line *line)
{
    double c00, c01, c11, squares;
    if (n < 3)
        return false;
    gsl_fit_linear(x, 1, y, 1, n, &line->value, &line->slope, &c00, &c01, &c11, &squares);
    line->value_deviation = sqrt(c00);
    line->slope_deviation = sqrt(c11);
    line->residual = sqrt(squares / (double)(n - 2));
    return isfinite(line->value) && isfinite(line->slope);
}

bool wb_fit_parabola(const double *x, const double *y, size_t n, double c[3], double *deviation)
{
    if (n < 4)
        return false;
    gsl_matrix *const design = wb_memory_need(gsl_matrix_alloc(n, 3));
    gsl_matrix *const covariance = wb_memory_need(gsl_matrix_alloc(3, 3));
    gsl_multifit_linear_workspace *const work = wb_memory_need(gsl_multifit_linear_alloc(n, 3));
    gsl_vector_view coefficients = gsl_vector_view_array(c, 3);
    gsl_vector_const_view values = gsl_vector_const_view_array(y, n);
    double squares;
    for (size_t i = 0; i < n; i++) {
        gsl_matrix_set(design, i, 0, 1.0);
        gsl_matrix_set(design, i, 1, x[i]);
        gsl_matrix_set(design, i, 2, x[i] * x[i]);
    }
    const bool fitted = gsl_multifit_linear(design, &values.vector, &coefficients.vector,
                                            covariance, &squares, work) == GSL_SUCCESS &&
                        isfinite(c[0]) && isfinite(c[1]) && isfinite(c[2]);
    *deviation = sqrt(gsl_matrix_get(covariance, 0, 0));
    gsl_multifit_linear_free(work);
    gsl_matrix_free(covariance);
    gsl_matrix_free(design);
    return fitted;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void wb_fit_sort(double *values, size_t n)
{
    qsort(values, n, sizeof *values, compare_doubles);
}

double wb_fit_median(double *values, size_t n)
{
    if (n == 0)
        return (double)NAN;
    wb_fit_sort(values, n);
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct wb_fit_band wb_fit_band(double *values, size_t n, double tail)
{
    wb_fit_sort(values, n);
    return (struct wb_fit_band){
        .median = gsl_stats_quantile_from_sorted_data(values, 1, n, 0.5),
        .low = gsl_stats_quantile_from_sorted_data(values, 1, n, tail),
        .high = gsl_stats_quantile_from_sorted_data(values, 1, n, 1.0 - tail),
    };
}

double wb_fit_usual_size(double *sizes, size_t n)
{
    return 1.4826 * wb_fit_median(sizes, n);
}

static double value_at(const double *values, size_t stride, size_t i)
{
    return *(const double *)((const char *)values + i * stride);
}

size_t wb_fit_first_at(const double *values, size_t stride, size_t n, double at)
{
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (value_at(values, stride, middle) < at)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

double wb_fit_between(double t, double t0, double v0, double t1, double v1)
{
    const double part = t1 > t0 ? (t - t0) / (t1 - t0) : 0.0;
    return (1.0 - part) * v0 + part * v1;
}

size_t wb_fit_branch_end(const double *values, size_t stride, size_t n, size_t begin, double back)
{
    size_t farthest = begin;
    for (size_t i = begin; i < n; i++) {
        const double way = value_at(values, stride, i) - value_at(values, stride, farthest);
        const double ahead = back > 0.0 ? way : -way;
        if (ahead >= 0.0)
            farthest = i;
        else if (-ahead > fabs(back))
            return farthest + 1;
    }
    return n;
}

/* By bisection, because gsl_cdf_fdist_Qinv() (GSL 2.7.1) is NaN for some degrees of freedom, such
 * as 11 and 1602. */
double wb_fit_fisher_limit(double level, double numerator, double denominator)
{
    double low = -700.0, high = 700.0; /* of ln F */
    while (high - low > 1e-13 * fmax(1.0, fabs(low))) {
        const double middle = 0.5 * (low + high);
        if (gsl_cdf_fdist_Q(exp(middle), numerator, denominator) > level)
            low = middle;
        else
            high = middle;
    }
    return exp(high);
}
