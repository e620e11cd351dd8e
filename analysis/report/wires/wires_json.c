#include "analysis/report/wires/wires_kind.h"

#include <math.h>
#include <stdio.h>

#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "analysis/report/numbers.h"
#include "base/text.h"
#include "base/units.h"

/* --- keys --- */

#define PEAK(member) WB_AT(struct wb_wires_peak, member)
#define RUN(member) WB_AT(struct wb_wires_run, member)
#define CASE(member) WB_AT(struct wb_wires_case, member)
#define STRESS(member) WB_AT(struct wb_wires_stress, member)
#define ROD(member) WB_AT(struct wb_wires_rod, member)

static const struct wb_key peak_rows[] = {
    {"von_mises_MPa", PEAK(stress), "largest von Mises stress"},
    {"at_mm", WB_FULL(struct wb_wires_peak, reference), "its place in the straight wire: x, y, z"},
};
static WB_KEYS(peak, "stress_peak", "The largest stress of a part.");

static const struct wb_key section_rows[] = {
    {"state", WB_AT(struct wb_field, state), "name of the model's step"},
    {"section", TEXT, "kind of section", .choices = "longitudinal|cross"},
    {"from_clamp_mm", WB_AT(struct wb_field, x) | UNKNOWN,
     "place of a cross section; null: longitudinal"},
    {"core", OBJECT | OPTIONAL, "largest stress of the core", &peak_keys},
    {"jacket", OBJECT | OPTIONAL, "largest stress of the jacket", &peak_keys},
};
static WB_KEYS(section, "section", "A section with stress fields.");

static const struct wb_key run_rows[] = {
    {.of = &wb_simulation_state_keys},
    {"elements", RUN(elements) | UNKNOWN, "number of elements"},
    {"degrees_of_freedom", RUN(unknowns) | UNKNOWN, "number of unknowns"},
    {"iterations", RUN(iterations) | UNKNOWN, "iterations of the equilibrium"},
    {"cpu_s", RUN(simulation.cpu_s) | UNKNOWN, "CPU time"},
    {"peak_memory_MB", NUMBER | UNKNOWN, "largest memory of the process"},
    {"slip_mm", NUMBER | OPTIONAL, "with friction: largest slip"},
    {"slip_limit_mm", NUMBER | UNKNOWN | OPTIONAL,
     "with friction: limit of the assumption of small sliding"},
    {"opening_mm", NUMBER | UNKNOWN | OPTIONAL, "with friction: largest opening"},
    {"sha256", RUN(simulation.sha256) | OPTIONAL, "SHA-256 of force_deflection.csv"},
    {"follower_force_N", RUN(force) | UNKNOWN | OPTIONAL, "follower force"},
    {"tip_mm", WB_FULL(struct wb_wires_run, tip) | UNKNOWN | OPTIONAL, "place of the tip: x, y, z"},
    {"tip_angle_degrees", RUN(tip_angle) | UNKNOWN | OPTIONAL, "slope angle at the tip"},
    {"largest_distance_from_solid_mm", NUMBER | UNKNOWN | OPTIONAL,
     "largest distance of the axes of rod and solid"},
    {"sections", OBJECT | LIST | OPTIONAL, "sections with stress fields", &section_keys},
    {"tip_moved_at_most_mm", NUMBER | UNKNOWN | OPTIONAL,
     "with residual stress: largest distance of the tip from that of the model without"},
};
static WB_KEYS(run, "comparison_run",
               "A dataset of a case; the keys from `sha256` on are of a used one.");

static const struct wb_key case_rows[] = {
    {"label", CASE(label), "name of the case in the report"},
    {"model", CASE(model_name), "name of the model"},
    {"inputs_sha256", CASE(datasets[WB_WIRES_SOLID].inputs_sha256),
     "SHA-256 of the solid's inputs"},
    {"wire3d", OBJECT | OPTIONAL, "dataset of the solid", &run_keys},
    {"wire1d", OBJECT | OPTIONAL, "dataset of the rod", &run_keys},
    {"cpu_of_rod_over_solid", NUMBER | UNKNOWN | OPTIONAL,
     "CPU time of the rod over that of the solid"},
};
static WB_KEYS(case, "comparison_case", "A case of the comparison.");

static const struct wb_key stress_rows[] = {
    {"from_clamp_mm", STRESS(x), "place of the cross section"},
    {"core", OBJECT | OPTIONAL, "largest stress of the core", &peak_keys},
    {"jacket", OBJECT | OPTIONAL, "largest stress of the jacket", &peak_keys},
    {"curvature_per_mm", NUMBER | UNKNOWN, "curvature of the exact rod there"},
    {"E_kappa_r_MPa", STRESS(beam) | UNKNOWN, "stress E kappa r of beam theory"},
};
static WB_KEYS(stress, "elastic_stress", "Stresses of a cross section of the elastic solid.");

static const struct wb_key rod_rows[] = {
    {"reached", ROD(reached), "the rod reached the force"},
    {"tip_x_mm", ROD(x[WB_WIRES_POINTS - 1]) | UNKNOWN, "x of the tip"},
    {"tip_y_mm", ROD(y[WB_WIRES_POINTS - 1]) | UNKNOWN, "y of the tip"},
    {"tip_angle_degrees", ROD(tip_angle) | UNKNOWN, "slope angle at the tip"},
    {"largest_distance_from_solid_mm", NUMBER | UNKNOWN | OPTIONAL,
     "largest distance of the axes of rod and solid"},
    {"x_mm", WB_FULL(struct wb_wires_rod, x) | UNKNOWN, "x of the axis"},
    {"y_mm", WB_FULL(struct wb_wires_rod, y) | UNKNOWN, "y of the axis"},
    {"force_N", NUMBER | LIST | UNKNOWN | OPTIONAL, "forces of the curve"},
    {"deflection_mm", NUMBER | LIST | UNKNOWN | OPTIONAL, "deflections of the curve"},
    {"angle_degrees", NUMBER | LIST | UNKNOWN | OPTIONAL, "slope angles of the curve"},
};
static WB_KEYS(rod, "rod", "A rod under the same force.");

static const struct wb_key fit_rows[] = {
    {"printed", OBJECT | OPTIONAL, "published properties", &wb_law_ludwik_keys},
    {"problem", TEXT | OPTIONAL, "why there is no fit"},
    {"properties", OBJECT | OPTIONAL, "fitted properties", &wb_law_ludwik_keys},
    {"rms_over_largest_deflection", NUMBER | UNKNOWN | OPTIONAL,
     "RMS error over the largest deflection"},
    {"F_max_N", NUMBER | OPTIONAL, "largest force"},
    {"max_deflection_mm", NUMBER | OPTIONAL, "largest deflection"},
    {"stopped_because", TEXT | OPTIONAL, "why the search ended"},
    {"beam_runs", INTEGER | OPTIONAL, "computations of the beam"},
    {"rod", OBJECT | OPTIONAL, "rod with the fitted properties", &rod_keys},
};
static WB_KEYS(fit, "comparison_fit", "The homogenised law fitted to the solid.");

static const struct wb_key wb_wires_json_rows[] = {
    {.of = &wb_numbers_head_keys},
    {"jacket_modulus_per_percent_of_core_MPa", NUMBER,
     "change of the jacket's E by eq. 8 when the core's E changes by 1 %"},
    {"cases", OBJECT | LIST, "cases", &case_keys},
    {"elastic_stresses", OBJECT | LIST, "stresses of the elastic solid", &stress_keys},
    {"exact_elastic_rod", OBJECT | OPTIONAL, "elastica", &rod_keys},
    {"fit", OBJECT, "homogenised law fitted to the solid", &fit_keys},
    {"printed_rod", OBJECT | OPTIONAL, "rod with the published properties", &rod_keys},
    {"printed_collapse_force_N", NUMBER | UNKNOWN | OPTIONAL,
     "force at which that rod would collapse without hardening"},
};
WB_KEYS(wb_wires_json, "report_of_comparison", "The report of a comparison campaign.");

/* --- values --- */

static void put_peak(struct wb_json *object, const char *key, const struct wb_wires_peak *largest)
{
    if (isfinite(largest->stress))
        WB_PUT(wb_json_set_object(object, key), &peak_keys, struct wb_wires_peak, largest);
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
        WB_PUT(item, &section_keys, struct wb_field, field);
        wb_json_set_text(item, "section", isnan(field->x) ? "longitudinal" : "cross");
        WB_PUT(item, &section_keys, struct wb_field, field);
        put_peak(item, "core", &core);
        put_peak(item, "jacket", &jacket);
    }
}

static void put_usable(struct wb_json *entry, const struct wb_wires_results *results,
                       const struct wb_wires_run *run, int index)
{
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, index);
    WB_PUT(entry, &run_keys, struct wb_wires_run, run);
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
    WB_PUT(entry, &run_keys, struct wb_wires_run, run);
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
    if (!rod->done)
        return;
    struct wb_json *const entry = wb_json_set_object(root, key);
    WB_PUT(entry, &rod_keys, struct wb_wires_rod, rod);
    if (solid && rod->reached)
        wb_json_set_number(entry, "largest_distance_from_solid_mm",
                           wb_wires_rod_distance(solid, rod) / WB_MM);
    WB_PUT(entry, &rod_keys, struct wb_wires_rod, rod);
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
        WB_PUT(entry, &stress_keys, struct wb_wires_stress, stress);
        put_peak(entry, "core", &stress->core);
        put_peak(entry, "jacket", &stress->jacket);
        wb_json_set_number(entry, "curvature_per_mm", stress->curvature * WB_MM);
        WB_PUT(entry, &stress_keys, struct wb_wires_stress, stress);
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
        WB_PUT(entry, &case_keys, struct wb_wires_case, item);
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
