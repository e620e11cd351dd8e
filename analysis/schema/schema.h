/* Schema: JSON Schemas of the files that the program writes, from the tables of their keys
 * (analysis/keys/keys.h). The page docs/file-keys.md is generated from them (docs/key-tables.py).
 */
#ifndef WB_ANALYSIS_SCHEMA_SCHEMA_H
#define WB_ANALYSIS_SCHEMA_SCHEMA_H

#include "analysis/keys/keys.h"

/* A kind of file. */
struct wb_schema_document {
    const char *name; /* of the command line: "dataset" */
    const char *title;
    const struct wb_keys *root;
};

enum {
    WB_SCHEMA_DOCUMENTS = 6
};
extern const struct wb_schema_document wb_schema_documents[WB_SCHEMA_DOCUMENTS];

/* The document of a name; NULL: there is none. */
const struct wb_schema_document *wb_schema_find(const char *name);

/* Its JSON Schema (draft 2020-12), which rejects keys without a row; the caller destroys it. The
 * keyword `unit` gives units. */
struct wb_json *wb_schema_build(const struct wb_schema_document *document);

#endif
