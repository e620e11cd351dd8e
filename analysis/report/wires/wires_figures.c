#include "analysis/report/wires/wires_figures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pdf.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

static const double full_turn = 180.0 / 3.14159265358979323846; /* degrees of a radian */

enum wb_status wb_wires_figures_start(struct wb_figure **figure, const char *name, double height)
{
    WB_TRY(wb_figure_create(figure, name, WB_PDF_WIDTH, height));
    wb_figure_set_footer(*figure, "simulation, no test");
    return WB_OK;
}

/* --- lines --- */

/* How a model looks in every figure: the solid a broad pale line, the others on it. */
static const struct wb_figure_style solid_style = {.colour = {0.34, 0.71, 0.91, 0.75},
                                                   .width = 3.6};
static const struct wb_figure_style contact_style = {.colour = {0.0, 0.28, 0.45, 1.0},
                                                     .width = 0.9};
static const struct wb_figure_style rod_style = {
    .colour = {0.835, 0.369, 0.0, 1.0}, .width = 1.3, .dash = WB_DASH_DASHED};
static const struct wb_figure_style fitted_style = {
    .colour = {0.114, 0.153, 0.2, 1.0}, .width = 1.2, .dash = WB_DASH_DOTTED};
static const struct wb_figure_style printed_style = {
    .colour = {0.365, 0.408, 0.459, 1.0}, .width = 1.0, .dash = WB_DASH_MIXED};

enum {
    MOST_POINTS = 1024
};

/* The axis of a run from the side, smooth between its points. */
static void add_axis(struct wb_panel *panel, const char *label, const struct wb_wires_run *run,
                     const struct wb_figure_style *style)
{
    double x[MOST_POINTS], y[MOST_POINTS], point[3];
    size_t n = 0;
    if (!run)
        return;
    const int last = (run->n_shape - 1) * 4;
    for (int i = 0; i <= last && n < MOST_POINTS; i++, n++) {
        const int below = i < last ? i / 4 : run->n_shape - 2;
        const double part = 0.25 * (i - 4 * below);
        wb_wires_axis_point(run, run->s[below] + part * (run->s[below + 1] - run->s[below]), point);
        x[n] = point[0] / WB_MM;
        y[n] = point[1] / WB_MM;
    }
    wb_figure_add_line(panel, label, n, x, y, style);
}

static void add_rod_axis(struct wb_panel *panel, const char *label, const struct wb_wires_rod *rod,
                         const struct wb_figure_style *style)
{
    double x[WB_WIRES_POINTS], y[WB_WIRES_POINTS];
    if (!rod->done)
        return;
    for (int i = 0; i < WB_WIRES_POINTS; i++) {
        x[i] = rod->x[i] / WB_MM;
        y[i] = rod->y[i] / WB_MM;
    }
    wb_figure_add_line(panel, label, WB_WIRES_POINTS, x, y, style);
}

static struct wb_panel *add_shape_panel(struct wb_figure *figure, const char *title,
                                        const char *y_label)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", y_label);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_title(panel, title);
    wb_figure_set_width(panel, 290.0);
    return panel;
}

/* --- Fig. 4 --- */

/* Distance from the solid along the wire. */
static void add_distance(struct wb_panel *panel, const struct wb_wires_run *solid,
                         const struct wb_wires_run *run, const struct wb_figure_style *style)
{
    double s[MOST_POINTS], distance[MOST_POINTS];
    size_t n = 0;
    if (!solid || !run)
        return;
    for (int i = 0; i < run->n_shape && n < MOST_POINTS; i++, n++) {
        s[n] = run->s[i] / WB_MM;
        distance[n] = wb_wires_distance_at(solid, run->s[i], run->shape[i]) / WB_MM;
    }
    wb_figure_add_line(panel, NULL, n, s, distance, style);
}

static void add_rod_distance(struct wb_panel *panel, const struct wb_wires_run *solid,
                             const struct wb_wires_rod *rod, const struct wb_figure_style *style)
{
    double s[WB_WIRES_POINTS], distance[WB_WIRES_POINTS];
    if (!solid || !rod->reached)
        return;
    for (int i = 0; i < WB_WIRES_POINTS; i++) {
        const double point[3] = {rod->x[i], rod->y[i], 0.0};
        s[i] = rod->s[i] / WB_MM;
        distance[i] = wb_wires_distance_at(solid, rod->s[i], point) / WB_MM;
    }
    wb_figure_add_line(panel, NULL, WB_WIRES_POINTS, s, distance, style);
}

static struct wb_panel *add_distance_panel(struct wb_figure *figure, const char *title)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_title(panel, title);
    wb_figure_set_axes(panel, "Arc length (mm)", "Distance (mm)");
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    return panel;
}

static enum wb_status draw_elastic_shapes(struct wb_figure **figure,
                                          const struct wb_wires_results *results)
{
    const struct wb_wires_run *const bonded =
        wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const contact =
        wb_wires_usable(results, WB_WIRES_CONTACT, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod = wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_ROD);
    if (!bonded && !contact && !rod)
        return WB_OK;
    WB_TRY(wb_wires_figures_start(figure, "shapes-elastic", 150.0));
    struct wb_panel *panel = add_shape_panel(*figure, "Linear elastic", "<i>y</i> (mm)");
    add_axis(panel, "3D, bonded", bonded, &solid_style);
    add_axis(panel, "3D, friction", contact, &contact_style);
    add_axis(panel, "1D", rod, &rod_style);
    add_rod_axis(panel, "1D, exact", &results->exact, &fitted_style);
    panel = add_distance_panel(*figure, "From the bonded solid");
    add_distance(panel, bonded, contact, &contact_style);
    add_distance(panel, bonded, rod, &rod_style);
    add_rod_distance(panel, bonded, &results->exact, &fitted_style);
    return WB_OK;
}

static enum wb_status draw_shapes(struct wb_figure **figure, const struct wb_wires_results *results)
{
    const struct wb_wires_run *const solid =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_ROD);
    const struct wb_wires_run *const elastic =
        wb_wires_usable(results, WB_WIRES_ELASTIC, WB_WIRES_SOLID);
    const bool fitted = results->fit_state == WB_WIRES_USABLE;
    if (!solid && !rod)
        return WB_OK;
    WB_TRY(wb_wires_figures_start(figure, "shapes-elastoplastic", 170.0));
    struct wb_panel *panel = add_shape_panel(*figure, "Elastoplastic", "<i>y</i> (mm)");
    add_axis(panel, "3D", solid, &solid_style);
    add_axis(panel, "1D fibres", rod, &rod_style);
    if (fitted)
        add_rod_axis(panel, "1D fitted", &results->fitted, &fitted_style);
    add_axis(panel, "3D, linear elastic", elastic, &printed_style);
    panel = add_distance_panel(*figure, "From the solid");
    add_distance(panel, solid, rod, &rod_style);
    if (fitted)
        add_rod_distance(panel, solid, &results->fitted, &fitted_style);
    return WB_OK;
}

/* --- force against deflection and angle --- */

static void add_rows(struct wb_panel *panels[2], const char *label, const struct wb_wires_run *run,
                     const struct wb_figure_style *style)
{
    double force[MOST_POINTS], deflection[MOST_POINTS], angle[MOST_POINTS];
    size_t n = 0;
    if (!run)
        return;
    for (size_t i = 0; i < run->dataset.n_rows && n < MOST_POINTS; i++, n++) {
        force[n] = run->dataset.rows[i].force;
        deflection[n] = run->dataset.rows[i].deflection / WB_MM;
        angle[n] = run->dataset.rows[i].tip_angle * full_turn;
    }
    wb_figure_add_line(panels[0], label, n, deflection, force, style);
    wb_figure_add_line(panels[1], label, n, angle, force, style);
}

static void add_rod_rows(struct wb_panel *panels[2], const char *label,
                         const struct wb_wires_rod *rod, const struct wb_figure_style *style)
{
    double deflection[WB_WIRES_STEPS + 1], angle[WB_WIRES_STEPS + 1];
    if (!rod->done)
        return;
    for (int i = 0; i < rod->n_curve; i++) {
        deflection[i] = rod->deflection[i] / WB_MM;
        angle[i] = rod->angle[i] * full_turn;
    }
    wb_figure_add_line(panels[0], label, (size_t)rod->n_curve, deflection, rod->force, style);
    wb_figure_add_line(panels[1], label, (size_t)rod->n_curve, angle, rod->force, style);
}

static enum wb_status draw_loading(struct wb_figure **figure,
                                   const struct wb_wires_results *results)
{
    const struct wb_wires_run *const solid =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_SOLID);
    const struct wb_wires_run *const rod =
        wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, WB_WIRES_ROD);
    if (!solid && !rod)
        return WB_OK;
    WB_TRY(wb_wires_figures_start(figure, "loading", 200.0));
    struct wb_panel *panels[2];
    for (int i = 0; i < 2; i++)
        panels[i] = wb_figure_add_panel(*figure);
    wb_figure_set_axes(panels[0], "Deflection of the tip (mm)", "Follower force (N)");
    wb_figure_set_axes(panels[1], "Angle of the tip (degrees)", "Follower force (N)");
    add_rows(panels, "3D", solid, &solid_style);
    add_rows(panels, "1D fibres", rod, &rod_style);
    if (results->fit_state == WB_WIRES_USABLE)
        add_rod_rows(panels, "1D fitted", &results->fitted, &fitted_style);
    add_rod_rows(panels, "1D as printed", &results->printed, &printed_style);
    return WB_OK;
}

/* --- shapes with residual stresses --- */

/* By how much a residual stress moves the tip, over the force. */
static void add_effect(struct wb_panel *panel, const struct wb_wires_run *run,
                       const struct wb_wires_run *without, const struct wb_figure_style *style)
{
    double force[MOST_POINTS], distance[MOST_POINTS];
    size_t n = 0;
    if (!run || !without || run == without)
        return;
    for (int i = 0; i < run->n_loading && n < MOST_POINTS; i++, n++) {
        force[n] = run->loading[i];
        distance[n] = wb_wires_tip_distance(run, i, without) / WB_MM;
    }
    wb_figure_add_line(panel, NULL, n, force, distance, style);
}

static bool any_residual(const struct wb_wires_results *results)
{
    bool any = false;
    for (int i = 0; i < results->comparison->n_residual; i++) {
        for (int k = 0; k < WB_WIRES_SOLVERS; k++)
            any |= wb_wires_usable(results, WB_WIRES_RESIDUAL + i, (enum wb_wires_solver)k) != NULL;
    }
    return any;
}

static enum wb_status draw_residual_shapes(struct wb_figure **figure,
                                           const struct wb_wires_results *results)
{
    static const char *const models[] = {"3D", "1D fibres"};
    const struct wb_wires *const comparison = results->comparison;
    if (!any_residual(results))
        return WB_OK;
    WB_TRY(wb_wires_figures_start(figure, "residual-shapes", 190.0));
    struct wb_panel *const side = add_shape_panel(*figure, "From the side", "<i>y</i> (mm)");
    struct wb_panel *const effect = wb_figure_add_panel(*figure);
    wb_figure_set_title(effect, "Effect on the tip");
    wb_figure_set_axes(effect, "Follower force (N)", "Tip moved (mm)");
    wb_figure_set_y_range(effect, 0.0, (double)NAN);
    for (int i = 0; i <= comparison->n_residual; i++) {
        const int index = WB_WIRES_ELASTOPLASTIC + i;
        const struct wb_figure_style styles[] = {
            {.colour = wb_palette_fade(wb_palette_wire(i), 0.4), .width = 3.4},
            {.colour = wb_palette_wire(i), .width = 1.2, .dash = WB_DASH_DASHED}};
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const enum wb_wires_solver solver = (enum wb_wires_solver)k;
            const struct wb_wires_run *const run = wb_wires_usable(results, index, solver);
            char label[100];
            snprintf(label, sizeof label, "%s, %s",
                     i == 0 ? "None" : comparison->cases[index].label, models[k]);
            add_axis(side, label, run, &styles[k]);
            add_effect(effect, run, wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, solver),
                       &styles[k]);
        }
    }
    return WB_OK;
}

/* --- all of them --- */

static enum wb_status draw_all(struct wb_wires_figures *figures,
                               const struct wb_wires_results *results)
{
    WB_TRY(wb_wires_figures_draw_stress(&figures->elastic, results, WB_WIRES_ELASTIC));
    WB_TRY(wb_wires_figures_draw_stress(&figures->elastoplastic, results, WB_WIRES_ELASTOPLASTIC));
    WB_TRY(draw_elastic_shapes(&figures->elastic_shapes, results));
    WB_TRY(draw_shapes(&figures->shapes, results));
    WB_TRY(draw_loading(&figures->loading, results));
    for (int i = 0; i < results->comparison->n_residual; i++)
        WB_TRY(wb_wires_figures_draw_residual(&figures->residual[i], results, i));
    WB_TRY(wb_wires_figures_draw_residual_stress(&figures->residual_stress, results));
    return draw_residual_shapes(&figures->residual_shapes, results);
}

enum wb_status wb_wires_figures_create(struct wb_wires_figures *figures,
                                       const struct wb_wires_results *results)
{
    memset(figures, 0, sizeof *figures);
    const enum wb_status status = draw_all(figures, results);
    if (status != WB_OK)
        wb_wires_figures_release(figures);
    return status;
}

int wb_wires_figures_list(const struct wb_wires_figures *figures,
                          const struct wb_figure *list[WB_WIRES_FIGURES])
{
    const struct wb_figure *all[WB_WIRES_FIGURES];
    int n_all = 0, n = 0;
    all[n_all++] = figures->elastic;
    all[n_all++] = figures->elastic_shapes;
    all[n_all++] = figures->elastoplastic;
    all[n_all++] = figures->shapes;
    all[n_all++] = figures->loading;
    for (int i = 0; i < WB_WIRES_RESIDUALS; i++)
        all[n_all++] = figures->residual[i];
    all[n_all++] = figures->residual_stress;
    all[n_all++] = figures->residual_shapes;
    for (int i = 0; i < n_all; i++) {
        if (all[i])
            list[n++] = all[i];
    }
    return n;
}

void wb_wires_figures_release(struct wb_wires_figures *figures)
{
    wb_figure_destroy(figures->elastic);
    wb_figure_destroy(figures->elastoplastic);
    wb_figure_destroy(figures->elastic_shapes);
    wb_figure_destroy(figures->shapes);
    wb_figure_destroy(figures->loading);
    for (int i = 0; i < WB_WIRES_RESIDUALS; i++)
        wb_figure_destroy(figures->residual[i]);
    wb_figure_destroy(figures->residual_stress);
    wb_figure_destroy(figures->residual_shapes);
    memset(figures, 0, sizeof *figures);
}
