/* Figures of what was measured: the bench, cycles, samples, shapes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/figures_private.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

/* --- from datasets --- */

double wb_figures_turn(const struct wb_dataset *dataset, double *t)
{
    double largest = 0.0;
    *t = (double)INFINITY;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == 1 && row->phase == WB_PHASE_LOAD && row->deflection > largest) {
            largest = row->deflection;
            *t = row->t;
        }
    }
    return largest;
}

void wb_figures_find_frame(const struct wb_dataset *dataset, double deflection,
                           struct wb_figures_frame *frame)
{
    double end, nearest = (double)INFINITY;
    wb_figures_turn(dataset, &end);
    frame->n = 0;
    for (size_t i = 0; i < dataset->n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[i];
        if (row->t <= end + 0.2 && fabs(row->deflection - deflection) < nearest) {
            nearest = fabs(row->deflection - deflection);
            frame->deflection = row->deflection;
            frame->t = row->t;
        }
    }
    for (size_t i = 0; isfinite(nearest) && i < dataset->n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[i];
        if (row->t != frame->t || frame->n == WB_FIGURES_MARKERS)
            continue;
        frame->x[frame->n] = row->x / WB_MM;
        frame->y[frame->n++] = row->y / WB_MM;
    }
}

static int n_cycles(const struct wb_dataset *dataset)
{
    int n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        if (dataset->rows[i].cycle > n)
            n = dataset->rows[i].cycle;
    }
    return n;
}

/* Adds the rows of one cycle (only its loading, or all of it but slack) as a line. Below zero
 * deflection, where no cycle is, the tip lies on its rest. */
static enum wb_status add_rows(struct wb_panel *panel, const char *label,
                               const struct wb_dataset *dataset, int cycle, bool loading_only,
                               const struct wb_figure_style *style)
{
    double *const x = malloc((dataset->n_rows + 1) * sizeof *x);
    double *const y = malloc((dataset->n_rows + 1) * sizeof *y);
    if (!x || !y) {
        free(x);
        free(y);
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
    }
    const double longest = wb_dataset_gap(dataset);
    size_t n = 0;
    double last = (double)NAN;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle != cycle)
            continue;
        const bool shown =
            row->deflection >= 0.0 &&
            (row->phase == WB_PHASE_LOAD || (!loading_only && row->phase == WB_PHASE_UNLOAD));
        /* A gap in time is a gap in the line. */
        const bool gap = isfinite(last) && row->t - last > longest;
        x[n] = row->deflection / WB_MM;
        y[n++] = shown && !gap ? row->force / WB_MN : (double)NAN;
        last = row->t;
    }
    if (n > 0)
        wb_figure_add_line(panel, label, n, x, y, style);
    free(x);
    free(y);
    return WB_OK;
}

/* --- the paper's Fig. 9 --- */

enum wb_status wb_figures_draw_cycles(struct wb_figures_wire *figures,
                                      const struct wb_recordings_results *results,
                                      const struct wb_recordings_results_wire *wire)
{
    const struct wb_recordings_results_test *best = NULL;
    int most = 0;
    const struct wb_recordings_results_tests *const both[] = {&wire->calibration_tests,
                                                              &wire->validation_tests};
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < both[k]->n; i++) {
            const struct wb_recordings_results_test *const test = &both[k]->items[i];
            if (test->usable && n_cycles(&test->dataset) > most) {
                most = n_cycles(&test->dataset);
                best = test;
            }
        }
    }
    if (!best)
        return WB_OK;
    WB_TRY(wb_figures_start(&figures->cycles, results, wire, "cycles", WB_PDF_HALF_WIDTH, 200.0));
    figures->cycles_test = best;
    struct wb_panel *const panel = wb_figure_add_panel(figures->cycles);
    wb_figures_set_force_axes(panel, 0.0);
    for (int cycle = 1; cycle <= most; cycle++) {
        char label[40];
        snprintf(label, sizeof label, "cycle %d", cycle);
        /* After the first, cycles lie on each other: each is drawn thinner and darker within the
         * one before, so that all are seen. */
        const struct wb_figure_style style = {
            .colour = wb_palette_sequence(most - cycle, most),
            .width = most > 1 ? 2.8 - 2.2 * (cycle - 1) / (most - 1) : 1.0};
        WB_TRY(add_rows(panel, label, &best->dataset, cycle, false, &style));
    }
    return WB_OK;
}

enum wb_status wb_figures_draw_samples(struct wb_figure **figure,
                                       const struct wb_recordings_results *results,
                                       const struct wb_recordings_results_wire *wire,
                                       struct wb_colour colour)
{
    static const enum wb_figure_dash dashes[] = {WB_DASH_DASHED, WB_DASH_MIXED, WB_DASH_DOTTED};
    WB_TRY(wb_figures_start(figure, results, wire, "samples", WB_PDF_HALF_WIDTH, 200.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figures_set_force_axes(panel, wire->fit.curve.max_force);
    wb_figures_state_max_force(*figure, results, wire->fit.curve.max_force);
    char label[64];
    snprintf(label, sizeof label, "range of %d", wire->fit.curve.n_samples);
    wb_figures_add_range(panel, label, &wire->fit.curve, colour);
    const struct wb_figure_style mean = {.colour = colour, .width = 1.6};
    for (int i = 0; i < wire->calibration_tests.n; i++) {
        const struct wb_recordings_results_test *const test = &wire->calibration_tests.items[i];
        if (!test->usable)
            continue;
        const int sample = test->dataset.info.sample;
        snprintf(label, sizeof label, "sample %d", sample);
        const struct wb_figure_style style = {
            .colour = wb_palette_sample(sample), .width = 1.0, .dash = dashes[(sample + 2) % 3]};
        WB_TRY(add_rows(panel, label, &test->dataset, 1, true, &style));
    }
    wb_figures_add_curve(panel, "mean", &wire->fit.curve, wire->fit.curve.force, WB_MN, &mean);
    return WB_OK;
}

/* --- the paper's Fig. 10 --- */

enum wb_status wb_figures_draw_shapes(struct wb_figures_wire *figures,
                                      const struct wb_recordings_results *results,
                                      const struct wb_recordings_results_wire *wire,
                                      struct wb_colour colour)
{
    static const enum wb_figure_marker markers[] = {
        WB_MARKER_CIRCLE, WB_MARKER_SQUARE, WB_MARKER_TRIANGLE, WB_MARKER_DIAMOND, WB_MARKER_RING};
    (void)colour;
    const struct wb_recordings_results_test *test = NULL;
    for (int i = 0; i < wire->calibration_tests.n && !test; i++) {
        if (wire->calibration_tests.items[i].usable &&
            wire->calibration_tests.items[i].dataset.n_shape_rows > 0)
            test = &wire->calibration_tests.items[i];
    }
    if (!test)
        return WB_OK;
    WB_TRY(wb_figures_start(&figures->shapes, results, wire, "shapes", WB_PDF_WIDTH, 300.0));
    figures->shapes_test = test;
    struct wb_panel *const panel = wb_figure_add_panel(figures->shapes);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(panel);
    double end, last_shown = (double)NAN;
    const double largest = wb_figures_turn(&test->dataset, &end);
    for (int i = 0; i < 5; i++) {
        struct wb_figures_frame frame;
        wb_figures_find_frame(&test->dataset, 0.25 * i * largest, &frame);
        if (frame.n < 2 || frame.t == last_shown)
            continue;
        last_shown = frame.t;
        char label[96];
        snprintf(label, sizeof label, "<i>t</i> = %.1f s, <i>\xce\xb4</i> = %.1f mm", frame.t,
                 frame.deflection / WB_MM);
        const struct wb_figure_style style = {.colour = wb_palette_sequence(i, 6),
                                              .width = 0.9,
                                              .marker = markers[i],
                                              .marker_size = 4.4};
        wb_figure_add_line(panel, label, (size_t)frame.n, frame.x, frame.y, &style);
    }
    return WB_OK;
}

/* --- the bench --- */

static const struct wb_recordings_results_test *
any_test(const struct wb_recordings_results *results)
{
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_tests *const both[] = {
            &results->wires[i].calibration_tests, &results->wires[i].validation_tests};
        for (int k = 0; k < 2; k++) {
            for (int j = 0; j < both[k]->n; j++) {
                if (both[k]->items[j].usable && both[k]->items[j].dataset.n_shape_rows > 0)
                    return &both[k]->items[j];
            }
        }
    }
    return NULL;
}

static void add_box(struct wb_panel *panel, double x0, double y0, double x1, double y1,
                    const struct wb_figure_style *style)
{
    const double x[] = {x0, x1, x1, x0, x0}, y[] = {y0, y0, y1, y1, y0};
    wb_figure_add_line(panel, NULL, 5, x, y, style);
}

static void add_arrow(struct wb_panel *panel, double x, double from, double to,
                      const struct wb_figure_style *style)
{
    const double head = from > to ? 3.0 : -3.0;
    const double xs[] = {x, x, x - 1.6, x, x + 1.6};
    const double ys[] = {from, to, to + head, to, to + head};
    wb_figure_add_line(panel, NULL, 5, xs, ys, style);
}

/* Clamp, strand, cell and counterweight around the wire; all lengths in mm. */
static void add_bench(struct wb_panel *panel, const struct wb_recordings_results_test *test,
                      double tip_x, double tip_y)
{
    const struct wb_figure_style solid = {.colour = wb_palette_ink(), .width = 1.2};
    const struct wb_figure_style thin = {.colour = wb_palette_grey(), .width = 0.9};
    const struct wb_figure_style strand = {
        .colour = wb_palette_grey(), .width = 0.9, .dash = WB_DASH_DASHED};
    const double length = test->dataset.info.length / WB_MM;
    add_box(panel, -14.0, -5.0, 0.0, 5.0, &solid);
    add_arrow(panel, -7.0, -8.0, -20.0, &thin);
    char text[160];
    snprintf(text, sizeof text, "clamp on the stage, down at %.3g mm/s",
             test->rig.stage.speed / WB_MM);
    wb_figure_add_text(panel, -3.0, -15.0, -1, text);
    /* The strand's true direction: its upper end is straight above the straight wire's tip. */
    const double strand_mm = test->rig.strand.length / WB_MM;
    const double lean = strand_mm > 0.0 ? (length - tip_x) / strand_mm : 0.0;
    const double top = tip_y + 26.0, top_x = tip_x + 26.0 * lean;
    const double strand_x[] = {tip_x, top_x}, strand_y[] = {tip_y, top};
    wb_figure_add_line(panel, NULL, 2, strand_x, strand_y, &strand);
    add_box(panel, top_x - 7.0, top, top_x + 7.0, top + 8.0, &solid);
    snprintf(text, sizeof text, "load cell, %.3g g, stands still",
             wb_recordings_results_capacity(&test->rig) / WB_G);
    wb_figure_add_text(panel, top_x + 10.0, top + 4.0, -1, text);
    if (strand_mm > 0.0) {
        snprintf(text, sizeof text, "strand of %.4g mm, drawn shortened", strand_mm);
        wb_figure_add_text(panel, top_x + 3.0, tip_y + 15.0, -1, text);
    }
    if (test->rig.strand.counterweight > 0.0) {
        const double line_x[] = {tip_x, tip_x}, line_y[] = {tip_y, tip_y - 9.0};
        wb_figure_add_line(panel, NULL, 2, line_x, line_y, &thin);
        add_box(panel, tip_x - 3.0, tip_y - 16.0, tip_x + 3.0, tip_y - 9.0, &thin);
        snprintf(text, sizeof text, "counterweight, %.3g g", test->rig.strand.counterweight / WB_G);
        wb_figure_add_text(panel, tip_x + 6.0, tip_y - 12.5, -1, text);
    }
}

enum wb_status wb_figures_draw_bench(struct wb_figure **figure,
                                     const struct wb_recordings_results *results)
{
    const struct wb_recordings_results_test *const test = any_test(results);
    if (!test)
        return WB_OK;
    struct wb_figures_frame frame;
    double end;
    wb_figures_find_frame(&test->dataset, wb_figures_turn(&test->dataset, &end), &frame);
    if (frame.n < 2)
        return WB_OK;
    WB_TRY(wb_figures_start(figure, results, NULL, "bench", WB_PDF_WIDTH, 190.0));
    struct wb_panel *const panel = wb_figure_add_panel(*figure);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    const double length = test->dataset.info.length / WB_MM;
    const double straight_x[] = {0.0, length}, straight_y[] = {0.0, 0.0};
    const struct wb_figure_style straight = {
        .colour = wb_palette_grey(), .width = 0.9, .dash = WB_DASH_DOTTED};
    wb_figure_add_line(panel, NULL, 2, straight_x, straight_y, &straight);
    const struct wb_figure_style wire = {
        .colour = wb_palette_wire(0), .width = 1.8, .marker = WB_MARKER_RING, .marker_size = 5.0};
    wb_figure_add_line(panel, NULL, (size_t)frame.n, frame.x, frame.y, &wire);
    wb_figure_add_text(panel, length + 4.0, 0.0, -1, "straight wire");
    char text[96];
    snprintf(text, sizeof text, "wire with %d markers", test->specimen.n_markers);
    wb_figure_add_text(panel, 0.4 * length, 0.45 * frame.y[frame.n - 1], 1, text);
    add_bench(panel, test, frame.x[frame.n - 1], frame.y[frame.n - 1]);
    return WB_OK;
}
