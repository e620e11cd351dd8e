#include "analysis/calibration/paper/jackknife.h"

#include <math.h>
#include <stdlib.h>

#include "base/log.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "jackknife"

/* Jackknife deviation of n values. */
static double spread(const double *values, int n)
{
    double mean = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++)
        mean += values[i] / n;
    for (int i = 0; i < n; i++)
        squares += (values[i] - mean) * (values[i] - mean);
    return sqrt((n - 1.0) / n * squares);
}

static enum wb_status leave_each_out(double deviation[4], const struct wb_dataset *const *datasets,
                                     int n, const struct wb_material *optimum,
                                     const struct wb_jackknife_refit *refit, struct wb_reason *why)
{
    enum wb_status status = WB_OK;
    bool all_converged = true;
    const struct wb_dataset **const others = wb_memory_new((size_t)n, sizeof *others);
    double *const values = wb_memory_new(4 * (size_t)n, sizeof *values);
    for (int i = 0; status == WB_OK && i < n; i++) {
        struct wb_material material = *optimum;
        int kept = 0;
        bool converged;
        for (int k = 0; k < n; k++) {
            if (k != i)
                others[kept++] = datasets[k];
        }
        status = refit->run(refit->context, others, kept, &material, &converged, why);
        all_converged = all_converged && converged;
        values[i] = material.youngs_modulus;
        values[n + i] = material.yield_stress;
        values[2 * n + i] = log(material.strength_coefficient / optimum->strength_coefficient);
        values[3 * n + i] = material.hardening_exponent;
    }
    for (int k = 0; status == WB_OK && k < 4; k++)
        deviation[k] = k < 2 || all_converged ? spread(values + k * n, n) : (double)NAN;
    free(others);
    free(values);
    return status;
}

enum wb_status wb_jackknife_run(double deviation[4], const struct wb_dataset *const *datasets,
                                int n, const struct wb_material *optimum,
                                const struct wb_jackknife_refit *refit, struct wb_reason *why)
{
    for (int k = 0; k < 4; k++)
        deviation[k] = (double)NAN;
    if (n < 2)
        return WB_OK;
    /* An error here concerns a subset of the samples: the calibration of all remains valid. */
    struct wb_reason unusable = {.text = ""};
    const enum wb_status status = leave_each_out(deviation, datasets, n, optimum, refit, &unusable);
    if (unusable.text[0])
        wb_warn("%s", unusable.text);
    if (status != WB_OK && status != WB_ERR_DATA)
        return wb_fail_to(why, status, "wire '%s': the uncertainties could not be computed: %s",
                          datasets[0]->info.wire, wb_status_text(status));
    if (status == WB_ERR_DATA)
        wb_warn(
            "wire '%s': no uncertainties, because the specimens are unusable when one of them is "
            "left out",
            datasets[0]->info.wire);
    return WB_OK;
}
