/* Keys: every key of the JSON and YAML files that the program writes, as rows of tables.
 *
 * A row has the key, its type and one sentence of meaning; the unit stands at the end of the key
 * (length_mm, flexural_rigidity_N_mm2). Where the value is a member of a struct, the row also has
 * its place, and WB_PUT() writes it; the other values are set by code. A table stands beside the
 * code that writes its object. analysis/schema/ makes JSON Schemas and the page docs/file-keys.md
 * of the tables. Settings and quantities have tables of their own (base/setting.h, quantity.h): a
 * row includes them, so that nothing is stated twice.
 *
 *     #define POINT(member) WB_AT(struct point, member)
 *     static const struct wb_key point_rows[] = {
 *         {"s_mm", POINT(s), "arc length of the place"},
 *         {"band", POINT(is_band), "the wire is bent too little there"},
 *         {"moment_N_mm", NUMBER | UNKNOWN, "moment"},
 *     };
 *     static WB_KEYS(point, "point", "A point of the curve.");
 *     ...
 *     WB_PUT(object, &point_keys, struct point, &points[i]);
 *
 * Whoever adds a key to a file adds its row; tests/check-files.py rejects files with keys that have
 * no row.
 */
#ifndef WB_ANALYSIS_KEYS_KEYS_H
#define WB_ANALYSIS_KEYS_KEYS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/json.h"
#include "base/setting.h"

struct wb_keys;

/* How a value is stored. */
enum wb_key_form {
    WB_KEY_NOWHERE, /* the row has no place */
    WB_KEY_DOUBLE,
    WB_KEY_INT, /* or an enumeration */
    WB_KEY_LONG,
    WB_KEY_BOOL,
    WB_KEY_POINTER, /* to a text */
    WB_KEY_INSIDE   /* an array of char or a struct, in place */
};

/* The place of a value, or of a list of values, in a struct. */
struct wb_key_place {
    const char *in; /* name of the struct */
    enum wb_key_form form;
    size_t offset;
    /* Of a list: */
    size_t step;     /* bytes from item to item */
    size_t count;    /* number of items; 0: that at `length` */
    size_t length;   /* offset of an int */
    bool is_pointer; /* the struct has a pointer to the items */
};

struct wb_key {
    const char *key;           /* NULL: the keys of `of`, `settings` or `quantities` stand here */
    unsigned type;             /* bits of row.h */
    const char *meaning;       /* without a full stop */
    const struct wb_keys *of;  /* of an object or of a list's objects */
    const char *choices;       /* the values of a text: "tip|follower"; NULL: any */
    struct wb_key_place place; /* of a text with choices: that of their index */
    const char *unit;          /* "mm"; "": none; NULL: the unit at the end of the key */
    const struct wb_setting_table *settings;
    unsigned applies; /* which of the settings: bits as of wb_setting_applies(); 0: all */
    bool quantities;  /* the quantities of a calibration, as the file's format has them */
};

struct wb_keys {
    const char *name;    /* unique among all tables */
    const char *meaning; /* a sentence */
    const struct wb_key *rows;
    size_t n;
    /* NULL-terminated: the object is one of these and has no rows of its own. */
    const struct wb_keys *const *alternatives;
};

/* Sets the members of `object` that `from`, a struct `in`, has: the next rows of the table with a
 * place in that struct. They begin behind the last key that the object has already, and end before
 * the first row without a place in it; so calls for several structs alternate with code that sets
 * other keys, and the object's keys have the order of the rows. Numbers are converted to the unit
 * of their row, in an object within another to that of the object where the row has none. */
#define WB_PUT(object, keys, in, from)                                                             \
    wb_keys_put(object, keys, #in, (const in *){from}) /* with a check of its type */
void wb_keys_put(struct wb_json *object, const struct wb_keys *keys, const char *in,
                 const void *from);

/* Unit of a row's value; "": none. */
const char *wb_keys_unit(const struct wb_key *row);

#endif
