#include "fe/model/model_file.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "model"

/* Above this a solid is nearly incompressible. */
static const double largest_poisson = 0.499;

enum wb_status wb_model_file_open(struct wb_model_file *file, const char *path)
{
    *file = (struct wb_model_file){.path = path};
    wb_file_folder(file->folder, path);
    WB_TRY(wb_config_read(&file->config, path, NULL));
    file->root = wb_config_root(file->config);
    return WB_OK;
}

void wb_model_file_close(struct wb_model_file *file)
{
    wb_config_destroy(file->config);
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
    return wb_file_find_named(path, kind, name, file->folder, named_in, NULL);
}

enum wb_status wb_model_file_wire(struct wb_model_file *file, const struct wb_config_node *map,
                                  const char *key, const char *name, struct wb_wire *wire)
{
    char path[WB_PATH];
    WB_TRY(wb_model_file_find(file, map, key, "wires", name, path));
    return wb_wire_read(path, wire, NULL);
}

enum wb_status wb_model_file_list(
    const struct wb_config_node *map, const char *key, const struct wb_config_node *list, int most,
    enum wb_status (*read)(void *into, const struct wb_config_node *item), void *into)
{
    const int n = wb_config_length(list);
    if (n < 1 || n > most)
        return wb_config_refuse(map, key, "expected a list of 1 to %d %s", most, key);
    for (int i = 0; i < n; i++)
        WB_TRY(read(into, wb_config_item(list, i)));
    return WB_OK;
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
