#include "daq/index.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
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

static enum wb_status read_entry(const struct wb_config_node *node, struct wb_index_entry *entry)
{
    char sha256[80];
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
        WB_CONFIG_IGNORED("specimen"),
        WB_CONFIG_IGNORED("rig"),
        WB_CONFIG_IGNORED("size_bytes"),
        WB_CONFIG_IGNORED("tool_revision"),
        WB_CONFIG_IGNORED("notes"),
    };
    WB_TRY(wb_config_map(node, keys, WB_COUNT(keys)));
    WB_TRY(check_sha256(node, sha256));
    memcpy(entry->sha256, sha256, sizeof entry->sha256);
    return WB_OK;
}

static enum wb_status read_entries(struct wb_index *index, const struct wb_config_node *list)
{
    const int n = wb_config_length(list);
    if (n < 0)
        return wb_config_refuse(list, NULL, "expected a list of recordings");
    index->entries = calloc((size_t)n + 1, sizeof *index->entries);
    if (!index->entries)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading the index of recordings");
    for (int i = 0; i < n; i++) {
        const struct wb_config_node *const node = wb_config_item(list, i);
        struct wb_index_entry entry;
        WB_TRY(read_entry(node, &entry));
        if (wb_index_find(index, entry.file))
            return wb_config_refuse(node, "file", "'%s' stands twice in the index", entry.file);
        index->entries[index->n++] = entry;
    }
    return WB_OK;
}

enum wb_status wb_index_read(struct wb_index *index, const char *path)
{
    memset(index, 0, sizeof *index);
    struct wb_config *config;
    WB_TRY(wb_config_read(&config, path, NULL));
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

const struct wb_index_entry *wb_index_find(const struct wb_index *index, const char *file)
{
    for (int i = 0; i < index->n; i++) {
        if (strcmp(index->entries[i].file, file) == 0 ||
            strcmp(wb_file_name(index->entries[i].file), wb_file_name(file)) == 0)
            return &index->entries[i];
    }
    return NULL;
}
