#include "analysis/report/wires/wires_results.h"

#include <math.h>
#include <string.h>

#include "analysis/report/reasons.h"
#include "base/interrupt.h"

const struct wb_wires_run *wb_wires_usable(const struct wb_wires_results *results, int index,
                                           enum wb_wires_solver solver)
{
    const struct wb_wires_run *const run = &results->runs[index][solver];
    return run->simulation.state == WB_SIMULATION_USABLE ? run : NULL;
}

const struct wb_wires_run *wb_wires_solid_run(const struct wb_wires_results *results, int index)
{
    return wb_wires_usable(results, index, WB_WIRES_SOLID);
}

const struct wb_wires_run *wb_wires_rod_run(const struct wb_wires_results *results, int index)
{
    return wb_wires_usable(results, index, WB_WIRES_ROD);
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
    const struct wb_wires_run *const run = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
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
        .force = wb_wires_force(model),
        .n_elements = comparison->head.fit.n_elements,
        .n_fibres = comparison->head.fit.n_fibres,
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

static enum wb_status calibrate(struct wb_wires_results *results, const struct wb_wires_run *run,
                                struct wb_reason *why)
{
    const struct wb_wires *const comparison = results->comparison;
    struct wb_wires_wire wire = wire_of(comparison, WB_WIRES_ELASTOPLASTIC);
    struct wb_calibrate_settings settings = comparison->head.fit;
    const struct wb_dataset *const dataset = &run->simulation.dataset;
    settings.progress = wb_campaign_go_on;
    if (comparison->mixture)
        settings.youngs_modulus = wire.material.youngs_modulus;
    WB_TRY(wb_calibrate_run(&results->fit, &dataset, 1, &settings, why));
    wire.material = results->fit.material;
    const enum wb_status status = wb_wires_rod_compute(&results->fitted, &wire);
    if (status != WB_OK)
        wb_calibrate_result_release(&results->fit);
    return status;
}

static void fit(struct wb_wires_results *results)
{
    const struct wb_wires_run *const run = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    results->fit_state = WB_SIMULATION_MISSING;
    if (!run) {
        wb_text_append(&results->fit_problem, "the solid's dataset that it builds on is missing");
        return;
    }
    const struct wb_reasons reasons = {&results->fit_problem, NULL, NULL};
    struct wb_reason why = {.text = ""};
    const enum wb_status status = calibrate(results, run, &why);
    results->fit_state = status == WB_OK ? WB_SIMULATION_USABLE : WB_SIMULATION_REFUSED;
    if (status != WB_OK)
        wb_reasons_fail(&reasons, status, &why);
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
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, index);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, index);
    return solid && rod ? rod->simulation.cpu_s / solid->simulation.cpu_s : (double)NAN;
}

bool wb_wires_residual(const struct wb_wires_results *results, double *stress, double *moved)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const without = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    *stress = *moved = (double)NAN;
    for (int i = 0; i < comparison->n_residual; i++) {
        const struct wb_wires_run *const run = wb_wires_solid_run(results, WB_WIRES_RESIDUAL + i);
        if (!run || !without)
            continue;
        const struct wb_field *const field =
            wb_wires_field(run, comparison->residual_state, comparison->section);
        *moved = fmax(*moved, wb_wires_effect(run, without));
        *stress = fmax(*stress, wb_wires_find_peak(field, 0).stress);
    }
    return isfinite(*moved) && isfinite(*stress);
}

/* Distance of a run's tip from the exact elastic one, over that one's displacement; NaN without a
 * run. */
static double tip_error(const struct wb_wires_results *results, const struct wb_wires_run *run)
{
    const int last = WB_WIRES_POINTS - 1;
    const struct wb_wires_rod *const exact = &results->exact;
    const double x = exact->x[last], y = exact->y[last];
    if (!run)
        return (double)NAN;
    return hypot(hypot(run->tip[0] - x, run->tip[1] - y), run->tip[2]) /
           hypot(x - exact->s[last], y);
}

/* --- all of it --- */

/* How far an elastic stress is from beam theory at most; NaN where one is not known. */
static double largest_difference(const struct wb_wires_results *results)
{
    double largest = 0.0;
    for (int i = 0; i < results->n_stresses; i++) {
        const struct wb_wires_stress *const stress = &results->stresses[i];
        const double difference = fabs(stress->core.stress / stress->beam - 1.0);
        if (!(difference <= largest))
            largest = difference;
        if (isnan(largest))
            break;
    }
    return largest;
}

int wb_wires_results_judge(const struct wb_wires_results *results,
                           struct wb_verdict verdicts[WB_WIRES_VERDICTS])
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTIC);
    const struct {
        bool is_known;
        struct wb_verdict verdict;
    } all[WB_WIRES_VERDICTS] = {
        {solid,
         {"Tip of the elastic solid from the exact one, over its displacement", "tip_max",
          .value = tip_error(results, solid), .limit = comparison->tip_limit}},
        {rod,
         {"Tip of the elastic rod from the exact one, over its displacement", "tip_max",
          .value = tip_error(results, rod), .limit = comparison->tip_limit}},
        {results->n_stresses > 0,
         {"Elastic stress of the core's outer fibre from <i>E\xce\xba</i><i>r</i>", "stress_max",
          .value = largest_difference(results), .limit = comparison->stress_limit}},
        {solid && rod,
         {"CPU seconds of the elastic rod over those of the solid", "cost_max",
          .value = wb_wires_cost(results, WB_WIRES_ELASTIC), .limit = comparison->cost_limit}},
    };
    int n = 0;
    for (int i = 0; i < WB_WIRES_VERDICTS; i++) {
        if (all[i].is_known)
            wb_verdict_add(verdicts, &n, &all[i].verdict);
    }
    return n;
}

static void judge(struct wb_wires_results *results)
{
    struct wb_kind_outcome *const outcome = &results->outcome;
    struct wb_verdict verdicts[WB_WIRES_VERDICTS];
    wb_simulation_count(wb_wires_results_list, results, &outcome->n_wanted, &outcome->n_usable);
    outcome->is_complete = outcome->n_usable == outcome->n_wanted &&
                           results->fit_state == WB_SIMULATION_USABLE && results->fitted.reached &&
                           (!results->comparison->has_printed_wire || results->printed.reached);
    outcome->exceeds_limit =
        !wb_verdict_all_kept(verdicts, wb_wires_results_judge(results, verdicts));
}

/* A solid costs its elements along the wire times the rows of all steps; a rod costs next to
 * nothing. */
static double cost_of(const struct wb_wire_model *model, enum wb_wires_solver solver)
{
    double rows = 0.0;
    for (int i = 0; i < model->n_steps; i++)
        rows += model->step[i].rows;
    return solver == WB_WIRES_SOLID ? rows * model->elements_along : 0.0;
}

bool wb_wires_results_list(const void *context, int index, struct wb_simulation_entry *entry)
{
    const struct wb_wires_results *const results = context;
    const int i = index / WB_WIRES_SOLVERS;
    const enum wb_wires_solver solver = (enum wb_wires_solver)(index % WB_WIRES_SOLVERS);
    if (i >= results->comparison->n_cases)
        return false;
    const struct wb_wires_case *const item = &results->comparison->cases[i];
    *entry = (struct wb_simulation_entry){.wanted = &item->datasets[solver],
                                          .result = &results->runs[i][solver].simulation,
                                          .cost = item->model ? cost_of(item->model, solver) : 0.0};
    return true;
}

enum wb_status wb_wires_results_load(void *context, const void *campaign)
{
    struct wb_wires_results *const results = context;
    const struct wb_wires *const comparison = campaign;
    results->comparison = comparison;
    results->outcome.campaign = &comparison->head;
    results->outcome.n_steps = 2;
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            wb_wires_run_load(&results->runs[i][k], &comparison->cases[i], (enum wb_wires_solver)k);
    }
    return WB_OK;
}

enum wb_status wb_wires_results_compute(void *of, int n_threads, wb_kind_progress *progress,
                                        void *context)
{
    struct wb_wires_results *const results = of;
    (void)n_threads;
    const struct wb_wires_wire elastic = wire_of(results->comparison, WB_WIRES_ELASTIC);
    wb_wires_rod_exact(&results->exact, &elastic);
    find_stresses(results);
    WB_TRY(compute_printed(results));
    if (progress)
        progress(context, 1, "computed the printed properties");
    fit(results);
    if (progress)
        progress(context, 2, "fitted the rod");
    results->outcome.interrupted = wb_interrupted();
    judge(results);
    return WB_OK;
}

void wb_wires_results_release(void *context)
{
    struct wb_wires_results *const results = context;
    for (int i = 0; i < WB_WIRES_CASES; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            wb_wires_run_release(&results->runs[i][k]);
    }
    wb_text_release(&results->fit_problem);
    if (results->fit_state == WB_SIMULATION_USABLE)
        wb_calibrate_result_release(&results->fit);
    memset(results, 0, sizeof *results);
}
