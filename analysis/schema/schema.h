/* Schema: every key of the JSON and YAML files that the program writes, as rows of tables.
 *
 * A row has the key, its type, its unit and one sentence of meaning. The tables are the files
 * NAME_keys.c of this folder; wb_schema_build() makes a JSON Schema of them, from which also the
 * page docs/file-keys.md is generated (docs/key-tables.py). Settings and quantities have
 * tables of their own (base/setting.h, quantity.h): a row includes them, so that nothing is stated
 * twice.
 *
 *     static const struct wb_schema_row tool_rows[] = {
 *         {"name", TEXT, "", "name of the program"},
 *         {"confirmed_by_revision", TEXT | OPTIONAL, "", "later revision with the same results"},
 *     };
 *     const struct wb_schema_object wb_schema_tool = {"tool", "The program.", ROWS(tool_rows)};
 *
 * Whoever adds a key to a file adds its row here; tests/check-files.py rejects files with keys that
 * have no row.
 */
#ifndef WB_ANALYSIS_SCHEMA_SCHEMA_H
#define WB_ANALYSIS_SCHEMA_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>

#include "base/json.h"
#include "base/setting.h"

struct wb_schema_object;

struct wb_schema_row {
    const char *key;     /* NULL: the keys of `of`, `settings` or `quantities` stand here */
    unsigned type;       /* bits of row.h */
    const char *unit;    /* "mm"; "": none */
    const char *meaning; /* without a full stop */
    const struct wb_schema_object *of; /* of an object or of a list's objects */
    const char *choices;               /* the values of a text: "tip|follower"; NULL: any */
    const struct wb_setting_table *settings;
    unsigned applies; /* which of the settings: bits as of wb_setting_applies(); 0: all */
    bool quantities;  /* the quantities of a calibration, as the file's format has them */
};

struct wb_schema_object {
    const char *name;    /* unique among all tables */
    const char *meaning; /* a sentence */
    const struct wb_schema_row *rows;
    size_t n;
    /* NULL-terminated: the object is one of these and has no rows of its own. */
    const struct wb_schema_object *const *alternatives;
};

/* A kind of file. */
struct wb_schema_document {
    const char *name; /* of the command line: "dataset" */
    const char *title;
    const struct wb_schema_object *root;
};

enum {
    WB_SCHEMA_DOCUMENTS = 4
};
extern const struct wb_schema_document wb_schema_documents[WB_SCHEMA_DOCUMENTS];

/* The document of a name; NULL: there is none. */
const struct wb_schema_document *wb_schema_find(const char *name);

/* Its JSON Schema (draft 2020-12), which rejects keys without a row; the caller destroys it. The
 * keyword `unit` gives units. */
struct wb_json *wb_schema_build(const struct wb_schema_document *document);

#endif
