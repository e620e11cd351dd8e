/* CSV exports of Motive: formats 1.20 to 1.25 with columns, and format 1.1 with rows.
 *
 * With columns, the header defines the layout: the first line has keys and values, followed by rows
 * of types, names, IDs, (1.25) parents, kinds and axes above each column; since 1.24 there may be a
 * column of time code between times and data. With rows, the first word of a line is its kind, and
 * the number of cells varies. Columns of type `Marker` were measured by the cameras; `Rigid Body
 * Marker` is solved from the body and filled in while the marker is lost.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "daq/take/take_reader.h"
#include "daq/take/take_rows.h"

#define MOST_HEADER_ROWS 12
#define MOST_COLUMNS 100000
#define MOST_COUNT 1e9 /* of frames by the header */

struct reading {
    struct wb_take *take;
    struct wb_take_rows rows;
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

#define reject(reading, column, ...) wb_take_rows_reject(&(reading)->rows, column, __VA_ARGS__)

static bool is_missing(struct wb_span cell)
{
    /* Fast path: most cells are numbers. */
    if (cell.n > 0 && (unsigned)cell.text[cell.n - 1] - '0' <= 9)
        return false;
    return cell.n == 0 || wb_cells_begins(cell, "nan") || wb_cells_begins(cell, "-nan");
}

/* --- header --- */

static void begin_row(struct reading *reading, struct wb_span line)
{
    wb_cells_begin(&reading->rows.cells, line, reading->rows.delimiter);
}

static bool next_cell(struct reading *reading, struct wb_span *cell)
{
    return wb_cells_next(&reading->rows.cells, cell);
}

/* Finds the cell after the cell `key`. */
static bool find_value(struct reading *reading, struct wb_span line, const char *key,
                       struct wb_span *value)
{
    begin_row(reading, line);
    while (next_cell(reading, value))
        if (wb_cells_equal(*value, key))
            return next_cell(reading, value);
    return false;
}

static void take_count(struct reading *reading, struct wb_span cell)
{
    double count;
    if (wb_cells_number(cell, reading->rows.comma, &count) && count >= 0.0 && count < MOST_COUNT)
        reading->take->declared_frames = (size_t)count;
}

static enum wb_status read_rate(struct reading *reading, struct wb_span line)
{
    static const char *const keys[] = {"Export Frame Rate", "Capture Frame Rate"};
    struct wb_span value;
    for (size_t i = 0; i < 2 && reading->take->rate == 0.0; i++) {
        if (!find_value(reading, line, keys[i], &value) || value.n == 0)
            continue;
        double rate;
        if (!wb_cells_number(value, reading->rows.comma, &rate) || !(rate > 0.0) || !(rate < 1e6))
            return reject(reading, reading->rows.cells.column,
                          "%s: expected a rate in frames/s, not '%s'", keys[i],
                          wb_take_quote(value).text);
        reading->take->rate = rate;
    }
    return WB_OK;
}

static enum wb_status read_keys(struct reading *reading, struct wb_span line)
{
    struct wb_span value;
    char version[16] = "";
    if (find_value(reading, line, "Format Version", &value))
        wb_take_copy_name(version, sizeof version, value);
    if (strncmp(version, "1.2", 3) != 0 && strncmp(version, "1,2", 3) != 0)
        return reject(reading, 2, "Format Version: expected 1.20 to 1.25, not '%s'", version);
    snprintf(reading->take->format, sizeof reading->take->format, "Motive CSV %s", version);
    WB_TRY(read_rate(reading, line));
    if (!find_value(reading, line, "Length Units", &value))
        return reject(reading, 1, "'Length Units' is missing: export again with the header");
    reading->rows.unit = wb_take_length_unit(value);
    if (!(reading->rows.unit > 0.0))
        return reject(reading, reading->rows.cells.column, "unknown unit of length '%s'",
                      wb_take_quote(value).text);
    if (find_value(reading, line, "Coordinate Space", &value) && wb_cells_equal(value, "Local"))
        return reject(reading, reading->rows.cells.column,
                      "local coordinates do not give the positions of markers: export again with "
                      "'Coordinate Space' Global");
    if (find_value(reading, line, "Total Exported Frames", &value))
        take_count(reading, value);
    return WB_OK;
}

/* The rows above the columns. */
struct header {
    size_t n;
    struct wb_span rows[MOST_HEADER_ROWS];
    size_t type, name, kind, axis; /* indices of the rows */
};

static enum wb_status gather_header(struct reading *reading, struct header *header)
{
    struct wb_span line, cell;
    for (;;) {
        if (!wb_cells_lines_next(&reading->rows.lines, &line))
            return reject(reading, 1, "the file ends before a row that begins with 'Frame'");
        if (wb_cells_blank(line, reading->rows.delimiter))
            continue;
        if (header->n == MOST_HEADER_ROWS)
            return reject(reading, 1, "no row begins with 'Frame' among the first %d",
                          MOST_HEADER_ROWS);
        header->rows[header->n++] = line;
        begin_row(reading, line);
        if (next_cell(reading, &cell) && wb_cells_equal(cell, "Frame"))
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
        struct wb_span cell;
        begin_row(reading, header->rows[i]);
        for (int k = 0; k < 3 && next_cell(reading, &cell); k++) {
            if (wb_cells_equal(cell, "Type"))
                header->type = i;
            else if (wb_cells_equal(cell, "Name"))
                header->name = i;
        }
    }
    return WB_OK;
}

static bool kind_of(struct wb_span type, struct wb_span name, enum wb_take_kind *kind)
{
    if (wb_cells_equal(type, "Marker") || wb_cells_equal(type, "Unlabeled Marker"))
        *kind = wb_cells_begins(name, "Unlabeled") ? WB_TAKE_UNLABELLED : WB_TAKE_MARKER;
    else if (wb_cells_equal(type, "Rigid Body Marker") || wb_cells_equal(type, "Bone Marker"))
        *kind = WB_TAKE_SOLVED;
    else if (wb_cells_equal(type, "Rigid Body") || wb_cells_equal(type, "Bone"))
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
        return reject(reading, 1,
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
        wb_cells_begin(&rows[r], header->rows[which[r]], reading->rows.delimiter);
    reading->columns = wb_memory_new(header->rows[header->axis].n + 2, sizeof *reading->columns);
    struct wb_span cell[4];
    while (wb_cells_next(&rows[3], &cell[3])) {
        struct column *const column = &reading->columns[reading->n_columns++];
        for (int r = 0; r < 3; r++)
            if (!wb_cells_next(&rows[r], &cell[r]))
                cell[r] = (struct wb_span){"", 0};
        if (reading->n_columns > MOST_COLUMNS)
            return reject(reading, reading->n_columns, "more than %d columns", MOST_COLUMNS);
        if (wb_cells_equal(cell[3], "Frame"))
            column->role = ROLE_FRAME;
        else if (wb_cells_equal(cell[3], "Time") || wb_cells_begins(cell[3], "Time ("))
            column->role = ROLE_TIME;
        enum wb_take_kind kind;
        if (!wb_cells_equal(cell[2], "Position") || cell[3].n != 1 ||
            !kind_of(cell[0], cell[1], &kind))
            continue;
        const int axis = (*cell[3].text | 0x20) - 'x';
        if (axis < 0 || axis > 2)
            return reject(reading, reading->n_columns, "axis: expected X, Y or Z, not '%c'",
                          *cell[3].text);
        const struct wb_take_quoted name = wb_take_quote(cell[1]);
        if (axes >> axis & 1 || kind != last_kind || strcmp(name.text, last.text) != 0) {
            wb_take_add_point(reading->take, kind, cell[1]);
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

/* Reads a coordinate; NaN if the cell is empty. */
static enum wb_status take_coordinate(struct reading *reading, struct wb_span cell, double *value)
{
    *value = (double)NAN;
    return is_missing(cell) ? WB_OK : wb_take_rows_coordinate(&reading->rows, cell, value);
}

static void add_point(struct reading *reading, uint32_t point, const double position[3])
{
    if (isfinite(position[0]) && isfinite(position[1]) && isfinite(position[2]))
        wb_take_add_place(reading->take, point, position);
}

/* Reads a row of data. A row with another number of cells than the header is skipped: it is unknown
 * which cell is missing. */
static enum wb_status read_row(struct reading *reading, struct wb_span line)
{
    struct wb_take_rows *const rows = &reading->rows;
    struct wb_span cell;
    int32_t number = 0;
    double t = 0.0;
    begin_row(reading, line);
    for (size_t i = 0; i < reading->n_columns; i++) {
        if (!next_cell(reading, &cell))
            return wb_take_rows_skip(rows);
        const struct column *const column = &reading->columns[i];
        if (column->role == ROLE_AXIS)
            WB_TRY(take_coordinate(reading, cell, &reading->places[column->point][column->axis]));
        else if (column->role == ROLE_FRAME)
            WB_TRY(wb_take_rows_number(rows, cell, &number));
        else if (column->role == ROLE_TIME)
            WB_TRY(wb_take_rows_time(rows, cell, &t));
    }
    if (wb_take_rows_has_more(rows) || !wb_take_add_frame(reading->take, number, t))
        return wb_take_rows_skip(rows);
    for (size_t i = 0; i < reading->take->n_points; i++)
        add_point(reading, (uint32_t)i, reading->places[i]);
    return WB_OK;
}

static enum wb_status read_data(struct reading *reading)
{
    struct wb_span line;
    char cells[48];
    reading->places = wb_memory_new(reading->take->n_points, sizeof *reading->places);
    while (wb_take_rows_next(&reading->rows, &line))
        WB_TRY(read_row(reading, line));
    snprintf(cells, sizeof cells, "the %zu cells of the header", reading->n_columns);
    return wb_take_rows_check(&reading->rows, cells);
}

static enum wb_status read_with_columns(struct reading *reading, struct wb_span line)
{
    struct header header = {0};
    WB_TRY(read_keys(reading, line));
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

static uint32_t point_of_id(struct reading *reading, int32_t id, struct wb_span name)
{
    grow_slots(reading);
    struct slot *const slot = find_slot(reading, (uint64_t)(uint32_t)id + 1);
    if (!slot->used) {
        char text[80], given[64];
        wb_take_copy_name(given, sizeof given, name);
        snprintf(text, sizeof text, "%s%s%d", given, given[0] ? ":" : "Unlabeled ", id);
        const size_t added =
            wb_take_add_point(reading->take, given[0] ? WB_TAKE_MARKER : WB_TAKE_UNLABELLED,
                              (struct wb_span){text, strlen(text)});
        *slot = (struct slot){
            .key = (uint64_t)(uint32_t)id + 1, .point = (uint32_t)added, .used = true};
    }
    return slot->point;
}

static enum wb_status need_count(struct reading *reading, const char *what, size_t *count)
{
    struct wb_span cell;
    double value;
    if (!next_cell(reading, &cell))
        return reject(reading, reading->rows.cells.column, "the row ends before %s", what);
    if (!wb_cells_number(cell, 0, &value) || value != floor(value) || !(value >= 0.0) ||
        !(value <= 1e6))
        return reject(reading, reading->rows.cells.column, "expected %s, not '%s'", what,
                      wb_take_quote(cell).text);
    *count = (size_t)value;
    return WB_OK;
}

/* Counts the remaining cells of the row, with and without empty cells at its end. */
static void count_left(struct wb_cells cells, size_t *all, size_t *filled)
{
    struct wb_span cell;
    *all = *filled = 0;
    while (wb_cells_next(&cells, &cell)) {
        ++*all;
        *filled = cell.n > 0 ? *all : *filled;
    }
}

/* Reads markers: x, y, z, id and, in some versions, a name. */
static enum wb_status read_markers(struct reading *reading, size_t n_markers)
{
    const struct wb_cells *const cells = &reading->rows.cells;
    size_t all, filled;
    count_left(*cells, &all, &filled);
    const bool named = filled > 4 * n_markers;
    /* With another number of cells their meaning is ambiguous. */
    if (named && (all < 5 * n_markers || filled > 5 * n_markers))
        return reject(reading, cells->column + 1,
                      "%zu cells for %zu markers: expected 4 or 5 per marker", filled, n_markers);
    for (size_t i = 0; i < n_markers; i++) {
        struct wb_span cell, name = {"", 0};
        double position[3];
        int32_t id;
        for (int k = 0; k < 3; k++) {
            if (!next_cell(reading, &cell))
                return reject(reading, cells->column, "the row ends within marker %zu of %zu",
                              i + 1, n_markers);
            WB_TRY(take_coordinate(reading, cell, &position[k]));
        }
        if (!next_cell(reading, &cell))
            return reject(reading, cells->column, "the row ends before the id of marker %zu",
                          i + 1);
        WB_TRY(wb_take_rows_number(&reading->rows, cell, &id));
        if (named)
            (void)next_cell(reading, &name);
        add_point(reading, point_of_id(reading, id, name), position);
    }
    return WB_OK;
}

/* Reads a row: frame, number, time, number of bodies, 11 cells per body, number of markers, 4 or 5
 * cells per marker. */
static enum wb_status read_frame(struct reading *reading)
{
    enum {
        CELLS_OF_BODY = 11
    };
    const struct wb_cells *const cells = &reading->rows.cells;
    struct wb_span cell;
    size_t n_bodies, n_markers;
    int32_t number;
    double t;
    if (!next_cell(reading, &cell))
        return reject(reading, cells->column, "the row ends before the frame number");
    WB_TRY(wb_take_rows_number(&reading->rows, cell, &number));
    if (!next_cell(reading, &cell))
        return reject(reading, cells->column, "the row ends before the time");
    WB_TRY(wb_take_rows_time(&reading->rows, cell, &t));
    WB_TRY(need_count(reading, "the number of rigid bodies", &n_bodies));
    for (size_t i = 0; i < CELLS_OF_BODY * n_bodies; i++)
        if (!next_cell(reading, &cell))
            return reject(reading, cells->column, "the row ends within its %zu rigid bodies",
                          n_bodies);
    WB_TRY(need_count(reading, "the number of markers", &n_markers));
    if (!wb_take_add_frame(reading->take, number, t))
        return wb_take_rows_skip(&reading->rows);
    return read_markers(reading, n_markers);
}

static void read_info(struct reading *reading)
{
    struct wb_span key, value;
    if (!next_cell(reading, &key) || !next_cell(reading, &value))
        return;
    if (wb_cells_equal(key, "version"))
        snprintf(reading->take->format, sizeof reading->take->format, "Motive CSV %.16s",
                 wb_take_quote(value).text);
    else if (wb_cells_equal(key, "framecount"))
        take_count(reading, value);
}

static enum wb_status read_line_by_word(struct reading *reading, struct wb_span line)
{
    static const char *const ignored[] = {"comment",   "righthanded", "lefthanded", "rigidbody",
                                          "trackable", "skeleton",    "forceplate", "device"};
    struct wb_span word;
    begin_row(reading, line);
    if (!next_cell(reading, &word))
        return WB_OK;
    if (wb_cells_equal(word, "frame"))
        return reading->rows.lines.terminated ? read_frame(reading)
                                              : wb_take_rows_skip(&reading->rows);
    if (wb_cells_equal(word, "info")) {
        read_info(reading);
        return WB_OK;
    }
    for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++)
        if (wb_cells_equal(word, ignored[i]))
            return WB_OK;
    return reject(reading, 1, "expected a row of frame, info, rigidbody or comment, not '%s'",
                  wb_take_quote(word).text);
}

static enum wb_status read_with_rows(struct reading *reading, struct wb_span line)
{
    reading->rows.unit = 1.0; /* format 1.1 is always in metres */
    strcpy(reading->take->format, "Motive CSV 1.1");
    do {
        if (wb_cells_blank(line, reading->rows.delimiter))
            reading->take->empty_rows++;
        else
            WB_TRY(read_line_by_word(reading, line));
    } while (wb_cells_lines_next(&reading->rows.lines, &line));
    if (reading->take->n_points == 0)
        return reject(reading, 1, "no frame contains a marker");
    return WB_OK;
}

/* --- the file --- */

/* The delimiter: the character after the first word. */
static char delimiter_after(struct wb_span line, const char *word)
{
    const char *at = line.text, *const end = at + line.n;
    at += at < end && *at == '"';
    if (!wb_cells_begins((struct wb_span){at, (size_t)(end - at)}, word))
        return 0;
    at += strlen(word);
    at += at < end && *at == '"';
    if (at == end)
        return ',';
    return *at == ',' || *at == ';' || *at == '\t' ? *at : 0;
}

/* Reads the first line; returns its delimiter, 0: this is no export of Motive. */
static char first_delimiter(struct wb_cells_lines *lines, struct wb_span *line, bool *with_columns)
{
    static const char *const words[] = {"Format Version", "comment", "righthanded", "lefthanded",
                                        "info",           "frame",   "rigidbody",   "trackable"};
    char delimiter = 0;
    bool found = wb_cells_lines_next(lines, line);
    while (found && wb_cells_blank(*line, ','))
        found = wb_cells_lines_next(lines, line);
    for (size_t i = 0; found && !delimiter && i < sizeof words / sizeof words[0]; i++) {
        delimiter = delimiter_after(*line, words[i]);
        *with_columns = i == 0;
    }
    return delimiter;
}

static bool is_motive_csv(const uint8_t *bytes, size_t n)
{
    struct wb_cells_lines lines;
    struct wb_span line;
    bool with_columns;
    /* The beginning of the first line is sufficient. */
    wb_cells_lines_begin(&lines, bytes, n < 4096 ? n : 4096);
    const bool is = first_delimiter(&lines, &line, &with_columns) != 0;
    wb_cells_lines_release(&lines);
    return is;
}

static enum wb_status read_all(struct reading *reading)
{
    struct wb_take_rows *const rows = &reading->rows;
    struct wb_span line;
    bool with_columns;
    rows->delimiter = first_delimiter(&rows->lines, &line, &with_columns);
    if (!rows->delimiter)
        return reject(reading, 1, "expected 'Format Version' or 'comment'");
    rows->comma = rows->delimiter == ',' ? 0 : ',';
    return with_columns ? read_with_columns(reading, line) : read_with_rows(reading, line);
}

static enum wb_status read_motive_csv(struct wb_take *take, const char *name, const uint8_t *bytes,
                                      size_t n, struct wb_reason *why)
{
    struct reading reading = {
        .take = take,
        .rows = {.take = take, .name = name, .domain = "motive", .why = why},
    };
    memset(take, 0, sizeof *take);
    wb_cells_lines_begin(&reading.rows.lines, bytes, n);
    const enum wb_status status = read_all(&reading);
    wb_cells_lines_release(&reading.rows.lines);
    free(reading.columns);
    free(reading.places);
    free(reading.slots);
    return wb_take_finish(take, status, name, why);
}

const struct wb_take_reader wb_motive_csv = {
    .name = "motive-csv", .is = is_motive_csv, .read = read_motive_csv};
