#include "analysis/dataset/dataset.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/csv_table.h"
#include "analysis/dataset/dataset_private.h"
#include "base/config.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/number.h"
#include "base/text.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "dataset"

/* Version of dataset.json's layout. */
#define SCHEMA 1
/* Limit of the columns of a table. */
#define MAX_COLUMNS 64

enum loading {
    LOADING_TIP,
    LOADING_FOLLOWER,
    LOADING_GENERAL
};

static const char *const loading_names[] = {"tip", "follower", "general", NULL};

static enum loading loading_of(const struct wb_test_info *info)
{
    if (info->is_general)
        return LOADING_GENERAL;
    return info->is_follower ? LOADING_FOLLOWER : LOADING_TIP;
}

/* theta0(s) = sum_i b_i u^(i+1), u = s/L, and its derivative over s by Horner's scheme. */
static double natural_angle(const struct wb_test_info *info, double u)
{
    double sum = 0.0;
    for (int i = info->n_natural_shape - 1; i >= 0; i--)
        sum = (sum + info->natural_shape[i]) * u;
    return sum;
}

double wb_dataset_natural_curvature(void *context, double arc_length)
{
    const struct wb_test_info *const info = context;
    const double u = arc_length / info->length;
    double sum = 0.0;
    for (int i = info->n_natural_shape - 1; i >= 0; i--)
        sum = sum * u + (i + 1) * info->natural_shape[i];
    return sum / info->length;
}

double wb_dataset_bow(const struct wb_test_info *info)
{
    if (info->n_natural_shape == 0)
        return 0.0;
    /* Simpson's rule; 64 intervals of a polynomial angle leave less than 1e-9 of it. */
    enum {
        N = 64
    };
    double sum = 0.0;
    for (int i = 0; i <= N; i++) {
        const double weight = i == 0 || i == N ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight * sin(natural_angle(info, (double)i / N));
    }
    return sum * info->length / (3.0 * N);
}

bool wb_dataset_is_complete(const struct wb_dataset *dataset)
{
    bool complete;
    return wb_json_get_boolean(dataset->document, "complete", &complete) && complete;
}

void wb_dataset_init(struct wb_dataset *dataset)
{
    memset(dataset, 0, sizeof *dataset);
    dataset->info.rest_level = (double)NAN;
    dataset->document = wb_json_create();
    wb_json_set_integer(dataset->document, "schema", SCHEMA);
}

void wb_dataset_release(struct wb_dataset *dataset)
{
    free(dataset->rows);
    free(dataset->shape_rows);
    wb_json_destroy(dataset->document);
    memset(dataset, 0, sizeof *dataset);
}

/* The capacity is not stored: memory is grown when the count is a power of two, so it always holds
 * the next power of two. */
static void *grown(void *rows, size_t n, size_t row_size)
{
    if (n != 0 && (n & (n - 1)) != 0)
        return rows;
    return wb_memory_resize(rows, n == 0 ? 1 : 2 * n, row_size);
}

void wb_dataset_add_row(struct wb_dataset *dataset, const struct wb_row *row)
{
    dataset->rows = grown(dataset->rows, dataset->n_rows, sizeof *row);
    dataset->rows[dataset->n_rows++] = *row;
}

void wb_dataset_add_shape_row(struct wb_dataset *dataset, const struct wb_shape_row *row)
{
    dataset->shape_rows = grown(dataset->shape_rows, dataset->n_shape_rows, sizeof *row);
    dataset->shape_rows[dataset->n_shape_rows++] = *row;
}

/* --- dataset.json: the typed part --- */

/* Rounds to 15 digits, as in settings files: a length of 0.085 m is written as 85, not as
 * 85.000000000000014. */
static void set_scaled(struct wb_json *object, const char *key, double value, double unit)
{
    char text[40];
    snprintf(text, sizeof text, "%.15g", value / unit);
    wb_json_set_number(object, key, isfinite(value) ? strtod(text, NULL) : (double)NAN);
}

static const struct stated {
    const char *key;
    size_t offset; /* in struct wb_test_uncertainty */
    double unit;
} stated[] = {
    {"u_gain_percent", offsetof(struct wb_test_uncertainty, gain), WB_PERCENT},
    {"u_length_mm", offsetof(struct wb_test_uncertainty, length), WB_MM},
    {"u_counterweight_g", offsetof(struct wb_test_uncertainty, counterweight), WB_G},
    {"u_outer_diameter_mm", offsetof(struct wb_test_uncertainty, diameter), WB_MM},
    {"u_density_percent", offsetof(struct wb_test_uncertainty, density), WB_PERCENT},
    {"u_marker_offset_mm", offsetof(struct wb_test_uncertainty, marker_offset), WB_MM},
};

/* Sets the uncertainties that are stated. */
static void set_uncertainty(struct wb_json *test, const struct wb_test_uncertainty *uncertainty)
{
    for (size_t i = 0; i < WB_COUNT(stated); i++) {
        double u;
        memcpy(&u, (const char *)uncertainty + stated[i].offset, sizeof u);
        if (u > 0.0)
            set_scaled(test, stated[i].key, u, stated[i].unit);
    }
}

static enum wb_status get_uncertainty(const struct wb_json *test, const char *path,
                                      struct wb_test_uncertainty *uncertainty,
                                      struct wb_reason *why)
{
    for (size_t i = 0; i < WB_COUNT(stated); i++) {
        double u = 0.0;
        if (wb_json_get(test, stated[i].key) &&
            (!wb_json_get_number(test, stated[i].key, &u) || !(u > 0.0)))
            return wb_fail_to(why, WB_ERR_FORMAT,
                              "%s: test.%s: expected a positive number, or no such key", path,
                              stated[i].key);
        u *= stated[i].unit;
        memcpy((char *)uncertainty + stated[i].offset, &u, sizeof u);
    }
    return WB_OK;
}

static void set_info(struct wb_json *document, const struct wb_test_info *info)
{
    struct wb_json *const test = wb_json_set_object(document, "test");
    wb_json_set_text(test, "wire", info->wire);
    wb_json_set_integer(test, "sample", info->sample);
    set_scaled(test, "length_mm", info->length, WB_MM);
    set_scaled(test, "outer_diameter_mm", info->outer_diameter, WB_MM);
    wb_json_set_number(test, "mass_per_length_kg_m", info->mass_per_length);
    wb_json_set_number(test, "poissons_ratio", info->poissons_ratio);
    wb_json_set_text(test, "loading", loading_names[loading_of(info)]);
    set_scaled(test, "strand_length_mm", info->strand_length, WB_MM);
    set_scaled(test, "counterweight_g", info->counterweight, WB_G);
    wb_json_set_number(test, "gravity_m_s2", info->gravity);
    set_scaled(test, "rest_level_mm", info->rest_level, WB_MM);
    struct wb_json *const shape = wb_json_set_array(test, "natural_shape_rad");
    for (int i = 0; i < info->n_natural_shape; i++)
        wb_json_append_number(shape, info->natural_shape[i]);
    set_scaled(test, "natural_bow_mm", wb_dataset_bow(info), WB_MM);
    set_uncertainty(test, &info->uncertainty);
    wb_json_set_boolean(test, "virtual_rig", info->is_virtual);
    wb_json_set_boolean(test, "simulation", info->is_simulation);
    if (info->kind != WB_TEST_CANTILEVER)
        wb_json_set_text(test, "kind", wb_machine_kind_name(info->kind));
    if (!info->has_machine)
        return;
    wb_machine_set_json(&info->machine, wb_json_set_object(document, "machine"));
    wb_test_piece_set_json(&info->piece, wb_json_set_object(document, "test_piece"));
}

static enum wb_status get_number(const struct wb_json *test, const char *path, const char *key,
                                 double unit, double *value, struct wb_reason *why)
{
    double read;
    if (!wb_json_get_number(test, key, &read))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.%s: expected a number", path, key);
    *value = read * unit;
    return WB_OK;
}

static enum wb_status get_flag(const struct wb_json *test, const char *path, const char *key,
                               bool *value, struct wb_reason *why)
{
    if (!wb_json_get_boolean(test, key, value))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.%s: expected true or false", path, key);
    return WB_OK;
}

static enum wb_status get_shape(const struct wb_json *test, const char *path,
                                struct wb_test_info *info, struct wb_reason *why)
{
    const struct wb_json *const shape = wb_json_get(test, "natural_shape_rad");
    const size_t n = wb_json_length(shape);
    if (!shape || n > sizeof info->natural_shape / sizeof info->natural_shape[0])
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: test.natural_shape_rad: expected an array of at most 4 numbers",
                          path);
    for (size_t i = 0; i < n; i++) {
        if (!wb_json_number(wb_json_item(shape, i), &info->natural_shape[i]))
            return wb_fail_to(why, WB_ERR_FORMAT,
                              "%s: test.natural_shape_rad: item %zu is not a number", path, i + 1);
    }
    info->n_natural_shape = (int)n;
    return WB_OK;
}

/* Older files lack the key: their force is the strand's, or vertical. */
static enum wb_status get_loading(const struct wb_json *test, const char *path,
                                  struct wb_test_info *info, struct wb_reason *why)
{
    const char *name = loading_names[LOADING_TIP];
    int loading;
    if (wb_json_get(test, "loading") && !wb_json_get_text(test, "loading", &name))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.loading: expected a text", path);
    if (!wb_machine_find_name(loading_names, name, &loading))
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: test.loading: expected %s, %s or %s, not '%.40s'", path,
                          loading_names[LOADING_TIP], loading_names[LOADING_FOLLOWER],
                          loading_names[LOADING_GENERAL], name);
    info->is_follower = loading == LOADING_FOLLOWER;
    info->is_general = loading == LOADING_GENERAL;
    if (info->is_follower && info->strand_length != 0.0)
        return wb_fail_to(
            why, WB_ERR_FORMAT,
            "%s: test.strand_length_mm: a follower force is not a strand's: expected 0", path);
    return WB_OK;
}

/* Datasets without the key are cantilever tests. */
static enum wb_status get_kind(const struct wb_json *document, const struct wb_json *test,
                               const char *path, struct wb_test_info *info, struct wb_reason *why)
{
    const char *name = wb_machine_kind_name(WB_TEST_CANTILEVER);
    if (wb_json_get(test, "kind") && !wb_json_get_text(test, "kind", &name))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.kind: expected a text", path);
    if (!wb_machine_kind_find(name, &info->kind))
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: test.kind: expected cantilever, three-point or tensile, not '%.40s'",
                          path, name);
    const struct wb_json *const machine = wb_json_get(document, "machine");
    info->has_machine = machine != NULL;
    if (!machine && info->kind == WB_TEST_CANTILEVER)
        return WB_OK;
    WB_TRY(wb_machine_get_json(&info->machine, machine, path, why));
    WB_TRY(wb_test_piece_get_json(&info->piece, wb_json_get(document, "test_piece"), path, why));
    if (info->machine.kind != info->kind)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: machine.kind: expected %s, as test.kind", path,
                          name);
    return WB_OK;
}

static enum wb_status get_info(const struct wb_json *document, const char *path,
                               struct wb_test_info *info, struct wb_reason *why)
{
    const struct wb_json *const test = wb_json_get(document, "test");
    const char *wire;
    int64_t sample;
    if (!test)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: no object 'test': this is not a dataset", path);
    if (!wb_json_get_text(test, "wire", &wire) || strlen(wire) >= sizeof info->wire)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.wire: expected a text of at most %zu bytes",
                          path, sizeof info->wire - 1);
    strcpy(info->wire, wire);
    if (!wb_json_get_integer(test, "sample", &sample) || sample < 0 || sample > INT32_MAX)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: test.sample: expected a whole number from 0",
                          path);
    info->sample = (int)sample;
    WB_TRY(get_number(test, path, "length_mm", WB_MM, &info->length, why));
    WB_TRY(get_number(test, path, "outer_diameter_mm", WB_MM, &info->outer_diameter, why));
    WB_TRY(get_number(test, path, "mass_per_length_kg_m", 1.0, &info->mass_per_length, why));
    WB_TRY(get_number(test, path, "poissons_ratio", 1.0, &info->poissons_ratio, why));
    WB_TRY(get_number(test, path, "strand_length_mm", WB_MM, &info->strand_length, why));
    WB_TRY(get_loading(test, path, info, why));
    WB_TRY(get_number(test, path, "counterweight_g", WB_G, &info->counterweight, why));
    WB_TRY(get_number(test, path, "gravity_m_s2", 1.0, &info->gravity, why));
    if (wb_json_get_number(test, "rest_level_mm", &info->rest_level))
        info->rest_level *= WB_MM;
    else
        info->rest_level = (double)NAN;
    if (!(info->length > 0.0) || !(info->outer_diameter > 0.0))
        return wb_fail_to(why, WB_ERR_FORMAT,
                          "%s: test.length_mm and test.outer_diameter_mm must be positive", path);
    WB_TRY(get_shape(test, path, info, why));
    WB_TRY(get_uncertainty(test, path, &info->uncertainty, why));
    WB_TRY(get_flag(test, path, "virtual_rig", &info->is_virtual, why));
    WB_TRY(get_flag(test, path, "simulation", &info->is_simulation, why));
    return get_kind(document, test, path, info, why);
}

/* --- the tables --- */

enum kind {
    KIND_NUMBER,   /* required */
    KIND_OPTIONAL, /* empty means not known; the whole column may be missing */
    KIND_EXTRA,    /* the same, and not written where it is unknown or zero in every row */
    KIND_INTEGER,
    KIND_PHASE
};

struct column {
    const char *name;
    enum kind kind;
    size_t offset; /* of the member */
    int shift;     /* decimal places from SI to the file's unit */
};

static const struct column row_columns[] = {
    {"t_s", KIND_NUMBER, offsetof(struct wb_row, t), 0},
    {"cycle", KIND_INTEGER, offsetof(struct wb_row, cycle), 0},
    {"phase", KIND_PHASE, offsetof(struct wb_row, phase), 0},
    {"deflection_mm", KIND_NUMBER, offsetof(struct wb_row, deflection), 3},
    {"tension_N", KIND_OPTIONAL, offsetof(struct wb_row, tension), 0},
    {"force_N", KIND_NUMBER, offsetof(struct wb_row, force), 0},
    {"stage_mm", KIND_OPTIONAL, offsetof(struct wb_row, stage), 3},
    {"tip_x_mm", KIND_OPTIONAL, offsetof(struct wb_row, tip_x), 3},
    {"tip_angle_rad", KIND_OPTIONAL, offsetof(struct wb_row, tip_angle), 0},
    {0},
};

/* Files of testing machines may have no time; the other columns are the same. */
static void columns_of(const struct wb_test_info *info,
                       struct column columns[WB_COUNT(row_columns)])
{
    memcpy(columns, row_columns, sizeof row_columns);
    if (info->kind != WB_TEST_CANTILEVER)
        columns[0].kind = KIND_OPTIONAL;
}

static const struct column shape_columns[] = {
    {"t_s", KIND_NUMBER, offsetof(struct wb_shape_row, t), 0},
    {"deflection_mm", KIND_NUMBER, offsetof(struct wb_shape_row, deflection), 3},
    {"marker", KIND_INTEGER, offsetof(struct wb_shape_row, marker), 0},
    {"s_mm", KIND_NUMBER, offsetof(struct wb_shape_row, s), 3},
    {"x_mm", KIND_NUMBER, offsetof(struct wb_shape_row, x), 3},
    {"y_mm", KIND_NUMBER, offsetof(struct wb_shape_row, y), 3},
    {"z_mm", KIND_EXTRA, offsetof(struct wb_shape_row, z), 3},
    {0},
};

/* The members are doubles, ints or a phase: memcpy() works for all three without aliasing. */
static enum wb_status append_field(struct wb_text *text, const struct column *column,
                                   const void *row, size_t index)
{
    const char *const member = (const char *)row + column->offset;
    if (column->kind == KIND_INTEGER) {
        int value;
        memcpy(&value, member, sizeof value);
        wb_text_append(text, "%d", value);
    } else if (column->kind == KIND_PHASE) {
        enum wb_phase phase;
        memcpy(&phase, member, sizeof phase);
        wb_text_append(text, "%s", wb_trial_phase_name(phase));
    } else {
        double value;
        memcpy(&value, member, sizeof value);
        if (!isfinite(value) && column->kind == KIND_NUMBER)
            return wb_fail(WB_ERR_ARGUMENT, "row %zu of a dataset has no %s", index + 1,
                           column->name);
        wb_csv_table_append_number(text, value, column->shift);
    }
    return WB_OK;
}

/* An extra column comes last in its table, so leaving it out ends the columns. */
static bool is_written(const struct column *column, const void *rows, size_t n, size_t row_size)
{
    if (!column->name || column->kind != KIND_EXTRA)
        return column->name != NULL;
    for (size_t i = 0; i < n; i++) {
        double value;
        memcpy(&value, (const char *)rows + i * row_size + column->offset, sizeof value);
        if (isfinite(value) && value != 0.0)
            return true;
    }
    return false;
}

static enum wb_status append_table(struct wb_text *text, const struct column *columns,
                                   const void *rows, size_t n, size_t row_size)
{
    const struct column *end = columns;
    for (; is_written(end, rows, n, row_size); end++)
        wb_text_append(text, "%s%s", end == columns ? "" : ",", end->name);
    wb_text_append_bytes(text, "\n", 1);
    for (size_t i = 0; i < n; i++) {
        const void *const row = (const char *)rows + i * row_size;
        for (const struct column *column = columns; column < end; column++) {
            if (column != columns)
                wb_text_append_bytes(text, ",", 1);
            WB_TRY(append_field(text, column, row, i));
        }
        wb_text_append_bytes(text, "\n", 1);
    }
    return WB_OK;
}

/* Appends both tables. WB_ERR_ARGUMENT when a row lacks time, deflection or force. */
static enum wb_status format_tables(const struct wb_dataset *dataset, struct wb_text *rows,
                                    struct wb_text *shapes)
{
    if (dataset->info.is_virtual) {
        wb_text_append(rows, "# virtual rig\n");
        wb_text_append(shapes, "# virtual rig\n");
    }
    struct column columns[WB_COUNT(row_columns)];
    columns_of(&dataset->info, columns);
    WB_TRY(append_table(rows, columns, dataset->rows, dataset->n_rows, sizeof *dataset->rows));
    return append_table(shapes, shape_columns, dataset->shape_rows, dataset->n_shape_rows,
                        sizeof *dataset->shape_rows);
}

/* --- reading tables --- */

/* A table that is being read: its lines, and the column of each field. */
struct reader {
    struct wb_csv_table table; /* its path, line and reason */
    char *text;                /* not read yet */
    int n_fields;
    const struct column *fields[MAX_COLUMNS]; /* NULL: unknown column, skipped */
};

static const struct column *find_column(const struct column *columns, const char *name)
{
    for (const struct column *column = columns; column->name; column++) {
        if (strcmp(column->name, name) == 0)
            return column;
    }
    return NULL;
}

static enum wb_status check_columns(const struct reader *reader, const struct column *columns)
{
    for (const struct column *column = columns; column->name; column++) {
        int count = 0;
        for (int i = 0; i < reader->n_fields; i++)
            count += reader->fields[i] == column;
        if (count == 0 && column->kind != KIND_OPTIONAL && column->kind != KIND_EXTRA)
            return wb_csv_table_fail(&reader->table, "no column '%s'", column->name);
        if (count > 1)
            return wb_csv_table_fail(&reader->table, "column '%s' appears twice", column->name);
    }
    return WB_OK;
}

static enum wb_status read_header(struct reader *reader, const struct column *columns)
{
    char *rest;
    do
        rest = wb_csv_table_line(&reader->table, &reader->text);
    while (rest && *rest == '#');
    if (!rest)
        return wb_fail_to(reader->table.why, WB_ERR_FORMAT,
                          "%s:%d: empty file, expected a line of column names", reader->table.path,
                          reader->table.line + 1);
    while (rest) {
        const char *const name = strsep(&rest, ",");
        if (reader->n_fields == MAX_COLUMNS)
            return wb_csv_table_fail(&reader->table, "more than %d columns", MAX_COLUMNS);
        reader->fields[reader->n_fields++] = find_column(columns, name);
    }
    return check_columns(reader, columns);
}

static bool parse_phase(const char *text, enum wb_phase *phase)
{
    for (int i = WB_PHASE_LOAD; i <= WB_PHASE_SLACK; i++) {
        if (strcmp(text, wb_trial_phase_name((enum wb_phase)i)) == 0) {
            *phase = (enum wb_phase)i;
            return true;
        }
    }
    return false;
}

static enum wb_status parse_field(const struct reader *reader, const struct column *column,
                                  const char *text, void *row)
{
    char *const member = (char *)row + column->offset;
    const char *expected = "a number";
    if (column->kind == KIND_INTEGER) {
        long value;
        if (wb_number_parse_integer(text, &value) && value >= 0 && value <= 1000000) {
            const int integer = (int)value;
            memcpy(member, &integer, sizeof integer);
            return WB_OK;
        }
        expected = "a whole number from 0 to 1000000";
    } else if (column->kind == KIND_PHASE) {
        enum wb_phase phase;
        if (parse_phase(text, &phase)) {
            memcpy(member, &phase, sizeof phase);
            return WB_OK;
        }
        expected = "load, unload or slack";
    } else {
        double value = (double)NAN;
        const bool may_lack = column->kind == KIND_OPTIONAL || column->kind == KIND_EXTRA;
        if ((may_lack && *text == '\0') || wb_csv_table_parse_number(text, column->shift, &value)) {
            memcpy(member, &value, sizeof value);
            return WB_OK;
        }
    }
    return wb_csv_table_fail(&reader->table, "%s: expected %s, not '%.40s'", column->name, expected,
                             text);
}

static enum wb_status parse_line(const struct reader *reader, char *line, void *row)
{
    char *rest = line;
    for (int i = 0; i < reader->n_fields; i++) {
        if (!rest)
            return wb_csv_table_fail(&reader->table, "%d fields, expected %d", i, reader->n_fields);
        const char *const field = strsep(&rest, ",");
        if (reader->fields[i])
            WB_TRY(parse_field(reader, reader->fields[i], field, row));
    }
    if (rest)
        return wb_csv_table_fail(&reader->table, "more than %d fields", reader->n_fields);
    return WB_OK;
}

static enum wb_status start_reading(struct reader *reader, const char *path, char *text, size_t n,
                                    const struct column *columns, struct wb_reason *why)
{
    *reader = (struct reader){.table = {.path = path, .why = why}, .text = text};
    const char *const zero = memchr(text, '\0', n);
    if (zero)
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: byte 0 at offset %td: not a text file", path,
                          zero - text);
    return read_header(reader, columns);
}

enum wb_status wb_dataset_parse_rows(struct wb_dataset *dataset, const char *path, char *text,
                                     size_t n, struct wb_reason *why)
{
    struct reader reader;
    char *line;
    struct column columns[WB_COUNT(row_columns)];
    columns_of(&dataset->info, columns);
    WB_TRY(start_reading(&reader, path, text, n, columns, why));
    while ((line = wb_csv_table_line(&reader.table, &reader.text))) {
        struct wb_row row = {.t = (double)NAN,
                             .tension = (double)NAN,
                             .stage = (double)NAN,
                             .tip_x = (double)NAN,
                             .tip_angle = (double)NAN};
        WB_TRY(parse_line(&reader, line, &row));
        wb_dataset_add_row(dataset, &row);
    }
    return WB_OK;
}

enum wb_status wb_dataset_parse_shapes(struct wb_dataset *dataset, const char *path, char *text,
                                       size_t n, struct wb_reason *why)
{
    struct reader reader;
    char *line;
    WB_TRY(start_reading(&reader, path, text, n, shape_columns, why));
    while ((line = wb_csv_table_line(&reader.table, &reader.text))) {
        struct wb_shape_row row = {.z = (double)NAN};
        WB_TRY(parse_line(&reader, line, &row));
        wb_dataset_add_shape_row(dataset, &row);
    }
    return WB_OK;
}

/* --- the folder --- */

/* Sets the typed data into a copy; the caller's document does not change. */
static enum wb_status format_document(const struct wb_dataset *dataset, char **text)
{
    struct wb_json *copy;
    char *const raw = wb_json_format(dataset->document);
    const enum wb_status parsed = wb_json_parse(&copy, raw, "dataset document");
    free(raw);
    WB_TRY(parsed);
    set_info(copy, &dataset->info);
    *text = wb_json_format(copy);
    wb_json_destroy(copy);
    return WB_OK;
}

enum wb_status wb_dataset_begin(const char *folder, bool force)
{
    /* dataset.json first: its presence marks a complete folder. */
    static const char *const names[] = {"dataset.json", "fields.csv", "energies.csv",
                                        "surface.csv"};

    WB_TRY(wb_file_prepare_output(folder, force));
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        WB_TRY(wb_csv_table_write(folder, names[i], NULL));
    return WB_OK;
}

struct texts {
    char *document;
    struct wb_text rows, shapes;
};

static void release_texts(struct texts *texts)
{
    free(texts->document);
    wb_text_release(&texts->rows);
    wb_text_release(&texts->shapes);
}

static enum wb_status format_texts(const struct wb_dataset *dataset, struct texts *texts)
{
    *texts = (struct texts){.document = NULL};
    if (dataset->info.is_follower && dataset->info.strand_length != 0.0)
        return wb_fail(WB_ERR_ARGUMENT,
                       "the dataset has a follower force and a strand: expected one of them");
    WB_TRY(format_document(dataset, &texts->document));
    return format_tables(dataset, &texts->rows, &texts->shapes);
}

static enum wb_status write_texts(const struct texts *texts, const char *folder)
{
    char path[WB_PATH];
    WB_TRY(wb_csv_table_write(folder, "force_deflection.csv", &texts->rows));
    WB_TRY(wb_csv_table_write(folder, "shape.csv", &texts->shapes));
    WB_TRY(wb_file_join(path, folder, "dataset.json"));
    return wb_file_write(path, texts->document, strlen(texts->document));
}

enum wb_status wb_dataset_finish(const struct wb_dataset *dataset, const char *folder)
{
    struct texts texts;

    enum wb_status status = format_texts(dataset, &texts);
    if (status == WB_OK)
        status = write_texts(&texts, folder);
    release_texts(&texts);
    return status;
}

/* Formats before the folder changes, so that a failure leaves an existing dataset intact. */
enum wb_status wb_dataset_write(const struct wb_dataset *dataset, const char *folder, bool force)
{
    struct texts texts;

    enum wb_status status = format_texts(dataset, &texts);
    if (status == WB_OK)
        status = wb_dataset_begin(folder, force);
    if (status == WB_OK)
        status = write_texts(&texts, folder);
    release_texts(&texts);
    return status;
}

static enum wb_status read_table(struct wb_dataset *dataset, const char *folder, const char *name,
                                 enum wb_status (*parse)(struct wb_dataset *dataset,
                                                         const char *path, char *text, size_t n,
                                                         struct wb_reason *why),
                                 struct wb_reason *why)
{
    char path[WB_PATH];
    char *text;
    size_t size;
    WB_TRY(wb_file_join(path, folder, name));
    WB_TRY(wb_file_read_with_reason(path, &text, &size, why));
    const enum wb_status status = parse(dataset, path, text, size, why);
    free(text);
    return status;
}

/* Rejects a dataset of another kind. */
static enum wb_status check_kind(const struct wb_test_info *info, const char *folder,
                                 unsigned kinds, struct wb_reason *why)
{
    char wanted[128];
    size_t n = 0;
    if (kinds & WB_TEST_BIT(info->kind))
        return WB_OK;
    for (int i = 0; i < WB_TEST_KINDS; i++) {
        if (kinds & WB_TEST_BIT(i))
            n += (size_t)snprintf(wanted + n, sizeof wanted - n, "%s%s", n > 0 ? " or " : "",
                                  wb_machine_kind_name((enum wb_test_kind)i));
    }
    return wb_fail_to(why, WB_ERR_UNSUPPORTED, "'%s' is a %s test: a %s test is expected here%s",
                      folder, wb_machine_kind_name(info->kind), wanted,
                      info->kind == WB_TEST_TENSILE
                          ? "; `wirebench calibrate --tensile` takes tensile tests"
                          : "");
}

static enum wb_status read_all(struct wb_dataset *dataset, const char *folder, unsigned kinds,
                               struct wb_reason *why)
{
    char path[WB_PATH];
    int64_t schema;
    WB_TRY(wb_file_join(path, folder, "dataset.json"));
    WB_TRY(wb_json_read_with_reason(&dataset->document, path, why));
    if (!wb_json_get_integer(dataset->document, "schema", &schema))
        return wb_fail_to(why, WB_ERR_FORMAT, "%s: no number 'schema': this is not a dataset",
                          path);
    if (schema != SCHEMA)
        return wb_fail_to(why, WB_ERR_UNSUPPORTED,
                          "%s: dataset schema %lld, this program reads %d: use a newer wirebench",
                          path, (long long)schema, SCHEMA);
    WB_TRY(get_info(dataset->document, path, &dataset->info, why));
    WB_TRY(check_kind(&dataset->info, folder, kinds, why));
    WB_TRY(read_table(dataset, folder, "force_deflection.csv", wb_dataset_parse_rows, why));
    return read_table(dataset, folder, "shape.csv", wb_dataset_parse_shapes, why);
}

enum wb_status wb_dataset_read(struct wb_dataset *dataset, const char *folder,
                               struct wb_reason *why)
{
    return wb_dataset_read_kinds(dataset, folder, WB_TEST_BIT(WB_TEST_CANTILEVER), why);
}

enum wb_status wb_dataset_read_kinds(struct wb_dataset *dataset, const char *folder, unsigned kinds,
                                     struct wb_reason *why)
{
    struct wb_dataset read = {0};
    const enum wb_status status = read_all(&read, folder, kinds, why);
    if (status != WB_OK) {
        wb_dataset_release(&read);
        memset(dataset, 0, sizeof *dataset);
        return status;
    }
    *dataset = read;
    return WB_OK;
}

enum wb_status wb_dataset_settle(struct wb_dataset *dataset)
{
    struct wb_test_info info = {.sample = 0};
    struct wb_json *document = NULL;
    char *text = NULL;
    WB_TRY(format_document(dataset, &text));
    enum wb_status status = wb_json_parse(&document, text, "dataset.json");
    free(text);
    if (status == WB_OK)
        status = get_info(document, "dataset.json", &info, NULL);
    if (status != WB_OK) {
        wb_json_destroy(document);
        return status;
    }
    wb_json_destroy(dataset->document);
    dataset->document = document;
    dataset->info = info;
    return WB_OK;
}

double wb_dataset_gap(const struct wb_dataset *dataset)
{
    const size_t n = dataset->n_rows;
    if (n < 2)
        return HUGE_VAL;
    return 5.0 * (dataset->rows[n - 1].t - dataset->rows[0].t) / (double)(n - 1);
}
