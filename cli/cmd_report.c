/* wirebench report: a campaign's recordings, or its simulations, become its report. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/jobs/jobs.h"
#include "analysis/report/bench/recordings_report.h"
#include "analysis/report/bundles/bundles_report.h"
#include "analysis/report/wires/wires_report.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/job_options.h"

#define WB_LOG_DOMAIN "report"

struct options {
    struct wb_command_common common;
    int threads;
    struct wb_jobs_options jobs; /* for datasets that are missing */
};

enum {
    KEY_THREADS = WB_KEY_OWN
};

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Folder to write", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Replace the report that the folder holds", 0},
    {"threads", KEY_THREADS, "N", 0, "Threads to compute on (as many as cores, 4 at most)", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print all numbers as one JSON object", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const o = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &o->jobs;
        return 0;
    case KEY_THREADS:
        o->threads = wb_command_integer(state, "--threads", argument, 1, 16);
        return 0;
    default:
        return wb_command_parse_common(key, argument, state, &o->common);
    }
}

static const struct argp_child children[] = {{&wb_job_options_argp, 0, NULL, 0}, {0}};

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "CAMPAIGN.yaml",
    .doc =
        "Aligns the recordings of a campaign, calibrates and validates its wires and writes the "
        "report: report.pdf, report.html, report.json and figures/ (SVG and PNG). A campaign of "
        "the kind `comparison` compares datasets that `solve` made of wire models, one of the "
        "kind `bundles` those of bundles.\v"
        "What is missing or cannot be used is named in the report (exit code 3). Exit code 4: "
        "all is written, but a limit of the campaign is exceeded. The same recordings or "
        "datasets and the same revision give the same bytes. --solve and --slurm first make "
        "the datasets that a campaign of bundles misses, those that are outdated too; run again, "
        "they go on where they ended. Logs lie in DIR.jobs.",
    .children = children,
};

static void show_progress(void *context, int done, int total, const char *what)
{
    (void)total;
    wb_progress_update(context, done, what);
}

/* A folder that may not be written should not cost the time of the calibrations. */
static int prepare(const struct options *o)
{
    return wb_command_exit(wb_file_prepare_output(o->common.output, o->common.force));
}

/* --- recordings --- */

static void print_rms(const char *what, enum wb_recordings_results_state state, double rms,
                      double limit)
{
    if (state == WB_RECORDINGS_NOT_WANTED)
        return;
    if (state != WB_RECORDINGS_DONE)
        printf("  %s missing", what);
    else if (limit > 0.0 && !(rms <= limit))
        printf("  %s RMS %.4f (limit %.4g exceeded)", what, rms, limit);
    else
        printf("  %s RMS %.4f", what, rms);
}

static void print_summary(const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    printf("%s%s: %d of %d recordings used\n", campaign->title,
           results->any_virtual ? " (virtual rig)" : "", results->n_usable, results->n_tests);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        printf("%-10s", wire->wanted->label);
        print_rms("calibration", wire->calibration_state, wire->calibration.rms,
                  campaign->calibration_limit);
        print_rms("validation", wire->validation_state, wire->validation.elastoplastic.rms,
                  campaign->validation_limit);
        printf("\n");
    }
}

/* The same text as the file's. */
static enum wb_status print_json(const char *folder)
{
    char path[WB_PATH], *text;
    WB_TRY(wb_file_join(path, folder, "report.json"));
    WB_TRY(wb_file_read(path, &text, NULL));
    fputs(text, stdout);
    free(text);
    return WB_OK;
}

/* Prints what was written and tells how it ended. */
static int deliver(const struct options *o, bool is_complete, bool exceeds_limit)
{
    const char *const folder = o->common.output;
    if (o->common.json && print_json(folder) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        printf("%s/report.pdf\n%s/report.html\n%s/report.json\n%s/figures\n", folder, folder,
               folder, folder);
    if (!is_complete)
        return WB_EXIT_INCOMPLETE;
    return exceeds_limit ? WB_EXIT_LIMIT : WB_EXIT_OK;
}

static int refuse_interrupted(void)
{
    wb_error("interrupted: no report is written");
    return WB_EXIT_FAILED;
}

static int finish(const struct options *o, const struct wb_recordings_results *results)
{
    if (results->interrupted)
        return refuse_interrupted();
    if (wb_recordings_report_write(results, o->common.output, o->common.force) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        print_summary(results);
    return deliver(o, results->is_complete, results->exceeds_limit);
}

static int report_recordings(const struct options *o, const char *path)
{
    struct wb_recordings campaign;
    struct wb_recordings_results results;
    struct wb_progress progress;
    int n_missing;
    if (wb_recordings_read(&campaign, path) != WB_OK)
        return WB_EXIT_FAILED;
    int code = prepare(o);
    if (code == WB_EXIT_OK) {
        wb_progress_start(&progress, "report", "steps",
                          wb_recordings_count(&campaign, &n_missing) + 2.0 * campaign.n_wires);
        code = wb_command_exit(wb_recordings_results_compute(&results, &campaign, o->threads,
                                                             show_progress, &progress));
        wb_progress_finish(&progress);
        if (code == WB_EXIT_OK) {
            code = finish(o, &results);
            wb_recordings_results_release(&results);
        }
    }
    wb_recordings_release(&campaign);
    return code;
}

/* --- comparisons of simulations --- */

static void print_runs(const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    printf("%s (simulations): %d of %d datasets used\n", comparison->title, results->n_usable,
           results->n_wanted);
    for (int i = 0; i < comparison->n_cases; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const struct wb_wires_run *const run = &results->runs[i][k];
            if (run->state == WB_WIRES_MISSING || run->state == WB_WIRES_REFUSED)
                printf("  %s: %s; to make it:\n    %s\n", comparison->cases[i].datasets[k].name,
                       wb_text_string(&run->problem), run->command);
        }
    }
    if (results->fit_state == WB_WIRES_USABLE)
        printf("  fitted rod: yield stress %.2f MPa, K %.4g MPa, n %.3f, RMS %.4f\n",
               results->fit.material.yield_stress / WB_MPA,
               results->fit.material.strength_coefficient / WB_MPA,
               results->fit.material.hardening_exponent, results->fit.rms);
    else
        printf("  no fitted rod: %s\n", wb_text_string(&results->fit_problem));
    if (results->exceeds_limit)
        printf("  a limit of the campaign is exceeded\n");
}

static int finish_comparison(const struct options *o, const struct wb_wires_results *results)
{
    if (results->interrupted)
        return refuse_interrupted();
    if (wb_wires_report_write(results, o->common.output, o->common.force) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        print_runs(results);
    return deliver(o, results->is_complete, results->exceeds_limit);
}

static int report_comparison(const struct options *o, const char *path)
{
    /* Too large for the stack of a small system. */
    struct wb_wires *const comparison = calloc(1, sizeof *comparison);
    struct wb_wires_results *const results = calloc(1, sizeof *results);
    struct wb_progress progress;
    int code = comparison && results ? WB_EXIT_OK : WB_EXIT_FAILED;
    if (code != WB_EXIT_OK)
        wb_error("out of memory");
    else
        code = wb_command_exit(wb_wires_read(comparison, path));
    if (code == WB_EXIT_OK)
        code = prepare(o);
    if (code == WB_EXIT_OK) {
        wb_progress_start(&progress, "report", "steps", wb_wires_count(comparison));
        code = wb_command_exit(wb_wires_compute(results, comparison, show_progress, &progress));
        wb_progress_finish(&progress);
        if (code == WB_EXIT_OK)
            code = finish_comparison(o, results);
    }
    if (results)
        wb_wires_results_release(results);
    if (comparison)
        wb_wires_release(comparison);
    free(results);
    free(comparison);
    return code;
}

/* --- bundles --- */

static void print_dataset(const struct wb_bundles_dataset *dataset,
                          const struct wb_bundles_result *result)
{
    if (result->state != WB_BUNDLES_USABLE && result->state != WB_BUNDLES_NOT_WANTED)
        printf("  %s: %s; to make it:\n    %s\n", dataset->name, wb_text_string(&result->problem),
               dataset->command);
}

static void print_bundle(const struct wb_bundles_results *results, int index)
{
    const struct wb_bundles *const campaign = results->campaign;
    const struct wb_bundles_bundle *const bundle = &campaign->bundles[index];
    const struct wb_bundles_result *const run = wb_bundles_results_usable(results, bundle->dynamic);
    const struct wb_bundles_fit *const fit = wb_bundles_results_fit(results, index);
    printf("%-16s", bundle->label);
    if (run)
        printf("  F_max %.4g N", run->curve.max_force);
    if (run && run->published)
        printf("  RMS from the published curve %.4f", run->rms);
    if (fit)
        printf("  E %.0f MPa, yield stress %.2f MPa, K %.4g MPa, n %.3f, RMS %.4f",
               fit->result.material.youngs_modulus / WB_MPA,
               fit->result.material.yield_stress / WB_MPA,
               fit->result.material.strength_coefficient / WB_MPA,
               fit->result.material.hardening_exponent, fit->result.rms);
    else
        printf("  no fitted beam: %s", wb_text_string(&results->fits[index].problem));
    printf("\n");
}

static void print_bundles(const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_bundles_verdict verdicts[WB_BUNDLES_VERDICTS];
    printf("%s (simulations): %d of %d datasets used\n", campaign->title, results->n_usable,
           results->n_wanted);
    for (int i = 0; i < campaign->n_runs; i++)
        print_dataset(&campaign->runs[i].dataset, &results->runs[i]);
    for (int i = 0; i < campaign->n_bundles; i++)
        print_dataset(&campaign->bundles[i].rod, &results->rods[i]);
    for (int i = 0; i < campaign->n_bundles; i++)
        print_bundle(results, i);
    const int n = wb_bundles_results_judge(results, verdicts);
    for (int i = 0; i < n; i++) {
        if (!verdicts[i].kept)
            printf("  limit %s exceeded by %s: %.4g, limit %.4g\n", verdicts[i].key,
                   verdicts[i].label, verdicts[i].value, verdicts[i].limit);
    }
}

static int finish_bundles(const struct options *o, const struct wb_bundles_results *results)
{
    if (results->interrupted)
        return refuse_interrupted();
    if (wb_bundles_report_write(results, o->common.output, o->common.force) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        print_bundles(results);
    return deliver(o, results->is_complete, results->exceeds_limit);
}

enum {
    MORE_ARGUMENTS = 4, /* --threads N --checkpoint FILE */
    MOST_JOBS = WB_BUNDLES_RUNS + WB_BUNDLES_BUNDLES
};

/* The jobs that make what is missing, with what their arguments point to. */
struct bundle_jobs {
    int n;
    struct wb_job jobs[MOST_JOBS];
    const char *arguments[MOST_JOBS][WB_BUNDLES_ARGUMENTS + MORE_ARGUMENTS];
    char checkpoints[MOST_JOBS][WB_PATH];
    char threads[16];
    char folder[WB_PATH];
    char program[WB_SHA256_TEXT];
};

/* A run that was ended goes on from its checkpoint, which fits one program, bundle and command. */
static enum wb_status name_checkpoint(struct bundle_jobs *all, const struct wb_bundles_run *run,
                                      char path[WB_PATH])
{
    char hash[WB_SHA256_TEXT], name[200];
    struct wb_text text = {0};
    wb_text_append(&text, "%s %s %s %s", all->program, all->threads, run->model->sha256,
                   run->dataset.command);
    wb_hash_bytes(wb_text_string(&text), text.length, hash);
    wb_text_release(&text);
    snprintf(name, sizeof name, "%.128s-%.12s.checkpoint", run->dataset.log, hash);
    return wb_file_join(path, all->folder, name);
}

/* Whether a file is a checkpoint of a run by any program, or one that was being written. */
static bool is_checkpoint_of(const char *file, const char *run)
{
    static const char ending[] = ".checkpoint";
    enum {
        DIGITS = 12
    };
    const size_t length = strlen(run);
    if (strncmp(file, run, length) != 0 || file[length] != '-')
        return false;
    const char *const hash = file + length + 1;
    if (strspn(hash, "0123456789abcdef") != DIGITS)
        return false;
    const char *const rest = hash + DIGITS;
    return strncmp(rest, ending, strlen(ending)) == 0 &&
           (rest[strlen(ending)] == '\0' || rest[strlen(ending)] == '.');
}

/* A changed program or bundle leaves checkpoints that nothing goes on from. They are let be until
 * their run is there. */
static void remove_checkpoints(const struct bundle_jobs *all,
                               const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    DIR *const folder = opendir(all->folder);
    if (!folder)
        return;
    for (const struct dirent *entry; (entry = readdir(folder));) {
        for (int i = 0; i < campaign->n_runs; i++) {
            if (results->runs[i].state != WB_BUNDLES_USABLE ||
                !is_checkpoint_of(entry->d_name, campaign->runs[i].dataset.log))
                continue;
            (void)unlinkat(dirfd(folder), entry->d_name, 0);
            break;
        }
    }
    closedir(folder);
}

static enum wb_status add_run_job(struct bundle_jobs *all, const struct wb_bundles_run *run,
                                  const struct wb_bundles_result *result)
{
    const char **const arguments = all->arguments[all->n];
    int n = 0;
    if (!wb_bundles_run_is_missing(result))
        return WB_OK;
    for (; run->dataset.arguments[n]; n++)
        arguments[n] = run->dataset.arguments[n];
    if (all->threads[0]) {
        arguments[n++] = "--threads";
        arguments[n++] = all->threads;
    }
    WB_TRY(name_checkpoint(all, run, all->checkpoints[all->n]));
    arguments[n++] = "--checkpoint";
    arguments[n++] = all->checkpoints[all->n];
    all->jobs[all->n++] = (struct wb_job){
        .name = run->dataset.log,
        .arguments = arguments,
        .output = run->dataset.path,
        .cost = wb_bundles_run_cost(run),
        .replace = result->state == WB_BUNDLES_STALE,
    };
    return WB_OK;
}

static void add_rod_job(struct bundle_jobs *all, const struct wb_bundles_dataset *rod,
                        const struct wb_bundles_result *result)
{
    if (wb_bundles_run_is_missing(result))
        all->jobs[all->n++] = (struct wb_job){
            .name = rod->log,
            .arguments = rod->arguments,
            .output = rod->path,
            .replace = result->state == WB_BUNDLES_STALE,
        };
}

/* Logs and checkpoints lie beside the report's folder. */
static enum wb_status list_jobs(struct bundle_jobs *all, const struct options *o,
                                const struct wb_bundles_results *results)
{
    const struct wb_bundles *const campaign = results->campaign;
    size_t length = strlen(o->common.output);
    while (length > 1 && o->common.output[length - 1] == '/')
        length--;
    if (snprintf(all->folder, sizeof all->folder, "%.*s.jobs", (int)length, o->common.output) >=
        (int)sizeof all->folder)
        return wb_fail(WB_ERR_ARGUMENT, "the output's path is too long");
    if (o->jobs.cores_per_job > 1)
        snprintf(all->threads, sizeof all->threads, "%d", o->jobs.cores_per_job);
    WB_TRY(wb_hash_file("/proc/self/exe", all->program));
    for (int i = 0; i < campaign->n_runs; i++)
        WB_TRY(add_run_job(all, &campaign->runs[i], &results->runs[i]));
    for (int i = 0; i < campaign->n_bundles; i++)
        add_rod_job(all, &campaign->bundles[i].rod, &results->rods[i]);
    return WB_OK;
}

static enum wb_status run_jobs(struct bundle_jobs *all, const struct options *o,
                               const struct wb_bundles_results *results,
                               struct wb_jobs_outcome *outcome)
{
    struct wb_jobs_options options = o->jobs;
    WB_TRY(list_jobs(all, o, results));
    options.folder = all->folder;
    return all->n > 0 ? wb_jobs_run(outcome, all->jobs, all->n, &options) : WB_OK;
}

/* Makes what is missing and reads it; *told is whether that is all that was asked for. */
static int make_missing(const struct options *o, struct wb_bundles_results *results, bool *told)
{
    const struct wb_bundles *const campaign = results->campaign;
    struct wb_jobs_outcome outcome = {0};
    struct bundle_jobs *const all = calloc(1, sizeof *all);
    if (!all)
        return wb_command_exit(wb_fail(WB_ERR_MEMORY, "out of memory"));
    const int code = wb_command_exit(run_jobs(all, o, results, &outcome));
    *told = code == WB_EXIT_OK && all->n > 0 && (o->jobs.dry_run || outcome.interrupted);
    if (code == WB_EXIT_OK && all->n > 0 && !*told) {
        wb_bundles_results_release(results);
        wb_bundles_results_load(results, campaign);
    }
    if (code == WB_EXIT_OK && !*told)
        remove_checkpoints(all, results);
    free(all);
    return *told && outcome.interrupted ? refuse_interrupted() : code;
}

static int compute_bundles(const struct options *o, struct wb_bundles_results *results,
                           const struct wb_bundles *campaign)
{
    struct wb_progress progress;
    bool told = false;
    int code = WB_EXIT_OK;
    wb_bundles_results_load(results, campaign);
    if (wb_jobs_wanted(&o->jobs))
        code = make_missing(o, results, &told);
    if (code != WB_EXIT_OK || told)
        return code;
    wb_progress_start(&progress, "report", "steps", campaign->n_bundles);
    wb_bundles_results_compute(results, show_progress, &progress);
    wb_progress_finish(&progress);
    return finish_bundles(o, results);
}

static int report_bundles(const struct options *o, const char *path)
{
    /* Too large for the stack of a small system. */
    struct wb_bundles *const bundles = calloc(1, sizeof *bundles);
    struct wb_bundles_results *const results = calloc(1, sizeof *results);
    int code = bundles && results ? WB_EXIT_OK : WB_EXIT_FAILED;
    if (code != WB_EXIT_OK)
        wb_error("out of memory");
    else
        code = wb_command_exit(wb_bundles_read(bundles, path));
    if (code == WB_EXIT_OK)
        code = prepare(o);
    if (code == WB_EXIT_OK)
        code = compute_bundles(o, results, bundles);
    if (results)
        wb_bundles_results_release(results);
    if (bundles)
        wb_bundles_release(bundles);
    free(results);
    free(bundles);
    return code;
}

int wb_cmd_report(int argc, char **argv)
{
    static int (*const reports[])(const struct options *, const char *) = {
        [WB_CAMPAIGN_RECORDINGS] = report_recordings,
        [WB_CAMPAIGN_COMPARISON] = report_comparison,
        [WB_CAMPAIGN_BUNDLES] = report_bundles,
    };

    char buffer[WB_PATH];
    struct options options = {.common = {.noun = "campaign file", .destination = "report goes"}};
    wb_command_parse(&argp, argc, argv, &options);
    const char *const path = wb_command_find(options.common.input, buffer);
    enum wb_campaign_kind kind;
    if (wb_campaign_read_kind(&kind, path) != WB_OK)
        return WB_EXIT_FAILED;
    if (wb_jobs_wanted(&options.jobs) && kind != WB_CAMPAIGN_BUNDLES) {
        wb_error("--solve and --slurm are for campaigns of the kind bundles; %s has another kind",
                 path);
        return WB_EXIT_FAILED;
    }
    const bool existed = wb_file_exists(options.common.output);
    wb_interrupt_install();
    const int code = reports[kind](&options, path);
    if (!existed)
        remove(options.common.output); /* only if it is empty */
    wb_jobs_options_release(&options.jobs);
    return code;
}
