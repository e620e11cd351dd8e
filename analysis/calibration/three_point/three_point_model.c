#include "analysis/calibration/three_point/three_point_model.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_spline.h>

#include "base/memory.h"
#include "fe/rod/section.h"

enum {
    STEPS = 36, /* most steps of the loading, */
    BACK = 24   /* and of the unloading */
};

/* The first step of the unloading, as part of the deflection; and the part of the remaining steps
 * in which a linear extrapolation of the force would reach zero, because the force decreases ever
 * more slowly. */
static const double first_back = 0.01, slower = 0.6;

/* rad: largest natural bend of a wire over the span, above which it does not rest on the
 * rollers. */
static const double most_bent = 1.0;

/* One branch by increasing travel, with a monotonic interpolation of its points. */
struct branch {
    int n;
    double travel[STEPS + 1], force[STEPS + 1];
    gsl_spline *spline;
    gsl_interp_accel *accel;
};

struct wb_three_point_model {
    struct wb_test_info info;
    struct wb_three_point_bending *bending;
    double natural_curvature;
    struct branch up, back;
};

static void create_branch(struct branch *branch, int n)
{
    branch->n = n;
    branch->spline = wb_memory_need(gsl_spline_alloc(gsl_interp_steffen, (size_t)n));
    branch->accel = wb_memory_need(gsl_interp_accel_alloc());
}

static void release_branch(struct branch *branch)
{
    gsl_spline_free(branch->spline);
    gsl_interp_accel_free(branch->accel);
}

enum wb_status wb_three_point_model_create(struct wb_three_point_model **out,
                                           const struct wb_test_info *info,
                                           const struct wb_three_point_bench *bench,
                                           const struct wb_law *law, int n_elements)
{
    struct wb_section section = {0};
    *out = NULL;
    struct wb_three_point_model *const model = wb_memory_new(1, sizeof *model);
    create_branch(&model->up, STEPS + 1);
    create_branch(&model->back, BACK + 1);
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
    if (status == WB_OK)
        *out = model;
    else
        wb_three_point_model_destroy(model);
    return status;
}

void wb_three_point_model_destroy(struct wb_three_point_model *model)
{
    if (!model)
        return;
    wb_three_point_bending_destroy(model->bending);
    release_branch(&model->up);
    release_branch(&model->back);
    free(model);
}

double wb_three_point_model_curvature(const struct wb_test_info *info, double bow)
{
    return 8.0 * bow / (info->length * info->length);
}

static double uniform_curvature(void *context, double from_middle)
{
    const struct wb_three_point_model *const model = context;
    (void)from_middle;
    return model->natural_curvature;
}

/* Computes one equilibrium; *reached is false if it was not found. */
static enum wb_status add(struct wb_three_point_model *model, struct branch *branch, int at,
                          double deflection, struct wb_three_point_run *run, bool *reached)
{
    struct wb_three_point_bending_point point;
    WB_TRY(wb_three_point_bending_move(model->bending, deflection, &point));
    run->end = point.end;
    *reached = point.end == WB_THREE_POINT_BENDING_CONVERGED;
    if (!*reached)
        return WB_OK;
    branch->travel[at] = point.travel;
    branch->force[at] = point.force;
    run->travel = fmax(run->travel, point.travel);
    run->largest_curvature = fmax(run->largest_curvature, point.middle_curvature);
    run->wrapped = fmax(run->wrapped, point.wrapped);
    return WB_OK;
}

static enum wb_status run_loading(struct wb_three_point_model *model, double deflection,
                                  struct wb_three_point_run *run, bool *reached)
{
    struct branch *const up = &model->up;
    up->travel[0] = up->force[0] = 0.0;
    for (int i = 1; i <= STEPS; i++) {
        /* Smaller steps at the start, where the curvature of the curve is largest. */
        const double part = (double)i / STEPS;
        WB_TRY(add(model, up, i, deflection * part * (0.35 + 0.65 * part), run, reached));
        /* A machine that is more compliant than the wire would snap through. */
        *reached = *reached && up->travel[i] > up->travel[i - 1];
        if (!*reached)
            return WB_OK;
    }
    *reached = gsl_spline_init(up->spline, up->travel, up->force, STEPS + 1) == GSL_SUCCESS;
    return WB_OK;
}

/* Interpolates the unloading, whose points are in the order of the test; false if they do not allow
 * it. */
static bool interpolate_unloading(struct branch *back)
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

/* Steps to where the nose leaves the wire, at which the curve has a kink and ends. */
static enum wb_status run_unloading(struct wb_three_point_model *model, double deflection,
                                    struct wb_three_point_run *run, bool *reached)
{
    struct branch *const back = &model->back;
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
    run->residual = wb_three_point_bending_contact_level(model->bending);
    *reached = *reached && interpolate_unloading(back);
    return WB_OK;
}

enum wb_status wb_three_point_model_run(struct wb_three_point_model *model,
                                        const struct wb_law *law, double natural_curvature,
                                        double deflection, bool with_unloading,
                                        struct wb_three_point_run *run)
{
    bool reached = false;
    *run = (struct wb_three_point_run){.end = WB_THREE_POINT_BENDING_NOT_CONVERGED,
                                       .residual = (double)NAN};
    if (!(fabs(natural_curvature) * model->info.length < most_bent))
        return WB_OK;
    if (natural_curvature != model->natural_curvature) {
        model->natural_curvature = natural_curvature;
        WB_TRY(wb_three_point_bending_set_curvature(model->bending, uniform_curvature, model));
    }
    WB_TRY(wb_three_point_bending_set_law(model->bending, law));
    gsl_interp_accel_reset(model->up.accel);
    gsl_interp_accel_reset(model->back.accel);
    WB_TRY(run_loading(model, deflection, run, &reached));
    if (reached && with_unloading)
        WB_TRY(run_unloading(model, deflection, run, &reached));
    run->reached = reached;
    return WB_OK;
}

double wb_three_point_model_stiffness(const struct wb_three_point_model *model, double travel,
                                      bool is_unloading)
{
    const struct branch *const branch = is_unloading ? &model->back : &model->up;
    const double *const x = branch->travel, *const y = branch->force;
    const int last = branch->n - 1;
    if (travel <= x[0])
        return 0.0;
    if (travel >= x[last])
        return (y[last] - y[last - 1]) / (x[last] - x[last - 1]);
    return gsl_spline_eval_deriv(branch->spline, travel, branch->accel);
}

double wb_three_point_model_force(const struct wb_three_point_model *model, double travel,
                                  bool is_unloading)
{
    const struct branch *const branch = is_unloading ? &model->back : &model->up;
    const double *const x = branch->travel, *const y = branch->force;
    const int last = branch->n - 1;
    if (travel <= x[0])
        return y[0];
    if (travel >= x[last])
        return y[last] +
               (travel - x[last]) * wb_three_point_model_stiffness(model, travel, is_unloading);
    return gsl_spline_eval(branch->spline, travel, branch->accel);
}
