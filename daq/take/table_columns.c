#include "daq/take/table_columns.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "daq/protocol/loadcell_line.h"

#define WB_LOG_DOMAIN "columns"

static const char *const measured_names[] = {"time", "force", "travel", "strain"};

const char *wb_table_columns_name(enum wb_measured measured)
{
    return measured_names[measured];
}

/* --- units --- */

struct unit {
    enum wb_measured measured;
    const char *name;
    double factor;
};

static const struct unit units[] = {
    {WB_MEASURED_TIME, "s", 1.0},         {WB_MEASURED_TIME, "sec", 1.0},
    {WB_MEASURED_TIME, "secs", 1.0},      {WB_MEASURED_TIME, "Sec", 1.0},
    {WB_MEASURED_TIME, "second", 1.0},    {WB_MEASURED_TIME, "seconds", 1.0},
    {WB_MEASURED_TIME, "Sekunden", 1.0},  {WB_MEASURED_TIME, "ms", 1e-3},
    {WB_MEASURED_TIME, "us", 1e-6},       {WB_MEASURED_TIME, "min", 60.0},
    {WB_MEASURED_TIME, "h", 3600.0},      {WB_MEASURED_FORCE, "daN", 10.0},
    {WB_MEASURED_FORCE, "cN", 1e-2},      {WB_MEASURED_FORCE, "MN", 1e6},
    {WB_MEASURED_FORCE, "cn", 1e-2},      {WB_MEASURED_TRAVEL, "mm", WB_MM},
    {WB_MEASURED_TRAVEL, "cm", 1e-2},     {WB_MEASURED_TRAVEL, "m", 1.0},
    {WB_MEASURED_TRAVEL, "um", 1e-6},     {WB_MEASURED_TRAVEL, "in", 0.0254},
    {WB_MEASURED_TRAVEL, "inch", 0.0254}, {WB_MEASURED_TRAVEL, "mil", 2.54e-5},
    {WB_MEASURED_STRAIN, "%", 1e-2},      {WB_MEASURED_STRAIN, "mm/mm", 1.0},
    {WB_MEASURED_STRAIN, "m/m", 1.0},     {WB_MEASURED_STRAIN, "1", 1.0},
    {WB_MEASURED_STRAIN, "um/m", 1e-6},
};

/* Copies a unit; both characters for micro (U+00B5, U+03BC) become 'u'. */
static void plain_unit(char out[16], const char *text)
{
    size_t n = 0;
    while (*text && n < 15) {
        if (strncmp(text, "\xc2\xb5", 2) == 0 || strncmp(text, "\xce\xbc", 2) == 0) {
            out[n++] = 'u';
            text += 2;
        } else {
            out[n++] = *text++;
        }
    }
    out[n] = '\0';
}

static bool find_unit(const char *text, double gravity, enum wb_measured *measured, double *factor)
{
    for (size_t i = 0; i < WB_COUNT(units); i++) {
        if (strcmp(units[i].name, text) == 0) {
            *measured = units[i].measured;
            *factor = units[i].factor;
            return true;
        }
    }
    *measured = WB_MEASURED_FORCE;
    return wb_line_unit_factor(text, gravity, factor);
}

/* --- words of the header --- */

/* The header of a column: its words in lower case, each surrounded by blanks, and its unit. */
struct header {
    char words[160];
    char unit[16];
};

static void copy_unit(struct header *header, const char *from, size_t n)
{
    char text[32];
    while (n > 0 && isspace((unsigned char)*from)) {
        from++;
        n--;
    }
    while (n > 0 && isspace((unsigned char)from[n - 1]))
        n--;
    snprintf(text, sizeof text, "%.*s", (int)(n < 31 ? n : 31), from);
    plain_unit(header->unit, text);
}

/* Splits the unit off the end of a name: "Load (N)", "Load [N]", "Load / N", "Load in N", "load_N",
 * "Load, N". Returns the length of the rest. */
static size_t take_unit(struct header *header, const char *name)
{
    static const char *const before[] = {" in ", "/", ",", "_", ":"};
    const size_t n = strlen(name);
    enum wb_measured measured;
    double factor;
    if (n > 2 && (name[n - 1] == ')' || name[n - 1] == ']')) {
        const char open = name[n - 1] == ')' ? '(' : '[';
        const char *const at = strrchr(name, open);
        if (at) {
            copy_unit(header, at + 1, (size_t)(name + n - 1 - (at + 1)));
            return (size_t)(at - name);
        }
    }
    for (size_t i = 0; i < WB_COUNT(before); i++) {
        const char *last = NULL;
        for (const char *at = name; (at = strstr(at, before[i])); at++)
            last = at;
        if (!last)
            continue;
        const char *const unit = last + strlen(before[i]);
        copy_unit(header, unit, strlen(unit));
        if (find_unit(header->unit, WB_STANDARD_GRAVITY, &measured, &factor))
            return (size_t)(last - name);
        header->unit[0] = '\0';
    }
    return n;
}

static void read_header(struct header *header, const struct wb_text_table_column *column)
{
    header->unit[0] = '\0';
    size_t n = take_unit(header, column->name);
    if (column->unit[0]) {
        const size_t length = strlen(column->unit);
        const bool bracketed = length > 1 && (column->unit[0] == '(' || column->unit[0] == '[');
        copy_unit(header, column->unit + bracketed, length - 2 * (size_t)bracketed);
    }
    size_t k = 0;
    header->words[k++] = ' ';
    for (size_t i = 0; i < n && k < sizeof header->words - 3; i++) {
        const unsigned char c = (unsigned char)column->name[i];
        if (isalnum(c) || c >= 0x80)
            header->words[k++] = (char)tolower(c);
        else if (header->words[k - 1] != ' ')
            header->words[k++] = ' ';
    }
    if (header->words[k - 1] != ' ')
        header->words[k++] = ' ';
    header->words[k] = '\0';
}

struct word {
    enum wb_measured measured;
    const char *text;
    int points;
};

/* The word with the highest score decides. */
static const struct word words[] = {
    {WB_MEASURED_TIME, "time", 10},
    {WB_MEASURED_TIME, "zeit", 10},
    {WB_MEASURED_TIME,
     "pr\xc3\xbc"
     "fzeit",
     10},
    {WB_MEASURED_TIME, "temps", 10},
    {WB_MEASURED_TIME, "tempo", 10},
    {WB_MEASURED_TIME, "tiempo", 10},
    {WB_MEASURED_TIME, "elapsed", 9},
    {WB_MEASURED_TIME, "t", 8},
    {WB_MEASURED_FORCE, "load", 10},
    {WB_MEASURED_FORCE, "force", 10},
    {WB_MEASURED_FORCE, "kraft", 10},
    {WB_MEASURED_FORCE, "standardkraft", 10},
    {WB_MEASURED_FORCE,
     "pr\xc3\xbc"
     "fkraft",
     10},
    {WB_MEASURED_FORCE, "fuerza", 10},
    {WB_MEASURED_FORCE, "forza", 10},
    {WB_MEASURED_FORCE, "carga", 10},
    {WB_MEASURED_FORCE, "charge", 10},
    {WB_MEASURED_FORCE, "f", 8},
    {WB_MEASURED_TRAVEL, "travel", 10},
    {WB_MEASURED_TRAVEL, "extension", 10},
    {WB_MEASURED_TRAVEL, "elongation", 10},
    {WB_MEASURED_TRAVEL, "displacement", 10},
    {WB_MEASURED_TRAVEL, "deflection", 10},
    {WB_MEASURED_TRAVEL, "position", 10},
    {WB_MEASURED_TRAVEL, "stroke", 10},
    {WB_MEASURED_TRAVEL, "crosshead", 10},
    {WB_MEASURED_TRAVEL, "weg", 10},
    {WB_MEASURED_TRAVEL, "standardweg", 10},
    {WB_MEASURED_TRAVEL, "traversenweg", 10},
    {WB_MEASURED_TRAVEL, "durchbiegung", 10},
    {WB_MEASURED_TRAVEL, "desplazamiento", 10},
    {WB_MEASURED_TRAVEL,
     "d\xc3\xa9"
     "placement",
     10},
    {WB_MEASURED_STRAIN, "strain", 10},
    {WB_MEASURED_STRAIN, "dehnung", 10},
};

/* Added to the score: among several extensions, the machine's total is preferred to one counted
 * from a preload. */
static const struct word qualifiers[] = {
    {WB_MEASURED_TRAVEL, "machine", 5},
    {WB_MEASURED_TRAVEL, "crosshead", 5},
    {WB_MEASURED_TRAVEL, "preload", -5},
};

static bool has_word(const struct header *header, const char *word)
{
    char padded[40];
    snprintf(padded, sizeof padded, " %s ", word);
    return strstr(header->words, padded) != NULL;
}

/* Score of a column for the quantity `measured`; 0: not suitable. Its unit must be one of that
 * quantity or missing. */
static int score(const struct header *header, enum wb_measured measured, double gravity)
{
    enum wb_measured of_unit;
    double factor;
    int best = 0, more = 0;
    if (header->unit[0] &&
        !(find_unit(header->unit, gravity, &of_unit, &factor) && of_unit == measured))
        return 0;
    for (size_t i = 0; i < WB_COUNT(words); i++) {
        if (words[i].measured == measured && words[i].points > best &&
            has_word(header, words[i].text))
            best = words[i].points;
    }
    for (size_t i = 0; i < WB_COUNT(qualifiers); i++) {
        if (qualifiers[i].measured == measured && has_word(header, qualifiers[i].text))
            more += qualifiers[i].points;
    }
    return best > 0 ? best + more : 0;
}

/* --- messages --- */

/* Writes "1 'Time (s)', 2 'Load (N)'". */
static void list_columns(const struct wb_text_table *table, struct wb_text *text)
{
    if (table->header_line == 0) {
        wb_text_append(text, "%d without names", table->n_columns);
        return;
    }
    for (int k = 0; k < table->n_columns && k < 8; k++)
        wb_text_append(text, "%s%d '%.40s'", k > 0 ? ", " : "", k + 1, table->columns[k].name);
    if (table->n_columns > 8)
        wb_text_append(text, ", ...");
}

static enum wb_status reject(const struct wb_text_table *table, const char *name,
                             enum wb_status status, const char *message, struct wb_reason *why)
{
    struct wb_text columns = {0};
    list_columns(table, &columns);
    const enum wb_status refused =
        wb_fail_to(why, status, "%s:%d: %s; the columns are %s", name,
                   table->header_line ? table->header_line : 1, message, wb_text_string(&columns));
    wb_text_release(&columns);
    return refused;
}

/* --- search --- */

struct search {
    const struct wb_text_table *table;
    const char *name;
    double gravity;
    struct wb_reason *why;
};

static enum wb_status assign(struct wb_table_columns *columns, const struct search *search,
                             enum wb_measured measured, int column, const char *unit)
{
    enum wb_measured of_unit;
    char message[160];
    if (unit[0] == '\0') {
        snprintf(message, sizeof message,
                 "column %d has no unit: give it, as in --columns %s=%d:%s", column + 1,
                 measured_names[measured], column + 1,
                 measured == WB_MEASURED_TIME     ? "s"
                 : measured == WB_MEASURED_FORCE  ? "N"
                 : measured == WB_MEASURED_TRAVEL ? "mm"
                                                  : "%");
        return reject(search->table, search->name, WB_ERR_FORMAT, message, search->why);
    }
    plain_unit(columns->unit[measured], unit);
    if (!find_unit(columns->unit[measured], search->gravity, &of_unit,
                   &columns->factor[measured]) ||
        of_unit != measured) {
        snprintf(message, sizeof message, "the unit '%.15s' of column %d is not a unit of %s", unit,
                 column + 1, measured_names[measured]);
        return reject(search->table, search->name, WB_ERR_FORMAT, message, search->why);
    }
    columns->column[measured] = column;
    return WB_OK;
}

static enum wb_status find_by_header(struct wb_table_columns *columns, const struct search *search)
{
    for (int m = 0; m < WB_MEASURED_COUNT; m++) {
        int best = 0, at = -1, second = -1;
        char message[200];
        struct header header;
        for (int k = 0; k < search->table->n_columns; k++) {
            read_header(&header, &search->table->columns[k]);
            const int points = score(&header, (enum wb_measured)m, search->gravity);
            if (points > best) {
                best = points;
                at = k;
                second = -1;
            } else if (points == best && points > 0) {
                second = k;
            }
        }
        if (second >= 0) {
            snprintf(message, sizeof message,
                     "columns %d and %d could both be the %s: choose one, as in --columns %s=%d",
                     at + 1, second + 1, measured_names[m], measured_names[m], at + 1);
            return reject(search->table, search->name, WB_ERR_FORMAT, message, search->why);
        }
        if (at < 0)
            continue;
        read_header(&header, &search->table->columns[at]);
        WB_TRY(assign(columns, search, (enum wb_measured)m, at, header.unit));
    }
    return WB_OK;
}

/* Reads an entry of the list: "force=2:mN". */
static enum wb_status read_entry(struct wb_table_columns *columns, const struct search *search,
                                 char *entry)
{
    char message[160];
    long number;
    struct header header;
    char *const equals = strchr(entry, '=');
    char *const colon = equals ? strchr(equals, ':') : NULL;
    int measured = 0;
    if (colon)
        *colon = '\0';
    if (equals)
        *equals = '\0';
    while (measured < WB_MEASURED_COUNT && strcmp(measured_names[measured], entry) != 0)
        measured++;
    if (!equals || measured == WB_MEASURED_COUNT || !wb_number_parse_integer(equals + 1, &number) ||
        (colon && colon[1] == '\0'))
        return wb_fail_to(search->why, WB_ERR_ARGUMENT,
                          "list of columns: expected time, force, travel or strain with a column "
                          "number, as in time=1,force=2:mN,travel=3, not '%.40s'",
                          entry);
    if (number < 1 || number > search->table->n_columns) {
        snprintf(message, sizeof message, "%s=%ld: this column does not exist", entry, number);
        return reject(search->table, search->name, WB_ERR_ARGUMENT, message, search->why);
    }
    if (columns->column[measured] >= 0)
        return wb_fail_to(search->why, WB_ERR_ARGUMENT, "list of columns: %s is given twice",
                          entry);
    read_header(&header, &search->table->columns[number - 1]);
    return assign(columns, search, (enum wb_measured)measured, (int)number - 1,
                  colon ? colon + 1 : header.unit);
}

static enum wb_status find_by_list(struct wb_table_columns *columns, const struct search *search,
                                   const char *list)
{
    char copy[256], *rest = copy;
    if (strlen(list) >= sizeof copy)
        return wb_fail_to(search->why, WB_ERR_ARGUMENT, "list of columns: too long");
    strcpy(copy, list);
    for (char *entry; (entry = strsep(&rest, ","));)
        WB_TRY(read_entry(columns, search, entry));
    return WB_OK;
}

enum wb_status wb_table_columns_find(struct wb_table_columns *columns,
                                     const struct wb_text_table *table, const char *list,
                                     unsigned needed, double gravity, const char *name,
                                     struct wb_reason *why)
{
    const struct search search = {table, name, gravity, why};
    struct wb_table_columns found;
    memset(&found, 0, sizeof found);
    for (int m = 0; m < WB_MEASURED_COUNT; m++)
        found.column[m] = -1;
    if (list && *list)
        WB_TRY(find_by_list(&found, &search, list));
    else
        WB_TRY(find_by_header(&found, &search));
    for (int m = 0; m < WB_MEASURED_COUNT; m++) {
        char message[160];
        if (found.column[m] >= 0 || !(needed & WB_MEASURED_BIT(m)))
            continue;
        snprintf(message, sizeof message,
                 "no column of the %s was found: give it, as in --columns %s=1:%s",
                 measured_names[m], measured_names[m],
                 m == WB_MEASURED_FORCE    ? "N"
                 : m == WB_MEASURED_TRAVEL ? "mm"
                 : m == WB_MEASURED_TIME   ? "s"
                                           : "%");
        return reject(table, name, WB_ERR_FORMAT, message, why);
    }
    *columns = found;
    return WB_OK;
}

enum wb_status wb_table_columns_value(const struct wb_table_columns *columns,
                                      const struct wb_text_table *table, size_t row,
                                      enum wb_measured measured, double *value, const char *name,
                                      struct wb_reason *why)
{
    const int column = columns->column[measured];
    double read;
    *value = (double)NAN;
    if (column < 0)
        return WB_OK;
    switch (wb_text_table_number(table, row, column, &read)) {
    case WB_FIELD_NUMBER:
        *value = read * columns->factor[measured];
        return WB_OK;
    case WB_FIELD_EMPTY:
        return WB_OK;
    case WB_FIELD_TEXT:
        break;
    }
    return wb_text_table_reject(table, name, row, column, "expected a number", why);
}
