/* wirebench record: the paper's test, recorded. */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/align/align.h"
#include "analysis/plot/figure.h"
#include "analysis/quicklook.h"
#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"
#include "cli/bench_options.h"
#include "cli/command.h"
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
    const char *figure; /* the curve's file; NULL: not wanted */
    const char *series; /* the file of a series; NULL: a single test */
    bool is_virtual;
    struct wb_virtual_options bench;
    const char *of_virtual; /* an option given that only a virtual test has; NULL: none */
    struct wb_virtual_test virtual;
};

enum {
    OPTION_SPECIMEN = WB_KEY_OWN,
    OPTION_SERIES,
    OPTION_OPERATOR,
    OPTION_NOTES,
    OPTION_LIVE,
    OPTION_SERVE,
    OPTION_FIGURE,
    OPTION_VIRTUAL,
    OPTION_START
};

static const struct argp_option argp_options[] = {
    {"specimen", OPTION_SPECIMEN, "SPECIMEN.yaml", 0, "The piece of wire on the bench", 0},
    {"series", OPTION_SERIES, "SERIES.yaml", 0,
     "Test several specimens, one after the other, as this file says", 0},
    {"output", 'o', "REC.wbr", 0,
     "The recording to write; it must not exist. Of a series: the folder of its recordings", 0},
    {"operator", OPTION_OPERATOR, "NAME", 0, "Who runs the test, for the recording", 0},
    {"notes", OPTION_NOTES, "TEXT", 0, "Anything worth knowing later, for the recording", 0},
    {"live", OPTION_LIVE, NULL, 0,
     "Show the test on the whole terminal: curve, wire, large figures, instruments", 0},
    {"serve", OPTION_SERVE, "PORT", 0,
     "Show it as a web page at http://127.0.0.1:PORT/; 0 takes a free port", 0},
    {"figure", OPTION_FIGURE, "FILE", 0,
     "Draw force over deflection at the end, as SVG, PNG or PDF; the file must not exist", 0},
    {"virtual", OPTION_VIRTUAL, NULL, 0,
     "Test on a virtual bench like that of RIG.yaml, in virtual time: the whole test in a second "
     "or "
     "two, without instruments",
     0},
    {"start", OPTION_START, "DATE", 0,
     "With --virtual: the date that the recording names, 2026-11-25 or 2026-11-25T14:03:00Z; "
     "without it the real one",
     0},
    {"json", WB_KEY_JSON, NULL, 0, "Print the outcome as JSON", 0},
    {0},
};

/* What the series' file says is not said a second time. */
static error_t check_series(struct argp_state *state, const struct options *options)
{
    if (options->request.specimen_path)
        argp_error(state, "--series names the specimen in its file: leave out --specimen");
    for (size_t i = 0; i < wb_bend_test_table.n; i++) {
        const struct wb_setting *const row = &wb_bend_test_table.rows[i];
        if (wb_setting_differs(row, &options->request))
            argp_error(state, "with --series, write %s into its file instead of --%s", row->name,
                       row->option);
    }
    return 0;
}

static void check_virtual(struct argp_state *state, const struct options *options)
{
    if (!options->is_virtual && options->of_virtual)
        argp_error(state, "--%s is for a virtual test: add --virtual", options->of_virtual);
    if (options->is_virtual && (options->views.live || options->views.serve))
        argp_error(state, "a virtual test takes a second and cannot be watched: leave out --live "
                          "and --serve, or start the bench with 'wirebench rig'");
}

static void note_option(void *input, const struct wb_setting *row)
{
    struct options *const options = input;
    for (size_t i = 0; i < wb_bench_options_virtual.n; i++)
        if (row == &wb_bench_options_virtual.rows[i])
            options->of_virtual = row->option;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    struct wb_bend_test_request *const request = &options->request;
    switch (key) {
    case OPTION_SPECIMEN:
        request->specimen_path = argument;
        return 0;
    case OPTION_SERIES:
        options->series = argument;
        return 0;
    case OPTION_OPERATOR:
        request->operator_name = argument;
        return 0;
    case OPTION_NOTES:
        request->notes = argument;
        return 0;
    case OPTION_LIVE:
        options->views.live = true;
        return 0;
    case OPTION_SERVE:
        options->views.serve = true;
        options->views.port = wb_command_integer(state, "--serve", argument, 0, 65535);
        return 0;
    case OPTION_FIGURE:
        options->figure = argument;
        if (!wb_figure_is_file(argument))
            argp_error(state, "a figure is written as NAME.svg, NAME.png or NAME.pdf, not '%s'",
                       argument);
        return 0;
    case OPTION_VIRTUAL:
        options->is_virtual = true;
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
        if (!request->specimen_path)
            argp_error(state, "no --specimen given");
        if (options->common.output && !wb_command_ends_in(options->common.output, ".wbr"))
            argp_error(state,
                       "a recording is written as NAME.wbr, not '%s'; compress it afterwards "
                       "with zstd",
                       options->common.output);
        break;
    default:
        break;
    }
    return wb_command_parse_common(key, argument, state, &options->common);
}

static const struct argp argp = {
    .options = argp_options,
    .parser = parse,
    .args_doc =
        "RIG.yaml --specimen SPECIMEN.yaml -o REC.wbr\n[RIG.yaml] --series SERIES.yaml [-o DIR]",
    .doc =
        "Runs a cantilever test and records it: connects to the instruments of the rig file, "
        "checks the start (all markers seen, zero of the load cell sane, travel free, stage "
        "ready), takes the tare, moves the clamp down and back, N times.\v"
        "Mount the specimen with the strand slack: the stage's position when the test starts is "
        "its start position. Every limit of the rig file (force, overload, travel, a silent "
        "instrument, an alarm of the stage) stops the stage; the specimen then stays where it "
        "is, and 'wirebench stage RIG.yaml release' frees it.\n\n"
        "Keys while it runs: m marks the moment in the recording, h holds the test where it is, r "
        "resumes it, q stops; Ctrl-C stops too. "
        "The stage is stopped before the recording is closed.\n\n"
        "Exit codes: 0 complete; 1 failed before the first cycle, or nothing was recorded; 2 wrong "
        "usage; 3 stopped early or data lost, what was recorded is usable.",
};

static const struct wb_settings_source sources[] = {
    {.tables = &wb_bend_test_table, .n_tables = 1, .offset = offsetof(struct options, request)},
    {.tables = &wb_bench_options_virtual,
     .n_tables = 1,
     .offset = offsetof(struct options, bench),
     .title = "With --virtual:"},
};

static const struct wb_settings_command command = {.argp = &argp,
                                                   .sources = sources,
                                                   .n_sources = WB_COUNT(sources),
                                                   .place = 1,
                                                   .note = note_option};

static const char *end_name(enum wb_sequence_end end)
{
    static const char *const names[] = {
        [WB_SEQUENCE_RUNNING] = "running",
        [WB_SEQUENCE_DONE] = "done",
        [WB_SEQUENCE_LIMIT] = "limit",
        [WB_SEQUENCE_INTERRUPTED] = "interrupted",
        [WB_SEQUENCE_STILL_LOADED] = "still_loaded",
        [WB_SEQUENCE_FAILED] = "failed",
    };
    return names[end];
}

static int print_json(const struct wb_bend_test_result *result, const char *output)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "recording", result->recorded ? output : NULL);
    wb_json_set_text(root, "end", end_name(result->end));
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
    return wb_command_print_json(root);
}

/* The curve of the test just recorded. */
static enum wb_status draw_figure(const char *recording, const char *path)
{
    struct wb_align_settings settings;
    struct wb_dataset dataset;
    wb_align_default_settings(&settings);
    WB_TRY(wb_align_run(&dataset, recording, &settings, NULL));
    const enum wb_status status = wb_quicklook_draw(&dataset, path);
    wb_dataset_release(&dataset);
    return status;
}

static void print_result(const struct wb_bend_test_result *result, const char *output)
{
    char *text = NULL;
    size_t size;
    FILE *const memory = open_memstream(&text, &size);
    if (memory)
        wb_record_test_print(memory, result, output);
    if (memory && fclose(memory) == 0)
        wb_live_line_print(text);
    free(text);
}

static int run_series(struct options *options)
{
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
    options.request.rig_path =
        options.is_virtual ? wb_command_find(options.common.input, rig) : options.common.input;
    if (options.series)
        return run_series(&options);
    options.request.output_path = options.common.output;
    options.request.specimen_path = wb_command_find(options.request.specimen_path, specimen);
    if (options.figure && wb_file_exists(options.figure)) {
        wb_error("'%s' exists: choose another name with --figure", options.figure);
        return WB_EXIT_FAILED;
    }
    if (wb_record_test_run(&options.request, &options.views,
                           options.is_virtual ? &options.virtual : NULL, &result, &code) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.figure && result.started &&
        draw_figure(options.request.output_path, options.figure) != WB_OK) {
        wb_error("'%s' was not drawn: the message before says why; the recording is not affected",
                 options.figure);
        code = code == WB_EXIT_OK ? WB_EXIT_INCOMPLETE : code;
    }
    if (options.common.json && print_json(&result, options.request.output_path) != WB_EXIT_OK)
        return WB_EXIT_FAILED;
    if (!options.common.json && result.recorded)
        print_result(&result, options.request.output_path);
    return code;
}
