#include "base/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "json"

/* A struct wb_json is jansson's json_t under another name: it is never defined. */
static json_t *jansson(const struct wb_json *value)
{
    return (json_t *)value;
}

static struct wb_json *own(json_t *value)
{
    return (struct wb_json *)value;
}

struct wb_json *wb_json_create(void)
{
    return wb_memory_need(json_object());
}

void wb_json_destroy(struct wb_json *root)
{
    json_decref(jansson(root));
}

/* Sets a member of an object (without a key: appends to an array). Takes ownership of `value`,
 * which is NULL if it could not be created. */
static struct wb_json *put(struct wb_json *list, const char *key, json_t *value)
{
    char message[160];
    if (key && !json_is_object(jansson(list))) {
        snprintf(message, sizeof message, "JSON: '%.80s' is set in a value that is not an object",
                 key);
        wb_memory_end(message);
    }
    if (!key && !json_is_array(jansson(list)))
        wb_memory_end("JSON: an item is appended to a value that is not an array");
    const int failed = key ? json_object_set_new(jansson(list), key, value)
                           : json_array_append_new(jansson(list), value);
    return own(wb_memory_need(failed ? NULL : value));
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *text(const char *raw)
{
    if (!raw)
        return json_null();
    json_t *string = json_string(raw);
    if (string)
        return string;
    /* Not UTF-8 (bytes from a device, for example): keep the ASCII characters. */
    char *const ascii = wb_memory_text(raw);
    for (char *c = ascii; *c; c++) {
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    }
    string = json_string(ascii);
    free(ascii);
    return string;
}

void wb_json_set_text(struct wb_json *object, const char *key, const char *value)
{
    put(object, key, text(value));
}

void wb_json_set_number(struct wb_json *object, const char *key, double value)
{
    put(object, key, number(value));
}

void wb_json_set_integer(struct wb_json *object, const char *key, int64_t value)
{
    put(object, key, json_integer(value));
}

void wb_json_set_boolean(struct wb_json *object, const char *key, bool value)
{
    put(object, key, json_boolean(value));
}

struct wb_json *wb_json_set_object(struct wb_json *object, const char *key)
{
    return put(object, key, json_object());
}

struct wb_json *wb_json_set_array(struct wb_json *object, const char *key)
{
    return put(object, key, json_array());
}

void wb_json_append_text(struct wb_json *array, const char *value)
{
    put(array, NULL, text(value));
}

void wb_json_append_number(struct wb_json *array, double value)
{
    put(array, NULL, number(value));
}

struct wb_json *wb_json_append_object(struct wb_json *array)
{
    return put(array, NULL, json_object());
}

void wb_json_set_copy(struct wb_json *object, const char *key, const struct wb_json *value)
{
    put(object, key, value ? json_deep_copy(jansson(value)) : json_null());
}

/* --- text --- */

enum {
    ONE_LINE = -1 /* as a depth */
};

static void format_value(struct wb_text *text, json_t *value, int depth);

static void format_key(struct wb_text *text, const char *key)
{
    json_t *const string = json_string(key);
    format_value(text, string, 0);
    wb_text_append(text, ": ");
    json_decref(string);
}

static void break_line(struct wb_text *text, int depth)
{
    if (depth != ONE_LINE)
        wb_text_append(text, "\n%*s", 2 * depth, "");
}

static void format_list(struct wb_text *text, json_t *list, int depth)
{
    const int inside = depth == ONE_LINE ? ONE_LINE : depth + 1;
    const bool is_object = json_is_object(list);
    void *member = json_object_iter(list);
    const size_t n = is_object ? json_object_size(list) : json_array_size(list);
    wb_text_append(text, is_object ? "{" : "[");
    for (size_t i = 0; i < n; i++) {
        wb_text_append(text, i > 0 && inside == ONE_LINE ? ", " : i > 0 ? "," : "");
        break_line(text, inside);
        if (is_object)
            format_key(text, json_object_iter_key(member));
        format_value(text, is_object ? json_object_iter_value(member) : json_array_get(list, i),
                     inside);
        member = json_object_iter_next(list, member);
    }
    if (n > 0)
        break_line(text, depth);
    wb_text_append(text, is_object ? "}" : "]");
}

/* jansson prints 0.1 with 17 digits as 0.10000000000000001. People read these files, so numbers,
 * objects and arrays are formatted here. */
static void format_value(struct wb_text *text, json_t *value, int depth)
{
    char number_text[WB_NUMBER_TEXT];
    if (json_is_object(value) || json_is_array(value)) {
        format_list(text, value, depth);
    } else if (json_is_real(value)) {
        wb_text_append(text, "%s", wb_number_format(json_real_value(value), number_text));
    } else {
        char *const scalar = wb_memory_need(json_dumps(value, JSON_ENCODE_ANY));
        wb_text_append(text, "%s", scalar);
        free(scalar);
    }
}

static char *format(const struct wb_json *root, int depth)
{
    struct wb_text text = {0};
    format_value(&text, jansson(root), depth);
    wb_text_append(&text, "\n");
    return text.bytes;
}

char *wb_json_format(const struct wb_json *root)
{
    return format(root, 0);
}

char *wb_json_format_line(const struct wb_json *root)
{
    return format(root, ONE_LINE);
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
    *root = own(parsed);
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

/* --- reading; jansson's functions return NULL or 0 for NULL and for values of another kind --- */

struct wb_json *wb_json_get(const struct wb_json *object, const char *key)
{
    return own(json_object_get(jansson(object), key));
}

size_t wb_json_length(const struct wb_json *array)
{
    return json_array_size(jansson(array));
}

struct wb_json *wb_json_item(const struct wb_json *array, size_t index)
{
    return own(json_array_get(jansson(array), index));
}

bool wb_json_number(const struct wb_json *value, double *number)
{
    if (!json_is_number(jansson(value)))
        return false;
    *number = json_number_value(jansson(value));
    return true;
}

bool wb_json_text(const struct wb_json *value, const char **text)
{
    if (!json_is_string(jansson(value)))
        return false;
    *text = json_string_value(jansson(value));
    return true;
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
    const json_t *const found = jansson(wb_json_get(object, key));
    if (!json_is_integer(found))
        return false;
    *value = json_integer_value(found);
    return true;
}

bool wb_json_get_boolean(const struct wb_json *object, const char *key, bool *value)
{
    const json_t *const found = jansson(wb_json_get(object, key));
    if (!json_is_boolean(found))
        return false;
    *value = json_is_true(found);
    return true;
}

/* --- two documents --- */

struct comparison {
    double tolerance;
    const char *const *ignored; /* members of the roots to skip */
    struct wb_json_difference *found;
    char place[sizeof(((struct wb_json_place *)0)->place)];
    size_t length; /* of the place */
};

/* A value for a message; arrays by their length only. */
static void show(json_t *value, char text[80])
{
    if (!value || json_is_null(value))
        snprintf(text, 80, "nothing");
    else if (json_is_number(value))
        snprintf(text, 80, "%.8g", json_number_value(value));
    else if (json_is_string(value))
        snprintf(text, 80, "'%.70s'", json_string_value(value));
    else if (json_is_boolean(value))
        snprintf(text, 80, "%s", json_is_true(value) ? "true" : "false");
    else if (json_is_array(value))
        snprintf(text, 80, "a list of %zu", json_array_size(value));
    else
        snprintf(text, 80, "an object");
}

static void note_difference(struct comparison *c, double size, json_t *a, json_t *b)
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

static double largest_of(json_t *list)
{
    double largest = 0.0;
    size_t i;
    json_t *item;
    json_array_foreach(list, i, item)
    {
        largest = fmax(largest, fabs(json_number_value(item)));
    }
    return largest;
}

static void compare(struct comparison *c, json_t *a, json_t *b, double scale);

/* Compares members or items of two values; `length` restores the place afterwards. */
static void compare_part(struct comparison *c, json_t *a, json_t *b, const char *key, size_t index,
                         double scale)
{
    const size_t before = c->length, room = sizeof c->place - before;
    const int n = key ? snprintf(c->place + before, room, "%s%s", before > 0 ? "." : "", key)
                      : snprintf(c->place + before, room, "[%zu]", index);
    c->length = n > 0 && (size_t)n < room ? before + (size_t)n : before;
    compare(c, a, b, scale);
    c->length = before;
    c->place[before] = '\0';
}

static bool is_ignored(const struct comparison *c, const char *key)
{
    for (const char *const *name = c->length == 0 ? c->ignored : NULL; name && *name; name++) {
        if (strcmp(key, *name) == 0)
            return true;
    }
    return false;
}

/* `scale`: the largest number of the array that contains the values. */
static void compare(struct comparison *c, json_t *a, json_t *b, double scale)
{
    json_t *part;
    const char *key;
    size_t i;
    /* A number without a fraction is read back as an integer. */
    if (json_is_number(a) && json_is_number(b)) {
        const double x = json_number_value(a), y = json_number_value(b);
        const double largest = fmax(scale, fmax(fabs(x), fabs(y)));
        if (!(fabs(x - y) <= c->tolerance * largest))
            note_difference(c, fabs(x - y) / largest, a, b);
    } else if (json_is_array(a) && json_is_array(b) && json_array_size(a) == json_array_size(b)) {
        scale = fmax(largest_of(a), largest_of(b));
        json_array_foreach(b, i, part)
        {
            compare_part(c, json_array_get(a, i), part, NULL, i, scale);
        }
    } else if (json_is_object(a) && json_is_object(b)) {
        json_object_foreach(b, key, part)
        {
            if (!is_ignored(c, key))
                compare_part(c, json_object_get(a, key), part, key, 0, 0.0);
        }
        json_object_foreach(a, key, part)
        {
            if (!is_ignored(c, key) && !json_object_get(b, key))
                compare_part(c, part, NULL, key, 0, 0.0);
        }
    } else if (a != b && !json_equal(a, b)) {
        note_difference(c, (double)INFINITY, a, b);
    }
}

bool wb_json_differs(const struct wb_json *a, const struct wb_json *b, double tolerance,
                     const char *const *ignored, struct wb_json_difference *difference)
{
    struct comparison c = {.tolerance = tolerance, .ignored = ignored, .found = difference};
    *difference = (struct wb_json_difference){.n = 0};
    compare(&c, jansson(a), jansson(b), 0.0);
    return difference->n > 0;
}
