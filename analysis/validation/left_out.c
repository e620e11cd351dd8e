#include "analysis/validation/left_out.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fe/trial/bending3p.h"

#define WB_LOG_DOMAIN "validation"

enum {
    STEPS = 48 /* of a computed loading */
};

struct curve {
    int n;
    double travel[STEPS + 1], force[STEPS + 1];
};

static double interpolate(const struct curve *curve, double at)
{
    for (int i = 1; i < curve->n; i++) {
        const double a = curve->travel[i - 1], b = curve->travel[i];
        if (at <= b && b > a)
            return curve->force[i - 1] +
                   fmax(0.0, at - a) / (b - a) * (curve->force[i] - curve->force[i - 1]);
    }
    return curve->force[curve->n - 1];
}

/* The loading's points; *n of them. */
static double way_of(const struct wb_bend3p_member *member, int i)
{
    return member->data.points[i].travel - member->data.first_contact;
}

static int count_loading(const struct wb_bend3p_member *member)
{
    int n = 0;
    while (n < member->data.n_points && !member->data.points[n].is_unloading)
        n++;
    return n;
}

static double force_of(const struct wb_bend3p_member *member, double at)
{
    const int n = count_loading(member);
    int i = 1;
    while (i + 1 < n && way_of(member, i) < at)
        i++;
    const double a = way_of(member, i - 1), b = way_of(member, i);
    const double before = member->data.points[i - 1].force;
    return before + (at - a) / (b - a) * (member->data.points[i].force - before);
}

/* --- the model --- */

static enum wb_status trace(struct curve *curve, struct wb_bending3p *bending, double to,
                            const struct wb_test_info *info, struct wb_reason *why)
{
    curve->travel[0] = curve->force[0] = 0.0;
    curve->n = 1;
    for (int i = 1; i <= STEPS; i++) {
        struct wb_bending3p_point point;
        const double part = (double)i / STEPS;
        WB_TRY(wb_bending3p_move(bending, to * part * (0.35 + 0.65 * part), &point));
        if (point.end != WB_BENDING3P_CONVERGED)
            return wb_fail_to(why, WB_ERR_CONVERGENCE,
                              "wire '%s': the model of the others comes to %.3g of %.3g mm (%s)",
                              info->wire, curve->travel[i - 1] / WB_MM, to / WB_MM,
                              wb_bending3p_end_name(point.end));
        curve->travel[i] = point.travel;
        curve->force[i] = point.force;
        curve->n = i + 1;
    }
    return WB_OK;
}

static enum wb_status compute(struct curve *curve, const struct wb_bend3p_calibration *c,
                              const struct wb_law *law, double to, int n_elements,
                              struct wb_reason *why)
{
    const struct wb_test_info *const info = &c->members[0].data.info;
    struct wb_section section = {0};
    struct wb_bending3p *bending;
    WB_TRY(wb_section_init_law(&section, info->outer_diameter, law, 0));
    const struct wb_bending3p_model model = {
        .section = &section,
        .diameter = info->outer_diameter,
        .span = info->length,
        .support_radius = info->machine.roller_radius,
        .nose_radius = c->bench.nose_radius,
        .friction = c->bench.friction,
        .compliance = c->bench.compliance,
        .n_elements = n_elements,
    };
    enum wb_status status = wb_bending3p_create(&bending, &model);
    wb_section_release(&section);
    if (status != WB_OK)
        return status;
    status = trace(curve, bending, to, info, why);
    wb_bending3p_destroy(bending);
    return status;
}

/* --- tests left out --- */

static enum wb_status find_grid(struct wb_left_out *r, const struct wb_bend3p_calibration *c,
                                struct wb_reason *why)
{
    double from = 0.0, to = HUGE_VAL;
    for (int i = 0; i < c->n_members; i++) {
        const struct wb_bend3p_member *const m = &c->members[i];
        if (!m->is_fitted)
            continue;
        r->n++;
        from = fmax(from, way_of(m, 0));
        to = fmin(to, way_of(m, count_loading(m) - 1));
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

static void find_scatter(struct wb_left_out *r, const struct wb_bend3p_calibration *c)
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

/* Where the others' fits put the first contact beyond where the readings show it. */
static double contact_of_others(const struct wb_bend3p_calibration *c, int without)
{
    double sum = 0.0;
    int n = 0;
    for (int i = 0; i < c->n_members; i++) {
        if (!c->members[i].is_fitted || i == without)
            continue;
        sum += c->members[i].fit.first_contact - c->members[i].data.first_contact;
        n++;
    }
    return sum / n;
}

static enum wb_status leave_out(struct wb_left_out *r, const struct wb_bend3p_calibration *c, int i,
                                int n_elements, double *squares, struct wb_reason *why)
{
    const double contact = contact_of_others(c, i);
    struct wb_law law;
    struct curve curve;
    wb_bend3p_calibrate_law(c, i, &law);
    WB_TRY(
        compute(&curve, c, &law, r->deflection[WB_LEFT_OUT_GRID - 1] - contact, n_elements, why));
    for (int k = 0; k < WB_LEFT_OUT_GRID; k++) {
        const double model = interpolate(&curve, r->deflection[k] - contact);
        const double test = force_of(&c->members[i], r->deflection[k]);
        const double others = (r->n * r->mean[k] - test) / (r->n - 1);
        r->offset[k] += (model - others) / r->n;
        *squares += pow(model - test, 2);
    }
    return WB_OK;
}

enum wb_status wb_left_out_run(struct wb_left_out *result,
                               const struct wb_bend3p_calibration *calibration, int n_elements,
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
