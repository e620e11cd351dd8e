#include "analysis/dataset_csv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"

#define WB_LOG_DOMAIN "dataset"

/* Longest field that is taken; a number needs far less. */
#define FIELD 64
#define MAX_COLUMNS 64

/* --- numbers --- */

void wb_dataset_csv_format_number(double value, int shift, char *text)
{
    /* Shortest "d.ddde+xx" that reads back the same, then the exponent is changed by `shift`. */
    char scientific[WB_DATASET_CSV_NUMBER];
    int digits = 0;
    do {
        snprintf(scientific, sizeof scientific, "%.*e", digits, value);
    } while (digits++ < 17 && strtod(scientific, NULL) != value);
    char *const mark = strchr(scientific, 'e');
    const int exponent = value == 0.0 ? 0 : atoi(mark + 1) + shift;
    *mark = '\0';

    const char *const sign = scientific[0] == '-' ? "-" : "";
    char mantissa[20];
    int n = 0;
    for (const char *c = scientific; *c && n < (int)sizeof mantissa - 1; c++) {
        if (*c >= '0' && *c <= '9')
            mantissa[n++] = *c;
    }
    while (n > 1 && mantissa[n - 1] == '0')
        n--;
    mantissa[n] = '\0';
    if (exponent < -7 || exponent > 15)
        snprintf(text, WB_DATASET_CSV_NUMBER, "%s%c%s%se%d", sign, mantissa[0], n > 1 ? "." : "",
                 mantissa + 1, exponent);
    else if (exponent < 0)
        snprintf(text, WB_DATASET_CSV_NUMBER, "%s0.%.*s%s", sign, -exponent - 1, "0000000",
                 mantissa);
    else if (n <= exponent + 1)
        snprintf(text, WB_DATASET_CSV_NUMBER, "%s%s%.*s", sign, mantissa, exponent + 1 - n,
                 "0000000000000000");
    else
        snprintf(text, WB_DATASET_CSV_NUMBER, "%s%.*s.%s", sign, exponent + 1, mantissa,
                 mantissa + exponent + 1);
}

bool wb_dataset_csv_parse_number(const char *text, int shift, double *value)
{
    double plain;
    char shifted[FIELD + 16];
    if (!wb_number_parse(text, &plain) || strlen(text) >= FIELD)
        return false;
    const size_t mantissa = strcspn(text, "eE");
    long exponent = 0;
    if (text[mantissa] && !wb_number_parse_integer(text + mantissa + 1, &exponent))
        return false;
    if (labs(exponent) > 400)
        return false;
    snprintf(shifted, sizeof shifted, "%.*se%ld", (int)mantissa, text, exponent - shift);
    return wb_number_parse(shifted, value);
}

/* --- tables --- */

enum kind {
    KIND_NUMBER,   /* must be there */
    KIND_OPTIONAL, /* empty means not known; the whole column may be missing */
    KIND_EXTRA,    /* the same, and not written where every row has none or zero */
    KIND_INTEGER,
    KIND_PHASE
};

struct column {
    const char *name;
    enum kind kind;
    size_t offset; /* of the member */
    int shift;     /* decimal places from SI to the file's unit */
};

static const struct column row_columns[] = {
    {"t_s", KIND_NUMBER, offsetof(struct wb_row, t), 0},
    {"cycle", KIND_INTEGER, offsetof(struct wb_row, cycle), 0},
    {"phase", KIND_PHASE, offsetof(struct wb_row, phase), 0},
    {"deflection_mm", KIND_NUMBER, offsetof(struct wb_row, deflection), 3},
    {"tension_N", KIND_OPTIONAL, offsetof(struct wb_row, tension), 0},
    {"force_N", KIND_NUMBER, offsetof(struct wb_row, force), 0},
    {"stage_mm", KIND_OPTIONAL, offsetof(struct wb_row, stage), 3},
    {"tip_x_mm", KIND_OPTIONAL, offsetof(struct wb_row, tip_x), 3},
    {"tip_angle_rad", KIND_OPTIONAL, offsetof(struct wb_row, tip_angle), 0},
    {0},
};

static const struct column shape_columns[] = {
    {"t_s", KIND_NUMBER, offsetof(struct wb_shape_row, t), 0},
    {"deflection_mm", KIND_NUMBER, offsetof(struct wb_shape_row, deflection), 3},
    {"marker", KIND_INTEGER, offsetof(struct wb_shape_row, marker), 0},
    {"s_mm", KIND_NUMBER, offsetof(struct wb_shape_row, s), 3},
    {"x_mm", KIND_NUMBER, offsetof(struct wb_shape_row, x), 3},
    {"y_mm", KIND_NUMBER, offsetof(struct wb_shape_row, y), 3},
    {"z_mm", KIND_EXTRA, offsetof(struct wb_shape_row, z), 3},
    {0},
};

/* The members are doubles, ints or a phase: memcpy() serves all three without aliasing. */
static enum wb_status append_field(struct wb_text *text, const struct column *column,
                                   const void *row, size_t index)
{
    const char *const member = (const char *)row + column->offset;
    if (column->kind == KIND_INTEGER) {
        int value;
        memcpy(&value, member, sizeof value);
        wb_text_append(text, "%d", value);
    } else if (column->kind == KIND_PHASE) {
        enum wb_phase phase;
        memcpy(&phase, member, sizeof phase);
        wb_text_append(text, "%s", wb_trial_phase_name(phase));
    } else {
        char number[WB_DATASET_CSV_NUMBER];
        double value;
        memcpy(&value, member, sizeof value);
        if (isfinite(value)) {
            wb_dataset_csv_format_number(value, column->shift, number);
            wb_text_append_bytes(text, number, strlen(number));
        } else if (column->kind == KIND_NUMBER) {
            return wb_fail(WB_ERR_ARGUMENT, "row %zu of a dataset has no %s", index + 1,
                           column->name);
        }
    }
    return WB_OK;
}

/* An extra column comes last in its table, so leaving it out ends the columns. */
static bool is_written(const struct column *column, const void *rows, size_t n, size_t row_size)
{
    if (!column->name || column->kind != KIND_EXTRA)
        return column->name != NULL;
    for (size_t i = 0; i < n; i++) {
        double value;
        memcpy(&value, (const char *)rows + i * row_size + column->offset, sizeof value);
        if (isfinite(value) && value != 0.0)
            return true;
    }
    return false;
}

static enum wb_status append_table(struct wb_text *text, const struct column *columns,
                                   const void *rows, size_t n, size_t row_size)
{
    const struct column *end = columns;
    for (; is_written(end, rows, n, row_size); end++)
        wb_text_append(text, "%s%s", end == columns ? "" : ",", end->name);
    wb_text_append_bytes(text, "\n", 1);
    for (size_t i = 0; i < n; i++) {
        const void *const row = (const char *)rows + i * row_size;
        for (const struct column *column = columns; column < end; column++) {
            if (column != columns)
                wb_text_append_bytes(text, ",", 1);
            WB_TRY(append_field(text, column, row, i));
        }
        wb_text_append_bytes(text, "\n", 1);
    }
    if (text->failed)
        return wb_fail(WB_ERR_MEMORY, "out of memory writing a dataset of %zu rows", n);
    return WB_OK;
}

enum wb_status wb_dataset_csv_format(const struct wb_dataset *dataset, struct wb_text *rows,
                                     struct wb_text *shapes)
{
    if (dataset->info.is_virtual) {
        wb_text_append(rows, "# virtual rig\n");
        wb_text_append(shapes, "# virtual rig\n");
    }
    WB_TRY(append_table(rows, row_columns, dataset->rows, dataset->n_rows, sizeof *dataset->rows));
    return append_table(shapes, shape_columns, dataset->shape_rows, dataset->n_shape_rows,
                        sizeof *dataset->shape_rows);
}

/* --- reading --- */

/* A table while it is read: the lines, and which of our columns each field is. */
struct reader {
    const char *path;
    char *next, *end;
    int line;
    int n_fields;
    const struct column *fields[MAX_COLUMNS]; /* NULL: a column we do not know */
};

/* The next line without its end, terminated in place; NULL at the end of the text. */
static char *next_line(struct reader *reader)
{
    if (reader->next >= reader->end)
        return NULL;
    char *const line = reader->next;
    char *const newline = memchr(line, '\n', (size_t)(reader->end - line));
    char *stop = newline ? newline : reader->end;
    reader->next = newline ? newline + 1 : reader->end;
    if (stop > line && stop[-1] == '\r')
        stop--;
    *stop = '\0';
    reader->line++;
    return line;
}

/* Cuts the next field off a line; *rest is NULL after the last. */
static char *next_field(char **rest)
{
    char *const field = *rest;
    char *const comma = strchr(field, ',');
    if (comma)
        *comma = '\0';
    *rest = comma ? comma + 1 : NULL;
    return field;
}

static const struct column *find_column(const struct column *columns, const char *name)
{
    for (const struct column *column = columns; column->name; column++) {
        if (strcmp(column->name, name) == 0)
            return column;
    }
    return NULL;
}

static enum wb_status check_columns(const struct reader *reader, const struct column *columns)
{
    for (const struct column *column = columns; column->name; column++) {
        int count = 0;
        for (int i = 0; i < reader->n_fields; i++)
            count += reader->fields[i] == column;
        if (count == 0 && column->kind != KIND_OPTIONAL && column->kind != KIND_EXTRA)
            return wb_fail(WB_ERR_FORMAT, "%s:%d: no column '%s'", reader->path, reader->line,
                           column->name);
        if (count > 1)
            return wb_fail(WB_ERR_FORMAT, "%s:%d: column '%s' stands there twice", reader->path,
                           reader->line, column->name);
    }
    return WB_OK;
}

static enum wb_status read_header(struct reader *reader, const struct column *columns)
{
    char *rest = next_line(reader);
    while (rest && *rest == '#')
        rest = next_line(reader);
    if (!rest)
        return wb_fail(WB_ERR_FORMAT, "%s:%d: empty file, expected a line of column names",
                       reader->path, reader->line + 1);
    while (rest) {
        const char *const name = next_field(&rest);
        if (reader->n_fields == MAX_COLUMNS)
            return wb_fail(WB_ERR_FORMAT, "%s:%d: more than %d columns", reader->path, reader->line,
                           MAX_COLUMNS);
        reader->fields[reader->n_fields++] = find_column(columns, name);
    }
    return check_columns(reader, columns);
}

static bool parse_phase(const char *text, enum wb_phase *phase)
{
    for (int i = WB_PHASE_LOAD; i <= WB_PHASE_SLACK; i++) {
        if (strcmp(text, wb_trial_phase_name((enum wb_phase)i)) == 0) {
            *phase = (enum wb_phase)i;
            return true;
        }
    }
    return false;
}

static enum wb_status parse_field(const struct reader *reader, const struct column *column,
                                  const char *text, void *row)
{
    char *const member = (char *)row + column->offset;
    const char *expected = "a number";
    if (column->kind == KIND_INTEGER) {
        long value;
        if (wb_number_parse_integer(text, &value) && value >= 0 && value <= 1000000) {
            const int integer = (int)value;
            memcpy(member, &integer, sizeof integer);
            return WB_OK;
        }
        expected = "a whole number from 0 to 1000000";
    } else if (column->kind == KIND_PHASE) {
        enum wb_phase phase;
        if (parse_phase(text, &phase)) {
            memcpy(member, &phase, sizeof phase);
            return WB_OK;
        }
        expected = "load, unload or slack";
    } else {
        double value = (double)NAN;
        const bool may_lack = column->kind == KIND_OPTIONAL || column->kind == KIND_EXTRA;
        if ((may_lack && *text == '\0') ||
            wb_dataset_csv_parse_number(text, column->shift, &value)) {
            memcpy(member, &value, sizeof value);
            return WB_OK;
        }
    }
    return wb_fail(WB_ERR_FORMAT, "%s:%d: %s: expected %s, not '%.40s'", reader->path, reader->line,
                   column->name, expected, text);
}

static enum wb_status parse_line(const struct reader *reader, char *line, void *row)
{
    char *rest = line;
    for (int i = 0; i < reader->n_fields; i++) {
        if (!rest)
            return wb_fail(WB_ERR_FORMAT, "%s:%d: %d fields, expected %d", reader->path,
                           reader->line, i, reader->n_fields);
        const char *const field = next_field(&rest);
        if (reader->fields[i])
            WB_TRY(parse_field(reader, reader->fields[i], field, row));
    }
    if (rest)
        return wb_fail(WB_ERR_FORMAT, "%s:%d: more than %d fields", reader->path, reader->line,
                       reader->n_fields);
    return WB_OK;
}

static enum wb_status start_reading(struct reader *reader, const char *path, char *text, size_t n,
                                    const struct column *columns)
{
    *reader = (struct reader){.path = path, .next = text, .end = text + n};
    const char *const zero = memchr(text, '\0', n);
    if (zero)
        return wb_fail(WB_ERR_FORMAT, "%s: byte 0 at offset %td: not a text file", path,
                       zero - text);
    return read_header(reader, columns);
}

enum wb_status wb_dataset_csv_parse_rows(struct wb_dataset *dataset, const char *path, char *text,
                                         size_t n)
{
    struct reader reader;
    char *line;
    WB_TRY(start_reading(&reader, path, text, n, row_columns));
    while ((line = next_line(&reader))) {
        struct wb_row row = {.tension = (double)NAN,
                             .stage = (double)NAN,
                             .tip_x = (double)NAN,
                             .tip_angle = (double)NAN};
        WB_TRY(parse_line(&reader, line, &row));
        WB_TRY(wb_dataset_add_row(dataset, &row));
    }
    return WB_OK;
}

enum wb_status wb_dataset_csv_parse_shapes(struct wb_dataset *dataset, const char *path, char *text,
                                           size_t n)
{
    struct reader reader;
    char *line;
    WB_TRY(start_reading(&reader, path, text, n, shape_columns));
    while ((line = next_line(&reader))) {
        struct wb_shape_row row = {.z = (double)NAN};
        WB_TRY(parse_line(&reader, line, &row));
        WB_TRY(wb_dataset_add_shape_row(dataset, &row));
    }
    return WB_OK;
}
