#include "analysis/report/bundles/bundles_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/computed.h"
#include "analysis/csv_table.h"
#include "analysis/errors.h"
#include "analysis/report/reasons.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

bool wb_bundles_run_is_missing(const struct wb_bundles_result *result)
{
    return result->state == WB_BUNDLES_MISSING || result->state == WB_BUNDLES_STALE;
}

double wb_bundles_run_cost(const struct wb_bundles_run *run)
{
    const double elements = (double)wb_bundle_model_hexahedra(run->model, run->mesh);
    return run->model->run.duration > 0.0 ? elements : 2.0 * elements;
}

/* --- dataset.json --- */

static double number_of(const struct wb_json *object, const char *key)
{
    double value;
    return wb_json_get_number(object, key, &value) ? value : (double)NAN;
}

static void read_numbers(struct wb_bundles_result *result)
{
    const struct wb_json *const simulation = wb_json_get(result->dataset.document, "simulation");
    const struct wb_json *const largest = wb_json_get(simulation, "largest");
    struct wb_bundles_numbers *const n = &result->numbers;
    const char *revision = "";
    n->elements = number_of(simulation, "elements");
    n->shells = number_of(simulation, "shells");
    n->steps = number_of(simulation, "steps");
    n->time_step = number_of(simulation, "time_step_s");
    n->duration = number_of(simulation, "duration_s");
    n->cpu_s = number_of(simulation, "cpu_s");
    n->wall_s = number_of(simulation, "wall_s");
    n->ns = number_of(simulation, "ns_per_element_step");
    n->kinetic = number_of(largest, "kinetic_over_internal");
    n->artificial = number_of(largest, "artificial_over_internal");
    n->imbalance = number_of(largest, "imbalance_over_external");
    n->strain = number_of(largest, "strain");
    n->penetration = number_of(largest, "penetration_mm") * WB_MM;
    (void)wb_json_get_boolean(largest, "beyond_strain_limit", &result->beyond);
    (void)wb_json_get_boolean(simulation, "duration_chosen", &result->kinetic_choice);
    (void)wb_json_get_text(wb_json_get(result->dataset.document, "tool"), "revision", &revision);
    snprintf(result->revision, sizeof result->revision, "%s", revision);
}

static void clear_numbers(struct wb_bundles_numbers *n)
{
    const double none = (double)NAN;
    *n = (struct wb_bundles_numbers){none, none, none, none, none, none, none,
                                     none, none, none, none, none, none};
}

static bool is_solved_by(const struct wb_bundles_result *result, const char *solver)
{
    const char *made_by = "";
    return result->dataset.info.is_simulation &&
           wb_json_get_text(wb_json_get(result->dataset.document, "simulation"), "model",
                            &made_by) &&
           strcmp(made_by, solver) == 0;
}

/* --- does it fit the campaign? --- */

struct setting {
    const char *what;
    double stored, wanted;
};

static bool is_same(double a, double b)
{
    return fabs(a - b) <= 1e-9 * fmax(fabs(a), fabs(b));
}

static enum wb_status check_settings(const struct setting *settings, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (!is_same(settings[i].stored, settings[i].wanted))
            return wb_fail(WB_ERR_DATA, "%s is %.6g in it, and %.6g is wanted", settings[i].what,
                           settings[i].stored, settings[i].wanted);
    }
    return WB_OK;
}

/* The same of a setting that dataset.json names as the bundle's file does. */
static enum wb_status check_row(const struct wb_setting *row, const void *settings,
                                const struct wb_json *simulation)
{
    char problem[WB_SETTING_PROBLEM];
    if (wb_setting_is_same(row, settings, simulation, problem))
        return WB_OK;
    return wb_fail(WB_ERR_DATA, "%s", problem);
}

static double largest_deflection(const struct wb_dataset *dataset)
{
    double largest = 0.0;
    for (size_t i = 0; i < dataset->n_rows; i++)
        largest = fmax(largest, dataset->rows[i].deflection);
    return largest;
}

/* Whether the dataset is of this bundle as it is now, with the run's settings, and whole. */
static enum wb_status check_run(const struct wb_bundles_result *result,
                                const struct wb_bundles_run *run)
{
    const struct wb_setting *const rows = wb_bundle_model_run_settings;
    const struct wb_bundle_model *const m = run->model;
    const struct wb_bundle_interface *const interface = &m->interface;
    const struct wb_test_info *const info = &result->dataset.info;
    const struct wb_json *const simulation = wb_json_get(result->dataset.document, "simulation");
    const struct wb_json *const cohesion = wb_json_get(simulation, "cohesion");
    const char *sha256 = "", *mesh = "", *problem = "";
    (void)wb_json_get_text(simulation, "sha256", &sha256);
    (void)wb_json_get_text(wb_json_get(simulation, "mesh"), "name", &mesh);
    (void)wb_json_get_text(simulation, "problem", &problem);
    if (strcmp(sha256, m->sha256) != 0)
        return wb_fail(WB_ERR_DATA, "the bundle, its wires or its materials have changed since");
    if (strcmp(mesh, m->run.mesh) != 0)
        return wb_fail(WB_ERR_DATA, "its mesh is '%s', and '%s' is wanted", mesh, m->run.mesh);
    const struct setting loads[] = {
        {"the strand's length (mm)", info->strand_length / WB_MM, m->loads.strand_length / WB_MM},
        {"gravity (m/s2)", info->gravity, m->loads.weight ? WB_STANDARD_GRAVITY : 0.0},
    };
    WB_TRY(check_row(wb_bundle_model_friction_setting, interface, simulation));
    WB_TRY(check_settings(loads, sizeof loads / sizeof loads[0]));
    WB_TRY(check_row(&rows[WB_BUNDLE_MODEL_MASS_SCALING], &m->run, simulation));
    WB_TRY(check_row(&rows[WB_BUNDLE_MODEL_SELECTIVE], &m->run, simulation));
    const struct setting normal = {"the cohesive stiffness (N/mm3)",
                                   number_of(cohesion, "normal_stiffness_N_mm3"),
                                   interface->normal_stiffness / WB_N_PER_MM3};
    if (m->has_tape)
        WB_TRY(check_settings(&normal, 1));
    if (m->run.duration > 0.0)
        WB_TRY(check_row(&rows[WB_BUNDLE_MODEL_DURATION], &m->run, simulation));
    else if (!result->kinetic_choice)
        return wb_fail(WB_ERR_DATA, "its duration was given, and one that keeps kinetic energy "
                                    "small is wanted");
    if (!wb_dataset_is_complete(&result->dataset))
        return wb_fail(WB_ERR_DATA, "it did not come to its end%s%s", problem[0] ? ": " : "",
                       problem);
    return WB_OK;
}

static enum wb_status check_rod(const struct wb_bundles_result *result,
                                const struct wb_bundles_run *run)
{
    const struct wb_bundle_model *const m = run->model;
    const struct wb_wire *const beam = wb_bundles_published(run);
    const struct wb_test_info *const info = &result->dataset.info;
    const struct wb_json *const simulation = wb_json_get(result->dataset.document, "simulation");
    const struct setting settings[] = {
        {"the diameter (mm)", info->outer_diameter / WB_MM, beam->outer_diameter / WB_MM},
        {"the length (mm)", info->length / WB_MM, m->length / WB_MM},
        {"the largest deflection (mm)", largest_deflection(&result->dataset) / WB_MM,
         m->run.deflection / WB_MM},
        {"the strand's length (mm)", info->strand_length / WB_MM, m->loads.strand_length / WB_MM},
        {"gravity (m/s2)", info->gravity, m->loads.weight ? WB_STANDARD_GRAVITY : 0.0},
        {"Young's modulus (MPa)", number_of(simulation, "youngs_modulus_MPa"),
         beam->material.youngs_modulus / WB_MPA},
        {"the yield stress (MPa)", number_of(simulation, "yield_stress_MPa"),
         beam->material.yield_stress / WB_MPA},
        {"the strength coefficient (MPa)", number_of(simulation, "strength_coefficient_MPa"),
         beam->material.strength_coefficient / WB_MPA},
        {"the hardening exponent", number_of(simulation, "hardening_exponent"),
         beam->material.hardening_exponent},
    };
    return check_settings(settings, sizeof settings / sizeof settings[0]);
}

/* --- energies.csv --- */

static const char energies_header[] =
    "t_s,deflection_mm,model_time_s,external_J,kinetic_J,stored_J,plastic_J,contact_J,cohesive_J,"
    "friction_J,artificial_J,kinetic_over_internal,artificial_over_internal,imbalance_J";

enum {
    COLUMNS = 11, /* that are wanted, the first ones */
    MM_SHIFT = 3  /* in mm */
};

static bool parse_energy(char *line, struct wb_bundles_energy *energy)
{
    double v[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) {
        char *const text = strsep(&line, ",");
        if (!text || !wb_csv_table_parse_number(text, i == 1 ? MM_SHIFT : 0, &v[i]))
            return false;
    }
    *energy = (struct wb_bundles_energy){
        .deflection = v[1],
        .time = v[2],
        .external = v[3],
        .kinetic = v[4],
        .internal = v[5] + v[6] + v[7] + v[8],
        .plastic = v[6],
        .friction = v[9],
        .artificial = v[10],
    };
    return true;
}

static enum wb_status parse_energies(struct wb_bundles_result *result, char *text, const char *path)
{
    char *line = strsep(&text, "\n");
    result->energies = calloc(result->dataset.n_rows + 1, sizeof *result->energies);
    if (!result->energies)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading '%s'", path);
    if (strcmp(line, energies_header) != 0)
        return wb_fail(WB_ERR_FORMAT, "%s:1: expected the columns %s", path, energies_header);
    while (text && (line = strsep(&text, "\n")) && line[0]) {
        const int n = result->n_energies;
        if (n == (int)result->dataset.n_rows)
            return wb_fail(WB_ERR_FORMAT, "%s:%d: more rows than force_deflection.csv", path,
                           n + 2);
        if (!parse_energy(line, &result->energies[n]))
            return wb_fail(WB_ERR_FORMAT, "%s:%d: expected %d numbers", path, n + 2, COLUMNS);
        result->n_energies++;
    }
    if (result->n_energies != (int)result->dataset.n_rows)
        return wb_fail(WB_ERR_FORMAT, "%s:%d: expected a row: force_deflection.csv has %zu", path,
                       result->n_energies + 2, result->dataset.n_rows);
    return WB_OK;
}

static enum wb_status read_energies(struct wb_bundles_result *result, const char *folder)
{
    char path[WB_PATH], *text;
    WB_TRY(wb_file_join(path, folder, "energies.csv"));
    WB_TRY(wb_file_read(path, &text, NULL));
    const enum wb_status status = parse_energies(result, text, path);
    free(text);
    return status;
}

/* --- loading --- */

/* `stale` says whether a failure is one that making the dataset again mends. */
static enum wb_status read_run(struct wb_bundles_result *result, const struct wb_bundles_run *run,
                               bool *stale)
{
    char rows[WB_PATH];
    WB_TRY(wb_dataset_read(&result->dataset, run->dataset.path));
    if (!is_solved_by(result, "bundle"))
        return wb_fail(WB_ERR_DATA, "it was not made by 'solve bundle'");
    read_numbers(result);
    *stale = true;
    WB_TRY(check_run(result, run));
    *stale = false;
    WB_TRY(wb_file_join(rows, run->dataset.path, "force_deflection.csv"));
    WB_TRY(wb_hash_file(rows, result->sha256));
    WB_TRY(read_energies(result, run->dataset.path));
    return wb_surface_read(&result->surface, run->dataset.path);
}

static enum wb_status read_rod(struct wb_bundles_result *result,
                               const struct wb_bundles_dataset *rod,
                               const struct wb_bundles_run *run, bool *stale)
{
    char rows[WB_PATH];
    WB_TRY(wb_dataset_read(&result->dataset, rod->path));
    if (!is_solved_by(result, "cantilever"))
        return wb_fail(WB_ERR_DATA, "it was not made by 'solve cantilever'");
    read_numbers(result);
    *stale = true;
    WB_TRY(check_rod(result, run));
    *stale = false;
    WB_TRY(wb_file_join(rows, rod->path, "force_deflection.csv"));
    return wb_hash_file(rows, result->sha256);
}

static void load(struct wb_bundles_result *result, const struct wb_bundles_dataset *wanted,
                 const struct wb_bundles_run *run, bool is_rod)
{
    char file[WB_PATH];
    bool stale = false;
    clear_numbers(&result->numbers);
    result->state = WB_BUNDLES_MISSING;
    if (wb_file_join(file, wanted->path, "dataset.json") != WB_OK || !wb_file_exists(file)) {
        wb_text_append(&result->problem, "there is no such dataset");
        return;
    }
    struct wb_reasons reasons = {&result->problem, wanted->path, wanted->name, true};
    wb_reasons_begin(&reasons);
    const enum wb_status status =
        is_rod ? read_rod(result, wanted, run, &stale) : read_run(result, run, &stale);
    wb_reasons_tell(&reasons);
    result->state = status == WB_OK ? WB_BUNDLES_USABLE
                    : stale         ? WB_BUNDLES_STALE
                                    : WB_BUNDLES_REFUSED;
    if (status != WB_OK && result->problem.length == 0)
        wb_text_append(&result->problem, "%s", wb_status_text(status));
}

void wb_bundles_run_load(struct wb_bundles_result *result, const struct wb_bundles_run *run)
{
    load(result, &run->dataset, run, false);
}

void wb_bundles_run_load_rod(struct wb_bundles_result *result,
                             const struct wb_bundles_bundle *bundle,
                             const struct wb_bundles_run *run)
{
    clear_numbers(&result->numbers);
    if (bundle->has_rod)
        load(result, &bundle->rod, run, true);
}

void wb_bundles_run_release(struct wb_bundles_result *result)
{
    wb_text_release(&result->problem);
    wb_dataset_release(&result->dataset);
    wb_surface_release(&result->surface);
    wb_curve_release(&result->curve);
    free(result->energies);
    free(result->published);
    free(result->error);
    memset(result, 0, sizeof *result);
}

/* --- beside the published curve --- */

static enum wb_status compute_published(struct wb_bundles_result *result,
                                        const struct wb_wire *beam,
                                        const struct wb_calibrate_settings *fit)
{
    const struct wb_curve *const curve = &result->curve;
    const struct wb_computed_settings how = {.n_elements = fit->n_elements,
                                             .n_fibres = fit->n_fibres};
    struct wb_test_info info = result->dataset.info;
    struct wb_computed *computed;
    info.outer_diameter = beam->outer_diameter;
    info.mass_per_length = wb_wire_mass_per_length(beam);
    WB_TRY(wb_computed_create(&computed, &info, &beam->material, &how));
    const enum wb_status status = wb_computed_curve(
        computed, &beam->material, curve->n, curve->step, result->published, &result->n_published);
    wb_computed_destroy(computed);
    return status;
}

enum wb_status wb_bundles_run_compare(struct wb_bundles_result *result,
                                      const struct wb_bundles_run *run,
                                      const struct wb_calibrate_settings *fit)
{
    const struct wb_dataset *const dataset = &result->dataset;
    const struct wb_wire *const beam = wb_bundles_published(run);
    WB_TRY(wb_curve_average(&result->curve, &dataset, 1, fit->step));
    result->rms = result->max_error = result->published_max = (double)NAN;
    if (!beam)
        return WB_OK;
    const int n = result->curve.n;
    result->published = malloc((size_t)n * sizeof *result->published);
    result->error = malloc((size_t)n * sizeof *result->error);
    if (!result->published || !result->error)
        return wb_fail(WB_ERR_MEMORY, "out of memory comparing a bundle");
    WB_TRY(compute_published(result, beam, fit));
    if (result->n_published < n)
        return WB_OK;
    result->published_max = 0.0;
    for (int i = 0; i < n; i++)
        result->published_max = fmax(result->published_max, result->published[i]);
    wb_errors_curve(n, result->published, result->curve.force, result->published_max,
                    result->error);
    result->rms = wb_errors_rms(n, result->error);
    result->max_error = wb_errors_largest(n, result->error);
    return WB_OK;
}
