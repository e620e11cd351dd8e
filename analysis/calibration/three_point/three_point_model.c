#include "analysis/calibration/three_point/three_point_model.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_spline.h>

#include "base/memory.h"
#include "fe/rod/section.h"

#define WB_LOG_DOMAIN "three-point"

enum {
    STEPS = 36, /* of the way up, */
    BACK = 24   /* and of the unloading, at most */
};

/* The first step of the unloading, as a part of the deflection; and for how much of the steps that
 * are left the rest of it would do, going on as it falls: it falls ever more slowly. */
static const double first_back = 0.01, slower = 0.6;

/* Bent by nature beyond this over the span, rad, a wire does not lie on rollers. */
static const double most_bent = 1.0;

/* One way by growing travel, with a curve through its points that does not overshoot. */
struct way {
    int n;
    double travel[STEPS + 1], force[STEPS + 1];
    gsl_spline *spline;
    gsl_interp_accel *accel;
};

struct wb_three_point_model {
    struct wb_test_info info;
    struct wb_three_point_bending *bending;
    double natural_curvature;
    struct way up, back;
};

static void take_way(struct way *way, int n)
{
    way->n = n;
    way->spline = wb_memory_need(gsl_spline_alloc(gsl_interp_steffen, (size_t)n));
    way->accel = wb_memory_need(gsl_interp_accel_alloc());
}

static void release_way(struct way *way)
{
    gsl_spline_free(way->spline);
    gsl_interp_accel_free(way->accel);
}

enum wb_status wb_three_point_model_create(struct wb_three_point_model **out,
                                           const struct wb_test_info *info,
                                           const struct wb_three_point_bench *bench,
                                           const struct wb_law *law, int n_elements)
{
    struct wb_section section = {0};
    *out = NULL;
    struct wb_three_point_model *const model = wb_memory_new(1, sizeof *model);
    take_way(&model->up, STEPS + 1);
    take_way(&model->back, BACK + 1);
    model->info = *info;
    enum wb_status status = wb_section_init_law(&section, info->outer_diameter, law, 0);
    if (status == WB_OK) {
        const struct wb_three_point_bending_model how = {
            .section = &section,
            .diameter = info->outer_diameter,
            .span = info->length,
            .support_radius = info->machine.roller_radius,
            .nose_radius = bench->nose_radius,
            .friction = bench->friction,
            .compliance = bench->compliance,
            .n_elements = n_elements,
        };
        status = wb_three_point_bending_create(&model->bending, &how);
        wb_section_release(&section);
    }
    if (status != WB_OK) {
        wb_three_point_model_destroy(model);
        return status;
    }
    *out = model;
    return WB_OK;
}

void wb_three_point_model_destroy(struct wb_three_point_model *model)
{
    if (!model)
        return;
    wb_three_point_bending_destroy(model->bending);
    release_way(&model->up);
    release_way(&model->back);
    free(model);
}

double wb_three_point_model_curvature(const struct wb_test_info *info, double bow)
{
    return 8.0 * bow / (info->length * info->length);
}

static double evenly(void *context, double from_middle)
{
    const struct wb_three_point_model *const model = context;
    (void)from_middle;
    return model->natural_curvature;
}

/* One equilibrium; false when it is not reached. */
static enum wb_status add(struct wb_three_point_model *model, struct way *way, int at,
                          double deflection, struct wb_three_point_run *run, bool *reached)
{
    struct wb_three_point_bending_point point;
    WB_TRY(wb_three_point_bending_move(model->bending, deflection, &point));
    run->end = point.end;
    *reached = point.end == WB_THREE_POINT_BENDING_CONVERGED;
    if (!*reached)
        return WB_OK;
    way->travel[at] = point.travel;
    way->force[at] = point.force;
    run->travel = fmax(run->travel, point.travel);
    run->largest_curvature = fmax(run->largest_curvature, point.middle_curvature);
    run->wrapped = fmax(run->wrapped, point.wrapped);
    return WB_OK;
}

static enum wb_status go_up(struct wb_three_point_model *model, double deflection,
                            struct wb_three_point_run *run, bool *reached)
{
    struct way *const up = &model->up;
    up->travel[0] = up->force[0] = 0.0;
    for (int i = 1; i <= STEPS; i++) {
        /* Denser at the start, where the curve bends most. */
        const double part = (double)i / STEPS;
        WB_TRY(add(model, up, i, deflection * part * (0.35 + 0.65 * part), run, reached));
        /* A machine that gives way more than the wire bends would snap. */
        *reached = *reached && up->travel[i] > up->travel[i - 1];
        if (!*reached)
            return WB_OK;
    }
    *reached = gsl_spline_init(up->spline, up->travel, up->force, STEPS + 1) == GSL_SUCCESS;
    return WB_OK;
}

/* Whether a curve goes through the points of the unloading, which come as the nose moves. */
static bool draw_back(struct way *back)
{
    for (int i = 0, k = back->n - 1; i < k; i++, k--) {
        const double travel = back->travel[i], force = back->force[i];
        back->travel[i] = back->travel[k];
        back->force[i] = back->force[k];
        back->travel[k] = travel;
        back->force[k] = force;
    }
    if ((unsigned)back->n < gsl_interp_type_min_size(gsl_interp_steffen))
        return false;
    gsl_spline_free(back->spline);
    back->spline = wb_memory_need(gsl_spline_alloc(gsl_interp_steffen, (size_t)back->n));
    return gsl_spline_init(back->spline, back->travel, back->force, (size_t)back->n) == GSL_SUCCESS;
}

/* Steps that come to where the nose leaves the wire, which is a kink: the curve ends there. */
static enum wb_status go_back(struct wb_three_point_model *model, double deflection,
                              struct wb_three_point_run *run, bool *reached)
{
    struct way *const back = &model->back;
    double at = deflection, step = first_back * deflection;
    bool has_left = false;
    WB_TRY(add(model, back, 0, at, run, reached));
    for (int i = 1; i <= BACK && *reached && !has_left; i++) {
        at = i < BACK ? fmax(0.0, at - step) : 0.0;
        WB_TRY(add(model, back, i, at, run, reached));
        if (!*reached)
            return WB_OK;
        const double force = back->force[i], fallen = back->force[i - 1] - force;
        has_left = !(force > 0.0) || at == 0.0;
        if (!(force > 0.0))
            back->travel[i] = wb_three_point_bending_contact_level(model->bending);
        back->n = i + 1;
        if (fallen > 0.0 && i < BACK)
            step = force / fallen * (back->travel[i - 1] - back->travel[i]) / (slower * (BACK - i));
    }
    run->left = wb_three_point_bending_contact_level(model->bending);
    *reached = *reached && draw_back(back);
    return WB_OK;
}

enum wb_status wb_three_point_model_run(struct wb_three_point_model *model,
                                        const struct wb_law *law, double natural_curvature,
                                        double deflection, bool with_way_back,
                                        struct wb_three_point_run *run)
{
    bool reached = false;
    *run = (struct wb_three_point_run){.end = WB_THREE_POINT_BENDING_NOT_CONVERGED,
                                       .left = (double)NAN};
    if (!(fabs(natural_curvature) * model->info.length < most_bent))
        return WB_OK;
    if (natural_curvature != model->natural_curvature) {
        model->natural_curvature = natural_curvature;
        WB_TRY(wb_three_point_bending_set_curvature(model->bending, evenly, model));
    }
    WB_TRY(wb_three_point_bending_set_law(model->bending, law));
    gsl_interp_accel_reset(model->up.accel);
    gsl_interp_accel_reset(model->back.accel);
    WB_TRY(go_up(model, deflection, run, &reached));
    if (reached && with_way_back)
        WB_TRY(go_back(model, deflection, run, &reached));
    run->reached = reached;
    return WB_OK;
}

double wb_three_point_model_stiffness(const struct wb_three_point_model *model, double travel,
                                      bool is_unloading)
{
    const struct way *const way = is_unloading ? &model->back : &model->up;
    const double *const x = way->travel, *const y = way->force;
    const int last = way->n - 1;
    if (travel <= x[0])
        return 0.0;
    if (travel >= x[last])
        return (y[last] - y[last - 1]) / (x[last] - x[last - 1]);
    return gsl_spline_eval_deriv(way->spline, travel, way->accel);
}

double wb_three_point_model_force(const struct wb_three_point_model *model, double travel,
                                  bool is_unloading)
{
    const struct way *const way = is_unloading ? &model->back : &model->up;
    const double *const x = way->travel, *const y = way->force;
    const int last = way->n - 1;
    if (travel <= x[0])
        return y[0];
    if (travel >= x[last])
        return y[last] +
               (travel - x[last]) * wb_three_point_model_stiffness(model, travel, is_unloading);
    return gsl_spline_eval(way->spline, travel, way->accel);
}
