/* CSV exports of Motive: formats 1.20 to 1.25 with columns, and format 1.1 with rows.
 *
 * With columns, the header defines the layout: the first line has keys and values, followed by rows
 * of types, names, IDs, (1.25) parents, kinds and axes above each column; since 1.24 there may be a
 * column of time code between times and data. With rows, the first word of a line is its kind, and
 * the number of cells varies. Columns of type `Marker` were measured by the cameras; `Rigid Body
 * Marker` is solved from the body and filled in while the marker is lost.
 */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "daq/protocol/cells.h"
#include "daq/take/take_reader.h"

#define WB_LOG_DOMAIN "motive"

#define MOST_HEADER_ROWS 12
#define MOST_COLUMNS 100000
#define LARGEST_TIME 1e8     /* s */
#define LARGEST_POSITION 1e4 /* m */

struct reading {
    struct wb_take *take;
    const char *name;
    struct wb_reason *why;
    struct wb_cells_lines lines;
    char delimiter, comma;
    double unit; /* m */
    bool has_last;
    int32_t last_number;
    double last_t;
    /* With columns. */
    size_t n_columns;
    struct column *columns;
    double (*places)[3]; /* of each point, in this row */
    /* With rows: a hash of ids to points. */
    size_t n_slots;
    struct slot *slots;
};

enum role {
    ROLE_IGNORED,
    ROLE_FRAME,
    ROLE_TIME,
    ROLE_AXIS
};

struct column {
    enum role role;
    uint32_t point;
    int axis;
};

struct slot {
    uint64_t key;
    uint32_t point;
    bool used;
};

#define reject(reading, column, format, ...)                                                       \
    wb_fail_to((reading)->why, WB_ERR_FORMAT, "%s:%zu: column %zu: " format, (reading)->name,      \
               (reading)->lines.number, (size_t)(column), __VA_ARGS__)

static bool is_missing(const char *cell, size_t n)
{
    /* Fast path: most cells are numbers. */
    if (n > 0 && (unsigned)cell[n - 1] - '0' <= 9)
        return false;
    return n == 0 || wb_cells_begins(cell, n, "nan") || wb_cells_begins(cell, n, "-nan");
}

/* --- header --- */

static bool find_value(const struct reading *reading, const char *line, size_t n, const char *key,
                       const char **value, size_t *n_value, size_t *column)
{
    struct wb_cells cells;
    const char *cell;
    size_t n_cell;
    wb_cells_begin(&cells, line, n, reading->delimiter);
    while (wb_cells_next(&cells, &cell, &n_cell)) {
        if (wb_cells_equal(cell, n_cell, key)) {
            *column = cells.column + 1;
            return wb_cells_next(&cells, value, n_value);
        }
    }
    return false;
}

static enum wb_status read_rate(struct reading *reading, const char *line, size_t n)
{
    static const char *const keys[] = {"Export Frame Rate", "Capture Frame Rate"};
    const char *value;
    size_t n_value, column;
    for (size_t i = 0; i < 2 && reading->take->rate == 0.0; i++) {
        if (!find_value(reading, line, n, keys[i], &value, &n_value, &column) || n_value == 0)
            continue;
        double rate;
        if (!wb_cells_number(value, n_value, reading->comma, &rate) || !(rate > 0.0) ||
            !(rate < 1e6))
            return reject(reading, column, "%s: expected a rate in frames/s, not '%s'", keys[i],
                          wb_take_quote(value, n_value).text);
        reading->take->rate = rate;
    }
    return WB_OK;
}

static enum wb_status read_keys(struct reading *reading, const char *line, size_t n)
{
    const char *value;
    size_t n_value, column;
    double count;
    char version[16] = "";
    if (find_value(reading, line, n, "Format Version", &value, &n_value, &column))
        wb_take_copy_name(version, sizeof version, value, n_value);
    if (strncmp(version, "1.2", 3) != 0 && strncmp(version, "1,2", 3) != 0)
        return reject(reading, 2, "Format Version: expected 1.20 to 1.25, not '%s'", version);
    snprintf(reading->take->format, sizeof reading->take->format, "Motive CSV %s", version);
    WB_TRY(read_rate(reading, line, n));
    if (!find_value(reading, line, n, "Length Units", &value, &n_value, &column))
        return reject(reading, 1, "%s", "'Length Units' is missing: export again with the header");
    reading->unit = wb_take_length_unit(value, n_value);
    if (!(reading->unit > 0.0))
        return reject(reading, column, "unknown unit of length '%s'",
                      wb_take_quote(value, n_value).text);
    if (find_value(reading, line, n, "Coordinate Space", &value, &n_value, &column) &&
        wb_cells_equal(value, n_value, "Local"))
        return reject(reading, column, "%s",
                      "local coordinates do not give the positions of markers: export again with "
                      "'Coordinate Space' Global");
    if (find_value(reading, line, n, "Total Exported Frames", &value, &n_value, &column) &&
        wb_cells_number(value, n_value, reading->comma, &count) && count >= 0.0 && count < 1e9)
        reading->take->declared_frames = (size_t)count;
    return WB_OK;
}

/* The rows above the columns. */
struct header {
    size_t n;
    struct {
        const char *line;
        size_t n;
    } rows[MOST_HEADER_ROWS];
    size_t type, name, kind, axis; /* indices of the rows */
};

static enum wb_status gather_header(struct reading *reading, struct header *header)
{
    const char *line, *cell;
    size_t n, n_cell;
    for (;;) {
        if (!wb_cells_lines_next(&reading->lines, &line, &n))
            return reject(reading, 1, "%s", "the file ends before a row that begins with 'Frame'");
        if (wb_cells_blank(line, n, reading->delimiter))
            continue;
        if (header->n == MOST_HEADER_ROWS)
            return reject(reading, 1, "no row begins with 'Frame' among the first %d",
                          MOST_HEADER_ROWS);
        header->rows[header->n].line = line;
        header->rows[header->n++].n = n;
        struct wb_cells cells;
        wb_cells_begin(&cells, line, n, reading->delimiter);
        if (wb_cells_next(&cells, &cell, &n_cell) && wb_cells_equal(cell, n_cell, "Frame"))
            return WB_OK;
    }
}

/* Format 1.21 has rows of types, names, IDs, kinds, axes; in later formats the first cells name the
 * rows. */
static enum wb_status find_rows(struct reading *reading, struct header *header)
{
    if (header->n < 4)
        return reject(reading, 1,
                      "expected header rows of types, names, IDs, kinds and axes above the data, "
                      "found %zu rows",
                      header->n);
    header->axis = header->n - 1;
    header->kind = header->n - 2;
    header->type = 0;
    header->name = 1;
    for (size_t i = 0; i < header->n - 2; i++) {
        struct wb_cells cells;
        const char *cell;
        size_t n;
        wb_cells_begin(&cells, header->rows[i].line, header->rows[i].n, reading->delimiter);
        for (int k = 0; k < 3 && wb_cells_next(&cells, &cell, &n); k++) {
            if (wb_cells_equal(cell, n, "Type"))
                header->type = i;
            else if (wb_cells_equal(cell, n, "Name"))
                header->name = i;
        }
    }
    return WB_OK;
}

static bool kind_of(const char *type, size_t n_type, const char *name, size_t n_name,
                    enum wb_take_kind *kind)
{
    if (wb_cells_equal(type, n_type, "Marker") || wb_cells_equal(type, n_type, "Unlabeled Marker"))
        *kind = wb_cells_begins(name, n_name, "Unlabeled") ? WB_TAKE_UNLABELLED : WB_TAKE_MARKER;
    else if (wb_cells_equal(type, n_type, "Rigid Body Marker") ||
             wb_cells_equal(type, n_type, "Bone Marker"))
        *kind = WB_TAKE_SOLVED;
    else if (wb_cells_equal(type, n_type, "Rigid Body") || wb_cells_equal(type, n_type, "Bone"))
        *kind = WB_TAKE_BODY;
    else
        return false;
    return true;
}

static enum wb_status check_columns(struct reading *reading)
{
    bool frame = false, time = false;
    unsigned *const axes = wb_memory_new(reading->take->n_points, sizeof *axes);
    size_t incomplete = 0;
    for (size_t i = 0; i < reading->n_columns; i++) {
        const struct column *const column = &reading->columns[i];
        frame |= column->role == ROLE_FRAME;
        time |= column->role == ROLE_TIME;
        if (column->role == ROLE_AXIS)
            axes[column->point] |= 1U << column->axis;
    }
    for (size_t i = reading->n_columns; i-- > 0;)
        if (reading->columns[i].role == ROLE_AXIS && axes[reading->columns[i].point] != 7)
            incomplete = i + 1;
    free(axes);
    if (incomplete)
        return reject(reading, incomplete, "'%s' lacks one of the columns X, Y and Z",
                      reading->take->points[reading->columns[incomplete - 1].point].name);
    if (!frame || !time)
        return reject(reading, 1, "the column '%s' is missing", frame ? "Time" : "Frame");
    if (reading->take->n_points == 0)
        return reject(reading, 1, "%s",
                      "no column has positions of markers: export again with 'Markers' on");
    return WB_OK;
}

/* Reads the rows of the header in parallel. A new point begins if the name or the type changes, or
 * if an axis is repeated. */
static enum wb_status read_columns(struct reading *reading, const struct header *header)
{
    struct wb_cells rows[4];
    const size_t which[4] = {header->type, header->name, header->kind, header->axis};
    struct wb_take_quoted last = {""};
    enum wb_take_kind last_kind = WB_TAKE_BODY;
    unsigned axes = 7;
    for (int r = 0; r < 4; r++)
        wb_cells_begin(&rows[r], header->rows[which[r]].line, header->rows[which[r]].n,
                       reading->delimiter);
    reading->columns = wb_memory_new(header->rows[header->axis].n + 2, sizeof *reading->columns);
    const char *cell[4];
    size_t n[4];
    while (wb_cells_next(&rows[3], &cell[3], &n[3])) {
        struct column *const column = &reading->columns[reading->n_columns++];
        for (int r = 0; r < 3; r++)
            if (!wb_cells_next(&rows[r], &cell[r], &n[r])) {
                cell[r] = "";
                n[r] = 0;
            }
        if (reading->n_columns > MOST_COLUMNS)
            return reject(reading, reading->n_columns, "more than %d columns", MOST_COLUMNS);
        if (wb_cells_equal(cell[3], n[3], "Frame"))
            column->role = ROLE_FRAME;
        else if (wb_cells_equal(cell[3], n[3], "Time") || wb_cells_begins(cell[3], n[3], "Time ("))
            column->role = ROLE_TIME;
        enum wb_take_kind kind;
        if (!wb_cells_equal(cell[2], n[2], "Position") || n[3] != 1 ||
            !kind_of(cell[0], n[0], cell[1], n[1], &kind))
            continue;
        const int axis = (cell[3][0] | 0x20) - 'x';
        if (axis < 0 || axis > 2)
            return reject(reading, reading->n_columns, "axis: expected X, Y or Z, not '%c'",
                          cell[3][0]);
        const struct wb_take_quoted name = wb_take_quote(cell[1], n[1]);
        if (axes >> axis & 1 || kind != last_kind || strcmp(name.text, last.text) != 0) {
            wb_take_add_point(reading->take, kind, cell[1], n[1]);
            axes = 0;
            last = name;
            last_kind = kind;
        }
        axes |= 1U << axis;
        *column = (struct column){
            .role = ROLE_AXIS, .point = (uint32_t)(reading->take->n_points - 1), .axis = axis};
    }
    return check_columns(reading);
}

/* --- data --- */

static enum wb_status take_number(struct reading *reading, const struct wb_cells *cells,
                                  const char *cell, size_t n, int32_t *number)
{
    double value;
    if (!wb_cells_number(cell, n, 0, &value) || value != floor(value) ||
        !(fabs(value) < (double)INT_MAX))
        return reject(reading, cells->column, "expected a frame number, not '%s'",
                      wb_take_quote(cell, n).text);
    *number = (int32_t)value;
    return WB_OK;
}

static enum wb_status take_time(struct reading *reading, const struct wb_cells *cells,
                                const char *cell, size_t n, double *t)
{
    if (!wb_cells_number(cell, n, reading->comma, t) || !(fabs(*t) < LARGEST_TIME))
        return reject(reading, cells->column, "expected a time in seconds, not '%s'",
                      wb_take_quote(cell, n).text);
    return WB_OK;
}

/* Reads a coordinate; NaN if the cell is empty. */
static enum wb_status take_coordinate(struct reading *reading, const struct wb_cells *cells,
                                      const char *cell, size_t n, double *value)
{
    if (is_missing(cell, n)) {
        *value = (double)NAN;
        return WB_OK;
    }
    if (!wb_cells_number(cell, n, reading->comma, value))
        return reject(reading, cells->column, "expected a position, not '%s'",
                      wb_take_quote(cell, n).text);
    *value *= reading->unit;
    if (!(fabs(*value) <= LARGEST_POSITION))
        return reject(reading, cells->column,
                      "implausible position of a marker: %g m; check the unit of length", *value);
    return WB_OK;
}

/* False if the frame is not in ascending order; it is then skipped. */
static bool in_order(struct reading *reading, int32_t number, double t)
{
    if (reading->has_last && (number <= reading->last_number || !(t > reading->last_t)))
        return false;
    reading->has_last = true;
    reading->last_number = number;
    reading->last_t = t;
    return true;
}

static void add_point(struct reading *reading, uint32_t point, const double position[3])
{
    if (isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]))
        wb_take_add_place(reading->take, point, position);
}

/* Reads a row of data. A row with another number of cells than the header is skipped: it is unknown
 * which cell is missing. */
static enum wb_status read_row(struct reading *reading, const char *line, size_t n)
{
    struct wb_cells cells;
    const char *cell;
    size_t n_cell;
    int32_t number = 0;
    double t = 0.0;
    wb_cells_begin(&cells, line, n, reading->delimiter);
    for (size_t i = 0; i < reading->n_columns; i++) {
        if (!wb_cells_next(&cells, &cell, &n_cell)) {
            wb_take_skip(reading->take, reading->lines.number);
            return WB_OK;
        }
        const struct column *const column = &reading->columns[i];
        if (column->role == ROLE_AXIS)
            WB_TRY(take_coordinate(reading, &cells, cell, n_cell,
                                   &reading->places[column->point][column->axis]));
        else if (column->role == ROLE_FRAME)
            WB_TRY(take_number(reading, &cells, cell, n_cell, &number));
        else if (column->role == ROLE_TIME)
            WB_TRY(take_time(reading, &cells, cell, n_cell, &t));
    }
    bool too_wide = false;
    while (wb_cells_next(&cells, &cell, &n_cell))
        too_wide |= n_cell > 0;
    if (too_wide || !in_order(reading, number, t)) {
        wb_take_skip(reading->take, reading->lines.number);
        return WB_OK;
    }
    wb_take_add_frame(reading->take, number, t);
    for (size_t i = 0; i < reading->take->n_points; i++)
        add_point(reading, (uint32_t)i, reading->places[i]);
    return WB_OK;
}

static enum wb_status read_data(struct reading *reading)
{
    const char *line;
    size_t n;
    reading->places = wb_memory_new(reading->take->n_points, sizeof *reading->places);
    while (wb_cells_lines_next(&reading->lines, &line, &n)) {
        if (wb_cells_blank(line, n, reading->delimiter)) {
            reading->take->empty_rows++;
        } else if (!reading->lines.terminated) {
            wb_take_skip(reading->take, reading->lines.number);
        } else {
            WB_TRY(read_row(reading, line, n));
        }
    }
    if (reading->take->skipped_rows > reading->take->n_frames) {
        reading->lines.number = reading->take->first_skipped;
        return reject(reading, 1,
                      "%zu of %zu rows do not have the %zu cells of the header or are not in "
                      "ascending order; this is the first of them",
                      reading->take->skipped_rows,
                      reading->take->skipped_rows + reading->take->n_frames, reading->n_columns);
    }
    return WB_OK;
}

static enum wb_status read_with_columns(struct reading *reading, const char *line, size_t n)
{
    struct header header = {0};
    WB_TRY(read_keys(reading, line, n));
    WB_TRY(gather_header(reading, &header));
    WB_TRY(find_rows(reading, &header));
    WB_TRY(read_columns(reading, &header));
    return read_data(reading);
}

/* --- rows (format 1.1) --- */

static struct slot *find_slot(const struct reading *reading, uint64_t key)
{
    size_t at = (size_t)(key * UINT64_C(0x9e3779b97f4a7c15) >> 20) & (reading->n_slots - 1);
    while (reading->slots[at].used && reading->slots[at].key != key)
        at = (at + 1) & (reading->n_slots - 1);
    return &reading->slots[at];
}

static void grow_slots(struct reading *reading)
{
    if (2 * (reading->take->n_points + 1) <= reading->n_slots)
        return;
    struct reading larger = {.n_slots = reading->n_slots ? 2 * reading->n_slots : 1024};
    larger.slots = wb_memory_new(larger.n_slots, sizeof *larger.slots);
    for (size_t i = 0; i < reading->n_slots; i++)
        if (reading->slots[i].used)
            *find_slot(&larger, reading->slots[i].key) = reading->slots[i];
    free(reading->slots);
    reading->slots = larger.slots;
    reading->n_slots = larger.n_slots;
}

static uint32_t point_of_id(struct reading *reading, int32_t id, const char *name, size_t n_name)
{
    grow_slots(reading);
    struct slot *const slot = find_slot(reading, (uint64_t)(uint32_t)id + 1);
    if (!slot->used) {
        char text[80], given[64];
        wb_take_copy_name(given, sizeof given, name, n_name);
        snprintf(text, sizeof text, "%s%s%d", given, given[0] ? ":" : "Unlabeled ", id);
        const size_t added = wb_take_add_point(
            reading->take, given[0] ? WB_TAKE_MARKER : WB_TAKE_UNLABELLED, text, strlen(text));
        *slot = (struct slot){
            .key = (uint64_t)(uint32_t)id + 1, .point = (uint32_t)added, .used = true};
    }
    return slot->point;
}

static enum wb_status need_count(struct reading *reading, struct wb_cells *cells, const char *what,
                                 size_t *count)
{
    const char *cell;
    size_t n;
    double value;
    if (!wb_cells_next(cells, &cell, &n))
        return reject(reading, cells->column, "the row ends before %s", what);
    if (!wb_cells_number(cell, n, 0, &value) || value != floor(value) || !(value >= 0.0) ||
        !(value <= 1e6))
        return reject(reading, cells->column, "expected %s, not '%s'", what,
                      wb_take_quote(cell, n).text);
    *count = (size_t)value;
    return WB_OK;
}

/* Counts the remaining cells of the row, with and without empty cells at its end. */
static void count_left(struct wb_cells cells, size_t *all, size_t *filled)
{
    const char *cell;
    size_t n;
    *all = *filled = 0;
    while (wb_cells_next(&cells, &cell, &n)) {
        ++*all;
        *filled = n > 0 ? *all : *filled;
    }
}

/* Reads markers: x, y, z, id and, in some versions, a name. */
static enum wb_status read_markers(struct reading *reading, struct wb_cells *cells,
                                   size_t n_markers)
{
    const char *cell, *name;
    size_t n, n_name;
    size_t all, filled;
    count_left(*cells, &all, &filled);
    const bool named = filled > 4 * n_markers;
    /* With another number of cells their meaning is ambiguous. */
    if (named && (all < 5 * n_markers || filled > 5 * n_markers))
        return reject(reading, cells->column + 1,
                      "%zu cells for %zu markers: expected 4 or 5 per marker", filled, n_markers);
    for (size_t i = 0; i < n_markers; i++) {
        double position[3];
        int32_t id;
        for (int k = 0; k < 3; k++) {
            if (!wb_cells_next(cells, &cell, &n))
                return reject(reading, cells->column, "the row ends within marker %zu of %zu",
                              i + 1, n_markers);
            WB_TRY(take_coordinate(reading, cells, cell, n, &position[k]));
        }
        if (!wb_cells_next(cells, &cell, &n))
            return reject(reading, cells->column, "the row ends before the id of marker %zu",
                          i + 1);
        WB_TRY(take_number(reading, cells, cell, n, &id));
        name = "";
        n_name = 0;
        if (named && !wb_cells_next(cells, &name, &n_name))
            n_name = 0;
        add_point(reading, point_of_id(reading, id, name, n_name), position);
    }
    return WB_OK;
}

/* Reads a row: frame, number, time, number of bodies, 11 cells per body, number of markers, 4 or 5
 * cells per marker. */
static enum wb_status read_frame(struct reading *reading, struct wb_cells *cells)
{
    enum {
        CELLS_OF_BODY = 11
    };
    const char *cell;
    size_t n, n_bodies, n_markers;
    int32_t number;
    double t;
    if (!wb_cells_next(cells, &cell, &n))
        return reject(reading, cells->column, "%s", "the row ends before the frame number");
    WB_TRY(take_number(reading, cells, cell, n, &number));
    if (!wb_cells_next(cells, &cell, &n))
        return reject(reading, cells->column, "%s", "the row ends before the time");
    WB_TRY(take_time(reading, cells, cell, n, &t));
    WB_TRY(need_count(reading, cells, "the number of rigid bodies", &n_bodies));
    for (size_t i = 0; i < CELLS_OF_BODY * n_bodies; i++)
        if (!wb_cells_next(cells, &cell, &n))
            return reject(reading, cells->column, "the row ends within its %zu rigid bodies",
                          n_bodies);
    WB_TRY(need_count(reading, cells, "the number of markers", &n_markers));
    if (!in_order(reading, number, t)) {
        wb_take_skip(reading->take, reading->lines.number);
        return WB_OK;
    }
    wb_take_add_frame(reading->take, number, t);
    return read_markers(reading, cells, n_markers);
}

static enum wb_status read_info(struct reading *reading, struct wb_cells *cells)
{
    const char *key, *value;
    size_t n_key, n;
    double count;
    if (!wb_cells_next(cells, &key, &n_key) || !wb_cells_next(cells, &value, &n))
        return WB_OK;
    if (wb_cells_equal(key, n_key, "version"))
        snprintf(reading->take->format, sizeof reading->take->format, "Motive CSV %.16s",
                 wb_take_quote(value, n).text);
    else if (wb_cells_equal(key, n_key, "framecount") && wb_cells_number(value, n, 0, &count) &&
             count >= 0.0 && count < 1e9)
        reading->take->declared_frames = (size_t)count;
    return WB_OK;
}

static enum wb_status read_line_by_word(struct reading *reading, const char *line, size_t n)
{
    static const char *const ignored[] = {"comment",   "righthanded", "lefthanded", "rigidbody",
                                          "trackable", "skeleton",    "forceplate", "device"};
    struct wb_cells cells;
    const char *word;
    size_t n_word;
    wb_cells_begin(&cells, line, n, reading->delimiter);
    if (!wb_cells_next(&cells, &word, &n_word))
        return WB_OK;
    if (wb_cells_equal(word, n_word, "frame")) {
        if (reading->lines.terminated)
            return read_frame(reading, &cells);
        wb_take_skip(reading->take, reading->lines.number);
        return WB_OK;
    }
    if (wb_cells_equal(word, n_word, "info"))
        return read_info(reading, &cells);
    for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++)
        if (wb_cells_equal(word, n_word, ignored[i]))
            return WB_OK;
    return reject(reading, 1, "expected a row of frame, info, rigidbody or comment, not '%s'",
                  wb_take_quote(word, n_word).text);
}

static enum wb_status read_with_rows(struct reading *reading, const char *line, size_t n)
{
    reading->unit = 1.0; /* format 1.1 is always in metres */
    strcpy(reading->take->format, "Motive CSV 1.1");
    do {
        if (wb_cells_blank(line, n, reading->delimiter))
            reading->take->empty_rows++;
        else
            WB_TRY(read_line_by_word(reading, line, n));
    } while (wb_cells_lines_next(&reading->lines, &line, &n));
    if (reading->take->n_points == 0)
        return reject(reading, 1, "%s", "no frame contains a marker");
    return WB_OK;
}

/* --- the file --- */

/* The delimiter: the character after the first word. */
static char delimiter_after(const char *line, size_t n, const char *word)
{
    const char *at = line, *const end = line + n;
    at += at < end && *at == '"';
    if (!wb_cells_begins(at, (size_t)(end - at), word))
        return 0;
    at += strlen(word);
    at += at < end && *at == '"';
    if (at == end)
        return ',';
    return *at == ',' || *at == ';' || *at == '\t' ? *at : 0;
}

static char first_delimiter(const char *line, size_t n, bool *with_columns)
{
    static const char *const words[] = {"Format Version", "comment", "righthanded", "lefthanded",
                                        "info",           "frame",   "rigidbody",   "trackable"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        const char delimiter = delimiter_after(line, n, words[i]);
        *with_columns = i == 0;
        if (delimiter)
            return delimiter;
    }
    return 0;
}

static bool first_line(struct wb_cells_lines *lines, const char **line, size_t *n, char *delimiter,
                       bool *with_columns)
{
    while (wb_cells_lines_next(lines, line, n)) {
        if (wb_cells_blank(*line, *n, ','))
            continue;
        *delimiter = first_delimiter(*line, *n, with_columns);
        return *delimiter != 0;
    }
    return false;
}

static bool is_motive_csv(const uint8_t *bytes, size_t n)
{
    struct wb_cells_lines lines;
    const char *line;
    size_t n_line;
    char delimiter;
    bool with_columns;
    /* The beginning of the first line is sufficient. */
    wb_cells_lines_begin(&lines, bytes, n < 4096 ? n : 4096);
    const bool is = first_line(&lines, &line, &n_line, &delimiter, &with_columns);
    wb_cells_lines_release(&lines);
    return is;
}

static enum wb_status read_motive_csv(struct wb_take *take, const char *name, const uint8_t *bytes,
                                      size_t n, struct wb_reason *why)
{
    struct reading reading = {.take = take, .name = name, .why = why};
    const char *line;
    size_t n_line;
    bool with_columns;
    memset(take, 0, sizeof *take);
    wb_cells_lines_begin(&reading.lines, bytes, n);
    enum wb_status status;
    if (!first_line(&reading.lines, &line, &n_line, &reading.delimiter, &with_columns)) {
        status = reject(&reading, 1, "%s", "expected 'Format Version' or 'comment'");
    } else {
        reading.comma = reading.delimiter == ',' ? 0 : ',';
        status = with_columns ? read_with_columns(&reading, line, n_line)
                              : read_with_rows(&reading, line, n_line);
    }
    if (status == WB_OK)
        status = wb_take_finish(take, name, why);
    wb_cells_lines_release(&reading.lines);
    free(reading.columns);
    free(reading.places);
    free(reading.slots);
    if (status != WB_OK)
        wb_take_release(take);
    return status;
}

const struct wb_take_reader wb_motive_csv = {
    .name = "motive-csv", .is = is_motive_csv, .read = read_motive_csv};
