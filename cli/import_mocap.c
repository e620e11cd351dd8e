/* wirebench import mocap: a take of motion capture to a recording. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/import/mocap_import.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "cli/finding.h"
#include "cli/import.h"
#include "cli/settings.h"

#define WB_LOG_DOMAIN "import"

#define KEY_SYNC WB_KEY_OWN

struct options {
    struct wb_command_common common;
    struct wb_mocap_import_request request;
};

static const struct argp_option other_options[] = {
    {"output", 'o', "REC.wbr", 0, "Recording to write"},
    {"specimen", WB_KEY_TEXT(options, request.specimen_path), "S.yaml", 0, "The specimen"},
    {"rig", WB_KEY_TEXT(options, request.rig_path), "R.yaml", 0,
     "The bench: load cell, vertical axis of the cameras, strand"},
    {"force", WB_KEY_TEXT(options, request.force_path), "FILE", 0, "Table of time and force"},
    {"columns", WB_KEY_TEXT(options, request.columns), "LIST", 0,
     "Columns of that table and their units: time=1:ms,force=2:mN (from the header)"},
    {"channel", WB_KEY_TEXT(options, request.channel), "NAME[:UNIT]", 0,
     "Analogue channel of a C3D with the force (the only one in a unit of force)"},
    {"sync", KEY_SYNC, "EVENT", 0,
     "Event that synchronises the two clocks: tap or reversal (the better of both)"},
    {"notes", WB_KEY_TEXT(options, request.notes), "TEXT", 0, "Notes, stored in the recording"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static void set_sync(struct argp_state *state, struct wb_mocap_import_request *request,
                     const char *event)
{
    request->tap = strcmp(event, "tap") == 0;
    request->reversal = strcmp(event, "reversal") == 0;
    if (!request->tap && !request->reversal)
        argp_error(state, "--sync: expected tap or reversal, not '%s'", event);
}

static void check(struct argp_state *state, const struct options *options)
{
    const struct wb_mocap_import_request *const request = &options->request;
    if (!options->common.input)
        argp_error(state, "take missing: a CSV export of Motive, a C3D or a TRC");
    if (!request->specimen_path)
        argp_error(state, "specimen missing: --specimen S.yaml");
    if (!request->rig_path)
        argp_error(state, "rig missing: --rig R.yaml");
    if (request->columns && !request->force_path)
        argp_error(state, "--columns needs --force FILE");
    if (request->channel && request->force_path)
        argp_error(state, "--force and --channel cannot be combined");
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct options *const options = state->input;
    if (key == KEY_SYNC) {
        set_sync(state, &options->request, argument);
        return 0;
    }
    if (key == ARGP_KEY_END)
        check(state, options);
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = other_options,
    .parser = parse,
    .args_doc = "FILE --specimen S.yaml --rig R.yaml -o REC.wbr",
    .doc =
        "Converts a take of motion capture into a recording: a CSV export of Motive, a C3D or a "
        "TRC, detected by its content. The force comes from a table with a clock of its own, or "
        "from an analogue channel of the C3D.\v"
        "The recording contains the files unchanged; 'wirebench align' makes a dataset of it. Two "
        "clocks are synchronised by an event that both files show: a tap on the bench, or a "
        "reversal of the motion; the lag is printed with its uncertainty. Exit code 3: frames or "
        "rows are missing or were left out, and are counted.",
};

/* --- output --- */

static void print_clocks(const struct wb_mocap_import *r)
{
    switch (r->sync.method) {
    case WB_SYNC_SAME:
        printf("  clocks      one: force and markers are in the same file\n");
        return;
    case WB_SYNC_GIVEN:
        printf("  clocks      clock of the force + %.4f s, as given\n", r->sync.lag);
        return;
    default:
        printf("  clocks      by %s: lag %.4f s +- %.1f ms (%d event%s, the first at %.2f s), "
               "including %.0f ms of the load cell's filter\n",
               wb_sync_name(r->sync.method), r->sync.lag, r->sync.uncertainty * 1e3,
               r->sync.n_events, r->sync.n_events == 1 ? "" : "s", r->sync.first_event,
               -r->filter_delay * 1e3);
    }
}

static void print_force(const struct wb_mocap_import *r)
{
    if (!r->has_force) {
        printf("  force       none: 'align' needs it; add --force FILE\n");
        return;
    }
    if (r->channel[0])
        printf("  force       %zu readings of channel %s, in %s\n", r->n_readings, r->channel,
               r->unit);
    else
        printf("  force       %zu readings, columns %s\n", r->n_readings, r->columns);
    print_clocks(r);
    if (isfinite(r->tare_deviation))
        printf("  tare        %.4g mN, mean of %ld readings before the motion at %.2f s\n",
               r->tare / WB_MN, r->tare_samples, r->motion_start);
    else
        printf("  tare        %.4g mN, as given\n", r->tare / WB_MN);
}

static void print_missing(const struct wb_mocap_import *r)
{
    if (r->missing_frames > 0)
        printf("  missing     %zu of the frames that the file's header announces\n",
               r->missing_frames);
    if (r->jumps > 0)
        printf("  missing     %zu frames, in %zu gaps\n", r->jumped, r->jumps);
    if (r->skipped_rows > 0)
        printf("  left out    %zu rows, the first in line %zu\n", r->skipped_rows,
               r->first_skipped);
    if (r->force_skipped > 0)
        printf("  left out    %zu rows of the force\n", r->force_skipped);
}

static void print_text(const struct wb_mocap_import *r, const char *output)
{
    printf("%s: recording\n", output);
    printf("  take        %s, %zu frames, %.2f s at %g/s\n", r->format, r->n_frames, r->duration,
           r->rate);
    printf(
        "  markers     %d, stitched from %zu of %zu columns, %.2f %% of their positions missing\n",
        r->n_markers, r->n_stitched, r->n_points, 100.0 * r->missing);
    print_force(r);
    print_missing(r);
}

static void print_finding(const struct wb_mocap_import *r, const char *output)
{
    struct wb_finding finding = {.figure = NULL};
    char dataset[WB_PATH];
    wb_text_append(&finding.found, "%d markers in %zu frames over %.1f s", r->n_markers,
                   r->n_frames, r->duration);
    if (r->has_force)
        wb_text_append(&finding.found, ", %zu readings of the force", r->n_readings);
    else
        wb_text_append(&finding.found, ", no force");
    if (r->complete)
        wb_text_append(&finding.trust, "yes: no frame or row is missing or was left out");
    else
        wb_text_append(&finding.trust, "in part: frames or rows are missing, see above");
    if (r->has_force && r->sync.method == WB_SYNC_GIVEN)
        wb_text_append(&finding.trust, "; the clocks were synchronised with the given lag");
    else if (r->has_force && r->sync.method != WB_SYNC_SAME)
        wb_text_append(&finding.trust, "; the clocks are synchronised within %.1f ms",
                       r->sync.uncertainty * 1e3);
    if (r->has_force) {
        snprintf(dataset, sizeof dataset, "%.*s",
                 (int)strlen(output) - (wb_command_ends_in(output, ".wbr") ? 4 : 0), output);
        wb_finding_append_command(&finding.next, "wirebench align %s -o %s", output, dataset);
    } else {
        wb_text_append(&finding.next, "import the take again with --force FILE");
    }
    wb_finding_print(&finding);
}

static void print_json(const struct wb_mocap_import *r, const char *output)
{
    struct wb_json *const root = wb_json_create();
    wb_json_set_text(root, "recording", output);
    wb_json_set_text(root, "format", r->format);
    wb_json_set_integer(root, "frames", (int64_t)r->n_frames);
    wb_json_set_number(root, "rate_per_s", r->rate);
    wb_json_set_number(root, "duration_s", r->duration);
    wb_json_set_integer(root, "missing_frames", (int64_t)r->missing_frames);
    wb_json_set_integer(root, "jumps", (int64_t)r->jumps);
    wb_json_set_integer(root, "frames_jumped", (int64_t)r->jumped);
    wb_json_set_integer(root, "skipped_rows", (int64_t)r->skipped_rows);
    wb_json_set_integer(root, "first_skipped_line", (int64_t)r->first_skipped);
    wb_json_set_integer(root, "empty_rows", (int64_t)r->empty_rows);
    wb_json_set_integer(root, "marker_columns", (int64_t)r->n_points);
    wb_json_set_integer(root, "columns_stitched", (int64_t)r->n_stitched);
    wb_json_set_integer(root, "markers", r->n_markers);
    wb_json_set_number(root, "missing_percent", 100.0 * r->missing);
    wb_json_set_boolean(root, "complete", r->complete);
    if (r->has_force) {
        struct wb_json *const force = wb_json_set_object(root, "force");
        wb_json_set_integer(force, "readings", (int64_t)r->n_readings);
        wb_json_set_integer(force, "skipped_rows", (int64_t)r->force_skipped);
        if (r->channel[0]) {
            wb_json_set_text(force, "channel", r->channel);
            wb_json_set_text(force, "unit", r->unit);
        } else {
            wb_json_set_text(force, "columns", r->columns);
        }
        wb_json_set_text(force, "clocks", wb_sync_name(r->sync.method));
        wb_json_set_number(force, "lag_s", r->sync.lag);
        wb_json_set_number(force, "lag_uncertainty_s", r->sync.uncertainty);
        wb_json_set_integer(force, "events", r->sync.n_events);
        wb_json_set_number(force, "offset_s", r->offset);
        wb_json_set_number(force, "tare_mN", r->tare / WB_MN);
        wb_json_set_number(force, "motion_start_s", r->motion_start);
    }
    wb_command_print_json(root);
}

int wb_import_mocap(int argc, char **argv)
{
    struct options options = {
        .common = {.noun = "take", .destination = "recording goes: -o REC.wbr"}};
    struct wb_mocap_import result;
    char specimen[WB_PATH], rig[WB_PATH];
    wb_setting_fill(&wb_mocap_import_table, &options.request);
    wb_settings_parse_table(&argp, &wb_mocap_import_table, &options.request, 1, argc, argv,
                            &options);
    struct wb_mocap_import_request *const request = &options.request;
    request->take_path = options.common.input;
    request->output = options.common.output;
    if (wb_file_kind_check(request->take_path, WB_FILE_BIT(WB_FILE_TAKE)) != WB_OK ||
        wb_file_kind_find_input(&request->specimen_path, specimen, WB_FILE_SPECIMENS) != WB_OK ||
        wb_file_kind_find_input(&request->rig_path, rig, WB_FILE_BIT(WB_FILE_RIG)) != WB_OK ||
        wb_mocap_import_run(&result, request) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.common.json) {
        print_json(&result, request->output);
    } else {
        print_text(&result, request->output);
        print_finding(&result, request->output);
    }
    return result.complete ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
