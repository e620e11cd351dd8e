/* wirebench solve wire3d and wire1d: a model file, computed as a solid or as a rod. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "analysis/simulated.h"
#include "analysis/wire_fields.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/solve.h"
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
    const struct wb_solve_options *options;
    struct wb_wire_model model;
    struct wb_wire3d *solid; /* either this or the rod */
    struct wb_wire1d *rod;
    struct wb_wire_run run;
    struct wb_fields fields;
    struct wb_vtk_file_series series;
    bool made_output, made_vtk; /* folders that this run created */
    struct wb_progress progress;
    int increments;
    struct wb_solve_time spent; /* computing */
    struct wb_solve_time aside; /* of that, on fields and files */
};

/* Called before the computation, so that an output that cannot be written is found out at once. */
static enum wb_status prepare_folder(const char *folder, bool force, bool *made)
{
    const bool was_there = wb_file_exists(folder);
    WB_TRY(wb_file_prepare_output(folder, force));
    *made = !was_there;
    return WB_OK;
}

static enum wb_status prepare(struct run *run)
{
    const struct wb_solve_options *const o = run->options;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "models", o->model, NULL));
    WB_TRY(wb_wire_model_read(&run->model, path));
    WB_TRY(wb_wire_run_init(&run->run, &run->model, MARKERS));
    if (o->common.output)
        WB_TRY(prepare_folder(o->common.output, o->common.force, &run->made_output));
    if (!o->vtk)
        return WB_OK;
    WB_TRY(prepare_folder(o->vtk, o->common.force, &run->made_vtk));
    return wb_vtk_file_series_init(&run->series, o->vtk, run->model.name);
}

/* --- while it runs --- */

static double norm(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The load at the last row, for the live line. */
static void describe_load(const struct run *run, char *text, size_t size)
{
    text[0] = '\0';
    if (run->run.n_rows == 0)
        return;
    const struct wb_wire_row *const row = &run->run.rows[run->run.n_rows - 1];
    const double moment = norm(row->loads.moment);
    const double force = hypot(norm(row->loads.force), norm(row->loads.follower));
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
    wb_progress_update(&run->progress, done * wb_wire_run_planned_rows(&run->model), note);
    (void)wire_run;
    return !wb_interrupted();
}

/* Stress fields are kept at the end of the last step and of the steps that ask for them. */
static bool keeps_fields(const struct run *run, bool last)
{
    const int step = run->run.rows[run->run.n_rows - 1].step;
    return run->options->common.output && last &&
           (run->model.step[step].fields || step == run->model.n_steps - 1);
}

static enum wb_status take_solid(struct run *run, const char *state)
{
    const struct wb_solid_mesh *const mesh = wb_wire3d_mesh(run->solid);
    struct wb_wire3d_fields fields;
    WB_TRY(wb_wire3d_fields(run->solid, &fields));
    enum wb_status status = WB_OK;
    if (state)
        status = wb_wire_fields_solid(&run->fields, &run->model, state, mesh, &fields);
    if (status == WB_OK && run->options->vtk)
        status = wb_vtk_add(&run->series, run->series.n, mesh, &fields);
    wb_wire3d_fields_release(&fields);
    return status;
}

static enum wb_status report_row(void *context, const struct wb_wire_run *wire_run, bool last)
{
    struct run *const run = context;
    const struct wb_wire_row *const row = &wire_run->rows[wire_run->n_rows - 1];
    const char *const state = keeps_fields(run, last) ? run->model.step[row->step].name : NULL;
    const struct wb_solve_time start = wb_solve_now();
    enum wb_status status = WB_OK;
    if (run->solid && (state || run->options->vtk))
        status = take_solid(run, state);
    else if (run->rod && state)
        status = wb_wire_fields_rod(&run->fields, &run->model, state, run->rod, SLICES);
    const struct wb_solve_time end = wb_solve_now();
    run->aside.wall += end.wall - start.wall;
    run->aside.cpu += end.cpu - start.cpu;
    return status;
}

static enum wb_status solve(struct run *run)
{
    const struct wb_wire_observer observer = {
        .increment = report_increment,
        .row = report_row,
        .context = run,
    };
    if (run->options->kind == WB_SOLVE_WIRE3D) {
        WB_TRY(wb_wire3d_create(&run->solid, &run->model));
        return wb_wire3d_run(run->solid, &run->run, &observer);
    }
    WB_TRY(wb_wire1d_create(&run->rod, &run->model, NULL));
    return wb_wire1d_run(run->rod, &run->run, &observer);
}

static enum wb_status compute(struct run *run)
{
    const struct wb_solve_time start = wb_solve_now();
    wb_progress_start(&run->progress, "solve", "rows", wb_wire_run_planned_rows(&run->model));
    const enum wb_status status = solve(run);
    wb_progress_finish(&run->progress);
    const struct wb_solve_time end = wb_solve_now();
    run->spent.wall = end.wall - start.wall - run->aside.wall;
    run->spent.cpu = end.cpu - start.cpu - run->aside.cpu;
    return status;
}

/* --- results --- */

/* Largest memory of the process, bytes; 0 where the system does not say. */
static double peak_memory(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * (double)usage.ru_maxrss : 0.0;
}

static enum wb_status write_dataset(const struct run *run)
{
    const char *const folder = run->options->common.output;
    struct wb_wire3d_balance balance;
    struct wb_simulated_wire wire = {
        .solver = run->options->kind_name,
        .model = &run->model,
        .run = &run->run,
        .wall = run->spent.wall,
        .cpu = run->spent.cpu,
        .peak_memory = peak_memory(),
    };
    struct wb_dataset dataset;

    if (run->solid) {
        wb_wire3d_balance(run->solid, &balance);
        wire.balance = &balance;
    }
    WB_TRY(wb_dataset_init(&dataset));
    enum wb_status status = wb_simulated_fill_wire(&dataset, &wire);
    /* That the folder may be overwritten was checked before the computation. */
    if (status == WB_OK)
        status = wb_dataset_begin(folder, true);
    if (status == WB_OK)
        status = wb_fields_write(&run->fields, folder);
    if (status == WB_OK)
        status = wb_dataset_finish(&dataset, folder);
    wb_dataset_release(&dataset);
    return status;
}

static struct wb_solve_point point_of(const struct wb_wire_row *row)
{
    return (struct wb_solve_point){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->tip[1],
        .tension = row->tension,
        .force = row->force,
        .tip_x = row->tip[0],
        .tip_angle = row->tip_angle,
    };
}

static int print_json(const struct run *run)
{
    struct wb_json *const root = wb_json_create();
    struct wb_json *const points = wb_json_set_array(root, "points");

    for (int i = 0; i < run->run.n_rows; i++) {
        const struct wb_wire_row *const row = &run->run.rows[i];
        const struct wb_solve_point point = point_of(row);
        struct wb_json *const object = wb_json_append_object(points);
        wb_solve_set_point(object, &point);
        wb_json_set_number(object, "tip_z_mm", row->tip[2] / WB_MM);
        wb_json_set_text(object, "step", run->model.step[row->step].name);
    }
    wb_json_set_boolean(root, "converged", run->run.converged);
    wb_json_set_number(root, "wall_s", run->spent.wall);
    wb_json_set_number(root, "cpu_s", run->spent.cpu);
    wb_json_set_integer(root, "elements", run->run.n_elements);
    wb_json_set_integer(root, "degrees_of_freedom", run->run.n_unknowns);
    wb_json_set_integer(root, "increments", run->run.increments);
    wb_json_set_integer(root, "iterations", run->run.iterations);
    wb_json_set_number(root, "peak_memory_MB", peak_memory() / 1e6);
    if (!run->run.converged)
        wb_json_set_text(root, "problem", run->run.problem);
    return wb_command_print_json(root);
}

static void print_csv(const struct run *run)
{
    wb_solve_print_header();
    for (int i = 0; i < run->run.n_rows; i++) {
        const struct wb_solve_point point = point_of(&run->run.rows[i]);
        wb_solve_print_point(&point);
    }
}

static void warn_of_sliding(const struct run *run)
{
    struct wb_wire3d_balance balance;
    if (!run->solid)
        return;
    wb_wire3d_balance(run->solid, &balance);
    if (balance.sliding > balance.slip_limit)
        wb_warn("%s: core and jacket slide by %.3g mm; contact is computed for small sliding, up "
                "to %.3g mm with this mesh: do not trust what depends on the interface",
                run->model.name, balance.sliding / WB_MM, balance.slip_limit / WB_MM);
}

static int deliver(const struct run *run)
{
    const struct wb_command_common *const common = &run->options->common;
    int code = WB_EXIT_OK;
    if (common->output && run->run.n_rows > 0)
        code = wb_command_exit(write_dataset(run));
    if (code == WB_EXIT_OK && common->json)
        code = print_json(run);
    else if (code == WB_EXIT_OK && !common->output)
        print_csv(run);
    if (code != WB_EXIT_OK)
        return code;

    if (!run->run.converged)
        wb_warn("%s: did not converge: %s; %d of %d rows were computed", run->model.name,
                run->run.problem, run->run.n_rows, wb_wire_run_planned_rows(&run->model));
    if (run->run.stopped)
        wb_warn("stopped after %d rows", run->run.n_rows);
    warn_of_sliding(run);
    return run->run.converged && !run->run.stopped ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

/* Removes folders that were created but have received no file. */
static void clean_up(const struct run *run)
{
    if (run->made_output)
        (void)rmdir(run->options->common.output);
    if (run->made_vtk)
        (void)rmdir(run->options->vtk);
}

int wb_solve_wire(const struct wb_solve_options *options)
{
    struct run *const run = calloc(1, sizeof *run);
    if (!run)
        return wb_command_exit(wb_fail(WB_ERR_MEMORY, "out of memory"));
    run->options = options;
    enum wb_status status = prepare(run);
    if (status == WB_OK)
        status = compute(run);
    const int code = status == WB_OK ? deliver(run) : wb_command_exit(status);

    clean_up(run);
    wb_vtk_file_series_release(&run->series);
    wb_fields_release(&run->fields);
    wb_wire_run_release(&run->run);
    wb_wire1d_destroy(run->rod);
    wb_wire3d_destroy(run->solid);
    free(run);
    return code;
}
