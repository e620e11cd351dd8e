/* wirebench report: the report of a campaign, from its recordings or simulations. */
#include <stdio.h>
#include <stdlib.h>

#include "analysis/jobs/jobs.h"
#include "analysis/report/check.h"
#include "analysis/report/kinds/kinds.h"
#include "analysis/report/report.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/job_options.h"

struct options {
    struct wb_command_common common;
    int threads;
    const char *key;             /* to sign with, or NULL */
    const char *check;           /* folder of a signed report to check; NULL: make a report */
    bool lists;                  /* --stale */
    struct wb_jobs_options jobs; /* for datasets that are missing */
};

#define KEY_THREADS WB_KEY_OWN

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Folder to write"},
    {"force", WB_KEY_FORCE, NULL, 0, "Replace the report in the folder"},
    {"threads", KEY_THREADS, "N", 0,
     "Threads to compute on, 1 to 16 (as many as cores, 4 at most)"},
    {"sign", WB_KEY_TEXT(options, key), "KEY", 0,
     "Also write manifest.json, the SHA-256 sums of the report and its inputs, and its OpenPGP "
     "signature with this gpg key"},
    {"check", WB_KEY_TEXT(options, check), "DIR", 0,
     "Check the signed report in this folder: signature, files, and the results computed again; "
     "name the campaign file only where it is not found"},
    {"stale", WB_KEY_FLAG(options, lists), NULL, 0,
     "Make no report, but list the datasets that are missing or outdated, and why"},
    {"json", WB_KEY_JSON, NULL, 0, "Print all numbers, or the list, as one JSON object"},
    {0},
};

/* Checks that the required options were given, and no conflicting ones. */
static error_t check_end(struct options *o, struct argp_state *state)
{
    if (o->check) {
        if (o->key || o->common.output || o->lists)
            argp_error(state, "--check cannot be combined with --sign, --stale or -o");
        return 0;
    }
    if (!o->lists && !o->common.output)
        argp_error(state, "output missing: -o DIR, or --stale for a list");
    if (o->lists && (o->key || o->common.output || wb_jobs_wanted(&o->jobs)))
        argp_error(state, "--stale cannot be combined with --sign, -o, --solve or --slurm");
    return wb_command_parse_common(ARGP_KEY_END, NULL, state);
}

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
    case ARGP_KEY_END:
        return check_end(o, state);
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp_child children[] = {{&wb_job_options_argp, 0, NULL, 0}, {0}};

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "CAMPAIGN.yaml\n--check DIR [CAMPAIGN.yaml]",
    .doc = "Aligns the recordings of a campaign, calibrates and validates its wires and writes the "
           "report: report.pdf, report.html, report.json and figures/ (SVG and PNG). Campaigns of "
           "kind `comparison` compare datasets of wire models computed by `solve`, those of kind "
           "`bundles` datasets of bundles; one of kind `harness` computes a harness file.\v"
           "The same recordings or datasets and the same revision give the same bytes. --solve and "
           "--slurm first compute the datasets that are missing or outdated (recordings cannot be "
           "computed); run the same command again to continue. Their logs are in DIR.jobs.\n\n"
           "Exit codes: 0 complete; 1 failed; 2 wrong usage; 3 data are missing or unusable, which "
           "the report names, or with --stale a dataset is missing or outdated; 4 written, but a "
           "limit of the campaign is exceeded. With --check: 0 the results are the same bytes or, "
           "from another build, equal within 1e-9 (fitted values 1e-5); 1 a difference from the "
           "signed report; 3 the campaign is not found, so that nothing was computed again.",
    .children = children,
};

/* Prints report.json. */
static enum wb_status print_json(const char *folder)
{
    char path[WB_PATH], *text;
    WB_TRY(wb_file_join(path, folder, "report.json"));
    WB_TRY(wb_file_read(path, &text, NULL));
    fputs(text, stdout);
    free(text);
    return WB_OK;
}

/* Prints the paths of the files and returns the exit code. */
static int deliver(const struct options *o, enum wb_report_end end)
{
    static const int codes[] = {[WB_REPORT_COMPLETE] = WB_EXIT_OK,
                                [WB_REPORT_INCOMPLETE] = WB_EXIT_INCOMPLETE,
                                [WB_REPORT_LIMIT] = WB_EXIT_LIMIT,
                                [WB_REPORT_INTERRUPTED] = WB_EXIT_FAILED,
                                [WB_REPORT_NOTHING] = WB_EXIT_OK};
    const char *const folder = o->common.output;
    if (end == WB_REPORT_INTERRUPTED || end == WB_REPORT_NOTHING || o->lists)
        return codes[end];
    if (o->common.json && print_json(folder) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        printf("%s/report.pdf\n%s/report.html\n%s/report.json\n%s/figures\n", folder, folder,
               folder, folder);
    if (!o->common.json && o->key)
        printf("%s/manifest.json\n%s/manifest.json.asc\n", folder, folder);
    return codes[end];
}

static int check(const struct options *o)
{
    static const int codes[] = {[WB_CHECK_SAME] = WB_EXIT_OK,
                                [WB_CHECK_OTHER_BUILD] = WB_EXIT_OK,
                                [WB_CHECK_NOT_COMPUTED] = WB_EXIT_INCOMPLETE};
    char buffer[WB_PATH];
    enum wb_check_end end = WB_CHECK_NOT_COMPUTED;
    const struct wb_check_order order = {
        .folder = o->check,
        .campaign = o->common.input ? wb_command_find(o->common.input, buffer) : NULL,
        .n_threads = o->threads,
        .out = stdout,
    };
    const enum wb_status status = wb_check_run(&end, wb_kinds, WB_KINDS, &order);
    return status == WB_OK ? codes[end] : wb_command_exit(status);
}

int wb_cmd_report(int argc, char **argv)
{
    char buffer[WB_PATH];
    struct options options = {.common = {.noun = "campaign file"}};
    enum wb_report_end end = WB_REPORT_NOTHING;
    wb_command_parse(&argp, argc, argv, &options);
    if (options.check) {
        wb_interrupt_install();
        const int code = check(&options);
        wb_jobs_options_release(&options.jobs);
        return code;
    }
    const struct wb_report_order order = {
        .campaign = wb_command_find(options.common.input, buffer),
        .folder = options.common.output,
        .force = options.common.force,
        .quiet = options.common.json,
        .key = options.key,
        .n_threads = options.threads,
        .jobs = &options.jobs,
    };
    if (wb_file_kind_check(order.campaign, WB_FILE_BIT(WB_FILE_CAMPAIGN)) != WB_OK)
        return WB_EXIT_FAILED;
    const bool existed = options.lists || wb_file_exists(order.folder);
    wb_interrupt_install();
    const enum wb_status status = wb_report_make(&end, wb_kinds, WB_KINDS, &order);
    if (!existed)
        remove(order.folder); /* only if it is empty */
    wb_jobs_options_release(&options.jobs);
    return status == WB_OK ? deliver(&options, end) : wb_command_exit(status);
}
