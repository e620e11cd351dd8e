#include "fe/model/model_file.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "model"

/* Beyond this a solid is as good as incompressible. */
static const double largest_poisson = 0.499;

/* Where a material's numbers are from, and how well they are known, changes nothing that is
 * computed: a dataset stays that of its model when somebody writes it down. */
static bool is_provenance(const char *line, size_t n)
{
    static const char *const keys[] = {"origin:", "intervals:", "uncertainty:"};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (n >= strlen(keys[i]) && memcmp(line, keys[i], strlen(keys[i])) == 0)
            return true;
    }
    return false;
}

/* Keeps all lines but those of the provenance and what is indented below them. */
static void append_what_computes(struct wb_text *texts, const char *bytes, size_t size)
{
    bool leaves_out = false;
    for (size_t at = 0; at < size;) {
        const char *const end = memchr(bytes + at, '\n', size - at);
        const size_t n = end ? (size_t)(end - bytes) + 1 - at : size - at;
        if (bytes[at] != ' ')
            leaves_out = is_provenance(bytes + at, n);
        if (!leaves_out)
            wb_text_append_bytes(texts, bytes + at, n);
        at += n;
    }
}

static enum wb_status keep_text(struct wb_model_file *file, const char *path)
{
    char *bytes;
    size_t size;
    WB_TRY(wb_file_read(path, &bytes, &size));
    append_what_computes(&file->texts, bytes, size);
    free(bytes);
    return WB_OK;
}

enum wb_status wb_model_file_open(struct wb_model_file *file, const char *path)
{
    *file = (struct wb_model_file){.path = path};
    wb_file_folder(file->folder, path);
    WB_TRY(wb_config_read(&file->config, path, NULL));
    file->root = wb_config_root(file->config);
    return keep_text(file, path);
}

void wb_model_file_close(struct wb_model_file *file)
{
    wb_config_destroy(file->config);
    wb_text_release(&file->texts);
}

enum wb_status wb_model_file_sum(struct wb_model_file *file, const char *meaning,
                                 char sha256[WB_SHA256_TEXT])
{
    wb_text_append(&file->texts, "%s", meaning);
    if (file->texts.failed)
        return wb_fail(WB_ERR_MEMORY, "out of memory reading '%s'", file->path);
    wb_hash_bytes(wb_text_string(&file->texts), file->texts.length, sha256);
    return WB_OK;
}

enum wb_status wb_model_file_check_name(const struct wb_config_node *map, const char *name)
{
    const char *c = name;
    while (isalnum((unsigned char)*c) || (*c && strchr("-_.+", *c)))
        c++;
    if (*name == '\0' || *c != '\0')
        return wb_config_refuse(map, "name", "expected letters, digits, '-', '_', '.', '+' only");
    return WB_OK;
}

enum wb_status wb_model_file_find(struct wb_model_file *file, const struct wb_config_node *map,
                                  const char *key, const char *kind, const char *name,
                                  char path[WB_PATH])
{
    char named_in[WB_PATH + 64];
    snprintf(named_in, sizeof named_in, "%s:%d: %s", wb_config_origin(map),
             wb_config_line(wb_config_find(map, key)), key);
    WB_TRY(wb_file_find_named(path, kind, name, file->folder, named_in, NULL));
    return keep_text(file, path);
}

enum wb_status wb_model_file_wire(struct wb_model_file *file, const struct wb_config_node *map,
                                  const char *key, const char *name, struct wb_wire *wire)
{
    char path[WB_PATH];
    WB_TRY(wb_model_file_find(file, map, key, "wires", name, path));
    return wb_wire_read(path, wire, NULL);
}

enum wb_status wb_model_file_check_wire(const struct wb_config_node *map, const char *key,
                                        const struct wb_wire *wire, const char *but)
{
    if (!wire->has_properties)
        return wb_config_refuse(map, key, "wire %s has no properties%s", wire->name, but);
    if (wire->material.poissons_ratio > largest_poisson)
        return wb_config_refuse(map, key, "wire %s has poissons_ratio %g, expected at most %g",
                                wire->name, wire->material.poissons_ratio, largest_poisson);
    return WB_OK;
}
