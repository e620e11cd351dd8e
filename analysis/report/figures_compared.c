/* Figures that compare what was measured with the calibrated beam. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/report/figures_private.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

#define SHAPE_POINTS 60

/* Measured markers and the computed shape at half and at full deflection. */
static enum wb_status add_shapes(struct wb_panel *inset,
                                 const struct wb_recordings_results_wire *wire,
                                 const struct wb_recordings_results_tests *tests,
                                 const struct wb_validate_result *result, struct wb_colour colour)
{
    const struct wb_dataset *dataset = NULL;
    for (int i = 0; i < tests->n && !dataset; i++) {
        if (tests->items[i].usable && tests->items[i].dataset.n_shape_rows > 0)
            dataset = &tests->items[i].dataset;
    }
    wb_figure_set_axes(inset, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(inset);
    const struct wb_figure_style computed = {.colour = wb_palette_ink(), .width = 0.9};
    const struct wb_figure_style measured = {
        .colour = colour, .marker = WB_MARKER_CIRCLE, .marker_size = 3.4};
    for (int i = 1; i <= 2 && dataset; i++) {
        struct wb_figures_frame frame;
        double line_x[SHAPE_POINTS], line_y[SHAPE_POINTS];
        wb_figures_find_frame(dataset, 0.5 * i * result->curve.max_deflection, &frame);
        if (frame.n == 0)
            continue;
        const enum wb_status status = wb_validate_shape(
            &wire->properties, &result->info, frame.deflection, SHAPE_POINTS, line_x, line_y);
        if (status != WB_OK && status != WB_ERR_CONVERGENCE)
            return status;
        for (int k = 0; k < SHAPE_POINTS; k++) {
            line_x[k] /= WB_MM;
            line_y[k] /= WB_MM;
        }
        if (status == WB_OK)
            wb_figure_add_line(inset, NULL, SHAPE_POINTS, line_x, line_y, &computed);
        wb_figure_add_line(inset, NULL, (size_t)frame.n, frame.x, frame.y, &measured);
    }
    return WB_OK;
}

static void add_measured(struct wb_panel *panel, const struct wb_curve *curve,
                         struct wb_colour colour)
{
    char label[80];
    if (curve->n_samples > 1)
        snprintf(label, sizeof label, "range of %d samples", curve->n_samples);
    wb_figures_add_range(panel, label, curve, colour);
    snprintf(label, sizeof label, curve->n_samples > 1 ? "measured, mean" : "measured");
    const struct wb_figure_style style = {.colour = colour, .width = 1.6};
    wb_figures_add_curve(panel, label, curve, curve->force, WB_MN, &style);
}

static const struct wb_figure_style computed_style = {
    .colour = {0.114, 0.153, 0.2, 1.0}, .width = 1.2, .dash = WB_DASH_DASHED};

enum wb_status wb_figures_draw_calibration(struct wb_figure **figure,
                                           const struct wb_recordings_results *results,
                                           const struct wb_recordings_results_wire *wire,
                                           struct wb_colour colour)
{
    const struct wb_validate_result *const fit = &wire->fit;
    WB_TRY(wb_figures_start(figure, results, wire, "calibration", WB_PDF_WIDTH, 208.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figures_set_force_axes(panel, fit->curve.max_force);
    wb_figures_state_max_force(*figure, results, fit->curve.max_force);
    /* Room above for the inset. */
    wb_figure_set_y_range(panel, (double)NAN, 1.25 * fit->curve.max_force / WB_MN);
    add_measured(panel, &fit->curve, colour);
    wb_figures_add_curve(panel, "computed, calibrated", &fit->curve, fit->elastoplastic.force,
                         WB_MN, &computed_style);
    return add_shapes(wb_figure_add_inset(panel), wire, &wire->calibration_tests, fit, colour);
}

enum wb_status wb_figures_draw_validation(struct wb_figure **figure,
                                          const struct wb_recordings_results *results,
                                          const struct wb_recordings_results_wire *wire,
                                          struct wb_colour colour)
{
    const struct wb_validate_result *const validation = &wire->validation;
    WB_TRY(wb_figures_start(figure, results, wire, "validation", WB_PDF_WIDTH, 208.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figures_set_force_axes(panel, validation->curve.max_force);
    wb_figures_state_max_force(*figure, results, validation->curve.max_force);
    /* The elastic curve goes far beyond; it may leave the frame. */
    wb_figure_set_y_range(panel, (double)NAN, 1.45 * validation->curve.max_force / WB_MN);
    add_measured(panel, &validation->curve, colour);
    wb_figures_add_curve(panel, "computed, elastoplastic", &validation->curve,
                         validation->elastoplastic.force, WB_MN, &computed_style);
    const struct wb_figure_style elastic = {
        .colour = wb_palette_grey(), .width = 1.2, .dash = WB_DASH_DOTTED};
    wb_figures_add_curve(panel, "computed, linear elastic", &validation->curve,
                         validation->elastic.force, WB_MN, &elastic);
    return add_shapes(wb_figure_add_inset(panel), wire, &wire->validation_tests, validation,
                      colour);
}

static void add_error(struct wb_panel *panel, const char *what, double length,
                      const struct wb_validate_result *result, const struct wb_figure_style *style)
{
    char label[160];
    snprintf(label, sizeof label, "%s, %g mm: RMS %.4f, <i>F</i><sub>max</sub> %.1f mN", what,
             length / WB_MM, result->elastoplastic.rms, result->curve.max_force / WB_MN);
    wb_figures_add_curve(panel, label, &result->curve, result->elastoplastic.error, 1.0, style);
}

enum wb_status wb_figures_draw_error(struct wb_figure **figure,
                                     const struct wb_recordings_results *results,
                                     const struct wb_recordings_results_wire *wire,
                                     struct wb_colour colour)
{
    const struct wb_recordings *const campaign = results->campaign;
    WB_TRY(wb_figures_start(figure, results, wire, "error", WB_PDF_WIDTH, 155.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Error / <i>F</i><sub>max</sub>");
    const struct wb_figure_style calibration = {
        .colour = wb_palette_ink(), .width = 1.1, .dash = WB_DASH_DASHED};
    add_error(panel, "calibration", campaign->calibration_length, &wire->fit, &calibration);
    const struct wb_figure_style validation = {.colour = colour, .width = 1.5};
    if (wire->validation_state == WB_RECORDINGS_DONE)
        add_error(panel, "validation", campaign->validation_length, &wire->validation, &validation);
    return WB_OK;
}

/* --- the search --- */

static enum wb_status add_path(struct wb_figure *figure, const struct wb_calibrate_result *result,
                               struct wb_colour colour)
{
    const int n = result->n_path;
    double *const values = malloc(4 * ((size_t)n + 1) * sizeof *values);
    if (!values)
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
    double *const step = values, *const error = values + n, *const k = values + 2 * n,
                  *const exponent = values + 3 * n;
    for (int i = 0; i < n; i++) {
        step[i] = i + 1;
        error[i] = result->path[i].error;
        k[i] = result->path[i].strength_coefficient / WB_MPA;
        exponent[i] = result->path[i].hardening_exponent;
    }
    struct wb_panel *const errors = wb_figure_add_panel(figure);
    wb_figure_set_axes(errors, "Iteration",
                       "<i>E</i><sub>L2</sub> / (<i>F</i><sub>max</sub> "
                       "\xce\xb4<sub>max</sub><sup>1/2</sup>)");
    wb_figure_set_logarithmic_y(errors);
    const struct wb_figure_style line = {.colour = colour, .width = 1.3};
    wb_figure_add_line(errors, NULL, (size_t)n, step, error, &line);

    struct wb_panel *const path = wb_figure_add_panel(figure);
    wb_figure_set_axes(path, "Hardening exponent <i>n</i>", "Strength coefficient <i>K</i> (MPa)");
    const struct wb_figure_style thin = {
        .colour = colour, .width = 0.8, .marker = WB_MARKER_CIRCLE, .marker_size = 2.4};
    wb_figure_add_line(path, "best so far", (size_t)n, exponent, k, &thin);
    const double first_n = result->first_hardening_exponent;
    const double first_k = result->first_strength_coefficient / WB_MPA;
    const struct wb_figure_style start = {
        .colour = wb_palette_grey(), .marker = WB_MARKER_RING, .marker_size = 6.0};
    wb_figure_add_line(path, "<i>n</i><sub>0</sub>, <i>K</i><sub>0</sub> (eqs. 15, 16)", 1,
                       &first_n, &first_k, &start);
    const double last_n = result->material.hardening_exponent;
    const double last_k = result->material.strength_coefficient / WB_MPA;
    const struct wb_figure_style end = {
        .colour = wb_palette_ink(), .marker = WB_MARKER_DIAMOND, .marker_size = 6.0};
    wb_figure_add_line(path, "calibrated", 1, &last_n, &last_k, &end);
    free(values);
    return WB_OK;
}

enum wb_status wb_figures_draw_optimiser(struct wb_figure **figure,
                                         const struct wb_recordings_results *results,
                                         const struct wb_recordings_results_wire *wire,
                                         struct wb_colour colour)
{
    if (wire->calibration.n_path < 1)
        return WB_OK;
    WB_TRY(wb_figures_start(figure, results, wire, "optimiser", WB_PDF_WIDTH, 170.0));
    return add_path(*figure, &wire->calibration, colour);
}
