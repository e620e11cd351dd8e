/* wirebench verify: checks recordings for missing or damaged data. */
#include <inttypes.h>
#include <stdio.h>

#include "cli/command.h"
#include "cli/file_kind.h"
#include "daq/recording/survey.h"

#define WB_LOG_DOMAIN "verify"

static const struct argp_option option_table[] = {
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

static const struct argp argp = {
    .options = option_table,
    .parser = wb_command_parse_common,
    .args_doc = "REC.wbr...",
    .doc =
        "Checks recordings (.wbr or .wbr.zst): checksum and position of every row, gaps in the "
        "sequence numbers, frames and lines that did not arrive, drops logged during the "
        "recording, silent or missing streams, and whether the file was closed properly.\v"
        "Exit codes: 0 complete; 1 a file could not be opened; 2 wrong usage; 3 data are missing "
        "or damaged, the rest is usable.",
};

static void print_text(const char *path, const char *sha256, const struct wb_survey *survey)
{
    bool whole = wb_survey_is_whole(survey);
    printf("%s: %s%s%s, %" PRIu64 " chunks in %.1f s, sha256 %s\n", path,
           survey->is_virtual ? "virtual rig, " : "", whole ? "whole" : "NOT WHOLE",
           survey->check.is_protected ? ""
                                      : ", partly protected (an older recording: only the bytes of "
                                        "its chunks have a checksum)",
           survey->chunks, wb_survey_duration(survey), sha256[0] ? sha256 : "unknown");
    char text[256];
    for (int at = 0; wb_survey_problem(survey, &at, text, sizeof text);)
        printf("  %s\n", text);
}

static void add_streams(struct wb_json *object, const struct wb_survey *survey)
{
    struct wb_json *streams = wb_json_set_array(object, "streams");
    for (int i = 0; i < survey->n_streams; i++) {
        const struct wb_survey_stream *s = &survey->streams[i];
        struct wb_json *item = wb_json_append_object(streams);
        wb_json_set_integer(item, "id", s->id);
        wb_json_set_text(item, "role", wb_role_name(s->role));
        wb_json_set_integer(item, "chunks", (int64_t)s->chunks);
        wb_json_set_integer(item, "damaged_chunks", (int64_t)s->damaged);
        wb_json_set_integer(item, "missing_chunks", (int64_t)s->missing);
        wb_json_set_integer(item, "gaps", (int64_t)s->gaps);
        wb_json_set_integer(item, "repeated_chunks", (int64_t)s->repeated);
        wb_json_set_integer(item, "samples", (int64_t)s->samples);
        wb_json_set_integer(item, "missing_samples", (int64_t)s->loss.missing);
        wb_json_set_integer(item, "repeated_samples", (int64_t)s->loss.repeated);
        wb_json_set_integer(item, "overtaken_samples", (int64_t)s->loss.overtaken);
    }
}

static void add_json(struct wb_json *array, const char *path, const char *sha256,
                     const struct wb_survey *survey)
{
    struct wb_json *object = wb_json_append_object(array);
    wb_json_set_text(object, "recording", path);
    wb_json_set_text(object, "sha256", sha256[0] ? sha256 : NULL);
    wb_json_set_boolean(object, "virtual_rig", survey->is_virtual);
    wb_json_set_boolean(object, "whole", wb_survey_is_whole(survey));
    wb_json_set_boolean(object, "closed", survey->closed);
    wb_json_set_boolean(object, "protected", survey->check.is_protected);
    wb_json_set_boolean(object, "database_damaged", survey->broken);
    wb_json_set_integer(object, "rows", (int64_t)survey->check.rows);
    wb_json_set_integer(object, "damaged_rows", (int64_t)survey->check.damaged);
    wb_json_set_integer(object, "missing_rows", (int64_t)survey->check.lost);
    wb_json_set_integer(object, "displaced_rows", (int64_t)survey->check.displaced);
    wb_json_set_integer(object, "chunks", (int64_t)survey->chunks);
    wb_json_set_integer(object, "damaged_chunks", (int64_t)survey->damaged);
    wb_json_set_integer(object, "missing_chunks", (int64_t)survey->missing);
    wb_json_set_integer(object, "undeclared_chunks", (int64_t)survey->undeclared);
    wb_json_set_integer(object, "drop_events", (int64_t)survey->drop_events);
    if (survey->dropped_chunks >= 0)
        wb_json_set_integer(object, "dropped_chunks", survey->dropped_chunks);
    wb_json_set_integer(object, "stream_lost_events", (int64_t)survey->lost_events);
    wb_json_set_number(object, "duration_s", wb_survey_duration(survey));
    add_streams(object, survey);
    struct wb_json *problems = wb_json_set_array(object, "problems");
    char text[256];
    for (int at = 0; wb_survey_problem(survey, &at, text, sizeof text);)
        wb_json_append_text(problems, text);
}

static enum wb_status look(const char *path, struct wb_survey *survey, char sha256[65])
{
    struct wb_recording *recording = NULL;
    WB_TRY(wb_file_kind_check(path, WB_FILE_BIT(WB_FILE_RECORDING)));
    WB_TRY(wb_recording_open(&recording, path));
    enum wb_status status = wb_survey_run(recording, true, survey);
    if (status == WB_OK && wb_recording_hash(recording, sha256) != WB_OK)
        sha256[0] = '\0';
    enum wb_status closed = wb_recording_close(recording);
    return status != WB_OK ? status : closed;
}

int wb_cmd_verify(int argc, char **argv)
{
    struct wb_command_common options = {.noun = "the recordings", .least = 1};
    wb_command_parse(&argp, argc, argv, &options);
    struct wb_json *root = options.json ? wb_json_create() : NULL;
    struct wb_json *array = root ? wb_json_set_array(root, "recordings") : NULL;
    int code = WB_EXIT_OK;
    for (int i = 0; i < options.n; i++) {
        struct wb_survey survey;
        char sha256[65] = "";
        if (look(options.inputs[i], &survey, sha256) != WB_OK) {
            code = WB_EXIT_FAILED;
            continue;
        }
        if (code == WB_EXIT_OK && !wb_survey_is_whole(&survey))
            code = WB_EXIT_INCOMPLETE;
        if (options.json)
            add_json(array, options.inputs[i], sha256, &survey);
        else
            print_text(options.inputs[i], sha256, &survey);
    }
    if (options.json)
        wb_command_print_json(root);
    return code;
}
