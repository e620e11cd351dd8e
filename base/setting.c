#include "base/setting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/setting_private.h"

#define WB_LOG_DOMAIN "setting"

static void *field_of(const struct wb_setting *row, void *settings)
{
    return (char *)settings + row->offset;
}

static const void *look_at(const struct wb_setting *row, const void *settings)
{
    return (const char *)settings + row->offset;
}

/* Whether a list was given. */
static bool *given_of(const struct wb_setting *row, void *settings)
{
    return (bool *)((char *)settings + row->given);
}

static double scale_of(const struct wb_setting *row)
{
    return row->scale == 0.0 ? 1.0 : row->scale;
}

static bool has_range(const struct wb_setting *row)
{
    return row->least != 0.0 || row->largest != 0.0;
}

bool wb_setting_applies(const struct wb_setting *row, unsigned place)
{
    return place == 0 || row->applies == 0 || (row->applies & place) != 0;
}

/* --- filling in --- */

static void fill(const struct wb_setting *row, void *settings)
{
    void *const field = field_of(row, settings);
    switch (row->type) {
    case WB_SETTING_NUMBER:
        *(double *)field = row->fallback * scale_of(row);
        break;
    case WB_SETTING_INTEGER:
    case WB_SETTING_CHOICE:
        *(int *)field = (int)row->fallback;
        break;
    case WB_SETTING_BOOLEAN:
        *(bool *)field = row->fallback != 0.0;
        break;
    case WB_SETTING_TEXT:
        if (row->size > 0)
            *(char *)field = '\0';
        else
            *(const char **)field = NULL;
        break;
    case WB_SETTING_LIST:
        wb_setting_fill(row->members, field);
        *given_of(row, settings) = false;
        break;
    }
}

void wb_setting_fill(const struct wb_setting_table *table, void *settings)
{
    for (size_t i = 0; i < table->n; i++)
        fill(&table->rows[i], settings);
}

/* Formats 1e-06 as "1e-6". */
static const char *format_short(double value, char text[WB_NUMBER_TEXT])
{
    snprintf(text, WB_NUMBER_TEXT, "%g", value);
    char *const exponent = strchr(text, 'e');
    if (exponent) {
        const int power = atoi(exponent + 1);
        snprintf(exponent + 1, (size_t)(text + WB_NUMBER_TEXT - exponent - 1), "%d", power);
    }
    return text;
}

/* --- the command line --- */

/* "a, b or c" */
static void list_choices(const struct wb_setting *row, char *text, size_t size)
{
    text[0] = '\0';
    for (int i = 0; row->choices[i]; i++) {
        const size_t used = strlen(text);
        const char *const before = i == 0 ? "" : row->choices[i + 1] ? ", " : " or ";
        snprintf(text + used, size - used, "%s%s", before, row->choices[i]);
    }
}

static bool is_within(const struct wb_setting *row, double value)
{
    return !has_range(row) || (value >= row->least && value <= row->largest);
}

/* Returns false, with the range in the format of --help in `problem`. */
static bool refuse_number(const struct wb_setting *row, const char *what, const char *argument,
                          char problem[WB_SETTING_PROBLEM])
{
    char range[WB_SETTING_VALUE];
    wb_setting_range(row, range);
    snprintf(problem, WB_SETTING_PROBLEM, "expected %s%s%s, not '%s'", what,
             range[0] ? " from " : "", range, argument);
    return false;
}

static bool parse_number(const struct wb_setting *row, const char *argument, double *field,
                         char problem[WB_SETTING_PROBLEM])
{
    double value = 0.0;
    const bool is_zero = row->zero && strcmp(argument, row->zero) == 0;
    if (!is_zero && (!wb_number_parse(argument, &value) || !is_within(row, value)))
        return refuse_number(row, "a number", argument, problem);
    *field = value * scale_of(row);
    return true;
}

static bool parse_integer(const struct wb_setting *row, const char *argument, int *field,
                          char problem[WB_SETTING_PROBLEM])
{
    long value = 0;
    if (!wb_number_parse_integer(argument, &value) || !is_within(row, (double)value))
        return refuse_number(row, "a whole number", argument, problem);
    *field = (int)value;
    return true;
}

static bool parse_text(const struct wb_setting *row, const char *argument, void *field,
                       char problem[WB_SETTING_PROBLEM])
{
    if (!argument[0]) {
        snprintf(problem, WB_SETTING_PROBLEM, "expected %s, not ''", row->argument);
        return false;
    }
    if (row->size == 0) {
        *(const char **)field = argument;
        return true;
    }
    if (strlen(argument) >= row->size) {
        snprintf(problem, WB_SETTING_PROBLEM, "expected at most %zu bytes, not '%s'", row->size - 1,
                 argument);
        return false;
    }
    strcpy(field, argument);
    return true;
}

static bool parse_choice(const struct wb_setting *row, const char *argument, int *field,
                         char problem[WB_SETTING_PROBLEM])
{
    char expected[WB_SETTING_VALUE];
    for (int i = 0; row->choices[i]; i++) {
        if (strcmp(argument, row->choices[i]) == 0) {
            *field = i;
            return true;
        }
    }
    list_choices(row, expected, sizeof expected);
    snprintf(problem, WB_SETTING_PROBLEM, "expected %s, not '%s'", expected, argument);
    return false;
}

static char separator_of(const struct wb_setting *row)
{
    return row->separator ? row->separator : ',';
}

/* Reads the first member alone, where that is allowed, or all members with separators between them.
 */
static bool parse_list(const struct wb_setting *row, const char *argument, void *members,
                       char problem[WB_SETTING_PROBLEM])
{
    char text[4 * WB_NUMBER_TEXT], what[WB_SETTING_VALUE];
    int n = 0;
    const int all = (int)row->members->n;
    const bool fits = snprintf(text, sizeof text, "%s", argument) < (int)sizeof text;
    for (char *part = fits ? text : NULL, *next; part; part = next) {
        next = strchr(part, separator_of(row));
        if (next)
            *next++ = '\0';
        if (n < all && !wb_setting_parse(&row->members->rows[n], part, members, problem))
            return false;
        n++;
    }
    const bool may_be_alone = strchr(row->argument, '[') != NULL;
    if (n != all && !may_be_alone) {
        snprintf(problem, WB_SETTING_PROBLEM, "expected %s, not '%s'", row->argument, argument);
        return false;
    }
    if (n != 1 && n != all) {
        /* "S or S,K,D" of "S[,K,D]" */
        const int alone = (int)strcspn(row->argument, "["), rest = (int)strlen(row->argument) - 2;
        snprintf(problem, WB_SETTING_PROBLEM, "expected %.*s or %.*s%.*s, not '%s'", alone,
                 row->argument, alone, row->argument, rest - alone, row->argument + alone + 1,
                 argument);
        return false;
    }
    const int wrong = row->complete ? row->complete(members, n, what, sizeof what) : -1;
    if (wrong < 0)
        return true;
    snprintf(problem, WB_SETTING_PROBLEM, "%s: %s", row->members->rows[wrong].name, what);
    return false;
}

bool wb_setting_parse(const struct wb_setting *row, const char *argument, void *settings,
                      char problem[WB_SETTING_PROBLEM])
{
    void *const field = field_of(row, settings);
    switch (row->type) {
    case WB_SETTING_NUMBER:
        return parse_number(row, argument, field, problem);
    case WB_SETTING_INTEGER:
        return parse_integer(row, argument, field, problem);
    case WB_SETTING_BOOLEAN:
        *(bool *)field = row->fallback == 0.0;
        return true;
    case WB_SETTING_TEXT:
        return parse_text(row, argument, field, problem);
    case WB_SETTING_CHOICE:
        return parse_choice(row, argument, field, problem);
    case WB_SETTING_LIST:
        if (!parse_list(row, argument, field, problem))
            return false;
        *given_of(row, settings) = true;
        return true;
    }
    return false;
}

/* --- files --- */

static struct wb_config_key key_of(const struct wb_setting *row, void *settings)
{
    static const enum wb_config_type types[] = {
        [WB_SETTING_NUMBER] = WB_CONFIG_TYPE_NUMBER,
        [WB_SETTING_INTEGER] = WB_CONFIG_TYPE_INTEGER,
        [WB_SETTING_BOOLEAN] = WB_CONFIG_TYPE_BOOLEAN,
        [WB_SETTING_TEXT] = WB_CONFIG_TYPE_TEXT,
        [WB_SETTING_CHOICE] = WB_CONFIG_TYPE_CHOICE,
    };
    return (struct wb_config_key){
        .name = row->name,
        .type = types[row->type],
        .optional = !row->required,
        .target = field_of(row, settings),
        .size = row->size,
        .factor = scale_of(row),
        .minimum = has_range(row) ? row->least : -(double)INFINITY,
        .maximum = has_range(row) ? row->largest : (double)INFINITY,
        .choices = row->choices,
    };
}

size_t wb_setting_keys(const struct wb_setting_table *table, unsigned place, void *settings,
                       struct wb_config_key *keys)
{
    size_t n = 0;
    for (size_t i = 0; i < table->n; i++) {
        const struct wb_setting *const row = &table->rows[i];
        if (row->type != WB_SETTING_LIST && wb_setting_applies(row, place))
            keys[n++] = key_of(row, settings);
    }
    return n;
}

enum wb_status wb_setting_read_list(const struct wb_setting *row, const struct wb_config_node *node,
                                    void *settings)
{
    struct wb_config_key keys[WB_SETTING_MEMBERS];
    char problem[WB_SETTING_PROBLEM];
    void *const members = field_of(row, settings);
    if (row->members->n > WB_SETTING_MEMBERS)
        return wb_config_refuse(node, row->name, "a list of %zu members, at most %d can be read",
                                row->members->n, WB_SETTING_MEMBERS);
    const size_t all = wb_setting_keys(row->members, 0, members, keys);
    const bool is_alone = wb_config_scalar(node) != NULL;
    if (is_alone) {
        keys[0].name = row->name;
        WB_TRY(wb_config_value(node, &keys[0]));
    } else {
        WB_TRY(wb_config_map(node, keys, all));
    }
    const int wrong = row->complete
                          ? row->complete(members, is_alone ? 1 : (int)all, problem, sizeof problem)
                          : -1;
    if (wrong >= 0)
        return wb_config_refuse(node, row->members->rows[wrong].name, "%s", problem);
    *given_of(row, settings) = true;
    return WB_OK;
}

/* --- values --- */

double wb_setting_value(const struct wb_setting *row, const void *settings)
{
    const void *const field = look_at(row, settings);
    if (row->type == WB_SETTING_NUMBER)
        return *(const double *)field / scale_of(row);
    return *(const int *)field;
}

/* A value without a default must be in its range, except members of a list, which may be omitted.
 */
static enum wb_status check_row(const struct wb_setting *row, bool has_default,
                                const void *settings, struct wb_reason *why)
{
    const void *const field = look_at(row, settings);
    if (row->type == WB_SETTING_LIST) {
        for (size_t i = 0; i < row->members->n; i++)
            WB_TRY(check_row(&row->members->rows[i], true, field, why));
        return WB_OK;
    }
    if ((row->type != WB_SETTING_NUMBER && row->type != WB_SETTING_INTEGER) || !has_range(row))
        return WB_OK;
    /* Compares in SI: a value at the end of the range was multiplied by the same scale when it was
     * read. */
    const double scale = scale_of(row);
    const double value =
        row->type == WB_SETTING_NUMBER ? *(const double *)field : *(const int *)field;
    if ((has_default && value == row->fallback * scale) ||
        (value >= row->least * scale && value <= row->largest * scale))
        return WB_OK;
    char text[WB_NUMBER_TEXT], range[WB_SETTING_VALUE];
    wb_setting_range(row, range);
    return wb_fail_to(why, WB_ERR_ARGUMENT, "%s: %s is out of range, expected %s", row->name,
                      format_short(value / scale, text), range);
}

enum wb_status wb_setting_check_row(const struct wb_setting *row, const void *settings,
                                    struct wb_reason *why)
{
    return check_row(row, !row->required, settings, why);
}

enum wb_status wb_setting_check(const struct wb_setting_table *table, const void *settings,
                                struct wb_reason *why)
{
    for (size_t i = 0; i < table->n; i++)
        WB_TRY(wb_setting_check_row(&table->rows[i], settings, why));
    return WB_OK;
}

bool wb_setting_is_given(const struct wb_setting *row, const void *settings)
{
    const void *const field = look_at(row, settings);
    switch (row->type) {
    case WB_SETTING_NUMBER:
        return *(const double *)field != 0.0;
    case WB_SETTING_INTEGER:
    case WB_SETTING_CHOICE:
        return *(const int *)field != 0;
    case WB_SETTING_BOOLEAN:
        return *(const bool *)field;
    case WB_SETTING_TEXT:
        return row->size > 0 ? *(const char *)field != '\0' : *(const char *const *)field != NULL;
    case WB_SETTING_LIST:
        return *(const bool *)((const char *)settings + row->given);
    }
    return false;
}

bool wb_setting_differs(const struct wb_setting *row, const void *settings)
{
    if (row->type == WB_SETTING_TEXT || row->type == WB_SETTING_LIST)
        return wb_setting_is_given(row, settings);
    if (row->type == WB_SETTING_BOOLEAN)
        return wb_setting_is_given(row, settings) != (row->fallback != 0.0);
    if (row->type == WB_SETTING_NUMBER)
        return *(const double *)look_at(row, settings) != row->fallback * scale_of(row);
    return wb_setting_value(row, settings) != row->fallback;
}

/* NULL: a borrowed text that is not set. */
static const char *text_of(const struct wb_setting *row, const void *settings)
{
    const void *const field = look_at(row, settings);
    if (row->type == WB_SETTING_CHOICE)
        return row->choices[*(const int *)field];
    return row->size > 0 ? field : *(const char *const *)field;
}

static void format_list(const struct wb_setting *row, const void *members,
                        char text[WB_SETTING_VALUE])
{
    const struct wb_setting_table *const table = row->members;
    size_t n = 1;
    while (n < table->n && is_within(&table->rows[n], wb_setting_value(&table->rows[n], members)))
        n++;
    text[0] = '\0';
    for (size_t i = 0; i < (n < table->n ? 1 : n); i++) {
        const size_t used = strlen(text);
        const char between[] = {separator_of(row), '\0'};
        snprintf(text + used, WB_SETTING_VALUE - used, "%s%.10g", i > 0 ? between : "",
                 wb_setting_value(&table->rows[i], members));
    }
}

void wb_setting_format(const struct wb_setting *row, const void *settings,
                       char text[WB_SETTING_VALUE])
{
    text[0] = '\0';
    switch (row->type) {
    case WB_SETTING_NUMBER:
    case WB_SETTING_INTEGER:
        snprintf(text, WB_SETTING_VALUE, "%.10g", wb_setting_value(row, settings));
        break;
    case WB_SETTING_TEXT:
    case WB_SETTING_CHOICE:
        if (wb_setting_is_given(row, settings) || row->type == WB_SETTING_CHOICE)
            snprintf(text, WB_SETTING_VALUE, "%s", text_of(row, settings));
        break;
    case WB_SETTING_LIST:
        format_list(row, look_at(row, settings), text);
        break;
    case WB_SETTING_BOOLEAN:
        break;
    }
}

void wb_setting_set_json(const struct wb_setting *row, const void *settings, struct wb_json *object)
{
    const void *const field = look_at(row, settings);
    switch (row->type) {
    case WB_SETTING_NUMBER:
        wb_json_set_number(object, row->name, wb_setting_value(row, settings));
        break;
    case WB_SETTING_INTEGER:
        wb_json_set_integer(object, row->name, *(const int *)field);
        break;
    case WB_SETTING_BOOLEAN:
        wb_json_set_boolean(object, row->name, *(const bool *)field);
        break;
    case WB_SETTING_TEXT:
    case WB_SETTING_CHOICE:
        wb_json_set_text(object, row->name, text_of(row, settings));
        break;
    case WB_SETTING_LIST: {
        /* A single member is written without an object, as in files. */
        struct wb_json *const members =
            row->members->n > 1 ? wb_json_set_object(object, row->name) : object;
        for (size_t i = 0; i < row->members->n; i++)
            wb_setting_set_json(&row->members->rows[i], field, members);
        break;
    }
    }
}

/* --- in words --- */

void wb_setting_range(const struct wb_setting *row, char text[WB_SETTING_VALUE])
{
    char least[WB_NUMBER_TEXT], largest[WB_NUMBER_TEXT];
    text[0] = '\0';
    if (row->type == WB_SETTING_CHOICE)
        list_choices(row, text, WB_SETTING_VALUE);
    else if (row->type == WB_SETTING_LIST)
        wb_setting_range(&row->members->rows[0], text);
    else if (has_range(row))
        snprintf(text, WB_SETTING_VALUE, "%s to %s%s%s%s%s", format_short(row->least, least),
                 format_short(row->largest, largest), row->unit ? " " : "",
                 row->unit ? row->unit : "", row->zero ? " or " : "", row->zero ? row->zero : "");
}

void wb_setting_default(const struct wb_setting *row, const char *otherwise,
                        char text[WB_SETTING_VALUE])
{
    char number[WB_NUMBER_TEXT];
    text[0] = '\0';
    if (row->type == WB_SETTING_BOOLEAN || (row->required && !otherwise))
        return;
    if (otherwise || row->otherwise)
        snprintf(text, WB_SETTING_VALUE, "%s", otherwise ? otherwise : row->otherwise);
    else if (row->type == WB_SETTING_CHOICE)
        snprintf(text, WB_SETTING_VALUE, "%s", row->choices[(int)row->fallback]);
    else if (row->type == WB_SETTING_NUMBER || row->type == WB_SETTING_INTEGER)
        snprintf(text, WB_SETTING_VALUE, "%s", format_short(row->fallback, number));
}

void wb_setting_describe(const struct wb_setting *row, const char *otherwise, struct wb_text *text)
{
    char range[WB_SETTING_VALUE], fallback[WB_SETTING_VALUE];
    wb_setting_range(row, range);
    wb_setting_default(row, otherwise, fallback);
    wb_text_append(text, "%s%s%s", row->help, range[0] ? ": " : "", range);
    if (fallback[0])
        wb_text_append(text, " (%s)", fallback);
}
