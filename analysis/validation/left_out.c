#include "analysis/validation/left_out.h"

#include <math.h>

#include "analysis/calibration/three_point/three_point_model.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "validation"

/* Deflection of a point of the loading. */
static double deflection_of(const struct wb_three_point_member *member, int i)
{
    return member->data.points[i].travel - member->data.first_contact;
}

static double force_of(const struct wb_three_point_member *member, double at)
{
    return wb_three_point_data_force(&member->data, at + member->data.first_contact, false);
}

/* --- tests left out --- */

static enum wb_status find_grid(struct wb_left_out *r, const struct wb_three_point_calibration *c,
                                struct wb_reason *why)
{
    double from = 0.0, to = HUGE_VAL;
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_three_point_member *const m = &c->members[i];
        if (!m->is_fitted)
            continue;
        r->n++;
        from = fmax(from, deflection_of(m, 0));
        to = fmin(to, deflection_of(m, wb_three_point_data_count_loading(&m->data) - 1));
    }
    if (r->n < 2)
        return wb_fail_to(why, WB_ERR_DATA, "%d of %d tests fitted: none can be left out", r->n,
                          c->n_members);
    if (!(to > from))
        return wb_fail_to(why, WB_ERR_DATA, "the tests have no deflections in common");
    for (int k = 0; k < WB_LEFT_OUT_GRID; k++)
        r->deflection[k] = from + (to - from) * k / (WB_LEFT_OUT_GRID - 1);
    return WB_OK;
}

static void find_scatter(struct wb_left_out *r, const struct wb_three_point_calibration *c)
{
    double squares = 0.0;
    for (int k = 0; k < WB_LEFT_OUT_GRID; k++) {
        double sum = 0.0, spread = 0.0;
        for (int i = 0; i < c->n_members; i++)
            sum += c->members[i].is_fitted ? force_of(&c->members[i], r->deflection[k]) : 0.0;
        r->mean[k] = sum / r->n;
        for (int i = 0; i < c->n_members; i++) {
            if (c->members[i].is_fitted)
                spread += pow(force_of(&c->members[i], r->deflection[k]) - r->mean[k], 2);
        }
        r->deviation[k] = sqrt(spread / (r->n - 1));
        squares += spread / (r->n - 1) / WB_LEFT_OUT_GRID;
        r->of_max_force = fmax(r->of_max_force, r->mean[k]);
    }
    r->scatter = sqrt(squares);
    r->expected = sqrt(r->n / (r->n - 1.0)) * r->scatter;
}

/* Mean difference of the other tests' fitted first contact from the one that the readings show, m;
 * `bow` receives their mean bow. */
static double mean_contact_shift(const struct wb_three_point_calibration *c, int without,
                                 double *bow)
{
    double sum = 0.0, bows = 0.0;
    int n = 0;
    for (int i = 0; i < c->n_members; i++) {
        if (!c->members[i].is_fitted || i == without)
            continue;
        sum += c->members[i].fit.first_contact - c->members[i].data.first_contact;
        bows += c->members[i].fit.bow;
        n++;
    }
    *bow = bows / n;
    return sum / n;
}

static enum wb_status compute(struct wb_three_point_model *model,
                              const struct wb_three_point_calibration *c, const struct wb_law *law,
                              double bow, double to, struct wb_reason *why)
{
    const double curvature = wb_three_point_model_curvature(&c->members[0].data.info, bow);
    struct wb_three_point_run run;
    WB_TRY(wb_three_point_model_run(model, law, curvature, to, false, &run));
    if (!run.reached)
        return wb_fail_to(why, WB_ERR_CONVERGENCE,
                          "wire '%s': the model of the other tests reaches %.3g of %.3g mm (%s)",
                          c->members[0].data.info.wire, run.travel / WB_MM, to / WB_MM,
                          wb_three_point_bending_end_name(run.end));
    return WB_OK;
}

static enum wb_status leave_out(struct wb_left_out *r, const struct wb_three_point_calibration *c,
                                int i, int n_elements, double *squares, struct wb_reason *why)
{
    double bow;
    const double contact = mean_contact_shift(c, i, &bow);
    struct wb_three_point_model *model;
    struct wb_law law;
    wb_three_point_calibrate_law(c, i, &law);
    WB_TRY(
        wb_three_point_model_create(&model, &c->members[0].data.info, &c->bench, &law, n_elements));
    const enum wb_status status =
        compute(model, c, &law, bow, r->deflection[WB_LEFT_OUT_GRID - 1] - contact, why);
    for (int k = 0; k < WB_LEFT_OUT_GRID && status == WB_OK; k++) {
        const double at = wb_three_point_model_force(model, r->deflection[k] - contact, false);
        const double test = force_of(&c->members[i], r->deflection[k]);
        const double others = (r->n * r->mean[k] - test) / (r->n - 1);
        r->offset[k] += (at - others) / r->n;
        *squares += pow(at - test, 2);
    }
    wb_three_point_model_destroy(model);
    return status;
}

enum wb_status wb_left_out_run(struct wb_left_out *result,
                               const struct wb_three_point_calibration *calibration, int n_elements,
                               struct wb_reason *why)
{
    struct wb_left_out r = {.n = 0};
    double squares = 0.0, bias = 0.0;
    WB_TRY(find_grid(&r, calibration, why));
    find_scatter(&r, calibration);
    for (int i = 0; i < calibration->n_members; i++) {
        if (calibration->members[i].is_fitted)
            WB_TRY(leave_out(&r, calibration, i, n_elements, &squares, why));
    }
    for (int k = 0; k < WB_LEFT_OUT_GRID; k++)
        bias += r.offset[k] * r.offset[k] / WB_LEFT_OUT_GRID;
    r.rms = sqrt(squares / r.n / WB_LEFT_OUT_GRID);
    r.bias = sqrt(bias);
    *result = r;
    return WB_OK;
}
