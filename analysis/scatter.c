#include "analysis/scatter.h"

#include <math.h>
#include <stdlib.h>

#define WB_LOG_DOMAIN "scatter"

/* Measured less computed values of one sample on the grid of the average, into `difference`, and ln
 * of the factor that brings the computed ones nearest to the measured. */
static enum wb_status sample_difference(double *difference, double *ln_factor, bool *complete,
                                        const struct wb_dataset *dataset,
                                        const struct wb_curve *grid,
                                        const struct wb_material *material,
                                        const struct wb_computed_settings *settings)
{
    struct wb_curve one;
    struct wb_computed *computed;
    int reached = 0;
    const struct wb_curve_grid steps = {.step = grid->step, .force_step = grid->step};
    WB_TRY(wb_curve_average_on(&one, &dataset, 1, &steps, settings->why));
    /* The average ends where the shortest sample does. */
    *complete = one.n >= grid->n;
    enum wb_status status = wb_computed_create(&computed, &dataset->info, material, settings);
    if (status == WB_OK) {
        status = wb_computed_curve(computed, material, grid->n, grid->step, difference, &reached);
        wb_computed_destroy(computed);
    }
    *complete = *complete && reached == grid->n;
    double product = 0.0, square = 0.0;
    for (int i = 0; status == WB_OK && *complete && i < grid->n; i++) {
        product += one.value[i] * difference[i];
        square += difference[i] * difference[i];
        difference[i] = one.value[i] - difference[i];
    }
    *ln_factor = product > 0.0 ? log(product / square) : (double)NAN;
    wb_curve_release(&one);
    return status;
}

/* Variance of n numbers that lie `stride` apart. */
static double variance_of(const double *values, int n, size_t stride)
{
    double mean = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++)
        mean += values[(size_t)i * stride] / n;
    for (int i = 0; i < n; i++) {
        const double away = values[(size_t)i * stride] - mean;
        squares += away * away;
    }
    return squares / (n - 1);
}

enum wb_status wb_scatter_find(double *rms, double *amplitude,
                               const struct wb_dataset *const *datasets, int n,
                               const struct wb_curve *curve, const struct wb_material *material,
                               const struct wb_computed_settings *settings)
{
    const size_t points = (size_t)curve->n;
    enum wb_status status = WB_OK;
    bool complete = true;
    *rms = *amplitude = 0.0;
    if (n < 2)
        return WB_OK;
    double *const differences = malloc((size_t)n * (points + 1) * sizeof *differences);
    if (!differences)
        return wb_fail_to(settings->why, WB_ERR_MEMORY, "no memory for %d samples", n);
    double *const ln_factor = differences + (size_t)n * points;
    for (int i = 0; status == WB_OK && complete && i < n; i++)
        status = sample_difference(differences + (size_t)i * points, &ln_factor[i], &complete,
                                   datasets[i], curve, material, settings);
    double sum = 0.0;
    for (size_t k = 0; status == WB_OK && complete && k < points; k++)
        sum += (k == 0 || k == points - 1 ? 0.5 : 1.0) * variance_of(differences + k, n, points);
    if (status == WB_OK) {
        *rms = complete ? sqrt(sum / (double)(points - 1)) / wb_curve_scale(curve) : (double)NAN;
        *amplitude = complete ? sqrt(variance_of(ln_factor, n, 1)) : (double)NAN;
    }
    free(differences);
    return status;
}

enum wb_status wb_scatter_residual(double *rms, const struct wb_dataset *const *datasets, int n,
                                   const struct wb_curve *curve, const struct wb_material *material,
                                   const struct wb_computed_settings *settings)
{
    double amplitude;
    return wb_scatter_find(rms, &amplitude, datasets, n, curve, material, settings);
}
