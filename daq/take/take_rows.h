/* What the readers of text formats share: rows of cells, whose errors name line and column. */
#ifndef WB_DAQ_TAKE_TAKE_ROWS_H
#define WB_DAQ_TAKE_TAKE_ROWS_H

#include "daq/take/take.h"

struct wb_take_rows {
    struct wb_take *take;
    const char *name; /* of the file */
    const char *domain;
    struct wb_reason *why;
    struct wb_cells_lines lines;
    struct wb_cells cells; /* of the current row */
    char delimiter, comma; /* comma: decimal sign besides '.'; 0: none */
    double unit;           /* m */
};

/* Rejects the file at a column of the current row. */
#define wb_take_rows_reject(rows, column, ...)                                                     \
    (wb_take_rows_report((rows), (column), __VA_ARGS__), WB_ERR_FORMAT)
void wb_take_rows_report(const struct wb_take_rows *rows, size_t column, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* The next row of data. Empty rows are counted, and a row without line end is skipped, because it
 * may be truncated within a number. */
bool wb_take_rows_next(struct wb_take_rows *rows, struct wb_span *line);

/* Counts the current row as skipped; returns WB_OK. */
enum wb_status wb_take_rows_skip(struct wb_take_rows *rows);

/* Rejects a file most of whose rows were skipped; `cells` describes the expected cells. */
WB_MUST_CHECK enum wb_status wb_take_rows_check(struct wb_take_rows *rows, const char *cells);

/* Read the last cell of the current row as frame number, time (s), or coordinate (m). */
WB_MUST_CHECK enum wb_status wb_take_rows_number(const struct wb_take_rows *rows,
                                                 struct wb_span cell, int32_t *number);
WB_MUST_CHECK enum wb_status wb_take_rows_time(const struct wb_take_rows *rows, struct wb_span cell,
                                               double *t);
WB_MUST_CHECK enum wb_status wb_take_rows_coordinate(const struct wb_take_rows *rows,
                                                     struct wb_span cell, double *x);

/* Whether a further cell of the row is not empty. Reads the row to its end. */
bool wb_take_rows_has_more(struct wb_take_rows *rows);

#endif
