/* What the readers of models share: the model's file, and the files of wires and materials that it
 * names.
 */
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
    char folder[WB_PATH]; /* of `path`: files are looked for there, too */
};

/* Reads the model's file; wb_model_file_close() releases also one that could not be opened. */
WB_MUST_CHECK enum wb_status wb_model_file_open(struct wb_model_file *file, const char *path);
void wb_model_file_close(struct wb_model_file *file);

/* Refuses a `name` that could not go into file names and into tables without quotes. */
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

/* Refuses a wire without properties (`but` ends the message) or as good as incompressible. */
WB_MUST_CHECK enum wb_status wb_model_file_check_wire(const struct wb_config_node *map,
                                                      const char *key, const struct wb_wire *wire,
                                                      const char *but);

#endif
