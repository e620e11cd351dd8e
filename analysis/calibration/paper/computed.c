#include "analysis/calibration/paper/computed.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/units.h"
#include "fe/rod/section.h"
#include "fe/trial/cantilever.h"

#define WB_LOG_DOMAIN "computed"

struct wb_computed {
    struct wb_test_info info; /* data of the natural curvature; outlives the cantilever */
    struct wb_section section;
    struct wb_cantilever *cantilever;
    double zero;  /* N, vertical force at zero deflection; 0 of a follower test */
    double at;    /* m: deflection of the last move */
    double begin; /* first value of a curve: zero force, or a follower test's deflection, m */
    struct wb_computed_settings settings;
};

enum wb_status wb_computed_create(struct wb_computed **out, const struct wb_test_info *info,
                                  const struct wb_material *material,
                                  const struct wb_computed_settings *settings)
{
    *out = NULL;
    if (info->is_follower && info->strand_length != 0.0)
        return wb_fail_to(
            settings->why, WB_ERR_ARGUMENT,
            "wire '%s': the test has a follower force and a strand: expected one of them",
            info->wire);
    struct wb_computed *const computed = wb_memory_new(1, sizeof *computed);
    computed->info = *info;
    computed->settings = *settings;
    enum wb_status status = settings->law
                                ? wb_section_init_law(&computed->section, info->outer_diameter,
                                                      settings->law, settings->n_fibres)
                                : wb_section_init_circle(&computed->section, info->outer_diameter,
                                                         material, settings->n_fibres);
    if (status == WB_OK) {
        struct wb_cantilever_model model;
        wb_cantilever_default_model(&model);
        model.section = &computed->section;
        model.length = info->length;
        model.n_elements = settings->n_elements;
        if (!settings->straight && info->n_natural_shape > 0) {
            model.natural_curvature = wb_dataset_natural_curvature;
            model.curvature_context = &computed->info;
        }
        model.strand_length = info->strand_length;
        model.counterweight = info->counterweight;
        model.mass_per_length = info->mass_per_length;
        model.gravity_y = -info->gravity;
        status = wb_cantilever_create(&computed->cantilever, &model, NULL);
    }
    if (status == WB_OK)
        *out = computed;
    else
        wb_computed_destroy(computed);
    return status;
}

struct wb_reason *wb_computed_reason(const struct wb_computed *computed)
{
    return computed->settings.why;
}

void wb_computed_destroy(struct wb_computed *computed)
{
    if (!computed)
        return;
    wb_cantilever_destroy(computed->cantilever);
    wb_section_release(&computed->section);
    free(computed);
}

/* One move; *force is the controlled or resulting force, not zeroed. */
static enum wb_status move(struct wb_computed *computed, enum wb_cantilever_control control,
                           double target, struct wb_cantilever_point *point, double *force,
                           bool *reached)
{
    WB_TRY(wb_cantilever_move(computed->cantilever, control, target, point));
    *force = computed->info.is_follower ? point->follower : point->vertical_force;
    *reached =
        point->end == WB_CANTILEVER_CONVERGED && isfinite(*force) && isfinite(point->deflection);
    return WB_OK;
}

enum wb_status wb_computed_start(struct wb_computed *computed, const struct wb_material *material,
                                 bool *reached)
{
    const bool follows = computed->info.is_follower;
    struct wb_cantilever_point point;
    double force;
    wb_cantilever_reset(computed->cantilever);
    if (computed->settings.law)
        WB_TRY(wb_cantilever_set_law(computed->cantilever, computed->settings.law));
    else
        wb_cantilever_set_materials(computed->cantilever, material);
    wb_cantilever_set_duration(computed->cantilever, (double)INFINITY);
    WB_TRY(move(computed, follows ? WB_CONTROL_FOLLOWER_FORCE : WB_CONTROL_DEFLECTION, 0.0, &point,
                &force, reached));
    computed->at = 0.0;
    if (*reached && point.slack)
        return wb_fail_to(
            computed->settings.why, WB_ERR_DATA,
            "wire '%s', sample %d: with its bow of %.2f mm the computed wire carries the "
            "counterweight above zero deflection, where the strand is slack: the force has no zero",
            computed->info.wire, computed->info.sample, wb_dataset_bow(&computed->info) / WB_MM);
    computed->zero = *reached && !follows ? force : 0.0;
    computed->begin = follows ? point.deflection : 0.0;
    return WB_OK;
}

enum wb_status wb_computed_move(struct wb_computed *computed, double deflection, double *force,
                                bool *reached)
{
    struct wb_cantilever_point point;
    double found;
    if (computed->settings.speed > 0.0)
        wb_cantilever_set_duration(computed->cantilever,
                                   fabs(deflection - computed->at) / computed->settings.speed);
    computed->at = deflection;
    WB_TRY(move(computed,
                computed->info.is_follower ? WB_CONTROL_FOLLOWER_DEFLECTION : WB_CONTROL_DEFLECTION,
                deflection, &point, &found, reached));
    if (*reached)
        *force = found - computed->zero;
    return WB_OK;
}

enum wb_status wb_computed_push(struct wb_computed *computed, double force, double *deflection,
                                bool *reached)
{
    struct wb_cantilever_point point;
    double given;
    if (!computed->info.is_follower)
        return wb_fail_to(computed->settings.why, WB_ERR_ARGUMENT,
                          "wire '%s': the test has no follower force: expected one",
                          computed->info.wire);
    WB_TRY(move(computed, WB_CONTROL_FOLLOWER_FORCE, force, &point, &given, reached));
    if (*reached)
        *deflection = point.deflection;
    return WB_OK;
}

void wb_computed_shape(const struct wb_computed *computed, int n, const double *s, double *x,
                       double *y, double *angle)
{
    wb_cantilever_shape(computed->cantilever, n, s, x, y, angle);
}

enum wb_status wb_computed_curve(struct wb_computed *computed, const struct wb_material *material,
                                 int n, double step, double *values, int *n_reached)
{
    enum wb_status (*const go)(struct wb_computed *, double, double *, bool *) =
        computed->info.is_follower ? wb_computed_push : wb_computed_move;
    bool reached;
    int done = 0;
    WB_TRY(wb_computed_start(computed, material, &reached));
    if (reached)
        values[done++] = computed->begin;
    while (reached && done < n) {
        WB_TRY(go(computed, done * step, &values[done], &reached));
        done += reached;
    }
    *n_reached = done;
    for (int i = done; i < n; i++)
        values[i] = (double)NAN;
    return WB_OK;
}
