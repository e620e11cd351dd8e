/* JSON values: built to be written, or read from a file. An interface to jansson, which only json.c
 * uses.
 *
 * Functions that build or format a document return no status. If memory runs out, or a member is
 * set in a value that is not an object (appended to one that is not an array), they end as
 * base/memory.h describes, with a message that says which. Numbers that are not finite become null.
 * Keys keep the order in which they were set.
 */
#ifndef WB_BASE_JSON_H
#define WB_BASE_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"
#include "base/status.h"

struct wb_json; /* a document, or a value in it */

/* A new document whose root is an object. */
struct wb_json *wb_json_create(void) __attribute__((returns_nonnull));
void wb_json_destroy(struct wb_json *root); /* accepts NULL */

/* Sets a member of an object. The text is copied; NULL becomes null. */
void wb_json_set_text(struct wb_json *object, const char *key, const char *text);
void wb_json_set_number(struct wb_json *object, const char *key, double value);
void wb_json_set_integer(struct wb_json *object, const char *key, int64_t value);
void wb_json_set_boolean(struct wb_json *object, const char *key, bool value);

/* Adds an empty object or array as a member; the returned handle belongs to the document and is
 * valid until the member is set again. */
struct wb_json *wb_json_set_object(struct wb_json *object, const char *key);
struct wb_json *wb_json_set_array(struct wb_json *object, const char *key);

/* Appends to an array. */
void wb_json_append_text(struct wb_json *array, const char *text);
void wb_json_append_number(struct wb_json *array, double value);
struct wb_json *wb_json_append_object(struct wb_json *array);

/* Sets a deep copy of `value`, from any document, as a member. */
void wb_json_set_copy(struct wb_json *object, const char *key, const struct wb_json *value);

/* Text of the document (caller frees), indented by two spaces, with a final newline; doubles are
 * read back exactly. */
char *wb_json_format(const struct wb_json *root) __attribute__((returns_nonnull));
/* The same in one line, with a final newline. */
char *wb_json_format_line(const struct wb_json *root) __attribute__((returns_nonnull));

/* Reads a document whose root is an object; messages name file and line. */
WB_MUST_CHECK enum wb_status wb_json_read(struct wb_json **root, const char *path);
/* As wb_json_read(). On failure `why` receives the reason; if it is NULL, the reason is logged. */
WB_MUST_CHECK enum wb_status wb_json_read_with_reason(struct wb_json **root, const char *path,
                                                      struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_json_parse(struct wb_json **root, const char *text,
                                           const char *origin);
WB_MUST_CHECK enum wb_status wb_json_parse_with_reason(struct wb_json **root, const char *text,
                                                       const char *origin, struct wb_reason *why);

/* Reading: each function returns false and leaves the target unchanged if the member is missing or
 * of another kind, or the object is NULL. Text is owned by the document. */
bool wb_json_get_text(const struct wb_json *object, const char *key, const char **text);
bool wb_json_get_number(const struct wb_json *object, const char *key, double *value);
bool wb_json_get_integer(const struct wb_json *object, const char *key, int64_t *value);
bool wb_json_get_boolean(const struct wb_json *object, const char *key, bool *value);
/* Member object or array; item of an array; NULL if missing. Length of an array, otherwise 0. */
struct wb_json *wb_json_get(const struct wb_json *object, const char *key);
size_t wb_json_length(const struct wb_json *array);
struct wb_json *wb_json_item(const struct wb_json *array, size_t index);
/* A value as number or text. */
bool wb_json_number(const struct wb_json *value, double *number);
bool wb_json_text(const struct wb_json *value, const char **text);

/* A place where two values differ, with both values as text for a message: `nothing` if a value is
 * missing, `a list of 3` for arrays. */
struct wb_json_place {
    char place[200]; /* "wires[0].rms" */
    char a[80], b[80];
};

struct wb_json_difference {
    size_t n;       /* number of differences; 0: the other members are empty */
    double largest; /* largest relative difference of numbers; INFINITY if other values differ */
    struct wb_json_place first, most;
};

/* Compares two values (NULL: missing) and finds the first and the largest difference. Texts,
 * booleans, keys and lengths must be equal, members may be in any order. Numbers may differ by
 * `tolerance` times the larger of the two, or in an array of numbers by `tolerance` times the
 * largest of both arrays. Members `ignored` (names up to a NULL; NULL: none) of the two values
 * themselves may differ. */
bool wb_json_differs(const struct wb_json *a, const struct wb_json *b, double tolerance,
                     const char *const *ignored, struct wb_json_difference *difference);

#endif
