/* The summary page: origin, limits, what is missing, properties, figures of merit, warnings. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/align.h"
#include "analysis/report/pages_private.h"
#include "base/units.h"

#define MOST_WARNINGS 4

static void put_origin(struct wb_document *document, const struct wb_recordings_results *results)
{
    if (!results->any_virtual)
        return;
    wb_document_notice(
        document, WB_TONE_ORIGIN,
        results->all_virtual
            ? "<b>Virtual rig.</b> All recordings of this report come from the virtual rig, a "
              "simulated bench with a simulated wire. No physical wire was tested. The wire in it "
              "only resembles the published one, whose values stand beside for orientation."
            : "<b>Virtual rig.</b> Some recordings of this report come from the virtual rig, a "
              "simulated bench with a simulated wire; the list of recordings says which.");
}

/* What the scatter between samples may have to do with a validation's error. */
static void append_share(struct wb_text *text, const struct wb_validate_result *validation)
{
    if (isfinite(validation->scatter_share))
        wb_text_append(text,
                       " RMS that the scatter between samples alone lets expect: at most %.4f; "
                       "found: %.4f. So it explains at most %.0f %% of the mean square error.",
                       validation->expected_rms, validation->elastoplastic.rms,
                       100.0 * validation->scatter_share);
    else
        wb_text_append(text, " What the scatter between samples explains is not known: there are "
                             "fewer than two samples.");
}

/* `validation` NULL: of the calibration. */
static void put_miss(struct wb_document *document, const char *label, double rms, double limit,
                     const struct wb_validate_result *validation)
{
    char escaped[300];
    struct wb_text text = {0};
    wb_text_append(&text,
                   "<b>Limit exceeded.</b> %s, %s: RMS %.4f of <i>F</i><sub>max</sub>, "
                   "limit %.4g.",
                   wb_pages_escape(escaped, sizeof escaped, label),
                   validation ? "validation" : "calibration", rms, limit);
    if (validation)
        append_share(&text, validation);
    wb_document_notice(document, WB_TONE_WARNING, wb_text_string(&text));
    document->failed |= text.failed;
    wb_text_release(&text);
}

static void put_limits(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    int judged = 0;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const char *const label = wire->wanted->label;
        if (wire->calibration_state == WB_RECORDINGS_DONE && campaign->calibration_limit > 0.0) {
            judged++;
            if (!(wire->calibration.rms <= campaign->calibration_limit))
                put_miss(document, label, wire->calibration.rms, campaign->calibration_limit, NULL);
        }
        if (wire->validation_state == WB_RECORDINGS_DONE && campaign->validation_limit > 0.0) {
            judged++;
            if (!(wire->validation.elastoplastic.rms <= campaign->validation_limit))
                put_miss(document, label, wire->validation.elastoplastic.rms,
                         campaign->validation_limit, &wire->validation);
        }
    }
    if (judged == 0 || results->exceeds_limit)
        return;
    struct wb_text text = {0};
    wb_text_append(&text, results->is_complete
                              ? "<b>All limits of the campaign are kept:</b>"
                              : "<b>What could be computed keeps the campaign's limits:</b>");
    if (campaign->calibration_limit > 0.0)
        wb_text_append(&text, " RMS of each calibration at most %.4g", campaign->calibration_limit);
    if (campaign->validation_limit > 0.0)
        wb_text_append(&text, "%s of each validation at most %.4g",
                       campaign->calibration_limit > 0.0 ? "," : " RMS",
                       campaign->validation_limit);
    wb_text_append(&text, " of <i>F</i><sub>max</sub>.");
    wb_document_notice(document, WB_TONE_GOOD, wb_text_string(&text));
    document->failed |= text.failed;
    wb_text_release(&text);
}

static void put_step_problem(struct wb_document *document, const char *label, const char *step,
                             enum wb_recordings_results_state state, const struct wb_text *problem)
{
    if (state != WB_RECORDINGS_MISSING && state != WB_RECORDINGS_FAILED)
        return;
    char name[300], reason[1200], item[1700];
    snprintf(item, sizeof item, "<b>%s: no %s</b>: %s", wb_pages_escape(name, sizeof name, label),
             step, wb_pages_escape(reason, sizeof reason, wb_text_string(problem)));
    wb_document_item(document, WB_TONE_WARNING, item);
}

static void put_missing(struct wb_document *document, const struct wb_recordings_results *results)
{
    if (results->is_complete)
        return;
    char text[300];
    const int n = results->n_tests - results->n_usable;
    if (n > 0)
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> %d of %d recordings %s missing or could not be used. The "
                 "report shows what the others give.",
                 n, results->n_tests, wb_pages_plural(n, "is", "are"));
    else
        snprintf(text, sizeof text,
                 "<b>Incomplete.</b> All recordings are there, but not every "
                 "step could be done.");
    wb_document_notice(document, WB_TONE_WARNING, text);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        wb_pages_missing(document, &wire->calibration_tests);
        wb_pages_missing(document, &wire->validation_tests);
        put_step_problem(document, wire->wanted->label, "calibration", wire->calibration_state,
                         &wire->calibration_problem);
        put_step_problem(document, wire->wanted->label, "validation", wire->validation_state,
                         &wire->validation_problem);
    }
}

static void put_property(struct wb_document *document, struct wb_document_table *table,
                         const struct wb_recordings_results_wire *wire, int i)
{
    const struct wb_pages_property *const property = &wb_pages_properties[i];
    const struct wb_recordings_wire *const wanted = wire->wanted;
    const bool done = wire->calibration_state == WB_RECORDINGS_DONE;
    const double value =
        done ? wb_pages_value(&wire->calibration.material, i) / property->factor : (double)NAN;
    /* K's is a factor. */
    const double own = done ? wire->calibration.deviation[i] : (double)NAN;
    const double deviation = i == 2 ? exp(own) : own / property->factor;
    const double reference =
        wanted->has_reference ? wanted->reference[i] / property->factor : (double)NAN;
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell_plain(&row, WB_TONE_PLAIN, i == 0 ? wanted->label : "");
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s %s", property->name, property->symbol);
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", property->unit);
    wb_pages_cell_number(&row, value, property->decimals);
    if (i == 2 && isfinite(deviation))
        wb_pages_cell(&row, WB_TONE_PLAIN, "\xc3\x97/\xc3\xb7 %.3g", deviation);
    else
        wb_pages_cell_number(&row, deviation, property->decimals);
    wb_pages_cell_number(&row, reference, property->decimals);
    wb_pages_cell_number(&row, value / reference, 2);
    wb_pages_put_row(document, table, i == 0, &row);
}

static void put_properties(struct wb_document *document,
                           const struct wb_recordings_results *results)
{
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {"Property"},
        {"Unit"},
        {.heading = "Calibrated", .right = true},
        {.heading = "\xc2\xb1 (samples)", .right = true},
        {.heading = "Published", .right = true},
        {.heading = "Ratio", .right = true},
    };
    const struct wb_calibrate_settings *const settings = &results->campaign->calibrate;
    char source[300] = "none", caption[900];
    for (int i = 0; i < results->n_wires; i++) {
        if (results->wires[i].wanted->has_reference) {
            wb_pages_escape(source, sizeof source, results->wires[i].wanted->reference_source);
            break;
        }
    }
    wb_document_heading(document, 2, "properties", "Calibrated properties");
    snprintf(caption, sizeof caption,
             "<i>E</i> from eq. 10 at a deflection of %g of the length, "
             "<i>\xcf\x83</i><sub>Y</sub> from eq. 11 at %g of it. \xc2\xb1: standard "
             "uncertainty from the scatter between samples (jackknife), of <i>K</i> a factor. "
             "%s Published: %s. Ratio: calibrated over published.",
             settings->elastic_zone,
             settings->yield_point > 0.0 ? settings->yield_point : settings->elastic_zone,
             settings->bow_corrected
                 ? "<i>E</i> and <i>\xcf\x83</i><sub>Y</sub> are corrected for the samples' bows."
                 : "Not corrected for the samples' bows (bow_corrected: false).",
             source);
    struct wb_document_table *const table = wb_document_table(document, caption, 7, columns);
    for (int i = 0; i < results->n_wires; i++) {
        for (int k = 0; k < 4; k++)
            put_property(document, table, &results->wires[i], k);
    }
}

static void put_rms(struct wb_pages_row *row, bool done, double rms, double limit)
{
    if (!done)
        wb_pages_cell(row, WB_TONE_WARNING, "missing");
    else if (limit > 0.0)
        wb_pages_cell(row, rms <= limit ? WB_TONE_GOOD : WB_TONE_WARNING, "%.4f", rms);
    else
        wb_pages_cell(row, WB_TONE_PLAIN, "%.4f", rms);
}

static void put_share(struct wb_pages_row *row, double share)
{
    if (isfinite(share))
        wb_pages_cell(row, WB_TONE_PLAIN, "%.0f %%", 100.0 * share);
    else
        wb_pages_cell(row, WB_TONE_QUIET, "\xe2\x80\x93");
}

static void put_merits(struct wb_document *document, const struct wb_recordings_results *results)
{
    const struct wb_recordings *const campaign = results->campaign;
    static const struct wb_document_column columns[] = {
        {"Wire"},
        {.heading = "Calibration RMS", .right = true, .wraps = true},
        {.heading = "Validation RMS", .right = true, .wraps = true},
        {.heading = "Validation, largest", .right = true, .wraps = true},
        {.heading = "Linear elastic RMS", .right = true, .wraps = true},
        {.heading = "Scatter explains, at most", .right = true, .wraps = true},
        {.heading = "Shapes, RMS (mm)", .right = true, .wraps = true},
        {.heading = "<i>F</i><sub>max</sub> (mN)", .right = true, .wraps = true},
    };
    char caption[900], source[300];
    int length = snprintf(caption, sizeof caption,
                          "Errors are parts of <i>F</i><sub>max</sub>, the largest force of the "
                          "mean measured curve (eqs. 18 and 19); that of the validation is given. "
                          "Scatter explains, at most: bound of the part of the validation's "
                          "RMS<sup>2</sup> that a perfect model would show too, because means of a "
                          "few unlike samples differ by chance; the scatter it comes from holds "
                          "the model's error with the samples' bows too.");
    if (campaign->calibration_limit > 0.0)
        length += snprintf(caption + length, sizeof caption - (size_t)length,
                           " Limit of the calibration: %.4g.", campaign->calibration_limit);
    if (campaign->validation_limit > 0.0)
        length += snprintf(caption + length, sizeof caption - (size_t)length,
                           " Limit of the validation: %.4g.", campaign->validation_limit);
    if (campaign->reference_rms[1] > 0.0)
        snprintf(caption + length, sizeof caption - (size_t)length,
                 " Published RMS of validations: %.4g to %.4g (%s).", campaign->reference_rms[0],
                 campaign->reference_rms[1],
                 wb_pages_escape(source, sizeof source, campaign->reference_source));
    wb_document_heading(document, 2, "merits", "How well the model fits");
    struct wb_document_table *const table = wb_document_table(document, caption, 8, columns);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const bool validated = wire->validation_state == WB_RECORDINGS_DONE;
        const struct wb_validate_result *const v = &wire->validation;
        struct wb_pages_row row = {.n = 0};
        wb_pages_cell_plain(&row, WB_TONE_PLAIN, wire->wanted->label);
        put_rms(&row, wire->calibration_state == WB_RECORDINGS_DONE, wire->calibration.rms,
                campaign->calibration_limit);
        if (wire->validation_state == WB_RECORDINGS_NOT_WANTED)
            wb_pages_cell(&row, WB_TONE_QUIET, "\xe2\x80\x93");
        else
            put_rms(&row, validated, v->elastoplastic.rms, campaign->validation_limit);
        wb_pages_cell_number(&row, validated ? v->elastoplastic.max_error : (double)NAN, 4);
        wb_pages_cell_number(&row, validated ? v->elastic.rms : (double)NAN, 4);
        put_share(&row, wb_recordings_results_validation_share(wire));
        wb_pages_cell_number(&row, validated ? v->shape_rms / WB_MM : (double)NAN, 2);
        wb_pages_cell_number(&row, validated ? v->curve.max_force / WB_MN : (double)NAN, 1);
        wb_pages_put_row(document, table, false, &row);
    }
}

static bool is_about_gaps(const char *warning)
{
    return strstr(warning, WB_ALIGN_GAPS_TEXT);
}

static void count_gaps(const struct wb_recordings_results_tests *tests, int *n, double *longest)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        const struct wb_json *const rows =
            test->usable ? wb_json_get(wb_json_get(test->dataset.document, "checks"), "rows")
                         : NULL;
        double gaps = 0.0, one = 0.0;
        if (!wb_json_get_number(rows, "gaps", &gaps) || !(gaps > 0.0))
            continue;
        ++*n;
        if (wb_json_get_number(rows, "longest_gap_s", &one))
            *longest = fmax(*longest, one);
    }
}

/* Recordings with gaps, in one line: their curves stay usable, a gap is left out of them. */
static int put_gaps(struct wb_document *document, const struct wb_recordings_results *results)
{
    char item[300];
    double longest = 0.0;
    int n = 0;
    for (int i = 0; i < results->n_wires; i++) {
        count_gaps(&results->wires[i].calibration_tests, &n, &longest);
        count_gaps(&results->wires[i].validation_tests, &n, &longest);
    }
    if (n == 0)
        return 0;
    snprintf(item, sizeof item,
             "%d of %d recordings %s gaps in the rows, the longest of %.2f s; the pages of the "
             "wires name them.",
             n, results->n_usable, wb_pages_plural(n, "has", "have"), longest);
    wb_document_item(document, WB_TONE_PLAIN, item);
    return 1;
}

/* Warnings of alignments, at most a few here; each wire's pages list its own. */
static int put_alignment_warnings(struct wb_document *document,
                                  const struct wb_recordings_results_tests *tests, int shown)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        const struct wb_json *const warnings =
            test->usable ? wb_json_get(test->dataset.document, "warnings") : NULL;
        for (size_t k = 0; k < wb_json_length(warnings); k++) {
            const char *warning;
            if (!wb_json_text(wb_json_item(warnings, k), &warning) || is_about_gaps(warning) ||
                ++shown > MOST_WARNINGS)
                continue;
            char name[400], text[1000], item[1500];
            snprintf(item, sizeof item, "%s: %s",
                     wb_pages_escape(name, sizeof name, test->wanted->name),
                     wb_pages_escape(text, sizeof text, warning));
            wb_document_item(document, WB_TONE_PLAIN, item);
        }
    }
    return shown;
}

/* What a reader must know of a search before trusting K and n. */
static int put_search_warnings(struct wb_document *document,
                               const struct wb_recordings_results_wire *wire)
{
    const struct wb_calibrate_result *const c = &wire->calibration;
    char label[300], item[700];
    int n = 0;
    if (wire->calibration_state != WB_RECORDINGS_DONE)
        return 0;
    wb_pages_escape(label, sizeof label, wire->wanted->label);
    if (c->end != WB_CALIBRATE_SIZE && c->end != WB_CALIBRATE_ERROR) {
        snprintf(item, sizeof item, "%s: the search for K and n ended because %s.", label,
                 wb_calibrate_end_text(c->end));
        wb_document_item(document, WB_TONE_WARNING, item);
        n++;
    }
    if (c->restarted && !(c->restart_moved <= 1e-3)) {
        snprintf(item, sizeof item,
                 "%s: a restart of the search moved K and n by up to %.2g %%: other pairs fit as "
                 "well.",
                 label, 100.0 * c->restart_moved);
        wb_document_item(document, WB_TONE_PLAIN, item);
        n++;
    }
    if (c->failed_evaluations > 0) {
        snprintf(item, sizeof item, "%s: %d of %d runs of the beam did not converge.", label,
                 c->failed_evaluations, c->evaluations);
        wb_document_item(document, WB_TONE_PLAIN, item);
        n++;
    }
    return n;
}

static void put_warnings(struct wb_document *document, const struct wb_recordings_results *results)
{
    wb_document_heading(document, 2, "warnings", "Warnings");
    int shown = 0, of_searches = 0;
    const int of_gaps = put_gaps(document, results);
    for (int i = 0; i < results->n_wires; i++)
        of_searches += put_search_warnings(document, &results->wires[i]);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        shown = put_alignment_warnings(document, &wire->calibration_tests, shown);
        shown = put_alignment_warnings(document, &wire->validation_tests, shown);
    }
    if (shown + of_searches + of_gaps == 0)
        wb_document_item(document, WB_TONE_QUIET, "None.");
    if (shown > MOST_WARNINGS) {
        char text[120];
        snprintf(text, sizeof text, "%d more on the pages of the wires.", shown - MOST_WARNINGS);
        wb_document_item(document, WB_TONE_PLAIN, text);
    }
}

void wb_pages_summary(struct wb_document *document, const struct wb_recordings_results *results)
{
    wb_document_heading(document, 1, "summary", "Summary");
    put_origin(document, results);
    put_limits(document, results);
    put_missing(document, results);
    put_properties(document, results);
    put_merits(document, results);
    put_warnings(document, results);
}
