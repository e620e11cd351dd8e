/* wirebench solve bundle: a bundle file in explicit dynamics. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/simulated_bundle.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/bundle_states.h"
#include "cli/solve.h"
#include "fe/bundle/bundle_run.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 26
};

static const double allowed_imbalance = 0.01;

/* Inputs and results of a run. */
struct run {
    const struct wb_solve_options *options;
    struct wb_bundle_model model;
    const struct wb_bundle_mesh *mesh;
    struct wb_bundle_history history;
    struct wb_progress progress;
    int attempt; /* shown by the live line */
    struct wb_bundle_states states;
    bool made_output, made_vtk; /* folders that this run created */
    struct wb_solve_time spent;
};

/* --- before --- */

/* Called before the computation, so that an output that cannot be written is found out at once. */
static enum wb_status prepare_folder(const char *folder, bool force, bool *made)
{
    const bool was_there = wb_file_exists(folder);

    WB_TRY(wb_file_prepare_output(folder, force));
    *made = !was_there;
    return WB_OK;
}

static enum wb_status try_checkpoint(const char *file)
{
    char beside[WB_PATH];

    wb_file_folder(beside, file);
    if (wb_file_is_folder(file))
        return wb_fail(WB_ERR_ARGUMENT, "--checkpoint: '%s' is a folder: expected a file", file);
    if (access(beside, W_OK | X_OK) != 0)
        return wb_fail(WB_ERR_IO, "--checkpoint: no file can be written in '%s': %s", beside,
                       strerror(errno));
    return WB_OK;
}

static enum wb_status prepare_output(struct run *run)
{
    const struct wb_solve_options *o = run->options;

    run->states.wants_surface = o->common.output;
    run->states.wants_vtk = o->vtk;
    run->states.every = o->vtk_every > 0 ? o->vtk_every : 1;
    run->states.turn = run->model.run.rows;
    if (o->checkpoint)
        WB_TRY(try_checkpoint(o->checkpoint));
    if (o->common.output)
        WB_TRY(prepare_folder(o->common.output, o->common.force, &run->made_output));
    if (!o->vtk)
        return WB_OK;
    /* VTK files in the folder of a resumed run are its own; its dataset is written at the end only.
     */
    const bool force = o->common.force || (o->checkpoint && wb_file_exists(o->checkpoint));
    WB_TRY(prepare_folder(o->vtk, force, &run->made_vtk));
    return wb_vtk_file_series_init(&run->states.series, o->vtk, run->model.name);
}

/* Only rank 0 writes files and prints. */
static bool is_first(void)
{
    return wb_team_rank() == 0;
}

static enum wb_status prepare(struct run *run)
{
    const struct wb_solve_options *o = run->options;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "bundles", o->model, NULL));
    WB_TRY(wb_bundle_model_read(&run->model, path));
    WB_TRY(wb_bundle_override_apply(&o->override, &run->model));
    run->mesh = wb_bundle_model_mesh(&run->model, run->model.run.mesh);
    WB_TRY(wb_bundle_run_init(&run->history, &run->model, MARKERS));
    return is_first() ? prepare_output(run) : WB_OK;
}

/* --- while it runs --- */

static bool report_progress(void *context, const struct wb_bundle_progress *now)
{
    struct run *run = context;
    const double rows = wb_bundle_run_planned_rows(&run->model);
    char note[160];

    if (!is_first())
        return true;
    if (now->attempt != run->attempt) {
        if (run->attempt > 0)
            wb_progress_finish(&run->progress);
        wb_progress_start(&run->progress, "solve", "rows", rows);
        wb_progress_resume(&run->progress, now->done * rows);
        run->attempt = now->attempt;
    }
    snprintf(note, sizeof note, "T %.3g s, step %lld, %.2f mm%s", run->history.duration, now->steps,
             now->deflection / WB_MM, now->rests ? ", coming to rest" : "");
    if (isfinite(now->kinetic)) {
        const size_t used = strlen(note);
        snprintf(note + used, sizeof note - used, ", kinetic %.2g, artificial %.2g", now->kinetic,
                 now->artificial);
    }
    wb_progress_update(&run->progress, now->done * rows, note);
    return !wb_interrupted();
}

static enum wb_status report_place(void *context, const struct wb_bundle_history *history,
                                   const struct wb_bundle_row *row, const struct wb_bundle *bundle)
{
    struct run *run = context;
    return is_first() ? wb_bundle_states_take(&run->states, history, row, bundle) : WB_OK;
}

static void visit_states(void *context, struct wb_checkpoint *checkpoint)
{
    struct run *run = context;
    wb_bundle_states_visit(&run->states, checkpoint);
}

static enum wb_status compute(struct run *run)
{
    const struct wb_bundle_observer observer = {
        .progress = report_progress,
        .place = report_place,
        .visit = visit_states,
        .context = run,
    };
    const struct wb_bundle_run_options options = {
        .mesh = run->mesh->name,
        .threads = run->options->threads,
        .checkpoint = run->options->checkpoint,
        .checkpoint_interval = run->options->checkpoint_interval,
        .observer = &observer,
    };
    const enum wb_status status = wb_bundle_run_with(&run->history, &run->model, &options);

    if (run->attempt > 0)
        wb_progress_finish(&run->progress);
    /* Time spent on fields and files is not the solver's. */
    run->spent.wall = run->history.wall - run->states.spent.wall;
    run->spent.cpu = run->history.cpu - run->states.spent.cpu;
    return status;
}

/* --- results --- */

static struct wb_simulated_bundle simulated(const struct run *run)
{
    return (struct wb_simulated_bundle){
        .model = &run->model,
        .mesh = run->mesh,
        .history = &run->history,
        .override = &run->options->override,
        .surface_deflection = run->states.deflection,
        .wall = run->spent.wall,
        .cpu = run->spent.cpu,
    };
}

static enum wb_status write_dataset(const struct run *run)
{
    const char *folder = run->options->common.output;
    const struct wb_simulated_bundle bundle = simulated(run);
    struct wb_dataset dataset;

    WB_TRY(wb_dataset_init(&dataset));
    enum wb_status status = wb_simulated_bundle_fill(&dataset, &bundle);
    /* That the folder may be overwritten was checked before the computation. */
    if (status == WB_OK)
        status = wb_dataset_begin(folder, true);
    if (status == WB_OK)
        status = wb_simulated_bundle_write_energies(&dataset, &bundle, folder);
    if (status == WB_OK)
        status = wb_surface_write(&run->states.surface, folder);
    if (status == WB_OK)
        status = wb_dataset_finish(&dataset, folder);
    wb_dataset_release(&dataset);
    return status;
}

static struct wb_solve_point point_of(const struct wb_bundle_row *row)
{
    return (struct wb_solve_point){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->deflection,
        .tension = row->tension,
        .force = row->force,
        .tip_x = row->tip[0],
        .tip_angle = row->tip_angle,
    };
}

static int print_json(const struct run *run)
{
    const struct wb_simulated_bundle bundle = simulated(run);
    struct wb_json *const root = wb_json_create();
    struct wb_json *const points = wb_json_set_array(root, "points");

    for (int i = 0; i < run->history.n_rows; i++) {
        const struct wb_solve_point point = point_of(&run->history.rows[i]);
        struct wb_json *const object = wb_json_append_object(points);
        wb_solve_set_point(object, &point);
        wb_json_set_number(object, "tip_z_mm", run->history.rows[i].tip[2] / WB_MM);
    }
    wb_simulated_bundle_describe(root, &bundle);
    return wb_command_print_json(root);
}

static void print_csv(const struct run *run)
{
    wb_solve_print_header();
    for (int i = 0; i < run->history.n_rows; i++) {
        const struct wb_solve_point point = point_of(&run->history.rows[i]);
        wb_solve_print_point(&point);
    }
}

/* Warns of what a reader of the curve must know. */
static void warn(const struct run *run)
{
    const struct wb_bundle_history *h = &run->history;
    const char *name = run->model.name;

    if (!h->converged)
        wb_warn("%s: the run was lost: %s; %d of %d rows were computed", name, h->problem,
                h->n_rows, h->capacity);
    if (h->stopped)
        wb_warn("stopped after %d rows", h->n_rows);
    if (h->exceeded)
        wb_warn("%s: kinetic over internal energy reaches %.3g with a duration of %.3g s, beyond "
                "the limit of %.3g: the curve is not quasi-static",
                name, h->largest.kinetic, h->duration, run->model.run.kinetic_limit);
    if (h->largest.imbalance > allowed_imbalance)
        wb_warn("%s: the energy balance is off by up to %.3g of the external work", name,
                h->largest.imbalance);
    if (h->largest.beyond)
        wb_warn("%s: strains reach %.3g, beyond what the elements are made for", name,
                h->largest.strain);
}

static int deliver(const struct run *run)
{
    const struct wb_command_common *common = &run->options->common;
    const char *checkpoint = run->options->checkpoint;
    const struct wb_bundle_history *h = &run->history;
    int code = WB_EXIT_OK;

    if (h->kept) {
        wb_warn("stopped after %d rows; the same command goes on from there ('%s')", h->n_rows,
                checkpoint);
        return WB_EXIT_INCOMPLETE;
    }
    if (common->output && h->n_rows > 0)
        code = wb_command_exit(write_dataset(run));
    if (code == WB_EXIT_OK && common->json)
        code = print_json(run);
    else if (code == WB_EXIT_OK && !common->output)
        print_csv(run);
    if (code != WB_EXIT_OK)
        return code;
    /* The checkpoint is removed only once the result is written. */
    if (checkpoint && !h->stopped)
        (void)unlink(checkpoint);
    warn(run);
    return h->converged && !h->stopped ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}

static int solve(const struct wb_solve_options *options)
{
    struct run *const run = calloc(1, sizeof *run);
    if (!run)
        return wb_command_exit(wb_fail(WB_ERR_MEMORY, "out of memory"));
    run->options = options;
    enum wb_status status = wb_team_agree(prepare(run));
    if (status == WB_OK)
        status = compute(run);
    int code = wb_command_exit(status);
    if (status == WB_OK && is_first())
        code = deliver(run);
    wb_team_share(&code, sizeof code, 0);

    /* Folders that were created but have received no file are removed. */
    if (run->made_output)
        (void)rmdir(options->common.output);
    if (run->made_vtk)
        (void)rmdir(options->vtk);
    wb_bundle_states_release(&run->states);
    wb_bundle_run_release(&run->history);
    free(run);
    return code;
}

int wb_solve_bundle(const struct wb_solve_options *options)
{
    const enum wb_status status = wb_team_start();
    if (status != WB_OK)
        return wb_command_exit(status);
    if (!is_first())
        wb_log_set_threshold(WB_LOG_ERROR);
    const int code = solve(options);
    wb_team_end();
    return code;
}
