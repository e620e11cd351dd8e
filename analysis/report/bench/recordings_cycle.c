#include "analysis/report/bench/recordings_cycle.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

#include "analysis/bending.h"
#include "analysis/cycle_json.h"
#include "base/interrupt.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

static const double coverage = 0.95;

/* What the interval of a mean of n logarithms is to both sides. */
static double half_width(double deviation, int degrees, int n)
{
    return gsl_cdf_tdist_Qinv(0.5 * (1.0 - coverage), degrees) * deviation / sqrt(n);
}

/* --- the law's line --- */

static enum wb_status draw_curve(struct wb_recordings_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    struct wb_recordings_cycle_curve *const curve = &cycle->curve;
    double sum[WB_RECORDINGS_CYCLE_CURVE] = {0.0}, squares[WB_RECORDINGS_CYCLE_CURVE] = {0.0};
    double moment[WB_RECORDINGS_CYCLE_CURVE];
    const int n = c->n_members, points = WB_RECORDINGS_CYCLE_CURVE;

    /* Close together where the line bends most. */
    for (int k = 0; k < points; k++)
        curve->curvature[k] = c->largest_curvature * pow((double)k / (points - 1), 2.0);
    for (int i = 0; i < n; i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        WB_TRY(wb_bending_moments(&member->answers[c->chosen].fit.law,
                                  member->data.info.outer_diameter, points, curve->curvature,
                                  moment));
        for (int k = 1; k < points; k++) {
            sum[k] += log(moment[k]);
            squares[k] += log(moment[k]) * log(moment[k]);
        }
    }
    curve->moment[0] = curve->low[0] = curve->high[0] = 0.0;
    for (int k = 1; k < points; k++) {
        const double mean = sum[k] / n;
        curve->moment[k] = exp(mean);
        curve->low[k] = curve->high[k] = (double)NAN;
        if (n < 2)
            continue;
        const double s = sqrt(fmax(0.0, squares[k] - n * mean * mean) / (n - 1));
        curve->low[k] = exp(mean - half_width(s, n - 1, n));
        curve->high[k] = exp(mean + half_width(s, n - 1, n));
    }
    return WB_OK;
}

/* --- all of it --- */

static bool go_on(void *context, int done, int all)
{
    (void)context, (void)done, (void)all;
    return !wb_interrupted();
}

enum wb_status wb_recordings_cycle_run(struct wb_recordings_cycle *cycle,
                                       const struct wb_dataset *const *datasets, int n,
                                       struct wb_reason *why)
{
    struct wb_cycle_calibrate_settings settings;
    wb_cycle_calibrate_default_settings(&settings);
    /* Wires are computed side by side already. */
    settings.threads = 1;
    settings.progress = go_on;
    WB_TRY(wb_cycle_calibrate_run(&cycle->calibration, datasets, n, &settings, why));
    const enum wb_status status = draw_curve(cycle);
    if (status != WB_OK)
        wb_recordings_cycle_release(cycle);
    return status;
}

void wb_recordings_cycle_release(struct wb_recordings_cycle *cycle)
{
    wb_cycle_calibrate_release(&cycle->calibration);
}

void wb_recordings_cycle_put(struct wb_json *object, const struct wb_recordings_cycle *cycle)
{
    wb_cycle_json_put(object, &cycle->calibration);
}

/* --- pooled over wires --- */

void wb_recordings_cycle_pool(struct wb_recordings_cycle_pool *pool,
                              const struct wb_recordings_cycle *cycle)
{
    const struct wb_estimate *const rigidity = &cycle->calibration.rigidity;
    const int degrees = cycle->calibration.n_members - 1;
    if (degrees < 1 || !isfinite(rigidity->deviation))
        return;
    pool->deviation += degrees * rigidity->deviation * rigidity->deviation;
    pool->degrees += degrees;
}

void wb_recordings_cycle_close(struct wb_recordings_cycle_pool *pool)
{
    pool->deviation = pool->degrees > 0 ? sqrt(pool->deviation / pool->degrees) : (double)NAN;
}

void wb_recordings_cycle_interval(const struct wb_recordings_cycle_pool *pool,
                                  const struct wb_recordings_cycle *cycle, double *low,
                                  double *high)
{
    const double value = cycle->calibration.rigidity.value;
    *low = *high = (double)NAN;
    if (pool->degrees < 1)
        return;
    const double half = half_width(pool->deviation, pool->degrees, cycle->calibration.n_members);
    *low = value * exp(-half);
    *high = value * exp(half);
}
