#include "daq/take/take_rows.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#define LARGEST_TIME 1e8 /* s */

void wb_take_rows_report(const struct wb_take_rows *rows, size_t column, const char *format, ...)
{
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    wb_reason_report(rows->why, false, rows->domain, "%s:%zu: column %zu: %s", rows->name,
                     rows->lines.number, column, message);
}

enum wb_status wb_take_rows_skip(struct wb_take_rows *rows)
{
    struct wb_take *const take = rows->take;
    if (take->skipped_rows++ == 0)
        take->first_skipped = rows->lines.number;
    return WB_OK;
}

bool wb_take_rows_next(struct wb_take_rows *rows, struct wb_span *line)
{
    while (wb_cells_lines_next(&rows->lines, line)) {
        if (wb_cells_blank(*line, rows->delimiter))
            rows->take->empty_rows++;
        else if (!rows->lines.terminated)
            (void)wb_take_rows_skip(rows);
        else
            return true;
    }
    return false;
}

enum wb_status wb_take_rows_check(struct wb_take_rows *rows, const char *cells)
{
    const struct wb_take *const take = rows->take;
    if (take->skipped_rows <= take->n_frames)
        return WB_OK;
    rows->lines.number = take->first_skipped;
    return wb_take_rows_reject(rows, 1,
                               "%zu of %zu rows do not have %s or are not in ascending order; this "
                               "is the first of them",
                               take->skipped_rows, take->skipped_rows + take->n_frames, cells);
}

enum wb_status wb_take_rows_number(const struct wb_take_rows *rows, struct wb_span cell,
                                   int32_t *number)
{
    double value;
    if (!wb_cells_number(cell, 0, &value) || value != floor(value) ||
        !(fabs(value) < (double)INT_MAX))
        return wb_take_rows_reject(rows, rows->cells.column, "expected a frame number, not '%s'",
                                   wb_take_quote(cell).text);
    *number = (int32_t)value;
    return WB_OK;
}

enum wb_status wb_take_rows_time(const struct wb_take_rows *rows, struct wb_span cell, double *t)
{
    if (!wb_cells_number(cell, rows->comma, t) || !(fabs(*t) < LARGEST_TIME))
        return wb_take_rows_reject(rows, rows->cells.column, "expected a time in seconds, not '%s'",
                                   wb_take_quote(cell).text);
    return WB_OK;
}

enum wb_status wb_take_rows_coordinate(const struct wb_take_rows *rows, struct wb_span cell,
                                       double *x)
{
    if (!wb_cells_number(cell, rows->comma, x))
        return wb_take_rows_reject(rows, rows->cells.column, "expected a position, not '%s'",
                                   wb_take_quote(cell).text);
    *x *= rows->unit;
    if (!(fabs(*x) <= WB_TAKE_LARGEST_POSITION))
        return wb_take_rows_reject(rows, rows->cells.column,
                                   "implausible position of a marker: %g m; check the unit of "
                                   "length",
                                   *x);
    return WB_OK;
}

bool wb_take_rows_has_more(struct wb_take_rows *rows)
{
    struct wb_span cell;
    bool has_more = false;
    while (wb_cells_next(&rows->cells, &cell))
        has_more |= cell.n > 0;
    return has_more;
}
