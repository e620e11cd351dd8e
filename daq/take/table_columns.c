#include "daq/take/table_columns.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/config.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"
#include "daq/protocol/cells.h"
#include "daq/protocol/loadcell_line.h"

#define WB_LOG_DOMAIN "columns"

static const char *const measured_names[] = {"time", "force", "travel", "strain"};
static const char *const usual_units[] = {"s", "N", "mm", "%"};

const char *wb_table_columns_name(enum wb_measured measured)
{
    return measured_names[measured];
}

/* --- units --- */

/* Units, by their names. Those of force are also the units of load cells. */
static const struct unit {
    enum wb_measured measured;
    const char *names;
    double factor;
} units[] = {
    {WB_MEASURED_TIME, "s sec secs Sec second seconds Sekunden", 1.0},
    {WB_MEASURED_TIME, "ms", 1e-3},
    {WB_MEASURED_TIME, "us", 1e-6},
    {WB_MEASURED_TIME, "min", 60.0},
    {WB_MEASURED_TIME, "h", 3600.0},
    {WB_MEASURED_FORCE, "daN", 10.0},
    {WB_MEASURED_FORCE, "cN cn", 1e-2},
    {WB_MEASURED_FORCE, "MN", 1e6},
    {WB_MEASURED_TRAVEL, "mm", WB_MM},
    {WB_MEASURED_TRAVEL, "cm", 1e-2},
    {WB_MEASURED_TRAVEL, "m", 1.0},
    {WB_MEASURED_TRAVEL, "um", 1e-6},
    {WB_MEASURED_TRAVEL, "in inch", 0.0254},
    {WB_MEASURED_TRAVEL, "mil", 2.54e-5},
    {WB_MEASURED_STRAIN, "%", 1e-2},
    {WB_MEASURED_STRAIN, "mm/mm m/m 1", 1.0},
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
        if (wb_cells_lists(units[i].names, text)) {
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
    const struct wb_span unit = wb_cells_strip((struct wb_span){from, n});
    char text[32];
    snprintf(text, sizeof text, "%.*s", (int)(unit.n < 31 ? unit.n : 31), unit.text);
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
    const char *texts;
    int points;
};

/* The word with the highest score decides. */
static const struct word words[] = {
    {WB_MEASURED_TIME,
     "time zeit pr\xc3\xbc"
     "fzeit temps tempo tiempo",
     10},
    {WB_MEASURED_TIME, "elapsed", 9},
    {WB_MEASURED_TIME, "t", 8},
    {WB_MEASURED_FORCE,
     "load force kraft standardkraft pr\xc3\xbc"
     "fkraft fuerza forza carga charge",
     10},
    {WB_MEASURED_FORCE, "f", 8},
    {WB_MEASURED_TRAVEL,
     "travel extension elongation displacement deflection position stroke crosshead weg "
     "standardweg traversenweg durchbiegung desplazamiento d\xc3\xa9"
     "placement",
     10},
    {WB_MEASURED_STRAIN, "strain dehnung", 10},
};

/* Added to the score: among several extensions, the machine's total is preferred to one counted
 * from a preload. */
static const struct word qualifiers[] = {
    {WB_MEASURED_TRAVEL, "machine", 5},
    {WB_MEASURED_TRAVEL, "crosshead", 5},
    {WB_MEASURED_TRAVEL, "preload", -5},
};

static bool has_word(const struct header *header, const struct word *word)
{
    char padded[40];
    for (const char *at = word->texts; *at; at += strspn(at, " ")) {
        const size_t n = strcspn(at, " ");
        snprintf(padded, sizeof padded, " %.*s ", (int)n, at);
        if (strstr(header->words, padded))
            return true;
        at += n;
    }
    return false;
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
        if (words[i].measured == measured && words[i].points > best && has_word(header, &words[i]))
            best = words[i].points;
    }
    for (size_t i = 0; i < WB_COUNT(qualifiers); i++) {
        if (qualifiers[i].measured == measured && has_word(header, &qualifiers[i]))
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

struct search {
    const struct wb_text_table *table;
    const char *name;
    double gravity;
    struct wb_reason *why;
};

static enum wb_status reject(const struct search *search, enum wb_status status, const char *format,
                             ...) __attribute__((format(printf, 3, 4)));

/* Fails with a message that ends in a list of the columns. */
static enum wb_status reject(const struct search *search, enum wb_status status, const char *format,
                             ...)
{
    const int line = search->table->header_line;
    char message[256];
    struct wb_text columns = {0};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    list_columns(search->table, &columns);
    (void)wb_fail_to(search->why, status, "%s:%d: %s; the columns are %s", search->name,
                     line ? line : 1, message, wb_text_string(&columns));
    wb_text_release(&columns);
    return status;
}

/* --- search --- */

static enum wb_status assign(struct wb_table_columns *columns, const struct search *search,
                             enum wb_measured measured, int column, const char *unit)
{
    const char *const name = measured_names[measured];
    enum wb_measured of_unit;
    if (unit[0] == '\0')
        return reject(search, WB_ERR_FORMAT,
                      "column %d has no unit: give it, as in --columns %s=%d:%s", column + 1, name,
                      column + 1, usual_units[measured]);
    plain_unit(columns->unit[measured], unit);
    if (!find_unit(columns->unit[measured], search->gravity, &of_unit,
                   &columns->factor[measured]) ||
        of_unit != measured)
        return reject(search, WB_ERR_FORMAT, "the unit '%.15s' of column %d is not a unit of %s",
                      unit, column + 1, name);
    columns->column[measured] = column;
    return WB_OK;
}

static enum wb_status find_by_header(struct wb_table_columns *columns, const struct search *search)
{
    for (int m = 0; m < WB_MEASURED_COUNT; m++) {
        int best = 0, at = -1, second = -1;
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
        if (second >= 0)
            return reject(search, WB_ERR_FORMAT,
                          "columns %d and %d could both be the %s: choose one, as in --columns "
                          "%s=%d",
                          at + 1, second + 1, measured_names[m], measured_names[m], at + 1);
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
    if (number < 1 || number > search->table->n_columns)
        return reject(search, WB_ERR_ARGUMENT, "%s=%ld: this column does not exist", entry, number);
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
    struct wb_table_columns found = {.column = {-1, -1, -1, -1}};
    if (list && *list)
        WB_TRY(find_by_list(&found, &search, list));
    else
        WB_TRY(find_by_header(&found, &search));
    for (int m = 0; m < WB_MEASURED_COUNT; m++)
        if (found.column[m] < 0 && needed & WB_MEASURED_BIT(m))
            return reject(&search, WB_ERR_FORMAT,
                          "no column of the %s was found: give it, as in --columns %s=1:%s",
                          measured_names[m], measured_names[m], usual_units[m]);
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
    const enum wb_text_field field = wb_text_table_number(table, row, column, &read);
    if (field == WB_FIELD_NUMBER)
        *value = read * columns->factor[measured];
    if (field != WB_FIELD_TEXT)
        return WB_OK;
    return wb_text_table_reject(table, name, row, column, "expected a number", why);
}
