/* Lines and cells of large tables as text, without copies: for exports of 100 MB, read in a second.
 * Small tables of unknown make are for base/text_table.h. */
#ifndef WB_DAQ_PROTOCOL_CELLS_H
#define WB_DAQ_PROTOCOL_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A text, line by line. Line ends are LF, CR, CR LF and CR CR LF; a byte order mark is left out. */
struct wb_cells_lines {
    const char *at, *end;
    const char *lf;  /* the next LF, or `end` */
    size_t number;   /* of the line last given, from 1 */
    bool terminated; /* that line had an end. The last of a file that was cut off has none: what it
                        holds may be part of a number */
    char *converted; /* owned: of UTF-16 text */
};

/* Begins. UTF-16 in either order becomes bytes, characters beyond ASCII '?'. */
void wb_cells_lines_begin(struct wb_cells_lines *lines, const uint8_t *bytes, size_t n);
/* The next line without its end; false at the end of the text. */
bool wb_cells_lines_next(struct wb_cells_lines *lines, const char **line, size_t *n);
void wb_cells_lines_release(struct wb_cells_lines *lines);

/* A line's cells. */
struct wb_cells {
    const char *at, *end; /* at is NULL after the last */
    char delimiter;       /* ' ': any number of blanks and tabs */
    size_t column;        /* of the cell last given, from 1 */
};

void wb_cells_begin(struct wb_cells *cells, const char *line, size_t n, char delimiter);
/* The next cell without blanks and quotes around it; false after the last. */
bool wb_cells_next(struct wb_cells *cells, const char **cell, size_t *n);
/* Whether the line has nothing but delimiters and blanks. */
bool wb_cells_blank(const char *line, size_t n, char delimiter);

/* Compares without regard to case. */
bool wb_cells_equal(const char *cell, size_t n, const char *word);
bool wb_cells_begins(const char *cell, size_t n, const char *word);

/* A decimal number that is the whole cell, with '.' or `comma` (0: none) before its decimals. Reads
 * the same double as strtod(). */
bool wb_cells_number(const char *cell, size_t n, char comma, double *value);

#endif
