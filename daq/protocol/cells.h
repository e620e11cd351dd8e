/* Reads lines and cells of large text tables without copying them: 100 MB per second. For small
 * tables of unknown layout use base/text_table.h. */
#ifndef WB_DAQ_PROTOCOL_CELLS_H
#define WB_DAQ_PROTOCOL_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A line or a cell: part of a text, without a NUL at its end. */
struct wb_span {
    const char *text;
    size_t n;
};

/* A text, read line by line. Line ends are LF, CR, CR LF and CR CR LF; a byte order mark is
 * skipped. */
struct wb_cells_lines {
    const char *at, *end;
    const char *lf;  /* the next LF, or `end` */
    size_t number;   /* of the last line returned, from 1 */
    bool terminated; /* that line had a line end; without one it may be truncated within a number */
    char *converted; /* owned: UTF-16 text as bytes */
};

/* Begins to read. UTF-16 is converted to bytes; characters beyond ASCII become '?'. */
void wb_cells_lines_begin(struct wb_cells_lines *lines, const uint8_t *bytes, size_t n);
/* The next line without its end; false at the end of the text. */
bool wb_cells_lines_next(struct wb_cells_lines *lines, struct wb_span *line);
void wb_cells_lines_release(struct wb_cells_lines *lines);

/* The cells of a line. */
struct wb_cells {
    const char *at, *end; /* `at` is NULL after the last cell */
    char delimiter;       /* ' ': any number of blanks and tabs */
    size_t column;        /* of the last cell returned, from 1 */
};

void wb_cells_begin(struct wb_cells *cells, struct wb_span line, char delimiter);
/* The next cell without blanks and quotes around it; false after the last. */
bool wb_cells_next(struct wb_cells *cells, struct wb_span *cell);
/* Whether the line contains only delimiters and blanks. */
bool wb_cells_blank(struct wb_span line, char delimiter);

/* Case-insensitive comparison with a word, and with the beginning of the cell. */
bool wb_cells_equal(struct wb_span cell, const char *word);
bool wb_cells_begins(struct wb_span cell, const char *word);

/* A text without the white space around it; at its end, NULs are white space too. */
struct wb_span wb_cells_strip(struct wb_span text);

/* Whether a word is one of `words`, which blanks separate. */
bool wb_cells_lists(const char *words, const char *word);

/* Reads a cell that is a decimal number with '.' or `comma` (0: none) as decimal sign. Gives the
 * same double as strtod(). False if the cell is not a number. */
bool wb_cells_number(struct wb_span cell, char comma, double *value);

#endif
