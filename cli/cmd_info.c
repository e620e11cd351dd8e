/* wirebench info: describes a recording here, a bundle in info_bundle.c, other files in
 * info_file.c. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/plot/figure.h"
#include "base/memory.h"
#include "base/units.h"
#include "cli/command.h"
#include "cli/complete.h"
#include "cli/info.h"
#include "daq/protocol/specimen.h"
#include "daq/recording/index.h"
#include "daq/recording/recover.h"
#include "daq/recording/replay.h"
#include "daq/recording/survey.h"
#include "daq/test/check_log.h"

#define WB_LOG_DOMAIN "info"

enum {
    KEY_FIGURE = WB_KEY_OWN,
    KEY_MESH,
    KEY_SCHEMA
};

static const struct argp_option option_table[] = {
    {"figure", KEY_FIGURE, "FILE", 0, "Draw the section of a bundle: .svg, .png or .pdf"},
    {"mesh", KEY_MESH, "NAME", 0, "Draw the lines of this mesh (that of the run)"},
    {"force", WB_KEY_FORCE, NULL, 0, "Overwrite the figure"},
    {"schema", KEY_SCHEMA, "KIND", 0,
     "Print the JSON Schema of a kind of file: dataset, report, manifest, properties, harness or "
     "harness-answer"},
    {"json", WB_KEY_JSON, NULL, 0, "Print one JSON object"},
    {0},
};

/* Whether it is the name of a shipped bundle: there is no such file, or a folder of unknown kind.
 */
static bool is_shipped_name(const char *name, enum wb_file_kind kind)
{
    return kind == WB_FILE_UNKNOWN && !strchr(name, '/') &&
           (!wb_file_exists(name) || wb_file_is_folder(name));
}

static bool is_bundle(const char *name)
{
    char found[WB_PATH];
    const enum wb_file_kind kind = wb_file_kind_find(wb_command_find(name, found));
    return kind == WB_FILE_BUNDLE || is_shipped_name(name, kind);
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    struct wb_info_options *const options = state->input;
    switch (key) {
    case KEY_FIGURE:
        if (!wb_figure_is_file(argument))
            argp_error(state, "--figure: expected a file that ends in .svg, .png or .pdf, not '%s'",
                       argument);
        options->figure = argument;
        return 0;
    case KEY_MESH:
        if (!argument[0])
            argp_error(state, "--mesh: expected NAME, not ''");
        options->mesh = argument;
        return 0;
    case KEY_SCHEMA:
        options->schema = wb_schema_find(argument);
        if (!options->schema)
            argp_error(state,
                       "--schema: expected dataset, report, manifest, properties, harness or "
                       "harness-answer, not '%s'",
                       argument);
        return 0;
    case ARGP_KEY_END:
        if (options->schema && options->common.input)
            argp_error(state, "--schema takes no file: '%s' is given", options->common.input);
        if (options->schema)
            return 0;
        if (options->mesh && !options->figure)
            argp_error(state, "--mesh needs --figure");
        if (options->figure && options->common.input && !is_bundle(options->common.input))
            argp_error(state, "--figure applies to bundles, and '%s' is not a bundle",
                       options->common.input);
        break;
    }
    return wb_command_parse_common(key, argument, state);
}

static const struct argp argp = {
    .options = option_table,
    .parser = parse,
    .args_doc = "FILE\n--schema KIND",
    .doc =
        "Prints the kind of a file or folder and the next command for it. Of a recording (.wbr or "
        ".wbr.zst): specimen, rig, operator, streams with their rates, events. Of a bundle "
        "(fixtures/bundles, by name or path): wires, packing, tape, diameters, density and "
        "bounds of its flexural rigidity beside the published ones, meshes. Of a properties "
        "file: its values. Of a dataset: a summary. Other kinds are recognised by their content, "
        "but not checked.\v"
        "Exit codes: 0 ok; 1 the file cannot be read or is of unknown kind; 2 wrong usage; 3 data "
        "of a recording are missing or damaged, which 'wirebench verify' lists.",
};

/* The contents of a recording, read once. */
struct facts {
    struct wb_recording *recording;
    struct wb_survey survey;
    char sha256[65];
    bool has_rig, has_specimen;
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_index_entry entry; /* of the index beside the recording; zeroed without one */
    struct wb_json *events;      /* array being filled */
};

/* The metadata of a key, or ""; the caller frees it. */
static char *meta(struct facts *facts, const char *key)
{
    char *value = NULL;
    if (wb_recording_meta(facts->recording, key, &value) != WB_OK)
        return wb_memory_text("");
    return value;
}

static enum wb_status gather(struct facts *facts, const char *path)
{
    WB_TRY(wb_recording_open(&facts->recording, path));
    WB_TRY(wb_survey_run(facts->recording, true, &facts->survey));
    if (wb_recording_hash(facts->recording, facts->sha256) != WB_OK)
        strcpy(facts->sha256, "");
    struct wb_reason why = {.text = ""};
    if (!wb_index_look_up(&facts->entry, path, facts->sha256, &why) && why.text[0])
        wb_warn("the index beside the recording cannot be read, so that exclusion is unknown: %s",
                why.text);
    if (facts->survey.has_rig)
        facts->has_rig = wb_replay_rig(facts->recording, &facts->rig) == WB_OK;
    if (facts->survey.has_specimen) {
        char *text = meta(facts, "specimen");
        facts->has_specimen =
            wb_specimen_parse(text, "the recording's specimen", &facts->specimen, NULL) == WB_OK;
        free(text);
    }
    return WB_OK;
}

/* --- as text --- */

static void print_meta(struct facts *facts, const char *label, const char *key)
{
    char *value = meta(facts, key);
    if (value[0])
        printf("  %-10s %s\n", label, value);
    free(value);
}

#define SETTINGS_COLUMNS 86 /* behind the label, in a terminal of 100 */

/* Series and exclusion, from the index beside the recording. */
static void print_entry(const struct wb_index_entry *entry)
{
    char text[WB_INDEX_EXCLUSION_TEXT];
    if (entry->series[0])
        printf("  %-10s %s, test %d\n", "series", entry->series, entry->number);
    wb_index_exclusion_describe(&entry->excluded, text);
    if (entry->excluded.is_excluded)
        printf("  %-10s %s\n", "EXCLUDED", text);
}

/* The settings of the stage's firmware, several on a line. */
static void print_settings(struct facts *facts)
{
    char *const value = meta(facts, "stage_settings"), *rest = NULL;
    size_t used = 0;
    for (char *word = strtok_r(value, "\n", &rest); word; word = strtok_r(NULL, "\n", &rest)) {
        const size_t n = strlen(word) + 1;
        if (used == 0 || used + n > SETTINGS_COLUMNS) {
            printf("%s  %-10s", used ? "\n" : "", used ? "" : "settings");
            used = 0;
        }
        used += (size_t)printf(" %s", word);
    }
    if (used)
        printf("\n");
    free(value);
}

/* The last check of the load cell before the test. */
static void print_check(struct facts *facts)
{
    struct wb_check_log_entry check;
    char text[WB_CHECK_LOG_LINE], *const line = meta(facts, "load_cell_check");
    if (wb_check_log_parse(line, &check)) {
        wb_check_log_describe(&check, text);
        printf("  %-10s %s\n", "cell check", text);
    }
    free(line);
}

static enum wb_status print_event(void *context, const struct wb_event *event)
{
    const struct facts *facts = context;
    double t = wb_survey_seconds(facts->survey.first_ns, event->t_ns);
    if (t < 0.0 && t > -5e-4)
        t = 0.0; /* not "-0.000" */
    printf("    %9.3f s  %-12s %s\n", t, event->kind, event->text);
    return WB_OK;
}

static void print_streams(const struct facts *facts)
{
    static const char *const samples[] = {"readings", "frames", "reports"};
    printf("  streams\n");
    for (int i = 0; i < facts->survey.n_streams; i++) {
        const struct wb_survey_stream *s = &facts->survey.streams[i];
        const struct wb_recording_stream *declared = wb_recording_stream_at(facts->recording, i);
        printf("    %-6s %-8s %" PRIu64 " chunks, %.1f kB", wb_role_name(s->role),
               declared->protocol, s->chunks, (double)s->bytes * 1e-3);
        if (facts->survey.decoded)
            printf(", %" PRIu64 " %s (%.1f/s)", s->samples, samples[s->role], s->rate);
        printf(", longest silence %.3f s, %s\n", wb_seconds_from_ns(s->longest_silence_ns),
               declared->address);
    }
}

static enum wb_status print_text(struct facts *facts, const char *path)
{
    const struct wb_survey *survey = &facts->survey;
    printf("%s: recording%s\n", path, survey->is_virtual ? " from a virtual rig" : "");
    print_meta(facts, "started", "start_utc");
    print_meta(facts, "ended", "ended");
    print_meta(facts, "host", "host");
    print_meta(facts, "recovered", WB_RECOVER_META_FROM);
    print_meta(facts, "operator", "operator");
    print_meta(facts, "notes", "notes");
    print_entry(&facts->entry);
    if (facts->has_specimen)
        printf("  %-10s wire %s, %g mm, sample %d, %d markers\n", "specimen", facts->specimen.wire,
               facts->specimen.length / WB_MM, facts->specimen.sample, facts->specimen.n_markers);
    if (facts->has_rig)
        printf("  %-10s %s%s\n", "rig", facts->rig.name,
               survey->is_virtual && !strstr(facts->rig.name, "virtual rig") ? " (virtual rig)"
                                                                             : "");
    print_check(facts);
    print_meta(facts, "cycles", "cycles");
    print_settings(facts);
    print_meta(facts, "tool", "tool_version");
    print_meta(facts, "revision", "tool_revision");
    printf("  %-10s %.3f s\n", "duration", wb_survey_duration(survey));
    printf("  %-10s %s\n", "sha256", facts->sha256);
    print_streams(facts);
    printf("  clock      %" PRIu64 " probes\n  events\n", survey->clock_rows);
    enum wb_status status = wb_recording_each_event(facts->recording, print_event, facts);
    char problem[256];
    for (int at = 0; wb_survey_problem(survey, &at, problem, sizeof problem);)
        printf("  problem    %s\n", problem);
    struct wb_text next = {0};
    wb_file_kind_append_next(&next, WB_FILE_RECORDING, path);
    printf("  %-10s %s\n", "next", wb_text_string(&next));
    wb_text_release(&next);
    return status == WB_ERR_DATA ? WB_OK : status;
}

/* --- as JSON --- */

static enum wb_status add_event(void *context, const struct wb_event *event)
{
    struct facts *facts = context;
    struct wb_json *item = wb_json_append_object(facts->events);
    wb_json_set_number(
        item, "t_s", wb_seconds_from_ns(event->t_ns) - wb_seconds_from_ns(facts->survey.first_ns));
    wb_json_set_integer(item, "t_ns", event->t_ns);
    wb_json_set_text(item, "kind", event->kind);
    wb_json_set_text(item, "text", event->text);
    return WB_OK;
}

static void add_meta(struct facts *facts, struct wb_json *root, const char *key)
{
    char *value = meta(facts, key);
    wb_json_set_text(root, key, value[0] ? value : NULL);
    free(value);
}

static void add_check(struct facts *facts, struct wb_json *root)
{
    struct wb_check_log_entry check;
    char *const line = meta(facts, "load_cell_check");
    if (wb_check_log_parse(line, &check)) {
        struct wb_json *const item = wb_json_set_object(root, "load_cell_check");
        wb_json_set_text(item, "utc", check.utc);
        wb_json_set_number(item, "known_mass_g", check.known / WB_G);
        wb_json_set_number(item, "read_mass_g", check.read / WB_G);
        wb_json_set_number(item, "deviation_mg", (check.read - check.known) / WB_MG);
        wb_json_set_number(item, "tolerance_percent", check.tolerance / WB_PERCENT);
        wb_json_set_boolean(item, "passed", check.passed);
        wb_json_set_text(item, "serial_number", check.serial_number);
    } else {
        wb_json_set_text(root, "load_cell_check", NULL);
    }
    free(line);
}

static void add_streams(const struct facts *facts, struct wb_json *root)
{
    struct wb_json *streams = wb_json_set_array(root, "streams");
    for (int i = 0; i < facts->survey.n_streams; i++) {
        const struct wb_survey_stream *s = &facts->survey.streams[i];
        const struct wb_recording_stream *declared = wb_recording_stream_at(facts->recording, i);
        struct wb_json *item = wb_json_append_object(streams);
        wb_json_set_integer(item, "id", s->id);
        wb_json_set_text(item, "role", wb_role_name(s->role));
        wb_json_set_text(item, "protocol", declared->protocol);
        wb_json_set_text(item, "address", declared->address);
        wb_json_set_integer(item, "chunks", (int64_t)s->chunks);
        wb_json_set_integer(item, "bytes", (int64_t)s->bytes);
        if (facts->survey.decoded) {
            wb_json_set_integer(item, "samples", (int64_t)s->samples);
            wb_json_set_number(item, "rate_Hz", s->rate);
        }
        wb_json_set_number(item, "longest_silence_s", wb_seconds_from_ns(s->longest_silence_ns));
    }
}

static enum wb_status print_json(struct facts *facts, const char *path)
{
    static const char *const keys[] = {"start_utc",
                                       "ended",
                                       "host",
                                       "operator",
                                       "notes",
                                       "cycles",
                                       "stage_settings",
                                       "tool_version",
                                       "tool_revision",
                                       "closed",
                                       WB_RECOVER_META_FROM,
                                       WB_RECOVER_META_SHA256,
                                       WB_RECOVER_META_TOOL,
                                       WB_RECOVER_META_MISSING};
    const struct wb_survey *survey = &facts->survey;
    struct wb_json *root = wb_json_create();
    wb_json_set_text(root, "recording", path);
    wb_json_set_text(root, "kind", wb_file_kind_key(WB_FILE_RECORDING));
    wb_json_set_boolean(root, "virtual_rig", survey->is_virtual);
    wb_json_set_text(root, "sha256", facts->sha256);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        add_meta(facts, root, keys[i]);
    wb_json_set_text(root, "rig", facts->has_rig ? facts->rig.name : NULL);
    if (facts->has_specimen) {
        struct wb_json *specimen = wb_json_set_object(root, "specimen");
        wb_json_set_text(specimen, "wire", facts->specimen.wire);
        wb_json_set_number(specimen, "length_mm", facts->specimen.length / WB_MM);
        wb_json_set_integer(specimen, "sample", facts->specimen.sample);
        wb_json_set_integer(specimen, "markers", facts->specimen.n_markers);
    }
    wb_json_set_text(root, "series", facts->entry.series[0] ? facts->entry.series : NULL);
    if (facts->entry.excluded.is_excluded)
        wb_index_exclusion_set_json(&facts->entry.excluded, root);
    add_check(facts, root);
    wb_json_set_number(root, "duration_s", wb_survey_duration(survey));
    add_streams(facts, root);
    wb_json_set_integer(root, "clock_probes", (int64_t)survey->clock_rows);
    facts->events = wb_json_set_array(root, "events");
    if (wb_recording_each_event(facts->recording, add_event, facts) == WB_ERR_MEMORY) {
        wb_json_destroy(root);
        return WB_ERR_MEMORY;
    }
    wb_json_set_boolean(root, "whole", wb_survey_is_whole(survey));
    wb_command_print_json(root);
    return WB_OK;
}

int wb_cmd_info(int argc, char **argv)
{
    struct wb_info_options options = {.common = {.noun = "file"}};
    char found[WB_PATH];
    for (size_t i = 0; i < WB_SCHEMA_DOCUMENTS; i++)
        wb_complete_value("schema", wb_schema_documents[i].name);
    wb_command_parse(&argp, argc, argv, &options);
    if (options.schema) {
        wb_command_print_json(wb_schema_build(options.schema));
        return WB_EXIT_OK;
    }
    const char *const path = options.common.input = wb_command_find(options.common.input, found);
    const enum wb_file_kind kind = wb_file_kind_find(path);
    if (kind == WB_FILE_BUNDLE || is_shipped_name(path, kind))
        return wb_info_bundle(&options);
    if (kind != WB_FILE_RECORDING)
        return wb_info_file(&options, kind);
    struct facts facts = {.recording = NULL};
    enum wb_status status = gather(&facts, path);
    if (status == WB_OK)
        status = options.common.json ? print_json(&facts, path) : print_text(&facts, path);
    if (wb_recording_close(facts.recording) != WB_OK || status != WB_OK)
        return WB_EXIT_FAILED;
    return wb_survey_is_whole(&facts.survey) ? WB_EXIT_OK : WB_EXIT_INCOMPLETE;
}
