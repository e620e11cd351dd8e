#include "daq/test/series.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/number.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "series"

#define MOST_NUMBER 999999 /* of a recording */
#define DEFAULT_OUTPUT "{series}-{number:03}-{specimen}.wbr"

/* By enum wb_series_question. */
static const char *const questions[] = {"markers_mm", "marker_offset_mm", "notes", NULL};

/* --- the template of names --- */

/* Values of the placeholders; `sample` 0: any (a wildcard). */
struct fields {
    const struct wb_series *series;
    int number, sample;
};

/* Letters, digits and the characters without a special meaning in shells and patterns. */
static bool is_plain(const char *text)
{
    return text[strspn(
               text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.+")] == '\0';
}

static void put_specimen(struct wb_text *text, const struct fields *fields)
{
    const struct wb_specimen *const like = &fields->series->like;
    char wire[160];
    snprintf(wire, sizeof wire, "%s", wb_file_name(like->wire));
    char *const ending = strstr(wire, ".yaml");
    if (ending)
        *ending = '\0';
    for (char *c = wire; *c; c++)
        *c = isalnum((unsigned char)*c) || strchr("-_.+", *c) ? *c : '_';
    wb_text_append(text, "%s-L%g-%d", wire, like->length / WB_MM, fields->sample);
}

/* Appends the value of "{NAME}" or "{NAME:0N}"; false for an unknown placeholder. */
static bool put_field(struct wb_text *text, const char *field, const struct fields *fields)
{
    int width = 0, end = -1;
    if (strcmp(field, "number") == 0 ||
        (sscanf(field, "number:0%1d%n", &width, &end) == 1 && field[end] == '\0'))
        wb_text_append(text, "%0*d", width, fields->number);
    else if (strcmp(field, "series") == 0)
        wb_text_append(text, "%s", fields->series->name);
    else if (strcmp(field, "specimen") != 0 && strcmp(field, "sample") != 0)
        return false;
    else if (fields->sample == 0)
        wb_text_append(text, "*");
    else if (strcmp(field, "sample") == 0)
        wb_text_append(text, "%d", fields->sample);
    else
        put_specimen(text, fields);
    return true;
}

/* Expands the template; false, with the placeholder in `field`, if a placeholder is invalid. */
static bool expand(struct wb_text *text, const struct fields *fields, char field[32])
{
    for (const char *c = fields->series->output; *c;) {
        const size_t plain = strcspn(c, "{");
        wb_text_append_bytes(text, c, plain);
        c += plain;
        if (!*c)
            break;
        const size_t n = strcspn(c, "}");
        snprintf(field, 32, "%.*s", (int)(n - 1), c + 1);
        if (c[n] != '}' || !put_field(text, field, fields))
            return false;
        c += n + 1;
    }
    return true;
}

void wb_series_file(const struct wb_series *series, int number, int sample,
                    char file[WB_SERIES_FILE])
{
    const struct fields fields = {series, number, sample};
    struct wb_text text = {0};
    char field[32];
    (void)expand(&text, &fields, field);
    snprintf(file, WB_SERIES_FILE, "%s", wb_text_string(&text));
    wb_text_release(&text);
}

static enum wb_status check_output(const struct wb_config_node *root,
                                   const struct wb_series *series)
{
    const struct fields fields = {series, MOST_NUMBER, 100000};
    struct wb_text text = {0};
    char field[32] = "", name[WB_SERIES_FILE] = "";
    const bool is_known = expand(&text, &fields, field);
    const bool is_short = text.length < sizeof name - 8; /* .zst, -wal */
    if (is_known && is_short)
        snprintf(name, sizeof name, "%s", wb_text_string(&text));
    wb_text_release(&text);
    if (!is_known)
        return wb_config_refuse(root, "output",
                                "expected {series}, {number}, {number:03}, {sample} or "
                                "{specimen}, not '{%s}'",
                                field);
    if (!strstr(series->output, "{number"))
        return wb_config_refuse(root, "output",
                                "expected {number} in the name, because names must be unique");
    const size_t n = strlen(name);
    if (!is_short || n < 5 || strcmp(name + n - 4, ".wbr") != 0 || !is_plain(name))
        return wb_config_refuse(root, "output",
                                "expected a name of letters, digits, '-', '_', '.' and '+' that "
                                "ends in .wbr, shorter than %d characters and without a folder, "
                                "not '%s'",
                                WB_SERIES_FILE - 8, series->output);
    return WB_OK;
}

/* --- the file --- */

static enum wb_status read_questions(const struct wb_config_node *list, struct wb_series *series)
{
    const int n = list ? wb_config_length(list) : 0;
    if (n < 0)
        return wb_config_refuse(list, "ask",
                                "expected a list of markers_mm, marker_offset_mm and notes");
    for (int i = 0; i < n; i++) {
        int question = 0;
        const struct wb_config_key key = WB_CONFIG_CHOICE("ask", &question, questions);
        WB_TRY(wb_config_value(wb_config_item(list, i), &key));
        series->asks[question] = true;
    }
    return WB_OK;
}

static enum wb_status find_files(const struct wb_config_node *root, struct wb_series *series,
                                 const char *specimen, const char *rig)
{
    if (!specimen[0])
        return wb_config_refuse(root, "specimen", "expected a specimen file");
    WB_TRY(wb_file_join(series->specimen_path, series->folder, specimen));
    if (rig[0])
        WB_TRY(wb_file_join(series->rig, series->folder, rig));
    if (!wb_file_exists(series->specimen_path) &&
        wb_file_find_data(series->specimen_path, specimen) != WB_OK)
        return wb_config_refuse(root, "specimen", "'%s' does not exist", specimen);
    return wb_specimen_read(series->specimen_path, &series->like);
}

static enum wb_status read_root(const struct wb_config_node *root, struct wb_series *series,
                                struct wb_bend_test_request *request)
{
    char specimen[1024] = "", rig[1024] = "";
    const struct wb_config_node *ask;
    struct wb_config_key keys[16] = {
        WB_CONFIG_TEXT("series", series->name),
        WB_CONFIG_TEXT("specimen", specimen),
        WB_CONFIG_INTEGER("specimens", &series->n_specimens, 1, 10000),
        WB_CONFIG_OPTIONAL_INTEGER("first_sample", &series->first_sample, 1, 90000),
        WB_CONFIG_OPTIONAL_NODE("ask", &ask),
        WB_CONFIG_OPTIONAL_TEXT("rig", rig),
        WB_CONFIG_OPTIONAL_TEXT("output", series->output),
    };
    const size_t n = 7 + wb_setting_keys(&wb_bend_test_table, 0, request, keys + 7);
    WB_TRY(wb_config_map(root, keys, n));
    if (!series->name[0] || !is_plain(series->name))
        return wb_config_refuse(root, "series",
                                "expected a name of letters, digits, '-', '_', '.' and '+', not "
                                "'%s'",
                                series->name);
    WB_TRY(read_questions(ask, series));
    WB_TRY(find_files(root, series, specimen, rig));
    return check_output(root, series);
}

enum wb_status wb_series_read(struct wb_series *series, const char *path,
                              struct wb_bend_test_request *request)
{
    struct wb_config *config;
    memset(series, 0, sizeof *series);
    series->first_sample = 1;
    snprintf(series->output, sizeof series->output, "%s", DEFAULT_OUTPUT);
    wb_file_folder(series->folder, path);
    WB_TRY(wb_config_read(&config, path, NULL));
    const enum wb_status status = read_root(wb_config_root(config), series, request);
    wb_config_destroy(config);
    return status;
}

/* --- specimens --- */

static const char *answer_to(const char *const answers[], enum wb_series_question question)
{
    return answers && answers[question] && answers[question][0] ? answers[question] : NULL;
}

enum wb_status wb_series_specimen(const struct wb_series *series, int sample,
                                  const char *const answers[WB_SERIES_QUESTIONS],
                                  struct wb_text *text, struct wb_reason *why)
{
    const struct wb_specimen *const like = &series->like;
    const char *const markers = answer_to(answers, WB_SERIES_MARKERS);
    const char *const offset = answer_to(answers, WB_SERIES_OFFSET);
    struct wb_specimen specimen;
    wb_text_append(text,
                   "# Based on '%s', in series %s.\nwire: '%s'\nlength_mm: %.10g\nsample: %d\n",
                   wb_file_name(series->specimen_path), series->name, like->wire,
                   like->length / WB_MM, sample);
    if (like->length_uncertainty > 0.0)
        wb_text_append(text, "u_length_mm: %.10g\n", like->length_uncertainty / WB_MM);
    wb_text_append(text, "markers_mm: [%s", markers ? markers : "");
    for (int i = 0; !markers && i < like->n_markers; i++)
        wb_text_append(text, "%s%.10g", i > 0 ? ", " : "", like->markers[i] / WB_MM);
    wb_text_append(text, "]\n");
    if (offset)
        wb_text_append(text, "marker_offset_mm: %s\n", offset);
    else
        wb_text_append(text, "marker_offset_mm: %.10g\n", like->marker_offset / WB_MM);
    if (like->marker_offset_uncertainty > 0.0)
        wb_text_append(text, "marker_offset_uncertainty_mm: %.10g\n",
                       like->marker_offset_uncertainty / WB_MM);
    return wb_specimen_parse(wb_text_string(text), "specimen", &specimen, why);
}

/* --- progress of the series --- */

static bool is_of(const struct wb_series *series, const struct wb_index_entry *entry)
{
    return strcmp(entry->series, series->name) == 0;
}

/* Whether `name` is the recording of that number; without `whole` also a file that belongs to it,
 * such as one with .zst or -wal appended. */
static bool is_named(const struct wb_series *series, const char *name, int number, bool whole)
{
    const struct fields any = {series, number, 0};
    struct wb_text pattern = {0};
    char field[32];
    (void)expand(&pattern, &any, field);
    if (!whole)
        wb_text_append(&pattern, "*");
    const bool matches = fnmatch(wb_text_string(&pattern), name, 0) == 0;
    wb_text_release(&pattern);
    return matches;
}

/* The number in a file name that matches the template; 0: no match. Every part of every sequence of
 * digits is tried, because the template may have other digits next to the number. */
static int number_of(const struct wb_series *series, const char *name, bool whole)
{
    int largest = 0;
    for (const char *c = name; *c; c++) {
        int number = 0;
        for (const char *d = c; isdigit((unsigned char)*d) && number <= MOST_NUMBER / 10; d++) {
            number = 10 * number + (*d - '0');
            if (number > largest && is_named(series, name, number, whole))
                largest = number;
        }
    }
    return largest;
}

static enum wb_status open_folder(DIR **directory, const char *folder)
{
    *directory = opendir(folder);
    if (!*directory)
        return wb_fail(WB_ERR_IO, "the folder '%s' cannot be read: %s", folder, strerror(errno));
    return WB_OK;
}

enum wb_status wb_series_next_number(const struct wb_series *series, const char *folder,
                                     const struct wb_index *index, int *number)
{
    DIR *directory;
    const struct dirent *file;
    int largest = 0;
    WB_TRY(open_folder(&directory, folder));
    while ((file = readdir(directory))) {
        const int used = number_of(series, file->d_name, false);
        largest = used > largest ? used : largest;
    }
    closedir(directory);
    for (int i = 0; i < index->n; i++) {
        const struct wb_index_entry *const entry = &index->entries[i];
        const int listed = is_of(series, entry) ? entry->number : 0;
        const int used = number_of(series, wb_file_name(entry->file), false);
        largest = listed > largest ? listed : largest;
        largest = used > largest ? used : largest;
    }
    if (largest >= MOST_NUMBER)
        return wb_fail(WB_ERR_ARGUMENT, "'%s': no number is free after %d; choose another folder",
                       folder, largest);
    *number = largest + 1;
    return WB_OK;
}

int wb_series_next_sample(const struct wb_series *series, const struct wb_index *index, int *n_done)
{
    int next = 0;
    *n_done = 0;
    for (int k = 0; k < series->n_specimens; k++) {
        const int sample = series->first_sample + k;
        bool is_done = false;
        for (int i = 0; i < index->n; i++) {
            const struct wb_index_entry *const entry = &index->entries[i];
            is_done |=
                is_of(series, entry) && entry->sample == sample && !entry->excluded.is_repeated;
        }
        *n_done += is_done;
        if (!is_done && next == 0)
            next = sample;
    }
    return next;
}

enum wb_status wb_series_find_unlisted(const struct wb_series *series, const char *folder,
                                       const struct wb_index *index, int *number,
                                       char file[WB_SERIES_FILE])
{
    DIR *directory;
    const struct dirent *entry;
    const int from = *number;
    *number = 0;
    WB_TRY(open_folder(&directory, folder));
    while ((entry = readdir(directory))) {
        const int of = number_of(series, entry->d_name, true);
        if (of < from || of == 0 || (*number > 0 && of >= *number) ||
            strlen(entry->d_name) >= WB_SERIES_FILE || wb_index_find(index, entry->d_name))
            continue;
        *number = of;
        snprintf(file, WB_SERIES_FILE, "%s", entry->d_name);
    }
    closedir(directory);
    return WB_OK;
}
