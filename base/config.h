/* YAML settings with types: every key has a type, a unit in its name, a range and a default, and
 * every error names file, line and key.
 *
 *     struct wb_config *config;
 *     WB_TRY(wb_config_read(&config, "rig.yaml", NULL));
 *     const struct wb_config_key keys[] = {
 *         WB_CONFIG_NUMBER("length_mm", &length, WB_MM, 1.0, 1e4),
 *         WB_CONFIG_OPTIONAL_TEXT("notes", notes, ""),
 *     };
 *     status = wb_config_map(wb_config_root(config), keys, WB_COUNT(keys));
 *     wb_config_destroy(config);
 *
 * wb_config_map() rejects unknown, duplicate and missing keys, wrong types and values out of range.
 * Numbers are strict decimals: `85 mm`, `nan` and `0x10` are rejected.
 *
 * A file may state its layout by the top-level key `schema: 1`, which is the default. A file of a
 * later layout than WB_CONFIG_SCHEMA is rejected when it is parsed.
 */
#ifndef WB_BASE_CONFIG_H
#define WB_BASE_CONFIG_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"

#define WB_COUNT(array) (sizeof(array) / sizeof((array)[0]))

enum {
    WB_CONFIG_SCHEMA = 1 /* of all YAML files together, see docs/versions.md */
};

struct wb_config;      /* one document, owned by the caller */
struct wb_config_node; /* a map, sequence or scalar in it; owned by the document */

/* Reads a file, or parses a text for which `origin` stands in messages. `why` receives the message
 * of a failure, now or while nodes are read, and must live as long as the document; NULL: messages
 * are logged. */
WB_MUST_CHECK enum wb_status wb_config_read(struct wb_config **out, const char *path,
                                            struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_config_parse(struct wb_config **out, const char *text,
                                             const char *origin, struct wb_reason *why);

/* Reads a file, or `text` where that is not NULL, and hands its top node to `read`, which fills
 * `into`: the document lives as long as that call. */
WB_MUST_CHECK enum wb_status
wb_config_load(const char *text, const char *origin, struct wb_reason *why,
               enum wb_status (*read)(const struct wb_config_node *, void *into), void *into);

/* Reads a file as a text for wb_config_parse(); the caller frees it. */
WB_MUST_CHECK enum wb_status wb_config_read_text(char **out, const char *path,
                                                 struct wb_reason *why);
void wb_config_destroy(struct wb_config *config); /* accepts NULL */

/* The top node; the file name of a node's document; and a node's line, from 1. */
const struct wb_config_node *wb_config_root(const struct wb_config *config);
const char *wb_config_origin(const struct wb_config_node *node);
int wb_config_line(const struct wb_config_node *node);

enum wb_config_type {
    WB_CONFIG_TYPE_NUMBER,  /* double *, times `factor` to SI; range is in the file's unit */
    WB_CONFIG_TYPE_INTEGER, /* int * */
    WB_CONFIG_TYPE_BOOLEAN, /* bool *: true or false */
    WB_CONFIG_TYPE_TEXT,    /* char[size] */
    WB_CONFIG_TYPE_CHOICE,  /* int *: index into `choices`, a NULL-terminated list */
    WB_CONFIG_TYPE_NODE,    /* const struct wb_config_node **: any value, for nested reading */
    WB_CONFIG_TYPE_IGNORED  /* any value, not read */
};

struct wb_config_key {
    const char *name;
    enum wb_config_type type;
    bool optional; /* when absent the target is left as it was */
    void *target;
    size_t size;             /* of a text target */
    double factor;           /* file unit to SI */
    double minimum, maximum; /* of a number, in the file's unit; of an integer */
    const char *const *choices;
};

#define WB_CONFIG_NUMBER(key, pointer, unit_factor, low, high)                                     \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_NUMBER, .target = (pointer), .factor = (unit_factor),  \
        .minimum = (low), .maximum = (high)                                                        \
    }
#define WB_CONFIG_OPTIONAL_NUMBER(key, pointer, unit_factor, low, high)                            \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_NUMBER, .optional = true, .target = (pointer),         \
        .factor = (unit_factor), .minimum = (low), .maximum = (high)                               \
    }
#define WB_CONFIG_INTEGER(key, pointer, low, high)                                                 \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_INTEGER, .target = (pointer), .minimum = (low),        \
        .maximum = (high)                                                                          \
    }
#define WB_CONFIG_OPTIONAL_INTEGER(key, pointer, low, high)                                        \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_INTEGER, .optional = true, .target = (pointer),        \
        .minimum = (low), .maximum = (high)                                                        \
    }
#define WB_CONFIG_OPTIONAL_BOOLEAN(key, pointer)                                                   \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_BOOLEAN, .optional = true, .target = (pointer)         \
    }
/* `array` must be a char array, not a pointer. */
#define WB_CONFIG_TEXT(key, array)                                                                 \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_TEXT, .target = (array), .size = sizeof(array)         \
    }
#define WB_CONFIG_OPTIONAL_TEXT(key, array)                                                        \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_TEXT, .optional = true, .target = (array),             \
        .size = sizeof(array)                                                                      \
    }
#define WB_CONFIG_CHOICE(key, pointer, list)                                                       \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_CHOICE, .target = (pointer), .choices = (list)         \
    }
#define WB_CONFIG_OPTIONAL_CHOICE(key, pointer, list)                                              \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_CHOICE, .optional = true, .target = (pointer),         \
        .choices = (list)                                                                          \
    }
#define WB_CONFIG_NODE(key, pointer)                                                               \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_NODE, .target = (void *)(pointer)                      \
    }
/* The pointer is set to NULL when the key is absent. */
#define WB_CONFIG_OPTIONAL_NODE(key, pointer)                                                      \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_NODE, .optional = true, .target = (void *)(pointer)    \
    }
#define WB_CONFIG_IGNORED(key)                                                                     \
    {                                                                                              \
        .name = key, .type = WB_CONFIG_TYPE_IGNORED, .optional = true                              \
    }

/* Reads a map by its table of keys. */
WB_MUST_CHECK enum wb_status wb_config_map(const struct wb_config_node *map,
                                           const struct wb_config_key *keys, size_t n_keys);

/* Reads one value by its key, whose name is for messages. */
WB_MUST_CHECK enum wb_status wb_config_value(const struct wb_config_node *node,
                                             const struct wb_config_key *key);

/* Sequences: length (-1 when the node is not one), and items. */
int wb_config_length(const struct wb_config_node *sequence);
const struct wb_config_node *wb_config_item(const struct wb_config_node *sequence, int index);

/* Reads a sequence of numbers, each times `factor` and within the range of the file's unit, into
 * `values`; *n receives how many, at least `least` and at most `most`. `name` is for messages. */
WB_MUST_CHECK enum wb_status wb_config_numbers(const struct wb_config_node *sequence,
                                               const struct wb_config_key *key, int least, int most,
                                               double *values, int *n);

/* A scalar as text (owned by the document); NULL when the node is not a scalar. */
const char *wb_config_scalar(const struct wb_config_node *node);

/* Entries of a map that is read without a table: their number (-1 if the node is not a map), and
 * name and value at an index. */
int wb_config_entries(const struct wb_config_node *map);
const struct wb_config_node *wb_config_entry(const struct wb_config_node *map, int index,
                                             const char **name);

/* The value of the first entry `key` of a map; NULL if the map has no such key, or the node is not
 * a map. */
const struct wb_config_node *wb_config_find(const struct wb_config_node *map, const char *key);

/* Fails with "FILE:LINE: KEY: message" and WB_ERR_FORMAT; `key` may be NULL. The line is
 * that of the key where `node` is the map that holds it, else the node's. For checks that a table
 * cannot express. */
WB_MUST_CHECK enum wb_status wb_config_refuse(const struct wb_config_node *node, const char *key,
                                              const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Rejects the first of the keys (NULL-terminated) that a map has, with the message. */
WB_MUST_CHECK enum wb_status wb_config_refuse_keys(const struct wb_config_node *map,
                                                   const char *const *keys, const char *message);

/* Rejects a text that is not a date as YYYY-MM-DD; "" is accepted. */
WB_MUST_CHECK enum wb_status wb_config_check_date(const struct wb_config_node *map, const char *key,
                                                  const char *date);

#endif
