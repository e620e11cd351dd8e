#include "analysis/calibration/cycle/cycle_shared.h"

#include "base/memory.h"
#include "base/units.h"

static const struct shared {
    const char *name, *key;
    double change;
} shared[WB_SHARED] = {
    [WB_SHARED_GAIN] = {"gain of the load cell", "cell_gain", 1e-3},
    [WB_SHARED_LENGTH] = {"free length", "length", 5e-4},
    [WB_SHARED_COUNTERWEIGHT] = {"counterweight", "counterweight", 1e-3},
    [WB_SHARED_DENSITY] = {"density", "density", 2e-3},
    [WB_SHARED_MARKERS] = {"marker offset", "marker_offset", 0.01 * WB_MM},
    [WB_SHARED_RELAXATION] = {"relaxation, no dwell recorded", "relaxation", 1e-2},
    [WB_SHARED_DIAMETER] = {"diameter", "diameter", 1e-3},
};

const char *wb_cycle_shared_name(enum wb_cycle_shared of)
{
    return shared[of].name;
}

const char *wb_cycle_shared_key(enum wb_cycle_shared of)
{
    return shared[of].key;
}

double wb_cycle_shared_change(enum wb_cycle_shared of)
{
    return shared[of].change;
}

bool wb_cycle_shared_applies(const struct wb_cycle_data *data, enum wb_cycle_shared of)
{
    if (of == WB_SHARED_COUNTERWEIGHT)
        return data->info.counterweight > 0.0;
    if (of == WB_SHARED_RELAXATION)
        return !data->info.is_simulation && data->n_held == 0 && data->n_points > 0 &&
               wb_cycle_data_loading_time(data) > 0.0;
    return true;
}

double wb_cycle_shared_uncertainty(const struct wb_cycle_data *data, double relaxation_prior,
                                   enum wb_cycle_shared of)
{
    const struct wb_test_info *const info = &data->info;
    const struct wb_test_uncertainty *const u = &info->uncertainty;
    switch (of) {
    case WB_SHARED_GAIN:
        return u->gain;
    case WB_SHARED_LENGTH:
        return u->length / info->length;
    case WB_SHARED_COUNTERWEIGHT:
        return info->counterweight > 0.0 ? u->counterweight / info->counterweight : 0.0;
    case WB_SHARED_DENSITY:
        return u->density;
    case WB_SHARED_MARKERS:
        return u->marker_offset;
    case WB_SHARED_RELAXATION:
        return relaxation_prior;
    default:
        return u->diameter / info->outer_diameter;
    }
}

bool wb_cycle_shared_alter(struct wb_cycle_data *altered, const struct wb_cycle_data *data,
                           enum wb_cycle_shared of, double change)
{
    const double longer = of == WB_SHARED_LENGTH ? change * data->info.length : 0.0;
    const double lower = of == WB_SHARED_MARKERS ? change : 0.0;
    if (of == WB_SHARED_DIAMETER || !wb_cycle_shared_applies(data, of))
        return false;
    *altered = *data;
    altered->points = wb_memory_new((size_t)data->n_points, sizeof *data->points);
    altered->places = wb_memory_new((size_t)data->n_places, sizeof *data->places);
    for (int i = 0; i < data->n_points; i++) {
        altered->points[i] = data->points[i];
        altered->points[i].deflection -= lower;
        if (of == WB_SHARED_GAIN)
            altered->points[i].tension *= 1.0 + change;
    }
    for (int i = 0; i < data->n_held && of == WB_SHARED_GAIN; i++)
        altered->held[i].tension *= 1.0 + change;
    altered->top -= lower;
    /* A change of length is hidden in the clamp, whose edge is the origin of the places. */
    for (int i = 0; i < data->n_places; i++) {
        altered->places[i] = data->places[i];
        altered->places[i].s += longer;
        altered->places[i].x += longer;
        altered->places[i].y -= lower;
    }
    altered->info.length += longer;
    if (of == WB_SHARED_COUNTERWEIGHT)
        altered->info.counterweight *= 1.0 + change;
    if (of == WB_SHARED_DENSITY)
        altered->info.mass_per_length *= 1.0 + change;
    return true;
}
