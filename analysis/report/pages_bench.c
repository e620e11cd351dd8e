/* Wires, specimens, bench, and what alignment corrected. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/units.h"

static void put_wires(struct wb_document *document, const struct wb_recordings_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "Conductor (mm)", .right = true},
        {.heading = "Outside (mm)", .right = true},
        {.heading = "Density (g/cm<sup>3</sup>)", .right = true},
        {.heading = "Mass (g/m)", .right = true},
        {.heading = "Poisson's ratio", .right = true},
    };
    wb_document_heading(document, 2, "products", "Wires");
    struct wb_document_table *const table = wb_document_table(document, NULL, 6, columns);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_wire *const wire = &results->wires[i].wanted->product;
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, results->wires[i].wanted->label);
        wb_pages_cell_number(&row, wire->conductor_diameter / WB_MM, 2);
        wb_pages_cell_number(&row, wire->outer_diameter / WB_MM, 2);
        wb_pages_cell_number(&row, wire->density / WB_G_PER_CM3, 2);
        wb_pages_cell_number(&row, wb_wire_mass_per_length(wire) / WB_G, 3);
        wb_pages_cell_number(&row,
                             wire->has_properties ? wire->material.poissons_ratio : (double)NAN, 2);
        wb_pages_put_row(document, table, false, &row);
    }
}

static double largest_force(const struct wb_dataset *dataset, int *cycles)
{
    double force = 0.0;
    *cycles = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle > *cycles)
            *cycles = row->cycle;
        if (row->phase == WB_PHASE_LOAD && row->cycle == 1 && row->force > force)
            force = row->force;
    }
    return force;
}

static void put_specimen_rows(struct wb_document *document, struct wb_document_table *table,
                              const struct wb_recordings_results_wire *wire,
                              const struct wb_recordings_results_tests *tests, bool *first)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        if (!test->usable)
            continue;
        const struct wb_dataset *const dataset = &test->dataset;
        double seen = (double)NAN, t;
        wb_json_get_number(wb_json_get(wb_json_get(dataset->document, "checks"), "markers"),
                           "seen_percent", &seen);
        int cycles;
        const double force = largest_force(dataset, &cycles);
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, *first ? wire->wanted->label : "");
        wb_pages_cell_number(&row, dataset->info.length / WB_MM, 0);
        wb_pages_cell(&row, WB_TONE_PLAIN, "%d", dataset->info.sample);
        wb_pages_cell(&row, WB_TONE_PLAIN, "%d", cycles);
        wb_pages_cell_number(&row, wb_dataset_bow(&dataset->info) / WB_MM, 2);
        wb_pages_cell_number(&row, wb_figures_turn(dataset, &t) / WB_MM, 1);
        wb_pages_cell_number(&row, force / WB_MN, 1);
        wb_pages_cell_number(&row, seen, 1);
        wb_pages_cell_plain(&row, test->operator_name[0] ? WB_TONE_PLAIN : WB_TONE_QUIET,
                            test->operator_name[0] ? test->operator_name : "not given");
        wb_pages_put_row(document, table, *first, &row);
        *first = false;
    }
}

/* Names of usual length stay in one line: "make-/recordings" reads as two. */
static bool has_long_operator(const struct wb_recordings_results *results)
{
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_tests *const both[] = {
            &results->wires[i].calibration_tests, &results->wires[i].validation_tests};
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < both[k]->n; j++) {
                if (strlen(both[k]->items[j].operator_name) > 20)
                    return true;
            }
        }
    }
    return false;
}

static void put_specimens(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "Length (mm)", .right = true, .wraps = true},
        {.heading = "Sample", .right = true},
        {.heading = "Cycles", .right = true},
        {.heading = "Bow (mm)", .right = true, .wraps = true},
        {.heading = "Largest deflection (mm)", .right = true, .wraps = true},
        {.heading = "Largest force (mN)", .right = true, .wraps = true},
        {.heading = "Markers seen (%)", .right = true, .wraps = true},
        {.heading = "Operator", .wraps = has_long_operator(results)},
    };
    wb_document_heading(document, 2, "specimens", "Specimens");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Bow: natural offset of the tip, upwards positive, found from the recording. Deflection "
        "and force: of the first loading.",
        9, columns);
    for (int i = 0; i < results->n_wires; i++) {
        bool first = true;
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        put_specimen_rows(document, table, wire, &wire->calibration_tests, &first);
        put_specimen_rows(document, table, wire, &wire->validation_tests, &first);
    }
}

/* --- the bench --- */

static const struct wb_recordings_results_test *test_at(const struct wb_recordings_results *results,
                                                        int index)
{
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_tests *const both[] = {
            &results->wires[i].calibration_tests, &results->wires[i].validation_tests};
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < both[k]->n; j++) {
                if (both[k]->items[j].usable && index-- == 0)
                    return &both[k]->items[j];
            }
        }
    }
    return NULL;
}

static void put_pair(struct wb_document *document, struct wb_document_table *table,
                     const char *name, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static void put_pair(struct wb_document *document, struct wb_document_table *table,
                     const char *name, const char *format, ...)
{
    char plain[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(plain, sizeof plain, format, arguments);
    va_end(arguments);
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", name);
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, plain);
    wb_pages_put_row(document, table, false, &row);
}

/* As their makers write it. */
static const char *protocol_name(const char *protocol)
{
    static const char *const names[][2] = {
        {"natnet", "NatNet"}, {"grbl", "GRBL"}, {"mt-sics", "MT-SICS"}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        if (strcmp(protocol, names[i][0]) == 0)
            return names[i][1];
    }
    return protocol;
}

static bool same_bench(const struct wb_rig *a, const struct wb_rig *b)
{
    return strcmp(a->name, b->name) == 0 && a->is_virtual == b->is_virtual &&
           strcmp(a->load_cell.serial_number, b->load_cell.serial_number) == 0 &&
           a->load_cell.capacity == b->load_cell.capacity && a->strand.length == b->strand.length &&
           a->strand.counterweight == b->strand.counterweight && a->stage.speed == b->stage.speed;
}

static void put_rig(struct wb_document *document, const struct wb_recordings_results *results,
                    const struct wb_recordings_results_test *test)
{
    static const struct wb_document_column columns[] = {{""}, {.heading = "", .wraps = true}};
    const struct wb_rig *const rig = &test->rig;
    const struct wb_rig_load_cell *const cell = &rig->load_cell;
    bool same = true;
    for (int i = 1; test_at(results, i); i++)
        same &= same_bench(rig, &test_at(results, i)->rig);
    wb_document_heading(document, 2, "rig", "Bench");
    struct wb_document_table *const table = wb_document_table(
        document,
        same ? NULL : "Not all recordings were made on the same bench; this is the first one's.", 2,
        columns);
    put_pair(document, table, "Name", "%s%s", rig->name,
             test->is_virtual && !strstr(rig->name, "virtual") ? " (virtual rig)" : "");
    put_pair(document, table, "Load cell",
             "%.4g g, reads on to %.4g %%, serial number %s, "
             "calibrated %s",
             wb_recordings_results_capacity(rig) / WB_G,
             cell->capacity > 0.0 ? 100.0 * cell->overload / cell->capacity : 0.0,
             cell->serial_number[0] ? cell->serial_number : "not given",
             cell->calibration_date[0] ? cell->calibration_date : "not given");
    put_pair(document, table, "Filter of the cell", "delay %.3g ms, uncertain by %.3g ms",
             1e3 * cell->filter_delay, 1e3 * cell->filter_delay_uncertainty);
    put_pair(document, table, "Motion capture",
             "%s, %.4g frames a second expected, %d markers on "
             "the wire, %.3g mm off its axis",
             protocol_name(rig->mocap.protocol), rig->mocap.frame_rate, test->specimen.n_markers,
             test->specimen.marker_offset / WB_MM);
    put_pair(document, table, "Stage", "%s, %.3g mm/s, %.4g mm of travel",
             protocol_name(rig->stage.protocol), rig->stage.speed / WB_MM,
             rig->stage.travel / WB_MM);
    if (rig->strand.length > 0.0)
        put_pair(document, table, "Strand", "%.4g mm, counterweight %.3g g at the tip",
                 rig->strand.length / WB_MM, rig->strand.counterweight / WB_G);
    else
        put_pair(document, table, "Strand", "none, the force is vertical");
    put_pair(document, table, "Gravity", "%.6g m/s\xc2\xb2", rig->gravity);
}

/* --- corrections --- */

static bool correction_value(const struct wb_json *entry, const char *what, double *value,
                             const char **unit)
{
    static const char *const units[] = {"mN",  "mm",  "ms",  "s",      "us",
                                        "deg", "rad", "ppm", "percent"};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        char key[64];
        snprintf(key, sizeof key, "%s_%s", what, units[i]);
        if (wb_json_get_number(entry, key, value)) {
            *unit = units[i];
            return true;
        }
    }
    return false;
}

static const struct wb_json *correction_of(const struct wb_recordings_results_test *test,
                                           const char *name)
{
    const struct wb_json *const list = wb_json_get(test->dataset.document, "corrections");
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const struct wb_json *const entry = wb_json_item(list, i);
        const char *other;
        if (wb_json_get_text(entry, "name", &other) && strcmp(other, name) == 0)
            return entry;
    }
    return NULL;
}

/* One correction over all recordings: the range of its size and the largest uncertainty. */
static void put_correction(struct wb_document *document, struct wb_document_table *table,
                           const struct wb_recordings_results *results, const char *name)
{
    double low = (double)NAN, high = (double)NAN, largest = (double)NAN;
    const char *unit = "";
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = test_at(results, i)); i++) {
        const struct wb_json *const entry = correction_of(test, name);
        double value;
        if (entry && correction_value(entry, "value", &value, &unit)) {
            low = low <= value ? low : value;
            high = high >= value ? high : value;
        }
        if (entry && correction_value(entry, "uncertainty", &value, &unit))
            largest = largest >= value ? largest : value;
    }
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, name);
    wb_pages_cell_plain(&row, WB_TONE_QUIET, unit);
    wb_pages_cell_number(&row, low, 3);
    wb_pages_cell_number(&row, high, 3);
    wb_pages_cell_number(&row, largest, 3);
    wb_pages_put_row(document, table, false, &row);
}

static void put_corrections(struct wb_document *document,
                            const struct wb_recordings_results *results,
                            const struct wb_recordings_results_test *first)
{
    static const struct wb_document_column columns[] = {
        {"Correction"},
        {"Unit"},
        {.heading = "Smallest", .right = true},
        {.heading = "Largest", .right = true},
        {.heading = "Uncertainty, at most", .right = true},
    };
    const struct wb_json *const list = wb_json_get(first->dataset.document, "corrections");
    if (wb_json_length(list) == 0)
        return;
    wb_document_heading(document, 2, "corrections", "Corrections made by the alignment");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Over all recordings. The natural shape is not taken off the data but given to the model. "
        "Each correction of each recording, with its reason, is in report.json.",
        5, columns);
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const char *name;
        if (wb_json_get_text(wb_json_item(list, i), "name", &name))
            put_correction(document, table, results, name);
    }
}

void wb_pages_bench(struct wb_document *document, const struct wb_recordings_results *results,
                    const struct wb_figures *figures)
{
    const struct wb_recordings_results_test *const first = test_at(results, 0);
    wb_document_new_page(document);
    wb_document_heading(document, 1, "bench", "Specimens and bench");
    if (figures->bench) {
        char caption[400];
        snprintf(caption, sizeof caption,
                 "The test, drawn to scale but for the strand: the clamp moves down, the strand "
                 "holds the wire's tip, the load cell above stands still. Markers as %s at the "
                 "largest deflection.",
                 wb_figures_measured(results));
        wb_document_figures(document, figures->bench, caption, NULL, NULL);
    }
    put_wires(document, results);
    if (!first)
        return;
    put_rig(document, results, first);
    put_corrections(document, results, first);
    put_specimens(document, results);
}
