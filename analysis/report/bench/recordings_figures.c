#include "analysis/report/bench/recordings_figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/report/bench/recordings_draw.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/units.h"

/* --- what they share --- */

/* Markers of one frame, in the order of the dataset. */
enum {
    MOST_MARKERS = 64
};
struct frame {
    int n;                                   /* 0: there is none */
    double x[MOST_MARKERS], y[MOST_MARKERS]; /* mm */
    double deflection, t;                    /* m, s */
};

/* Deflection in mm and force in mN; with a scale over F_max on the right when it is given. */
static void set_force_axes(struct wb_panel *panel, double max_force)
{
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Force <i>F</i> (mN)");
    if (max_force > 0.0)
        wb_figure_set_right_axis(panel, "<i>F</i> / <i>F</i><sub>max</sub>", WB_MN / max_force);
}

/* A panel of deflection and force, whose scale over F_max is on the right; F_max is in the footer.
 */
static struct wb_panel *add_force_panel(struct wb_figures_item *item, double max_force)
{
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    char footer[160];
    snprintf(footer, sizeof footer, "%s \xc2\xb7 <i>F</i><sub>max</sub> = %.1f mN",
             wb_recordings_draw_measured(item->results), max_force / WB_MN);
    set_force_axes(panel, max_force);
    wb_figure_set_footer(item->figure, footer);
    return panel;
}

static struct wb_panel *add_error_panel(struct wb_figures_item *item)
{
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "Deflection <i>\xce\xb4</i> (mm)", "Error / <i>F</i><sub>max</sub>");
    return panel;
}

/* --- from datasets --- */

double wb_recordings_figures_turn(const struct wb_dataset *dataset, double *t)
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

/* The frame of the first loading that is nearest to a deflection (m). */
static void find_frame(const struct wb_dataset *dataset, double deflection, struct frame *frame)
{
    double end, nearest = (double)INFINITY;
    wb_recordings_figures_turn(dataset, &end);
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
        if (row->t != frame->t || frame->n == MOST_MARKERS)
            continue;
        frame->x[frame->n] = row->x / WB_MM;
        frame->y[frame->n++] = row->y / WB_MM;
    }
}

/* Adds the rows of one cycle (only its loading, or all of it but slack) as a line. Below zero
 * deflection, where no cycle is, the tip lies on its rest. */
static void add_rows(struct wb_panel *panel, const char *label, const struct wb_dataset *dataset,
                     int cycle, bool loading_only, const struct wb_figure_style *style)
{
    struct wb_figures_points line = {0};
    const double longest = wb_dataset_gap(dataset);
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
        wb_figures_add_point(&line, row->deflection / WB_MM,
                             shown && !gap ? row->force / WB_MN : (double)NAN);
        last = row->t;
    }
    wb_figures_put_points(panel, label, &line, style);
}

/* --- the paper's Fig. 9 --- */

/* The recording with the most cycles; NULL without any. */
static const struct wb_recordings_results_test *
most_cycles(const struct wb_recordings_results_wire *wire, int *most)
{
    const struct wb_recordings_results_test *best = NULL;
    *most = 0;
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        const struct wb_recordings_results_tests *const tests = &wire->steps[k].tests;
        for (int i = 0; i < tests->n; i++) {
            const struct wb_recordings_results_test *const test = &tests->items[i];
            if (test->usable && wb_cycle_later_count(&test->dataset) > *most) {
                *most = wb_cycle_later_count(&test->dataset);
                best = test;
            }
        }
    }
    return best;
}

static enum wb_status draw_cycles(struct wb_figures_item *item)
{
    int most;
    const struct wb_recordings_results_test *const best =
        most_cycles(wb_recordings_draw_wire(item), &most);
    if (!best)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "cycles", WB_PDF_HALF_WIDTH, 200.0));
    wb_text_append(&item->caption,
                   "Cycles of sample %d, %g mm, %s; stretches with a slack strand left out.",
                   best->dataset.info.sample, best->dataset.info.length / WB_MM,
                   wb_recordings_draw_measured(item->results));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    set_force_axes(panel, 0.0);
    for (int cycle = 1; cycle <= most; cycle++) {
        char label[40];
        snprintf(label, sizeof label, "cycle %d", cycle);
        /* After the first, cycles lie on each other: each is drawn thinner and darker within the
         * one before, so that all are seen. */
        const struct wb_figure_style style = {
            .colour = wb_palette_sequence(most - cycle, most),
            .width = most > 1 ? 2.8 - 2.2 * (cycle - 1) / (most - 1) : 1.0};
        add_rows(panel, label, &best->dataset, cycle, false, &style);
    }
    return WB_OK;
}

static enum wb_status draw_samples(struct wb_figures_item *item)
{
    static const enum wb_figure_dash dashes[] = {WB_DASH_DASHED, WB_DASH_MIXED, WB_DASH_DOTTED};
    const struct wb_recordings_results *const results = item->results;
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    const struct wb_recordings_results_tests *const tests =
        &wire->steps[WB_RECORDINGS_CALIBRATION].tests;
    const struct wb_validate_result *const fit =
        wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION);
    const struct wb_colour colour = wb_palette_wire(item->index);
    if (!fit)
        return WB_OK;
    const struct wb_curve *const curve = &fit->curve;
    WB_TRY(wb_recordings_draw_start(item, "samples", WB_PDF_HALF_WIDTH, 200.0));
    wb_text_append(&item->caption,
                   "First loading of %d %s, %g mm, %s, with mean and range; "
                   "<i>F</i><sub>max</sub> = %.1f mN.",
                   curve->n_samples, wb_pages_plural(curve->n_samples, "sample", "samples"),
                   results->campaign->length[WB_RECORDINGS_CALIBRATION] / WB_MM,
                   wb_recordings_draw_measured(item->results), curve->max_force / WB_MN);
    struct wb_panel *const panel = add_force_panel(item, curve->max_force);
    char label[64];
    snprintf(label, sizeof label, "range of %d", curve->n_samples);
    wb_figures_add_range(panel, label, curve, colour);
    const struct wb_figure_style mean = {.colour = colour, .width = 1.6};
    for (int i = 0; i < tests->n; i++) {
        const struct wb_dataset *const dataset = &tests->items[i].dataset;
        const int sample = dataset->info.sample;
        if (!tests->items[i].usable)
            continue;
        snprintf(label, sizeof label, "sample %d", sample);
        const struct wb_figure_style style = {
            .colour = wb_palette_sample(sample), .width = 1.0, .dash = dashes[(sample + 2) % 3]};
        add_rows(panel, label, dataset, 1, true, &style);
    }
    wb_figures_add_curve(panel, "mean", curve, curve->force, WB_MN, &mean);
    return WB_OK;
}

/* --- the paper's Fig. 10 --- */

/* The first recording that has shapes; NULL without any. */
static const struct wb_recordings_results_test *
first_with_shapes(const struct wb_recordings_results_tests *tests)
{
    for (int i = 0; i < tests->n; i++) {
        if (tests->items[i].usable && tests->items[i].dataset.n_shape_rows > 0)
            return &tests->items[i];
    }
    return NULL;
}

static enum wb_status draw_shapes(struct wb_figures_item *item)
{
    static const enum wb_figure_marker markers[] = {
        WB_MARKER_CIRCLE, WB_MARKER_SQUARE, WB_MARKER_TRIANGLE, WB_MARKER_DIAMOND, WB_MARKER_RING};
    const struct wb_recordings_results_test *const test =
        first_with_shapes(&wb_recordings_draw_wire(item)->steps[WB_RECORDINGS_CALIBRATION].tests);
    if (!test)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "shapes", WB_PDF_WIDTH, 300.0));
    const struct wb_test_info *const info = &test->dataset.info;
    wb_text_append(&item->caption,
                   "Shapes of sample %d, %g mm, on its first loading, %s: the markers, moved onto "
                   "the wire's axis, in the clamp's frame.",
                   info->sample, info->length / WB_MM, wb_recordings_draw_measured(item->results));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(panel);
    double end, last_shown = (double)NAN;
    const double largest = wb_recordings_figures_turn(&test->dataset, &end);
    for (int i = 0; i < 5; i++) {
        struct frame frame;
        find_frame(&test->dataset, 0.25 * i * largest, &frame);
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
    const struct wb_recordings_results_test *test;
    for (int i = 0; (test = wb_recordings_results_at(results, i, NULL, NULL)); i++) {
        if (test->usable && test->dataset.n_shape_rows > 0)
            return test;
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

static enum wb_status draw_bench(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    const struct wb_recordings_results_test *const test = any_test(results);
    if (!test)
        return WB_OK;
    struct frame frame;
    double end;
    find_frame(&test->dataset, wb_recordings_figures_turn(&test->dataset, &end), &frame);
    if (frame.n < 2)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "bench", WB_PDF_WIDTH, 190.0));
    wb_text_append(&item->caption,
                   "The test, drawn to scale but for the strand: the clamp moves down, the strand "
                   "holds the wire's tip, the load cell above stands still. Markers as %s at the "
                   "largest deflection.",
                   wb_recordings_draw_measured(item->results));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
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

/* --- beside the calibrated beam --- */

#define SHAPE_POINTS 60

/* Measured markers and the computed shape at half and at full deflection. */
static enum wb_status add_shapes(struct wb_panel *inset,
                                 const struct wb_recordings_results_wire *wire,
                                 const struct wb_recordings_results_step *step,
                                 struct wb_colour colour)
{
    const struct wb_recordings_results_test *const test = first_with_shapes(&step->tests);
    const struct wb_validate_result *const result = &step->result;
    const struct wb_dataset *const dataset = test ? &test->dataset : NULL;
    wb_figure_set_axes(inset, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(inset);
    const struct wb_figure_style computed = {.colour = wb_palette_ink(), .width = 0.9};
    const struct wb_figure_style measured = {
        .colour = colour, .marker = WB_MARKER_CIRCLE, .marker_size = 3.4};
    for (int i = 1; i <= 2 && dataset; i++) {
        struct frame frame;
        double line_x[SHAPE_POINTS], line_y[SHAPE_POINTS];
        find_frame(dataset, 0.5 * i * result->curve.max_deflection, &frame);
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
        snprintf(label, sizeof label, "range of %d specimens", curve->n_samples);
    wb_figures_add_range(panel, label, curve, colour);
    snprintf(label, sizeof label, curve->n_samples > 1 ? "measured, mean" : "measured");
    const struct wb_figure_style style = {.colour = colour, .width = 1.6};
    wb_figures_add_curve(panel, label, curve, curve->force, WB_MN, &style);
}

static const struct wb_figure_style computed_style = {
    .colour = WB_PALETTE_INK, .width = 1.2, .dash = WB_DASH_DASHED};

/* Measured curve and calibrated beam of a step, with room above for the inset; F_max in the
 * caption. */
static enum wb_status draw_step(struct wb_figures_item *item, enum wb_recordings_purpose purpose,
                                double room)
{
    static const char *const labels[] = {"computed, calibrated", "computed, elastoplastic"};
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    const struct wb_validate_result *const result = wb_recordings_results_of(wire, purpose);
    const struct wb_colour colour = wb_palette_wire(item->index);
    if (!result)
        return WB_OK;
    wb_text_append(&item->caption, " <i>F</i><sub>max</sub> = %.1f mN.",
                   result->curve.max_force / WB_MN);
    WB_TRY(wb_recordings_draw_start(item, wb_recordings_purposes[purpose], WB_PDF_WIDTH, 208.0));
    struct wb_panel *const panel = add_force_panel(item, result->curve.max_force);
    wb_figure_set_y_range(panel, (double)NAN, room * result->curve.max_force / WB_MN);
    add_measured(panel, &result->curve, colour);
    wb_figures_add_curve(panel, labels[purpose], &result->curve, result->elastoplastic.force, WB_MN,
                         &computed_style);
    const struct wb_figure_style elastic = {
        .colour = wb_palette_grey(), .width = 1.2, .dash = WB_DASH_DOTTED};
    if (purpose == WB_RECORDINGS_VALIDATION)
        wb_figures_add_curve(panel, "computed, linear elastic", &result->curve,
                             result->elastic.force, WB_MN, &elastic);
    return add_shapes(wb_figure_add_inset(panel), wire, &wire->steps[purpose], colour);
}

static enum wb_status draw_calibration(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    wb_text_append(
        &item->caption,
        "Calibration at %g mm: mean of the specimens, %s, and the calibrated beam. Inset: "
        "markers of one specimen and computed shape at half and at full deflection.",
        results->campaign->length[WB_RECORDINGS_CALIBRATION] / WB_MM,
        wb_recordings_draw_measured(item->results));
    return draw_step(item, WB_RECORDINGS_CALIBRATION, 1.25);
}

static enum wb_status draw_validation(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    const double *const length = results->campaign->length;
    wb_text_append(
        &item->caption,
        "Validation at %g mm: mean of the specimens, %s, the beam calibrated at %g mm, and for "
        "contrast the same beam without yielding, which leaves the frame. Inset as before.",
        length[WB_RECORDINGS_VALIDATION] / WB_MM, wb_recordings_draw_measured(item->results),
        length[WB_RECORDINGS_CALIBRATION] / WB_MM);
    /* The elastic curve goes far beyond; it may leave the frame. */
    return draw_step(item, WB_RECORDINGS_VALIDATION, 1.45);
}

static enum wb_status draw_error(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    const struct wb_figure_style styles[] = {
        {.colour = wb_palette_ink(), .width = 1.1, .dash = WB_DASH_DASHED},
        {.colour = wb_palette_wire(item->index), .width = 1.5}};
    if (!wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION))
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "error", WB_PDF_WIDTH, 155.0));
    wb_text_append(
        &item->caption,
        "Error of the computed force against the mean force, %s (eq. 18), as part of "
        "each curve's own <i>F</i><sub>max</sub>, with its RMS (eq. 19); each specimen is "
        "computed with its own bow.",
        wb_recordings_draw_measured(item->results));
    struct wb_panel *const panel = add_error_panel(item);
    for (int k = 0; k < WB_RECORDINGS_PURPOSES; k++) {
        const struct wb_validate_result *const result =
            wb_recordings_results_of(wire, (enum wb_recordings_purpose)k);
        char label[160];
        if (!result)
            continue;
        snprintf(label, sizeof label, "%s, %g mm: RMS %.4f, <i>F</i><sub>max</sub> %.1f mN",
                 wb_recordings_purposes[k], results->campaign->length[k] / WB_MM,
                 result->elastoplastic.rms, result->curve.max_force / WB_MN);
        wb_figures_add_curve(panel, label, &result->curve, result->elastoplastic.error, 1.0,
                             &styles[k]);
    }
    return WB_OK;
}

/* --- the search --- */

static void add_path(struct wb_figure *figure, const struct wb_calibrate_result *result,
                     struct wb_colour colour)
{
    struct wb_figures_points errors = {0}, pairs = {0};
    for (int i = 0; i < result->n_path; i++) {
        wb_figures_add_point(&errors, i + 1, result->path[i].error);
        wb_figures_add_point(&pairs, result->path[i].hardening_exponent,
                             result->path[i].strength_coefficient / WB_MPA);
    }
    struct wb_panel *const left = wb_figure_add_panel(figure);
    wb_figure_set_axes(left, "Iteration",
                       "<i>E</i><sub>L2</sub> / (<i>F</i><sub>max</sub> "
                       "\xce\xb4<sub>max</sub><sup>1/2</sup>)");
    wb_figure_set_logarithmic_y(left);
    const struct wb_figure_style line = {.colour = colour, .width = 1.3};
    wb_figures_put_points(left, NULL, &errors, &line);

    struct wb_panel *const right = wb_figure_add_panel(figure);
    wb_figure_set_axes(right, "Hardening exponent <i>n</i>", "Strength coefficient <i>K</i> (MPa)");
    const struct wb_figure_style thin = {
        .colour = colour, .width = 0.8, .marker = WB_MARKER_CIRCLE, .marker_size = 2.4};
    wb_figures_put_points(right, "best so far", &pairs, &thin);
    const struct wb_figure_style start = {
        .colour = wb_palette_grey(), .marker = WB_MARKER_RING, .marker_size = 6.0};
    wb_figures_add_point(&pairs, result->first_hardening_exponent,
                         result->first_strength_coefficient / WB_MPA);
    wb_figures_put_points(right, "<i>n</i><sub>0</sub>, <i>K</i><sub>0</sub> (eqs. 15, 16)", &pairs,
                          &start);
    const struct wb_figure_style end = {
        .colour = wb_palette_ink(), .marker = WB_MARKER_DIAMOND, .marker_size = 6.0};
    wb_figures_add_point(&pairs, result->material.hardening_exponent,
                         result->material.strength_coefficient / WB_MPA);
    wb_figures_put_points(right, "calibrated", &pairs, &end);
}

static enum wb_status draw_optimiser(struct wb_figures_item *item)
{
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    if (!wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION) || wire->calibration.n_path < 1)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "optimiser", WB_PDF_WIDTH, 170.0));
    wb_text_append(
        &item->caption,
        "Left: error of the best corner of the simplex after each iteration, then of the restart. "
        "Right: its path from the first guess to the calibrated values.");
    add_path(item->figure, &wire->calibration, wb_palette_wire(item->index));
    return WB_OK;
}

/* --- all wires in one --- */

/* Said where the report has another route too. */
static const char *route_of(const struct wb_recordings_results *results)
{
    return results->campaign->whole_cycle ? ", by the paper's route" : "";
}

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
    struct wb_figures_points points = {0};
    for (int i = 0; i < curve->n; i += 10)
        wb_figures_add_point(&points, i * curve->step / WB_MM, curve->force[i] / WB_MN);
    const struct wb_figure_style style = {
        .colour = colour, .marker = markers[index % 4], .marker_size = 4.2};
    wb_figures_put_points(panel, label, &points, &style);
    snprintf(label, sizeof label, "%s, computed", results->wires[index].wanted->label);
    const struct wb_figure_style line = {.colour = colour, .width = 1.3};
    wb_figures_add_curve(panel, label, curve, result->elastoplastic.force, WB_MN, &line);
}

/* Whether the first page shows the curves of that purpose: by the paper's route alone, those of the
 * validation where there is any. */
static bool is_on_first_page(const struct wb_recordings_results *results,
                             enum wb_recordings_purpose purpose)
{
    bool any_validation = false;
    for (int i = 0; i < results->n_wires; i++)
        any_validation |=
            wb_recordings_results_of(&results->wires[i], WB_RECORDINGS_VALIDATION) != NULL;
    return !results->campaign->whole_cycle &&
           (purpose == WB_RECORDINGS_VALIDATION) == any_validation;
}

static enum wb_status draw_all(struct wb_figures_item *item, enum wb_recordings_purpose purpose)
{
    const struct wb_recordings_results *const results = item->results;
    const bool is_first_page = strcmp(item->row->place, "found") == 0;
    struct wb_panel *panel = NULL;
    if (!is_first_page && is_on_first_page(results, purpose))
        return WB_OK;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_validate_result *const result =
            wb_recordings_results_of(&results->wires[i], purpose);
        if (!result)
            continue;
        if (!panel) {
            WB_TRY(wb_recordings_draw_start(item, wb_recordings_purposes[purpose], WB_PDF_WIDTH,
                                            is_first_page ? 160.0 : 205.0));
            panel = wb_figure_add_panel(item->figure);
            set_force_axes(panel, 0.0);
        }
        add_overview(panel, results, i, result);
    }
    return WB_OK;
}

static enum wb_status draw_calibrations(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    wb_text_append(
        &item->caption,
        "Mean force and deflection of the specimens of %g mm, %s, and the beam calibrated "
        "against them%s. Bands: range of the specimens.",
        results->campaign->length[WB_RECORDINGS_CALIBRATION] / WB_MM,
        wb_recordings_draw_measured(item->results), route_of(results));
    return draw_all(item, WB_RECORDINGS_CALIBRATION);
}

static enum wb_status draw_validations(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    const double *const length = results->campaign->length;
    wb_text_append(
        &item->caption,
        "Mean force over deflection of the specimens of %g mm, %s, and the prediction of "
        "the beams calibrated at %g mm%s. Bands: range of the specimens.",
        length[WB_RECORDINGS_VALIDATION] / WB_MM, wb_recordings_draw_measured(item->results),
        length[WB_RECORDINGS_CALIBRATION] / WB_MM, route_of(results));
    return draw_all(item, WB_RECORDINGS_VALIDATION);
}

/* Moments of all wires, or where the campaign has the paper's route alone, forces of all. */
static enum wb_status draw_found(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    if (results->campaign->whole_cycle)
        return wb_recordings_cycle_figures_all_moments(item);
    return is_on_first_page(results, WB_RECORDINGS_VALIDATION) ? draw_validations(item)
                                                               : draw_calibrations(item);
}

static enum wb_status draw_errors(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    static const enum wb_figure_dash dashes[] = {WB_DASH_SOLID, WB_DASH_DASHED, WB_DASH_MIXED,
                                                 WB_DASH_DOTTED};
    struct wb_panel *panel = NULL;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_validate_result *const validation =
            wb_recordings_results_of(wire, WB_RECORDINGS_VALIDATION);
        if (!validation)
            continue;
        if (!panel) {
            WB_TRY(wb_recordings_draw_start(item, "errors", WB_PDF_WIDTH, 165.0));
            panel = add_error_panel(item);
        }
        char label[160];
        snprintf(label, sizeof label, "%s, RMS %.4f, <i>F</i><sub>max</sub> %.1f mN",
                 wire->wanted->label, validation->elastoplastic.rms,
                 validation->curve.max_force / WB_MN);
        const struct wb_figure_style style = {
            .colour = wb_palette_wire(i), .width = 1.3, .dash = dashes[i % 4]};
        wb_figures_add_curve(panel, label, &validation->curve, validation->elastoplastic.error, 1.0,
                             &style);
    }
    wb_text_append(&item->caption,
                   "Error of the prediction at %g mm%s (eq. 18): distance of mean force, %s, and "
                   "computed force over the largest mean force of the wire.",
                   results->campaign->length[WB_RECORDINGS_VALIDATION] / WB_MM, route_of(results),
                   wb_recordings_draw_measured(item->results));
    return WB_OK;
}

/* --- the table --- */

const struct wb_figures_row wb_recordings_figures[WB_RECORDINGS_FIGURES] = {
    {"found", NULL, draw_found, false},
    {"bench", NULL, draw_bench, false},
    {"overview", NULL, draw_calibrations, false},
    {"overview", NULL, draw_validations, false},
    {"overview", NULL, draw_errors, false},
    {"cycle", wb_recordings_draw_count, wb_recordings_cycle_figures_ways, false},
    {"cycle", wb_recordings_draw_count, wb_recordings_cycle_figures_residuals, false},
    {"later", wb_recordings_draw_count, wb_recordings_cycle_figures_later, false},
    {"prediction", wb_recordings_draw_count, wb_recordings_cycle_figures_prediction, false},
    {"law", wb_recordings_draw_count, wb_recordings_cycle_figures_forest, true},
    {"law", wb_recordings_draw_count, wb_recordings_cycle_figures_moments, true},
    {"valley", wb_recordings_draw_count, wb_recordings_cycle_figures_valley, false},
    {"measured", wb_recordings_draw_count, draw_cycles, true},
    {"measured", wb_recordings_draw_count, draw_samples, true},
    {"measured", wb_recordings_draw_count, draw_shapes, false},
    {"compared", wb_recordings_draw_count, draw_calibration, false},
    {"compared", wb_recordings_draw_count, draw_validation, false},
    {"compared", wb_recordings_draw_count, draw_error, false},
    {"search", wb_recordings_draw_count, draw_optimiser, false},
};
