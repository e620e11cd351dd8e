/* wirebench export: samples of a recording as CSV; tables of a recording or dataset as HDF5; with
 * --to, the law of a wire as a card. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "analysis/cards/card.h"
#include "base/file.h"
#include "base/version.h"
#include "cli/complete.h"
#include "cli/export.h"
#include "cli/file_kind.h"
#include "daq/recording/export.h"
#include "daq/recording/replay.h"

#define WB_LOG_DOMAIN "export"

/* Only for --help: cli/export_card.c parses it. */
#define KEY_TO WB_KEY_OWN

static const struct argp_option option_table[] = {
    {"to", KEY_TO, "KIND", 0,
     "From a wire or properties file, write a card for another program; see `wirebench export --to "
     "KIND --help`"},
    {"output", 'o', "DIR|FILE.h5", 0, "Folder for CSV files, or HDF5 file to write"},
    {"force", WB_KEY_FORCE, NULL, 0,
     "Write into a folder that contains files already, or overwrite the file"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr -o DIR\nREC.wbr|DATASET -o FILE.h5\nWIRE|FILE --to KIND",
    .doc = "Decodes a recording (.wbr or .wbr.zst) and writes load.csv, mocap.csv, stage.csv, "
           "events.csv and clock.csv. With -o FILE.h5 it writes the tables of a recording or a "
           "dataset into one HDF5 file, lengths in metres.\v"
           "The values are those of the instruments: not tared, aligned or filtered, which "
           "'wirebench align' does. Exit code 3: parts of the recording are missing or damaged and "
           "left out.",
};

static enum wb_status write_samples(struct wb_recording *recording,
                                    const struct wb_command_common *options,
                                    struct wb_export_counts *counts)
{
    struct wb_rig rig;
    char sha256[65], source[WB_PATH + 160];
    WB_TRY(wb_replay_rig(recording, &rig));
    if (wb_recording_hash(recording, sha256) != WB_OK)
        snprintf(sha256, sizeof sha256, "unknown");
    WB_TRY(wb_file_prepare_output(options->output, options->force));
    snprintf(source, sizeof source, "%s (sha256 %s), wirebench %s (%s)",
             wb_file_name(options->input), sha256, wb_version(), wb_version_revision());
    return wb_export_csv(recording, &rig, source, options->output, counts);
}

static void print(const struct wb_command_common *options, const struct wb_export_counts *counts)
{
    if (!options->json) {
        printf("%s: %" PRIu64 " load readings, %" PRIu64 " markers, %" PRIu64
               " stage reports, %" PRIu64 " events, %" PRIu64 " clock probes\n",
               options->output, counts->load, counts->mocap, counts->stage, counts->events,
               counts->clock);
        return;
    }
    struct wb_json *root = wb_json_create();
    wb_json_set_text(root, "folder", options->output);
    wb_json_set_integer(root, "load_rows", (int64_t)counts->load);
    wb_json_set_integer(root, "mocap_rows", (int64_t)counts->mocap);
    wb_json_set_integer(root, "stage_rows", (int64_t)counts->stage);
    wb_json_set_integer(root, "event_rows", (int64_t)counts->events);
    wb_json_set_integer(root, "clock_rows", (int64_t)counts->clock);
    wb_json_set_integer(root, "damaged_chunks", (int64_t)counts->damaged_chunks);
    wb_command_print_json(root);
}

static bool is_to(const char *argument)
{
    return strcmp(argument, "--to") == 0 || strncmp(argument, "--to=", 5) == 0;
}

int wb_cmd_export(int argc, char **argv)
{
    for (int i = 0; i < WB_CARD_KINDS; i++)
        wb_complete_value("to", wb_card_kinds[i].name);
    for (int i = 1; i < argc; i++) {
        if (is_to(argv[i]))
            return wb_export_card(argc, argv);
    }
    struct wb_command_common options = {.noun = "recording or dataset",
                                        .destination = "files go: -o DIR or -o FILE.h5"};
    struct wb_recording *recording = NULL;
    struct wb_export_counts counts = {0};
    wb_command_parse(&argp, argc, argv, &options);
    if (wb_file_kind_check(options.input,
                           WB_FILE_BIT(WB_FILE_RECORDING) | WB_FILE_BIT(WB_FILE_DATASET)) != WB_OK)
        return WB_EXIT_FAILED;
    if (wb_command_ends_in(options.output, ".h5") || wb_command_ends_in(options.output, ".hdf5"))
        return wb_export_hdf5(&options);
    if (wb_file_is_folder(options.input))
        return wb_command_exit(wb_fail(WB_ERR_UNSUPPORTED,
                                       "'%s' is a folder: a dataset contains its tables as CSV "
                                       "already; use -o FILE.h5 for one HDF5 file",
                                       options.input));
    enum wb_status status = wb_recording_open(&recording, options.input);
    bool complete = status == WB_OK && wb_recording_is_complete(recording);
    if (status == WB_OK)
        status = write_samples(recording, &options, &counts);
    if (wb_recording_close(recording) != WB_OK)
        return WB_EXIT_FAILED;
    /* Damage was logged while reading; the readable part was written. */
    bool written = status == WB_OK || (status == WB_ERR_DATA && counts.load + counts.mocap > 0);
    if (!written)
        return WB_EXIT_FAILED;
    print(&options, &counts);
    if (counts.damaged_chunks > 0)
        wb_warn("%" PRIu64 " damaged chunk%s left out", counts.damaged_chunks,
                counts.damaged_chunks == 1 ? " was" : "s were");
    return status == WB_OK && complete && counts.damaged_chunks == 0 ? WB_EXIT_OK
                                                                     : WB_EXIT_INCOMPLETE;
}
