/* TRC: a header of five lines, then frame, time and three coordinates per marker, separated by
 * tabs.
 *
 * Many programs write TRC. Real files have padded integers, CR CR LF, a header with blanks instead
 * of tabs, a blank line before the data, rows that end after the last visible marker, and 0, 0, 0
 * for a marker that is not visible.
 */
#include <limits.h>
#include <math.h>
#include <string.h>

#include "daq/protocol/cells.h"
#include "daq/take/take_reader.h"

#define WB_LOG_DOMAIN "trc"

#define MOST_MARKERS 10000
#define LARGEST_TIME 1e8     /* s */
#define LARGEST_POSITION 1e4 /* m */

struct reading {
    struct wb_take *take;
    const char *name;
    struct wb_reason *why;
    struct wb_cells_lines lines;
    double unit; /* m */
    size_t n_markers;
    bool has_last;
    int32_t last_number;
    double last_t;
};

#define reject(reading, column, format, ...)                                                       \
    wb_fail_to((reading)->why, WB_ERR_FORMAT, "%s:%zu: column %zu: " format, (reading)->name,      \
               (reading)->lines.number, (size_t)(column), __VA_ARGS__)

/* The next line that is not empty. */
static enum wb_status need_line(struct reading *reading, const char *what, const char **line,
                                size_t *n)
{
    while (wb_cells_lines_next(&reading->lines, line, n))
        if (!wb_cells_blank(*line, *n, '\t'))
            return WB_OK;
    return reject(reading, 1, "the file ends before %s", what);
}

/* --- header --- */

/* Reads a value of the header: keys are in one line, values at the same position in the next. */
static enum wb_status read_value(struct reading *reading, const char *key, const char *value,
                                 size_t n, size_t column)
{
    double number;
    if (strcmp(key, "Units") == 0) {
        reading->unit = wb_take_length_unit(value, n);
        if (!(reading->unit > 0.0))
            return reject(reading, column, "unknown unit of length '%s'",
                          wb_take_quote(value, n).text);
        return WB_OK;
    }
    if (!wb_cells_number(value, n, ',', &number) || !(number >= 0.0) || !(number < 1e9))
        return reject(reading, column, "%s: expected a number, not '%s'", key,
                      wb_take_quote(value, n).text);
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
    const char *keys, *values, *key, *value;
    size_t n_keys, n_values, n_key, n_value;
    WB_TRY(need_line(reading, "its keys", &keys, &n_keys));
    WB_TRY(need_line(reading, "the values of its keys", &values, &n_values));
    struct wb_cells at_key, at_value;
    const bool tabs = memchr(keys, '\t', n_keys) && memchr(values, '\t', n_values);
    wb_cells_begin(&at_key, keys, n_keys, tabs ? '\t' : ' ');
    wb_cells_begin(&at_value, values, n_values, tabs ? '\t' : ' ');
    unsigned found = 0;
    while (wb_cells_next(&at_key, &key, &n_key)) {
        if (!wb_cells_next(&at_value, &value, &n_value) && n_key > 0)
            return reject(reading, at_value.column, "the key '%s' has no value",
                          wb_take_quote(key, n_key).text);
        for (unsigned i = 0; i < 4; i++) {
            if (!wb_cells_equal(key, n_key, wanted[i]))
                continue;
            found |= 1U << i;
            WB_TRY(read_value(reading, wanted[i], value, n_value, at_value.column));
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
    const char *line, *cell;
    size_t n, n_cell;
    WB_TRY(need_line(reading, "the names of markers", &line, &n));
    const bool tabs = memchr(line, '\t', n) != NULL;
    struct wb_cells cells;
    wb_cells_begin(&cells, line, n, tabs ? '\t' : ' ');
    if (!wb_cells_next(&cells, &cell, &n_cell) || !wb_cells_begins(cell, n_cell, "Frame"))
        return reject(reading, 1, "%s", "expected 'Frame#'");
    if (!wb_cells_next(&cells, &cell, &n_cell) || !wb_cells_begins(cell, n_cell, "Time"))
        return reject(reading, 2, "%s", "expected 'Time'");
    while (wb_cells_next(&cells, &cell, &n_cell)) {
        if (n_cell == 0)
            continue;
        wb_take_add_point(reading->take,
                          wb_cells_begins(cell, n_cell, "Unlabeled") ? WB_TAKE_UNLABELLED
                                                                     : WB_TAKE_MARKER,
                          cell, n_cell);
    }
    if (reading->take->n_points != reading->n_markers)
        return reject(reading, cells.column, "%zu names of markers, but NumMarkers is %zu",
                      reading->take->n_points, reading->n_markers);
    return WB_OK;
}

/* Reads the row of axes: X1 Y1 Z1 X2 ... */
static enum wb_status read_axes(struct reading *reading)
{
    const char *line, *cell;
    size_t n, n_cell, count = 0;
    WB_TRY(need_line(reading, "the row X1 Y1 Z1", &line, &n));
    struct wb_cells cells;
    wb_cells_begin(&cells, line, n, ' ');
    while (wb_cells_next(&cells, &cell, &n_cell)) {
        if ((cell[0] | 0x20) != "xyz"[count % 3])
            return reject(reading, cells.column + 2, "expected an axis %c, not '%s'",
                          "XYZ"[count % 3], wb_take_quote(cell, n_cell).text);
        count++;
    }
    if (count != 3 * reading->n_markers)
        return reject(reading, cells.column + 2, "%zu axes for %zu markers", count,
                      reading->n_markers);
    return WB_OK;
}

/* --- data --- */

static enum wb_status read_start(struct reading *reading, struct wb_cells *cells, int32_t *number,
                                 double *t)
{
    const char *cell = "";
    size_t n = 0;
    double value;
    if (!wb_cells_next(cells, &cell, &n) || !wb_cells_number(cell, n, 0, &value) ||
        value != floor(value) || !(fabs(value) < (double)INT_MAX))
        return reject(reading, 1, "expected a frame number, not '%s'", wb_take_quote(cell, n).text);
    *number = (int32_t)value;
    if (!wb_cells_next(cells, &cell, &n))
        return reject(reading, 2, "%s", "the row ends before the time");
    if (!wb_cells_number(cell, n, ',', t) || !(fabs(*t) < LARGEST_TIME))
        return reject(reading, 2, "expected a time in seconds, not '%s'",
                      wb_take_quote(cell, n).text);
    return WB_OK;
}

/* Reads three cells. *whole is false if the row ends before the marker. */
static enum wb_status read_marker(struct reading *reading, struct wb_cells *cells,
                                  double position[3], bool *whole, int *cells_there)
{
    const char *cell;
    size_t n;
    *cells_there = 0;
    for (int k = 0; k < 3; k++) {
        position[k] = (double)NAN;
        *whole = wb_cells_next(cells, &cell, &n);
        if (!*whole)
            return WB_OK;
        ++*cells_there;
        if (n == 0 || wb_cells_begins(cell, n, "nan"))
            continue;
        if (!wb_cells_number(cell, n, ',', &position[k]))
            return reject(reading, cells->column, "expected a position, not '%s'",
                          wb_take_quote(cell, n).text);
        position[k] *= reading->unit;
        if (!(fabs(position[k]) <= LARGEST_POSITION))
            return reject(reading, cells->column,
                          "implausible position of a marker: %g m; check the unit of length",
                          position[k]);
    }
    return WB_OK;
}

static bool is_seen(const double position[3])
{
    return isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]) &&
           (position[0] != 0.0 || position[1] != 0.0 || position[2] != 0.0);
}

/* Reads a row of data. It may end after any marker; a row that ends within a marker is skipped. */
static enum wb_status read_row(struct reading *reading, const char *line, size_t n)
{
    struct wb_take *const take = reading->take;
    struct wb_cells cells;
    int32_t number;
    double t;
    wb_cells_begin(&cells, line, n, memchr(line, '\t', n) ? '\t' : ' ');
    WB_TRY(read_start(reading, &cells, &number, &t));
    if (reading->has_last && (number <= reading->last_number || !(t > reading->last_t))) {
        wb_take_skip(take, reading->lines.number);
        return WB_OK;
    }
    wb_take_add_frame(take, number, t);
    bool whole = true;
    int there = 3;
    for (size_t i = 0; i < reading->n_markers && whole; i++) {
        double position[3];
        WB_TRY(read_marker(reading, &cells, position, &whole, &there));
        if (whole && is_seen(position))
            wb_take_add_place(take, (uint32_t)i, position);
    }
    const char *cell;
    size_t n_cell;
    bool too_wide = false;
    while (whole && wb_cells_next(&cells, &cell, &n_cell))
        too_wide |= n_cell > 0;
    if (too_wide || (!whole && there > 0)) {
        wb_take_drop_frame(take);
        wb_take_skip(take, reading->lines.number);
        return WB_OK;
    }
    reading->has_last = true;
    reading->last_number = number;
    reading->last_t = t;
    return WB_OK;
}

static enum wb_status read_data(struct reading *reading)
{
    const char *line;
    size_t n;
    while (wb_cells_lines_next(&reading->lines, &line, &n)) {
        if (wb_cells_blank(line, n, '\t'))
            reading->take->empty_rows++;
        else if (!reading->lines.terminated)
            wb_take_skip(reading->take, reading->lines.number);
        else
            WB_TRY(read_row(reading, line, n));
    }
    if (reading->take->skipped_rows > reading->take->n_frames) {
        reading->lines.number = reading->take->first_skipped;
        return reject(
            reading, 1,
            "%zu of %zu rows do not have the cells of %zu markers or are not in ascending "
            "order; this is the first of them",
            reading->take->skipped_rows, reading->take->skipped_rows + reading->take->n_frames,
            reading->n_markers);
    }
    return WB_OK;
}

/* --- the file --- */

static bool begins(struct wb_cells_lines *lines)
{
    const char *line;
    size_t n;
    return wb_cells_lines_next(lines, &line, &n) && wb_cells_begins(line, n, "PathFileType");
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
    if (!begins(&reading->lines))
        return reject(reading, 1, "%s", "expected 'PathFileType'");
    strcpy(reading->take->format, "TRC");
    WB_TRY(read_keys(reading));
    WB_TRY(read_names(reading));
    WB_TRY(read_axes(reading));
    WB_TRY(read_data(reading));
    return wb_take_finish(reading->take, reading->name, reading->why);
}

static enum wb_status read_trc(struct wb_take *take, const char *name, const uint8_t *bytes,
                               size_t n, struct wb_reason *why)
{
    struct reading reading = {.take = take, .name = name, .why = why};
    memset(take, 0, sizeof *take);
    wb_cells_lines_begin(&reading.lines, bytes, n);
    const enum wb_status status = read_all(&reading);
    wb_cells_lines_release(&reading.lines);
    if (status != WB_OK)
        wb_take_release(take);
    return status;
}

const struct wb_take_reader wb_trc = {.name = "trc", .is = is_trc, .read = read_trc};
