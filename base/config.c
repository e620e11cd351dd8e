#include "base/config.h"

#include <ctype.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <yaml.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/number.h"

#define WB_LOG_DOMAIN "config"

/* A handle on one YAML node; the document holds one for each, in the order of libyaml's own. */
struct wb_config_node {
    const struct wb_config *config;
    yaml_node_t *yaml;
};

struct wb_config {
    struct wb_reason *why; /* NULL: failures are logged */
    char *origin;
    yaml_document_t document;
    bool loaded;
    struct wb_config_node *nodes;
};

static const struct wb_config_node *node_of(const struct wb_config *config, int yaml_index)
{
    return &config->nodes[yaml_index - 1];
}

static enum wb_status load(struct wb_config *config, const char *text)
{
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser))
        wb_memory_need(NULL);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, strlen(text));
    enum wb_status status = WB_OK;
    if (!yaml_parser_load(&parser, &config->document)) {
        const char *const what = parser.problem ? parser.problem : "not YAML";
        /* libyaml's messages for the most frequent mistake, a missing colon. */
        const bool colon = strstr(what, "mapping values are not allowed") ||
                           strstr(what, "could not find expected ':'");
        status = wb_fail_to(config->why, WB_ERR_FORMAT, "%s:%zu: %s%s%s%s", config->origin,
                            parser.problem_mark.line + 1, what, parser.context ? " " : "",
                            parser.context ? parser.context : "",
                            colon ? ": is a colon missing in the line before?" : "");
    } else {
        config->loaded = true;
        if (!yaml_document_get_root_node(&config->document))
            status =
                wb_fail_to(config->why, WB_ERR_FORMAT, "%s: the file is empty", config->origin);
    }
    yaml_parser_delete(&parser);
    return status;
}

/* Finds the entry `name`; rejects a second one. */
static enum wb_status find_entry(const struct wb_config_node *map, const char *name,
                                 const struct wb_config_node **found)
{
    *found = NULL;
    for (int i = 0; i < wb_config_entries(map); i++) {
        const char *other;
        const struct wb_config_node *const value = wb_config_entry(map, i, &other);
        if (strcmp(name, other) != 0)
            continue;
        if (*found)
            return wb_config_refuse(value, name, "given twice, first in line %d",
                                    wb_config_line(*found));
        *found = value;
    }
    return WB_OK;
}

static enum wb_status check_schema(const struct wb_config *config)
{
    int schema = WB_CONFIG_SCHEMA;
    const struct wb_config_node *value;
    const struct wb_config_key key = WB_CONFIG_INTEGER("schema", &schema, 1, INT_MAX);
    WB_TRY(find_entry(wb_config_root(config), "schema", &value));
    if (value)
        WB_TRY(wb_config_value(value, &key));
    if (schema > WB_CONFIG_SCHEMA)
        return wb_config_refuse(value, "schema",
                                "the file has layout %d, this program reads up to %d: use a newer "
                                "wirebench",
                                schema, WB_CONFIG_SCHEMA);
    return WB_OK;
}

enum wb_status wb_config_parse(struct wb_config **out, const char *text, const char *origin,
                               struct wb_reason *why)
{
    *out = NULL;
    struct wb_config *const config = wb_memory_new(1, sizeof *config);
    config->why = why;
    config->origin = wb_memory_text(origin);
    enum wb_status status = load(config, text);
    if (status == WB_OK) {
        const size_t n = (size_t)(config->document.nodes.top - config->document.nodes.start);
        config->nodes = wb_memory_new(n, sizeof *config->nodes);
        for (size_t i = 0; i < n; i++)
            config->nodes[i] = (struct wb_config_node){config, config->document.nodes.start + i};
    }
    if (status == WB_OK)
        status = check_schema(config);
    if (status != WB_OK) {
        wb_config_destroy(config);
        return status;
    }
    *out = config;
    return WB_OK;
}

enum wb_status wb_config_read_text(char **out, const char *path, struct wb_reason *why)
{
    size_t size;
    WB_TRY(wb_file_read_with_reason(path, out, &size, why));
    if (strlen(*out) == size)
        return WB_OK;
    free(*out);
    *out = NULL;
    return wb_fail_to(why, WB_ERR_FORMAT, "'%s' is not a text file", path);
}

enum wb_status wb_config_read(struct wb_config **out, const char *path, struct wb_reason *why)
{
    *out = NULL;
    char *text;
    WB_TRY(wb_config_read_text(&text, path, why));
    const enum wb_status status = wb_config_parse(out, text, path, why);
    free(text);
    return status;
}

enum wb_status wb_config_load(const char *text, const char *origin, struct wb_reason *why,
                              enum wb_status (*read)(const struct wb_config_node *, void *),
                              void *into)
{
    struct wb_config *config;
    WB_TRY(text ? wb_config_parse(&config, text, origin, why)
                : wb_config_read(&config, origin, why));
    const enum wb_status status = read(wb_config_root(config), into);
    wb_config_destroy(config);
    return status;
}

void wb_config_destroy(struct wb_config *config)
{
    if (!config)
        return;
    if (config->loaded)
        yaml_document_delete(&config->document);
    free(config->nodes);
    free(config->origin);
    free(config);
}

const struct wb_config_node *wb_config_root(const struct wb_config *config)
{
    return node_of(config, 1);
}

const char *wb_config_origin(const struct wb_config_node *node)
{
    return node->config->origin;
}

int wb_config_line(const struct wb_config_node *node)
{
    return (int)node->yaml->start_mark.line + 1;
}

const struct wb_config_node *wb_config_find(const struct wb_config_node *map, const char *key)
{
    for (int i = 0; i < wb_config_entries(map); i++) {
        const char *name;
        const struct wb_config_node *const value = wb_config_entry(map, i, &name);
        if (strcmp(name, key) == 0)
            return value;
    }
    return NULL;
}

enum wb_status wb_config_refuse(const struct wb_config_node *node, const char *key,
                                const char *format, ...)
{
    char message[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    const struct wb_config_node *const named = key ? wb_config_find(node, key) : NULL;
    return wb_fail_to(node->config->why, WB_ERR_FORMAT, "%s:%d: %s%s%s", wb_config_origin(node),
                      wb_config_line(named ? named : node), key ? key : "", key ? ": " : "",
                      message);
}

enum wb_status wb_config_refuse_keys(const struct wb_config_node *map, const char *const *keys,
                                     const char *message)
{
    for (; *keys; keys++)
        if (wb_config_find(map, *keys))
            return wb_config_refuse(map, *keys, "%s", message);
    return WB_OK;
}

const char *wb_config_scalar(const struct wb_config_node *node)
{
    if (node->yaml->type != YAML_SCALAR_NODE)
        return NULL;
    /* A scalar that contains NUL ("\0") would be cut off: treat it as not a scalar. */
    const char *const text = (const char *)node->yaml->data.scalar.value;
    return strlen(text) == node->yaml->data.scalar.length ? text : NULL;
}

int wb_config_entries(const struct wb_config_node *map)
{
    if (map->yaml->type != YAML_MAPPING_NODE)
        return -1;
    return (int)(map->yaml->data.mapping.pairs.top - map->yaml->data.mapping.pairs.start);
}

const struct wb_config_node *wb_config_entry(const struct wb_config_node *map, int index,
                                             const char **name)
{
    const yaml_node_pair_t *const pair = map->yaml->data.mapping.pairs.start + index;
    const char *const text = wb_config_scalar(node_of(map->config, pair->key));
    *name = text ? text : "";
    return node_of(map->config, pair->value);
}

int wb_config_length(const struct wb_config_node *sequence)
{
    if (sequence->yaml->type != YAML_SEQUENCE_NODE)
        return -1;
    return (int)(sequence->yaml->data.sequence.items.top -
                 sequence->yaml->data.sequence.items.start);
}

const struct wb_config_node *wb_config_item(const struct wb_config_node *sequence, int index)
{
    return node_of(sequence->config, sequence->yaml->data.sequence.items.start[index]);
}

/* Whether the text is a number with a decimal comma, "85,5"; `with_point` is then "85.5". */
static bool is_decimal_comma(const char *text, char *with_point, size_t size)
{
    double number;
    if (snprintf(with_point, size, "%s", text) >= (int)size)
        return false;
    char *const comma = strchr(with_point, ',');
    if (!comma)
        return false;
    *comma = '.';
    return wb_number_parse(with_point, &number);
}

static enum wb_status read_number(const struct wb_config_node *node,
                                  const struct wb_config_key *key, double *value)
{
    const char *const text = wb_config_scalar(node);
    double number;
    if (!text)
        return wb_config_refuse(node, key->name, "expected a number");
    char with_point[64];
    if (!wb_number_parse(text, &number) && is_decimal_comma(text, with_point, sizeof with_point))
        return wb_config_refuse(node, key->name, "expected a decimal point, not a comma: write %s",
                                with_point);
    if (!wb_number_parse(text, &number))
        return wb_config_refuse(node, key->name,
                                "expected a plain number (the unit stands in the key's name), "
                                "not '%s'",
                                text);
    if (number < key->minimum || number > key->maximum)
        return wb_config_refuse(node, key->name, "%s is out of range, expected %g to %g", text,
                                key->minimum, key->maximum);
    *value = number * key->factor;
    return WB_OK;
}

static enum wb_status read_integer(const struct wb_config_node *node,
                                   const struct wb_config_key *key)
{
    const char *const text = wb_config_scalar(node);
    long number;
    if (!text || !wb_number_parse_integer(text, &number))
        return wb_config_refuse(node, key->name, "expected a whole number%s%s",
                                text ? ", not " : "", text ? text : "");
    if ((double)number < key->minimum || (double)number > key->maximum)
        return wb_config_refuse(node, key->name, "%ld is out of range, expected %g to %g", number,
                                key->minimum, key->maximum);
    *(int *)key->target = (int)number;
    return WB_OK;
}

static enum wb_status read_boolean(const struct wb_config_node *node,
                                   const struct wb_config_key *key)
{
    const char *const text = wb_config_scalar(node);
    const bool yes = text && strcmp(text, "true") == 0;
    if (!yes && !(text && strcmp(text, "false") == 0))
        return wb_config_refuse(node, key->name, "expected true or false");
    *(bool *)key->target = yes;
    return WB_OK;
}

static enum wb_status read_text(const struct wb_config_node *node, const struct wb_config_key *key)
{
    const char *const text = wb_config_scalar(node);
    if (!text)
        return wb_config_refuse(node, key->name, "expected a text");
    if (strlen(text) >= key->size)
        return wb_config_refuse(node, key->name, "text too long, at most %zu bytes", key->size - 1);
    strcpy(key->target, text);
    return WB_OK;
}

static enum wb_status read_choice(const struct wb_config_node *node,
                                  const struct wb_config_key *key)
{
    const char *const text = wb_config_scalar(node);
    char expected[256] = "";
    for (int i = 0; key->choices[i]; i++) {
        if (text && strcmp(text, key->choices[i]) == 0) {
            *(int *)key->target = i;
            return WB_OK;
        }
        const size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s%s", i ? ", " : "", key->choices[i]);
    }
    return wb_config_refuse(node, key->name, "expected one of %s%s%s", expected,
                            text ? ", not " : "", text ? text : "");
}

enum wb_status wb_config_value(const struct wb_config_node *node, const struct wb_config_key *key)
{
    switch (key->type) {
    case WB_CONFIG_TYPE_NUMBER:
        return read_number(node, key, key->target);
    case WB_CONFIG_TYPE_INTEGER:
        return read_integer(node, key);
    case WB_CONFIG_TYPE_BOOLEAN:
        return read_boolean(node, key);
    case WB_CONFIG_TYPE_TEXT:
        return read_text(node, key);
    case WB_CONFIG_TYPE_CHOICE:
        return read_choice(node, key);
    case WB_CONFIG_TYPE_NODE:
        *(const struct wb_config_node **)key->target = node;
        return WB_OK;
    case WB_CONFIG_TYPE_IGNORED:
        return WB_OK;
    }
    return WB_ERR_ARGUMENT;
}

static enum wb_status refuse_unknown(const struct wb_config_node *value, const char *name,
                                     const struct wb_config_key *keys, size_t n_keys)
{
    char known[768] = "";
    for (size_t i = 0; i < n_keys; i++) {
        const size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s%s", i ? ", " : "", keys[i].name);
    }
    return wb_config_refuse(value, name, "unknown key; known here: %s", known);
}

/* wb_config_parse() has read this key. */
static bool is_schema(const struct wb_config_node *map, const char *name)
{
    return map == wb_config_root(map->config) && strcmp(name, "schema") == 0;
}

enum wb_status wb_config_map(const struct wb_config_node *map, const struct wb_config_key *keys,
                             size_t n_keys)
{
    if (wb_config_entries(map) < 0)
        return wb_config_refuse(map, NULL, "expected keys with values");
    for (int i = 0; i < wb_config_entries(map); i++) {
        const char *name;
        const struct wb_config_node *const value = wb_config_entry(map, i, &name);
        size_t k = 0;
        while (k < n_keys && strcmp(keys[k].name, name) != 0)
            k++;
        if (k == n_keys && is_schema(map, name))
            continue;
        if (k == n_keys)
            return refuse_unknown(value, name, keys, n_keys);
    }
    for (size_t k = 0; k < n_keys; k++) {
        const struct wb_config_node *value;
        WB_TRY(find_entry(map, keys[k].name, &value));
        if (value)
            WB_TRY(wb_config_value(value, &keys[k]));
        else if (!keys[k].optional)
            return wb_config_refuse(map, keys[k].name, "this key is missing");
        else if (keys[k].type == WB_CONFIG_TYPE_NODE)
            *(const struct wb_config_node **)keys[k].target = NULL;
    }
    return WB_OK;
}

enum wb_status wb_config_numbers(const struct wb_config_node *sequence,
                                 const struct wb_config_key *key, int least, int most,
                                 double *values, int *n)
{
    const int length = wb_config_length(sequence);
    if (length < 0)
        return wb_config_refuse(sequence, key->name, "expected a list of numbers");
    if (length != least && least == most)
        return wb_config_refuse(sequence, key->name, "%d numbers given, expected %d", length,
                                least);
    if (length < least || length > most)
        return wb_config_refuse(sequence, key->name, "%d numbers given, expected %d to %d", length,
                                least, most);
    for (int i = 0; i < length; i++)
        WB_TRY(read_number(wb_config_item(sequence, i), key, &values[i]));
    *n = length;
    return WB_OK;
}

enum wb_status wb_config_check_date(const struct wb_config_node *map, const char *key,
                                    const char *date)
{
    int year, month, day, end = 0;
    if (date[0] == '\0')
        return WB_OK;
    if (strlen(date) != 10 || sscanf(date, "%4d-%2d-%2d%n", &year, &month, &day, &end) != 3 ||
        end != 10 || !isdigit((unsigned char)date[5]) || !isdigit((unsigned char)date[8]) ||
        month < 1 || month > 12 || day < 1 || day > 31)
        return wb_config_refuse(map, key, "expected a date as YYYY-MM-DD, not '%s'", date);
    return WB_OK;
}
