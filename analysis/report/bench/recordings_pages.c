/* Recordings' report, in order: summary, specimens and bench, all wires, each wire, provenance. */
#include "analysis/report/bench/recordings_kind.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/align/align.h"
#include "analysis/report/bench/recordings_draw.h"
#include "analysis/report/bench/recordings_figures.h"
#include "analysis/report/bench/recordings_pages.h"
#include "analysis/report/pages.h"
#include "base/text.h"
#include "base/units.h"
#include "base/version.h"

/* An item for each recording of a wire that is missing or was rejected, with the reason. */
static void put_missing_tests(struct wb_document *document,
                              const struct wb_recordings_results *results,
                              const struct wb_recordings_results_wire *of)
{
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, NULL)); i++) {
        if (wire == of && !test->usable && !test->wanted->excluded.is_excluded)
            wb_pages_item(document, WB_TONE_WARNING, "<b>", test->wanted->name,
                          "</b>: ", wb_text_string(&test->problem));
    }
}

/* Who excluded which recordings, and why; nothing where none is. `of` NULL: of all wires. */
static void put_exclusions(struct wb_document *document,
                           const struct wb_recordings_results *results,
                           const struct wb_recordings_results_wire *of)
{
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, NULL)); i++) {
        char text[WB_INDEX_EXCLUSION_TEXT];
        if (!test->wanted->excluded.is_excluded || (of && wire != of))
            continue;
        wb_index_exclusion_describe(&test->wanted->excluded, text);
        wb_pages_item(document, WB_TONE_PLAIN, "<b>", test->wanted->name, "</b>: excluded ", text);
    }
}

static int count_exclusions(const struct wb_recordings_results *results)
{
    const struct wb_recordings_results_test *test;
    int n = 0;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++)
        n += test->wanted->excluded.is_excluded;
    return n;
}

/* --- summary: first page, what is missing, properties, figures of merit, warnings --- */

#define MOST_WARNINGS 4

/* Why a step of a wire could not be done; NULL: it was, or there is none. */
static const char *problem_of(const struct wb_recordings_results_step *step)
{
    return step->state == WB_RECORDINGS_MISSING || step->state == WB_RECORDINGS_FAILED
               ? wb_text_string(&step->problem)
               : NULL;
}

static void put_missing(struct wb_document *document, const struct wb_recordings_results *results)
{
    if (results->outcome.is_complete)
        return;
    wb_document_heading(document, 2, "missing", "What is missing");
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        put_missing_tests(document, results, wire);
        for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
            char between[40];
            snprintf(between, sizeof between, ": no %s</b>: ", wb_recordings_purposes[k]);
            if (problem_of(&wire->steps[k]))
                wb_pages_item(document, WB_TONE_WARNING, "<b>", wire->wanted->label, between,
                              problem_of(&wire->steps[k]));
        }
    }
}

static void put_property(struct wb_document_table *table,
                         const struct wb_recordings_results_wire *wire, int i)
{
    const struct wb_pages_property *const property = &wb_pages_properties[i];
    const struct wb_recordings_wire *const wanted = wire->wanted;
    const bool done = wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION);
    const double value =
        done ? wb_pages_value(&wire->calibration.material, i) / property->factor : (double)NAN;
    /* K's is a factor. */
    const double own = done ? wire->calibration.deviation[i] : (double)NAN;
    const double deviation = i == 2 ? exp(own) : own / property->factor;
    const double reference = wanted->has_reference
                                 ? wb_pages_value(&wanted->reference, i) / property->factor
                                 : (double)NAN;
    wb_pages_row(table, i == 0, i == 0 ? wanted->label : "");
    wb_pages_cell(table, WB_TONE_PLAIN, "%s %s", property->name, property->symbol);
    wb_pages_cell(table, WB_TONE_QUIET, "%s", property->unit);
    wb_pages_cell_number(table, value, property->decimals);
    if (i == 2 && isfinite(deviation))
        wb_pages_cell(table, WB_TONE_PLAIN, "\xc3\x97/\xc3\xb7 %.3g", deviation);
    else
        wb_pages_cell_number(table, deviation, property->decimals);
    wb_pages_cell_number(table, reference, property->decimals);
    wb_pages_cell_number(table, value / reference, 2);
}

static void put_properties(struct wb_document *document,
                           const struct wb_recordings_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {"Property"},
        {"Unit"},
        {.heading = "Calibrated", .right = true},
        {.heading = "\xc2\xb1 (specimens)", .right = true},
        {.heading = "Published", .right = true},
        {.heading = "Ratio", .right = true},
    };
    const struct wb_calibrate_settings *const settings = &results->campaign->head.fit;
    char source[300] = "none";
    for (int i = 0; i < results->n_wires; i++) {
        if (results->wires[i].wanted->has_reference) {
            wb_pages_escape(source, sizeof source, results->wires[i].wanted->reference_source);
            break;
        }
    }
    wb_document_heading(document, 2, "properties",
                        results->campaign->whole_cycle
                            ? "Calibrated properties, by the paper's route"
                            : "Calibrated properties");
    struct wb_document_table *const table = wb_pages_table(
        document, WB_COUNT(columns), columns,
        "<i>E</i> from eq. 10 at a deflection of %g of the length, <i>\xcf\x83</i><sub>Y</sub> "
        "from eq. 11 at %g of it. \xc2\xb1: standard uncertainty from the scatter between "
        "specimens (jackknife), of <i>K</i> a factor. %s Published: %s. Ratio: calibrated over "
        "published.",
        settings->elastic_zone,
        settings->yield_point > 0.0 ? settings->yield_point : settings->elastic_zone,
        settings->bow_corrected
            ? "<i>E</i> and <i>\xcf\x83</i><sub>Y</sub> are corrected for the specimens' bows."
            : "Not corrected for the specimens' bows (bow_corrected: false).",
        source);
    for (int i = 0; i < results->n_wires; i++) {
        for (int k = 0; k < 4; k++)
            put_property(table, &results->wires[i], k);
    }
}

static void put_rms(struct wb_document_table *table, const struct wb_recordings_results *results,
                    const struct wb_recordings_results_wire *wire,
                    enum wb_recordings_purpose purpose)
{
    const enum wb_recordings_results_state state = wire->steps[purpose].state;
    const double limit = results->campaign->limit[purpose];
    const double rms = wb_recordings_results_rms(wire, purpose);
    if (state == WB_RECORDINGS_NOT_WANTED)
        wb_pages_cell_number(table, (double)NAN, 0);
    else if (state != WB_RECORDINGS_DONE)
        wb_pages_cell(table, WB_TONE_WARNING, "missing");
    else
        wb_pages_cell_judged(table, rms, 4, limit > 0.0,
                             wb_recordings_results_keeps(results->campaign, wire, purpose));
}

static void put_merits(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "RMS of the fit", .right = true, .wraps = true},
        {.heading = "Validation RMS", .right = true, .wraps = true},
        {.heading = "Validation, largest", .right = true, .wraps = true},
        {.heading = "Linear elastic RMS", .right = true, .wraps = true},
        {.heading = "Scatter explains, about", .right = true, .wraps = true},
        {.heading = "Shapes, RMS (mm)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub> (mN)", .right = true, .wraps = true},
    };
    struct wb_text caption = {0};
    char source[300];
    wb_text_append(&caption,
                   "Errors are fractions of <i>F</i><sub>max</sub>, the largest force of the mean "
                   "measured curve (eqs. 18 and 19); the table has that of the validation. Scatter "
                   "explains, about: the part of the validation's RMS<sup>2</sup> that a perfect "
                   "model would show too, on average, because means of a few specimens of unlike "
                   "stiffness differ by chance.");
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        if (campaign->limit[k] > 0.0)
            wb_text_append(&caption, " Limit of the %s: %.4g.", wb_recordings_purposes[k],
                           campaign->limit[k]);
    }
    if (campaign->reference_rms[1] > 0.0)
        wb_text_append(&caption, " Published RMS of validations: %.4g to %.4g (%s).",
                       campaign->reference_rms[0], campaign->reference_rms[1],
                       wb_pages_escape(source, sizeof source, campaign->reference_source));
    wb_document_heading(document, 2, "merits",
                        campaign->whole_cycle ? "How well the model of the paper's route fits"
                                              : "How well the model fits");
    struct wb_document_table *const table =
        wb_pages_start_table(document, &caption, WB_COUNT(columns), columns);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_validate_result *const v =
            wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
        const double none = (double)NAN, share = v ? v->scatter_share : none;
        wb_pages_row(table, false, wire->wanted->label);
        put_rms(table, results, wire, WB_RECORDINGS_CALIBRATION);
        put_rms(table, results, wire, WB_RECORDINGS_VALIDATION);
        wb_pages_cell_number(table, v ? v->elastoplastic.max_error : none, 4);
        wb_pages_cell_number(table, v ? v->elastic.rms : none, 4);
        if (isfinite(share))
            wb_pages_cell(table, WB_TONE_PLAIN, "%.0f %%", 100.0 * share);
        else
            wb_pages_cell_number(table, none, 0);
        wb_pages_cell_number(table, v ? v->shape_rms / WB_MM : none, 2);
        wb_pages_cell_number(table, v ? v->curve.max_force / WB_MN : none, 1);
    }
}

static const struct wb_recordings_results_test *
usable_at(const struct wb_recordings_results *results, int index)
{
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++) {
        if (test->usable && index-- == 0)
            break;
    }
    return test;
}

/* Recordings with gaps, in one line: their curves stay usable, a gap is left out of them. */
static int put_gaps(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_recordings_results_test *test;
    double longest = 0.0;
    int n = 0;
    for (int i = 0; (test = usable_at(results, i)); i++) {
        const struct wb_json *const rows =
            wb_json_get(wb_json_get(test->dataset.document, "checks"), "rows");
        double gaps = 0.0, one = 0.0;
        if (!wb_json_get_number(rows, "gaps", &gaps) || !(gaps > 0.0))
            continue;
        n++;
        if (wb_json_get_number(rows, "longest_gap_s", &one))
            longest = fmax(longest, one);
    }
    if (n > 0)
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_PLAIN,
                     "%d of %d recordings %s gaps in the rows, the longest of %.2f s; the pages of "
                     "the wires name them.",
                     n, results->outcome.n_usable, wb_pages_plural(n, "has", "have"), longest);
    return n;
}

/* Warnings of alignments: of one wire all, or (`of` NULL) of all wires the first few but those of
 * gaps. Returns how many there are. */
static int put_alignment_warnings(struct wb_document *document,
                                  const struct wb_recordings_results *results,
                                  const struct wb_recordings_results_wire *of)
{
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire;
    int n = 0;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, NULL)); i++) {
        const struct wb_json *const warnings =
            test->usable ? wb_json_get(test->dataset.document, "warnings") : NULL;
        for (size_t k = 0; k < wb_json_length(warnings); k++) {
            const char *warning;
            if ((of && wire != of) || !wb_json_text(wb_json_item(warnings, k), &warning) ||
                (!of && (strstr(warning, WB_ALIGN_GAPS_TEXT) || n++ >= MOST_WARNINGS)))
                continue;
            wb_pages_item(document, WB_TONE_PLAIN, "", test->wanted->name, ": ", warning);
        }
    }
    return n;
}

/* Doubts about the search for K and n. */
static int put_search_warnings(struct wb_document *document,
                               const struct wb_recordings_results_wire *wire)
{
    const struct wb_calibrate_result *const c = &wire->calibration;
    const char *const label = wire->wanted->markup;
    const int n = document->n;
    if (!wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION))
        return 0;
    if (!wb_calibrate_is_complete(c->end))
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_WARNING,
                     "%s: the search for K and n ended because %s.", label,
                     wb_calibrate_end_text(c->end));
    if (c->restarted && !(c->restart_moved <= 1e-3))
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_PLAIN,
                     "%s: a restart of the search moved K and n by up to %.2g %%: other pairs fit "
                     "equally well.",
                     label, 100.0 * c->restart_moved);
    if (c->failed_evaluations > 0)
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_PLAIN,
                     "%s: %d of %d runs of the beam did not converge.", label,
                     c->failed_evaluations, c->evaluations);
    return document->n - n;
}

static void put_warnings(struct wb_document *document, const struct wb_recordings_results *results)
{
    wb_document_heading(document, 2, "warnings", "Warnings");
    int of_searches = 0;
    const int of_gaps = put_gaps(document, results);
    for (int i = 0; i < results->n_wires; i++)
        of_searches += put_search_warnings(document, &results->wires[i]);
    const int shown = put_alignment_warnings(document, results, NULL);
    if (shown + of_searches + of_gaps == 0)
        wb_document_item(document, WB_TONE_QUIET, "None.");
    if (shown > MOST_WARNINGS)
        wb_pages_put(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, "%d more on the pages of the wires.",
                     shown - MOST_WARNINGS);
}

static void put_excluded(struct wb_document *document, const struct wb_recordings_results *results)
{
    const int n = count_exclusions(results);
    if (n == 0)
        return;
    wb_document_heading(document, 2, "excluded", "Excluded");
    wb_pages_put(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN,
                 "%d further %s excluded and %s used in no number of this report.", n,
                 wb_pages_plural(n, "recording was", "recordings were"),
                 wb_pages_plural(n, "is", "are"));
    put_exclusions(document, results, NULL);
}

static void put_summary(struct wb_document *document, const struct wb_recordings_results *results,
                        const struct wb_figures *figures)
{
    wb_recordings_found_put(document, results, figures);
    put_missing(document, results);
    wb_recordings_cycle_put_summary(document, results);
    put_properties(document, results);
    put_merits(document, results);
    put_excluded(document, results);
    put_warnings(document, results);
}

/* --- wires, specimens, bench, and what alignment corrected --- */

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
        wb_pages_row(table, false, results->wires[i].wanted->label);
        wb_pages_cell_number(table, wire->conductor_diameter / WB_MM, 2);
        wb_pages_cell_number(table, wire->outer_diameter / WB_MM, 2);
        wb_pages_cell_number(table, wire->density / WB_G_PER_CM3, 2);
        wb_pages_cell_number(table, wb_wire_mass_per_length(wire) / WB_G, 3);
        wb_pages_cell_number(table,
                             wire->has_properties ? wire->material.poissons_ratio : (double)NAN, 2);
    }
}

static double largest_force(const struct wb_dataset *dataset)
{
    double force = 0.0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->phase == WB_PHASE_LOAD && row->cycle == 1 && row->force > force)
            force = row->force;
    }
    return force;
}

static void put_specimen(struct wb_document_table *table,
                         const struct wb_recordings_results_test *test, const char *label)
{
    const struct wb_dataset *const dataset = &test->dataset;
    double seen = (double)NAN, t;
    wb_json_get_number(wb_json_get(wb_json_get(dataset->document, "checks"), "markers"),
                       "seen_percent", &seen);
    wb_pages_row(table, label[0] != '\0', label);
    wb_pages_cell_number(table, dataset->info.length / WB_MM, 0);
    wb_pages_cell(table, WB_TONE_PLAIN, "%d", dataset->info.sample);
    wb_pages_cell(table, WB_TONE_PLAIN, "%d", wb_cycle_later_count(dataset));
    wb_pages_cell_number(table, wb_dataset_bow(&dataset->info) / WB_MM, 2);
    wb_pages_cell_number(table, wb_recordings_figures_turn(dataset, &t) / WB_MM, 1);
    wb_pages_cell_number(table, largest_force(dataset) / WB_MN, 1);
    wb_pages_cell_number(table, seen, 1);
    wb_pages_cell_plain(table, test->operator_name[0] ? WB_TONE_PLAIN : WB_TONE_QUIET,
                        test->operator_name[0] ? test->operator_name : "not given");
}

/* Names of usual length stay in one line: "make-/recordings" reads as two. */
static bool has_long_operator(const struct wb_recordings_results *results)
{
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++) {
        if (strlen(test->operator_name) > 20)
            return true;
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
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire, *before = NULL;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, NULL)); i++) {
        if (!test->usable)
            continue;
        put_specimen(table, test, wire == before ? "" : wire->wanted->label);
        before = wire;
    }
}

/* --- the bench --- */

/* As their makers write it. */
static const char *protocol_name(const char *protocol)
{
    static const char *const names[][2] = {
        {"natnet", "NatNet"}, {"grbl", "GRBL"}, {"tic", "Tic"}, {"mt-sics", "MT-SICS"}};
    for (size_t i = 0; i < WB_COUNT(names); i++) {
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
    for (int i = 1; usable_at(results, i); i++)
        same &= same_bench(rig, &usable_at(results, i)->rig);
    wb_document_heading(document, 2, "rig", "Bench");
    struct wb_document_table *const table = wb_document_table(
        document,
        same ? NULL : "Not all recordings were made on the same bench; this is the first one's.", 2,
        columns);
    wb_pages_row_pair(table, WB_TONE_QUIET, "Name", "%s%s", rig->name,
                      test->is_virtual && !strstr(rig->name, "virtual") ? " (virtual rig)" : "");
    wb_pages_row_pair(table, WB_TONE_QUIET, "Load cell",
                      "%.4g g, reads on to %.4g %%, serial number %s, calibrated %s",
                      wb_recordings_results_capacity(rig) / WB_G,
                      cell->capacity > 0.0 ? 100.0 * cell->overload / cell->capacity : 0.0,
                      cell->serial_number[0] ? cell->serial_number : "not given",
                      cell->calibration_date[0] ? cell->calibration_date : "not given");
    wb_pages_row_pair(table, WB_TONE_QUIET, "Filter of the cell",
                      "delay %.3g ms, uncertain by %.3g ms", 1e3 * cell->filter_delay,
                      1e3 * cell->filter_delay_uncertainty);
    wb_pages_row_pair(table, WB_TONE_QUIET, "Motion capture",
                      "%s, %.4g frames a second expected, %d markers on "
                      "the wire, %.3g mm off its axis",
                      protocol_name(rig->mocap.protocol), rig->mocap.frame_rate,
                      test->specimen.n_markers, test->specimen.marker_offset / WB_MM);
    wb_pages_row_pair(table, WB_TONE_QUIET, "Stage", "%s, %.3g mm/s, %.4g mm of travel",
                      protocol_name(rig->stage.protocol), rig->stage.speed / WB_MM,
                      rig->stage.travel / WB_MM);
    if (rig->strand.length > 0.0)
        wb_pages_row_pair(table, WB_TONE_QUIET, "Strand",
                          "%.4g mm, counterweight %.3g g at the tip", rig->strand.length / WB_MM,
                          rig->strand.counterweight / WB_G);
    else
        wb_pages_row_pair(table, WB_TONE_QUIET, "Strand", "none, the force is vertical");
    wb_pages_row_pair(table, WB_TONE_QUIET, "Gravity", "%.6g m/s\xc2\xb2", rig->gravity);
}

/* --- corrections --- */

static bool correction_value(const struct wb_json *entry, const char *what, double *value,
                             const char **unit)
{
    static const char *const units[] = {"mN",  "mm",  "ms",  "s",      "us",
                                        "deg", "rad", "ppm", "percent"};
    for (size_t i = 0; i < WB_COUNT(units); i++) {
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
static void put_correction(struct wb_document_table *table,
                           const struct wb_recordings_results *results, const char *name)
{
    double low = (double)NAN, high = (double)NAN, largest = (double)NAN;
    const char *unit = "";
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = usable_at(results, i)); i++) {
        const struct wb_json *const entry = correction_of(test, name);
        double value;
        if (entry && correction_value(entry, "value", &value, &unit)) {
            low = low <= value ? low : value;
            high = high >= value ? high : value;
        }
        if (entry && correction_value(entry, "uncertainty", &value, &unit))
            largest = largest >= value ? largest : value;
    }
    wb_pages_row(table, false, name);
    wb_pages_cell_plain(table, WB_TONE_QUIET, unit);
    wb_pages_cell_number(table, low, 3);
    wb_pages_cell_number(table, high, 3);
    wb_pages_cell_number(table, largest, 3);
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
        "Over all recordings. The natural shape is not subtracted from the data; the model starts "
        "from it. Each correction of each recording, with its reason, is in report.json.",
        5, columns);
    for (size_t i = 0; i < wb_json_length(list); i++) {
        const char *name;
        if (wb_json_get_text(wb_json_item(list, i), "name", &name))
            put_correction(table, results, name);
    }
}

static void put_bench(struct wb_document *document, const struct wb_recordings_results *results,
                      const struct wb_figures *figures)
{
    const struct wb_recordings_results_test *const first = usable_at(results, 0);
    wb_document_new_page(document);
    wb_document_heading(document, 1, "bench", "Specimens and bench");
    wb_figures_put(figures, document, "bench", 0);
    put_wires(document, results);
    if (!first)
        return;
    put_rig(document, results, first);
    put_corrections(document, results, first);
    put_specimens(document, results);
}

/* --- all wires --- */

static void put_overview(struct wb_document *document, const struct wb_figures *figures)
{
    if (!wb_figures_has(figures, "overview", 0))
        return;
    wb_document_heading(document, 1, "overview", "All wires");
    wb_figures_put(figures, document, "overview", 0);
}

/* --- one wire --- */

static void put_calibration_text(struct wb_document *document,
                                 const struct wb_recordings_results *results,
                                 const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings *const campaign = results->campaign;
    const struct wb_calibrate_result *const c = &wire->calibration;
    const struct wb_recordings_results_step *const steps = wire->steps;
    const int n = steps[0].tests.n_usable, n_predicted = steps[1].tests.n_usable;
    const struct wb_validate_result *const v =
        wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
    struct wb_text text = {0};
    wb_text_append(
        &text,
        "Calibrated on %d %s of %g mm: <i>E</i> = %.0f MPa, <i>\xcf\x83</i><sub>Y</sub> = %.2f "
        "MPa, <i>K</i> = %.0f MPa, <i>n</i> = %.3f, RMS of the fit with the mean bow %.4f of "
        "<i>F</i><sub>max</sub> = %.1f mN (largest error %.4f).",
        n, wb_pages_plural(n, "sample", "samples"), campaign->length[0] / WB_MM,
        c->material.youngs_modulus / WB_MPA, c->material.yield_stress / WB_MPA,
        c->material.strength_coefficient / WB_MPA, c->material.hardening_exponent, c->rms,
        steps[0].result.curve.max_force / WB_MN, c->max_error);
    if (v)
        wb_text_append(&text,
                       " Predicts %d %s of %g mm with RMS %.4f of <i>F</i><sub>max</sub> = %.1f mN "
                       "(largest error %.4f); a linear elastic wire would be off by RMS %.4f.",
                       n_predicted, wb_pages_plural(n_predicted, "sample", "samples"),
                       campaign->length[1] / WB_MM, v->elastoplastic.rms,
                       v->curve.max_force / WB_MN, v->elastoplastic.max_error, v->elastic.rms);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
}

#define PART "of <i>F</i><sub>max</sub>"
#define OF(member) offsetof(struct wb_validate_result, member)

static void put_numbers(struct wb_document *document, const struct wb_recordings_results_wire *wire)
{
    static const struct wb_document_column columns[] = {
        {"Figure of merit"},
        {"Unit"},
        {.heading = "Calibration", .right = true},
        {.heading = "Validation", .right = true},
    };
    static const struct wb_recordings_score scores[] = {
        {"RMS (eq. 19), each specimen with its own bow", PART, OF(elastoplastic.rms), 1.0, 4},
        {"RMS beyond 5 mm", PART, OF(elastoplastic.rms_from_5mm), 1.0, 4},
        {"Largest error (eq. 18)", PART, OF(elastoplastic.max_error), 1.0, 4},
        {"RMS of the linear elastic beam", PART, OF(elastic.rms), 1.0, 4},
        {"Scatter between specimens <i>s</i>", PART, OF(scatter_rms), 1.0, 4,
         .needs_scatter = true},
        {"Scatter beyond the natural shapes <i>r</i>", PART, OF(residual_scatter_rms), 1.0, 4,
         .needs_scatter = true},
        {"RMS of a perfect model, about", PART, OF(expected_rms), 1.0, 4},
        {"RMS of a perfect model, exceeded by one of twenty", PART, OF(expected_rms_95), 1.0, 4},
        {"Share that the scatter explains, about", "1", OF(scatter_share), 1.0, 2},
        {"Shapes, RMS distance", "mm", OF(shape_rms), WB_MM, 2},
        {"Shapes, largest distance", "mm", OF(shape_max), WB_MM, 2},
        {"<i>F</i><sub>max</sub>", "mN", OF(curve.max_force), WB_MN, 1},
        {"Largest deflection of all specimens", "mm", OF(curve.max_deflection), WB_MM, 1},
    };
    const struct wb_validate_result *const v =
        wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
    /* Scatter as the calibration has it; a perfect model is known for the validation alone. */
    struct wb_validate_result fit = wire->steps[WB_RECORDINGS_CALIBRATION].result;
    fit.scatter_rms = wire->calibration.scatter_rms;
    fit.residual_scatter_rms = wire->calibration.residual_scatter_rms;
    fit.expected_rms = fit.expected_rms_95 = fit.scatter_share = (double)NAN;
    const double bows[2] = {wb_dataset_bow(&fit.info) / WB_MM,
                            v ? wb_dataset_bow(&v->info) / WB_MM : (double)NAN};
    wb_document_heading(document, 2, "", "Numbers");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Scatter <i>s</i>: standard deviation between the specimens at the same deflection, RMS "
        "over all deflections; <i>r</i>: what remains of it when each specimen is computed with "
        "its own natural shape, the model's error with the bow included. A perfect model, one of "
        "the product's mean, shows an RMS of about <i>s</i><sub>k</sub> <i>G</i> (1/<i>n</i> + "
        "1/<i>m</i>)<sup>1/2</sup> with <i>n</i> specimens here and <i>m</i> calibrated on, whose "
        "stiffness has the standard deviation <i>s</i><sub>k</sub> (of its logarithm, pooled); "
        "<i>G</i> is what stiffness changes in the curve. Student's <i>t</i> times as much is "
        "exceeded in one of twenty validations. Share: its square over RMS<sup>2</sup>, at most 1; "
        "near 0 the error is the model's.",
        WB_COUNT(columns), columns);
    wb_recordings_cycle_put_scores(table, scores, WB_COUNT(scores),
                                   (const struct wb_validate_result *[2]){&fit, v});
    wb_recordings_cycle_put_score(table, "Mean bow of the specimens", "mm", bows, 2);
}

static void put_remarks(struct wb_document *document, const struct wb_calibrate_result *result)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n = wb_calibrate_remarks(result, remarks);
    for (int i = 0; i < n; i++) {
        struct wb_text text = {0};
        wb_text_append(&text, "Note: ");
        wb_pages_append_symbols(&text, remarks[i]);
        wb_text_append(&text, ".");
        wb_pages_put_text(document, WB_BLOCK_ITEM, WB_TONE_PLAIN, &text);
    }
}

static void put_search(struct wb_document *document, const struct wb_recordings_results *results,
                       int index, const struct wb_figures *figures)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    const struct wb_calibrate_result *const c = &wire->calibration;
    struct wb_text text = {0};
    wb_document_heading(document, 2, "", "Search for K and n");
    wb_text_append(&text,
                   "Nelder-Mead from <i>K</i><sub>0</sub> = %.0f MPa, <i>n</i><sub>0</sub> = %.3f "
                   "(eqs. 12 to 16), %d runs of the beam; stopped because %s.",
                   c->first_strength_coefficient / WB_MPA, c->first_hardening_exponent,
                   c->evaluations, wb_calibrate_end_text(c->end));
    if (c->restarted && c->restart_moved == 0.0)
        wb_text_append(&text, " A restart from the optimum did not move K and n.");
    else if (c->restarted)
        wb_text_append(&text, " A restart from the optimum moved K and n by at most %.2g %%.",
                       100.0 * c->restart_moved);
    if (c->failed_evaluations > 0)
        wb_text_append(&text, " %d of the runs did not converge and counted with a large error.",
                       c->failed_evaluations);
    wb_pages_put_text(document, WB_BLOCK_PARAGRAPH, WB_TONE_PLAIN, &text);
    put_remarks(document, c);
    wb_figures_put(figures, document, "search", index);
}

static bool has_warnings(const struct wb_recordings_results *results,
                         const struct wb_recordings_results_wire *of)
{
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, NULL)); i++) {
        if (wire == of &&
            (!test->usable || wb_json_length(wb_json_get(test->dataset.document, "warnings")) > 0))
            return true;
    }
    return false;
}

static void put_wire(struct wb_document *document, const struct wb_recordings_results *results,
                     int index, const struct wb_figures *figures)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    char slug[64], anchor[80];
    wb_recordings_draw_slug(slug, wire->wanted->product.name);
    snprintf(anchor, sizeof anchor, "wire-%s", slug);
    wb_document_new_page(document);
    wb_document_heading(document, 1, anchor, wire->wanted->label);
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        struct wb_text text = {0};
        if (!problem_of(&wire->steps[k]))
            continue;
        wb_text_append(&text, "<b>No %s:</b> ", wb_recordings_purposes[k]);
        wb_text_append_escaped(&text, problem_of(&wire->steps[k]));
        wb_pages_put_text(document, WB_BLOCK_NOTICE, WB_TONE_WARNING, &text);
    }
    wb_recordings_cycle_put_wire(document, results, index, figures);
    const bool calibrated = wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION);
    if (wb_recordings_results_cycle(wire)) {
        wb_document_new_page(document);
        wb_document_heading(document, 2, "", "The paper's route");
    }
    if (calibrated)
        put_calibration_text(document, results, wire);
    wb_figures_put(figures, document, "measured", index);
    if (calibrated) {
        wb_figures_put(figures, document, "compared", index);
        put_search(document, results, index, figures);
        put_numbers(document, wire);
    }
    if (has_warnings(results, wire)) {
        wb_document_heading(document, 2, "", "Warnings");
        put_missing_tests(document, results, wire);
        put_exclusions(document, results, wire);
        put_alignment_warnings(document, results, wire);
    }
}

/* --- provenance: settings, recordings with their checksums --- */

static void put_test(struct wb_document_table *table, const struct wb_recordings_results_test *test,
                     bool begins_group)
{
    wb_pages_row(table, begins_group, test->wanted->name);
    if (!test->usable) {
        wb_pages_cell(table, WB_TONE_WARNING, "%s",
                      test->wanted->excluded.is_excluded ? "excluded" : "not used");
    } else {
        char start[40];
        snprintf(start, sizeof start, "%.19s", test->start_utc);
        char *const t = strchr(start, 'T');
        if (t)
            *t = ' ';
        wb_pages_cell_plain(table, WB_TONE_PLAIN, start);
    }
    if (test->wanted->seed >= 0)
        wb_pages_cell(table, WB_TONE_PLAIN, "%d", test->wanted->seed);
    else
        wb_pages_cell_number(table, (double)NAN, 0);
    wb_pages_cell_checksum(table, test->sha256[0] ? test->sha256 : test->wanted->sha256);
}

/* The revisions that recorded, each once, in the order of the list. */
static void append_revisions(struct wb_text *caption, const struct wb_recordings_results *results)
{
    struct wb_text list = {0};
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++) {
        char revision[400];
        wb_pages_escape(revision, sizeof revision, test->tool_revision);
        if (revision[0] && !strstr(wb_text_string(&list), revision))
            wb_text_append(&list, "%s%s", list.length > 0 ? ", " : "", revision);
    }
    if (list.length > 0)
        wb_text_append(caption, " Recorded with revision %s.", wb_text_string(&list));
    wb_text_release(&list);
}

static void put_recordings(struct wb_document *document,
                           const struct wb_recordings_results *results)
{
    static const struct wb_document_column columns[] = {
        {.heading = "Recording", .wraps = true},
        {.heading = "Start (UTC)"},
        {.heading = "Seed", .right = true},
        {.heading = "SHA-256, first 16 digits", .monospace = true},
    };
    wb_document_heading(document, 2, "recordings", "Recordings");
    struct wb_text caption = {0};
    wb_text_append(
        &caption,
        "Checksums are of the uncompressed recordings; all 64 digits are in report.json.%s",
        results->any_virtual ? " Seed: of the virtual rig." : "");
    append_revisions(&caption, results);
    struct wb_document_table *const table = wb_pages_start_table(document, &caption, 4, columns);
    const struct wb_recordings_results_test *test;
    const struct wb_recordings_results_wire *wire, *wire_before = NULL;
    enum wb_recordings_purpose purpose, before = WB_RECORDINGS_CALIBRATION;
    for (int i = 0; (test = wb_recordings_results_at(results, i, &wire, &purpose)); i++) {
        put_test(table, test, wire != wire_before || purpose != before);
        wire_before = wire;
        before = purpose;
    }
}

static void put_settings(struct wb_document *document, const struct wb_recordings_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Setting"}, {"Value"}, {.heading = "Meaning", .wraps = true}};
    const struct wb_calibrate_settings *const s = &results->campaign->head.fit;
    wb_document_heading(document, 2, "settings", "Settings");
    struct wb_document_table *const table =
        wb_document_table(document, NULL, WB_COUNT(columns), columns);
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Elastic zone", "%g", s->elastic_zone);
    wb_document_cell(table, WB_TONE_QUIET, "deflection over length at which eq. 10 gives <i>E</i>");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Yield point", "%g",
                      s->yield_point > 0.0 ? s->yield_point : s->elastic_zone);
    wb_document_cell(table, WB_TONE_QUIET,
                     "deflection over length at which eq. 11 gives <i>\xcf\x83</i><sub>Y</sub>");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Step", "%g mm", s->step / WB_MM);
    wb_document_cell(table, WB_TONE_QUIET, "between the deflections that are compared");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Initial shape",
                      s->straight ? "straight" : "mean of the specimens");
    wb_document_cell(table, WB_TONE_QUIET, "natural shape of the computed wire");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Restart", s->restart ? "once" : "no");
    wb_document_cell(table, WB_TONE_QUIET, "of the search, from its optimum");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Elements", "%d", s->n_elements);
    wb_document_cell(table, WB_TONE_QUIET, "quadratic beam elements along the wire");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Fibres", "%d", s->n_fibres);
    wb_document_cell(table, WB_TONE_QUIET, "integration points over the diameter");
    wb_pages_row_pair(table, WB_TONE_PLAIN, "Stops at", "%g of the size, %g of the error",
                      s->size_tolerance, s->error_tolerance);
    wb_document_cell(table, WB_TONE_QUIET,
                     "size in units of <i>K</i><sub>0</sub> and <i>n</i><sub>0</sub>; error over "
                     "<i>F</i><sub>max</sub>");
}

static void put_provenance(struct wb_document *document,
                           const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    wb_pages_put_origin(document, &campaign->head, "recordings");
    put_settings(document, results);
    put_recordings(document, results);
}

/* --- all of it --- */

void wb_recordings_pages_build(struct wb_document *document, const void *context,
                               const struct wb_figures *figures)
{
    const struct wb_recordings_results *const results = context;
    char subtitle[300];
    snprintf(subtitle, sizeof subtitle,
             "%d of %d recordings, the latest of %.10s \xc2\xb7 wirebench %s, revision %s",
             results->outcome.n_usable, results->outcome.n_wanted,
             results->latest_utc[0] ? results->latest_utc : "an unknown date", wb_version(),
             wb_version_revision());
    if (results->outcome.n_usable == 0)
        snprintf(subtitle, sizeof subtitle,
                 "none of %d recordings \xc2\xb7 wirebench %s, revision %s",
                 results->outcome.n_wanted, wb_version(), wb_version_revision());
    wb_pages_start(document, "Calibration report", &results->campaign->head, subtitle,
                   results->any_virtual ? "virtual rig" : NULL, results->latest_utc);
    put_summary(document, results, figures);
    put_bench(document, results, figures);
    put_overview(document, figures);
    for (int i = 0; i < results->n_wires; i++)
        put_wire(document, results, i, figures);
    put_provenance(document, results);
}
