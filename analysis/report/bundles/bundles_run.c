#include "analysis/report/bundles/bundles_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/errors.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

double wb_bundles_run_cost(const struct wb_bundles_run *run)
{
    const double elements = (double)wb_bundle_model_hexahedra(run->model, run->mesh);
    return run->model->run.duration > 0.0 ? elements : 2.0 * elements;
}

/* --- dataset.json --- */

static void read_numbers(struct wb_bundles_result *result)
{
    const struct wb_json *const simulation = wb_simulation_of(&result->simulation);
    const struct wb_json *const largest = wb_json_get(simulation, "largest");
    struct wb_bundles_numbers *const n = &result->numbers;
    n->elements = wb_simulation_number(simulation, "elements");
    n->shells = wb_simulation_number(simulation, "shells");
    n->steps = wb_simulation_number(simulation, "steps");
    n->time_step = wb_simulation_number(simulation, "time_step_s");
    n->duration = wb_simulation_number(simulation, "duration_s");
    n->ns = wb_simulation_number(simulation, "ns_per_element_step");
    n->kinetic = wb_simulation_number(largest, "kinetic_over_internal");
    n->artificial = wb_simulation_number(largest, "artificial_over_internal");
    n->imbalance = wb_simulation_number(largest, "imbalance_over_external");
    n->strain = wb_simulation_number(largest, "strain");
    n->penetration = wb_simulation_number(largest, "penetration_mm") * WB_MM;
    (void)wb_json_get_boolean(largest, "beyond_strain_limit", &result->beyond);
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
        .friction = v[9],
        .artificial = v[10],
    };
    return true;
}

static enum wb_status parse_energies(struct wb_bundles_result *result, char *text, const char *path,
                                     struct wb_reason *why)
{
    char *line = strsep(&text, "\n");
    result->energies = wb_memory_new(result->simulation.dataset.n_rows, sizeof *result->energies);
    if (strcmp(line, energies_header) != 0)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s:1: expected the columns %s", path,
                          energies_header);
    while (text && (line = strsep(&text, "\n")) && line[0]) {
        const int n = result->n_energies;
        if (n == (int)result->simulation.dataset.n_rows)
            return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: more rows than force_deflection.csv",
                              path, n + 2);
        if (!parse_energy(line, &result->energies[n]))
            return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: expected %d numbers", path, n + 2,
                              COLUMNS);
        result->n_energies++;
    }
    if (result->n_energies != (int)result->simulation.dataset.n_rows)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: expected a row: force_deflection.csv has %zu",
                          path, result->n_energies + 2, result->simulation.dataset.n_rows);
    return WB_OK;
}

static enum wb_status read_energies(struct wb_bundles_result *result, const char *folder,
                                    struct wb_reason *why)
{
    char path[WB_PATH], *text;
    WB_TRY(wb_file_join(path, folder, "energies.csv"));
    WB_TRY(wb_file_read_with_reason(path, &text, NULL, why));
    const enum wb_status status = parse_energies(result, text, path, why);
    free(text);
    return status;
}

/* --- loading --- */

/* A dataset while it is read. */
struct loading {
    struct wb_bundles_result *result;
    const char *folder;
};

static enum wb_status take_bundle(void *context, struct wb_reason *why)
{
    const struct loading *const loading = context;
    read_numbers(loading->result);
    WB_TRY(read_energies(loading->result, loading->folder, why));
    return wb_surface_read(&loading->result->surface, loading->folder, why);
}

void wb_bundles_run_load(struct wb_bundles_result *result, const struct wb_bundles_run *run)
{
    struct loading loading = {result, run->dataset.path};
    const struct wb_simulation_reader reader = {take_bundle, &loading};
    wb_simulation_load(&result->simulation, &run->dataset, &reader);
}

void wb_bundles_run_release(struct wb_bundles_result *result)
{
    wb_simulation_result_release(&result->simulation);
    wb_surface_release(&result->surface);
    wb_curve_release(&result->curve);
    free(result->energies);
    free(result->published);
    free(result->error);
    memset(result, 0, sizeof *result);
}

/* --- beside the published curve --- */

enum wb_status wb_bundles_run_beam(double *force, int *n_reached,
                                   const struct wb_bundles_result *result,
                                   const struct wb_test_info *info,
                                   const struct wb_material *material,
                                   const struct wb_calibrate_settings *fit, struct wb_reason *why)
{
    const struct wb_computed_settings how = {
        .n_elements = fit->n_elements, .n_fibres = fit->n_fibres, .why = why};
    struct wb_computed *computed;
    WB_TRY(wb_computed_create(&computed, info, material, &how));
    const enum wb_status status = wb_computed_curve(computed, material, result->curve.n,
                                                    result->curve.step, force, n_reached);
    wb_computed_destroy(computed);
    return status;
}

enum wb_status wb_bundles_run_compare(struct wb_bundles_result *result,
                                      const struct wb_bundles_run *run,
                                      const struct wb_calibrate_settings *fit,
                                      struct wb_reason *why)
{
    const struct wb_dataset *const dataset = &result->simulation.dataset;
    const struct wb_wire *const beam = wb_bundles_published(run);
    const struct wb_curve_grid grid = {.step = fit->step};
    WB_TRY(wb_curve_average_on(&result->curve, &dataset, 1, &grid, why));
    result->rms = result->max_error = result->published_max = (double)NAN;
    if (!beam)
        return WB_OK;
    const int n = result->curve.n;
    result->published = wb_memory_new((size_t)n, sizeof *result->published);
    result->error = wb_memory_new((size_t)n, sizeof *result->error);
    struct wb_test_info info = dataset->info;
    info.outer_diameter = beam->outer_diameter;
    info.mass_per_length = wb_wire_mass_per_length(beam);
    WB_TRY(wb_bundles_run_beam(result->published, &result->n_published, result, &info,
                               &beam->material, fit, why));
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
