#include "analysis/calibration/cycle/cycle_sensitivity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "calibrate"

/* Change of what is shared: so large that the fits' ends, which are known to a few 1e-4, tell it,
 * and so small that the answer is linear. */
static const double change = 0.02;

static const struct shared {
    const char *name, *key;
} names[WB_SHARED] = {
    [WB_SHARED_GAIN] = {"gain of the load cell", "cell_gain"},
    [WB_SHARED_LENGTH] = {"free length", "length"},
    [WB_SHARED_COUNTERWEIGHT] = {"counterweight", "counterweight"},
    [WB_SHARED_DIAMETER] = {"diameter", "diameter"},
};

const char *wb_cycle_shared_name(enum wb_cycle_shared shared)
{
    return names[shared].name;
}

/* The numbers that are compared. */
struct numbers {
    struct wb_bending bending;
    double moment;
};

static enum wb_status fit(const struct wb_cycle_calibration *calibration,
                          const struct wb_cycle_data *data,
                          const struct wb_cycle_calibrate_settings *settings,
                          struct numbers *numbers, bool *is_fitted)
{
    const struct wb_law *const start =
        &calibration->members[0].answers[calibration->chosen].fit.law;
    const double diameter = data->info.outer_diameter, largest = calibration->largest_curvature;
    struct wb_cycle_grid grid = {.last_strain = 0.5 * diameter * largest};
    struct wb_cycle_fit found = {.tension = NULL};
    struct wb_reason why = {""};
    if (start->form == WB_LAW_PARALLEL) {
        const double ratio = start->parts[1].yield_strain / start->parts[0].yield_strain;
        /* As the calibration would space them: strains go with the inverse square of the length. */
        const double longer = data->info.length / calibration->members[0].data.info.length;
        grid.first_strain = start->parts[0].yield_strain / (longer * longer);
        grid.last_strain = grid.first_strain * pow(ratio, start->n_parts - 1);
    }
    enum wb_status status =
        wb_cycle_fit_run(&found, data, calibration->chosen, start, &grid, &settings->fit, &why);
    *is_fitted = status == WB_OK && found.is_converged;
    if (status == WB_ERR_CONVERGENCE)
        return WB_OK;
    if (status == WB_OK)
        status = wb_bending_describe(&found.law, diameter, largest, &numbers->bending);
    if (status == WB_OK)
        status = wb_bending_moments(&found.law, diameter, 1, &largest, &numbers->moment);
    wb_cycle_fit_release(&found);
    return status == WB_OK ? WB_OK : wb_fail(status, "no sensitivities: %s", why.text);
}

/* The specimen as it would be with the cell's gain, the length or the counterweight changed. */
static void alter(struct wb_cycle_data *data, const struct wb_cycle_point *points,
                  enum wb_cycle_shared shared)
{
    const double factor = 1.0 + change;
    memcpy(data->points, points, (size_t)data->n_points * sizeof *points);
    if (shared == WB_SHARED_LENGTH)
        data->info.length *= factor;
    if (shared == WB_SHARED_COUNTERWEIGHT)
        data->info.counterweight *= factor;
    if (shared != WB_SHARED_GAIN)
        return;
    for (int i = 0; i < data->n_points; i++)
        data->points[i].tension *= factor;
    data->max_force *= factor;
}

static double per_percent(double altered, double base)
{
    return log(altered / base) / log1p(change);
}

static enum wb_status find(const struct wb_cycle_calibration *calibration,
                           const struct wb_cycle_calibrate_settings *settings,
                           struct wb_cycle_point *points,
                           struct wb_cycle_sensitivity sensitivities[WB_SHARED])
{
    const struct wb_cycle_data *const data = &calibration->members[0].data;
    struct numbers base, altered;
    bool is_fitted;
    WB_TRY(fit(calibration, data, settings, &base, &is_fitted));
    for (int i = 0; i < WB_SHARED_DIAMETER && is_fitted; i++) {
        struct wb_cycle_data changed = *data;
        bool has_fitted;
        if (i == WB_SHARED_COUNTERWEIGHT && !(data->info.counterweight > 0.0))
            continue;
        changed.points = points;
        alter(&changed, data->points, (enum wb_cycle_shared)i);
        WB_TRY(fit(calibration, &changed, settings, &altered, &has_fitted));
        if (!has_fitted)
            continue;
        struct wb_cycle_sensitivity *const s = &sensitivities[i];
        s->rigidity = s->modulus =
            per_percent(altered.bending.flexural_rigidity, base.bending.flexural_rigidity);
        s->moment = per_percent(altered.moment, base.moment);
        if (calibration->has_unloading)
            s->springback = per_percent(altered.bending.springback, base.bending.springback);
    }
    return WB_OK;
}

enum wb_status wb_cycle_sensitivity_find(const struct wb_cycle_calibration *calibration,
                                         const struct wb_cycle_calibrate_settings *settings,
                                         struct wb_cycle_sensitivity sensitivities[WB_SHARED])
{
    const double unknown = (double)NAN;
    for (int i = 0; i < WB_SHARED; i++)
        sensitivities[i] = (struct wb_cycle_sensitivity){unknown, unknown, unknown, unknown};
    sensitivities[WB_SHARED_DIAMETER] = (struct wb_cycle_sensitivity){0.0, -4.0, 0.0, 0.0};
    /* Who stopped does not wait for more fits. */
    if (calibration->is_stopped)
        return WB_OK;
    const size_t n = (size_t)calibration->members[0].data.n_points;
    struct wb_cycle_point *const points = wb_memory_new(n, sizeof *points);
    const enum wb_status status = find(calibration, settings, points, sensitivities);
    free(points);
    return status;
}

void wb_cycle_sensitivity_put(struct wb_json *array,
                              const struct wb_cycle_sensitivity sensitivities[WB_SHARED])
{
    for (int i = 0; i < WB_SHARED; i++) {
        struct wb_json *const item = wb_json_append_object(array);
        wb_json_set_text(item, "of", names[i].key);
        wb_json_set_number(item, "flexural_rigidity", sensitivities[i].rigidity);
        wb_json_set_number(item, "youngs_modulus", sensitivities[i].modulus);
        wb_json_set_number(item, "largest_moment", sensitivities[i].moment);
        wb_json_set_number(item, "springback_ratio", sensitivities[i].springback);
    }
}
