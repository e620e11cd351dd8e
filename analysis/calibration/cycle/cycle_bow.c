#include "analysis/calibration/cycle/cycle_bow.h"

#include <math.h>

#include "base/units.h"

enum {
    MOST_DOUBLINGS = 5,
    HALVINGS = 20
};

/* Initial half width of the interval in which the angle is sought, about that of the alignment,
 * rad. */
static const double first_reach = 0.02;

static const double unstated_deviation = 0.3 * WB_MM;

/* A number of the alignment's check of the natural shape; false if there is none. */
static bool get_number(const struct wb_dataset *dataset, const char *key, double *value)
{
    const struct wb_json *const checks = wb_json_get(dataset->document, "checks");
    return wb_json_get_number(wb_json_get(checks, "natural_shape"), key, value);
}

double wb_cycle_bow_deviation(const struct wb_dataset *dataset)
{
    double value;
    return get_number(dataset, "bow_uncertainty_mm", &value) && value > 0.0 ? value * WB_MM
                                                                            : unstated_deviation;
}

/* Whether the alignment took the zero of force from the cell without load, so that tensions are
 * absolute. */
static bool is_absolute(const struct wb_dataset *dataset)
{
    double bow;
    return !dataset->info.is_simulation && dataset->info.n_natural_shape > 0 &&
           get_number(dataset, "bow_from_force_mm", &bow);
}

/* Computed minus measured tension of the only point, N; decreases with the angle. NaN: not reached.
 */
static enum wb_status miss_of(double *miss, struct wb_cycle_model *model,
                              const struct wb_cycle_data *data, const struct wb_law *law,
                              double angle)
{
    const struct wb_cycle_specimen specimen = {.bow_angle = angle};
    struct wb_cycle_run run;
    double tension;
    WB_TRY(wb_cycle_model_run(model, law, &specimen, &tension, NULL, &run));
    *miss = tension - data->points[0].tension;
    return WB_OK;
}

static enum wb_status find(double *angle, struct wb_cycle_model *model,
                           const struct wb_cycle_data *data, const struct wb_law *law)
{
    double reach = first_reach, low, high, at_low, at_high;
    for (int i = 0;; i++, reach *= 2.0) {
        low = *angle - reach;
        high = *angle + reach;
        WB_TRY(miss_of(&at_low, model, data, law, low));
        WB_TRY(miss_of(&at_high, model, data, law, high));
        if (at_low >= 0.0 && at_high < 0.0)
            break;
        if (i == MOST_DOUBLINGS)
            return WB_OK;
    }
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        double miss;
        WB_TRY(miss_of(&miss, model, data, law, middle));
        if (!isfinite(miss))
            return WB_OK;
        *(miss < 0.0 ? &high : &low) = middle;
    }
    *angle = 0.5 * (low + high);
    return WB_OK;
}

enum wb_status wb_cycle_bow_find(double *angle, const struct wb_dataset *dataset,
                                 const struct wb_cycle_data *data, const struct wb_law *law,
                                 const struct wb_cycle_model_settings *settings)
{
    struct wb_cycle_data first = *data;
    struct wb_cycle_model *model;
    *angle = 2.0 * wb_dataset_bow(&dataset->info) / dataset->info.length;
    if (!is_absolute(dataset))
        return WB_OK;
    first.n_points = first.n_loading = 1;
    first.n_places = 0;
    WB_TRY(wb_cycle_model_create(&model, &first, law, settings));
    const enum wb_status status = find(angle, model, &first, law);
    wb_cycle_model_destroy(model);
    return status;
}
