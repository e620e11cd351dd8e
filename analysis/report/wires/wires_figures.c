#include "analysis/report/wires/wires_kind.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"

static const double degrees = 180.0 / 3.14159265358979323846; /* degrees of a radian */

/* The follower force at the end, N. */
static double force_of(const struct wb_wires_results *results)
{
    return wb_wires_force(results->comparison->cases[WB_WIRES_ELASTIC].model);
}

/* " (the paper's Fig. N)", or "" of a campaign that has nothing of the paper's. */
static const char *figure_number(char text[48], const struct wb_wires_results *results,
                                 const char *number)
{
    return wb_pages_paper_figure(text, results->comparison->printed_source[0] ? number : "");
}

/* --- lines --- */

/* How a model looks in every figure: the solid a broad pale line, the others on it. */
static const struct wb_figure_style contact_style = {.colour = {0.0, 0.28, 0.45, 1.0},
                                                     .width = 0.9};
static const struct wb_figure_style rod_style = {
    .colour = {0.835, 0.369, 0.0, 1.0}, .width = 1.3, .dash = WB_DASH_DASHED};
static const struct wb_figure_style fitted_style = {
    .colour = WB_PALETTE_INK, .width = 1.2, .dash = WB_DASH_DOTTED};
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

static struct wb_panel *add_shape_panel(struct wb_figure *figure, const char *title)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
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

static enum wb_status draw_elastic_shapes(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    const struct wb_wires_run *const bonded = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const struct wb_wires_run *const contact = wb_wires_solid_run(results, WB_WIRES_CONTACT);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTIC);
    if (!bonded && !contact && !rod)
        return WB_OK;
    WB_TRY(wb_figures_start_simulation(&item->figure, "shapes-elastic", 150.0));
    char in[48];
    wb_text_append(&item->caption,
                   "Simulated shapes of the axis at %g N%s, and how far they lie from that of the "
                   "bonded solid.",
                   force_of(results), figure_number(in, results, "4, linear elastic"));
    struct wb_panel *panel = add_shape_panel(item->figure, "Linear elastic");
    add_axis(panel, "3D, bonded", bonded, &wb_figures_reference_style);
    add_axis(panel, "3D, friction", contact, &contact_style);
    add_axis(panel, "1D", rod, &rod_style);
    add_rod_axis(panel, "1D, exact", &results->exact, &fitted_style);
    panel = add_distance_panel(item->figure, "From the bonded solid");
    add_distance(panel, bonded, contact, &contact_style);
    add_distance(panel, bonded, rod, &rod_style);
    add_rod_distance(panel, bonded, &results->exact, &fitted_style);
    return WB_OK;
}

static enum wb_status draw_shapes(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTOPLASTIC);
    const struct wb_wires_run *const elastic = wb_wires_solid_run(results, WB_WIRES_ELASTIC);
    const bool fitted = results->fit_state == WB_SIMULATION_USABLE;
    if (!solid && !rod)
        return WB_OK;
    WB_TRY(wb_figures_start_simulation(&item->figure, "shapes-elastoplastic", 170.0));
    char in[48];
    wb_text_append(
        &item->caption,
        "Simulated shapes of the axis at %g N%s, and how far they lie from that of the solid. "
        "1D fibres: each material with its own law; 1D fitted: one homogenised material, "
        "fitted to the solid.",
        force_of(results), figure_number(in, results, "4, elastoplastic"));
    struct wb_panel *panel = add_shape_panel(item->figure, "Elastoplastic");
    add_axis(panel, "3D", solid, &wb_figures_reference_style);
    add_axis(panel, "1D fibres", rod, &rod_style);
    if (fitted)
        add_rod_axis(panel, "1D fitted", &results->fitted, &fitted_style);
    add_axis(panel, "3D, linear elastic", elastic, &printed_style);
    panel = add_distance_panel(item->figure, "From the solid");
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
    for (size_t i = 0; i < run->simulation.dataset.n_rows && n < MOST_POINTS; i++, n++) {
        force[n] = run->simulation.dataset.rows[i].force;
        deflection[n] = run->simulation.dataset.rows[i].deflection / WB_MM;
        angle[n] = run->simulation.dataset.rows[i].tip_angle * degrees;
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
        angle[i] = rod->angle[i] * degrees;
    }
    wb_figure_add_line(panels[0], label, (size_t)rod->n_curve, deflection, rod->force, style);
    wb_figure_add_line(panels[1], label, (size_t)rod->n_curve, angle, rod->force, style);
}

static enum wb_status draw_loading(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    const struct wb_wires_run *const solid = wb_wires_solid_run(results, WB_WIRES_ELASTOPLASTIC);
    const struct wb_wires_run *const rod = wb_wires_rod_run(results, WB_WIRES_ELASTOPLASTIC);
    if (!solid && !rod)
        return WB_OK;
    WB_TRY(wb_figures_start_simulation(&item->figure, "loading", 200.0));
    wb_text_append(
        &item->caption, "Follower force against deflection and angle of the tip, simulated.%s",
        results->printed.reached ? " As printed: with the paper's effective properties." : "");
    struct wb_panel *panels[2];
    for (int i = 0; i < 2; i++)
        panels[i] = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panels[0], "Deflection of the tip (mm)", "Follower force (N)");
    wb_figure_set_axes(panels[1], "Angle of the tip (degrees)", "Follower force (N)");
    add_rows(panels, "3D", solid, &wb_figures_reference_style);
    add_rows(panels, "1D fibres", rod, &rod_style);
    if (results->fit_state == WB_SIMULATION_USABLE)
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

static enum wb_status draw_residual_shapes(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    static const char *const models[] = {"3D", "1D fibres"};
    const struct wb_wires *const comparison = results->comparison;
    if (!any_residual(results))
        return WB_OK;
    WB_TRY(wb_figures_start_simulation(&item->figure, "residual-shapes", 190.0));
    wb_text_append(&item->caption,
                   "The same shapes of solid and rod as lines, and how far residual "
                   "stress moves the tip while the force grows.");
    struct wb_panel *const side = add_shape_panel(item->figure, "From the side");
    struct wb_panel *const effect = wb_figure_add_panel(item->figure);
    wb_figure_set_title(effect, "Effect on the tip");
    wb_figure_set_axes(effect, "Follower force (N)", "Tip moved (mm)");
    wb_figure_set_y_range(effect, 0.0, (double)NAN);
    for (int i = 0; i <= comparison->n_residual; i++) {
        const int at = WB_WIRES_ELASTOPLASTIC + i;
        const struct wb_figure_style styles[] = {
            {.colour = wb_palette_fade(wb_palette_wire(i), 0.4), .width = 3.4},
            {.colour = wb_palette_wire(i), .width = 1.2, .dash = WB_DASH_DASHED}};
        for (int k = 0; k < WB_WIRES_SOLVERS; k++) {
            const enum wb_wires_solver solver = (enum wb_wires_solver)k;
            const struct wb_wires_run *const run = wb_wires_usable(results, at, solver);
            char label[100];
            snprintf(label, sizeof label, "%s, %s", i == 0 ? "None" : comparison->cases[at].label,
                     models[k]);
            add_axis(side, label, run, &styles[k]);
            add_effect(effect, run, wb_wires_usable(results, WB_WIRES_ELASTOPLASTIC, solver),
                       &styles[k]);
        }
    }
    return WB_OK;
}

/* --- stress fields: the paper's Figs. 3 and 5 --- */

static const double full_turn = 2.0 * 3.14159265358979323846;
static const double same_radius = 1e-3; /* mm */

enum quantity {
    VON_MISES,
    AXIAL
};

enum view {
    FROM_THE_SIDE, /* deformed: x to the right, y upwards */
    FROM_THE_CLAMP /* on the straight wire: z to the right, y upwards */
};

/* --- fields as faces --- */

static struct wb_contour_face face_of(const struct wb_field_face *from, enum view view,
                                      enum quantity quantity)
{
    struct wb_contour_face face;
    for (int k = 0; k < 8; k++) {
        const struct wb_field_node *const node = &from->node[k];
        face.x[k] = (view == FROM_THE_SIDE ? node->position[0] : node->reference[2]) / WB_MM;
        face.y[k] = (view == FROM_THE_SIDE ? node->position[1] : node->reference[1]) / WB_MM;
        face.value[k] = (quantity == AXIAL ? node->axial : node->von_mises) / WB_MPA;
    }
    return face;
}

/* A rod's cells are parts of rings, and every second ring is turned by half a cell. Halves of them
 * share their nodes with all neighbours, so that they join without a seam. Files keep few digits:
 * radii that are nearly equal, and angles that nearly are parts of a cell, are made so. */
struct rings {
    int n;
    double radius[64];
};

static double snap_radius(struct rings *rings, double radius)
{
    int i = 0;
    while (i < rings->n && fabs(rings->radius[i] - radius) > same_radius)
        i++;
    if (i < rings->n)
        return rings->radius[i];
    if (rings->n < 64)
        rings->radius[rings->n++] = radius;
    return radius;
}

static void halve_cell(const struct wb_contour_face *cell, struct rings *rings,
                       struct wb_contour_face halves[2])
{
    static const double at[8][2] = {{0, 0},   {1, 0},   {1, 1},   {0, 1},
                                    {0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    const double inner = snap_radius(rings, hypot(cell->x[0], cell->y[0]));
    const double outer = snap_radius(rings, hypot(cell->x[1], cell->y[1]));
    const double begin = atan2(cell->y[1], cell->x[1]);
    double turn = atan2(cell->y[2], cell->x[2]) - begin;
    turn -= full_turn * round(turn / full_turn);
    const double n_around = fmax(1.0, round(full_turn / fabs(turn)));
    for (int h = 0; h < 2; h++) {
        for (int k = 0; k < 8; k++) {
            const double r = inner + at[k][0] * (outer - inner);
            const double angle = begin + 0.5 * (h + at[k][1]) * turn;
            const double quarters = round(angle / full_turn * 4.0 * n_around);
            const double same = fmod(quarters + 4.0 * n_around, 4.0 * n_around);
            halves[h].x[k] = r * cos(full_turn * same / (4.0 * n_around));
            halves[h].y[k] = r * sin(full_turn * same / (4.0 * n_around));
            halves[h].value[k] = cell->value[k];
        }
    }
}

/* Quantity that is drawn of a field, with its style. */
struct drawing {
    enum view view;
    enum quantity quantity;
    bool cells; /* a cross section of a rod */
    struct wb_figure_colours colours;
};

static void add_part(struct wb_panel *panel, const struct wb_field *field, int part,
                     const struct drawing *drawing)
{
    struct wb_contour_face *const faces = wb_memory_new(2 * (size_t)field->n_faces, sizeof *faces);
    struct rings rings = {.n = 0};
    int n = 0;
    for (int i = 0; i < field->n_faces; i++) {
        const struct wb_contour_face face =
            face_of(&field->faces[i], drawing->view, drawing->quantity);
        if (field->faces[i].part != part)
            continue;
        if (drawing->cells)
            halve_cell(&face, &rings, &faces[n]);
        else
            faces[n] = face;
        n += drawing->cells ? 2 : 1;
    }
    struct wb_figure_colours colours = drawing->colours;
    /* The core lies within the jacket. */
    colours.outline =
        part == 0 && drawing->view == FROM_THE_SIDE ? WB_OUTLINE_LIGHT : WB_OUTLINE_INK;
    if (n > 0)
        wb_figure_add_field(panel, n, faces, &colours);
    free(faces);
}

static void add_field(struct wb_panel *panel, const struct wb_field *field,
                      const struct drawing *drawing)
{
    add_part(panel, field, 1, drawing);
    add_part(panel, field, 0, drawing);
}

/* --- scales --- */

static double largest_of(const struct wb_field *field, int part, enum quantity quantity)
{
    double largest = 0.0;
    for (int i = 0; field && i < field->n_faces; i++) {
        for (int k = 0; k < 8 && field->faces[i].part == part; k++) {
            const struct wb_field_node *const node = &field->faces[i].node[k];
            largest = fmax(largest, fabs(quantity == AXIAL ? node->axial : node->von_mises));
        }
    }
    return largest / WB_MPA;
}

/* The next number above that reads well at the end of a scale. */
static double round_up(double value)
{
    static const double steps[] = {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0};
    if (!(value > 0.0))
        return 1.0;
    const double power = pow(10.0, floor(log10(value)));
    size_t i = 0;
    while (i + 1 < sizeof steps / sizeof steps[0] && steps[i] * power < value * (1.0 - 1e-9))
        i++;
    return steps[i] * power;
}

static struct wb_figure_colours colours_of(enum quantity quantity, double largest)
{
    const double end = round_up(largest);
    return (struct wb_figure_colours){
        .map = quantity == AXIAL ? WB_PALETTE_DIVERGING : WB_PALETTE_SEQUENTIAL,
        .low = quantity == AXIAL ? -end : 0.0,
        .high = end,
    };
}

/* --- Fig. 3 --- */

static void ring(struct wb_panel *panel, double x, double y)
{
    const struct wb_figure_style style = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_RING, .marker_size = 4.5};
    wb_figure_add_line(panel, NULL, 1, &x, &y, &style);
}

/* A panel without axes. */
static struct wb_panel *add_drawing(struct wb_figure *figure, const char *title)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_title(panel, title);
    return panel;
}

static void append_stress_caption(struct wb_figures_item *item, bool elastic)
{
    char in[48];
    wb_text_append(
        &item->caption,
        elastic ? "Simulated wire of linear elastic materials under a follower force of %g N%s: "
                  "von Mises stress on the longitudinal section as it is deformed, and on a cross "
                  "section, seen from the clamp. Ring: the largest value."
                : "The same wire of elastoplastic materials at %g N%s: von Mises stress, "
                  "simulated. The colours have another scale than the elastic ones.",
        force_of(item->results), figure_number(in, item->results, elastic ? "3a" : "3b"));
}

static enum wb_status draw_stress(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    const struct wb_wires *const comparison = results->comparison;
    const bool elastic = strcmp(item->row->place, "elastic") == 0;
    const int index = elastic ? WB_WIRES_ELASTIC : WB_WIRES_ELASTOPLASTIC;
    const struct wb_wires_run *const run = wb_wires_solid_run(results, index);
    const struct wb_field *const along = wb_wires_field(run, comparison->loaded_state, (double)NAN);
    const struct wb_field *const across =
        wb_wires_field(run, comparison->loaded_state, comparison->section);
    if (!along)
        return WB_OK;
    const struct wb_wires_peak peak = wb_wires_find_peak(along, 0);
    struct drawing drawing = {.view = FROM_THE_SIDE, .quantity = VON_MISES};
    drawing.colours = colours_of(
        VON_MISES, fmax(largest_of(along, 0, VON_MISES), largest_of(across, 0, VON_MISES)));
    /* A wire that curls up needs more height. */
    const bool curls = fabs(run->tip[1]) >= 0.35 * comparison->cases[index].model->length;
    WB_TRY(wb_figures_start_simulation(&item->figure,
                                       elastic ? "stress-elastic" : "stress-elastoplastic",
                                       elastic || !curls ? 150.0 : 215.0));
    append_stress_caption(item, elastic);
    struct wb_panel *panel = wb_figure_add_panel(item->figure);
    char title[200];
    snprintf(title, sizeof title, "%s: largest %.0f MPa",
             elastic ? "(a) Linear elastic" : "(b) Elastoplastic", peak.stress / WB_MPA);
    wb_figure_set_title(panel, title);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(panel);
    add_field(panel, along, &drawing);
    ring(panel, peak.position[0] / WB_MM, peak.position[1] / WB_MM);
    if (across) {
        snprintf(title, sizeof title, "Section at %.3g mm", across->x / WB_MM);
        panel = add_drawing(item->figure, title);
        wb_figure_set_width(panel, 104.0);
        drawing.view = FROM_THE_CLAMP;
        add_field(panel, across, &drawing);
    }
    wb_figure_add_colour_bar(item->figure, &drawing.colours, "MPa");
    return WB_OK;
}

/* --- Fig. 5a --- */

/* Solid and rod beside each other, with their scale. */
static void add_pair(struct wb_figure *figure, const struct wb_field *const fields[2],
                     enum quantity quantity)
{
    static const char *const models[] = {"3D", "1D fibres"};
    struct drawing drawing = {.view = FROM_THE_CLAMP, .quantity = quantity};
    drawing.colours = colours_of(
        quantity, fmax(largest_of(fields[0], 0, quantity), largest_of(fields[1], 0, quantity)));
    for (int i = 0; i < 2; i++) {
        char title[120];
        snprintf(title, sizeof title, "%s, %s", quantity == AXIAL ? "Axial" : "von Mises",
                 models[i]);
        struct wb_panel *const panel = add_drawing(figure, title);
        drawing.cells = i == WB_WIRES_ROD;
        if (fields[i])
            add_part(panel, fields[i], 0, &drawing);
        else
            wb_figure_add_text(panel, 0.0, 0.0, 0, "missing");
    }
    wb_figure_add_colour_bar(figure, &drawing.colours, "MPa");
}

static enum wb_status draw_residual(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    const struct wb_wires *const comparison = results->comparison;
    const int at = WB_WIRES_RESIDUAL + item->index;
    const struct wb_field *const fields[2] = {
        wb_wires_field(wb_wires_solid_run(results, at), comparison->residual_state,
                       comparison->section),
        wb_wires_field(wb_wires_rod_run(results, at), comparison->residual_state,
                       comparison->section)};
    char name[40];
    if (!fields[0] && !fields[1])
        return WB_OK;
    snprintf(name, sizeof name, "residual-%d", item->index + 1);
    WB_TRY(wb_figures_start_simulation(&item->figure, name, 122.0));
    char in[48];
    char label[200];
    wb_text_append(
        &item->caption,
        "%s%s: simulated residual stress in the core near the clamp, seen from it: axial "
        "stress, tension positive, and von Mises stress, of the solid and of the rod's "
        "fibres.",
        wb_pages_escape(label, sizeof label, comparison->cases[at].label),
        figure_number(in, results, "5a"));
    add_pair(item->figure, fields, AXIAL);
    add_pair(item->figure, fields, VON_MISES);
    return WB_OK;
}

static int count_residual(const void *context)
{
    const struct wb_wires_results *const results = context;
    return results->comparison->n_residual;
}

/* --- Fig. 5b --- */

/* The same piece of the plane in all panels. */
struct extent {
    double low[2], high[2];
};

static void extend(struct extent *extent, const struct wb_field *field)
{
    for (int i = 0; i < field->n_faces; i++) {
        for (int k = 0; k < 8; k++) {
            for (int j = 0; j < 2; j++) {
                const double at = field->faces[i].node[k].position[j] / WB_MM;
                extent->low[j] = fmin(extent->low[j], at);
                extent->high[j] = fmax(extent->high[j], at);
            }
        }
    }
}

static void add_loaded(struct wb_figure *figure, const char *label, const struct wb_field *field,
                       const struct extent *extent, const struct wb_figure_colours *colours)
{
    const struct drawing drawing = {
        .view = FROM_THE_SIDE, .quantity = VON_MISES, .colours = *colours};
    char title[120];
    snprintf(title, sizeof title, "%s: %.0f MPa", label, largest_of(field, 0, VON_MISES));
    struct wb_panel *const panel = add_drawing(figure, title);
    wb_figure_set_x_range(panel, extent->low[0], extent->high[0]);
    wb_figure_set_y_range(panel, extent->low[1], extent->high[1]);
    add_field(panel, field, &drawing);
}

/* Longitudinal sections under the force, without and with residual stresses: as many as are
 * readable beside each other. */
struct loaded {
    int n;
    const struct wb_field *fields[3];
    const char *labels[3];
    struct extent extent;
    double largest; /* MPa */
};

static void find_loaded(struct loaded *loaded, const struct wb_wires_results *results)
{
    const struct wb_wires *const comparison = results->comparison;
    *loaded = (struct loaded){.n = 0};
    for (int i = 0; i <= comparison->n_residual && loaded->n < 3; i++) {
        const int index = WB_WIRES_ELASTOPLASTIC + i;
        const struct wb_field *const field = wb_wires_field(wb_wires_solid_run(results, index),
                                                            comparison->loaded_state, (double)NAN);
        if (!field)
            continue;
        extend(&loaded->extent, field);
        loaded->largest = fmax(loaded->largest, largest_of(field, 0, VON_MISES));
        loaded->labels[loaded->n] = i == 0 ? "No residual stress" : comparison->cases[index].label;
        loaded->fields[loaded->n++] = field;
    }
}

static enum wb_status draw_residual_stress(struct wb_figures_item *item)
{
    const struct wb_wires_results *const results = item->results;
    struct loaded loaded;
    find_loaded(&loaded, results);
    if (loaded.n == 0 || results->comparison->n_residual == 0)
        return WB_OK;
    const struct wb_figure_colours colours = colours_of(VON_MISES, loaded.largest);
    const struct extent *const extent = &loaded.extent;
    const double width = (WB_PDF_WIDTH - 46.0 - 10.0 * loaded.n) / loaded.n;
    const double ratio = (extent->high[1] - extent->low[1]) / (extent->high[0] - extent->low[0]);
    WB_TRY(wb_figures_start_simulation(&item->figure, "residual-stress",
                                       fmin(fmax(width * ratio, 60.0), 260.0) + 30.0));
    char in[48];
    wb_text_append(&item->caption,
                   "Von Mises stress at %g N without and with residual stresses%s, simulated: "
                   "longitudinal sections as they are deformed, seen from the side, with the "
                   "largest value of the core.",
                   force_of(results), figure_number(in, results, "5b"));
    for (int i = 0; i < loaded.n; i++)
        add_loaded(item->figure, loaded.labels[i], loaded.fields[i], extent, &colours);
    wb_figure_add_colour_bar(item->figure, &colours, "MPa");
    return WB_OK;
}

/* --- the table --- */

const struct wb_figures_row wb_wires_figures[WB_WIRES_FIGURES] = {
    {"elastic", NULL, draw_stress, false},
    {"elastic-shapes", NULL, draw_elastic_shapes, false},
    {"elastoplastic", NULL, draw_stress, false},
    {"elastoplastic", NULL, draw_shapes, false},
    {"found", NULL, draw_loading, false},
    {"residual", count_residual, draw_residual, false},
    {"residual-effect", NULL, draw_residual_stress, false},
    {"residual-effect", NULL, draw_residual_shapes, false},
};
