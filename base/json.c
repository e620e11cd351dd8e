#include "base/json.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/number.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "json"

enum kind {
    KIND_NULL,
    KIND_BOOLEAN,
    KIND_INTEGER,
    KIND_NUMBER,
    KIND_TEXT,
    KIND_ARRAY,
    KIND_OBJECT
};

/* A value of a document. jansson parses text and quotes it; the values are our own, because each
 * must know its document: a failure is remembered there, in the root, which needs no memory. */
struct wb_json {
    enum kind kind;
    bool failed; /* of the root: a value of the document is lost */
    struct wb_json *root;
    char *key; /* of a member of an object; owned */
    union {
        bool boolean;
        int64_t integer;
        double number;
        char *text;                  /* owned */
        struct {                     /* of an array or object */
            struct wb_json **values; /* (n) in the order in which they were set; owned */
            size_t n, capacity;
        } list;
    } as;
};

static bool is_list(const struct wb_json *value)
{
    return value && (value->kind == KIND_ARRAY || value->kind == KIND_OBJECT);
}

struct wb_json *wb_json_create(void)
{
    struct wb_json *const root = calloc(1, sizeof *root);
    if (root) {
        root->kind = KIND_OBJECT;
        root->root = root;
    }
    return root;
}

/* Leaves a null without what was in it. */
static void clear(struct wb_json *value)
{
    if (is_list(value)) {
        for (size_t i = 0; i < value->as.list.n; i++)
            wb_json_destroy(value->as.list.values[i]);
        free(value->as.list.values);
    } else if (value->kind == KIND_TEXT) {
        free(value->as.text);
    }
    memset(&value->as, 0, sizeof value->as);
    value->kind = KIND_NULL;
}

void wb_json_destroy(struct wb_json *root)
{
    if (!root)
        return;
    clear(root);
    free(root->key);
    free(root);
}

static bool reserve_one(struct wb_json *list)
{
    if (list->as.list.n < list->as.list.capacity)
        return true;
    const size_t capacity = list->as.list.capacity > 0 ? 2 * list->as.list.capacity : 8;
    struct wb_json **const values =
        realloc(list->as.list.values, capacity * sizeof *list->as.list.values);
    if (!values)
        return false;
    list->as.list.values = values;
    list->as.list.capacity = capacity;
    return true;
}

/* Appends a null to an array, or to an object, which has no member of that key yet. NULL when that
 * fails, and then the document remembers it; a list that is NULL is one that could not be made,
 * which its document remembers already. */
static struct wb_json *append(struct wb_json *list, const char *key)
{
    if (!list)
        return NULL;
    struct wb_json *const value = calloc(1, sizeof *value);
    if (!value || list->kind != (key ? KIND_OBJECT : KIND_ARRAY) || !reserve_one(list) ||
        (key && !(value->key = strdup(key)))) {
        wb_json_destroy(value);
        list->root->failed = true;
        return NULL;
    }
    value->root = list->root;
    list->as.list.values[list->as.list.n++] = value;
    return value;
}

/* The member of that key as a null: the one there is, in its place, or a new one at the end. */
static struct wb_json *set(struct wb_json *object, const char *key)
{
    struct wb_json *const found = wb_json_get(object, key);
    if (!found)
        return append(object, key);
    clear(found);
    return found;
}

static void put_number(struct wb_json *value, double number)
{
    if (!value || !isfinite(number))
        return;
    value->kind = KIND_NUMBER;
    value->as.number = number;
}

static void put_integer(struct wb_json *value, int64_t integer)
{
    if (!value)
        return;
    value->kind = KIND_INTEGER;
    value->as.integer = integer;
}

static void put_boolean(struct wb_json *value, bool boolean)
{
    if (!value)
        return;
    value->kind = KIND_BOOLEAN;
    value->as.boolean = boolean;
}

/* RFC 3629: as few bytes as a character needs, no surrogates, none beyond U+10FFFF. */
static bool is_utf8(const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c;) {
        const unsigned first = *c++;
        const int more = first < 0x80 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
        unsigned code = more == 0 ? first : first & (0x3fu >> more);
        if (first >= 0xf5 || (first >= 0x80 && first < 0xc2))
            return false;
        for (int i = 0; i < more; i++) {
            if ((*c & 0xc0) != 0x80)
                return false;
            code = code << 6 | (*c++ & 0x3fu);
        }
        if ((more == 2 && code < 0x800) || (more == 3 && code < 0x10000) || code > 0x10ffff ||
            (code >= 0xd800 && code <= 0xdfff))
            return false;
    }
    return true;
}

static void put_text(struct wb_json *value, const char *text)
{
    if (!value || !text)
        return;
    char *const copy = strdup(text);
    if (!copy) {
        value->root->failed = true;
        return;
    }
    /* Not UTF-8 (bytes from a device, say): keep what is ASCII. */
    if (!is_utf8(copy)) {
        for (char *c = copy; *c; c++) {
            if ((unsigned char)*c >= 0x80)
                *c = '?';
        }
    }
    value->kind = KIND_TEXT;
    value->as.text = copy;
}

static struct wb_json *put_list(struct wb_json *value, enum kind kind)
{
    if (value)
        value->kind = kind;
    return value;
}

static void put_copy(struct wb_json *value, const struct wb_json *of)
{
    if (!value || !of)
        return;
    if (of->kind == KIND_TEXT) {
        put_text(value, of->as.text);
        return;
    }
    value->kind = of->kind;
    if (!is_list(of)) {
        value->as = of->as;
        return;
    }
    for (size_t i = 0; i < of->as.list.n; i++)
        put_copy(append(value, of->as.list.values[i]->key), of->as.list.values[i]);
}

void wb_json_set_text(struct wb_json *object, const char *key, const char *text)
{
    put_text(set(object, key), text);
}

void wb_json_set_number(struct wb_json *object, const char *key, double value)
{
    put_number(set(object, key), value);
}

void wb_json_set_integer(struct wb_json *object, const char *key, int64_t value)
{
    put_integer(set(object, key), value);
}

void wb_json_set_boolean(struct wb_json *object, const char *key, bool value)
{
    put_boolean(set(object, key), value);
}

struct wb_json *wb_json_set_object(struct wb_json *object, const char *key)
{
    return put_list(set(object, key), KIND_OBJECT);
}

struct wb_json *wb_json_set_array(struct wb_json *object, const char *key)
{
    return put_list(set(object, key), KIND_ARRAY);
}

void wb_json_append_text(struct wb_json *array, const char *text)
{
    put_text(append(array, NULL), text);
}

void wb_json_append_number(struct wb_json *array, double value)
{
    put_number(append(array, NULL), value);
}

struct wb_json *wb_json_append_object(struct wb_json *array)
{
    return put_list(append(array, NULL), KIND_OBJECT);
}

/* Copied before it is set: `value` may be the member that is replaced, or have `object` in it. */
void wb_json_set_copy(struct wb_json *object, const char *key, const struct wb_json *value)
{
    if (!object)
        return;
    struct wb_json copy = {.root = object->root};
    put_copy(&copy, value);
    struct wb_json *const place = set(object, key);
    if (place) {
        place->kind = copy.kind;
        place->as = copy.as;
    } else {
        clear(&copy);
    }
}

/* jansson prints 0.1 with 17 digits as 0.10000000000000001; people read these files, so numbers and
 * lists are laid out here, and only text is quoted by jansson. */
static void format_text(struct wb_text *text, const char *raw)
{
    json_t *const string = json_string(raw);
    char *const quoted = string ? json_dumps(string, JSON_ENCODE_ANY) : NULL;
    if (quoted)
        wb_text_append(text, "%s", quoted);
    else
        text->failed = true;
    free(quoted);
    json_decref(string);
}

static void format_value(struct wb_text *text, const struct wb_json *value, int depth);

static void format_list(struct wb_text *text, const struct wb_json *list, int depth)
{
    const bool is_object = list->kind == KIND_OBJECT;
    wb_text_append(text, is_object ? "{" : "[");
    for (size_t i = 0; i < list->as.list.n; i++) {
        const struct wb_json *const value = list->as.list.values[i];
        wb_text_append(text, "%s\n%*s", i == 0 ? "" : ",", 2 * (depth + 1), "");
        if (is_object) {
            format_text(text, value->key);
            wb_text_append(text, ": ");
        }
        format_value(text, value, depth + 1);
    }
    if (list->as.list.n > 0)
        wb_text_append(text, "\n%*s", 2 * depth, "");
    wb_text_append(text, is_object ? "}" : "]");
}

static void format_value(struct wb_text *text, const struct wb_json *value, int depth)
{
    char number_text[WB_NUMBER_TEXT];
    switch (value->kind) {
    case KIND_NULL:
        wb_text_append(text, "null");
        break;
    case KIND_BOOLEAN:
        wb_text_append(text, value->as.boolean ? "true" : "false");
        break;
    case KIND_INTEGER:
        wb_text_append(text, "%" PRId64, value->as.integer);
        break;
    case KIND_NUMBER:
        wb_text_append(text, "%s", wb_number_format(value->as.number, number_text));
        break;
    case KIND_TEXT:
        format_text(text, value->as.text);
        break;
    case KIND_ARRAY:
    case KIND_OBJECT:
        format_list(text, value, depth);
        break;
    }
}

enum wb_status wb_json_format(const struct wb_json *root, char **text)
{
    struct wb_text formatted = {0};
    if (root && !root->root->failed) {
        format_value(&formatted, root, 0);
        wb_text_append(&formatted, "\n");
    }
    if (formatted.length == 0 || formatted.failed) {
        wb_text_release(&formatted);
        return wb_fail(WB_ERR_MEMORY, "out of memory writing JSON");
    }
    *text = formatted.bytes;
    return WB_OK;
}

static void put_parsed(struct wb_json *value, json_t *parsed)
{
    const char *key;
    json_t *child;
    size_t i;
    if (!value)
        return;
    switch (json_typeof(parsed)) {
    case JSON_NULL:
        break;
    case JSON_TRUE:
    case JSON_FALSE:
        put_boolean(value, json_is_true(parsed));
        break;
    case JSON_INTEGER:
        put_integer(value, json_integer_value(parsed));
        break;
    case JSON_REAL:
        put_number(value, json_real_value(parsed));
        break;
    case JSON_STRING:
        put_text(value, json_string_value(parsed));
        break;
    case JSON_ARRAY:
        value->kind = KIND_ARRAY;
        json_array_foreach(parsed, i, child)
        {
            put_parsed(append(value, NULL), child);
        }
        break;
    case JSON_OBJECT:
        value->kind = KIND_OBJECT;
        json_object_foreach(parsed, key, child)
        {
            put_parsed(append(value, key), child);
        }
        break;
    }
}

enum wb_status wb_json_parse_with_reason(struct wb_json **root, const char *text,
                                         const char *origin, struct wb_reason *why)
{
    *root = NULL;
    json_error_t error;
    json_t *const parsed = json_loads(text, JSON_REJECT_DUPLICATES, &error);
    if (!parsed)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s:%d: %s", origin, error.line, error.text);
    if (!json_is_object(parsed)) {
        json_decref(parsed);
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: expected a JSON object", origin);
    }
    struct wb_json *const made = wb_json_create();
    put_parsed(made, parsed);
    json_decref(parsed);
    if (!made || made->failed) {
        wb_json_destroy(made);
        return wb_fail_to(why, WB_ERR_MEMORY, "%s: out of memory", origin);
    }
    *root = made;
    return WB_OK;
}

enum wb_status wb_json_parse(struct wb_json **root, const char *text, const char *origin)
{
    return wb_json_parse_with_reason(root, text, origin, NULL);
}

enum wb_status wb_json_read_with_reason(struct wb_json **root, const char *path,
                                        struct wb_reason *why)
{
    *root = NULL;
    char *text;
    WB_TRY(wb_file_read_with_reason(path, &text, NULL, why));
    const enum wb_status status = wb_json_parse_with_reason(root, text, path, why);
    free(text);
    return status;
}

enum wb_status wb_json_read(struct wb_json **root, const char *path)
{
    return wb_json_read_with_reason(root, path, NULL);
}

struct wb_json *wb_json_get(const struct wb_json *object, const char *key)
{
    if (!object || object->kind != KIND_OBJECT)
        return NULL;
    for (size_t i = 0; i < object->as.list.n; i++) {
        if (strcmp(object->as.list.values[i]->key, key) == 0)
            return object->as.list.values[i];
    }
    return NULL;
}

bool wb_json_get_text(const struct wb_json *object, const char *key, const char **text)
{
    return wb_json_text(wb_json_get(object, key), text);
}

bool wb_json_get_number(const struct wb_json *object, const char *key, double *value)
{
    return wb_json_number(wb_json_get(object, key), value);
}

bool wb_json_get_integer(const struct wb_json *object, const char *key, int64_t *value)
{
    const struct wb_json *const found = wb_json_get(object, key);
    if (!found || found->kind != KIND_INTEGER)
        return false;
    *value = found->as.integer;
    return true;
}

bool wb_json_get_boolean(const struct wb_json *object, const char *key, bool *value)
{
    const struct wb_json *const found = wb_json_get(object, key);
    if (!found || found->kind != KIND_BOOLEAN)
        return false;
    *value = found->as.boolean;
    return true;
}

size_t wb_json_length(const struct wb_json *array)
{
    return array && array->kind == KIND_ARRAY ? array->as.list.n : 0;
}

struct wb_json *wb_json_item(const struct wb_json *array, size_t index)
{
    return index < wb_json_length(array) ? array->as.list.values[index] : NULL;
}

bool wb_json_number(const struct wb_json *value, double *number)
{
    if (!value || (value->kind != KIND_NUMBER && value->kind != KIND_INTEGER))
        return false;
    *number = value->kind == KIND_NUMBER ? value->as.number : (double)value->as.integer;
    return true;
}

bool wb_json_text(const struct wb_json *value, const char **text)
{
    if (!value || value->kind != KIND_TEXT)
        return false;
    *text = value->as.text;
    return true;
}

/* --- two documents --- */

struct comparison {
    double tolerance;
    struct wb_json_difference *found;
    char place[sizeof(((struct wb_json_place *)0)->place)];
    size_t length; /* of the place */
};

/* Puts a step on the way to a value; what was there before is put back by its length. */
static size_t step_to(struct comparison *c, const char *key, size_t index)
{
    const size_t before = c->length, room = sizeof c->place - before;
    const int n = key ? snprintf(c->place + before, room, "%s%s", before > 0 ? "." : "", key)
                      : snprintf(c->place + before, room, "[%zu]", index);
    c->length = n > 0 && (size_t)n < room ? before + (size_t)n : before;
    return before;
}

/* A value for a message; of a list that it is one. */
static void show(const struct wb_json *value, char text[80])
{
    double number;
    if (!value || value->kind == KIND_NULL)
        snprintf(text, 80, "nothing");
    else if (wb_json_number(value, &number))
        snprintf(text, 80, "%.8g", number);
    else if (value->kind == KIND_TEXT)
        snprintf(text, 80, "'%.70s'", value->as.text);
    else if (value->kind == KIND_BOOLEAN)
        snprintf(text, 80, "%s", value->as.boolean ? "true" : "false");
    else
        snprintf(text, 80, value->kind == KIND_ARRAY ? "a list of %zu" : "something",
                 value->as.list.n);
}

static void note(struct comparison *c, double size, const struct wb_json *a,
                 const struct wb_json *b)
{
    struct wb_json_difference *const found = c->found;
    struct wb_json_place here;
    if (found->n++ > 0 && !(size > found->largest))
        return;
    snprintf(here.place, sizeof here.place, "%s", c->place);
    show(a, here.a);
    show(b, here.b);
    found->largest = size;
    found->most = here;
    if (found->n == 1)
        found->first = here;
}

static double largest_of(const struct wb_json *list)
{
    double largest = 0.0, number;
    for (size_t i = 0; list->kind == KIND_ARRAY && i < list->as.list.n; i++) {
        if (wb_json_number(list->as.list.values[i], &number))
            largest = fmax(largest, fabs(number));
    }
    return largest;
}

static void compare(struct comparison *c, const struct wb_json *a, const struct wb_json *b,
                    double scale);

static void compare_part(struct comparison *c, const struct wb_json *a, const struct wb_json *b,
                         const char *key, size_t index, double scale)
{
    const size_t before = step_to(c, key, index);
    compare(c, a, b, scale);
    c->length = before;
    c->place[before] = '\0';
}

static bool is_among(const char *key, const char *const *names)
{
    for (; names && *names; names++) {
        if (strcmp(key, *names) == 0)
            return true;
    }
    return false;
}

static void compare_lists(struct comparison *c, const struct wb_json *a, const struct wb_json *b,
                          const char *const *ignored)
{
    const bool is_object = a->kind == KIND_OBJECT;
    const double scale = fmax(largest_of(a), largest_of(b));
    if (!is_object && a->as.list.n != b->as.list.n) {
        note(c, (double)INFINITY, a, b);
        return;
    }
    for (size_t i = 0; i < b->as.list.n; i++) {
        const struct wb_json *const y = b->as.list.values[i];
        if (!is_object)
            compare_part(c, a->as.list.values[i], y, NULL, i, scale);
        else if (!is_among(y->key, ignored))
            compare_part(c, wb_json_get(a, y->key), y, y->key, i, 0.0);
    }
    for (size_t i = 0; is_object && i < a->as.list.n; i++) {
        const struct wb_json *const x = a->as.list.values[i];
        if (!wb_json_get(b, x->key) && !is_among(x->key, ignored))
            compare_part(c, x, NULL, x->key, i, 0.0);
    }
}

static bool is_equal(const struct wb_json *a, const struct wb_json *b)
{
    if (!a || !b || a->kind != b->kind)
        return a == b;
    switch (a->kind) {
    case KIND_BOOLEAN:
        return a->as.boolean == b->as.boolean;
    case KIND_TEXT:
        return strcmp(a->as.text, b->as.text) == 0;
    default:
        return a->kind == KIND_NULL;
    }
}

/* `scale`: the largest number of the array that they stand in. */
static void compare(struct comparison *c, const struct wb_json *a, const struct wb_json *b,
                    double scale)
{
    double x, y;
    /* A number without a fraction reads back as an integer. */
    if (wb_json_number(a, &x) && wb_json_number(b, &y)) {
        const double largest = fmax(scale, fmax(fabs(x), fabs(y)));
        if (!(fabs(x - y) <= c->tolerance * largest))
            note(c, fabs(x - y) / largest, a, b);
    } else if (is_list(a) && is_list(b) && a->kind == b->kind) {
        compare_lists(c, a, b, NULL);
    } else if (!is_equal(a, b)) {
        note(c, (double)INFINITY, a, b);
    }
}

bool wb_json_differs(const struct wb_json *a, const struct wb_json *b, double tolerance,
                     const char *const *ignored, struct wb_json_difference *difference)
{
    struct comparison c = {.tolerance = tolerance, .found = difference};
    *difference = (struct wb_json_difference){.n = 0};
    if (is_list(a) && is_list(b) && a->kind == b->kind)
        compare_lists(&c, a, b, ignored);
    else
        compare(&c, a, b, 0.0);
    return difference->n > 0;
}
