/* Shared by the readers of models: the model's file, and the files of wires and materials that it
 * names. */
#ifndef WB_FE_MODEL_MODEL_FILE_H
#define WB_FE_MODEL_MODEL_FILE_H

#include "base/config.h"
#include "base/file.h"
#include "base/status.h"
#include "fe/model/wire.h"

struct wb_model_file {
    struct wb_config *config; /* owned */
    const struct wb_config_node *root;
    const char *path;     /* borrowed */
    char folder[WB_PATH]; /* of `path`: files are also searched there */
};

/* Reads the model's file; wb_model_file_close() also releases a file that could not be opened. */
WB_MUST_CHECK enum wb_status wb_model_file_open(struct wb_model_file *file, const char *path);
void wb_model_file_close(struct wb_model_file *file);

/* Rejects a `name` that file names, or tables without quotes, cannot contain. */
WB_MUST_CHECK enum wb_status wb_model_file_check_name(const struct wb_config_node *map,
                                                      const char *name);

/* The file of a kind ("wires", "materials") that the value `name` of `key` in `map` names. */
WB_MUST_CHECK enum wb_status wb_model_file_find(struct wb_model_file *file,
                                                const struct wb_config_node *map, const char *key,
                                                const char *kind, const char *name,
                                                char path[WB_PATH]);

/* The wire that the value `name` of `key` in `map` names. */
WB_MUST_CHECK enum wb_status wb_model_file_wire(struct wb_model_file *file,
                                                const struct wb_config_node *map, const char *key,
                                                const char *name, struct wb_wire *wire);

/* Reads the items of the list `key` of `map`, 1 to `most`; in messages its items have its name. */
WB_MUST_CHECK enum wb_status wb_model_file_list(
    const struct wb_config_node *map, const char *key, const struct wb_config_node *list, int most,
    enum wb_status (*read)(void *into, const struct wb_config_node *item), void *into);

/* Rejects a wire that has no properties (`but` ends the message) or is nearly incompressible. */
WB_MUST_CHECK enum wb_status wb_model_file_check_wire(const struct wb_config_node *map,
                                                      const char *key, const struct wb_wire *wire,
                                                      const char *but);

#endif
