/* A bundle file in explicit dynamics. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/dataset/simulated_bundle.h"
#include "analysis/solve/bundle_states.h"
#include "analysis/solve/solve_kind.h"
#include "analysis/solve/solve_law.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "fe/bundle/bundle_run.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "solve"

enum {
    MARKERS = 26
};

static const double allowed_imbalance = 0.01;
static const double usual_interval = 600.0; /* s, default time between checkpoints */

/* Inputs and results of a run. */
struct run {
    struct wb_solve solve;
    struct wb_bundle_model model;
    const struct wb_bundle_mesh *mesh;
    struct wb_bundle_result result;
    int attempt; /* shown on the progress line */
    struct wb_bundle_states states;
};

/* Only rank 0 keeps states and shows progress. */
static bool is_first(void)
{
    return wb_team_rank() == 0;
}

static enum wb_status prepare(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const s = run->solve.settings;
    char path[WB_PATH];

    WB_TRY(wb_file_find_fixture(path, "bundles", s->model, NULL));
    WB_TRY(wb_bundle_override_read(&run->model, path, &s->override, NULL));
    run->solve.name = run->model.name;
    for (int i = 0; i < run->model.n_types && is_first(); i++)
        WB_TRY(wb_solve_law_report(&run->model.type[i]));
    run->mesh = wb_bundle_model_mesh(&run->model, run->model.run.mesh);
    run->states = (struct wb_bundle_states){
        .wants_surface = is_first() && s->output,
        .wants_vtk = is_first() && s->vtk,
        .every = s->vtk_every > 0 ? s->vtk_every : 1,
        .turn = run->model.run.rows,
        .series = &run->solve.series,
    };
    return wb_bundle_result_init(&run->result, &run->model, MARKERS);
}

/* --- progress --- */

static bool report_progress(void *context, const struct wb_bundle_progress *now)
{
    struct run *run = context;
    const double rows = wb_bundle_model_rows(&run->model);
    char note[160];

    if (!is_first())
        return true;
    if (now->attempt != run->attempt) {
        if (run->attempt > 0)
            wb_progress_finish(&run->solve.progress);
        wb_progress_start(&run->solve.progress, "solve", "rows", rows);
        wb_progress_resume(&run->solve.progress, now->done * rows);
        run->attempt = now->attempt;
    }
    snprintf(note, sizeof note, "T %.3g s, step %lld, %.2f mm%s", run->result.duration, now->steps,
             now->deflection / WB_MM, now->rests ? ", coming to rest" : "");
    if (isfinite(now->kinetic)) {
        const size_t used = strlen(note);
        snprintf(note + used, sizeof note - used, ", kinetic %.2g, artificial %.2g", now->kinetic,
                 now->artificial);
    }
    wb_progress_update(&run->solve.progress, now->done * rows, note);
    return !wb_interrupted();
}

static enum wb_status report_place(void *context, const struct wb_bundle_result *result,
                                   const struct wb_bundle_row *row, const struct wb_bundle *bundle)
{
    struct run *run = context;
    return is_first() ? wb_bundle_states_take(&run->states, result, row, bundle) : WB_OK;
}

static void visit_states(void *context, struct wb_checkpoint *checkpoint)
{
    struct run *run = context;
    wb_bundle_states_visit(&run->states, checkpoint);
}

static enum wb_status compute(void *context)
{
    struct run *const run = context;
    const struct wb_solve_settings *const s = run->solve.settings;
    const struct wb_bundle_observer observer = {
        .progress = report_progress,
        .place = report_place,
        .visit = visit_states,
        .context = run,
    };
    const struct wb_bundle_run_options options = {
        .mesh = run->mesh->name,
        .threads = s->threads,
        .checkpoint = s->checkpoint,
        .checkpoint_interval =
            s->checkpoint_interval > 0.0 ? s->checkpoint_interval : usual_interval,
        .observer = &observer,
    };
    const enum wb_status status = wb_bundle_run(&run->result, &run->model, &options);

    if (run->attempt > 0)
        wb_progress_finish(&run->solve.progress);
    run->solve.n_rows = run->result.n_rows;
    run->solve.converged = run->result.converged;
    run->solve.stopped = run->result.stopped;
    run->solve.kept = run->result.kept;
    return status;
}

/* --- results --- */

/* The times include all calls that computed it, without the time spent on fields and files. */
static struct wb_simulated_bundle simulated(const struct run *run)
{
    return (struct wb_simulated_bundle){
        .model = &run->model,
        .mesh = run->mesh,
        .result = &run->result,
        .override = &run->solve.settings->override,
        .surface_deflection = run->states.deflection,
        .wall = run->result.wall - run->states.spent.wall,
        .cpu = run->result.cpu - run->states.spent.cpu,
    };
}

static void fill(const void *context, struct wb_dataset *dataset)
{
    const struct wb_simulated_bundle bundle = simulated(context);
    wb_simulated_bundle_fill(dataset, &bundle);
}

static enum wb_status write(const void *context, const struct wb_dataset *dataset,
                            const char *folder)
{
    const struct run *const run = context;
    const struct wb_simulated_bundle bundle = simulated(run);
    WB_TRY(wb_simulated_bundle_write_energies(dataset, &bundle, folder));
    return wb_surface_write(&run->states.surface, folder);
}

static void take_row(const void *context, int index, struct wb_solve_row *out)
{
    const struct run *const run = context;
    const struct wb_bundle_row *const row = &run->result.rows[index];
    *out = (struct wb_solve_row){
        .cycle = row->cycle,
        .phase = row->phase,
        .deflection = row->deflection,
        .tension = row->tension,
        .force = row->force,
        .tip_x = row->tip[0],
        .tip_angle = row->tip_angle,
        .is_spatial = true,
        .tip_z = row->tip[2],
    };
}

static void describe(const void *context, struct wb_json *object)
{
    const struct wb_simulated_bundle bundle = simulated(context);
    wb_simulated_bundle_describe(object, &bundle);
}

static void warn_not_converged(const void *context)
{
    const struct run *const run = context;
    wb_warn("%s: the run failed: %s; %d of %d rows were computed", run->model.name,
            run->result.reason.text, run->result.n_rows, run->result.capacity);
}

static void warn(const void *context)
{
    const struct run *const run = context;
    const struct wb_bundle_result *h = &run->result;
    const char *name = run->model.name;

    if (h->exceeded)
        wb_warn("%s: kinetic over internal energy reaches %.3g with a duration of %.3g s, beyond "
                "the limit of %.3g: the curve is not quasi-static",
                name, h->largest.kinetic, h->duration, run->model.run.kinetic_limit);
    if (h->largest.imbalance > allowed_imbalance)
        wb_warn("%s: the energy balance has an error of up to %.3g of the external work", name,
                h->largest.imbalance);
    if (h->largest.beyond)
        wb_warn("%s: strains reach %.3g, above the range of validity of the elements", name,
                h->largest.strain);
}

static void release(void *context)
{
    struct run *const run = context;
    wb_bundle_states_release(&run->states);
    wb_bundle_result_release(&run->result);
}

const struct wb_solve_kind wb_solve_bundle = {
    .size = sizeof(struct run),
    .prepare = prepare,
    .compute = compute,
    .fill = fill,
    .write = write,
    .row = take_row,
    .describe = describe,
    .warn_not_converged = warn_not_converged,
    .warn = warn,
    .release = release,
};
