#include "analysis/report/wires/wires_kind.h"

#include <math.h>
#include <stdio.h>

#include "analysis/report/numbers.h"
#include "base/text.h"
#include "base/units.h"

static void put_peak(struct wb_json *object, const char *key, const struct wb_wires_peak *peak)
{
    if (!isfinite(peak->stress))
        return;
    struct wb_json *const entry = wb_json_set_object(object, key);
    wb_json_set_number(entry, "von_mises_MPa", peak->stress / WB_MPA);
    wb_numbers_put_list(entry, "at_mm", peak->reference, 3, WB_MM);
}

/* The largest stresses on every section that the dataset keeps. */
static void put_fields(struct wb_json *entry, const struct wb_fields *fields)
{
    struct wb_json *const list = wb_json_set_array(entry, "sections");
    for (int i = 0; i < fields->n; i++) {
        const struct wb_field *const field = &fields->items[i];
        const struct wb_wires_peak core = wb_wires_find_peak(field, 0);
        const struct wb_wires_peak jacket = wb_wires_find_peak(field, 1);
        struct wb_json *const item = wb_json_append_object(list);
        wb_json_set_text(item, "state", field->state);
        wb_json_set_text(item, "section", isnan(field->x) ? "longitudinal" : "cross");
        wb_json_set_number(item, "from_clamp_mm", field->x / WB_MM);
        put_peak(item, "core", &core);
        put_peak(item, "jacket", &jacket);
    }
}

static void put_usable(struct wb_json *entry, const struct wb_wires_results *results,
                       const struct wb_wires_run *run, int index)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, index);
    wb_json_set_text(entry, "sha256", run->simulation.sha256);
    wb_json_set_number(entry, "follower_force_N", run->force);
    wb_numbers_put_list(entry, "tip_mm", run->tip, 3, WB_MM);
    wb_json_set_number(entry, "tip_angle_degrees", run->tip_angle / WB_DEGREE);
    if (solid && solid != run)
        wb_json_set_number(entry, "largest_distance_from_solid_mm",
                           wb_wires_distance(solid, run) / WB_MM);
    put_fields(entry, &run->fields);
}

/* Of a case with residual stress: how far its tip is from that of the same model without. */
static void put_effect(struct wb_json *entry, const struct wb_wires_results *results,
                       const struct wb_wires_run *run, int index, int solver)
{
    const struct wb_wires_run *const without =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, (enum wb_wires_solver)solver);
    if (index >= WB_WIRES_RESIDUAL && without)
        wb_json_set_number(entry, "tip_moved_at_most_mm", wb_wires_effect(run, without) / WB_MM);
}

static void put_run(struct wb_json *object, const struct wb_wires_results *results, int index,
                    int solver)
{
    const struct wb_wires_case *const item = &results->comparison->cases[index];
    const struct wb_wires_run *const run = &results->runs[index][solver];
    if (run->simulation.state == WB_SIMULATION_NOT_WANTED)
        return;
    struct wb_json *const entry =
        wb_json_set_object(object, wb_wires_command((enum wb_wires_solver)solver));
    wb_simulation_describe(entry, &item->datasets[solver], &run->simulation);
    wb_json_set_number(entry, "elements", run->elements);
    wb_json_set_number(entry, "degrees_of_freedom", run->unknowns);
    wb_json_set_number(entry, "iterations", run->iterations);
    wb_json_set_number(entry, "cpu_s", run->simulation.cpu_s);
    wb_json_set_number(entry, "peak_memory_MB", run->memory_MB);
    if (isfinite(run->slip)) {
        wb_json_set_number(entry, "slip_mm", run->slip / WB_MM);
        wb_json_set_number(entry, "slip_limit_mm", run->slip_limit / WB_MM);
        wb_json_set_number(entry, "opening_mm", run->opening / WB_MM);
    }
    if (run->simulation.state != WB_SIMULATION_USABLE)
        return;
    put_usable(entry, results, run, index);
    put_effect(entry, results, run, index, solver);
}

static void put_rod(struct wb_json *root, const char *key, const struct wb_wires_rod *rod,
                    const struct wb_wires_run *solid)
{
    const int last = WB_WIRES_POINTS - 1;
    if (!rod->done)
        return;
    struct wb_json *const entry = wb_json_set_object(root, key);
    wb_json_set_boolean(entry, "reached", rod->reached);
    wb_json_set_number(entry, "tip_x_mm", rod->x[last] / WB_MM);
    wb_json_set_number(entry, "tip_y_mm", rod->y[last] / WB_MM);
    wb_json_set_number(entry, "tip_angle_degrees", rod->tip_angle / WB_DEGREE);
    if (solid && rod->reached)
        wb_json_set_number(entry, "largest_distance_from_solid_mm",
                           wb_wires_rod_distance(solid, rod) / WB_MM);
    wb_numbers_put_list(entry, "x_mm", rod->x, WB_WIRES_POINTS, WB_MM);
    wb_numbers_put_list(entry, "y_mm", rod->y, WB_WIRES_POINTS, WB_MM);
    if (rod->n_curve < 2)
        return;
    wb_numbers_put_list(entry, "force_N", rod->force, rod->n_curve, 1.0);
    wb_numbers_put_list(entry, "deflection_mm", rod->deflection, rod->n_curve, WB_MM);
    wb_numbers_put_list(entry, "angle_degrees", rod->angle, rod->n_curve, WB_DEGREE);
}

static void put_material(struct wb_json *object, const char *key,
                         const struct wb_material *material)
{
    struct wb_json *const entry = wb_json_set_object(object, key);
    wb_numbers_put_properties(entry, material);
}

static void put_fit(struct wb_json *root, const struct wb_wires_results *results)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    struct wb_json *const entry = wb_json_set_object(root, "fit");
    if (results->comparison->has_printed_wire)
        put_material(entry, "printed", &results->comparison->printed_wire.material);
    if (results->fit_state != WB_SIMULATION_USABLE) {
        wb_json_set_text(entry, "problem", wb_text_string(&results->fit_problem));
        return;
    }
    put_material(entry, "properties", &results->fit.material);
    wb_json_set_number(entry, "rms_over_largest_deflection", results->fit.rms);
    wb_json_set_number(entry, "F_max_N", results->fit.max_force);
    wb_json_set_number(entry, "max_deflection_mm", results->fit.max_deflection / WB_MM);
    wb_json_set_text(entry, "stopped_because", wb_calibrate_end_text(results->fit.end));
    wb_json_set_integer(entry, "beam_runs", results->fit.evaluations);
    put_rod(entry, "rod", &results->fitted, solid);
}

static void put_stresses(struct wb_json *root, const struct wb_wires_results *results)
{
    struct wb_json *const list = wb_json_set_array(root, "elastic_stresses");
    for (int i = 0; i < results->n_stresses; i++) {
        const struct wb_wires_stress *const stress = &results->stresses[i];
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_number(entry, "from_clamp_mm", stress->x / WB_MM);
        put_peak(entry, "core", &stress->core);
        put_peak(entry, "jacket", &stress->jacket);
        wb_json_set_number(entry, "curvature_per_mm", stress->curvature * WB_MM);
        wb_json_set_number(entry, "E_kappa_r_MPa", stress->beam / WB_MPA);
    }
}

static void put_cases(struct wb_json *root, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    struct wb_json *const list = wb_json_set_array(root, "cases");
    for (int i = 0; i < comparison->n_cases; i++) {
        const struct wb_wires_case *const item = &comparison->cases[i];
        if (!item->model)
            continue;
        struct wb_json *const entry = wb_json_append_object(list);
        wb_json_set_text(entry, "label", item->label);
        wb_json_set_text(entry, "model", item->model_name);
        wb_json_set_text(entry, "inputs_sha256", item->datasets[WB_WIRES_SOLID].inputs_sha256);
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            put_run(entry, results, i, k);
        if (item->datasets[WB_WIRES_ROD].wanted)
            wb_json_set_number(entry, "cpu_of_rod_over_solid", wb_wires_cost(results, i));
    }
}

struct wb_json *wb_wires_json_build(const void *context)
{
    const struct wb_wires_results *const results = context;
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const elastic = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const plastic = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    struct wb_json *const root =
        wb_numbers_create(&comparison->head, "simulation", &results->outcome);
    wb_json_set_number(root, "jacket_modulus_per_percent_of_core_MPa",
                       wb_wires_split(comparison->cases[WB_WIRES_ELASTOPLASTIC].model, 0.01) /
                           WB_MPA);
    put_cases(root, results);
    put_stresses(root, results);
    put_rod(root, "exact_elastic_rod", &results->exact, elastic);
    put_fit(root, results);
    put_rod(root, "printed_rod", &results->printed, plastic);
    if (results->printed.done)
        wb_json_set_number(root, "printed_collapse_force_N", results->collapse_force);
    return root;
}
