#include "analysis/calibration/cycle/cycle_model.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"

#define WB_LOG_DOMAIN "cycle"

struct wb_cycle_model {
    const struct wb_cycle_data *data;
    struct wb_test_info info; /* context of the natural curvature */
    struct wb_section section;
    struct wb_cantilever *cantilever;
    int n_followers;
    struct wb_cantilever **followers; /* (n_followers), of neighbours, */
    double *offsets;                  /* and of their deflections, m */
    bool relaxes;                     /* the law has Maxwell elements */
    double t;                         /* s: present time of the cycle */
    double held[WB_CYCLE_MOST_HELD];  /* N */
};

enum wb_status wb_cycle_model_create(struct wb_cycle_model **out, const struct wb_cycle_data *data,
                                     const struct wb_law *law,
                                     const struct wb_cycle_model_settings *settings)
{
    *out = NULL;
    struct wb_cycle_model *const model = wb_memory_new(1, sizeof *model);
    model->data = data;
    model->info = data->info;
    enum wb_status status =
        wb_section_init_law(&model->section, data->info.outer_diameter, law, settings->n_fibres);
    if (status == WB_OK) {
        struct wb_cantilever_model beam;
        wb_cantilever_default_model(&beam);
        beam.section = &model->section;
        beam.length = data->info.length;
        beam.n_elements = settings->n_elements;
        beam.strand_length = data->info.strand_length;
        beam.counterweight = data->info.counterweight;
        beam.mass_per_length = data->info.mass_per_length;
        beam.gravity_y = -data->info.gravity;
        status = wb_cantilever_create(&model->cantilever, &beam, NULL);
        const size_t n = (size_t)settings->n_neighbours;
        model->followers = wb_memory_new(n, sizeof *model->followers);
        model->offsets = wb_memory_new(n, sizeof *model->offsets);
        for (int i = 0; i < settings->n_neighbours && status == WB_OK; i++, model->n_followers++)
            status = wb_cantilever_create(&model->followers[i], &beam, NULL);
    }
    if (status == WB_OK)
        *out = model;
    else
        wb_cycle_model_destroy(model);
    return status;
}

void wb_cycle_model_destroy(struct wb_cycle_model *model)
{
    if (!model)
        return;
    wb_cantilever_destroy(model->cantilever);
    for (int i = 0; i < model->n_followers; i++)
        wb_cantilever_destroy(model->followers[i]);
    free(model->followers);
    free(model->offsets);
    wb_section_release(&model->section);
    free(model);
}

static bool is_reached(const struct wb_cantilever_point *point)
{
    return point->end == WB_CANTILEVER_CONVERGED && isfinite(point->tension);
}

/* Advances the time to a given one, s; NaN: instantaneous. */
static enum wb_status move(struct wb_cycle_model *model, double deflection, double t,
                           struct wb_cantilever_point *point, bool *reached)
{
    if (model->relaxes) {
        const double duration = t - model->t;
        wb_cantilever_set_duration(model->cantilever, duration > 0.0 ? duration : 0.0);
        model->t = t < model->t ? model->t : t;
    }
    WB_TRY(wb_cantilever_move(model->cantilever, WB_CONTROL_DEFLECTION, deflection, point));
    *reached = is_reached(point);
    return WB_OK;
}

void wb_cycle_model_bend(const struct wb_cycle_specimen *specimen, struct wb_test_info *info)
{
    info->n_natural_shape = 2;
    info->natural_shape[0] = specimen->bow_angle + 2.0 * specimen->uneven_angle;
    info->natural_shape[1] = -3.0 * specimen->uneven_angle;
}

/* Curvature at the clamp relative to the natural one, from the rotation of a short piece. */
static double clamp_curvature(const struct wb_cycle_model *model)
{
    const double s[2] = {0.0, model->info.length / 400.0};
    double x[2], y[2], angle[2];
    wb_cantilever_shape(model->cantilever, 2, s, x, y, angle);
    return (angle[1] - angle[0]) / s[1] -
           wb_dataset_natural_curvature((void *)&model->info, 0.5 * s[1]);
}

/* Distance of a place above the axis, along its normal. */
static double distance_of(const struct wb_cantilever *cantilever,
                          const struct wb_cycle_place *place)
{
    double x, y, angle;
    wb_cantilever_shape(cantilever, 1, &place->s, &x, &y, &angle);
    return (place->y - y) * cos(angle) - (place->x - x) * sin(angle);
}

double wb_cycle_model_rest(const struct wb_test_info *info)
{
    return isfinite(info->rest_level) ? fmin(info->rest_level, 0.0) : 0.0;
}

const double *wb_cycle_model_held(const struct wb_cycle_model *model)
{
    return model->held;
}

/* Moves to the turn and holds for the dwell. */
static enum wb_status turn(struct wb_cycle_model *model, double deflection, double *curvature,
                           int n, struct wb_cycle_neighbour *neighbours, bool *reached)
{
    const struct wb_cycle_data *const data = model->data;
    struct wb_cantilever_point point;
    WB_TRY(move(model, deflection, data->arrival, &point, reached));
    *curvature = clamp_curvature(model);
    for (int i = 0; i < data->n_held && *reached; i++) {
        if (model->relaxes)
            WB_TRY(move(model, deflection, data->held[i].t, &point, reached));
        model->held[i] = point.tension;
        for (int k = 0; k < n; k++)
            neighbours[k].held[i] = wb_cantilever_tension(model->followers[k]);
    }
    return model->relaxes && *reached ? move(model, deflection, data->departure, &point, reached)
                                      : WB_OK;
}

/* Time at which the tip left its rest, extrapolated from the first points. It had been at rest for
 * a long time. */
static double time_at_rest(const struct wb_cycle_data *data, double rest)
{
    const struct wb_cycle_point *const p = data->points;
    if (data->n_points < 2)
        return (double)NAN;
    const double speed = (p[1].deflection - p[0].deflection) / (p[1].t - p[0].t);
    return p[0].t - (p[0].deflection - rest) / speed;
}

/* Sets a law and a virgin specimen. Leaves the natural shape of the specimen in model->info. */
static enum wb_status begin(struct wb_cycle_model *model, struct wb_cantilever *cantilever,
                            const struct wb_law *law, const struct wb_cycle_specimen *specimen)
{
    wb_cycle_model_bend(specimen, &model->info);
    WB_TRY(wb_cantilever_set_curvature(cantilever, wb_dataset_natural_curvature, &model->info));
    wb_cantilever_set_duration(cantilever, (double)INFINITY);
    return wb_cantilever_set_law(cantilever, law);
}

static void forget(const struct wb_cycle_data *data, double *tension, double *distance)
{
    for (int i = 0; i < data->n_points; i++)
        tension[i] = (double)NAN;
    for (int i = 0; distance && i < data->n_places; i++)
        distance[i] = (double)NAN;
}

enum wb_status wb_cycle_model_run_beside(struct wb_cycle_model *model, const struct wb_law *law,
                                         const struct wb_cycle_specimen *specimen, double *tension,
                                         double *distance, int n,
                                         struct wb_cycle_neighbour *neighbours,
                                         struct wb_cycle_run *run)
{
    const struct wb_cycle_data *const data = model->data;
    struct wb_cantilever_point point;
    int place = 0;
    bool reached;

    *run = (struct wb_cycle_run){.turn_change = (double)NAN};
    double top = 0.0;
    if (n > model->n_followers)
        return wb_fail(WB_ERR_ARGUMENT, "%d neighbours: expected at most %d", n,
                       model->n_followers);
    for (int k = 0; k < n; k++) {
        struct wb_cycle_neighbour *const neighbour = &neighbours[k];
        WB_TRY(begin(model, model->followers[k], &neighbour->law, &neighbour->specimen));
        forget(data, neighbour->tension, neighbour->distance);
        model->offsets[k] = specimen->level - neighbour->specimen.level;
    }
    WB_TRY(begin(model, model->cantilever, law, specimen));
    forget(data, tension, distance);
    wb_cantilever_lead(model->cantilever, n, model->followers, model->offsets);

    /* The rest carries the tip before the strand does; the load on the wire is the same. */
    const double rest = wb_cycle_model_rest(&data->info);
    model->relaxes = law->n_maxwell > 0;
    model->t = time_at_rest(data, rest);
    WB_TRY(wb_cantilever_move(model->cantilever, WB_CONTROL_DEFLECTION, rest - specimen->level,
                              &point));
    reached = is_reached(&point);
    for (int i = 0; i < data->n_points && reached; i++) {
        WB_TRY(move(model, data->points[i].deflection - specimen->level, data->points[i].t, &point,
                    &reached));
        if (!reached)
            break;
        tension[i] = point.tension;
        for (int k = 0; k < n; k++)
            neighbours[k].tension[i] = wb_cantilever_tension(model->followers[k]);
        const double curvature = clamp_curvature(model);
        if (i == 0)
            run->first_curvature = curvature;
        run->clamp_curvature = fmax(run->clamp_curvature, curvature);
        if (i == data->n_loading)
            run->turn_change = top - curvature;
        for (; distance && place < data->n_places && data->places[place].point == i; place++) {
            distance[place] = distance_of(model->cantilever, &data->places[place]);
            for (int k = 0; k < n; k++)
                neighbours[k].distance[place] =
                    distance_of(model->followers[k], &data->places[place]);
        }
        if (i == data->n_loading - 1 && data->n_points > data->n_loading) {
            WB_TRY(turn(model, data->top - specimen->level, &top, n, neighbours, &reached));
            run->clamp_curvature = fmax(run->clamp_curvature, top);
        }
    }
    run->reached = reached;
    return WB_OK;
}

enum wb_status wb_cycle_model_run(struct wb_cycle_model *model, const struct wb_law *law,
                                  const struct wb_cycle_specimen *specimen, double *tension,
                                  double *distance, struct wb_cycle_run *run)
{
    return wb_cycle_model_run_beside(model, law, specimen, tension, distance, 0, NULL, run);
}
