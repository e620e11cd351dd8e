#include "analysis/calibration/paper/scatter.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"

/* Measured less computed values of one sample on the grid of the average. */
static enum wb_status sample_difference(double *difference, bool *complete,
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
    /* The average ends at the end of the shortest sample. */
    *complete = one.n >= grid->n;
    enum wb_status status = wb_computed_create(&computed, &dataset->info, material, settings);
    if (status == WB_OK) {
        status = wb_computed_curve(computed, material, grid->n, grid->step, difference, &reached);
        wb_computed_destroy(computed);
    }
    *complete = *complete && reached == grid->n;
    for (int i = 0; status == WB_OK && *complete && i < grid->n; i++)
        difference[i] = one.value[i] - difference[i];
    wb_curve_release(&one);
    return status;
}

enum wb_status wb_scatter_residual(double *rms, const struct wb_dataset *const *datasets, int n,
                                   const struct wb_curve *curve, const struct wb_material *material,
                                   const struct wb_computed_settings *settings)
{
    const size_t points = (size_t)curve->n;
    enum wb_status status = WB_OK;
    bool complete = true;
    if (n < 2) {
        *rms = 0.0;
        return WB_OK;
    }
    double *const differences = wb_memory_new((size_t)n * points, sizeof *differences);
    for (int i = 0; status == WB_OK && complete && i < n; i++)
        status = sample_difference(differences + (size_t)i * points, &complete, datasets[i], curve,
                                   material, settings);
    double sum = 0.0;
    for (size_t k = 0; status == WB_OK && complete && k < points; k++) {
        double mean = 0.0, squares = 0.0;
        for (size_t i = 0; i < (size_t)n; i++)
            mean += differences[i * points + k] / n;
        for (size_t i = 0; i < (size_t)n; i++) {
            const double away = differences[i * points + k] - mean;
            squares += away * away;
        }
        sum += (k == 0 || k == points - 1 ? 0.5 : 1.0) * squares / (n - 1);
    }
    free(differences);
    if (status == WB_OK)
        *rms = complete ? sqrt(sum / (double)(points - 1)) / wb_curve_scale(curve) : (double)NAN;
    return status;
}
