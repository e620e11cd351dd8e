/* Figures of stress fields: the paper's Figs. 3 and 5. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pdf.h"
#include "analysis/report/wires/wires_figures.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "report"

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

/* What is drawn of a field, and how. */
struct drawing {
    enum view view;
    enum quantity quantity;
    bool cells; /* a cross section of a rod */
    struct wb_figure_colours colours;
};

static enum wb_status add_part(struct wb_panel *panel, const struct wb_field *field, int part,
                               const struct drawing *drawing)
{
    struct wb_contour_face *const faces = malloc((2 * (size_t)field->n_faces + 1) * sizeof *faces);
    struct rings rings = {.n = 0};
    int n = 0;
    if (!faces)
        return wb_fail(WB_ERR_MEMORY, "out of memory drawing figures");
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
    return WB_OK;
}

static enum wb_status add_field(struct wb_panel *panel, const struct wb_field *field,
                                const struct drawing *drawing)
{
    WB_TRY(add_part(panel, field, 1, drawing));
    return add_part(panel, field, 0, drawing);
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

static void add_cross_section(struct wb_figure *figure, const struct wb_field *field,
                              struct wb_panel **panel)
{
    char title[80];
    *panel = wb_figure_add_panel(figure);
    wb_figure_set_width(*panel, 104.0);
    wb_figure_hide_axes(*panel);
    wb_figure_set_equal_aspect(*panel);
    snprintf(title, sizeof title, "Section at %.3g mm", field->x / WB_MM);
    wb_figure_set_title(*panel, title);
}

enum wb_status wb_wires_figures_draw_stress(struct wb_figure **figure,
                                            const struct wb_wires_results *results, int index)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_wires_run *const run = wb_wires_usable(results, index, WB_WIRES_SOLID);
    const struct wb_field *const along =
        run ? wb_fields_find(&run->fields, comparison->loaded_state, (double)NAN) : NULL;
    const struct wb_field *const across =
        run ? wb_fields_find(&run->fields, comparison->loaded_state, comparison->section) : NULL;
    if (!along)
        return WB_OK;
    const struct wb_wires_peak peak = wb_wires_find_peak(along, 0);
    const bool elastic = index == WB_WIRES_ELASTIC;
    struct drawing drawing = {.view = FROM_THE_SIDE, .quantity = VON_MISES};
    drawing.colours = colours_of(
        VON_MISES, fmax(largest_of(along, 0, VON_MISES), largest_of(across, 0, VON_MISES)));
    /* A wire that curls up needs more height. */
    const double low = fmin(run->tip[1], 0.0), high = fmax(run->tip[1], 0.0);
    const double height =
        elastic || high - low < 0.35 * comparison->cases[index].model->length ? 150.0 : 215.0;
    WB_TRY(wb_wires_figures_start(figure, elastic ? "stress-elastic" : "stress-elastoplastic",
                                  height));
    struct wb_panel *panel = wb_figure_add_panel(*figure);
    char title[200];
    snprintf(title, sizeof title, "(%c) %s: largest %.0f MPa", elastic ? 'a' : 'b',
             elastic ? "Linear elastic" : "Elastoplastic", peak.stress / WB_MPA);
    wb_figure_set_title(panel, title);
    wb_figure_set_axes(panel, "<i>x</i> (mm)", "<i>y</i> (mm)");
    wb_figure_set_equal_aspect(panel);
    WB_TRY(add_field(panel, along, &drawing));
    ring(panel, peak.position[0] / WB_MM, peak.position[1] / WB_MM);
    if (across) {
        add_cross_section(*figure, across, &panel);
        drawing.view = FROM_THE_CLAMP;
        WB_TRY(add_field(panel, across, &drawing));
    }
    wb_figure_add_colour_bar(*figure, &drawing.colours, "MPa");
    return WB_OK;
}

/* --- Fig. 5a --- */

/* Solid and rod beside each other, with their scale. */
static enum wb_status add_pair(struct wb_figure *figure, const struct wb_field *const fields[2],
                               enum quantity quantity)
{
    static const char *const models[] = {"3D", "1D fibres"};
    struct drawing drawing = {.view = FROM_THE_CLAMP, .quantity = quantity};
    drawing.colours = colours_of(
        quantity, fmax(largest_of(fields[0], 0, quantity), largest_of(fields[1], 0, quantity)));
    for (int i = 0; i < 2; i++) {
        struct wb_panel *const panel = wb_figure_add_panel(figure);
        char title[120];
        wb_figure_hide_axes(panel);
        wb_figure_set_equal_aspect(panel);
        snprintf(title, sizeof title, "%s, %s", quantity == AXIAL ? "Axial" : "von Mises",
                 models[i]);
        wb_figure_set_title(panel, title);
        drawing.cells = i == WB_WIRES_ROD;
        if (fields[i])
            WB_TRY(add_part(panel, fields[i], 0, &drawing));
        else
            wb_figure_add_text(panel, 0.0, 0.0, 0, "missing");
    }
    wb_figure_add_colour_bar(figure, &drawing.colours, "MPa");
    return WB_OK;
}

enum wb_status wb_wires_figures_draw_residual(struct wb_figure **figure,
                                              const struct wb_wires_results *results, int index)
{
    const struct wb_wires *const comparison = results->comparison;
    const struct wb_field *fields[2] = {NULL, NULL};
    char name[40];
    for (int k = 0; k < 2; k++) {
        const struct wb_wires_run *const run =
            wb_wires_usable(results, WB_WIRES_RESIDUAL + index, (enum wb_wires_solver)k);
        if (run)
            fields[k] =
                wb_fields_find(&run->fields, comparison->residual_state, comparison->section);
    }
    if (!fields[0] && !fields[1])
        return WB_OK;
    snprintf(name, sizeof name, "residual-%d", index + 1);
    WB_TRY(wb_wires_figures_start(figure, name, 122.0));
    WB_TRY(add_pair(*figure, fields, AXIAL));
    return add_pair(*figure, fields, VON_MISES);
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

static enum wb_status add_loaded(struct wb_figure *figure, const char *label,
                                 const struct wb_field *field, const struct extent *extent,
                                 const struct wb_figure_colours *colours)
{
    const struct drawing drawing = {
        .view = FROM_THE_SIDE, .quantity = VON_MISES, .colours = *colours};
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    char title[120];
    snprintf(title, sizeof title, "%s: %.0f MPa", label, largest_of(field, 0, VON_MISES));
    wb_figure_set_title(panel, title);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_x_range(panel, extent->low[0], extent->high[0]);
    wb_figure_set_y_range(panel, extent->low[1], extent->high[1]);
    return add_field(panel, field, &drawing);
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
        const struct wb_wires_run *const run = wb_wires_usable(results, index, WB_WIRES_SOLID);
        const struct wb_field *const field =
            run ? wb_fields_find(&run->fields, comparison->loaded_state, (double)NAN) : NULL;
        if (!field)
            continue;
        extend(&loaded->extent, field);
        loaded->largest = fmax(loaded->largest, largest_of(field, 0, VON_MISES));
        loaded->labels[loaded->n] = i == 0 ? "No residual stress" : comparison->cases[index].label;
        loaded->fields[loaded->n++] = field;
    }
}

enum wb_status wb_wires_figures_draw_residual_stress(struct wb_figure **figure,
                                                     const struct wb_wires_results *results)
{
    struct loaded loaded;
    find_loaded(&loaded, results);
    if (loaded.n == 0 || results->comparison->n_residual == 0)
        return WB_OK;
    const struct wb_figure_colours colours = colours_of(VON_MISES, loaded.largest);
    const struct extent *const extent = &loaded.extent;
    const double width = (WB_PDF_WIDTH - 46.0 - 10.0 * loaded.n) / loaded.n;
    const double ratio = (extent->high[1] - extent->low[1]) / (extent->high[0] - extent->low[0]);
    WB_TRY(wb_wires_figures_start(figure, "residual-stress",
                                  fmin(fmax(width * ratio, 60.0), 260.0) + 30.0));
    for (int i = 0; i < loaded.n; i++)
        WB_TRY(add_loaded(*figure, loaded.labels[i], loaded.fields[i], extent, &colours));
    wb_figure_add_colour_bar(*figure, &colours, "MPa");
    return WB_OK;
}
