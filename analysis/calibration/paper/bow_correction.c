#include "analysis/calibration/paper/bow_correction.h"

#include <stdlib.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "calibrate"

/* Adds 1/n of a sample's computed curve to `mean`. */
static enum wb_status add_sample(double *mean, double *value, const struct wb_bow_samples *samples,
                                 const struct wb_test_info *info,
                                 const struct wb_material *material, struct wb_reason *why)
{
    const struct wb_curve *const curve = samples->curve;
    struct wb_computed *computed;
    int reached = 0;
    WB_TRY(wb_computed_create(&computed, info, material, samples->how));
    enum wb_status status =
        wb_computed_curve(computed, material, curve->n, curve->step, value, &reached);
    wb_computed_destroy(computed);
    if (status == WB_OK && reached < curve->n)
        status = wb_fail_to(why, WB_ERR_CONVERGENCE,
                            "wire '%s', sample %d: the beam converges only up to %.3g of the "
                            "curve, so the effect of its bow on E cannot be determined",
                            info->wire, info->sample, (double)reached / curve->n);
    for (int i = 0; status == WB_OK && i < curve->n; i++)
        mean[i] += value[i] / samples->n;
    return status;
}

enum wb_status wb_bow_correction_guess(struct wb_first_guess *guess,
                                       const struct wb_bow_samples *samples,
                                       const struct wb_material *material, int *evaluations,
                                       struct wb_reason *why)
{
    const size_t points = (size_t)samples->curve->n;
    double *const mean = wb_memory_new(2 * points, sizeof *mean);
    enum wb_status status = WB_OK;
    for (int i = 0; status == WB_OK && i < samples->n; i++) {
        status =
            add_sample(mean, mean + points, samples, &samples->datasets[i]->info, material, why);
        ++*evaluations;
    }
    if (status == WB_OK) {
        struct wb_curve computed = *samples->curve;
        computed.value = mean;
        status = wb_first_guess_run(guess, &computed, &samples->datasets[0]->info,
                                    samples->elastic_zone, samples->yield_point, why);
    }
    free(mean);
    return status;
}
