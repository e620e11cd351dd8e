#include "analysis/report/figures.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/figures_private.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

const char *wb_figures_measured(const struct wb_recordings_results *results)
{
    return results->any_virtual ? "measured (virtual rig)" : "measured";
}

void wb_figures_slug(char slug[64], const char *name)
{
    size_t n = 0;
    for (; name[n] && n < 48; n++)
        slug[n] = (char)(isalnum((unsigned char)name[n]) ? tolower((unsigned char)name[n]) : '-');
    slug[n] = '\0';
}

double *wb_figures_scaled(const double *values, int n, double unit)
{
    double *const scaled = malloc(((size_t)n + 1) * sizeof *scaled);
    for (int i = 0; scaled && i < n; i++)
        scaled[i] = values[i] / unit;
    return scaled;
}

double *wb_figures_deflections(const struct wb_curve *curve)
{
    double *const mm = malloc(((size_t)curve->n + 1) * sizeof *mm);
    for (int i = 0; mm && i < curve->n; i++)
        mm[i] = i * curve->step / WB_MM;
    return mm;
}

void wb_figures_add_curve(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          const double *values, double unit, const struct wb_figure_style *style)
{
    double *const x = wb_figures_deflections(curve);
    double *const y = wb_figures_scaled(values, curve->n, unit);
    if (x && y)
        wb_figure_add_line(panel, label, (size_t)curve->n, x, y, style);
    free(x);
    free(y);
}

void wb_figures_add_range(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          struct wb_colour colour)
{
    double *const x = wb_figures_deflections(curve);
    double *const low = wb_figures_scaled(curve->low, curve->n, WB_MN);
    double *const high = wb_figures_scaled(curve->high, curve->n, WB_MN);
    const double *const edges[2] = {low, high};
    if (x && low && high && curve->n_samples > 1)
        wb_figure_add_band(panel, label, (size_t)curve->n, x, edges, wb_palette_fade(colour, 0.22));
    free(x);
    free(low);
    free(high);
}

void wb_figures_set_force_axes(struct wb_panel *panel, double max_force)
{
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Force <i>F</i> (mN)");
    if (max_force > 0.0)
        wb_figure_set_right_axis(panel, "<i>F</i> / <i>F</i><sub>max</sub>", WB_MN / max_force);
}

enum wb_status wb_figures_start(struct wb_figure **figure,
                                const struct wb_recordings_results *results,
                                const struct wb_recordings_results_wire *wire, const char *kind,
                                double width, double height)
{
    char slug[64] = "all", name[128];
    if (wire)
        wb_figures_slug(slug, wire->wanted->product.name);
    snprintf(name, sizeof name, "%s-%s", slug, kind);
    WB_TRY(wb_figure_create(figure, name, width, height));
    wb_figure_set_footer(*figure, wb_figures_measured(results));
    return WB_OK;
}

void wb_figures_state_max_force(struct wb_figure *figure,
                                const struct wb_recordings_results *results, double max_force)
{
    char footer[160];
    snprintf(footer, sizeof footer, "%s \xc2\xb7 <i>F</i><sub>max</sub> = %.1f mN",
             wb_figures_measured(results), max_force / WB_MN);
    wb_figure_set_footer(figure, footer);
}

/* --- all wires in one --- */

static void add_overview(struct wb_panel *panel, const struct wb_recordings_results *results,
                         int index, const struct wb_validate_result *result)
{
    static const enum wb_figure_marker markers[] = {WB_MARKER_CIRCLE, WB_MARKER_SQUARE,
                                                    WB_MARKER_TRIANGLE, WB_MARKER_DIAMOND};
    const struct wb_curve *const curve = &result->curve;
    const struct wb_colour colour = wb_palette_wire(index);
    char label[160];
    snprintf(label, sizeof label, "%s, measured", results->wires[index].wanted->label);
    wb_figures_add_range(panel, NULL, curve, colour);
    /* Every tenth point carries a marker, so that wires differ without their colours. */
    double *const x = wb_figures_deflections(curve);
    double *const y = wb_figures_scaled(curve->force, curve->n, WB_MN);
    int n = 0;
    for (int i = 0; x && y && i < curve->n; i += 10, n++) {
        x[n] = x[i];
        y[n] = y[i];
    }
    const struct wb_figure_style points = {
        .colour = colour, .marker = markers[index % 4], .marker_size = 4.2};
    if (x && y)
        wb_figure_add_line(panel, label, (size_t)n, x, y, &points);
    free(x);
    free(y);
    snprintf(label, sizeof label, "%s, computed", results->wires[index].wanted->label);
    const struct wb_figure_style line = {.colour = colour, .width = 1.3};
    wb_figures_add_curve(panel, label, curve, result->elastoplastic.force, WB_MN, &line);
}

static enum wb_status draw_overview(struct wb_figure **figure,
                                    const struct wb_recordings_results *results, bool validation)
{
    int n = 0;
    for (int i = 0; i < results->n_wires; i++)
        n += validation ? results->wires[i].validation_state == WB_RECORDINGS_DONE
                        : results->wires[i].calibration_state == WB_RECORDINGS_DONE;
    if (n == 0)
        return WB_OK;
    WB_TRY(wb_figures_start(figure, results, NULL, validation ? "validation" : "calibration",
                            WB_PDF_WIDTH, 205.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figures_set_force_axes(panel, 0.0);
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        if (validation && wire->validation_state == WB_RECORDINGS_DONE)
            add_overview(panel, results, i, &wire->validation);
        if (!validation && wire->calibration_state == WB_RECORDINGS_DONE)
            add_overview(panel, results, i, &wire->fit);
    }
    return WB_OK;
}

static enum wb_status draw_errors(struct wb_figure **figure,
                                  const struct wb_recordings_results *results)
{
    static const enum wb_figure_dash dashes[] = {WB_DASH_SOLID, WB_DASH_DASHED, WB_DASH_MIXED,
                                                 WB_DASH_DOTTED};
    struct wb_panel *panel = NULL;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        if (wire->validation_state != WB_RECORDINGS_DONE)
            continue;
        if (!*figure) {
            WB_TRY(wb_figures_start(figure, results, NULL, "errors", WB_PDF_WIDTH, 165.0));
            panel = wb_figure_add_panel(*figure);
            wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)",
                               "Error / <i>F</i><sub>max</sub>");
        }
        char label[160];
        snprintf(label, sizeof label, "%s, RMS %.4f, <i>F</i><sub>max</sub> %.1f mN",
                 wire->wanted->label, wire->validation.elastoplastic.rms,
                 wire->validation.curve.max_force / WB_MN);
        const struct wb_figure_style style = {
            .colour = wb_palette_wire(i), .width = 1.3, .dash = dashes[i % 4]};
        wb_figures_add_curve(panel, label, &wire->validation.curve,
                             wire->validation.elastoplastic.error, 1.0, &style);
    }
    return WB_OK;
}

static enum wb_status draw_wire(struct wb_figures_wire *figures,
                                const struct wb_recordings_results *results, int index)
{
    const struct wb_recordings_results_wire *const wire = &results->wires[index];
    const struct wb_colour colour = wb_palette_wire(index);
    WB_TRY(wb_figures_draw_cycles(figures, results, wire));
    WB_TRY(wb_figures_draw_shapes(figures, results, wire, colour));
    if (wire->calibration_state == WB_RECORDINGS_DONE) {
        WB_TRY(wb_figures_draw_samples(&figures->samples, results, wire, colour));
        WB_TRY(wb_figures_draw_calibration(&figures->calibration, results, wire, colour));
        WB_TRY(wb_figures_draw_optimiser(&figures->optimiser, results, wire, colour));
        WB_TRY(wb_figures_draw_error(&figures->error, results, wire, colour));
    }
    if (wire->validation_state == WB_RECORDINGS_DONE)
        WB_TRY(wb_figures_draw_validation(&figures->validation, results, wire, colour));
    return WB_OK;
}

enum wb_status wb_figures_create(struct wb_figures *figures,
                                 const struct wb_recordings_results *results)
{
    memset(figures, 0, sizeof *figures);
    figures->wires = calloc((size_t)results->n_wires + 1, sizeof *figures->wires);
    if (!figures->wires)
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
    figures->n_wires = results->n_wires;
    enum wb_status status = wb_figures_draw_bench(&figures->bench, results);
    if (status == WB_OK)
        status = draw_overview(&figures->calibration, results, false);
    if (status == WB_OK)
        status = draw_overview(&figures->validation, results, true);
    if (status == WB_OK)
        status = draw_errors(&figures->errors, results);
    for (int i = 0; status == WB_OK && i < results->n_wires; i++)
        status = draw_wire(&figures->wires[i], results, i);
    if (status != WB_OK)
        wb_figures_release(figures);
    return status;
}

int wb_figures_list(const struct wb_figures *figures, const struct wb_figure **list)
{
    int n = 0;
    const struct wb_figure *const first[] = {figures->bench, figures->calibration,
                                             figures->validation, figures->errors};
    for (int i = 0; i < 4; i++) {
        if (first[i] && list)
            list[n] = first[i];
        n += first[i] != NULL;
    }
    for (int i = 0; i < figures->n_wires; i++) {
        const struct wb_figures_wire *const wire = &figures->wires[i];
        const struct wb_figure *const each[] = {wire->cycles,      wire->samples,    wire->shapes,
                                                wire->calibration, wire->validation, wire->error,
                                                wire->optimiser};
        for (int k = 0; k < 7; k++) {
            if (each[k] && list)
                list[n] = each[k];
            n += each[k] != NULL;
        }
    }
    return n;
}

void wb_figures_release(struct wb_figures *figures)
{
    wb_figure_destroy(figures->bench);
    wb_figure_destroy(figures->calibration);
    wb_figure_destroy(figures->validation);
    wb_figure_destroy(figures->errors);
    for (int i = 0; i < figures->n_wires; i++) {
        struct wb_figures_wire *const wire = &figures->wires[i];
        wb_figure_destroy(wire->cycles);
        wb_figure_destroy(wire->samples);
        wb_figure_destroy(wire->shapes);
        wb_figure_destroy(wire->calibration);
        wb_figure_destroy(wire->validation);
        wb_figure_destroy(wire->error);
        wb_figure_destroy(wire->optimiser);
    }
    free(figures->wires);
    memset(figures, 0, sizeof *figures);
}
