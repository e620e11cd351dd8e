/* Tables of numbers that other programs wrote: text files of any encoding, delimiter and decimal
 * sign, with or without a header, read without being told how they are written.
 *
 *     struct wb_text_table table;
 *     WB_TRY(wb_text_table_parse(&table, bytes, size, "curve.txt", NULL, NULL));
 *     for (size_t row = 0; row < table.n_rows; row++)
 *         if (wb_text_table_number(&table, row, 1, &value) == WB_FIELD_NUMBER)
 *             ...
 *     wb_text_table_release(&table);
 *
 * Encodings: UTF-8, UTF-16 in either order, each with or without byte order mark, and Latin-1 where
 * the bytes are no UTF-8. Line ends: LF, CR LF, CR, and CR CR LF as one. Delimiters: tab,
 * semicolon, bar, comma, blanks. Fields may stand in double quotes. What stands above the header is
 * left aside. A table is refused, with line and column, where it cannot be understood in one way
 * only: both decimal signs, commas that may be those of thousands, a row with more fields than
 * columns, bytes that are no text. Fields that are no numbers are left as they are: what a column
 * is for decides whether they matter.
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

/* What is known beforehand; all zero: nothing. */
struct wb_text_table_form {
    char delimiter; /* '\t', ';', '|', ',' or ' ' (blanks) */
    char decimal;   /* '.' or ',' */
};

enum wb_text_field {
    WB_FIELD_NUMBER,
    WB_FIELD_EMPTY, /* nothing, or a word for it: NaN, n/a, --- */
    WB_FIELD_TEXT
};

struct wb_text_table_column {
    const char *name; /* the header's text, without quotes; "" without a header; owned by the table
                       */
    const char *unit; /* of a line of units below the header; "" else */
};

struct wb_text_table {
    enum wb_text_encoding encoding;
    bool byte_order_mark;
    char delimiter, decimal;
    int n_lines;           /* of the file */
    int header_line;       /* from 1; 0: none */
    int n_columns;         /* of the header, or most rows */
    bool ends_without_end; /* the last line has no line end: it may have been cut */
    bool cut;              /* the last bytes are no whole character, or the last line, which has
                              no end, lacks fields */
    size_t n_empty_lines;  /* below the first of the header and the rows: nothing but delimiters */
    size_t n_rows;
    struct wb_text_table_column *columns; /* (n_columns) */
    char **fields;                        /* (n_rows, n_columns); NULL: the line is shorter */
    int *lines;                           /* (n_rows), from 1 */
    char *text;
};

/* Parses the bytes of a file, whose name is for messages. `form` may be NULL. WB_ERR_FORMAT, with
 * line and column, where they are not understood, also bytes that are no text (control characters,
 * halves of UTF-16 pairs) and a table without a row of numbers. The messages go to `why`, or to the
 * log where that is NULL. */
WB_MUST_CHECK enum wb_status wb_text_table_parse(struct wb_text_table *table, const void *bytes,
                                                 size_t size, const char *name,
                                                 const struct wb_text_table_form *form,
                                                 struct wb_reason *why);
void wb_text_table_release(struct wb_text_table *table); /* accepts a zeroed one */

/* What stands in a field; *value is set where it is a number. Columns count from 0. */
enum wb_text_field wb_text_table_number(const struct wb_text_table *table, size_t row, int column,
                                        double *value);

/* Refuses a field: "FILE:LINE: column 2 'Load (N)': MESSAGE, not 'TEXT'". */
enum wb_status wb_text_table_refuse(const struct wb_text_table *table, const char *name, size_t row,
                                    int column, const char *message, struct wb_reason *why);

#endif
