/* wirebench record: runs a bending test and records it. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/plot/figure.h"
#include "analysis/quicklook.h"
#include "analysis/series_results.h"
#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/bench_options.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/live_line.h"
#include "cli/record_series.h"
#include "cli/record_test.h"
#include "cli/settings.h"
#include "daq/test/bend_test.h"
#include "fixtures/virtual/virtual_time.h"

#define WB_LOG_DOMAIN "record"

struct options {
    struct wb_command_common common;
    struct wb_bend_test_request request;
    struct wb_record_views_options views;
    const char *figure; /* path, or NULL */
    const char *series; /* path of a series' file; NULL: a single test */
    bool is_virtual;
    struct wb_virtual_options bench;
    const char *of_virtual; /* an option that only a virtual test has and that was given, or NULL */
    struct wb_virtual_test virtual;
};

enum {
    OPTION_SERVE = WB_KEY_OWN,
    OPTION_FIGURE,
    OPTION_START
};

static const struct argp_option argp_options[] = {
    {"specimen", WB_KEY_TEXT(options, request.specimen_path), "SPECIMEN.yaml", 0,
     "The piece of wire on the bench"},
    {"series", WB_KEY_TEXT(options, series), "SERIES.yaml", 0,
     "Test several specimens one after another, as described in this file"},
    {"output", 'o', "REC.wbr", 0,
     "The recording to write; it must not exist. For a series: the folder of its recordings"},
    {"operator", WB_KEY_TEXT(options, request.operator_name), "NAME", 0,
     "Name of the operator, stored in the recording"},
    {"notes", WB_KEY_TEXT(options, request.notes), "TEXT", 0, "Notes, stored in the recording"},
    {"live", WB_KEY_FLAG(options, views.live), NULL, 0,
     "Show the test full-screen in the terminal: curve, wire, large numbers, instruments"},
    {"serve", OPTION_SERVE, "PORT", 0,
     "Show the test as a web page at http://127.0.0.1:PORT/; 0 selects a free port"},
    {"figure", OPTION_FIGURE, "FILE", 0,
     "At the end, draw force over deflection as SVG, PNG or PDF; the file must not exist"},
    {"virtual", WB_KEY_FLAG(options, is_virtual), NULL, 0,
     "Test on a virtual bench like that of RIG.yaml, in virtual time: a whole test takes one or "
     "two seconds and needs no instruments"},
    {"start", OPTION_START, "DATE", 0,
     "With --virtual: the date stored in the recording, 2026-11-25 or 2026-11-25T14:03:00Z (the "
     "real date)"},
    {"json", WB_KEY_JSON, NULL, 0, "Print the outcome as JSON"},
    {0},
};

/* Settings of a series stand in its file only. */
static error_t check_series(struct argp_state *state, const struct options *options)
{
    if (options->request.specimen_path)
        argp_error(state,
                   "--specimen cannot be combined with --series, whose file names the specimen");
    for (size_t i = 0; i < wb_bend_test_table.n; i++) {
        const struct wb_setting *const row = &wb_bend_test_table.rows[i];
        if (wb_setting_differs(row, &options->request))
            argp_error(state,
                       "--%s cannot be combined with --series: write %s into the series' file",
                       row->option, row->name);
    }
    return 0;
}

static void check_virtual(struct argp_state *state, const struct options *options)
{
    if (!options->is_virtual && options->of_virtual)
        argp_error(state, "--%s needs --virtual", options->of_virtual);
    if (options->is_virtual && (options->views.live || options->views.serve))
        argp_error(state, "--live and --serve cannot be combined with --virtual, which takes a "
                          "second; for a virtual bench in real time use 'wirebench rig'");
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    switch (key) {
    case OPTION_SERVE:
        options->views.serve = true;
        options->views.port = wb_command_integer(state, "--serve", argument, 0, 65535);
        return 0;
    case OPTION_FIGURE:
        options->figure = argument;
        if (!wb_figure_is_file(argument))
            argp_error(state, "--figure: expected NAME.svg, NAME.png or NAME.pdf, not '%s'",
                       argument);
        return 0;
    case OPTION_START:
        options->of_virtual = "start";
        if (!wb_time_parse(argument, &options->virtual.start))
            argp_error(state,
                       "--start: expected a date such as 2026-11-25 or 2026-11-25T14:03:00Z "
                       "(UTC), not '%s'",
                       argument);
        return 0;
    case ARGP_KEY_END:
        check_virtual(state, options);
        if (options->series)
            return check_series(state, options);
        if (!options->request.specimen_path)
            argp_error(state, "--specimen SPECIMEN.yaml is missing");
        if (options->common.output && !wb_command_ends_in(options->common.output, ".wbr"))
            argp_error(state,
                       "--output: expected NAME.wbr, not '%s'; compress the recording afterwards "
                       "with zstd",
                       options->common.output);
        break;
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc =
        "RIG.yaml --specimen SPECIMEN.yaml -o REC.wbr\n[RIG.yaml] --series SERIES.yaml [-o DIR]",
    .doc =
        "Runs a cantilever test and records it: connects to the instruments of the rig file, "
        "checks the start (all markers visible, zero of the load cell plausible, travel free, "
        "stage ready), takes the tare, and moves the clamp down and back, N times.\v"
        "Mount the specimen with the strand slack: the test starts at the current position of the "
        "stage. Every limit of the rig file (force, overload, travel, a silent instrument, an "
        "alarm of the stage) stops the stage; the specimen then stays loaded until 'wirebench "
        "stage RIG.yaml release' frees it.\n\n"
        "Keys during the test: m marks the moment in the recording, h holds the test, r resumes "
        "it, q stops it; Ctrl-C stops it, too. The stage is stopped before the recording is "
        "closed.\n\n"
        "Exit codes: 0 complete; 1 failed before the first cycle, or nothing was recorded; 2 wrong "
        "usage; 3 stopped early or data lost, the recorded part is usable.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_bend_test_table, .n_tables = 1, .offset = offsetof(struct options, request)},
    {.tables = &wb_bench_options_virtual,
     .n_tables = 1,
     .offset = offsetof(struct options, bench),
     .title = "With --virtual:"},
};

static void note_option(void *input, const struct wb_setting *row, size_t source)
{
    struct options *const options = input;
    if (sources[source].tables == &wb_bench_options_virtual)
        options->of_virtual = row->option;
}

static const struct wb_settings_command command = {.argp = &argp,
                                                   .sources = sources,
                                                   .n_sources = WB_COUNT(sources),
                                                   .place = 1,
                                                   .note = note_option};

static void print_json(const struct wb_bend_test_result *result, const char *output)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "recording", result->recorded ? output : NULL);
    wb_json_set_text(root, "end", wb_bench_options_end_name(result->end));
    wb_json_set_text(root, "reason", result->text);
    wb_json_set_boolean(root, "virtual_rig", result->is_virtual);
    wb_json_set_integer(root, "cycles_done", result->cycles_done);
    wb_json_set_number(root, "duration_s", result->duration);
    wb_json_set_number(root, "tare_mN", result->tare / WB_MN);
    wb_json_set_number(root, "peak_tension_mN", result->peak_tension / WB_MN);
    wb_json_set_integer(root, "holds", result->holds);
    wb_json_set_number(root, "held_s", result->held);
    wb_json_set_number(root, "travel_mm", result->travel / WB_MM);
    wb_json_set_boolean(root, "stage_standing", result->standing);
    wb_json_set_boolean(root, "soft_reset", result->soft_reset);
    wb_json_set_number(root, "hold_latency_ms", result->hold_latency * 1e3);
    wb_json_set_number(root, "confirm_latency_ms", result->confirm_latency * 1e3);
    wb_json_set_integer(root, "load_readings", (int64_t)result->samples[WB_ROLE_LOAD]);
    wb_json_set_integer(root, "mocap_frames", (int64_t)result->samples[WB_ROLE_MOCAP]);
    wb_json_set_integer(root, "stage_reports", (int64_t)result->samples[WB_ROLE_STAGE]);
    wb_json_set_integer(root, "drops", (int64_t)result->drops);
    wb_json_set_integer(root, "load_readings_missing", (int64_t)result->loss[WB_ROLE_LOAD].missing);
    wb_json_set_integer(root, "mocap_frames_missing", (int64_t)result->loss[WB_ROLE_MOCAP].missing);
    wb_command_print_json(root);
}

static bool draw_figure(const struct wb_series_test *test, const char *path)
{
    const enum wb_status status = test->is_usable ? wb_quicklook_draw(&test->dataset, path)
                                                  : wb_fail(WB_ERR_DATA, "%s", test->problem);
    if (status != WB_OK)
        wb_error("'%s' was not drawn: see the message before; the recording is not affected", path);
    return status == WB_OK;
}

/* --- the last lines --- */

static void append_found(struct wb_text *text, const struct wb_bend_test_result *result,
                         const struct wb_series_test *test)
{
    const struct wb_test_info *const info = &test->dataset.info;
    if (test->is_usable)
        wb_text_append(text, "%s, L = %g mm, sample %d (%s): ", info->wire, info->length / WB_MM,
                       info->sample, wb_finding_source(info));
    else if (result->is_virtual)
        wb_text_append(text, "virtual rig: ");
    wb_text_append(text, "%d cycle%s", result->cycles_done, result->cycles_done == 1 ? "" : "s");
    if (isfinite(test->values[WB_SERIES_PEAK_FORCE]))
        wb_text_append(text, ", peak force %.1f mN", test->values[WB_SERIES_PEAK_FORCE] / WB_MN);
    if (isfinite(test->values[WB_SERIES_RESIDUAL]))
        wb_text_append(text, ", residual deflection %.1f mm",
                       test->values[WB_SERIES_RESIDUAL] / WB_MM);
}

static void append_trust(struct wb_text *text, const struct wb_bend_test_result *result,
                         const struct wb_series_test *test, int code)
{
    if (!test->is_usable) {
        wb_text_append(text, "no: no curve can be made of this recording: %s", test->problem);
        return;
    }
    const int n = (int)wb_json_length(wb_json_get(test->dataset.document, "warnings"));
    if (result->end != WB_SEQUENCE_DONE)
        wb_text_append(text, "in part: the test ended early");
    else if (code != WB_EXIT_OK)
        wb_text_append(text, "in part: data were lost, see the warning");
    else if (result->holds > 0)
        wb_text_append(text, "in part: the test was held, and the wire relaxed meanwhile");
    else if (n > 0)
        wb_text_append(text, "in part: complete, but aligned with %d warning%s, see above", n,
                       n == 1 ? "" : "s");
    else if (!wb_dataset_is_complete(&test->dataset))
        wb_text_append(text, "in part: the aligned curve is incomplete");
    else
        wb_text_append(text, "yes: complete, nothing lost, aligned without warnings");
}

static void append_next(struct wb_text *text, const struct wb_bend_test_result *result,
                        const struct wb_series_test *test, const char *output)
{
    char dataset[WB_PATH];
    if (!result->is_virtual && (result->displaced || !result->standing)) {
        wb_text_append(text, "follow the warning above before you touch the specimen");
        return;
    }
    if (result->end == WB_SEQUENCE_LIMIT || result->end == WB_SEQUENCE_FAILED) {
        wb_text_append(text,
                       "remove the cause that the message above names, then record again into "
                       "another file");
        return;
    }
    if (!test->is_usable) {
        wb_finding_append_command(text, "wirebench verify %s", output);
        return;
    }
    snprintf(dataset, sizeof dataset, "%.*s", (int)(strlen(output) - strlen(".wbr")), output);
    wb_finding_append_command(text, "wirebench align %s -o %s", output, dataset);
}

static void print_result(const struct wb_bend_test_result *result, const char *output,
                         const struct wb_series_results *results, const char *figure, int code)
{
    char *text = NULL;
    size_t size;
    FILE *const memory = open_memstream(&text, &size);
    if (!memory)
        return;
    wb_record_test_print(memory, result, output);
    if (results->n > 0) {
        const struct wb_series_test *const test = &results->tests[0];
        struct wb_finding finding = {.figure = figure};
        struct wb_text table = {0};
        wb_series_results_append(results, &table);
        /* Without the rows of means, which one test does not have. */
        const char *const all = wb_text_string(&table), *const means = strstr(all, "\nmean ");
        fprintf(memory, "%.*s\n", means ? (int)(means - all) : (int)strlen(all), all);
        wb_text_release(&table);
        append_found(&finding.found, result, test);
        append_trust(&finding.trust, result, test, code);
        append_next(&finding.next, result, test, output);
        wb_finding_write(memory, &finding);
    }
    if (fclose(memory) == 0)
        wb_live_line_print(text);
    free(text);
}

static int run_series(struct options *options)
{
    if (wb_file_kind_check(options->series, WB_FILE_BIT(WB_FILE_SERIES)) != WB_OK)
        return WB_EXIT_FAILED;
    const struct wb_record_series series = {
        .path = options->series,
        .test = options->request,
        .views = options->views,
        .virtual = options->is_virtual ? &options->virtual : NULL,
        .folder = options->common.output,
        .figure = options->figure,
        .json = options->common.json,
    };
    return wb_record_series_run(&series);
}

/* `code` is that of the test; returns that of the command. */
static int deliver(const struct options *o, const struct wb_bend_test_result *result, int code)
{
    const char *const output = o->request.output_path;
    const int code_of_test = code;
    struct wb_series_results results = {0};
    bool has_figure = false;
    if (result->started && (o->figure || !o->common.json))
        (void)wb_series_results_add(&results, output, 1);
    if (o->figure && results.n > 0) {
        has_figure = draw_figure(&results.tests[0], o->figure);
        code = !has_figure && code == WB_EXIT_OK ? WB_EXIT_INCOMPLETE : code;
    }
    if (o->common.json)
        print_json(result, output);
    else if (result->recorded)
        print_result(result, output, &results, has_figure ? o->figure : NULL, code_of_test);
    wb_series_results_release(&results);
    return code;
}

int wb_cmd_record(int argc, char **argv)
{
    struct options options = {
        .common = {.noun = "rig file", .destination = "recording goes: -o REC.wbr"}};
    struct wb_bend_test_result result;
    int code;
    char specimen[WB_PATH], rig[WB_PATH];
    wb_bend_test_default_request(&options.request);
    wb_bench_options_default(&options.bench);
    options.virtual.start = WB_VIRTUAL_TIME_HOST_DATE;
    wb_settings_parse(&command, argc, argv, &options);
    wb_bench_options_complete(&options.bench);
    options.virtual.settings = options.bench.bench;
    options.request.rig_path = options.is_virtual && options.common.input
                                   ? wb_command_find(options.common.input, rig)
                                   : options.common.input;
    if (options.request.rig_path &&
        wb_file_kind_check(options.request.rig_path, WB_FILE_BIT(WB_FILE_RIG)) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.series)
        return run_series(&options);
    options.request.output_path = options.common.output;
    if (wb_file_kind_find_input(&options.request.specimen_path, specimen, WB_FILE_SPECIMENS) !=
        WB_OK)
        return WB_EXIT_FAILED;
    if (options.figure && wb_file_exists(options.figure)) {
        wb_error("'%s' exists: choose another name with --figure", options.figure);
        return WB_EXIT_FAILED;
    }
    if (wb_record_test_run(&options.request, &options.views,
                           options.is_virtual ? &options.virtual : NULL, &result, &code) != WB_OK)
        return WB_EXIT_FAILED;
    return deliver(&options, &result, code);
}
