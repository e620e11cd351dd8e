#include "base/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "base/file.h"
#include "base/number.h"
#include "base/text.h"

#define WB_LOG_DOMAIN "json"

/* A handle is jansson's own value under our name; these two casts are the only way between. */
static json_t *value_of(const struct wb_json *handle)
{
    return (json_t *)(uintptr_t)handle;
}

static struct wb_json *handle_of(json_t *value)
{
    return (struct wb_json *)(uintptr_t)value;
}

/* A handle that could not be made is NULL, and what is set into it is lost: the counter makes
 * that visible when the document is written. Documents are built by one thread at a time each, but
 * several may be built at once. */
static _Thread_local unsigned lost_values;

struct wb_json *wb_json_create(void)
{
    lost_values = 0;
    return handle_of(json_object());
}

void wb_json_destroy(struct wb_json *root)
{
    json_decref(value_of(root));
}

static struct wb_json *set(struct wb_json *object, const char *key, json_t *value)
{
    if (!object) {
        json_decref(value);
        value = NULL;
    }
    if (!value || json_object_set_new(value_of(object), key, value) != 0) {
        lost_values++;
        return NULL;
    }
    return handle_of(value);
}

static struct wb_json *append(struct wb_json *array, json_t *value)
{
    if (!array) {
        json_decref(value);
        value = NULL;
    }
    if (!value || json_array_append_new(value_of(array), value) != 0) {
        lost_values++;
        return NULL;
    }
    return handle_of(value);
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *string(const char *text)
{
    if (!text)
        return json_null();
    json_t *value = json_string(text);
    if (value)
        return value;
    /* Not UTF-8 (bytes from a device, say): keep what is ASCII. */
    char *ascii = strdup(text);
    if (!ascii)
        return NULL;
    for (char *c = ascii; *c; c++) {
        if ((unsigned char)*c >= 0x80)
            *c = '?';
    }
    value = json_string(ascii);
    free(ascii);
    return value;
}

void wb_json_set_text(struct wb_json *object, const char *key, const char *text)
{
    set(object, key, string(text));
}

void wb_json_set_number(struct wb_json *object, const char *key, double value)
{
    set(object, key, number(value));
}

void wb_json_set_integer(struct wb_json *object, const char *key, int64_t value)
{
    set(object, key, json_integer(value));
}

void wb_json_set_boolean(struct wb_json *object, const char *key, bool value)
{
    set(object, key, json_boolean(value));
}

struct wb_json *wb_json_set_object(struct wb_json *object, const char *key)
{
    return set(object, key, json_object());
}

struct wb_json *wb_json_set_array(struct wb_json *object, const char *key)
{
    return set(object, key, json_array());
}

void wb_json_append_text(struct wb_json *array, const char *text)
{
    append(array, string(text));
}

void wb_json_append_number(struct wb_json *array, double value)
{
    append(array, number(value));
}

struct wb_json *wb_json_append_object(struct wb_json *array)
{
    return append(array, json_object());
}

struct wb_json *wb_json_append_array(struct wb_json *array)
{
    return append(array, json_array());
}

void wb_json_set_copy(struct wb_json *object, const char *key, const struct wb_json *value)
{
    set(object, key, value ? json_deep_copy(value_of(value)) : json_null());
}

/* jansson prints 0.1 with 17 digits as 0.10000000000000001; people read these files, so containers
 * and numbers are laid out here and everything else is left to jansson. */
static void format_value(struct wb_text *text, const json_t *value, int depth);

static void format_scalar(struct wb_text *text, const json_t *value)
{
    if (json_is_real(value)) {
        char number_text[WB_NUMBER_TEXT];
        wb_text_append(text, "%s", wb_number_format(json_real_value(value), number_text));
        return;
    }
    char *scalar = json_dumps(value, JSON_ENCODE_ANY);
    if (scalar)
        wb_text_append(text, "%s", scalar);
    else
        text->failed = true;
    free(scalar);
}

static void start_line(struct wb_text *text, bool first, int depth)
{
    wb_text_append(text, "%s\n%*s", first ? "" : ",", 2 * depth, "");
}

static void format_object(struct wb_text *text, json_t *object, int depth)
{
    bool first = true;
    const char *key;
    json_t *member_value;
    wb_text_append(text, "{");
    json_object_foreach(object, key, member_value)
    {
        json_t *name = json_string(key);
        start_line(text, first, depth + 1);
        format_scalar(text, name);
        wb_text_append(text, ": ");
        format_value(text, member_value, depth + 1);
        json_decref(name);
        first = false;
    }
    wb_text_append(text, "%s%*s}", first ? "" : "\n", first ? 0 : 2 * depth, "");
}

static void format_array(struct wb_text *text, const json_t *array, int depth)
{
    wb_text_append(text, "[");
    for (size_t i = 0; i < json_array_size(array); i++) {
        start_line(text, i == 0, depth + 1);
        format_value(text, json_array_get(array, i), depth + 1);
    }
    const bool empty = json_array_size(array) == 0;
    wb_text_append(text, "%s%*s]", empty ? "" : "\n", empty ? 0 : 2 * depth, "");
}

static void format_value(struct wb_text *text, const json_t *value, int depth)
{
    if (json_is_object(value))
        format_object(text, (json_t *)(uintptr_t)value, depth);
    else if (json_is_array(value))
        format_array(text, value, depth);
    else
        format_scalar(text, value);
}

enum wb_status wb_json_format(const struct wb_json *root, char **text)
{
    struct wb_text formatted = {0};
    if (lost_values == 0 && root) {
        format_value(&formatted, value_of(root), 0);
        wb_text_append(&formatted, "\n");
    }
    if (formatted.length == 0 || formatted.failed) {
        wb_text_release(&formatted);
        return wb_fail(WB_ERR_MEMORY, "out of memory writing JSON");
    }
    *text = formatted.bytes;
    return WB_OK;
}

enum wb_status wb_json_parse(struct wb_json **root, const char *text, const char *origin)
{
    *root = NULL;
    json_error_t error;
    json_t *value = json_loads(text, JSON_REJECT_DUPLICATES, &error);
    if (!value)
        return wb_fail(WB_ERR_FORMAT, "%s:%d: %s", origin, error.line, error.text);
    if (!json_is_object(value)) {
        json_decref(value);
        return wb_fail(WB_ERR_FORMAT, "%s: expected a JSON object", origin);
    }
    *root = handle_of(value);
    return WB_OK;
}

enum wb_status wb_json_read(struct wb_json **root, const char *path)
{
    *root = NULL;
    char *text;
    WB_TRY(wb_file_read(path, &text, NULL));
    const enum wb_status status = wb_json_parse(root, text, path);
    free(text);
    return status;
}

static json_t *member(const struct wb_json *object, const char *key)
{
    return json_object_get(value_of(object), key);
}

bool wb_json_get_text(const struct wb_json *object, const char *key, const char **text)
{
    return wb_json_text(handle_of(member(object, key)), text);
}

bool wb_json_get_number(const struct wb_json *object, const char *key, double *value)
{
    return wb_json_number(handle_of(member(object, key)), value);
}

bool wb_json_get_integer(const struct wb_json *object, const char *key, int64_t *value)
{
    const json_t *const found = member(object, key);
    if (!json_is_integer(found))
        return false;
    *value = json_integer_value(found);
    return true;
}

bool wb_json_get_boolean(const struct wb_json *object, const char *key, bool *value)
{
    const json_t *const found = member(object, key);
    if (!json_is_boolean(found))
        return false;
    *value = json_is_true(found);
    return true;
}

struct wb_json *wb_json_get(const struct wb_json *object, const char *key)
{
    return handle_of(member(object, key));
}

size_t wb_json_length(const struct wb_json *array)
{
    return json_array_size(value_of(array));
}

struct wb_json *wb_json_item(const struct wb_json *array, size_t index)
{
    return handle_of(json_array_get(value_of(array), index));
}

bool wb_json_number(const struct wb_json *value, double *number_out)
{
    const json_t *const found = value_of(value);
    if (!json_is_number(found))
        return false;
    *number_out = json_number_value(found);
    return true;
}

bool wb_json_text(const struct wb_json *value, const char **text)
{
    const json_t *const found = value_of(value);
    if (!json_is_string(found))
        return false;
    *text = json_string_value(found);
    return true;
}
