/* wirebench recover: salvages the data of a damaged recording. */
#include <inttypes.h>
#include <stdio.h>

#include "base/units.h"
#include "cli/command.h"
#include "cli/file_kind.h"
#include "daq/recording/recover.h"

#define WB_LOG_DOMAIN "recover"

static const struct argp_option option_table[] = {
    {"output", 'o', "NEW.wbr", 0, "Recording to write"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr -o NEW.wbr",
    .doc = "Copies the intact data of a damaged or unclosed recording (.wbr or .wbr.zst, with the "
           "-wal file beside it) into a new one. The old files are only read. Rows are searched "
           "page by page, also behind damaged pages, and kept where their checksum is correct.\v"
           "The new recording states its source and what is missing. Exit codes: 0 complete; 1 "
           "nothing could be written; 2 wrong usage; 3 data are missing, or the end of the "
           "recording is unknown.",
};

static void print_text(const struct wb_command_common *options, const struct wb_recover *found)
{
    uint64_t chunks = 0;
    char missing[600];
    for (int i = 0; i < WB_RECOVER_STREAMS; i++)
        chunks += found->streams[i].chunks;
    wb_recover_missing(found, missing, sizeof missing);
    printf("%s: %" PRIu64 " rows of '%s', with %" PRIu64 " chunks in %.1f s%s\n", options->output,
           found->rows, options->input, chunks,
           wb_seconds_from_ns(found->last_ns - found->first_ns),
           found->is_protected
               ? ""
               : ", partly protected (an older recording: only the bytes of its chunks have a "
                 "checksum)");
    if (*missing)
        printf("  missing: %s\n", missing);
    else
        printf("  nothing is missing\n");
}

static void print_json(const struct wb_command_common *options, const struct wb_recover *found)
{
    struct wb_json *const root = wb_json_create();
    char missing[600];
    wb_recover_missing(found, missing, sizeof missing);
    wb_json_set_text(root, "recording", options->output);
    wb_json_set_text(root, "from", options->input);
    wb_json_set_text(root, "from_sha256", found->sha256);
    wb_json_set_boolean(root, "whole", wb_recover_is_whole(found));
    wb_json_set_boolean(root, "protected", found->is_protected);
    wb_json_set_boolean(root, "end_known", found->is_end_known);
    wb_json_set_boolean(root, "log_missing", found->is_log_missing);
    wb_json_set_integer(root, "rows", (int64_t)found->rows);
    wb_json_set_integer(root, "missing_rows", (int64_t)found->missing);
    wb_json_set_integer(root, "damaged_rows", (int64_t)found->damaged);
    wb_json_set_text(root, "missing", missing);
    struct wb_json *const streams = wb_json_set_array(root, "streams");
    for (int i = 0; i < WB_RECOVER_STREAMS; i++) {
        const struct wb_recover_stream *const s = &found->streams[i];
        if (s->chunks == 0)
            continue;
        struct wb_json *const object = wb_json_append_object(streams);
        wb_json_set_integer(object, "id", i);
        wb_json_set_integer(object, "chunks", (int64_t)s->chunks);
        wb_json_set_integer(object, "missing_chunks", (int64_t)s->missing);
    }
    wb_command_print_json(root);
}

int wb_cmd_recover(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "recording",
                                        .destination = "recording goes: -o NEW.wbr"};
    struct wb_recover found;
    wb_command_parse(&argp, argc, argv, &options);
    if (wb_file_kind_check(options.input, WB_FILE_BIT(WB_FILE_RECORDING)) != WB_OK ||
        wb_recover_run(options.input, options.output, &found, NULL) != WB_OK)
        return WB_EXIT_FAILED;
    if (options.json)
        print_json(&options, &found);
    else
        print_text(&options, &found);
    return wb_recover_is_whole(&found) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
