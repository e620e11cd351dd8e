#include "analysis/report/bench/recordings_figures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/report/bench/recordings_draw.h"
#include "analysis/report/draw/figures_compared.h"
#include "analysis/report/draw/figures_cycle.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"

enum {
    MOST_FACES = WB_VALLEY_NODES * WB_VALLEY_NODES / 4,
    MOST_ROWS = 24, /* of the samples' EI, with the two of the mean */
    BANDS = 5       /* stretches of curvature where the cloud is a band */
};

static const char deflection_axis[] = "Deflection <i>\xce\xb4</i> (mm)";

/* What an item is of; NULL: there is no such calibration. */
static const struct wb_recordings_cycle *cycle_of(const struct wb_figures_item *item)
{
    return wb_recordings_results_cycle(wb_recordings_draw_wire(item));
}

static const char *measured_of(const struct wb_figures_item *item)
{
    return wb_recordings_draw_measured(item->results);
}

/* Columns of numbers to draw. */
static double *columns_of(int n_columns, int n)
{
    return wb_memory_new((size_t)n_columns * (size_t)n, sizeof(double));
}

/* --- both ways --- */

static int panels_of(const struct wb_recordings_cycle *cycle)
{
    const int n = cycle->calibration.n_members;
    return n < WB_FIGURES_CYCLE_MOST ? n : WB_FIGURES_CYCLE_MOST;
}

enum wb_status wb_recordings_cycle_figures_ways(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle)
        return WB_OK;
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    WB_TRY(wb_recordings_draw_start(item, "ways", WB_PDF_WIDTH, 200.0));
    wb_text_append(
        &item->caption,
        "First loading and unloading, %s, and the beam with the chosen law (%s), each "
        "sample with its own fit; every third reading is drawn. Tension of the strand as read, "
        "weights included.",
        measured_of(item), wb_candidate_name(c->chosen));
    if (c->n_members > WB_FIGURES_CYCLE_MOST)
        wb_text_append(&item->caption, " The first %d of %d specimens.", WB_FIGURES_CYCLE_MOST,
                       c->n_members);
    wb_figures_cycle_add_panels(item->figure, c, wb_palette_wire(item->index));
    return WB_OK;
}

/* Points that count for less than half in the fit: farther off than 5 standard deviations. */
static double outlier_limit(const struct wb_cycle_member *member, const struct wb_cycle_fit *fit)
{
    struct wb_cycle_fit_settings settings;
    wb_cycle_fit_default_settings(&settings);
    const double noise = fmax(settings.force_noise, settings.force_share * member->data.max_force);
    return 5.0 * fmax(noise, fit->misfit * member->data.max_force);
}

static void add_residuals(struct wb_panel *panel, const struct wb_cycle_member *member,
                          const struct wb_cycle_fit *fit, struct wb_colour colour)
{
    const int most = member->data.n_points;
    double *const x = columns_of(3, most), *const measured = x + most;
    double *const computed = x + 2 * most;
    struct wb_figures_points points = {0}, off = {0};
    const struct wb_figure_style ways[2] = {
        {.colour = colour, .width = 0.9, .marker = WB_MARKER_CIRCLE, .marker_size = 2.2},
        {.colour = colour, .width = 0.7, .marker = WB_MARKER_RING, .marker_size = 2.6}};
    const struct wb_figure_style outliers = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_DIAMOND, .marker_size = 5.0};
    const double limit = outlier_limit(member, fit) / WB_MN;
    const double percent = 100.0 * WB_MN / member->data.max_force;
    for (int k = 0; k < 2; k++) {
        const int n = wb_figures_cycle_points(member, fit, k == 1, x, measured, computed);
        for (int i = 0; i < n; i++) {
            const double residual = computed[i] - measured[i];
            wb_figures_add_point(&points, x[i], percent * residual);
            if (fabs(residual) > limit)
                wb_figures_add_point(&off, x[i], percent * residual);
        }
        wb_figures_put_points(panel, NULL, &points, &ways[k]);
    }
    wb_figures_put_points(panel, "outliers", &off, &outliers);
    free(x);
}

/* The largest residual of any sample, % of F_max: all panels have the same scale. */
static double largest_residual(const struct wb_recordings_cycle *cycle)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    double largest = 0.0;
    for (int i = 0; i < panels_of(cycle); i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        const struct wb_cycle_fit *const fit = &member->answers[c->chosen].fit;
        for (int k = 0; k < member->data.n_points; k++)
            largest = fmax(largest, fabs(fit->tension[k] - member->data.points[k].tension) /
                                        member->data.max_force);
    }
    return 100.0 * largest;
}

/* The next of 1, 2, 5 times a power of ten: axes that end there carry numbers at both ends. */
static double round_end(double value)
{
    const double power = pow(10.0, floor(log10(fmax(value, 1e-6))));
    const double part = value / power;
    return power * (part <= 1.0 ? 1.0 : part <= 2.0 ? 2.0 : part <= 5.0 ? 5.0 : 10.0);
}

enum wb_status wb_recordings_cycle_figures_residuals(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle)
        return WB_OK;
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const double end = round_end(largest_residual(cycle));
    WB_TRY(wb_recordings_draw_start(item, "residuals", WB_PDF_WIDTH, 135.0));
    wb_text_append(&item->caption,
                   "Computed less measured tension of the same specimens (dots: loading, rings: "
                   "unloading). Points that the fit counts for less than half are marked as "
                   "outliers.");
    for (int i = 0; i < panels_of(cycle); i++) {
        const struct wb_cycle_member *const member = &c->members[i];
        struct wb_panel *const panel = wb_figure_add_panel(item->figure);
        wb_figure_set_axes(panel, deflection_axis, i == 0 ? "% of <i>F</i><sub>max</sub>" : "");
        wb_figure_set_y_range(panel, -end, end);
        add_residuals(panel, member, &member->answers[c->chosen].fit, wb_palette_wire(item->index));
    }
    return WB_OK;
}

/* --- later cycles --- */

static void add_later(struct wb_figure *figure, const struct wb_cycle_later *later,
                      double max_force)
{
    double *const x = columns_of(3, later->n), *const measured = x + later->n;
    double *const computed = x + 2 * later->n;
    struct wb_figures_compared to;
    wb_figures_compared_start(&to, figure, "Tension (mN)", max_force);
    for (int cycle = 2; cycle <= later->n_cycles; cycle++) {
        int n = 0;
        for (int i = 0; i < later->n; i++) {
            const struct wb_cycle_later_point *const p = &later->points[i];
            if (p->cycle != cycle)
                continue;
            x[n] = p->deflection / WB_MM;
            measured[n] = p->measured / WB_MN;
            computed[n++] = p->computed / WB_MN;
        }
        char label[40];
        snprintf(label, sizeof label, "cycle %d", cycle);
        wb_figures_compared_add(&to, label, cycle == later->n_cycles ? "predicted" : NULL, n, x,
                                measured, computed, wb_palette_sequence(cycle - 2, later->n_cycles),
                                cycle % 2 != 0);
    }
    free(x);
}

static double max_force_of(const struct wb_cycle_calibration *c, int sample)
{
    for (int i = 0; i < c->n_members; i++) {
        if (c->members[i].sample == sample)
            return c->members[i].data.max_force;
    }
    return (double)NAN;
}

enum wb_status wb_recordings_cycle_figures_later(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle || cycle->later.n == 0)
        return WB_OK;
    const struct wb_cycle_later *const later = &cycle->later;
    WB_TRY(wb_recordings_draw_start(item, "later", WB_PDF_WIDTH, 165.0));
    if (later->n_cycles > 2)
        wb_text_append(&item->caption, "Cycles 2 to %d", later->n_cycles);
    else
        wb_text_append(&item->caption, "Cycle 2");
    wb_text_append(&item->caption,
                   " of sample %d, %s, and what the law predicts that was fitted to the first one "
                   "alone: RMS %.2f %% of <i>F</i><sub>max</sub>, energy lost in a cycle %.2f mJ "
                   "measured, %.2f mJ predicted. Right: computed less measured.",
                   later->sample, measured_of(item), 100.0 * later->rms,
                   later->measured_energy / WB_MJ, later->computed_energy / WB_MJ);
    add_later(item->figure, later, max_force_of(&cycle->calibration, later->sample));
    return WB_OK;
}

/* --- the other length --- */

enum wb_status wb_recordings_cycle_figures_prediction(struct wb_figures_item *item)
{
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    const struct wb_validate_result *const result = wb_recordings_results_prediction(wire);
    if (!result)
        return WB_OK;
    const struct wb_recordings *const campaign =
        ((const struct wb_recordings_results *)item->results)->campaign;
    WB_TRY(wb_recordings_draw_start(item, "prediction", WB_PDF_WIDTH, 165.0));
    wb_text_append(&item->caption,
                   "First loading and unloading at %g mm, mean of the specimens, %s, and what the "
                   "law of the %g mm specimens (%s) predicts of them: RMS %.2f %% of "
                   "<i>F</i><sub>max</sub> = %.1f mN on loading",
                   campaign->length[WB_RECORDINGS_VALIDATION] / WB_MM, measured_of(item),
                   campaign->length[WB_RECORDINGS_CALIBRATION] / WB_MM,
                   wb_candidate_name(wire->cycle.calibration.chosen),
                   100.0 * result->elastoplastic.rms, result->curve.max_force / WB_MN);
    if (result->cycles.n_samples > 0)
        wb_text_append(&item->caption, ", %.2f %% on unloading", 100.0 * result->cycles.rms);
    wb_text_append(&item->caption,
                   ". Forces less that at zero deflection; right: computed less measured.");
    wb_figures_compared_prediction(item->figure, result, wb_palette_wire(item->index));
    return WB_OK;
}

/* --- EI of the samples --- */

/* The range of a sample's EI over the laws that count. */
static void range_of(const struct wb_cycle_calibration *c, const struct wb_cycle_member *member,
                     double range[2])
{
    range[0] = range[1] = member->answers[c->chosen].value[WB_CYCLE_RIGIDITY] / WB_NMM2;
    for (int i = 0; i < c->n_ranked; i++) {
        const struct wb_cycle_answer *const answer = &member->answers[c->ranked[i].candidate];
        if (!c->ranked[i].counts || !answer->is_fitted)
            continue;
        range[0] = fmin(range[0], answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2);
        range[1] = fmax(range[1], answer->value[WB_CYCLE_RIGIDITY] / WB_NMM2);
    }
}

/* Ends at round numbers, so that at least these carry one. */
static void set_round_range(struct wb_panel *panel, double low, double high)
{
    const double span = fmax(high - low, 1e-3 * high);
    const double step = round_end(0.5 * span);
    wb_figure_set_x_range(panel, fmax(0.0, step * floor((low - 0.02 * span) / step)),
                          step * ceil((high + 0.02 * span) / step));
}

/* Values with their ranges (N mm2), each in a row; the first stands at the bottom. */
struct forest {
    struct wb_panel *panel;
    int n;
    char names[MOST_ROWS][32];
    double low, high; /* of all */
};

/* `value` NaN: only the range is drawn; a range that is not known is not drawn. */
static void add_tree(struct forest *forest, double value, const double range[2],
                     const struct wb_figure_style *dot, struct wb_colour colour, double width)
{
    const double y = forest->n++, ys[2] = {y, y};
    const struct wb_figure_style line = {.colour = colour, .width = width};
    /* NaN is neither end. */
    forest->low = fmin(forest->low, fmin(value, range[0]));
    forest->high = fmax(forest->high, fmax(value, range[1]));
    if (isfinite(range[0]))
        wb_figure_add_line(forest->panel, NULL, 2, range, ys, &line);
    if (isfinite(value))
        wb_figure_add_line(forest->panel, NULL, 1, &value, &y, dot);
}

/* From the bottom up: the range over laws, the mean unless no law fits the data, then the
 * samples from the last on. */
static void plant(struct forest *forest, const struct wb_recordings_cycle *cycle,
                  struct wb_colour colour)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const struct wb_estimate *const EI = &c->rigidity;
    const struct wb_figure_style dot = {
        .colour = colour, .marker = WB_MARKER_CIRCLE, .marker_size = 5.0};
    const struct wb_figure_style mean = {
        .colour = wb_palette_ink(), .marker = WB_MARKER_DIAMOND, .marker_size = 6.5};
    const double over_laws[2] = {EI->candidates_low / WB_NMM2, EI->candidates_high / WB_NMM2};
    const double interval[2] = {EI->low / WB_NMM2, EI->high / WB_NMM2};
    snprintf(forest->names[0], sizeof forest->names[0], "over laws");
    add_tree(forest, (double)NAN, over_laws, &dot, wb_palette_grey(), 1.0);
    if (!wb_recordings_cycle_is_refuted(cycle)) {
        snprintf(forest->names[1], sizeof forest->names[1], "mean");
        add_tree(forest, EI->value / WB_NMM2, interval, &mean, wb_palette_ink(), 1.4);
    }
    const int most = MOST_ROWS - forest->n;
    for (int i = (c->n_members < most ? c->n_members : most) - 1; i >= 0; i--) {
        const struct wb_cycle_member *const member = &c->members[i];
        double range[2];
        range_of(c, member, range);
        snprintf(forest->names[forest->n], sizeof forest->names[0], "sample %d", member->sample);
        add_tree(forest, member->answers[c->chosen].value[WB_CYCLE_RIGIDITY] / WB_NMM2, range, &dot,
                 wb_palette_grey(), 1.0);
    }
}

enum wb_status wb_recordings_cycle_figures_forest(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "forest", WB_PDF_HALF_WIDTH, 200.0));
    wb_text_append(
        &item->caption,
        "<i>EI</i> of each specimen, %s: dots of the chosen law, lines over the laws in "
        "range. Below them %sthe range of the mean over the laws.",
        measured_of(item),
        wb_recordings_cycle_is_refuted(cycle) ? "" : "the mean with its interval of 95 %, and ");
    struct forest forest = {.panel = wb_figure_add_panel(item->figure), .low = (double)INFINITY};
    const char *names[MOST_ROWS];
    wb_figure_set_axes(forest.panel, "<i>EI</i> (N mm\xc2\xb2)", "");
    plant(&forest, cycle, wb_palette_wire(item->index));
    for (int i = 0; i < forest.n; i++)
        names[i] = forest.names[i];
    set_round_range(forest.panel, forest.low, forest.high);
    wb_figure_set_y_names(forest.panel, forest.n, names);
    wb_figure_set_y_range(forest.panel, -0.6, forest.n - 0.4);
    return WB_OK;
}

/* --- M(kappa) --- */

/* Where the wire is bent too little for its shape to say how much, the cloud is a band: the range
 * of the moments over curvature, from the first loadings of all samples. */
static void add_cloud_band(struct wb_panel *panel, const struct wb_recordings_cycle *cycle)
{
    double low[BANDS], high[BANDS], x[BANDS], end = 0.0;
    const double *const edges[2] = {low, high};
    struct wb_figures_points points = {0};
    int n = 0;
    for (int i = 0; i < cycle->calibration.n_members; i++) {
        for (int k = 0; k < cycle->clouds[i].n; k++) {
            const struct wb_moment_point *const point = &cycle->clouds[i].points[k];
            if (point->is_unloading || !point->is_band || !(point->curvature > 0.0))
                continue;
            wb_figures_add_point(&points, point->curvature, point->moment / WB_NMM);
            end = fmax(end, point->curvature);
        }
    }
    for (int k = 0; k < BANDS; k++) {
        low[k] = high[k] = (double)NAN;
        for (size_t i = 0; i < points.n; i++) {
            if ((int)fmin(BANDS - 1, BANDS * points.x[i] / end) != k)
                continue;
            low[k] = fmin(low[k], points.y[i]);
            high[k] = fmax(high[k], points.y[i]);
        }
        if (!(high[k] > low[k]))
            continue;
        x[n] = (k + 0.5) * end / BANDS;
        low[n] = low[k];
        high[n++] = high[k];
    }
    wb_figures_release_points(&points);
    if (n > 1)
        wb_figure_add_band(panel, NULL, (size_t)n, x, edges,
                           wb_palette_fade(wb_palette_grey(), 0.35));
}

/* The measured cloud: moments from shapes and tension alone, loading only, from where they mean
 * something. */
static void add_cloud(struct wb_panel *panel, const struct wb_recordings_cycle *cycle)
{
    bool is_named = false;
    for (int i = 0; i < cycle->calibration.n_members; i++) {
        const struct wb_moment_cloud *const cloud = &cycle->clouds[i];
        struct wb_figures_points points = {0};
        for (int k = 0; k < cloud->n; k++) {
            const struct wb_moment_point *const point = &cloud->points[k];
            if (!point->is_unloading && !point->is_band)
                wb_figures_add_point(&points, point->curvature, point->moment / WB_NMM);
        }
        const struct wb_figure_style dots = {.colour = wb_palette_fade(wb_palette_grey(), 0.75),
                                             .marker = WB_MARKER_CIRCLE,
                                             .marker_size = 2.4};
        const char *const label = is_named ? NULL : "shape and tension";
        is_named |= points.n > 0;
        wb_figures_put_points(panel, label, &points, &dots);
    }
}

/* The law's line, and its band where there is one. A law that does not follow the data has a broken
 * line and no band: the specimens' scatter is not what it is uncertain by. */
static void add_law(struct wb_panel *panel, const char *label, const char *band_label,
                    const struct wb_recordings_cycle *cycle, struct wb_colour colour)
{
    const struct wb_recordings_cycle_curve *const curve = &cycle->curve;
    const bool is_refuted = wb_recordings_cycle_is_refuted(cycle);
    const int n = WB_RECORDINGS_CYCLE_CURVE;
    double *const moment = wb_figures_scaled(curve->moment, n, WB_NMM);
    double *const low = wb_figures_scaled(curve->low, n, WB_NMM);
    double *const high = wb_figures_scaled(curve->high, n, WB_NMM);
    const double *const edges[2] = {low, high};
    const struct wb_figure_style line = {
        .colour = colour, .width = 1.6, .dash = is_refuted ? WB_DASH_DASHED : WB_DASH_SOLID};
    if (isfinite(curve->low[n - 1]) && !is_refuted)
        wb_figure_add_band(panel, band_label, (size_t)n, curve->curvature, edges,
                           wb_palette_fade(colour, 0.22));
    wb_figure_add_line(panel, label, (size_t)n, curve->curvature, moment, &line);
    free(moment);
    free(low);
    free(high);
}

static const char broken_line[] =
    " Broken line: the best law where none follows the data; it has no interval.";

static struct wb_panel *add_moment_panel(struct wb_figure *figure)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_axes(panel, "Curvature <i>\xce\xba</i> (1/m)", "Moment <i>M</i> (N mm)");
    return panel;
}

/* Where a wire comes to rest, if the law knows. */
static void add_rest(struct wb_panel *panel, const char *label,
                     const struct wb_recordings_cycle *cycle, struct wb_colour colour)
{
    const struct wb_cycle_calibration *const c = &cycle->calibration;
    const double rest = c->residual_curvature_ratio.value * c->largest_curvature, zero = 0.0;
    const struct wb_figure_style at_rest = {
        .colour = colour, .marker = WB_MARKER_TRIANGLE, .marker_size = 6.0};
    if (c->has_unloading && c->is_followed)
        wb_figure_add_line(panel, label, 1, &rest, &zero, &at_rest);
}

enum wb_status wb_recordings_cycle_figures_moments(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle)
        return WB_OK;
    WB_TRY(wb_recordings_draw_start(item, "moments", WB_PDF_HALF_WIDTH, 200.0));
    wb_text_append(
        &item->caption,
        "Moment over curvature of the chosen law with the interval of its mean (95 %%), "
        "and the residual curvature after unloading from its end. Dots: from "
        "shapes and tension, %s, without any law; they are no data of the fit. Grey: range "
        "of the same where the wire is bent too little to see how much.",
        measured_of(item));
    if (wb_recordings_cycle_is_refuted(cycle))
        wb_text_append(&item->caption, "%s", broken_line);
    struct wb_panel *const panel = add_moment_panel(item->figure);
    add_cloud_band(panel, cycle);
    add_cloud(panel, cycle);
    add_law(panel, "law", "95 %", cycle, wb_palette_wire(item->index));
    add_rest(panel, "unloaded", cycle, wb_palette_ink());
    return WB_OK;
}

enum wb_status wb_recordings_cycle_figures_all_moments(struct wb_figures_item *item)
{
    const struct wb_recordings_results *const results = item->results;
    struct wb_panel *panel = NULL;
    bool any_refuted = false;
    for (int i = 0; i < results->n_wires; i++) {
        const struct wb_recordings_results_wire *const wire = &results->wires[i];
        const struct wb_recordings_cycle *const cycle = wb_recordings_results_cycle(wire);
        if (!cycle)
            continue;
        if (!panel) {
            WB_TRY(wb_recordings_draw_start(item, "moments", WB_PDF_WIDTH, 132.0));
            wb_text_append(&item->caption,
                           "Moment over curvature of the first loading, by the chosen laws, with "
                           "the interval of the mean of the specimens (95 %%). Triangles: the "
                           "residual curvature after unloading from the end of the curve.");
            panel = add_moment_panel(item->figure);
        }
        add_law(panel, wire->wanted->markup, NULL, cycle, wb_palette_wire(i));
        add_rest(panel, NULL, cycle, wb_palette_wire(i));
        any_refuted |= wb_recordings_cycle_is_refuted(cycle);
    }
    if (any_refuted)
        wb_text_append(&item->caption, "%s", broken_line);
    return WB_OK;
}

/* --- K and n --- */

/* Faces of 8 nodes over n and the stress that hardening adds; values are misfits over the smallest.
 */
static int make_faces(const struct wb_cycle_valley *valley, struct wb_contour_face *faces)
{
    static const int at[8][2] = {{0, 0}, {0, 2}, {2, 2}, {2, 0}, {0, 1}, {1, 2}, {2, 1}, {1, 0}};
    int n = 0;
    for (int i = 0; i + 2 < WB_VALLEY_NODES; i += 2) {
        for (int k = 0; k + 2 < WB_VALLEY_NODES; k += 2) {
            struct wb_contour_face *const face = &faces[n++];
            for (int j = 0; j < 8; j++) {
                const struct wb_cycle_valley_node *const node =
                    &valley->nodes[i + at[j][0]][k + at[j][1]];
                face->x[j] = node->exponent;
                face->y[j] = node->stress / WB_MPA;
                face->value[j] = node->misfit / valley->best_misfit;
            }
        }
    }
    return n;
}

/* The line around what the data cannot tell apart, values up to the limit; it closes along the edge
 * of the faces. Over n as K or as the stress that hardening adds. */
static enum wb_status add_region(struct wb_panel *panel, const struct wb_cycle_valley *valley,
                                 bool is_stress, const char *label)
{
    struct wb_contour_face faces[MOST_FACES];
    const int n_faces = make_faces(valley, faces);
    const double limit = valley->limit / valley->best_misfit;
    const struct wb_contour_levels levels = {.low = -3.0 * limit, .high = limit, .n = 2};
    const struct wb_figure_style line = {.colour = wb_palette_ink(), .width = 1.4};
    struct wb_contour contour;
    for (int i = 0; i < n_faces; i++) {
        for (int k = 0; k < 8; k++)
            faces[i].value[k] = -faces[i].value[k];
    }
    WB_TRY(wb_contour_create(&contour, n_faces, faces, &levels));
    for (int i = 0; i < contour.n_loops; i++) {
        const struct wb_contour_loop *const loop = &contour.loops[i];
        struct wb_figures_points points = {0};
        if (loop->level != 1)
            continue;
        for (int k = 0; k <= loop->n; k++) {
            const double *const at = contour.points[loop->first + k % loop->n];
            wb_figures_add_point(&points, at[0],
                                 is_stress ? at[1] : at[1] / pow(WB_BENDING_PLASTIC_STRAIN, at[0]));
        }
        wb_figures_put_points(panel, label, &points, &line);
        label = NULL;
    }
    wb_contour_release(&contour);
    return WB_OK;
}

/* Whether a value lies so near to a region that the region can be seen beside it. */
static bool is_near(double value, double low, double high)
{
    const double reach = 2.0 * (high - low);
    return value > low - reach && value < high + reach;
}

/* K over n: the region, the fit, and where the paper's route ended. */
static enum wb_status add_pairs(struct wb_panel *panel, struct wb_figures_item *item)
{
    const struct wb_recordings_results_wire *const wire = wb_recordings_draw_wire(item);
    const struct wb_cycle_valley *const valley = &wire->cycle.valley;
    wb_figure_set_axes(panel, "Hardening exponent <i>n</i>", "Strength coefficient <i>K</i> (MPa)");
    WB_TRY(add_region(panel, valley, false, "indistinguishable"));
    struct wb_figures_points point = {0};
    const struct wb_figure_style best = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_DIAMOND, .marker_size = 6.0};
    wb_figures_add_point(&point, valley->best.hardening_exponent,
                         valley->best.strength_coefficient / WB_MPA);
    wb_figures_put_points(panel, "best", &point, &best);
    if (!wb_recordings_results_of(wire, WB_RECORDINGS_CALIBRATION))
        return WB_OK;
    const double paper_n = wire->calibration.material.hardening_exponent;
    const double paper_K = wire->calibration.material.strength_coefficient;
    if (is_near(paper_n, valley->exponent_low, valley->exponent_high) &&
        is_near(paper_K, valley->strength_low, valley->strength_high)) {
        const struct wb_figure_style ring = {
            .colour = wb_palette_grey(), .marker = WB_MARKER_RING, .marker_size = 6.0};
        wb_figures_add_point(&point, paper_n, paper_K / WB_MPA);
        wb_figures_put_points(panel, "paper's route, all specimens", &point, &ring);
    } else {
        wb_text_append(&item->caption,
                       " The paper's route, with all specimens, ended far outside, at <i>K</i> = "
                       "%.0f MPa and <i>n</i> = %.3f.",
                       paper_K / WB_MPA, paper_n);
    }
    return WB_OK;
}

/* The misfit over n and the stress that hardening adds, where the valley is not a thin line. */
static enum wb_status add_misfits(struct wb_figure *figure, const struct wb_cycle_valley *valley)
{
    struct wb_contour_face faces[MOST_FACES];
    const int n_faces = make_faces(valley, faces);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    double highest = 1.0;
    for (int i = 0; i < n_faces; i++) {
        for (int k = 0; k < 8; k++)
            highest = faces[i].value[k] > highest ? faces[i].value[k] : highest;
    }
    if (!(highest > 1.0))
        return WB_OK;
    const struct wb_figure_colours colours = {.map = WB_PALETTE_SEQUENTIAL,
                                              .low = 1.0,
                                              .high = highest,
                                              .n = 16,
                                              .outline = WB_OUTLINE_LIGHT};
    wb_figure_set_axes(panel, "Hardening exponent <i>n</i>",
                       "<i>K</i> \xc2\xb7 0.003<sup><i>n</i></sup> (MPa)");
    wb_figure_add_field(panel, n_faces, faces, &colours);
    WB_TRY(add_region(panel, valley, true, NULL));
    const double n = valley->best.hardening_exponent;
    const double stress =
        valley->best.strength_coefficient * pow(WB_BENDING_PLASTIC_STRAIN, n) / WB_MPA;
    const struct wb_figure_style best = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_DIAMOND, .marker_size = 6.0};
    wb_figure_add_line(panel, NULL, 1, &n, &stress, &best);
    wb_figure_add_colour_bar(figure, &colours, "misfit ratio");
    return WB_OK;
}

enum wb_status wb_recordings_cycle_figures_valley(struct wb_figures_item *item)
{
    const struct wb_recordings_cycle *const cycle = cycle_of(item);
    if (!cycle || !cycle->has_valley)
        return WB_OK;
    const struct wb_cycle_valley *const valley = &cycle->valley;
    WB_TRY(wb_recordings_draw_start(item, "valley", WB_PDF_WIDTH, 200.0));
    wb_text_append(
        &item->caption,
        "Ludwik's <i>K</i> and <i>n</i> by the first loading of sample %d alone, %s; at each pair "
        "<i>E</i>, <i>\xcf\x83</i><sub>Y</sub>, bow and level fit best. Within the line, <i>K</i> "
        "from %.0f to %.0f MPa and <i>n</i> from %.3f to %.3f, a pair fits as well as the best "
        "(misfit %.3f %%, limit %.3f %%, <i>F</i>-test of 95 %%). Right: misfit over the smallest; "
        "<i>y</i> is the stress that hardening adds at a plastic strain of 0.003.",
        cycle->calibration.members[0].sample, measured_of(item), valley->strength_low / WB_MPA,
        valley->strength_high / WB_MPA, valley->exponent_low, valley->exponent_high,
        100.0 * valley->best_misfit, 100.0 * valley->limit);
    WB_TRY(add_pairs(wb_figure_add_panel(item->figure), item));
    return add_misfits(item->figure, valley);
}
