/* What the files that read bundle models share. */
#ifndef WB_FE_MODEL_BUNDLE_MODEL_PRIVATE_H
#define WB_FE_MODEL_BUNDLE_MODEL_PRIVATE_H

#include "base/config.h"
#include "base/text.h"
#include "fe/model/bundle_model.h"

/* A model while it is read. */
struct wb_bundle_model_reader {
    struct wb_bundle_model *model;
    const struct wb_config_node *root;
    char folder[WB_PATH]; /* of the model's file */
    struct wb_text texts; /* of all files, for the checksum */
};

/* Names of enum wb_bundle_packing in files. */
extern const char *const wb_bundle_model_packings[];

/* The file that the value of `key` in `map` names, whose text is kept. */
WB_MUST_CHECK enum wb_status wb_bundle_model_find(struct wb_bundle_model_reader *reader,
                                                  const struct wb_config_node *map, const char *key,
                                                  const char *kind, const char *name,
                                                  char path[WB_PATH]);
/* The wire that is named there. */
WB_MUST_CHECK enum wb_status wb_bundle_model_find_wire(struct wb_bundle_model_reader *reader,
                                                       const struct wb_config_node *map,
                                                       const char *key, const char *name,
                                                       struct wb_wire *wire);

/* Values of a file's top level that the section is made of. */
struct wb_bundle_model_section {
    const struct wb_config_node *wires, *places, *search, *gaps, *taping;
    bool has_settled;
    char tape[64]; /* "": none */
};

/* Reads wires, packing and tape; name, arrangement, `settled` and length are there. */
WB_MUST_CHECK enum wb_status
wb_bundle_model_read_section(struct wb_bundle_model_reader *reader,
                             const struct wb_bundle_model_section *section);

#endif
