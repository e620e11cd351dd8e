#include "analysis/solve/solve.h"

#include <cblas.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/solve/solve_kind.h"
#include "base/file.h"
#include "base/memory.h"
#include "fe/team/team.h"

#define WB_LOG_DOMAIN "solve"

static bool is_explicit_bundle(const struct wb_solve_settings *settings)
{
    return settings->kind == WB_SOLVE_BUNDLE && settings->bundle_model == WB_SOLVE_EXPLICIT &&
           !settings->uncertain;
}

static const struct wb_solve_kind *find_kind(const struct wb_solve_settings *settings)
{
    const unsigned bit = settings->kind;
    if (bit == WB_SOLVE_BUNDLE && !is_explicit_bundle(settings))
        return &wb_solve_section;
    return bit == WB_SOLVE_CANTILEVER    ? &wb_solve_cantilever
           : bit == WB_SOLVE_BUNDLE      ? &wb_solve_bundle
           : bit == WB_SOLVE_THREE_POINT ? &wb_solve_three_point
                                         : &wb_solve_wire;
}

/* --- preparation --- */

/* Called before the computation, so that an output that cannot be written is reported at once. */
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

/* Only the first rank writes files. */
static bool is_first(void)
{
    return wb_team_rank() == 0;
}

static enum wb_status prepare(struct wb_solve *solve)
{
    const struct wb_solve_settings *const s = solve->settings;

    WB_TRY(solve->kind->prepare(solve));
    WB_TRY(wb_solve_settings_check(solve->settings));
    if (!is_first())
        return WB_OK;
    if (s->checkpoint)
        WB_TRY(try_checkpoint(s->checkpoint));
    if (s->output)
        WB_TRY(prepare_folder(s->output, s->force, &solve->made_output));
    if (!s->vtk)
        return WB_OK;
    /* VTK files in the folder of a resumed run are its own; its dataset is written only at the
     * end. */
    const bool force = s->force || (s->checkpoint && wb_file_exists(s->checkpoint));
    WB_TRY(prepare_folder(s->vtk, force, &solve->made_vtk));
    return wb_vtk_file_series_init(&solve->series, s->vtk, solve->name);
}

static enum wb_status compute(struct wb_solve *solve)
{
    const struct wb_solve_time start = wb_solve_time_now();
    const enum wb_status status = solve->kind->compute(solve);
    wb_solve_time_add(&solve->spent, &start);
    solve->spent.wall -= solve->aside.wall;
    solve->spent.cpu -= solve->aside.cpu;
    return status;
}

/* --- results --- */

static enum wb_status write_dataset(const struct wb_solve *solve)
{
    const char *const folder = solve->settings->output;
    struct wb_dataset dataset;

    wb_dataset_init(&dataset);
    solve->kind->fill(solve, &dataset);
    /* Whether the folder may be overwritten was checked before the computation. */
    enum wb_status status = wb_dataset_begin(folder, true);
    if (status == WB_OK && solve->kind->write)
        status = solve->kind->write(solve, &dataset, folder);
    if (status == WB_OK)
        status = wb_dataset_finish(&dataset, folder);
    wb_dataset_release(&dataset);
    return status;
}

static enum wb_status deliver(const struct wb_solve *solve, wb_solve_show *show, void *context)
{
    const struct wb_solve_settings *const s = solve->settings;
    const char *const rows = solve->n_rows == 1 ? "row" : "rows";

    if (solve->kept) {
        wb_warn("stopped after %d %s; run the same command again to continue ('%s')", solve->n_rows,
                rows, s->checkpoint);
        return WB_OK;
    }
    if (s->output && solve->n_rows > 0)
        WB_TRY(write_dataset(solve));
    if (show)
        WB_TRY(show(context, solve));
    /* The checkpoint is removed only once the result is written. */
    if (s->checkpoint && !solve->stopped)
        (void)unlink(s->checkpoint);
    if (!solve->converged)
        solve->kind->warn_not_converged(solve);
    if (solve->stopped)
        wb_warn("stopped after %d %s", solve->n_rows, rows);
    if (solve->kind->warn)
        solve->kind->warn(solve);
    return WB_OK;
}

int wb_solve_count(const struct wb_solve *solve)
{
    return solve->n_rows;
}

void wb_solve_row(const struct wb_solve *solve, int index, struct wb_solve_row *row)
{
    solve->kind->row(solve, index, row);
}

void wb_solve_describe(const struct wb_solve *solve, struct wb_json *object)
{
    solve->kind->describe(solve, object);
}

bool wb_solve_summarise(const struct wb_solve *solve, struct wb_text *text)
{
    return solve->kind->summarise && solve->kind->summarise(solve, text);
}

/* --- a run --- */

/* Result of a run, the same on all ranks. */
struct outcome {
    enum wb_status status;
    bool complete;
};

static struct outcome run(struct wb_solve *solve, wb_solve_show *show, void *context)
{
    struct outcome outcome = {.status = wb_team_agree(prepare(solve))};
    if (outcome.status == WB_OK)
        outcome.status = compute(solve);
    if (outcome.status == WB_OK && is_first())
        outcome.status = deliver(solve, show, context);
    outcome.complete = solve->converged && !solve->stopped;
    wb_team_share(&outcome, sizeof outcome, 0);

    /* Folders that were created but have received no file are removed. */
    if (solve->made_output)
        (void)rmdir(solve->settings->output);
    if (solve->made_vtk)
        (void)rmdir(solve->settings->vtk);
    solve->kind->release(solve);
    wb_vtk_file_series_release(&solve->series);
    return outcome;
}

static enum wb_status run_in_team(const struct wb_solve_settings *settings, wb_solve_show *show,
                                  void *context, bool *complete)
{
    const struct wb_solve_kind *const kind = find_kind(settings);
    struct wb_solve *const solve = wb_memory_new(1, kind->size);
    solve->kind = kind;
    solve->settings = settings;
    const struct outcome outcome = run(solve, show, context);
    free(solve);
    *complete = outcome.complete;
    return outcome.status;
}

enum wb_status wb_solve_run(const struct wb_solve_settings *settings, wb_solve_show *show,
                            void *context, bool *complete)
{
    *complete = false;
    /* Ranks share the work of an explicit bundle; other kinds are computed completely by each
     * rank. */
    if (!is_explicit_bundle(settings))
        return run_in_team(settings, show, context, complete);
    WB_TRY(wb_team_start());
    if (!is_first())
        wb_log_set_threshold(WB_LOG_ERROR);
    const enum wb_status status = run_in_team(settings, show, context, complete);
    wb_team_end();
    return status;
}

void wb_solve_set_threads(int n)
{
    openblas_set_num_threads(n);
}
