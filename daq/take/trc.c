/* TRC: a header of five lines, then frame, time and three coordinates per marker, separated by
 * tabs.
 *
 * Many programs write TRC. Real files have padded integers, CR CR LF, a header with blanks instead
 * of tabs, a blank line before the data, rows that end after the last visible marker, and 0, 0, 0
 * for a marker that is not visible.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "daq/take/take_reader.h"
#include "daq/take/take_rows.h"

#define MOST_MARKERS 10000

struct reading {
    struct wb_take *take;
    struct wb_take_rows rows;
    size_t n_markers;
};

#define reject(reading, column, ...) wb_take_rows_reject(&(reading)->rows, column, __VA_ARGS__)

/* The next line that is not empty. */
static enum wb_status need_line(struct reading *reading, const char *what, struct wb_span *line)
{
    while (wb_cells_lines_next(&reading->rows.lines, line))
        if (!wb_cells_blank(*line, '\t'))
            return WB_OK;
    return reject(reading, 1, "the file ends before %s", what);
}

static bool next_cell(struct reading *reading, struct wb_span *cell)
{
    return wb_cells_next(&reading->rows.cells, cell);
}

static char separator(struct wb_span line)
{
    return memchr(line.text, '\t', line.n) ? '\t' : ' ';
}

/* --- header --- */

/* Reads a value of the header: keys are in one line, values at the same position in the next. */
static enum wb_status read_value(struct reading *reading, const char *key, struct wb_span value)
{
    const size_t column = reading->rows.cells.column;
    double number;
    if (strcmp(key, "Units") == 0) {
        reading->rows.unit = wb_take_length_unit(value);
        if (!(reading->rows.unit > 0.0))
            return reject(reading, column, "unknown unit of length '%s'",
                          wb_take_quote(value).text);
        return WB_OK;
    }
    if (!wb_cells_number(value, ',', &number) || !(number >= 0.0) || !(number < 1e9))
        return reject(reading, column, "%s: expected a number, not '%s'", key,
                      wb_take_quote(value).text);
    if (strcmp(key, "DataRate") == 0)
        reading->take->rate = number;
    else if (strcmp(key, "NumFrames") == 0)
        reading->take->declared_frames = (size_t)number;
    else if (number < 1.0 || number > MOST_MARKERS || number != floor(number))
        return reject(reading, column, "expected 1 to %d markers, not %g", MOST_MARKERS, number);
    else
        reading->n_markers = (size_t)number;
    return WB_OK;
}

static enum wb_status read_keys(struct reading *reading)
{
    static const char *const wanted[] = {"DataRate", "NumFrames", "NumMarkers", "Units"};
    struct wb_span keys, values, key, value;
    WB_TRY(need_line(reading, "its keys", &keys));
    WB_TRY(need_line(reading, "the values of its keys", &values));
    struct wb_cells at_key;
    const char delimiter = separator(keys) == '\t' ? separator(values) : ' ';
    wb_cells_begin(&at_key, keys, delimiter);
    wb_cells_begin(&reading->rows.cells, values, delimiter);
    unsigned found = 0;
    while (wb_cells_next(&at_key, &key)) {
        if (!next_cell(reading, &value) && key.n > 0)
            return reject(reading, reading->rows.cells.column, "the key '%s' has no value",
                          wb_take_quote(key).text);
        for (unsigned i = 0; i < 4; i++) {
            if (!wb_cells_equal(key, wanted[i]))
                continue;
            found |= 1U << i;
            WB_TRY(read_value(reading, wanted[i], value));
        }
    }
    for (unsigned i = 0; i < 4; i++)
        if (!(found >> i & 1))
            return reject(reading, 1, "the header has no '%s'", wanted[i]);
    return WB_OK;
}

/* Reads the names, which are above the first of a marker's three columns. If blanks separate them,
 * they follow each other directly. */
static enum wb_status read_names(struct reading *reading)
{
    struct wb_span line, cell;
    WB_TRY(need_line(reading, "the names of markers", &line));
    wb_cells_begin(&reading->rows.cells, line, separator(line));
    if (!next_cell(reading, &cell) || !wb_cells_begins(cell, "Frame"))
        return reject(reading, 1, "expected 'Frame#'");
    if (!next_cell(reading, &cell) || !wb_cells_begins(cell, "Time"))
        return reject(reading, 2, "expected 'Time'");
    while (next_cell(reading, &cell)) {
        const bool unlabelled = wb_cells_begins(cell, "Unlabeled");
        if (cell.n > 0)
            wb_take_add_point(reading->take, unlabelled ? WB_TAKE_UNLABELLED : WB_TAKE_MARKER,
                              cell);
    }
    if (reading->take->n_points != reading->n_markers)
        return reject(reading, reading->rows.cells.column,
                      "%zu names of markers, but NumMarkers is %zu", reading->take->n_points,
                      reading->n_markers);
    return WB_OK;
}

/* Reads the row of axes: X1 Y1 Z1 X2 ... */
static enum wb_status read_axes(struct reading *reading)
{
    const struct wb_cells *const cells = &reading->rows.cells;
    struct wb_span line, cell;
    size_t count = 0;
    WB_TRY(need_line(reading, "the row X1 Y1 Z1", &line));
    wb_cells_begin(&reading->rows.cells, line, ' ');
    while (next_cell(reading, &cell)) {
        if ((*cell.text | 0x20) != "xyz"[count % 3])
            return reject(reading, cells->column + 2, "expected an axis %c, not '%s'",
                          "XYZ"[count % 3], wb_take_quote(cell).text);
        count++;
    }
    if (count != 3 * reading->n_markers)
        return reject(reading, cells->column + 2, "%zu axes for %zu markers", count,
                      reading->n_markers);
    return WB_OK;
}

/* --- data --- */

/* Reads up to three cells; *n receives their number, fewer if the row ends before. */
static enum wb_status read_marker(struct reading *reading, double position[3], int *n)
{
    struct wb_span cell;
    for (*n = 0; *n < 3 && next_cell(reading, &cell); ++*n) {
        position[*n] = (double)NAN;
        if (cell.n > 0 && !wb_cells_begins(cell, "nan"))
            WB_TRY(wb_take_rows_coordinate(&reading->rows, cell, &position[*n]));
    }
    return WB_OK;
}

static bool is_seen(const double position[3])
{
    return isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) &&
           (position[0] != 0.0 || position[1] != 0.0 || position[2] != 0.0);
}

/* Reads a row of data. It may end after any marker; a row that ends within a marker is skipped. */
static enum wb_status read_row(struct reading *reading, struct wb_span line)
{
    struct wb_take_rows *const rows = &reading->rows;
    struct wb_span cell = {"", 0};
    int32_t number;
    double t;
    wb_cells_begin(&rows->cells, line, separator(line));
    (void)next_cell(reading, &cell);
    WB_TRY(wb_take_rows_number(rows, cell, &number));
    if (!next_cell(reading, &cell))
        return reject(reading, 2, "the row ends before the time");
    WB_TRY(wb_take_rows_time(rows, cell, &t));
    if (!wb_take_add_frame(reading->take, number, t))
        return wb_take_rows_skip(rows);
    int n_cells = 3;
    for (size_t i = 0; i < reading->n_markers && n_cells == 3; i++) {
        double position[3];
        WB_TRY(read_marker(reading, position, &n_cells));
        if (n_cells == 3 && is_seen(position))
            wb_take_add_place(reading->take, (uint32_t)i, position);
    }
    if (n_cells == 3 ? wb_take_rows_has_more(rows) : n_cells > 0) {
        wb_take_drop_frame(reading->take);
        return wb_take_rows_skip(rows);
    }
    return WB_OK;
}

/* --- the file --- */

static bool begins(struct wb_cells_lines *lines)
{
    struct wb_span line;
    return wb_cells_lines_next(lines, &line) && wb_cells_begins(line, "PathFileType");
}

static bool is_trc(const uint8_t *bytes, size_t n)
{
    struct wb_cells_lines lines;
    wb_cells_lines_begin(&lines, bytes, n < 4096 ? n : 4096);
    const bool is = begins(&lines);
    wb_cells_lines_release(&lines);
    return is;
}

static enum wb_status read_all(struct reading *reading)
{
    struct wb_span line;
    char cells[48];
    if (!begins(&reading->rows.lines))
        return reject(reading, 1, "expected 'PathFileType'");
    strcpy(reading->take->format, "TRC");
    WB_TRY(read_keys(reading));
    WB_TRY(read_names(reading));
    WB_TRY(read_axes(reading));
    while (wb_take_rows_next(&reading->rows, &line))
        WB_TRY(read_row(reading, line));
    snprintf(cells, sizeof cells, "the cells of %zu markers", reading->n_markers);
    return wb_take_rows_check(&reading->rows, cells);
}

static enum wb_status read_trc(struct wb_take *take, const char *name, const uint8_t *bytes,
                               size_t n, struct wb_reason *why)
{
    struct reading reading = {.take = take,
                              .rows = {.take = take,
                                       .name = name,
                                       .domain = "trc",
                                       .why = why,
                                       .delimiter = '\t',
                                       .comma = ','}};
    memset(take, 0, sizeof *take);
    wb_cells_lines_begin(&reading.rows.lines, bytes, n);
    const enum wb_status status = read_all(&reading);
    wb_cells_lines_release(&reading.rows.lines);
    return wb_take_finish(take, status, name, why);
}

const struct wb_take_reader wb_trc = {.name = "trc", .is = is_trc, .read = read_trc};
