#include "cli/solve_harness.h"

#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_bands.h"
#include "analysis/harness/harness_bands_output.h"
#include "analysis/harness/harness_drawing.h"
#include "analysis/harness/harness_found.h"
#include "analysis/harness/harness_gltf.h"
#include "analysis/harness/harness_output.h"
#include "analysis/harness/harness_vtk.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/solve_harness_follow.h"
#include "cli/solve_harness_parts.h"

#define WB_LOG_DOMAIN "solve"

struct watched {
    struct wb_progress progress;
    const struct wb_harness_plan *plan;
};

static bool watch(void *context, int step, double fraction)
{
    struct watched *const watched = context;
    wb_progress_update(&watched->progress, step + fraction, watched->plan->steps[step].name);
    return !wb_interrupted();
}

/* Releases after a calibration on loading only: the hardening rule is then an assumption. */
static void warn_of_unloading(const struct wb_harness_plan *plan)
{
    for (int i = 0; i < plan->n_steps; i++) {
        const struct wb_harness_step *const step = &plan->steps[i];
        if (step->kind != WB_HARNESS_RELEASE && step->kind != WB_HARNESS_TAKE_OFF)
            continue;
        struct wb_text names = {0};
        for (int w = 0; w < plan->n_wires; w++) {
            if (!plan->wires[w].has_unloading)
                wb_text_append(&names, "%s%s (%s)", names.length > 0 ? ", " : "",
                               plan->wires[w].name, plan->wires[w].file);
        }
        if (names.length > 0)
            wb_warn("step %d, %s: fitted on loading only: %s; what springs back follows from an "
                    "assumed hardening rule",
                    i + 1, step->name, wb_text_string(&names));
        wb_text_release(&names);
    }
}

static void warn_not_converged(const struct wb_harness_result_set *set)
{
    const struct wb_harness_step_result *const last = &set->results[set->n_steps - 1];
    const struct wb_harness_step *const step = &set->plan->steps[set->n_steps - 1];
    if (set->converged)
        return;
    if (last->end == WB_HARNESS_STOPPED)
        wb_warn("stopped in step %d, %s, at %.3g of it", set->n_steps, step->name, last->fraction);
    else
        wb_warn("step %d, %s, ends at %.3g of it, in branch %s: %s", set->n_steps, step->name,
                last->fraction,
                last->worst_branch < 0 ? "(root)" : set->plan->branches[last->worst_branch].name,
                last->problem);
}

/* Wires whose tests were made on a virtual rig. */
static void append_virtual(struct wb_text *text, const struct wb_harness_plan *plan)
{
    const char *between = "; calibrated on a virtual rig: ";
    for (int i = 0; i < plan->n_wires; i++) {
        if (!plan->wires[i].is_virtual)
            continue;
        wb_text_append(text, "%s%s", between, plan->wires[i].name);
        between = ", ";
    }
}

static void warn_of_deviants(const struct wb_harness_bands *bands)
{
    struct wb_text text = {0};
    wb_harness_bands_output_append_deviants(&text, bands);
    if (text.length > 0)
        wb_warn("%s", wb_text_string(&text));
    wb_text_release(&text);
}

static void append_trust(struct wb_text *text, const struct wb_harness_result_set *set)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_harness_found found;
    const char *between = "; ";
    wb_harness_found_collect(&found, set);
    wb_text_append(text, set->converged ? "complete" : "in part: see the warning");
    if (found.n_exceeded > 0)
        wb_text_append(text, "; LIMITS EXCEEDED");
    for (int b = 0; b < plan->n_branches; b++) {
        if (!wb_harness_found_is_beyond(set, b))
            continue;
        wb_text_append(text, "%s%s", between, plan->branches[b].name);
        between = ", ";
    }
    if (between[0] == ',')
        wb_text_append(text, " bent beyond the calibration");
    if (found.n_twist > 0)
        wb_text_append(text, "; %d of %d items depend on GJ, which is not measured", found.n_twist,
                       plan->n_items);
    append_virtual(text, plan);
    wb_text_append(text, "; computed, not compared with a measurement");
}

static enum wb_status deliver(const struct wb_command_common *common,
                              const struct wb_solve_settings *settings, const char *figure,
                              const struct wb_harness_result_set *set,
                              const struct wb_harness_bands *bands)
{
    struct wb_text table = {0};
    struct wb_finding finding = {.figure = figure[0] ? figure : NULL};
    if (common->output)
        WB_TRY(wb_harness_output_write(set, bands, common->output));
    if (finding.figure)
        WB_TRY(wb_harness_drawing_write(set, figure));
    if (settings->vtk)
        WB_TRY(wb_harness_vtk_write(set, settings->vtk));
    if (settings->gltf)
        WB_TRY(wb_harness_gltf_write(set, settings->gltf));
    warn_not_converged(set);
    if (bands)
        warn_of_deviants(bands);
    if (common->json) {
        struct wb_json *const root = wb_json_create();
        wb_harness_output_put(root, set, bands);
        wb_command_print_json(root);
        return WB_OK;
    }
    wb_harness_output_append_table(&table, set);
    if (bands)
        wb_harness_bands_output_append_table(&table, bands);
    fputs(wb_text_string(&table), stdout);
    wb_text_release(&table);
    wb_harness_output_append_finding(&finding.found, set);
    append_trust(&finding.trust, set);
    if (settings->vtk)
        wb_finding_append_command(&finding.next, "open the .pvd file in %s with ParaView",
                                  settings->vtk);
    else if (settings->gltf)
        wb_finding_append_command(&finding.next, "open %s with a glTF viewer", settings->gltf);
    else if (!common->output)
        wb_finding_append_command(&finding.next,
                                  "wirebench solve harness %s -o DIR, for shapes "
                                  "and forces as tables",
                                  settings->model);
    else if (!set->settings.is_elastic)
        wb_finding_append_command(&finding.next,
                                  "wirebench solve harness %s --law elastic, for "
                                  "the same without yielding",
                                  settings->model);
    wb_finding_print(&finding);
    return WB_OK;
}

static enum wb_status compute(const struct wb_command_common *common,
                              const struct wb_solve_settings *settings, const char *figure,
                              struct wb_harness_plan *plan, struct wb_harness_result_set *set)
{
    const struct wb_harness_settings s = {.is_elastic = settings->law == WB_SOLVE_ELASTIC,
                                          .torsion = 1.0,
                                          .frames = settings->frames};
    struct watched watched = {.plan = plan};
    char path[WB_PATH];
    WB_TRY(wb_file_find_fixture(path, "harnesses", settings->model, NULL));
    WB_TRY(wb_file_kind_check(path, WB_FILE_BIT(WB_FILE_HARNESS)));
    WB_TRY(wb_solve_settings_check(settings));
    WB_TRY(wb_harness_file_read(plan, path));
    if (settings->uncertain)
        WB_TRY(wb_harness_bands_check(plan, settings->runs));
    if (settings->part)
        WB_TRY(wb_solve_harness_parts_check(settings));
    if (common->output)
        WB_TRY(wb_file_prepare_output(common->output, common->force));
    if (settings->vtk)
        WB_TRY(wb_file_prepare_output(settings->vtk, common->force));
    if (settings->gltf)
        WB_TRY(wb_command_check_output(settings->gltf, common->force));
    if (figure[0])
        WB_TRY(wb_finding_check_figure(figure, common->force));
    if (!s.is_elastic)
        warn_of_unloading(plan);
    if (settings->follow)
        return wb_solve_harness_follow(plan, &s);
    wb_progress_start(&watched.progress, "solve", "steps", plan->n_steps);
    const enum wb_status status = wb_harness_run_compute(set, plan, &s, watch, &watched);
    wb_progress_finish(&watched.progress);
    return status;
}

/* Computes all runs, or the part of a job. */
static enum wb_status compute_runs(struct wb_harness_bands *bands,
                                   const struct wb_solve_settings *settings,
                                   const struct wb_jobs_options *jobs, bool *complete)
{
    *complete = true;
    if (wb_jobs_wanted(jobs))
        return wb_solve_harness_parts_run(bands, settings, jobs, complete);
    const enum wb_status status = settings->part
                                      ? wb_solve_harness_parts_compute(bands, settings)
                                      : wb_harness_bands_compute(bands, 0, settings->runs);
    *complete = !bands->stopped;
    if (status == WB_OK && bands->stopped)
        wb_warn("stopped: no bands, because not all runs were computed");
    return status;
}

/* Bands of all runs; *bands stays NULL where they are incomplete, and after results in part. */
static enum wb_status compute_bands(const struct wb_solve_settings *settings,
                                    const struct wb_jobs_options *jobs,
                                    const struct wb_harness_result_set *set,
                                    struct wb_harness_bands **bands, bool *complete)
{
    const struct wb_harness_bands_settings s = {
        .runs = settings->runs,
        .seed = (uint64_t)settings->seed,
        .stop = wb_interrupt_stops,
    };
    struct wb_harness_bands *all;
    *complete = set->converged;
    if (!set->converged)
        return WB_OK;
    WB_TRY(wb_harness_bands_create(&all, set, &s));
    const enum wb_status status = compute_runs(all, settings, jobs, complete);
    if (status == WB_OK && *complete && !settings->part) {
        wb_harness_bands_finish(all);
        *bands = all;
    } else {
        wb_harness_bands_destroy(all);
    }
    return status;
}

int wb_solve_harness(const struct wb_command_common *common,
                     const struct wb_solve_settings *settings, const struct wb_jobs_options *jobs)
{
    struct wb_harness_plan *const plan = wb_memory_new(1, sizeof *plan);
    struct wb_harness_result_set set = {.plan = NULL};
    struct wb_harness_bands *bands = NULL;
    char figure[WB_PATH] = "";
    if (common->output && !common->no_figure)
        wb_finding_folder_figure_path(figure, common->output);
    enum wb_status status = compute(common, settings, figure, plan, &set);
    bool complete = true;
    if (status == WB_OK && settings->follow) {
        complete = !wb_interrupted();
    } else if (status == WB_OK) {
        complete = set.converged;
        if (settings->uncertain)
            status = compute_bands(settings, jobs, &set, &bands, &complete);
        /* Of jobs that are left the next call delivers all. */
        if (status == WB_OK && !settings->part && (complete || !wb_jobs_wanted(jobs)))
            status = deliver(common, settings, figure, &set, bands);
    }
    wb_harness_bands_destroy(bands);
    wb_harness_run_release(&set);
    free(plan);
    if (status == WB_ERR_ARGUMENT)
        return WB_EXIT_USAGE;
    return status == WB_OK && !complete ? WB_EXIT_INCOMPLETE : wb_command_exit(status);
}
