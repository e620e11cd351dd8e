/* The pages of one wire. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/pages_private.h"
#include "base/units.h"

static void put_calibration_text(struct wb_document *document,
                                 const struct wb_recordings_results *results,
                                 const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings *const campaign = results->campaign;
    const struct wb_calibrate_result *const c = &wire->calibration;
    struct wb_text text = {0};
    wb_text_append(&text,
                   "Calibrated on %d %s of %g mm: <i>E</i> = %.0f MPa, "
                   "<i>\xcf\x83</i><sub>Y</sub> = %.2f MPa, <i>K</i> = %.0f MPa, <i>n</i> = %.3f, "
                   "RMS %.4f of <i>F</i><sub>max</sub> = %.1f mN (largest error %.4f).",
                   wire->calibration_tests.n_usable,
                   wb_pages_plural(wire->calibration_tests.n_usable, "sample", "samples"),
                   campaign->calibration_length / WB_MM, c->material.youngs_modulus / WB_MPA,
                   c->material.yield_stress / WB_MPA, c->material.strength_coefficient / WB_MPA,
                   c->material.hardening_exponent, c->rms, wire->fit.curve.max_force / WB_MN,
                   c->max_error);
    if (wire->validation_state == WB_RECORDINGS_DONE)
        wb_text_append(&text,
                       " Predicts %d %s of %g mm with RMS %.4f of <i>F</i><sub>max</sub> = %.1f mN "
                       "(largest error %.4f); a linear elastic wire would be off by RMS %.4f.",
                       wire->validation_tests.n_usable,
                       wb_pages_plural(wire->validation_tests.n_usable, "sample", "samples"),
                       campaign->validation_length / WB_MM, wire->validation.elastoplastic.rms,
                       wire->validation.curve.max_force / WB_MN,
                       wire->validation.elastoplastic.max_error, wire->validation.elastic.rms);
    wb_document_paragraph(document, wb_text_string(&text));
    document->failed |= text.failed;
    wb_text_release(&text);
}

static void put_problem(struct wb_document *document, const char *step,
                        enum wb_recordings_results_state state, const struct wb_text *problem)
{
    if (state != WB_RECORDINGS_MISSING && state != WB_RECORDINGS_FAILED)
        return;
    char reason[1200], text[1500];
    snprintf(text, sizeof text, "<b>No %s:</b> %s", step,
             wb_pages_escape(reason, sizeof reason, wb_text_string(problem)));
    wb_document_notice(document, WB_TONE_WARNING, text);
}

static void put_measured(struct wb_document *document, const struct wb_recordings_results *results,
                         const struct wb_recordings_results_wire *wire,
                         const struct wb_figures_wire *figures)
{
    const char *const measured = wb_figures_measured(results);
    const double length = results->campaign->calibration_length / WB_MM;
    char cycles[500] = "", samples[500], shapes[600];
    if (figures->cycles_test)
        snprintf(cycles, sizeof cycles,
                 "Cycles of sample %d, %g mm, %s; stretches with a slack strand left out.",
                 figures->cycles_test->dataset.info.sample,
                 figures->cycles_test->dataset.info.length / WB_MM, measured);
    if (figures->samples) {
        snprintf(samples, sizeof samples,
                 "First loading of %d %s, %g mm, %s, with mean and range; "
                 "<i>F</i><sub>max</sub> = %.1f mN.",
                 wire->fit.curve.n_samples,
                 wb_pages_plural(wire->fit.curve.n_samples, "sample", "samples"), length, measured,
                 wire->fit.curve.max_force / WB_MN);
        wb_document_figures(document, figures->cycles, cycles, figures->samples, samples);
    } else if (figures->cycles) {
        wb_document_figures(document, figures->cycles, cycles, NULL, NULL);
    }
    if (figures->shapes) {
        snprintf(shapes, sizeof shapes,
                 "Shapes of sample %d, %g mm, on its first loading, %s: the markers, moved onto "
                 "the wire's axis, in the clamp's frame.",
                 figures->shapes_test->dataset.info.sample,
                 figures->shapes_test->dataset.info.length / WB_MM, measured);
        wb_document_figures(document, figures->shapes, shapes, NULL, NULL);
    }
}

static void put_compared(struct wb_document *document, const struct wb_recordings_results *results,
                         const struct wb_recordings_results_wire *wire,
                         const struct wb_figures_wire *figures)
{
    const struct wb_recordings *const campaign = results->campaign;
    const char *const measured = wb_figures_measured(results);
    char caption[900];
    if (figures->calibration) {
        snprintf(caption, sizeof caption,
                 "Calibration at %g mm: mean of the samples, %s, and the calibrated beam. Inset: "
                 "markers of one sample and computed shape at half and at full deflection. "
                 "<i>F</i><sub>max</sub> = %.1f mN.",
                 campaign->calibration_length / WB_MM, measured, wire->fit.curve.max_force / WB_MN);
        wb_document_figures(document, figures->calibration, caption, NULL, NULL);
    }
    if (figures->validation) {
        snprintf(caption, sizeof caption,
                 "Validation at %g mm: mean of the samples, %s, the beam calibrated at %g mm, and "
                 "for contrast the same beam without yielding, which leaves the frame. Inset as "
                 "before. <i>F</i><sub>max</sub> = %.1f mN.",
                 campaign->validation_length / WB_MM, measured,
                 campaign->calibration_length / WB_MM, wire->validation.curve.max_force / WB_MN);
        wb_document_figures(document, figures->validation, caption, NULL, NULL);
    }
    if (figures->error) {
        snprintf(caption, sizeof caption,
                 "Error of the computed force against the mean force, %s (eq. 18), as part of each "
                 "curve's own <i>F</i><sub>max</sub>, with its RMS (eq. 19).",
                 measured);
        wb_document_figures(document, figures->error, caption, NULL, NULL);
    }
}

struct merit {
    const char *name, *unit;
    double calibration, validation; /* in the unit; NaN unknown */
    int decimals;
};

static void put_merit(struct wb_document *document, struct wb_document_table *table,
                      const struct merit *merit)
{
    struct wb_pages_row row = {.n = 0};
    wb_pages_cell(&row, WB_TONE_PLAIN, "%s", merit->name);
    wb_pages_cell(&row, WB_TONE_QUIET, "%s", merit->unit);
    wb_pages_cell_number(&row, merit->calibration, merit->decimals);
    wb_pages_cell_number(&row, merit->validation, merit->decimals);
    wb_pages_put_row(document, table, false, &row);
}

static void put_numbers(struct wb_document *document, const struct wb_recordings_results_wire *wire)
{
    static const struct wb_document_column columns[] = {
        {"Figure of merit"},
        {"Unit"},
        {.heading = "Calibration", .right = true},
        {.heading = "Validation", .right = true},
    };
    const double none = (double)NAN;
    const bool v = wire->validation_state == WB_RECORDINGS_DONE;
    const struct wb_calibrate_result *const c = &wire->calibration;
    const struct wb_validate_result *const fit = &wire->fit, *const val = &wire->validation;
    const bool scatters = fit->curve.n_samples > 1, v_scatters = v && val->curve.n_samples > 1;
    const char *const part = "of <i>F</i><sub>max</sub>";
    const struct merit merits[] = {
        {"RMS (eq. 19)", part, fit->elastoplastic.rms, v ? val->elastoplastic.rms : none, 4},
        {"RMS beyond 5 mm", part, fit->elastoplastic.rms_from_5mm,
         v ? val->elastoplastic.rms_from_5mm : none, 4},
        {"Largest error (eq. 18)", part, fit->elastoplastic.max_error,
         v ? val->elastoplastic.max_error : none, 4},
        {"RMS of the linear elastic beam", part, fit->elastic.rms, v ? val->elastic.rms : none, 4},
        {"Scatter between samples <i>s</i>", part, scatters ? c->scatter_rms : none,
         v_scatters ? val->scatter_rms : none, 4},
        {"Scatter beyond the natural shapes <i>r</i>", part,
         scatters ? c->residual_scatter_rms : none, v_scatters ? val->residual_scatter_rms : none,
         4},
        {"RMS expected from scatter, at most", part, none, v ? val->expected_rms : none, 4},
        {"Share that the scatter explains, at most", "1", none,
         wb_recordings_results_validation_share(wire), 2},
        {"Shapes, RMS distance", "mm", fit->shape_rms / WB_MM, v ? val->shape_rms / WB_MM : none,
         2},
        {"Shapes, largest distance", "mm", fit->shape_max / WB_MM,
         v ? val->shape_max / WB_MM : none, 2},
        {"<i>F</i><sub>max</sub>", "mN", fit->curve.max_force / WB_MN,
         v ? val->curve.max_force / WB_MN : none, 1},
        {"Largest deflection of all samples", "mm", fit->curve.max_deflection / WB_MM,
         v ? val->curve.max_deflection / WB_MM : none, 1},
        {"Mean bow of the samples", "mm", wb_dataset_bow(&fit->info) / WB_MM,
         v ? wb_dataset_bow(&val->info) / WB_MM : none, 2},
    };
    wb_document_heading(document, 2, "", "Numbers");
    struct wb_document_table *const table = wb_document_table(
        document,
        "Scatter <i>s</i>: standard deviation between the samples at the same deflection, RMS over "
        "all deflections; <i>r</i>: what remains of it when each sample is computed with its own "
        "natural shape, the model's error with the bow included. With <i>m</i> the smaller of "
        "both, "
        "the mean of <i>n</i> samples is off by <i>m</i>/<i>n</i><sup>1/2</sup> at most by chance, "
        "so that even a perfect model would show an RMS of up to "
        "(<i>m</i><sub>v</sub><sup>2</sup>/<i>n</i><sub>v</sub> + "
        "<i>m</i><sub>c</sub><sup>2</sup>/<i>n</i><sub>c</sub>)<sup>1/2</sup>, of the validation's "
        "samples (v) and those calibrated on (c). Share: its square over RMS<sup>2</sup>, at most "
        "1; an upper bound, near 0 the error is the model's.",
        4, columns);
    for (size_t i = 0; i < sizeof merits / sizeof merits[0]; i++)
        put_merit(document, table, &merits[i]);
}

static void put_remarks(struct wb_document *document, const struct wb_calibrate_result *result)
{
    const char *remarks[WB_CALIBRATE_MOST_REMARKS];
    const int n = wb_calibrate_remarks(result, remarks);
    for (int i = 0; i < n; i++) {
        char escaped[400], item[440];
        snprintf(item, sizeof item, "Note: %s.",
                 wb_pages_escape(escaped, sizeof escaped, remarks[i]));
        wb_document_item(document, WB_TONE_PLAIN, item);
    }
}

static void put_search(struct wb_document *document, const struct wb_recordings_results_wire *wire,
                       const struct wb_figures_wire *figures)
{
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
        wb_text_append(&text, " %d of the runs did not converge and were given a large error.",
                       c->failed_evaluations);
    wb_document_paragraph(document, wb_text_string(&text));
    document->failed |= text.failed;
    wb_text_release(&text);
    put_remarks(document, c);
    if (figures->optimiser)
        wb_document_figures(document, figures->optimiser,
                            "Left: error of the best corner of the simplex after each iteration. "
                            "Right: its path from the first guess to the calibrated values.",
                            NULL, NULL);
}

static void put_test_warnings(struct wb_document *document,
                              const struct wb_recordings_results_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        const struct wb_json *const warnings =
            test->usable ? wb_json_get(test->dataset.document, "warnings") : NULL;
        for (size_t k = 0; k < wb_json_length(warnings); k++) {
            const char *warning;
            if (!wb_json_text(wb_json_item(warnings, k), &warning))
                continue;
            char name[400], escaped[1000], item[1500];
            snprintf(item, sizeof item, "%s: %s",
                     wb_pages_escape(name, sizeof name, test->wanted->name),
                     wb_pages_escape(escaped, sizeof escaped, warning));
            wb_document_item(document, WB_TONE_PLAIN, item);
        }
    }
}

static bool has_warnings(const struct wb_recordings_results_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        const struct wb_recordings_results_test *const test = &tests->items[i];
        if (!test->usable || wb_json_length(wb_json_get(test->dataset.document, "warnings")) > 0)
            return true;
    }
    return false;
}

void wb_pages_wire(struct wb_document *document, const struct wb_recordings_results *results,
                   int index, const struct wb_figures_wire *figures)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    char slug[64], anchor[80];
    wb_figures_slug(slug, wire->wanted->product.name);
    snprintf(anchor, sizeof anchor, "wire-%s", slug);
    wb_document_new_page(document);
    wb_document_heading(document, 1, anchor, wire->wanted->label);
    put_problem(document, "calibration", wire->calibration_state, &wire->calibration_problem);
    put_problem(document, "validation", wire->validation_state, &wire->validation_problem);
    if (wire->calibration_state == WB_RECORDINGS_DONE)
        put_calibration_text(document, results, wire);
    put_measured(document, results, wire, figures);
    if (wire->calibration_state == WB_RECORDINGS_DONE) {
        put_compared(document, results, wire, figures);
        put_search(document, wire, figures);
        put_numbers(document, wire);
    }
    if (has_warnings(&wire->calibration_tests) || has_warnings(&wire->validation_tests)) {
        wb_document_heading(document, 2, "", "Warnings");
        wb_pages_missing(document, &wire->calibration_tests);
        wb_pages_missing(document, &wire->validation_tests);
        put_test_warnings(document, &wire->calibration_tests);
        put_test_warnings(document, &wire->validation_tests);
    }
}
