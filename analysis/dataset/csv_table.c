#include "analysis/dataset/csv_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/dataset/csv_table_private.h"
#include "base/file.h"
#include "base/number.h"

#define WB_LOG_DOMAIN "table"

/* Length limit of a field that is parsed as a number; numbers need far fewer characters. */
#define FIELD 64

/* --- numbers --- */

void wb_csv_table_format_number(double value, int shift, char *text)
{
    /* Shortest "d.ddde+xx" that reads back the same, then the exponent is changed by `shift`. */
    char scientific[WB_CSV_TABLE_NUMBER];
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
        snprintf(text, WB_CSV_TABLE_NUMBER, "%s%c%s%se%d", sign, mantissa[0], n > 1 ? "." : "",
                 mantissa + 1, exponent);
    else if (exponent < 0)
        snprintf(text, WB_CSV_TABLE_NUMBER, "%s0.%.*s%s", sign, -exponent - 1, "0000000", mantissa);
    else if (n <= exponent + 1)
        snprintf(text, WB_CSV_TABLE_NUMBER, "%s%s%.*s", sign, mantissa, exponent + 1 - n,
                 "0000000000000000");
    else
        snprintf(text, WB_CSV_TABLE_NUMBER, "%s%.*s.%s", sign, exponent + 1, mantissa,
                 mantissa + exponent + 1);
}

void wb_csv_table_append_number(struct wb_text *text, double value, int shift)
{
    char number[WB_CSV_TABLE_NUMBER] = "";
    if (isfinite(value))
        wb_csv_table_format_number(value, shift, number);
    wb_text_append_bytes(text, number, strlen(number));
}

bool wb_csv_table_parse_number(const char *text, int shift, double *value)
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

enum wb_status wb_csv_table_refuse(const struct wb_csv_table *table, int column,
                                   const char *expected, const char *text)
{
    return wb_csv_table_fail(table, "%s: expected %s, not '%.40s'", table->columns[column],
                             expected, text);
}

enum wb_status wb_csv_table_integer(const struct wb_csv_table *table, int column,
                                    char *const *fields, int most, int *value)
{
    long number;
    char expected[64];
    if (wb_number_parse_integer(fields[column], &number) && number >= 0 && number <= most) {
        *value = (int)number;
        return WB_OK;
    }
    snprintf(expected, sizeof expected, "a whole number from 0 to %d", most);
    return wb_csv_table_refuse(table, column, expected, fields[column]);
}

char *wb_csv_table_line(struct wb_csv_table *table, char **text)
{
    if (!*text || **text == '\0')
        return NULL;
    char *const line = strsep(text, "\n");
    const size_t length = strlen(line);
    if (length > 0 && line[length - 1] == '\r')
        line[length - 1] = '\0';
    table->line++;
    return line;
}

static enum wb_status split(const struct wb_csv_table *table, char *line, char **fields)
{
    int n = 0;
    for (char *next = line; next;) {
        char *const field = strsep(&next, ",");
        if (n < table->n_columns)
            fields[n] = field;
        n++;
    }
    if (n != table->n_columns)
        return wb_csv_table_fail(table, "%d fields, expected %d", n, table->n_columns);
    return WB_OK;
}

static enum wb_status check_header(const struct wb_csv_table *table, char *const *fields)
{
    for (int i = 0; i < table->n_columns; i++)
        if (strcmp(fields[i], table->columns[i]) != 0)
            return wb_csv_table_fail(table, "expected column '%s', not '%.40s'", table->columns[i],
                                     fields[i]);
    return WB_OK;
}

enum wb_status wb_csv_table_parse(struct wb_csv_table *table, char *text, size_t size)
{
    if (table->n_columns > WB_CSV_TABLE_MOST)
        return wb_fail_to(table->why, WB_ERR_ARGUMENT, "%s: a table of %d columns, at most %d",
                          table->path, table->n_columns, WB_CSV_TABLE_MOST);
    if (memchr(text, '\0', size))
        return wb_fail_to(table->why, WB_ERR_FORMAT, "%s: a byte 0: not a text file", table->path);
    if (size == 0)
        return wb_fail_to(table->why, WB_ERR_FORMAT,
                          "%s:1: empty file, expected a line of column names", table->path);
    for (char *line; (line = wb_csv_table_line(table, &text));) {
        char *fields[WB_CSV_TABLE_MOST];
        WB_TRY(split(table, line, fields));
        WB_TRY(table->line == 1 ? check_header(table, fields)
                                : table->take(table->context, table, fields));
    }
    return table->finish ? table->finish(table->context, table) : WB_OK;
}

enum wb_status wb_csv_table_read(struct wb_csv_table *table, const char *folder, const char *name)
{
    char path[WB_PATH];
    char *text;
    size_t size;
    WB_TRY(wb_file_join(path, folder, name));
    if (!wb_file_exists(path))
        return WB_OK;
    WB_TRY(wb_file_read_with_reason(path, &text, &size, table->why));
    table->path = path;
    const enum wb_status status = wb_csv_table_parse(table, text, size);
    table->path = NULL;
    free(text);
    return status;
}

void wb_csv_table_append_header(struct wb_text *text, const char *const *columns, int n)
{
    for (int i = 0; i < n; i++)
        wb_text_append(text, "%s%s", i == 0 ? "" : ",", columns[i]);
    wb_text_append(text, "\n");
}

enum wb_status wb_csv_table_write(const char *folder, const char *name, const struct wb_text *text)
{
    char path[WB_PATH];
    WB_TRY(wb_file_join(path, folder, name));
    if (text)
        return wb_file_write_text(path, text);
    if (unlink(path) != 0 && errno != ENOENT)
        return wb_fail(WB_ERR_IO, "cannot remove '%s': %s", path, strerror(errno));
    return WB_OK;
}
