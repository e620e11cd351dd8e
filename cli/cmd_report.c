/* wirebench report: a campaign's recordings become its calibration report. */
#include <stdio.h>
#include <stdlib.h>

#include "analysis/report/report.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/progress.h"
#include "cli/command.h"

#define WB_LOG_DOMAIN "report"

struct options {
    struct wb_command_common common;
    int threads;
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
    if (key != KEY_THREADS)
        return wb_command_parse_common(key, argument, state, &o->common);
    o->threads = wb_command_integer(state, "--threads", argument, 1, 16);
    return 0;
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "CAMPAIGN.yaml",
    .doc = "Aligns the recordings of a campaign, calibrates and validates its wires and writes the "
           "report: report.pdf, report.html, report.json and figures/ (SVG and PNG).\v"
           "Recordings that are missing or cannot be used are named in the report (exit code 3). "
           "Exit code 4: all is written, but a limit of the campaign is exceeded. The same "
           "recordings and the same revision give the same bytes.",
};

static void show_progress(void *context, int done, int total, const char *what)
{
    (void)total;
    wb_progress_update(context, done, what);
}

static void print_rms(const char *what, enum wb_results_state state, double rms, double limit)
{
    if (state == WB_RESULTS_NOT_WANTED)
        return;
    if (state != WB_RESULTS_DONE)
        printf("  %s missing", what);
    else if (limit > 0.0 && !(rms <= limit))
        printf("  %s RMS %.4f (limit %.4g exceeded)", what, rms, limit);
    else
        printf("  %s RMS %.4f", what, rms);
}

static void print_summary(const struct wb_results *results, const char *folder)
{
    const struct wb_campaign *const campaign = results->campaign;
    printf("%s%s: %d of %d recordings used\n", campaign->title,
           results->any_virtual ? " (virtual rig)" : "", results->n_usable, results->n_tests);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_results_wire *const wire = &results->wires[i];
        printf("%-10s", wire->wanted->label);
        print_rms("calibration", wire->calibration_state, wire->calibration.rms,
                  campaign->calibration_limit);
        print_rms("validation", wire->validation_state, wire->validation.elastoplastic.rms,
                  campaign->validation_limit);
        printf("\n");
    }
    printf("%s/report.pdf\n%s/report.html\n%s/report.json\n%s/figures\n", folder, folder, folder,
           folder);
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

static int finish(const struct options *o, const struct wb_results *results)
{
    if (results->interrupted) {
        wb_error("interrupted: no report is written");
        return WB_EXIT_FAILED;
    }
    if (wb_report_write(results, o->common.output, o->common.force) != WB_OK)
        return WB_EXIT_FAILED;
    if (!o->common.json)
        print_summary(results, o->common.output);
    else if (print_json(o->common.output) != WB_OK)
        return WB_EXIT_FAILED;
    if (!results->is_complete)
        return WB_EXIT_INCOMPLETE;
    return results->exceeds_limit ? WB_EXIT_LIMIT : WB_EXIT_OK;
}

int wb_cmd_report(int argc, char **argv)
{
    char path[WB_PATH];
    struct options options = {.common = {.noun = "campaign file", .destination = "report goes"}};
    wb_command_parse(&argp, argc, argv, &options);
    struct wb_campaign campaign;
    if (wb_campaign_read(&campaign, wb_command_find(options.common.input, path)) != WB_OK)
        return WB_EXIT_FAILED;
    /* A folder that may not be written should not cost the time of the calibrations. */
    const bool existed = wb_file_exists(options.common.output);
    int code = wb_command_exit(wb_file_prepare_output(options.common.output, options.common.force));
    if (code == WB_EXIT_OK) {
        int n_missing;
        wb_interrupt_install();
        struct wb_progress progress;
        wb_progress_start(&progress, "report", "steps",
                          wb_campaign_count(&campaign, &n_missing) + 2.0 * campaign.n_wires);
        struct wb_results results;
        code = wb_command_exit(
            wb_results_compute(&results, &campaign, options.threads, show_progress, &progress));
        wb_progress_finish(&progress);
        if (code == WB_EXIT_OK) {
            code = finish(&options, &results);
            wb_results_release(&results);
        }
        if (code == WB_EXIT_FAILED && !existed)
            remove(options.common.output); /* only if it is empty */
    }
    wb_campaign_release(&campaign);
    return code;
}
