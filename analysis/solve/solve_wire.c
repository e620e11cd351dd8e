/* A wire of a model file, computed as a solid or as a rod. */
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

#include "analysis/dataset/simulated.h"
#include "analysis/dataset/wire_fields.h"
#include "analysis/solve/solve_kind.h"
#include "analysis/solve/solve_law.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "base/vec3.h"
#include "fe/output/vtk.h"
#include "fe/trial/wire1d.h"
#include "fe/trial/wire3d.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 26,
    SLICES = 50 /* of a rod's longitudinal section */
};

/* Inputs and results of a run. */
struct run {
    struct wb_solve solve;
    struct wb_wire_model model;
    struct wb_wire3d *solid; /* either this or the rod */
    struct wb_wire1d *rod;
    struct wb_wire_run run;
    struct wb_fields fields;
    int increments;
};

static enum wb_status prepare(void *context)
{
    struct run *const run = context;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "models", run->solve.settings->model, NULL));
    WB_TRY(wb_wire_model_read(&run->model, path));
    run->solve.name = run->model.name;
    if (run->model.is_homogenised)
        WB_TRY(wb_solve_law_report(&run->model.wire));
    return wb_wire_run_init(&run->run, &run->model, MARKERS);
}

/* --- progress --- */

/* The load at the last row, for the progress line. */
static void describe_load(const struct run *run, char *text, size_t size)
{
    text[0] = '\0';
    if (run->run.n_rows == 0)
        return;
    const struct wb_wire_row *const row = &run->run.rows[run->run.n_rows - 1];
    const double moment = wb_vec3_length(row->loads.moment);
    const double force =
        hypot(wb_vec3_length(row->loads.force), wb_vec3_length(row->loads.follower));
    if (run->model.step[row->step].kind != WB_WIRE_STEP_LOADS)
        snprintf(text, size, "%.3g mm %.3g N", row->tip[1] / WB_MM, row->tension);
    else if (moment > 0.0)
        snprintf(text, size, "%.3g N %.3g N m", force, moment);
    else
        snprintf(text, size, "%.3g N", force);
}

static bool report_increment(void *context, const struct wb_wire_run *wire_run, int step,
                             double fraction, int iterations, double done)
{
    struct run *const run = context;
    char load[64], note[128];
    (void)step, (void)fraction;
    run->increments++;
    describe_load(run, load, sizeof load);
    snprintf(note, sizeof note, "increment %d, %d iterations, %s", run->increments, iterations,
             load);
    wb_progress_update(&run->solve.progress, done * wb_wire_run_planned_rows(&run->model), note);
    (void)wire_run;
    return !wb_interrupted();
}

/* Stress fields are kept at the end of the last step and of the steps that request them. */
static bool keeps_fields(const struct run *run, bool last)
{
    const int step = run->run.rows[run->run.n_rows - 1].step;
    return run->solve.settings->output && last &&
           (run->model.step[step].fields || step == run->model.n_steps - 1);
}

static enum wb_status take_solid(struct run *run, const char *state)
{
    const struct wb_solid_mesh *const mesh = wb_wire3d_mesh(run->solid);
    struct wb_wire3d_fields fields;
    wb_wire3d_fields(run->solid, &fields);
    enum wb_status status = WB_OK;
    if (state)
        status = wb_wire_fields_solid(&run->fields, &run->model, state, mesh, &fields);
    if (status == WB_OK && run->solve.settings->vtk)
        status = wb_vtk_add(&run->solve.series, run->solve.series.n, mesh, &fields);
    wb_wire3d_fields_release(&fields);
    return status;
}

static enum wb_status report_row(void *context, const struct wb_wire_run *wire_run, bool last)
{
    struct run *const run = context;
    const struct wb_wire_row *const row = &wire_run->rows[wire_run->n_rows - 1];
    const char *const state = keeps_fields(run, last) ? run->model.step[row->step].name : NULL;
    const struct wb_solve_time start = wb_solve_time_now();
    enum wb_status status = WB_OK;
    if (run->solid && (state || run->solve.settings->vtk))
        status = take_solid(run, state);
    else if (run->rod && state)
        status = wb_wire_fields_rod(&run->fields, &run->model, state, run->rod, SLICES);
    wb_solve_time_add(&run->solve.aside, &start);
    return status;
}

static enum wb_status solve(struct run *run)
{
    const struct wb_wire_observer observer = {
        .increment = report_increment,
        .row = report_row,
        .context = run,
    };
    if (run->solve.settings->kind == WB_SOLVE_WIRE3D) {
        WB_TRY(wb_wire3d_create(&run->solid, &run->model));
        return wb_wire3d_run(run->solid, &run->run, &observer);
    }
    WB_TRY(wb_wire1d_create(&run->rod, &run->model, NULL));
    return wb_wire1d_run(run->rod, &run->run, &observer);
}

static enum wb_status compute(void *context)
{
    struct run *const run = context;
    wb_progress_start(&run->solve.progress, "solve", "rows", wb_wire_run_planned_rows(&run->model));
    const enum wb_status status = solve(run);
    wb_progress_finish(&run->solve.progress);
    run->solve.n_rows = run->run.n_rows;
    run->solve.converged = run->run.converged;
    run->solve.stopped = run->run.stopped;
    return status;
}

/* --- results --- */

/* Peak memory of the process, bytes; 0 if the system does not report it. */
static double peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * (double)usage.ru_maxrss : 0.0;
}

static void fill(const void *context, struct wb_dataset *dataset)
{
    const struct run *const run = context;
    struct wb_wire3d_balance balance;
    struct wb_simulated_wire wire = {
        .solver = wb_solve_settings_kind(run->solve.settings),
        .model = &run->model,
        .run = &run->run,
        .wall = run->solve.spent.wall,
        .cpu = run->solve.spent.cpu,
        .peak_memory = peak_memory(),
    };

    if (run->solid) {
        wb_wire3d_balance(run->solid, &balance);
        wire.balance = &balance;
    }
    wb_simulated_fill_wire(dataset, &wire);
}

static enum wb_status write(const void *context, const struct wb_dataset *dataset,
                            const char *folder)
{
    const struct run *const run = context;
    (void)dataset;
    return wb_fields_write(&run->fields, folder);
}

static void take_row(const void *context, int index, struct wb_solve_row *out)
{
    const struct run *const run = context;
    const struct wb_wire_row *const row = &run->run.rows[index];
    *out = (struct wb_solve_row){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->tip[1],
        .tension = row->tension,
        .force = row->force,
        .tip_x = row->tip[0],
        .tip_angle = row->tip_angle,
        .is_spatial = true,
        .tip_z = row->tip[2],
        .step = run->model.step[row->step].name,
    };
}

static void describe(const void *context, struct wb_json *object)
{
    const struct run *const run = context;
    wb_json_set_boolean(object, "converged", run->run.converged);
    wb_json_set_number(object, "wall_s", run->solve.spent.wall);
    wb_json_set_number(object, "cpu_s", run->solve.spent.cpu);
    wb_json_set_integer(object, "elements", run->run.n_elements);
    wb_json_set_integer(object, "degrees_of_freedom", run->run.n_unknowns);
    wb_json_set_integer(object, "increments", run->run.increments);
    wb_json_set_integer(object, "iterations", run->run.iterations);
    wb_json_set_number(object, "peak_memory_MB", peak_memory() / 1e6);
    if (!run->run.converged)
        wb_json_set_text(object, "problem", run->run.problem);
}

static void warn_not_converged(const void *context)
{
    const struct run *const run = context;
    wb_warn("%s: did not converge: %s; %d of %d rows were computed", run->model.name,
            run->run.problem, run->run.n_rows, wb_wire_run_planned_rows(&run->model));
}

static void warn_of_sliding(const void *context)
{
    const struct run *const run = context;
    struct wb_wire3d_balance balance;
    if (!run->solid)
        return;
    wb_wire3d_balance(run->solid, &balance);
    if (balance.sliding > balance.slip_limit)
        wb_warn("%s: core and jacket slide by %.3g mm, but contact assumes small sliding, up to "
                "%.3g mm with this mesh: results that depend on the interface are not reliable",
                run->model.name, balance.sliding / WB_MM, balance.slip_limit / WB_MM);
}

static void release(void *context)
{
    struct run *const run = context;
    wb_fields_release(&run->fields);
    wb_wire_run_release(&run->run);
    wb_wire1d_destroy(run->rod);
    wb_wire3d_destroy(run->solid);
}

const struct wb_solve_kind wb_solve_wire = {
    .size = sizeof(struct run),
    .prepare = prepare,
    .compute = compute,
    .fill = fill,
    .write = write,
    .row = take_row,
    .describe = describe,
    .warn_not_converged = warn_not_converged,
    .warn = warn_of_sliding,
    .release = release,
};
