/* Tables of numbers written by other programs: text files with any encoding, delimiter and decimal
 * sign, with or without a header. The format is detected.
 *
 *     struct wb_text_table table;
 *     WB_TRY(wb_text_table_parse(&table, bytes, size, "curve.txt", NULL, NULL));
 *     for (size_t row = 0; row < table.n_rows; row++)
 *         if (wb_text_table_number(&table, row, 1, &value) == WB_FIELD_NUMBER)
 *             ...
 *     wb_text_table_release(&table);
 *
 * Encodings: UTF-8, UTF-16 in either byte order, each with or without byte order mark, and Latin-1
 * if the bytes are not valid UTF-8. Line ends: LF, CR LF, CR, and CR CR LF as one. Delimiters: tab,
 * semicolon, bar, comma, blanks. Fields may be in double quotes. Lines above the header are
 * ignored. A table that is ambiguous is rejected, with line and column: both decimal signs, commas
 * that may be thousands separators, a row with more fields than columns, bytes that are not text.
 * Fields that are not numbers are kept: the use of a column decides whether they matter.
 */
#ifndef WB_BASE_TEXT_TABLE_H
#define WB_BASE_TEXT_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "base/reason.h"

enum wb_text_encoding {
    WB_ENCODING_UTF8,
    WB_ENCODING_UTF16_LE,
    WB_ENCODING_UTF16_BE,
    WB_ENCODING_LATIN1
};

/* "UTF-8", "UTF-16 little endian", ... */
const char *wb_text_encoding_name(enum wb_text_encoding encoding);

/* Known properties of the format; zero: detect it. */
struct wb_text_table_form {
    char delimiter; /* '\t', ';', '|', ',' or ' ' (blanks) */
    char decimal;   /* '.' or ',' */
};

enum wb_text_field {
    WB_FIELD_NUMBER,
    WB_FIELD_EMPTY, /* empty, or a word for it: NaN, n/a, --- */
    WB_FIELD_TEXT
};

struct wb_text_table_column {
    /* The header's text, without quotes; "" without a header; owned by the table. */
    const char *name;
    const char *unit; /* from a line of units below the header; otherwise "" */
};

struct wb_text_table {
    enum wb_text_encoding encoding;
    bool byte_order_mark;
    char delimiter, decimal;
    int n_lines;           /* of the file */
    int header_line;       /* from 1; 0: no header */
    int n_columns;         /* of the header, or of most rows */
    bool ends_without_end; /* the last line has no line end: it may be incomplete */
    bool cut; /* the file ends within a character, or the last line has no line end and too few
                 fields */
    size_t n_empty_lines; /* below the first line of the header or the rows: lines with delimiters
                             only */
    size_t n_rows;
    struct wb_text_table_column *columns; /* (n_columns) */
    char **fields;                        /* (n_rows, n_columns); NULL: the line is shorter */
    int *lines;                           /* (n_rows), from 1 */
    char *text;
};

/* Parses the bytes of a file, whose name is for messages. `form` may be NULL. WB_ERR_FORMAT, with
 * line and column, if the table is ambiguous, has bytes that are not text (control characters,
 * halves of UTF-16 pairs) or no row of numbers. Messages go to `why`, or to the log if it is
 * NULL. */
WB_MUST_CHECK enum wb_status wb_text_table_parse(struct wb_text_table *table, const void *bytes,
                                                 size_t size, const char *name,
                                                 const struct wb_text_table_form *form,
                                                 struct wb_reason *why);
void wb_text_table_release(struct wb_text_table *table); /* accepts a zeroed one */

/* Kind of a field; *value is set if it is a number. Columns count from 0. */
enum wb_text_field wb_text_table_number(const struct wb_text_table *table, size_t row, int column,
                                        double *value);

/* Rejects a field: "FILE:LINE: column 2 'Load (N)': MESSAGE, not 'TEXT'". */
enum wb_status wb_text_table_reject(const struct wb_text_table *table, const char *name, size_t row,
                                    int column, const char *message, struct wb_reason *why);

#endif
