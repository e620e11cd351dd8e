/* wirebench record: the paper's test, recorded. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "analysis/align/align.h"
#include "analysis/plot/figure.h"
#include "analysis/quicklook.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/live_line.h"
#include "cli/record_views.h"
#include "cli/settings.h"
#include "daq/acquisition.h"
#include "daq/bend_test.h"
#include "daq/specimen.h"
#include "fe/model/wire.h"

#define WB_LOG_DOMAIN "record"

struct options {
    struct wb_command_common common;
    struct wb_bend_test_request request;
    struct wb_record_views_options views;
    const char *figure; /* the curve's file; NULL: not wanted */
};

enum {
    OPTION_SPECIMEN = WB_KEY_OWN,
    OPTION_OPERATOR,
    OPTION_NOTES,
    OPTION_LIVE,
    OPTION_SERVE,
    OPTION_FIGURE
};

static const struct argp_option argp_options[] = {
    {"specimen", OPTION_SPECIMEN, "SPECIMEN.yaml", 0, "The piece of wire on the bench", 0},
    {"output", 'o', "REC.wbr", 0, "The recording to write; it must not exist", 0},
    {"operator", OPTION_OPERATOR, "NAME", 0, "Who runs the test, for the recording", 0},
    {"notes", OPTION_NOTES, "TEXT", 0, "Anything worth knowing later, for the recording", 0},
    {"live", OPTION_LIVE, NULL, 0,
     "Show the test on the whole terminal: curve, wire, large figures, instruments", 0},
    {"serve", OPTION_SERVE, "PORT", 0,
     "Show it as a web page at http://127.0.0.1:PORT/; 0 takes a free port", 0},
    {"figure", OPTION_FIGURE, "FILE", 0,
     "Draw force over deflection at the end, as SVG, PNG or PDF; the file must not exist", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print the outcome as JSON", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    struct wb_bend_test_request *const request = &options->request;
    switch (key) {
    case OPTION_SPECIMEN:
        request->specimen_path = argument;
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
    case ARGP_KEY_END:
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
    .args_doc = "RIG.yaml --specimen SPECIMEN.yaml -o REC.wbr",
    .doc =
        "Runs a cantilever test and records it: connects to the instruments of the rig file, "
        "checks the start (all markers seen, zero of the load cell sane, travel free, stage "
        "ready), takes the tare, moves the clamp down and back, N times.\v"
        "Mount the specimen with the strand slack: the stage's position when the test starts is "
        "its start position. Every limit of the rig file (force, overload, travel, a silent "
        "instrument, an alarm of the stage) stops the stage; the specimen then stays where it "
        "is, and 'wirebench stage RIG.yaml release' frees it.\n\n"
        "Keys while it runs: m marks the moment in the recording, q stops; Ctrl-C stops too. "
        "The stage is stopped before the recording is closed.\n\n"
        "Exit codes: 0 complete; 1 failed before the first cycle, or nothing was recorded; 2 wrong "
        "usage; 3 stopped early or data lost, what was recorded is usable.",
};

/* The fields of the live line, as text. */
struct fields {
    const char *origin;
    char phase[48], force[64], travel[32], deflection[32], markers[32], drops[32], rates[64];
};

static void fill_fields(const struct wb_bend_test_status *status, struct fields *f)
{
    const struct wb_acquisition_latest *const latest = status->latest;
    const struct wb_acquisition_stream_state *const stream = latest->stream;
    const int seconds = (int)status->elapsed;
    *f = (struct fields){status->is_virtual ? "virtual rig: " : "",
                         "",
                         "-- mN",
                         "-- mm",
                         "-- mm",
                         "no markers",
                         "",
                         ""};
    if (status->cycle > 0)
        snprintf(f->phase, sizeof f->phase, "%s %d/%d %d:%02d", status->phase, status->cycle,
                 status->cycles, seconds / 60, seconds % 60);
    else
        snprintf(f->phase, sizeof f->phase, "%s %d:%02d", status->phase, seconds / 60,
                 seconds % 60);
    if (status->has_tension)
        snprintf(f->force, sizeof f->force, "%.2f mN %.2f g", status->tension / WB_MN,
                 status->tension / status->gravity / WB_G);
    if (status->has_deflection)
        snprintf(f->deflection, sizeof f->deflection, "%.1f mm", status->deflection / WB_MM);
    if (status->has_travel)
        snprintf(f->travel, sizeof f->travel, "%.1f mm", status->travel / WB_MM);
    if (latest->has_mocap)
        snprintf(f->markers, sizeof f->markers, "%d/%d", latest->markers_seen,
                 status->markers_expected);
    snprintf(f->drops, sizeof f->drops, "%" PRIu64,
             stream[WB_ROLE_LOAD].drops + stream[WB_ROLE_MOCAP].drops +
                 stream[WB_ROLE_STAGE].drops);
    if (status->latest->is_storage_late)
        snprintf(f->drops, sizeof f->drops, "0, DISK %.1f s LATE",
                 wb_seconds_from_ns(status->latest->storage.lag_ns));
    snprintf(f->rates, sizeof f->rates, "%.0f/%.0f/%.0f Hz", stream[WB_ROLE_LOAD].rate,
             stream[WB_ROLE_MOCAP].rate, stream[WB_ROLE_STAGE].rate);
}

/* The longest form that the terminal has room for: in words, short, and short without rates. */
static void show(const struct wb_bend_test *test)
{
    struct wb_bend_test_status status;
    struct fields f;
    char line[512];
    wb_bend_test_status(test, &status);
    fill_fields(&status, &f);
    const int columns = wb_live_line_columns();
    int length =
        snprintf(line, sizeof line,
                 "%s%s  force %s  deflection %s  travel %s  markers %s  drops %s  "
                 "cell/cameras/stage %s",
                 f.origin, f.phase, f.force, f.deflection, f.travel, f.markers, f.drops, f.rates);
    if (length > columns)
        length = snprintf(line, sizeof line, "%s%s %s y %s %s %s drops %s", f.origin, f.phase,
                          f.force, f.deflection, f.markers, f.drops, f.rates);
    if (length > columns)
        snprintf(line, sizeof line, "%s%s %s y %s %s %s drops", f.origin, f.phase, f.force,
                 f.deflection, f.markers, f.drops);
    wb_live_line_show("%s", line);
}

static void obey(struct wb_bend_test *test, int key)
{
    if (key == 'm') {
        wb_bend_test_mark(test, "key m");
        wb_info("marked");
    } else if (key == 'q') {
        wb_bend_test_stop(test);
    }
}

static void run(struct wb_bend_test *test, struct wb_record_views *views)
{
    while (wb_bend_test_step(test, 20 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
        if (wb_record_views_tell(views, false) && wb_live_line_due())
            show(test);
        obey(test, wb_record_views_key(views));
    }
    (void)wb_record_views_tell(views, true);
}

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

/* What a stop leaves behind, and how to go on. */
static void tell_stop(const struct wb_bend_test_result *result, const char *rig_path)
{
    if (result->end == WB_SEQUENCE_LIMIT)
        wb_warn("stopped by a limit: %s", result->text);
    else if (result->end == WB_SEQUENCE_INTERRUPTED)
        wb_warn("%s", result->text);
    else
        wb_error("%s", result->text);
    if (!result->standing)
        wb_error("the stage did not confirm that it stands: switch off its power before you touch "
                 "the bench");
    else if (result->displaced && isfinite(result->travel))
        wb_warn("the stage stands at %.2f mm and the specimen stays as it is; free it with "
                "'wirebench stage %s release %.0f', which goes up by no more than that many mm",
                result->travel / WB_MM, rig_path, ceil(fabs(result->travel) / WB_MM) + 1.0);
    else if (result->displaced)
        wb_warn("the specimen stays as it is; free it with 'wirebench stage %s release'", rig_path);
}

static void tell_losses(const struct wb_bend_test_result *result)
{
    if (result->drops > 0)
        wb_warn("%" PRIu64 " reads are missing from the recording", result->drops);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        if (result->is_losing[role])
            wb_warn("%.2g %% of what the %s sent never came: %" PRIu64 " in %" PRIu64
                    " places, the longest of %.3g s: look at its cable or network, and at what "
                    "else this computer does",
                    wb_loss_share(&result->loss[role]) / WB_PERCENT,
                    wb_role_name((enum wb_role)role), result->loss[role].missing,
                    result->loss[role].gaps, result->loss[role].longest_gap);
    }
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

static void print_summary(const struct wb_bend_test_result *result, const char *output)
{
    printf("%s: %s%d cycle%s, %.0f s, %" PRIu64 " readings, %" PRIu64 " frames, largest force "
           "%.2f mN, %" PRIu64 " drops\n",
           output, result->is_virtual ? "virtual rig, " : "", result->cycles_done,
           result->cycles_done == 1 ? "" : "s", result->duration, result->samples[WB_ROLE_LOAD],
           result->samples[WB_ROLE_MOCAP], result->peak_tension / WB_MN, result->drops);
}

static int exit_code(const struct wb_bend_test_result *result, enum wb_status status)
{
    if (result->end == WB_SEQUENCE_DONE && status == WB_OK && result->drops == 0 &&
        !result->is_losing[WB_ROLE_LOAD] && !result->is_losing[WB_ROLE_MOCAP])
        return WB_EXIT_OK;
    if (result->end == WB_SEQUENCE_INTERRUPTED && result->recorded)
        return WB_EXIT_INCOMPLETE;
    return result->started ? WB_EXIT_INCOMPLETE : WB_EXIT_FAILED;
}

/* The specimen's wire, and what its file says of the first force. */
static enum wb_status find_wire(struct wb_bend_test_request *request, struct wb_wire *wire)
{
    struct wb_first_force_bounds *const bounds = &request->stiffness;
    char path[WB_PATH];
    struct wb_specimen specimen;
    WB_TRY(wb_specimen_read(request->specimen_path, &specimen));
    WB_TRY(wb_specimen_find_wire(&specimen, request->specimen_path, path));
    WB_TRY(wb_wire_read(path, wire, NULL));
    wb_wire_stiffness_bounds(wire, specimen.length, &bounds->lowest, &bounds->highest);
    snprintf(bounds->of, sizeof bounds->of,
             wire->has_properties ? "%s (a third to three times the properties in its file)"
                                  : "%s (between free strands and solid copper)",
             wire->name);
    return WB_OK;
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

int wb_cmd_record(int argc, char **argv)
{
    struct options options = {
        .common = {.noun = "rig file", .destination = "recording goes: -o REC.wbr"}};
    static struct wb_record_views views;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    struct wb_wire wire;
    char specimen[WB_PATH];
    wb_bend_test_default_request(&options.request);
    wb_settings_parse_table(&argp, &wb_bend_test_table, &options.request, 1, argc, argv, &options);
    options.request.rig_path = options.common.input;
    options.request.output_path = options.common.output;
    options.request.specimen_path = wb_command_find(options.request.specimen_path, specimen);
    if (find_wire(&options.request, &wire) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.figure && wb_file_exists(options.figure)) {
        wb_error("'%s' exists: choose another name with --figure", options.figure);
        return WB_EXIT_FAILED;
    }
    wb_interrupt_install();
    wb_interrupt_guard();
    if (wb_record_views_open(&views, &options.views, &options.request, &wire) != WB_OK)
        return WB_EXIT_FAILED;
    wb_acquisition_raise_priority();
    if (wb_bend_test_open(&test, &options.request) != WB_OK) {
        wb_record_views_close(&views);
        return WB_EXIT_FAILED;
    }
    wb_record_views_begin(&views, test);
    run(test, &views);
    const enum wb_status status = wb_bend_test_close(test, &result);
    wb_record_views_close(&views);
    if (result.end != WB_SEQUENCE_DONE)
        tell_stop(&result, options.request.rig_path);
    tell_losses(&result);
    if (!result.recorded)
        wb_info("nothing was recorded: '%s' was not kept", options.request.output_path);
    int code = exit_code(&result, status);
    if (options.figure && result.started &&
        draw_figure(options.request.output_path, options.figure) != WB_OK) {
        wb_error("'%s' was not drawn: the message before says why; the recording is not affected",
                 options.figure);
        code = code == WB_EXIT_OK ? WB_EXIT_INCOMPLETE : code;
    }
    if (options.common.json && print_json(&result, options.request.output_path) != WB_EXIT_OK)
        return WB_EXIT_FAILED;
    if (!options.common.json && result.recorded)
        print_summary(&result, options.request.output_path);
    return code;
}
