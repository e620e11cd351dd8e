#include "analysis/calibration/cycle/cycle_budget.h"

#include <math.h>
#include <stdio.h>

#include <gsl/gsl_cdf.h>

#include "analysis/keys/row.h"
#include "base/units.h"

static const double coverage = 0.95;
/* Logarithms below this are round-off: the chosen law compared with itself. */
static const double round_off = 1e-12;
/* Width of a candidate's range on either side, in standard errors of its fit. */
static const double range_errors = 2.0;
/* Largest half width of a logarithm, a factor of ten: beyond it the linearised errors are
 * meaningless. */
static const double largest_range = 2.3;
/* Degrees of freedom of an uncertainty that is itself uncertain by 25 % (JCGM 100:2008, G.4.2). */
static const double known_to_a_quarter = 8.0;

static const struct own {
    const char *name, *key;
} own[WB_FROM_SHARED] = {
    [WB_FROM_SPECIMENS] = {"scatter between specimens", "specimens"},
    [WB_FROM_FIT] = {"uncertainty of the fits", "fits"},
    [WB_FROM_LAW] = {"form of the law", "law"},
};

/* Changes for which the effect of an unstated uncertainty is printed. */
static const double unit_part = 0.01, unit_distance = 0.1 * WB_MM;

/* Standard uncertainty of the extrapolation of a stiffness below the data, over the change by the
 * extrapolation. */
static const double unknown_part = 0.5;

/* Laws with a misfit of at most this many times the best fit nearly as well. The weights, which
 * assume that residuals are noise, would exclude such laws even where every law has a systematic
 * misfit. */
static const double as_good = 1.3;

/* A residual curvature is at most the largest curvature, and a deflection springs back at most
 * completely. */
static double largest_value(enum wb_cycle_number number)
{
    return number == WB_CYCLE_RESIDUAL_CURVATURE || number == WB_CYCLE_SPRINGBACK
               ? 1.0
               : (double)INFINITY;
}

static bool is_pooled(const struct wb_cycle_calibration *calibration)
{
    return calibration->pooled_deviation > 0.0 && calibration->pooled_degrees > 0;
}

void wb_cycle_average(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                      enum wb_cycle_number number, struct wb_estimate *estimate)
{
    const double unknown = (double)NAN;
    const int n = calibration->n_members;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++) {
        const double x = log(calibration->members[i].answers[candidate].value[number]);
        sum += x;
        squares += x * x;
    }
    const double mean = sum / n;
    *estimate = (struct wb_estimate){exp(mean), unknown, unknown, unknown, unknown, unknown};
    if (is_pooled(calibration))
        estimate->deviation = calibration->pooled_deviation;
    else if (n > 1)
        estimate->deviation = sqrt(fmax(0.0, squares - n * mean * mean) / (n - 1));
}

static double mean_of(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                      enum wb_cycle_number number)
{
    struct wb_estimate mean;
    wb_cycle_average(calibration, candidate, number, &mean);
    return mean.value;
}

/* Root mean square over the specimens. */
static double fit_error(const struct wb_cycle_calibration *calibration, enum wb_candidate candidate,
                        enum wb_cycle_number number)
{
    double squares = 0.0;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_answer *const answer = &calibration->members[i].answers[candidate];
        squares += answer->error[number] * answer->error[number];
    }
    return fmin(sqrt(squares / calibration->n_members), largest_range);
}

/* Uncertainty of the mean from the scatter, at least the one that the errors of the fits imply:
 * three specimens have agreed within 0.03 % by chance. */
static void add_scatter(const struct wb_cycle_calibration *calibration, double deviation,
                        struct wb_budget *budget)
{
    const int n = calibration->n_members;
    const double error = budget->uncertainty[WB_FROM_FIT];
    budget->uncertainty[WB_FROM_SPECIMENS] = fmax(deviation, error) / sqrt(n);
    budget->degrees[WB_FROM_SPECIMENS] = deviation < error        ? known_to_a_quarter
                                         : is_pooled(calibration) ? calibration->pooled_degrees
                                                                  : n - 1;
    if (!isfinite(deviation))
        budget->uncertainty[WB_FROM_SPECIMENS] = (double)NAN;
}

/* Mean of a stiffness at the smallest curvature that the data resolve, N m2. */
static double resolved_mean(const struct wb_cycle_calibration *calibration,
                            const struct wb_cycle_stiffness *stiffness, enum wb_cycle_number first)
{
    return mean_of(calibration, calibration->chosen,
                   (enum wb_cycle_number)((int)first + wb_cycle_stiffness_resolved(stiffness)));
}

/* Extrapolation by the law below the smallest curvature that the data resolve: distance of the
 * logarithm of a stiffness from its value there. 0 within the data. */
static double beyond_data(const struct wb_cycle_calibration *calibration,
                          enum wb_cycle_number number, double value)
{
    const struct wb_cycle_stiffness *const s = &calibration->secant, *const u =
                                                                         &calibration->unloading;
    const double secant = resolved_mean(calibration, s, WB_CYCLE_FIRST_SECANT);
    const double unloading =
        u->n > 0 ? resolved_mean(calibration, u, WB_CYCLE_FIRST_UNLOADING) : (double)NAN;
    const int moment = (int)number - WB_CYCLE_FIRST_MOMENT;
    const int k = (int)number - WB_CYCLE_FIRST_SECANT, unloading_index = k - WB_CYCLE_STIFFNESSES;
    if (number == WB_CYCLE_RIGIDITY)
        return fmin(fabs(log(value / secant)), fabs(log(value / unloading)));
    if (unloading_index >= 0)
        return u->curvature[unloading_index] < u->resolved ? fabs(log(value / unloading)) : 0.0;
    if (k >= 0)
        return s->curvature[k] < s->resolved ? fabs(log(value / secant)) : 0.0;
    if (moment >= 0 && calibration->curvature[moment] < s->resolved)
        return fabs(log(value / calibration->curvature[moment] / secant));
    return 0.0;
}

/* Relative error of the force's change just after the turn, which is also that of the stiffness
 * there: root mean square over the specimens. */
static double miss_at_turn(const struct wb_cycle_calibration *calibration,
                           enum wb_cycle_number number)
{
    double squares = 0.0;
    int n = 0;
    for (int i = 0; i < calibration->n_members && number >= WB_CYCLE_FIRST_UNLOADING; i++) {
        const double miss = calibration->members[i].answers[calibration->chosen].fit.turn_miss;
        squares += isfinite(miss) ? miss * miss : 0.0;
        n += isfinite(miss);
    }
    return n > 0 ? sqrt(squares / n) : 0.0;
}

/* Adds the uncertainty of the form of the law. Three contributions: the larger of the weighted
 * distance of the other laws from the chosen one and the width of a rectangular distribution over
 * the laws that fit nearly as well; the misfit of the chosen law just after the turn; and a part of
 * its extrapolation below the data. */
static void add_form(const struct wb_cycle_calibration *calibration, enum wb_cycle_number number,
                     double value, struct wb_budget *budget)
{
    double squares = 0.0, low = 0.0, high = 0.0;
    for (int i = 0; i < calibration->n_ranked; i++) {
        const struct wb_cycle_rank *const rank = &calibration->ranked[i];
        const double off = log(mean_of(calibration, rank->candidate, number) / value);
        if (!isfinite(off) || fabs(off) < round_off)
            continue;
        squares += rank->weight * off * off;
        if (rank->misfit <= as_good * calibration->ranked[0].misfit) {
            low = fmin(low, off);
            high = fmax(high, off);
        }
    }
    squares = fmax(squares, (high - low) * (high - low) / 12.0);
    const double alone = unknown_part * beyond_data(calibration, number, value);
    const double missed = miss_at_turn(calibration, number);
    budget->uncertainty[WB_FROM_LAW] = sqrt(squares + alone * alone + missed * missed);
    budget->degrees[WB_FROM_LAW] = known_to_a_quarter;
}

/* Root mean square over the specimens, which may come from several benches; 0 if one of them does
 * not state it. */
static double stated(const struct wb_cycle_calibration *calibration, enum wb_cycle_shared shared)
{
    double squares = 0.0;
    int n = 0;
    for (int i = 0; i < calibration->n_members; i++) {
        const struct wb_cycle_data *const data = &calibration->members[i].data;
        const double u = wb_cycle_shared_uncertainty(data, calibration->relaxation_prior, shared);
        if (!wb_cycle_shared_applies(data, shared))
            continue;
        if (!(u > 0.0))
            return 0.0;
        squares += u * u;
        n++;
    }
    return n > 0 ? sqrt(squares / n) : 0.0;
}

static void add_shared(const struct wb_cycle_calibration *calibration, enum wb_cycle_number number,
                       struct wb_budget *budget)
{
    const int n = calibration->n_members;
    for (int s = 0; s < WB_SHARED; s++) {
        const double u = stated(calibration, s);
        double effect = 0.0;
        for (int i = 0; i < n; i++)
            effect += calibration->members[i].answers[calibration->chosen].effect[s][number] / n;
        budget->effect[s] = effect;
        budget->uncertainty[WB_FROM_SHARED + s] = u > 0.0 ? fabs(effect) * u : (double)NAN;
        budget->degrees[WB_FROM_SHARED + s] = (double)INFINITY;
    }
}

/* Combines the contributions, with the degrees of freedom by Welch and Satterthwaite (JCGM
 * 100:2008, G.2b). Unknown contributions are left out. */
static void combine(struct wb_budget *budget)
{
    double squares = 0.0, fourths = 0.0;
    for (int i = 0; i < WB_CONTRIBUTIONS; i++) {
        const double u = budget->uncertainty[i];
        if (!isfinite(u))
            continue;
        squares += u * u;
        fourths += u * u * u * u / budget->degrees[i];
    }
    budget->combined = sqrt(squares);
    budget->effective_degrees = squares * squares / fourths;
    const double tail = 0.5 * (1.0 - coverage);
    budget->factor = isfinite(budget->effective_degrees)
                         ? gsl_cdf_tdist_Qinv(tail, fmax(1.0, budget->effective_degrees))
                         : gsl_cdf_ugaussian_Qinv(tail);
}

void wb_cycle_estimate(const struct wb_cycle_calibration *calibration, enum wb_cycle_number number,
                       struct wb_estimate *estimate, struct wb_budget *budget)
{
    wb_cycle_average(calibration, calibration->chosen, number, estimate);
    budget->uncertainty[WB_FROM_FIT] = fit_error(calibration, calibration->chosen, number);
    budget->degrees[WB_FROM_FIT] = known_to_a_quarter;
    add_scatter(calibration, estimate->deviation, budget);
    add_form(calibration, number, estimate->value, budget);
    add_shared(calibration, number, budget);
    combine(budget);
    const double half = fmin(budget->factor * budget->combined, largest_range);
    estimate->low = estimate->value * exp(-half);
    estimate->high = fmin(estimate->value * exp(half), largest_value(number));

    estimate->candidates_low = estimate->candidates_high = estimate->value;
    for (int i = 0; i < calibration->n_ranked; i++) {
        const enum wb_candidate candidate = calibration->ranked[i].candidate;
        if (!calibration->ranked[i].counts)
            continue;
        const double other = mean_of(calibration, candidate, number);
        const double error =
            fmin(range_errors * fit_error(calibration, candidate, number), largest_range);
        estimate->candidates_low = fmin(estimate->candidates_low, other * exp(-error));
        estimate->candidates_high = fmax(estimate->candidates_high, other * exp(error));
    }
    estimate->candidates_high = fmin(estimate->candidates_high, largest_value(number));
}

/* --- output --- */

int wb_cycle_budget_columns(const struct wb_cycle_calibration *c,
                            struct wb_budget_column columns[WB_BUDGET_COLUMNS])
{
    const int moments[] = {1, WB_CYCLE_MOMENTS - 1};
    int n = 0;
    for (int i = 0; i < 2; i++) {
        columns[n].number = WB_CYCLE_FIRST_MOMENT + moments[i];
        snprintf(columns[n++].name, WB_BUDGET_TEXT, "M at %.3g /m", c->curvature[moments[i]]);
    }
    if (c->unloading.n > 0) {
        const int k = wb_cycle_stiffness_near_one(&c->unloading);
        columns[n].number = WB_CYCLE_FIRST_UNLOADING + k;
        snprintf(columns[n++].name, WB_BUDGET_TEXT, "unloading over %.3g /m",
                 c->unloading.curvature[k]);
    }
    const int k = wb_cycle_stiffness_near_one(&c->secant);
    columns[n].number = WB_CYCLE_FIRST_SECANT + k;
    snprintf(columns[n++].name, WB_BUDGET_TEXT, "secant to %.3g /m", c->secant.curvature[k]);
    if (c->has_unloading) {
        columns[n].number = WB_CYCLE_RESIDUAL_CURVATURE;
        snprintf(columns[n++].name, WB_BUDGET_TEXT, "residual curvature ratio");
    }
    return n;
}

static void take_worse(const struct wb_budget *budget, const char *name, char worst[WB_BUDGET_TEXT],
                       double *known)
{
    const double U = expm1(budget->factor * budget->combined);
    if (U <= *known)
        return;
    *known = U;
    snprintf(worst, WB_BUDGET_TEXT, "%s", name);
}

bool wb_cycle_budget_is_within(const struct wb_cycle_calibration *c, double part,
                               char name[WB_BUDGET_TEXT], double *known)
{
    char text[WB_BUDGET_TEXT];
    *known = 0.0;
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        snprintf(text, sizeof text, "M at %.3g /m", c->curvature[k]);
        take_worse(&c->budget[WB_CYCLE_FIRST_MOMENT + k], text, name, known);
    }
    if (c->has_unloading) {
        const int k = wb_cycle_stiffness_near_one(&c->unloading);
        snprintf(text, sizeof text, "the unloading stiffness over %.3g /m",
                 c->unloading.curvature[k]);
        take_worse(&c->budget[WB_CYCLE_FIRST_UNLOADING + k], text, name, known);
        take_worse(&c->budget[WB_CYCLE_RESIDUAL_CURVATURE], "residual curvature ratio", name,
                   known);
    }
    if (!isfinite(c->rigidity.deviation)) {
        snprintf(name, WB_BUDGET_TEXT, "the scatter between specimens");
        *known = (double)INFINITY;
    }
    return *known <= part;
}

bool wb_cycle_budget_has(const struct wb_cycle_calibration *calibration, enum wb_contribution row)
{
    bool has = row < WB_FROM_SHARED;
    for (int i = 0; i < calibration->n_members && !has; i++)
        has = wb_cycle_shared_applies(&calibration->members[i].data, row - WB_FROM_SHARED);
    return has;
}

void wb_cycle_budget_row(const struct wb_cycle_calibration *calibration, enum wb_contribution row,
                         char name[WB_BUDGET_TEXT])
{
    if (row < WB_FROM_SHARED) {
        snprintf(name, WB_BUDGET_TEXT, "%s", own[row].name);
        return;
    }
    const enum wb_cycle_shared shared = row - WB_FROM_SHARED;
    const bool is_distance = shared == WB_SHARED_MARKERS;
    const double u = stated(calibration, shared), unit = is_distance ? WB_MM : 0.01;
    const double by = is_distance ? unit_distance : unit_part;
    snprintf(name, WB_BUDGET_TEXT, "%s, %s%.2g %s", wb_cycle_shared_name(shared),
             u > 0.0 ? "" : "not stated: per ", (u > 0.0 ? u : by) / unit,
             is_distance ? "mm" : "%");
}

double wb_cycle_budget_cell(const struct wb_budget *budget, enum wb_contribution row,
                            bool *is_stated)
{
    *is_stated = row < WB_FROM_SHARED || isfinite(budget->uncertainty[row]);
    if (*is_stated)
        return budget->uncertainty[row];
    const enum wb_cycle_shared shared = row - WB_FROM_SHARED;
    return fabs(budget->effect[shared]) * (shared == WB_SHARED_MARKERS ? unit_distance : unit_part);
}

#define BUDGET(member) WB_AT(struct wb_budget, member)

static const struct wb_key contribution_rows[] = {
    {"of", TEXT,
     "source of the uncertainty: `specimens`, `fits`, `law`, or what all specimens share"},
    {"standard_uncertainty", NUMBER | UNKNOWN, "of the logarithm of the quantity"},
    {"degrees_of_freedom", NUMBER | UNKNOWN, "degrees of freedom; null: infinite"},
    {"sensitivity", NUMBER | UNKNOWN | OPTIONAL,
     "change of the logarithm by a relative change of what all specimens share"},
    {"sensitivity_1_mm", NUMBER | UNKNOWN | OPTIONAL,
     "change of the logarithm by a change of the marker offset"},
};
static WB_KEYS(contribution, "contribution", "A contribution to the uncertainty of a quantity.");

static const struct wb_key wb_cycle_budget_rows[] = {
    {"quantity", TEXT, "the quantity",
     .choices = "flexural_rigidity|residual_curvature_ratio|loop_energy|"
                "deflection_springback|moment|secant_stiffness|"
                "unloading_stiffness"},
    {"curvature_1_m", NUMBER | UNKNOWN, "curvature; null: the quantity has none"},
    {"standard_uncertainty", BUDGET(combined) | UNKNOWN,
     "combined standard uncertainty of the logarithm of the quantity"},
    {"degrees_of_freedom", BUDGET(effective_degrees) | UNKNOWN,
     "effective degrees of freedom; null: infinite"},
    {"coverage_factor", BUDGET(factor) | UNKNOWN, "coverage factor for 95 %"},
    {"contributions", OBJECT | LIST, "contributions", &contribution_keys},
};
WB_KEYS(wb_cycle_budget, "budget", "The uncertainty budget of a quantity.");

static void put_budget(struct wb_json *array, const char *quantity, double curvature,
                       const struct wb_budget *budget)
{
    struct wb_json *const object = wb_json_append_object(array);
    wb_json_set_text(object, "quantity", quantity);
    wb_json_set_number(object, "curvature_1_m", curvature);
    WB_PUT(object, &wb_cycle_budget_keys, struct wb_budget, budget);
    struct wb_json *const items = wb_json_set_array(object, "contributions");
    for (int i = 0; i < WB_CONTRIBUTIONS; i++) {
        struct wb_json *const item = wb_json_append_object(items);
        const enum wb_cycle_shared shared = i - WB_FROM_SHARED;
        wb_json_set_text(item, "of", i < WB_FROM_SHARED ? own[i].key : wb_cycle_shared_key(shared));
        wb_json_set_number(item, "standard_uncertainty", budget->uncertainty[i]);
        wb_json_set_number(item, "degrees_of_freedom", budget->degrees[i]);
        if (shared == WB_SHARED_MARKERS)
            wb_json_set_number(item, "sensitivity_1_mm", budget->effect[shared] * WB_MM);
        else if (i >= WB_FROM_SHARED)
            wb_json_set_number(item, "sensitivity", budget->effect[shared]);
    }
}

void wb_cycle_budget_put(struct wb_json *array, const struct wb_cycle_calibration *c)
{
    const double none = (double)NAN;
    put_budget(array, "flexural_rigidity", none, &c->budget[WB_CYCLE_RIGIDITY]);
    if (c->has_unloading) {
        put_budget(array, "residual_curvature_ratio", none,
                   &c->budget[WB_CYCLE_RESIDUAL_CURVATURE]);
        put_budget(array, "loop_energy", none, &c->budget[WB_CYCLE_LOOP_ENERGY]);
        put_budget(array, "deflection_springback", none, &c->budget[WB_CYCLE_SPRINGBACK]);
    }
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        put_budget(array, "moment", c->curvature[k], &c->budget[WB_CYCLE_FIRST_MOMENT + k]);
    for (int k = 0; k < c->secant.n; k++)
        put_budget(array, "secant_stiffness", c->secant.curvature[k],
                   &c->budget[WB_CYCLE_FIRST_SECANT + k]);
    for (int k = 0; k < c->unloading.n; k++)
        put_budget(array, "unloading_stiffness", c->unloading.curvature[k],
                   &c->budget[WB_CYCLE_FIRST_UNLOADING + k]);
}
