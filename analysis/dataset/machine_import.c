#include "analysis/dataset/machine_import.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"
#include "analysis/keys/common.h"
#include "analysis/keys/row.h"
#include "base/compress.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/memory.h"
#include "base/units.h"
#include "daq/take/table_columns.h"

#define WB_LOG_DOMAIN "import"

/* Part of the travel's range by which the travel returns at a turn. */
#define TURN 0.02
/* Least number of rows of a curve. */
#define LEAST_ROWS 5

struct import {
    const struct wb_machine_import *from;
    struct wb_dataset *dataset;
    struct wb_text_table table;
    struct wb_table_columns columns;
    struct wb_machine_import_report report;
    enum wb_measured travel; /* column of the deflection: travel or strain */
    double travel_factor;    /* a strain times the gauge length */
    int force_sign, travel_sign;
    size_t bytes;
    char hash[WB_SHA256_TEXT];
    struct wb_reason *why;
};

/* --- columns --- */

static enum wb_status find_columns(struct import *import, unsigned needed)
{
    return wb_table_columns_find(&import->columns, &import->table, import->from->columns, needed,
                                 WB_STANDARD_GRAVITY, import->from->path, import->why);
}

/* A tensile test's strain is that of an extensometer; where the machine file says so it comes
 * first, else the crosshead's travel. */
static enum wb_status choose_columns(struct import *import)
{
    const struct wb_machine *const machine = import->from->machine;
    const int *const column = import->columns.column;
    WB_TRY(find_columns(import, WB_MEASURED_BIT(WB_MEASURED_FORCE)));
    const bool has_travel = column[WB_MEASURED_TRAVEL] >= 0;
    const bool by_strain = machine->kind == WB_TEST_TENSILE && column[WB_MEASURED_STRAIN] >= 0 &&
                           (machine->own_elongation || !has_travel);
    import->travel = by_strain ? WB_MEASURED_STRAIN : WB_MEASURED_TRAVEL;
    import->travel_factor = by_strain ? machine->gauge_length : 1.0;
    if (by_strain || has_travel)
        return WB_OK;
    return find_columns(import,
                        WB_MEASURED_BIT(WB_MEASURED_FORCE) | WB_MEASURED_BIT(WB_MEASURED_TRAVEL));
}

/* --- rows --- */

static enum wb_status take_row(struct import *import, size_t index)
{
    struct wb_machine_import_report *const report = &import->report;
    const char *const path = import->from->path;
    const struct wb_table_columns *const columns = &import->columns;
    struct wb_row row = {.t = (double)NAN,
                         .cycle = 1,
                         .phase = WB_PHASE_LOAD,
                         .stage = (double)NAN,
                         .tip_x = (double)NAN,
                         .tip_angle = (double)NAN};
    WB_TRY(wb_table_columns_value(columns, &import->table, index, WB_MEASURED_FORCE, &row.force,
                                  path, import->why));
    WB_TRY(wb_table_columns_value(columns, &import->table, index, import->travel, &row.deflection,
                                  path, import->why));
    WB_TRY(wb_table_columns_value(columns, &import->table, index, WB_MEASURED_TIME, &row.t, path,
                                  import->why));
    report->largest_force = fmax(report->largest_force, row.force);
    report->largest_travel = fmax(report->largest_travel, row.deflection * import->travel_factor);
    const bool has_force = isfinite(row.force), has_travel = isfinite(row.deflection);
    const bool has_time = isfinite(row.t) || columns->column[WB_MEASURED_TIME] < 0;
    if (!has_force && !has_travel) {
        report->empty++; /* a line with a time alone counts as empty */
        return WB_OK;
    }
    report->without_force += !has_force;
    report->without_travel += !has_travel;
    report->without_time += !has_time;
    if (!has_force || !has_travel || !has_time) {
        report->partial++;
        return WB_OK;
    }
    row.deflection *= import->travel_factor;
    row.tension = row.force;
    const size_t n = import->dataset->n_rows;
    if (n > 0 && row.t < import->dataset->rows[n - 1].t)
        return wb_fail_to(import->why, WB_ERR_DATA,
                          "%s:%d: column %d: time goes back from %g s to %g s: the rows are not in "
                          "order",
                          path, import->table.lines[index], columns->column[WB_MEASURED_TIME] + 1,
                          import->dataset->rows[n - 1].t, row.t);
    wb_dataset_add_row(import->dataset, &row);
    return WB_OK;
}

/* --- signs, times, phases --- */

/* Sign with which the values rise from the first to the one farthest from it. */
static int rising_sign(const struct wb_dataset *dataset, size_t offset, double *largest)
{
    double first, farthest = 0.0;
    memcpy(&first, (const char *)&dataset->rows[0] + offset, sizeof first);
    for (size_t i = 0; i < dataset->n_rows; i++) {
        double value;
        memcpy(&value, (const char *)&dataset->rows[i] + offset, sizeof value);
        if (fabs(value - first) > fabs(farthest))
            farthest = value - first;
    }
    *largest = fabs(farthest);
    return farthest < 0.0 ? -1 : 1;
}

static enum wb_status turn_signs(struct import *import)
{
    struct wb_dataset *const dataset = import->dataset;
    double range, force;
    import->travel_sign = rising_sign(dataset, offsetof(struct wb_row, deflection), &range);
    import->force_sign = rising_sign(dataset, offsetof(struct wb_row, force), &force);
    if (!(range > 0.0) || !(force > 0.0))
        return wb_fail_to(import->why, WB_ERR_DATA,
                          "%s: the %s is constant in all %zu rows: not a test record",
                          import->from->path, range > 0.0 ? "force" : "travel", dataset->n_rows);
    for (size_t i = 0; i < dataset->n_rows; i++) {
        struct wb_row *const row = &dataset->rows[i];
        /* + 0.0 avoids -0. */
        row->deflection = import->travel_sign * row->deflection + 0.0;
        row->force = import->force_sign * row->force + 0.0;
        row->tension = row->force;
    }
    return WB_OK;
}

/* Derives the time from the travel where the file has no time and the machine's speed is known. */
static enum wb_status take_times(struct import *import)
{
    const struct wb_machine *const machine = import->from->machine;
    struct wb_dataset *const dataset = import->dataset;
    if (import->columns.column[WB_MEASURED_TIME] >= 0)
        return WB_OK;
    if (!machine->speed.known) {
        if (machine->kind == WB_TEST_CANTILEVER)
            return wb_fail_to(import->why, WB_ERR_DATA,
                              "%s: no column of the time: name it in --columns, or give the "
                              "machine's speed_mm_s",
                              import->from->path);
        return WB_OK;
    }
    dataset->rows[0].t = 0.0;
    for (size_t i = 1; i < dataset->n_rows; i++)
        dataset->rows[i].t = dataset->rows[i - 1].t +
                             fabs(dataset->rows[i].deflection - dataset->rows[i - 1].deflection) /
                                 machine->speed.value;
    return WB_OK;
}

/* Separates phases at the turns: where the travel has returned from its farthest point by TURN of
 * its range. */
static void cut_phases(struct wb_dataset *dataset)
{
    struct wb_row *const rows = dataset->rows;
    double least = rows[0].deflection, most = least;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        least = fmin(least, rows[i].deflection);
        most = fmax(most, rows[i].deflection);
    }
    const double back = TURN * (most - least);
    bool load = false;
    int cycle = 0;
    for (size_t i = 0; i < dataset->n_rows;) {
        load = !load;
        cycle += load;
        const size_t end = wb_fit_branch_end(&rows->deflection, sizeof *rows, dataset->n_rows, i,
                                             load ? back : -back);
        for (; i < end; i++) {
            rows[i].phase = load ? WB_PHASE_LOAD : WB_PHASE_UNLOAD;
            rows[i].cycle = cycle;
        }
    }
}

/* A pause of the machine cannot be distinguished from lost rows; both are reported. */
static void count_gaps(struct import *import)
{
    const struct wb_dataset *const dataset = import->dataset;
    struct wb_machine_import_report *const report = &import->report;
    const size_t n = dataset->n_rows - 1;
    if (import->columns.column[WB_MEASURED_TIME] < 0)
        return;
    double *const steps = wb_memory_new(n, sizeof *steps);
    for (size_t i = 0; i < n; i++)
        steps[i] = dataset->rows[i + 1].t - dataset->rows[i].t;
    wb_fit_sort(steps, n);
    const double limit = 5.0 * steps[n / 2];
    for (size_t i = 0; i < n; i++) {
        if (steps[i] > limit && limit > 0.0) {
            report->gaps++;
            report->longest_gap = steps[i];
        }
    }
    free(steps);
}

/* --- the document --- */

#define IMPORT(member) WB_AT(struct import, member)

static const struct wb_key column_rows[] = {
    {"column", INTEGER, "number of the column, from 1"},
    {"header", TEXT, "name of the column in the file"},
    {"unit", TEXT, "unit of the column"},
};
static WB_KEYS(column, "import_column", "A column of the imported file.");

static const struct wb_key columns_rows[] = {
    {"time", OBJECT | OPTIONAL, "column of time", &column_keys},
    {"force", OBJECT | OPTIONAL, "column of force", &column_keys},
    {"travel", OBJECT | OPTIONAL, "column of travel or elongation", &column_keys},
    {"strain", OBJECT | OPTIONAL, "column of strain", &column_keys},
};
static WB_KEYS(columns, "import_columns", "The columns of the imported file that are used.");

static const struct wb_key wb_machine_import_rows[] = {
    {"file", TEXT, "name of the original file"},
    {"bytes", IMPORT(bytes), "size of the original file"},
    {"sha256", IMPORT(hash), "SHA-256 of the original file"},
    {"encoding", TEXT, "character encoding"},
    {"byte_order_mark", IMPORT(table.byte_order_mark), "the file begins with a byte order mark"},
    {"delimiter", TEXT, "character between fields, `tab` or `blanks`"},
    {"decimal_sign", TEXT, "decimal sign"},
    {"header_line", IMPORT(table.header_line), "line with the names of the columns; 0: none"},
    {"columns", OBJECT, "columns that are used", &columns_keys},
    {"lines", IMPORT(report.lines), "lines of the file"},
    {"rows", IMPORT(report.rows), "rows of the dataset"},
    {"empty_rows", IMPORT(report.empty), "lines without force and travel"},
    {"partial_rows", IMPORT(report.partial), "rows left out because a value is missing"},
    {"rows_without_force", IMPORT(report.without_force), "of these, rows without a force"},
    {"rows_without_travel", IMPORT(report.without_travel), "of these, rows without a travel"},
    {"rows_without_time", IMPORT(report.without_time), "of these, rows without a time"},
    {"largest_force_N", IMPORT(report.largest_force) | UNKNOWN,
     "largest force of all rows, as in the file"},
    {"largest_travel_mm", IMPORT(report.largest_travel) | UNKNOWN,
     "largest travel of all rows, as in the file"},
    {"gaps", IMPORT(report.gaps), "steps of time longer than five usual ones"},
    {"longest_gap_s", IMPORT(report.longest_gap) | UNKNOWN, "longest step of time"},
    {"cut", IMPORT(report.cut), "the file ends within a row or a character"},
    {"last_line_has_no_end", IMPORT(table.ends_without_end),
     "the last line has no end of line and may be cut"},
    {"force_turned", FLAG, "the machine counts force downwards; the sign was changed"},
    {"travel_turned", FLAG, "the machine counts travel downwards; the sign was changed"},
};
WB_KEYS(wb_machine_import, "force_import", "The file of a testing machine.");

static void set_column(struct wb_json *object, const struct import *import, enum wb_measured m)
{
    const int column = import->columns.column[m];
    if (column < 0 || (m != import->travel && (m == WB_MEASURED_TRAVEL || m == WB_MEASURED_STRAIN)))
        return;
    struct wb_json *const entry = wb_json_set_object(object, wb_table_columns_name(m));
    wb_json_set_integer(entry, "column", column + 1);
    wb_json_set_text(entry, "header", import->table.columns[column].name);
    wb_json_set_text(entry, "unit", import->columns.unit[m]);
}

static void set_document(const struct import *import)
{
    const struct wb_machine_import_report *const report = &import->report;
    const struct wb_keys *const keys = &wb_machine_import_keys;
    struct wb_json *const document = import->dataset->document;
    const struct wb_text_table *const table = &import->table;
    char delimiter[2] = {table->delimiter, '\0'}, decimal[2] = {table->decimal, '\0'};
    wb_json_set_text(document, "name", wb_file_name(import->from->path));
    wb_keys_put_tool(document, "wirebench import force");
    struct wb_json *const from = wb_json_set_object(document, "import");
    wb_json_set_text(from, "file", wb_file_name(import->from->path));
    WB_PUT(from, keys, struct import, import);
    wb_json_set_text(from, "encoding", wb_text_encoding_name(table->encoding));
    WB_PUT(from, keys, struct import, import);
    wb_json_set_text(from, "delimiter",
                     table->delimiter == '\t'  ? "tab"
                     : table->delimiter == ' ' ? "blanks"
                                               : delimiter);
    wb_json_set_text(from, "decimal_sign", decimal);
    WB_PUT(from, keys, struct import, import);
    struct wb_json *const used = wb_json_set_object(from, "columns");
    for (int m = 0; m < WB_MEASURED_COUNT; m++)
        set_column(used, import, (enum wb_measured)m);
    WB_PUT(from, keys, struct import, import);
    wb_json_set_boolean(from, "force_turned", import->force_sign < 0);
    wb_json_set_boolean(from, "travel_turned", import->travel_sign < 0);
    wb_json_set_boolean(document, "complete", !report->cut && report->gaps == 0);
}

static void set_info(const struct import *import)
{
    struct wb_test_info *const info = &import->dataset->info;
    const struct wb_machine *const machine = import->from->machine;
    const struct wb_test_piece *const piece = import->from->piece;
    snprintf(info->wire, sizeof info->wire, "%s", piece->wire);
    info->sample = piece->sample;
    info->kind = machine->kind;
    info->has_machine = true;
    info->machine = *machine;
    info->piece = *piece;
    info->length = machine->kind == WB_TEST_THREE_POINT ? machine->span
                   : machine->kind == WB_TEST_TENSILE   ? machine->gauge_length
                                                        : piece->length;
    /* Diameter of a tensile specimen without one: that of a circle with its area. */
    info->outer_diameter =
        isfinite(piece->outer_diameter) ? piece->outer_diameter : sqrt(4.0 * piece->area / M_PI);
    info->mass_per_length = piece->mass_per_length;
    /* Without a Poisson's ratio, the default of `align`. */
    info->poissons_ratio = piece->poissons_ratio > 0.0 ? piece->poissons_ratio : 0.3;
    if (machine->kind == WB_TEST_CANTILEVER && piece->mass_per_length > 0.0)
        info->gravity = machine->bends == WB_BENDS_UP     ? WB_STANDARD_GRAVITY
                        : machine->bends == WB_BENDS_DOWN ? -WB_STANDARD_GRAVITY
                                                          : 0.0;
}

/* The force of a cantilever is compared with a model's, which is zero at zero deflection. */
static void zero_force(struct wb_dataset *dataset)
{
    const double zero = dataset->rows[0].force, start = dataset->rows[0].deflection;
    if (dataset->info.kind != WB_TEST_CANTILEVER)
        return;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        dataset->rows[i].force -= zero;
        dataset->rows[i].deflection -= start;
    }
}

static enum wb_status fill(struct import *import)
{
    struct wb_dataset *const dataset = import->dataset;
    WB_TRY(choose_columns(import));
    import->report.largest_force = import->report.largest_travel = (double)NAN;
    for (size_t i = 0; i < import->table.n_rows; i++)
        WB_TRY(take_row(import, i));
    import->report.lines = (size_t)import->table.n_lines;
    import->report.empty += import->table.n_empty_lines;
    import->report.rows = dataset->n_rows;
    import->report.cut = import->table.cut;
    if (dataset->n_rows < LEAST_ROWS)
        return wb_fail_to(import->why, WB_ERR_DATA,
                          "%s: %zu whole rows in %d lines, %zu rows lack something: too few for a "
                          "curve",
                          import->from->path, dataset->n_rows, import->table.n_lines,
                          import->report.partial);
    WB_TRY(turn_signs(import));
    WB_TRY(take_times(import));
    cut_phases(dataset);
    count_gaps(import);
    set_info(import);
    zero_force(dataset);
    set_document(import);
    return WB_OK;
}

enum wb_status wb_machine_import(struct wb_dataset *dataset, const void *bytes, size_t size,
                                 const struct wb_machine_import *from,
                                 struct wb_machine_import_report *report, struct wb_reason *why)
{
    struct wb_dataset made;
    struct import import = {.from = from, .dataset = &made, .bytes = size, .why = why};
    wb_hash_bytes(bytes, size, import.hash);
    wb_dataset_init(&made);
    enum wb_status status =
        wb_text_table_parse(&import.table, bytes, size, from->path, from->form, why);
    if (status == WB_OK)
        status = fill(&import);
    wb_text_table_release(&import.table);
    if (status != WB_OK) {
        wb_dataset_release(&made);
        return status;
    }
    *dataset = made;
    *report = import.report;
    return WB_OK;
}

static enum wb_status write_original(const void *bytes, size_t size, const char *folder)
{
    char target[WB_PATH];
    size_t packed_size;
    void *packed;
    WB_TRY(wb_file_join(target, folder, "original.zst"));
    WB_TRY(wb_compress(bytes, size, WB_COMPRESS_QUICK, target, &packed, &packed_size));
    const enum wb_status status = wb_file_write(target, packed, packed_size);
    free(packed);
    return status;
}

enum wb_status wb_machine_import_write(const struct wb_dataset *dataset, const void *bytes,
                                       size_t size, const char *folder, bool force)
{
    WB_TRY(wb_dataset_begin(folder, force));
    WB_TRY(write_original(bytes, size, folder));
    return wb_dataset_finish(dataset, folder);
}
