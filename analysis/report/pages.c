#include "analysis/report/pages.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/units.h"
#include "base/version.h"

const struct wb_pages_property wb_pages_properties[4] = {
    {"Young's modulus", "<i>E</i>", "MPa", "youngs_modulus_MPa", WB_MPA, 0},
    {"Yield stress", "<i>\xcf\x83</i><sub>Y</sub>", "MPa", "yield_stress_MPa", WB_MPA, 2},
    {"Strength coefficient", "<i>K</i>", "MPa", "strength_coefficient_MPa", WB_MPA, 0},
    {"Hardening exponent", "<i>n</i>", "1", "hardening_exponent", 1.0, 3},
};

double wb_pages_value(const struct wb_material *material, int property)
{
    const double values[] = {material->youngs_modulus, material->yield_stress,
                             material->strength_coefficient, material->hardening_exponent};
    return values[property];
}

const char *wb_pages_plural(int n, const char *one, const char *many)
{
    return n == 1 ? one : many;
}

char *wb_pages_escape(char *buffer, size_t size, const char *raw)
{
    struct wb_text text = {0};
    wb_text_append_escaped(&text, raw);
    size_t length = strlen(wb_text_string(&text));
    if (length >= size) {
        length = size - 1;
        /* Not within an entity, and not within a character of several bytes. */
        const char *const string = wb_text_string(&text);
        for (size_t back = 0; back < 7 && back < length; back++) {
            if (string[length - 1 - back] == ';')
                break;
            if (string[length - 1 - back] == '&') {
                length -= back + 1;
                break;
            }
        }
        while (length > 0 && ((unsigned char)string[length] & 0xc0) == 0x80)
            length--;
    }
    memcpy(buffer, wb_text_string(&text), length);
    buffer[length] = '\0';
    wb_text_release(&text);
    return buffer;
}

void wb_pages_cell(struct wb_pages_row *row, enum wb_document_tone tone, const char *format, ...)
{
    if (row->n == WB_DOCUMENT_COLUMNS)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(row->cells[row->n], sizeof row->cells[0], format, arguments);
    va_end(arguments);
    row->tones[row->n++] = tone;
}

void wb_pages_cell_plain(struct wb_pages_row *row, enum wb_document_tone tone, const char *text)
{
    char escaped[WB_PAGES_CELL];
    wb_pages_cell(row, tone, "%s", wb_pages_escape(escaped, sizeof escaped, text));
}

void wb_pages_cell_number(struct wb_pages_row *row, double value, int decimals)
{
    /* What rounds to zero has no sign. */
    const bool negative = value < 0.0 && -value * pow(10.0, decimals) >= 0.5;
    if (isfinite(value))
        wb_pages_cell(row, WB_TONE_PLAIN, "%s%.*f", negative ? "\xe2\x88\x92" : "", decimals,
                      fabs(value));
    else
        wb_pages_cell(row, WB_TONE_QUIET, "\xe2\x80\x93");
}

void wb_pages_put_row(struct wb_document *document, struct wb_document_table *table,
                      bool begins_group, struct wb_pages_row *row)
{
    const char *cells[WB_DOCUMENT_COLUMNS] = {NULL};
    for (int i = 0; i < row->n; i++)
        cells[i] = row->cells[i];
    wb_document_row(document, table, begins_group, cells);
    for (int i = 0; i < row->n; i++)
        wb_document_tone_cell(table, i, row->tones[i]);
    row->n = 0;
}

int wb_pages_missing(struct wb_document *document, const struct wb_recordings_results_tests *tests)
{
    int n = 0;
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        if (test->usable)
            continue;
        char name[400], problem[1200], item[1800];
        wb_pages_escape(name, sizeof name, test->wanted->name);
        wb_pages_escape(problem, sizeof problem, wb_text_string(&test->problem));
        snprintf(item, sizeof item, "<b>%s</b>: %s", name, problem);
        wb_document_item(document, WB_TONE_WARNING, item);
        n++;
    }
    return n;
}

static void add_overview(struct wb_document *document, const struct wb_recordings_results *results,
                         const struct wb_figures *figures)
{
    if (!figures->calibration && !figures->validation)
        return;
    const struct wb_recordings *const campaign = results->campaign;
    const char *const measured = wb_figures_measured(results);
    char caption[600];
    wb_document_heading(document, 1, "overview", "All wires");
    if (figures->calibration) {
        snprintf(caption, sizeof caption,
                 "Mean force and deflection of the samples of %g mm, %s, and the beam calibrated "
                 "against them. Bands: range of the samples.",
                 campaign->calibration_length / WB_MM, measured);
        wb_document_figures(document, figures->calibration, caption, NULL, NULL);
    }
    if (figures->validation) {
        snprintf(caption, sizeof caption,
                 "The same wires at %g mm, %s, and the prediction of the beams calibrated at %g "
                 "mm.",
                 campaign->validation_length / WB_MM, measured,
                 campaign->calibration_length / WB_MM);
        wb_document_figures(document, figures->validation, caption, NULL, NULL);
    }
    if (figures->errors) {
        snprintf(caption, sizeof caption,
                 "Error of the prediction at %g mm (eq. 18): distance of mean force, %s, and "
                 "computed force over the largest mean force of the wire.",
                 campaign->validation_length / WB_MM, measured);
        wb_document_figures(document, figures->errors, caption, NULL, NULL);
    }
}

void wb_pages_build(struct wb_document *document, const struct wb_recordings_results *results,
                    const struct wb_figures *figures)
{
    char subtitle[300], footer[300];
    snprintf(footer, sizeof footer, "wirebench %s, revision %s%s", wb_version(),
             wb_version_revision(), results->any_virtual ? " \xc2\xb7 virtual rig" : "");
    snprintf(subtitle, sizeof subtitle,
             "%d of %d recordings, the latest of %.10s \xc2\xb7 wirebench %s, revision %s",
             results->n_usable, results->n_tests,
             results->latest_utc[0] ? results->latest_utc : "an unknown date", wb_version(),
             wb_version_revision());
    if (results->n_usable == 0)
        snprintf(subtitle, sizeof subtitle,
                 "none of %d recordings \xc2\xb7 wirebench %s, revision "
                 "%s",
                 results->n_tests, wb_version(), wb_version_revision());
    wb_document_init(document, "Calibration report", results->campaign->title, subtitle, footer,
                     results->latest_utc);
    wb_pages_summary(document, results);
    wb_pages_bench(document, results, figures);
    add_overview(document, results, figures);
    for (int i = 0; i < results->n_wires; i++)
        wb_pages_wire(document, results, i, &figures->wires[i]);
    wb_pages_provenance(document, results);
}
