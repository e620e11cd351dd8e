/* wirebench export: a recording's samples as CSV. */
#include <inttypes.h>
#include <stdio.h>

#include "base/file.h"
#include "base/version.h"
#include "cli/command.h"
#include "daq/export.h"
#include "daq/replay.h"

#define WB_LOG_DOMAIN "export"

static const struct argp_option option_table[] = {
    {"output", 'o', "DIR", 0, "Folder to write into", 0},
    {"force", WB_KEY_FORCE, NULL, 0, "Write into a folder that holds files already", 0},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object", 0},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_only_common,
    .args_doc = "REC.wbr -o DIR",
    .doc = "Decodes a recording (.wbr or .wbr.zst) and writes load.csv, mocap.csv, stage.csv, "
           "events.csv and clock.csv.\v"
           "The numbers are what the instruments said: not tared, aligned or filtered; "
           "'wirebench align' does that. Exit code 3: parts of the recording are missing or "
           "damaged and left out.",
};

static enum wb_status write_samples(struct wb_recording *recording,
                                    const struct wb_command_common *options,
                                    struct wb_export_counts *counts)
{
    struct wb_rig rig;
    char sha256[65], source[WB_PATH + 160];
    WB_TRY(wb_replay_rig(recording, &rig));
    if (wb_recording_sha256(options->input, sha256, NULL) != WB_OK)
        snprintf(sha256, sizeof sha256, "unknown");
    WB_TRY(wb_file_prepare_output(options->output, options->force));
    snprintf(source, sizeof source, "%s (sha256 %s), wirebench %s (%s)",
             wb_file_name(options->input), sha256, wb_version(), wb_version_revision());
    return wb_export_csv(recording, &rig, source, options->output, counts);
}

static int print(const struct wb_command_common *options, const struct wb_export_counts *counts)
{
    if (!options->json) {
        printf("%s: %" PRIu64 " load readings, %" PRIu64 " markers, %" PRIu64
               " stage reports, %" PRIu64 " events, %" PRIu64 " clock probes\n",
               options->output, counts->load, counts->mocap, counts->stage, counts->events,
               counts->clock);
        return WB_EXIT_OK;
    }
    struct wb_json *root = wb_json_create();
    wb_json_set_text(root, "folder", options->output);
    wb_json_set_integer(root, "load_rows", (int64_t)counts->load);
    wb_json_set_integer(root, "mocap_rows", (int64_t)counts->mocap);
    wb_json_set_integer(root, "stage_rows", (int64_t)counts->stage);
    wb_json_set_integer(root, "event_rows", (int64_t)counts->events);
    wb_json_set_integer(root, "clock_rows", (int64_t)counts->clock);
    wb_json_set_integer(root, "damaged_chunks", (int64_t)counts->damaged_chunks);
    return wb_command_print_json(root);
}

int wb_cmd_export(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "recording", .destination = "files go: -o DIR"};
    struct wb_recording *recording = NULL;
    struct wb_export_counts counts = {0};
    wb_command_parse(&argp, argc, argv, &options);
    enum wb_status status = wb_recording_open(&recording, options.input);
    bool complete = status == WB_OK && wb_recording_is_complete(recording);
    if (status == WB_OK)
        status = write_samples(recording, &options, &counts);
    if (wb_recording_close(recording) != WB_OK)
        return WB_EXIT_FAILED;
    /* Damage was logged while reading; what could be read has been written. */
    bool written = status == WB_OK || (status == WB_ERR_DATA && counts.load + counts.mocap > 0);
    if (!written || print(&options, &counts) != WB_EXIT_OK)
        return WB_EXIT_FAILED;
    if (counts.damaged_chunks > 0)
        wb_warn("%" PRIu64 " damaged chunk%s left out", counts.damaged_chunks,
                counts.damaged_chunks == 1 ? " was" : "s were");
    return status == WB_OK && complete && counts.damaged_chunks == 0 ? WB_EXIT_OK
                                                                     : WB_EXIT_INCOMPLETE;
}
