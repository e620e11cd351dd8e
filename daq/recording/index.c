#include "daq/recording/index.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/memory.h"
#include "base/reads.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "index"

static enum wb_status check_sha256(const struct wb_config_node *node, char *hex)
{
    for (char *c = hex; *c; c++)
        *c = (char)tolower((unsigned char)*c);
    if (strlen(hex) != 64 || strspn(hex, "0123456789abcdef") != 64)
        return wb_config_refuse(node, "sha256", "expected 64 hexadecimal digits, not '%s'", hex);
    return WB_OK;
}

enum wb_status wb_index_exclusion_read(const struct wb_config_node *node, char recording[256],
                                       struct wb_index_exclusion *exclusion)
{
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("by", exclusion->by),
        WB_CONFIG_TEXT("reason", exclusion->reason),
        WB_CONFIG_OPTIONAL_TEXT("date_utc", exclusion->date_utc),
        WB_CONFIG_OPTIONAL_BOOLEAN("repeated", &exclusion->is_repeated),
        {.name = "recording", .type = WB_CONFIG_TYPE_TEXT, .target = recording, .size = 256},
    };
    if (!node)
        return WB_OK;
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys) - (recording == NULL)));
    if (!exclusion->by[0] || !exclusion->reason[0])
        return wb_config_refuse(node, exclusion->by[0] ? "reason" : "by",
                                "expected a text: an exclusion needs a person and a reason");
    exclusion->is_excluded = true;
    return WB_OK;
}

static enum wb_status read_entry(const struct wb_config_node *node, struct wb_index_entry *entry)
{
    char sha256[80];
    const struct wb_config_node *excluded;
    *entry = (struct wb_index_entry){.seed = -1};
    const struct wb_config_key keys[] = {
        WB_CONFIG_TEXT("file", entry->file),
        WB_CONFIG_TEXT("wire", entry->wire),
        WB_CONFIG_NUMBER("length_mm", &entry->length, WB_MM, 1.0, 1e4),
        WB_CONFIG_INTEGER("sample", &entry->sample, 0, 100000),
        WB_CONFIG_TEXT("sha256", sha256),
        WB_CONFIG_OPTIONAL_INTEGER("cycles", &entry->cycles, 1, 100000),
        WB_CONFIG_OPTIONAL_INTEGER("seed", &entry->seed, 0, 2147483647),
        WB_CONFIG_OPTIONAL_TEXT("date_utc", entry->date_utc),
        WB_CONFIG_OPTIONAL_BOOLEAN("virtual", &entry->is_virtual),
        WB_CONFIG_OPTIONAL_TEXT("corrected_specimen", entry->corrected_specimen),
        WB_CONFIG_OPTIONAL_TEXT("corrected_rig", entry->corrected_rig),
        WB_CONFIG_OPTIONAL_TEXT("series", entry->series),
        WB_CONFIG_OPTIONAL_INTEGER("number", &entry->number, 1, 1000000),
        WB_CONFIG_OPTIONAL_NODE("excluded", &excluded),
        WB_CONFIG_IGNORED("specimen"),
        WB_CONFIG_IGNORED("rig"),
        WB_CONFIG_IGNORED("size_bytes"),
        WB_CONFIG_IGNORED("tool_revision"),
        WB_CONFIG_IGNORED("notes"),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(check_sha256(node, sha256));
    memcpy(entry->sha256, sha256, sizeof entry->sha256);
    return wb_index_exclusion_read(excluded, NULL, &entry->excluded);
}

static enum wb_status read_entries(struct wb_index *index, const struct wb_config_node *list)
{
    const int n = wb_config_length(list);
    if (n < 0)
        return wb_config_refuse(list, NULL, "expected a list of recordings");
    index->entries = wb_memory_new((size_t)n, sizeof *index->entries);
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const node = wb_config_item(list, i);
        struct wb_index_entry entry;
        WB_TRY(read_entry(node, &entry));
        if (wb_index_find(index, entry.file))
            return wb_config_refuse(node, "file", "'%s' is listed twice in the index", entry.file);
        index->entries[index->n++] = entry;
    }
    return WB_OK;
}

enum wb_status wb_index_read(struct wb_index *index, const char *path, struct wb_reason *why)
{
    memset(index, 0, sizeof *index);
    struct wb_config *config;
    WB_TRY(wb_config_read(&config, path, why));
    wb_reads_leave_out(path); /* it grows with each test; only the chosen recordings are inputs */
    const struct wb_config_node *list = wb_config_root(config);
    enum wb_status status = WB_OK;
    if (wb_config_length(list) < 0) {
        const struct wb_config_key keys[] = {WB_CONFIG_NODE("recordings", &list)};
        status = wb_config_map(wb_config_root(config), keys, WB_COUNT(keys));
    }
    if (status == WB_OK)
        status = read_entries(index, list);
    wb_config_destroy(config);
    if (status == WB_OK)
        wb_file_folder(index->folder, path);
    else
        wb_index_release(index);
    return status;
}

void wb_index_release(struct wb_index *index)
{
    free(index->entries);
    memset(index, 0, sizeof *index);
}

/* Length of a file name without ".zst": a recording may be compressed after it was listed. */
static size_t name_length(const char *name)
{
    static const char ending[] = ".zst";
    const size_t n = strlen(name), m = sizeof ending - 1;
    return n > m && strcmp(name + n - m, ending) == 0 ? n - m : n;
}

const struct wb_index_entry *wb_index_find(const struct wb_index *index, const char *file)
{
    const char *const name = wb_file_name(file);
    const size_t n = name_length(name);
    for (int i = 0; i < index->n; i++) {
        const char *const listed = wb_file_name(index->entries[i].file);
        if (name_length(listed) == n && strncmp(listed, name, n) == 0)
            return &index->entries[i];
    }
    return NULL;
}

bool wb_index_look_up(struct wb_index_entry *entry, const char *recording_path, const char *sha256,
                      struct wb_reason *why)
{
    struct wb_index index;
    char folder[WB_PATH], path[WB_PATH];
    wb_file_folder(folder, recording_path);
    if (wb_file_join(path, folder, WB_INDEX_FILE) != WB_OK || !wb_file_exists(path) ||
        wb_index_read(&index, path, why) != WB_OK)
        return false;
    const struct wb_index_entry *const found = wb_index_find(&index, recording_path);
    const bool is_it = found && (!sha256 || strcmp(found->sha256, sha256) == 0);
    if (is_it)
        *entry = *found;
    else if (found)
        wb_reason_set(why, "%s lists '%s' with other contents (sha256 %.12s...)", path,
                      wb_file_name(recording_path), found->sha256);
    wb_index_release(&index);
    return is_it;
}

void wb_index_exclusion_describe(const struct wb_index_exclusion *exclusion,
                                 char text[WB_INDEX_EXCLUSION_TEXT])
{
    snprintf(text, WB_INDEX_EXCLUSION_TEXT, "by %s%s%.10s: %s", exclusion->by,
             exclusion->date_utc[0] ? " on " : "", exclusion->date_utc, exclusion->reason);
}

void wb_index_exclusion_set_json(const struct wb_index_exclusion *exclusion, struct wb_json *object)
{
    struct wb_json *const excluded = wb_json_set_object(object, "excluded");
    wb_json_set_text(excluded, "by", exclusion->by);
    wb_json_set_text(excluded, "reason", exclusion->reason);
    wb_json_set_text(excluded, "date_utc", exclusion->date_utc[0] ? exclusion->date_utc : NULL);
}

static void copy_text(const struct wb_json *object, const char *key, char *text, size_t size)
{
    const char *value = "";
    (void)wb_json_get_text(object, key, &value);
    snprintf(text, size, "%s", value);
}

bool wb_index_exclusion_get_json(struct wb_index_exclusion *exclusion, const struct wb_json *object)
{
    const struct wb_json *const excluded = wb_json_get(object, "excluded");
    *exclusion = (struct wb_index_exclusion){.is_excluded = excluded != NULL};
    if (!excluded)
        return false;
    copy_text(excluded, "by", exclusion->by, sizeof exclusion->by);
    copy_text(excluded, "reason", exclusion->reason, sizeof exclusion->reason);
    copy_text(excluded, "date_utc", exclusion->date_utc, sizeof exclusion->date_utc);
    return true;
}

/* --- writing --- */

/* Writes a text in single quotes, where the only escape of YAML is the doubled quote. */
static void put_text(struct wb_text *text, const char *key, const char *value)
{
    wb_text_append(text, "%s: '", key);
    for (const char *c = value; *c; c++) {
        wb_text_append_bytes(text, iscntrl((unsigned char)*c) ? " " : c, 1);
        if (*c == '\'')
            wb_text_append(text, "'");
    }
    wb_text_append(text, "'\n");
}

static void put_entry(struct wb_text *text, const struct wb_index_entry *entry)
{
    const struct wb_index_exclusion *const excluded = &entry->excluded;
    put_text(text, "- file", entry->file);
    put_text(text, "  wire", entry->wire);
    wb_text_append(text, "  length_mm: %.10g\n  sample: %d\n  sha256: %s\n", entry->length / WB_MM,
                   entry->sample, entry->sha256);
    if (entry->cycles > 0)
        wb_text_append(text, "  cycles: %d\n", entry->cycles);
    if (entry->date_utc[0])
        put_text(text, "  date_utc", entry->date_utc);
    if (entry->is_virtual)
        wb_text_append(text, "  virtual: true\n");
    if (entry->series[0])
        put_text(text, "  series", entry->series);
    if (entry->number > 0)
        wb_text_append(text, "  number: %d\n", entry->number);
    if (!excluded->is_excluded)
        return;
    wb_text_append(text, "  excluded:\n");
    put_text(text, "    by", excluded->by);
    put_text(text, "    reason", excluded->reason);
    put_text(text, "    date_utc", excluded->date_utc);
    if (excluded->is_repeated)
        wb_text_append(text, "    repeated: true\n");
}

/* Checks that the result is valid: an entry can only be appended to a block list that is not
 * indented. */
static enum wb_status check_appended(const struct wb_text *text, int n_expected, const char *path,
                                     const struct wb_index_entry *entry)
{
    struct wb_config *config;
    struct wb_reason why = {.text = ""};
    const enum wb_status status = wb_config_parse(&config, wb_text_string(text), path, &why);
    const struct wb_config_node *const root = status == WB_OK ? wb_config_root(config) : NULL;
    const int n = root ? wb_config_length(root) : -1;
    if (status == WB_OK)
        wb_config_destroy(config);
    if (n != n_expected)
        return wb_fail(WB_ERR_FORMAT,
                       "'%s': an entry for '%s' cannot be appended: expected a list of recordings, "
                       "each beginning with '- file: ...' without indentation%s%s",
                       path, entry->file, why.text[0] ? "; " : "", why.text);
    return WB_OK;
}

enum wb_status wb_index_append(const char *path, const struct wb_index_entry *entry)
{
    struct wb_text text = {0};
    int n_before = 0;
    if (wb_file_exists(path)) {
        struct wb_index index;
        char *before;
        size_t size;
        WB_TRY(wb_index_read(&index, path, NULL));
        n_before = index.n;
        const bool is_listed = wb_index_find(&index, entry->file);
        wb_index_release(&index);
        if (is_listed)
            return wb_fail(WB_ERR_EXISTS, "'%s' already lists '%s'", path, entry->file);
        WB_TRY(wb_file_read(path, &before, &size));
        wb_text_append_bytes(&text, before, size);
        wb_text_append(&text, "%s", size > 0 && before[size - 1] != '\n' ? "\n" : "");
        free(before);
    } else {
        wb_text_append(
            &text, "# Recordings of this folder. 'excluded' removes a recording from reports.\n");
    }
    put_entry(&text, entry);
    enum wb_status status = check_appended(&text, n_before + 1, path, entry);
    if (status == WB_OK)
        status = wb_file_write_text(path, &text);
    wb_text_release(&text);
    return status;
}
