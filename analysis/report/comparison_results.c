#include "analysis/report/comparison_results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

/* --- what a failure says --- */

struct listener {
    struct wb_text *text;
    const char *path, *name; /* no path of this machine may reach the report */
};

static void listen(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    const struct listener *const listener = context;
    (void)domain;
    if (level != WB_LOG_ERROR)
        return;
    if (listener->text->length > 0)
        wb_text_append(listener->text, "; ");
    const size_t length = strlen(listener->path);
    for (const char *found; length > 0 && (found = strstr(message, listener->path));) {
        wb_text_append_bytes(listener->text, message, (size_t)(found - message));
        wb_text_append(listener->text, "%s", listener->name);
        message = found + length;
    }
    wb_text_append(listener->text, "%s", message);
}

/* --- one dataset --- */

static double number_of(const struct wb_json *object, const char *key)
{
    double value;
    return wb_json_get_number(object, key, &value) ? value : (double)NAN;
}

static void read_simulation(struct wb_comparison_run *run)
{
    const struct wb_json *const document = run->dataset.document;
    const struct wb_json *const simulation = wb_json_get(document, "simulation");
    const char *revision = "";
    run->elements = number_of(simulation, "elements");
    run->unknowns = number_of(simulation, "degrees_of_freedom");
    run->iterations = number_of(simulation, "iterations");
    run->cpu_s = number_of(simulation, "cpu_s");
    run->memory_MB = number_of(simulation, "peak_memory_MB");
    const struct wb_json *const interface = wb_json_get(simulation, "interface");
    run->slip = number_of(interface, "slip_mm") * WB_MM;
    run->slip_limit = number_of(interface, "slip_limit_mm") * WB_MM;
    run->opening = number_of(interface, "opening_mm") * WB_MM;
    (void)wb_json_get_text(wb_json_get(document, "tool"), "revision", &revision);
    snprintf(run->revision, sizeof run->revision, "%s", revision);
}

/* Whether the dataset is of this model as it is now, and whole. */
static enum wb_status check_simulation(struct wb_comparison_run *run,
                                       const struct wb_comparison_case *item,
                                       enum wb_comparison_solver solver)
{
    const struct wb_json *const simulation = wb_json_get(run->dataset.document, "simulation");
    const struct wb_test_info *const info = &run->dataset.info;
    const char *sha256 = "", *made_by = "", *problem = "";
    if (!info->is_simulation || !simulation || !wb_json_get_text(simulation, "model", &made_by) ||
        !wb_json_get_text(simulation, "sha256", &sha256))
        return wb_fail(WB_ERR_DATA, "it does not say of which model it is a simulation");
    if (strcmp(made_by, wb_comparison_command(solver)) != 0)
        return wb_fail(WB_ERR_DATA, "it was made by 'solve %s', not by 'solve %s'", made_by,
                       wb_comparison_command(solver));
    run->is_stale = strcmp(sha256, item->model->sha256) != 0;
    if (run->is_stale)
        return wb_fail(WB_ERR_DATA, "the model, its wire or its materials have changed since");
    (void)wb_json_get_text(simulation, "problem", &problem);
    run->is_cut_short = !wb_dataset_is_complete(&run->dataset);
    if (run->is_cut_short)
        return wb_fail(WB_ERR_DATA, "it did not converge to its end%s%s", problem[0] ? ": " : "",
                       problem);
    return WB_OK;
}

/* State and axis at the end of the history. */
static enum wb_status take_end(struct wb_comparison_run *run, const struct wb_wire_model *model)
{
    const struct wb_dataset *const dataset = &run->dataset;
    const double force = model->step[model->n_steps - 1].loads.follower[1];
    if (dataset->n_rows == 0 || dataset->n_shape_rows < 2)
        return wb_fail(WB_ERR_DATA, "it has no rows or no shapes");
    const struct wb_row *const last = &dataset->rows[dataset->n_rows - 1];
    size_t first = dataset->n_shape_rows;
    while (first > 0 && dataset->shape_rows[first - 1].t == last->t)
        first--;
    const size_t n = dataset->n_shape_rows - first;
    if (n < 2)
        return wb_fail(WB_ERR_DATA, "it has no shape of its last row");
    run->s = malloc(n * sizeof *run->s);
    run->shape = malloc(n * sizeof *run->shape);
    if (!run->s || !run->shape)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading a dataset");
    for (size_t i = 0; i < n; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[first + i];
        const double z = isfinite(row->z) ? row->z : 0.0;
        run->s[i] = row->s;
        memcpy(run->shape[i], (double[3]){row->x, row->y, z}, sizeof run->shape[i]);
    }
    run->n_shape = (int)n;
    memcpy(run->tip, run->shape[n - 1], sizeof run->tip);
    run->force = force;
    run->tip_angle = last->tip_angle;
    if (fabs(run->s[n - 1] - model->length) > 1e-6 * model->length)
        return wb_fail(WB_ERR_DATA, "its shapes end at %g mm, not at the wire's tip",
                       run->s[n - 1] / WB_MM);
    return WB_OK;
}

static enum wb_status read_run(struct wb_comparison_run *run, const struct wb_comparison_case *item,
                               enum wb_comparison_solver solver)
{
    const char *const path = item->datasets[solver].path;
    char rows[WB_PATH];
    WB_TRY(wb_dataset_read(&run->dataset, path));
    read_simulation(run);
    WB_TRY(check_simulation(run, item, solver));
    WB_TRY(take_end(run, item->model));
    WB_TRY(wb_file_join(rows, path, "force_deflection.csv"));
    WB_TRY(wb_hash_file(rows, run->sha256));
    return wb_fields_read(&run->fields, path);
}

static void load_run(struct wb_comparison_run *run, const struct wb_comparison_case *item,
                     enum wb_comparison_solver solver)
{
    const struct wb_comparison_dataset *const wanted = &item->datasets[solver];
    char folder[WB_PATH];
    run->elements = run->unknowns = run->iterations = (double)NAN;
    run->cpu_s = run->memory_MB = run->slip = run->slip_limit = run->opening = (double)NAN;
    if (!wanted->wanted)
        return;
    snprintf(run->command, sizeof run->command, "wirebench solve %s %s -o %s",
             wb_comparison_command(solver), item->model_name, wanted->name);
    run->state = WB_COMPARISON_MISSING;
    if (wb_file_join(folder, wanted->path, "dataset.json") != WB_OK || !wb_file_exists(folder)) {
        wb_text_append(&run->problem, "there is no such dataset");
        return;
    }
    struct listener listener = {&run->problem, wanted->path, wanted->name};
    wb_log_set_tap(listen, &listener);
    const enum wb_status status = read_run(run, item, solver);
    wb_log_set_tap(NULL, NULL);
    run->state = status == WB_OK ? WB_COMPARISON_USABLE : WB_COMPARISON_REFUSED;
    if (status != WB_OK && run->problem.length == 0)
        wb_text_append(&run->problem, "%s", wb_status_text(status));
}

const struct wb_comparison_run *wb_comparison_usable(const struct wb_comparison_results *results,
                                                     int index, enum wb_comparison_solver solver)
{
    const struct wb_comparison_run *const run = &results->runs[index][solver];
    return run->state == WB_COMPARISON_USABLE ? run : NULL;
}

/* --- stresses --- */

struct wb_comparison_peak wb_comparison_find_peak(const struct wb_field *field, int part)
{
    struct wb_comparison_peak peak = {.stress = (double)NAN};
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

static void find_stresses(struct wb_comparison_results *results)
{
    const struct wb_comparison *const comparison = results->comparison;
    const struct wb_comparison_run *const run =
        wb_comparison_usable(results, WB_COMPARISON_ELASTIC, WB_COMPARISON_SOLID);
    const struct wb_wire_model_part *const core =
        &comparison->cases[WB_COMPARISON_ELASTIC].model->part[0];
    for (int i = 0; run && i < run->fields.n; i++) {
        const struct wb_field *const field = &run->fields.items[i];
        if (isnan(field->x) || strcmp(field->state, comparison->loaded_state) != 0 ||
            results->n_stresses == WB_COMPARISON_STRESSES)
            continue;
        struct wb_comparison_stress *const stress = &results->stresses[results->n_stresses++];
        stress->x = field->x;
        stress->core = wb_comparison_find_peak(field, 0);
        stress->jacket = wb_comparison_find_peak(field, 1);
        stress->curvature = wb_comparison_rod_curvature(&results->exact, field->x);
        stress->beam =
            core->material.youngs_modulus * stress->curvature * 0.5 * core->outer_diameter;
    }
}

/* --- rods --- */

static struct wb_comparison_wire wire_of(const struct wb_comparison *comparison, int index)
{
    const struct wb_wire_model *const model = comparison->cases[index].model;
    return (struct wb_comparison_wire){
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

static enum wb_status compute_printed(struct wb_comparison_results *results)
{
    const struct wb_comparison *const comparison = results->comparison;
    if (!comparison->has_printed_wire)
        return WB_OK;
    struct wb_comparison_wire wire = wire_of(comparison, WB_COMPARISON_ELASTOPLASTIC);
    wire.diameter = comparison->printed_wire.outer_diameter;
    wire.material = comparison->printed_wire.material;
    /* Plastic moment sigma_Y d^3 / 6 of a full circle at the clamp. */
    results->collapse_force =
        wire.material.yield_stress * pow(wire.diameter, 3.0) / 6.0 / wire.length;
    return wb_comparison_rod_compute(&results->printed, &wire);
}

static bool go_on(void *context, int evaluation, double error, double size)
{
    (void)context, (void)evaluation, (void)error, (void)size;
    return !wb_interrupted();
}

static enum wb_status calibrate(struct wb_comparison_results *results,
                                const struct wb_comparison_run *run)
{
    const struct wb_comparison *const comparison = results->comparison;
    struct wb_comparison_wire wire = wire_of(comparison, WB_COMPARISON_ELASTOPLASTIC);
    struct wb_calibrate_settings settings = comparison->fit;
    const struct wb_dataset *const dataset = &run->dataset;
    settings.progress = go_on;
    if (comparison->mixture)
        settings.youngs_modulus = wire.material.youngs_modulus;
    WB_TRY(wb_calibrate_run(&results->fit, &dataset, 1, &settings));
    wire.material = results->fit.material;
    const enum wb_status status = wb_comparison_rod_compute(&results->fitted, &wire);
    if (status != WB_OK)
        wb_calibrate_result_release(&results->fit);
    return status;
}

static void fit(struct wb_comparison_results *results)
{
    const struct wb_comparison_run *const run =
        wb_comparison_usable(results, WB_COMPARISON_ELASTOPLASTIC, WB_COMPARISON_SOLID);
    results->fit_state = WB_COMPARISON_MISSING;
    if (!run) {
        wb_text_append(&results->fit_problem, "the solid's dataset that it builds on is missing");
        return;
    }
    struct listener listener = {&results->fit_problem, "", ""};
    wb_log_set_tap(listen, &listener);
    const enum wb_status status = calibrate(results, run);
    wb_log_set_tap(NULL, NULL);
    results->fit_state = status == WB_OK ? WB_COMPARISON_USABLE : WB_COMPARISON_REFUSED;
    if (status == WB_OK)
        wb_text_release(&results->fit_problem);
    else if (results->fit_problem.length == 0)
        wb_text_append(&results->fit_problem, "%s", wb_status_text(status));
}

double wb_comparison_split(const struct wb_wire_model *model, double change)
{
    const struct wb_wire_model_part *const core = &model->part[0], *const jacket = &model->part[1];
    const double inner = pow(core->outer_diameter, 4.0);
    return change * core->material.youngs_modulus * inner /
           (pow(jacket->outer_diameter, 4.0) - inner);
}

/* --- comparing --- */

/* A point of an axis at an arc length, on the straight line between its neighbours. */
static void point_at(const struct wb_comparison_run *run, double s, double point[3])
{
    int i = 1;
    while (i + 1 < run->n_shape && run->s[i] < s)
        i++;
    const double part = (s - run->s[i - 1]) / (run->s[i] - run->s[i - 1]);
    for (int k = 0; k < 3; k++)
        point[k] = run->shape[i - 1][k] + part * (run->shape[i][k] - run->shape[i - 1][k]);
}

double wb_comparison_distance(const struct wb_comparison_run *run,
                              const struct wb_comparison_run *other)
{
    double largest = 0.0;
    for (int i = 0; i < other->n_shape; i++) {
        double point[3];
        point_at(run, other->s[i], point);
        largest =
            fmax(largest, hypot(hypot(point[0] - other->shape[i][0], point[1] - other->shape[i][1]),
                                point[2] - other->shape[i][2]));
    }
    return largest;
}

double wb_comparison_rod_distance(const struct wb_comparison_run *run,
                                  const struct wb_comparison_rod *rod)
{
    const int last = WB_COMPARISON_POINTS - 1;
    double largest = 0.0;
    for (int i = 0; i < run->n_shape; i++) {
        const double place = fmin(fmax(run->s[i] / rod->s[last], 0.0), 1.0) * last;
        const int below = place < last ? (int)place : last - 1;
        const double part = place - below;
        const double x = rod->x[below] + part * (rod->x[below + 1] - rod->x[below]);
        const double y = rod->y[below] + part * (rod->y[below + 1] - rod->y[below]);
        largest = fmax(largest,
                       hypot(hypot(run->shape[i][0] - x, run->shape[i][1] - y), run->shape[i][2]));
    }
    return largest;
}

double wb_comparison_cost(const struct wb_comparison_results *results, int index)
{
    const struct wb_comparison_run *const runs = results->runs[index];
    return runs[WB_COMPARISON_ROD].cpu_s / runs[WB_COMPARISON_SOLID].cpu_s;
}

double wb_comparison_tip_error(const struct wb_comparison_results *results,
                               const struct wb_comparison_run *run)
{
    const int last = WB_COMPARISON_POINTS - 1;
    const struct wb_comparison_rod *const exact = &results->exact;
    const double x = exact->x[last], y = exact->y[last];
    return hypot(hypot(run->tip[0] - x, run->tip[1] - y), run->tip[2]) /
           hypot(x - exact->s[last], y);
}

/* --- all of it --- */

static void judge(struct wb_comparison_results *results)
{
    const struct wb_comparison *const comparison = results->comparison;
    const struct wb_comparison_run *const solid =
        wb_comparison_usable(results, WB_COMPARISON_ELASTIC, WB_COMPARISON_SOLID);
    const struct wb_comparison_run *const rod =
        wb_comparison_usable(results, WB_COMPARISON_ELASTIC, WB_COMPARISON_ROD);
    const struct wb_comparison_run *const both[] = {solid, rod};
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_COMPARISON_SOLVERS; k++) {
            results->n_wanted += results->runs[i][k].state != WB_COMPARISON_NOT_WANTED;
            results->n_usable += results->runs[i][k].state == WB_COMPARISON_USABLE;
        }
    }
    results->is_complete = results->n_usable == results->n_wanted &&
                           results->fit_state == WB_COMPARISON_USABLE && results->fitted.reached &&
                           (!comparison->has_printed_wire || results->printed.reached);
    /* Compared so that a NaN exceeds. */
    for (int i = 0; i < 2 && comparison->tip_limit > 0.0; i++) {
        if (both[i] && !(wb_comparison_tip_error(results, both[i]) <= comparison->tip_limit))
            results->exceeds_limit = true;
    }
    for (int i = 0; i < results->n_stresses && comparison->stress_limit > 0.0; i++) {
        const struct wb_comparison_stress *const stress = &results->stresses[i];
        if (!(fabs(stress->core.stress / stress->beam - 1.0) <= comparison->stress_limit))
            results->exceeds_limit = true;
    }
    if (comparison->cost_limit > 0.0 && solid && rod &&
        !(wb_comparison_cost(results, WB_COMPARISON_ELASTIC) <= comparison->cost_limit))
        results->exceeds_limit = true;
}

int wb_comparison_count(const struct wb_comparison *comparison)
{
    int n = 2;
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_COMPARISON_SOLVERS; k++)
            n += comparison->cases[i].datasets[k].wanted;
    }
    return n;
}

struct teller {
    wb_comparison_progress *progress;
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

static enum wb_status compute(struct wb_comparison_results *results, struct teller *teller)
{
    const struct wb_comparison *const comparison = results->comparison;
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_COMPARISON_SOLVERS; k++) {
            const struct wb_comparison_case *const item = &comparison->cases[i];
            load_run(&results->runs[i][k], item, (enum wb_comparison_solver)k);
            if (item->datasets[k].wanted)
                tell(teller, "read", item->datasets[k].name);
        }
    }
    const struct wb_comparison_wire elastic = wire_of(comparison, WB_COMPARISON_ELASTIC);
    wb_comparison_rod_exact(&results->exact, &elastic);
    find_stresses(results);
    WB_TRY(compute_printed(results));
    tell(teller, "computed", "the printed properties");
    fit(results);
    tell(teller, "fitted", "the rod");
    return WB_OK;
}

enum wb_status wb_comparison_compute(struct wb_comparison_results *results,
                                     const struct wb_comparison *comparison,
                                     wb_comparison_progress *progress, void *context)
{
    memset(results, 0, sizeof *results);
    results->comparison = comparison;
    struct teller teller = {progress, context, 0, wb_comparison_count(comparison)};
    const enum wb_status status = compute(results, &teller);
    if (status != WB_OK) {
        wb_comparison_results_release(results);
        return status;
    }
    results->interrupted = wb_interrupted();
    judge(results);
    return WB_OK;
}

void wb_comparison_results_release(struct wb_comparison_results *results)
{
    for (int i = 0; i < WB_COMPARISON_CASES; i++) {
        for (int k = 0; k < WB_COMPARISON_SOLVERS; k++) {
            struct wb_comparison_run *const run = &results->runs[i][k];
            wb_text_release(&run->problem);
            wb_dataset_release(&run->dataset);
            wb_fields_release(&run->fields);
            free(run->s);
            free(run->shape);
        }
    }
    wb_text_release(&results->fit_problem);
    if (results->fit_state == WB_COMPARISON_USABLE)
        wb_calibrate_result_release(&results->fit);
    memset(results, 0, sizeof *results);
}
