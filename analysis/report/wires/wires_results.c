#include "analysis/report/wires/wires_results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/reasons.h"
#include "base/interrupt.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

const struct wb_wires_run *wb_wires_usable(const struct wb_wires_results *results, int index,
                                           enum wb_wires_solver solver)
{
    const struct wb_wires_run *const run = &results->runs[index][solver];
    return run->state == WB_WIRES_USABLE ? run : NULL;
}

/* --- stresses --- */

struct wb_wires_peak wb_wires_find_peak(const struct wb_field *field, int part)
{
    struct wb_wires_peak peak = {.stress = (double)NAN};
    for (int i = 0; field && i < field->n_faces; i++) {
        const struct wb_field_face *const face = &field->faces[i];
        for (int k = 0; k < 8 && face->part == part; k++) {
            const struct wb_field_node *const node = &face->node[k];
            if (node->von_mises <= peak.stress)
                continue;
            peak.stress = node->von_mises;
            memcpy(peak.reference, node->reference, sizeof peak.reference);
            memcpy(peak.position, node->position, sizeof peak.position);
        }
    }
    return peak;
}

static void find_stresses(struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const run =
        wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    const struct wb_wire_model_part *const core =
        &comparison->cases[WB_WIRES_ELASTIC].model->part[0];
    for (int i = 0; run && i < run->fields.n; i++) {
        const struct wb_field *const field = &run->fields.items[i];
        if (isnan(field->x) || strcmp(field->state, comparison->loaded_state) != 0 ||
            results->n_stresses == WB_WIRES_STRESSES)
            continue;
        struct wb_wires_stress *const stress = &results->stresses[results->n_stresses++];
        stress->x = field->x;
        stress->core = wb_wires_find_peak(field, 0);
        stress->jacket = wb_wires_find_peak(field, 1);
        stress->curvature = wb_wires_rod_curvature(&results->exact, field->x);
        stress->beam =
            core->material.youngs_modulus * stress->curvature * 0.5 * core->outer_diameter;
    }
}

/* --- rods --- */

static struct wb_wires_wire wire_of(const struct wb_wires *comparison, int index)
{
    const struct wb_wire_model *const model = comparison->cases[index].model;
    return (struct wb_wires_wire){
        .length = model->length,
        .diameter = model->part[1].outer_diameter,
        .material = {.hardening = WB_HARDENING_NONE_ELASTIC,
                     .youngs_modulus = wb_wire_model_youngs_modulus(model),
                     .poissons_ratio = wb_wire_model_poissons_ratio(model)},
        .force = model->step[model->n_steps - 1].loads.follower[1],
        .n_elements = comparison->fit.n_elements,
        .n_fibres = comparison->fit.n_fibres,
    };
}

static enum wb_status compute_printed(struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    if (!comparison->has_printed_wire)
        return WB_OK;
    struct wb_wires_wire wire = wire_of(comparison, WB_WIRES_ELASTOPLASTIC);
    wire.diameter = comparison->printed_wire.outer_diameter;
    wire.material = comparison->printed_wire.material;
    /* Plastic moment sigma_Y d^3 / 6 of a full circle at the clamp. */
    results->collapse_force =
        wire.material.yield_stress * pow(wire.diameter, 3.0) / 6.0 / wire.length;
    WB_TRY(wb_wires_rod_compute(&results->printed, &wire));
    wire.material.strength_coefficient *= 10.0;
    return wb_wires_rod_compute(&results->tenfold, &wire);
}

static bool go_on(void *context, int evaluation, double error, double size)
{
    (void)context, (void)evaluation, (void)error, (void)size;
    return !wb_interrupted();
}

static enum wb_status calibrate(struct wb_wires_results *results, const struct wb_wires_run *run)
{
    const struct wb_wires *const comparison = results->comparison;
    struct wb_wires_wire wire = wire_of(comparison, WB_WIRES_ELASTOPLASTIC);
    struct wb_calibrate_settings settings = comparison->fit;
    const struct wb_dataset *const dataset = &run->dataset;
    settings.progress = go_on;
    if (comparison->mixture)
        settings.youngs_modulus = wire.material.youngs_modulus;
    WB_TRY(wb_calibrate_run(&results->fit, &dataset, 1, &settings));
    wire.material = results->fit.material;
    const enum wb_status status = wb_wires_rod_compute(&results->fitted, &wire);
    if (status != WB_OK)
        wb_calibrate_result_release(&results->fit);
    return status;
}

static void fit(struct wb_wires_results *results)
{
    const struct wb_wires_run *const run =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    results->fit_state = WB_WIRES_MISSING;
    if (!run) {
        wb_text_append(&results->fit_problem, "the solid's dataset that it builds on is missing");
        return;
    }
    struct wb_reasons reasons = {&results->fit_problem, NULL, NULL};
    wb_reasons_begin(&reasons);
    const enum wb_status status = calibrate(results, run);
    wb_reasons_end();
    results->fit_state = status == WB_OK ? WB_WIRES_USABLE : WB_WIRES_REFUSED;
    if (status == WB_OK)
        wb_text_release(&results->fit_problem);
    else if (results->fit_problem.length == 0)
        wb_text_append(&results->fit_problem, "%s", wb_status_text(status));
}

double wb_wires_split(const struct wb_wire_model *model, double change)
{
    const struct wb_wire_model_part *const core = &model->part[0], *const jacket = &model->part[1];
    const double inner = pow(core->outer_diameter, 4.0);
    return change * core->material.youngs_modulus * inner /
           (pow(jacket->outer_diameter, 4.0) - inner);
}

/* --- comparing --- */

double wb_wires_cost(const struct wb_wires_results *results, int index)
{
    const struct wb_wires_run *const solid = wb_wires_usable(results, index, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod = wb_wires_usable(results, index, WB_WIRES_ROD);
    return solid && rod ? rod->cpu_s / solid->cpu_s : (double)NAN;
}

double wb_wires_tip_error(const struct wb_wires_results *results, const struct wb_wires_run *run)
{
    const int last = WB_WIRES_POINTS - 1;
    const struct wb_wires_rod *const exact = &results->exact;
    const double x = exact->x[last], y = exact->y[last];
    return hypot(hypot(run->tip[0] - x, run->tip[1] - y), run->tip[2]) /
           hypot(x - exact->s[last], y);
}

/* --- all of it --- */

static void judge(struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const solid =
        wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod = wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_ROD);
    const struct wb_wires_run *const both[] = {solid, rod};
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            results->n_wanted += results->runs[i][k].state != WB_WIRES_NOT_WANTED;
            results->n_usable += results->runs[i][k].state == WB_WIRES_USABLE;
        }
    }
    results->is_complete = results->n_usable == results->n_wanted &&
                           results->fit_state == WB_WIRES_USABLE && results->fitted.reached &&
                           (!comparison->has_printed_wire || results->printed.reached);
    /* Compared so that a NaN exceeds. */
    for (int i = 0; i < 2 && comparison->tip_limit > 0.0; i++) {
        if (both[i] && !(wb_wires_tip_error(results, both[i]) <= comparison->tip_limit))
            results->exceeds_limit = true;
    }
    for (int i = 0; i < results->n_stresses && comparison->stress_limit > 0.0; i++) {
        const struct wb_wires_stress *const stress = &results->stresses[i];
        if (!(fabs(stress->core.stress / stress->beam - 1.0) <= comparison->stress_limit))
            results->exceeds_limit = true;
    }
    if (comparison->cost_limit > 0.0 && solid && rod &&
        !(wb_wires_cost(results, WB_WIRES_ELASTIC) <= comparison->cost_limit))
        results->exceeds_limit = true;
}

int wb_wires_count(const struct wb_wires *comparison)
{
    int n = 2;
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            n += comparison->cases[i].datasets[k].wanted;
    }
    return n;
}

struct teller {
    wb_wires_progress *progress;
    void *context;
    int done, total;
};

static void tell(struct teller *teller, const char *what, const char *name)
{
    char text[320];
    snprintf(text, sizeof text, "%s %s", what, name);
    teller->done++;
    if (teller->progress)
        teller->progress(teller->context, teller->done, teller->total, text);
}

static enum wb_status compute(struct wb_wires_results *results, struct teller *teller)
{
    const struct wb_wires *const comparison = results->comparison;
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const struct wb_wires_case *const item = &comparison->cases[i];
            wb_wires_run_load(&results->runs[i][k], item, (enum wb_wires_solver)k);
            if (item->datasets[k].wanted)
                tell(teller, "read", item->datasets[k].name);
        }
    }
    const struct wb_wires_wire elastic = wire_of(comparison, WB_WIRES_ELASTIC);
    wb_wires_rod_exact(&results->exact, &elastic);
    find_stresses(results);
    WB_TRY(compute_printed(results));
    tell(teller, "computed", "the printed properties");
    fit(results);
    tell(teller, "fitted", "the rod");
    return WB_OK;
}

enum wb_status wb_wires_compute(struct wb_wires_results *results, const struct wb_wires *comparison,
                                wb_wires_progress *progress, void *context)
{
    memset(results, 0, sizeof *results);
    results->comparison = comparison;
    struct teller teller = {progress, context, 0, wb_wires_count(comparison)};
    const enum wb_status status = compute(results, &teller);
    if (status != WB_OK) {
        wb_wires_results_release(results);
        return status;
    }
    results->interrupted = wb_interrupted();
    judge(results);
    return WB_OK;
}

void wb_wires_results_release(struct wb_wires_results *results)
{
    for (int i = 0; i < WB_WIRES_CASES; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            wb_wires_run_release(&results->runs[i][k]);
    }
    wb_text_release(&results->fit_problem);
    if (results->fit_state == WB_WIRES_USABLE)
        wb_calibrate_result_release(&results->fit);
    memset(results, 0, sizeof *results);
}
