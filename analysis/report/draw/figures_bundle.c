#include "analysis/report/draw/figures_bundle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"
#include "fe/swept/swept_section.h"

#define WB_LOG_DOMAIN "report"

static const double pi = 3.14159265358979323846;

enum {
    CIRCLE = 96,          /* points of one */
    OUTLINE = 720,        /* points of the tape's faces */
    TITLE = 38,           /* bytes of one beside others */
    BONDS = 1440,         /* places looked at for bonds */
    MOST_POINTS = 1 << 15 /* of a series */
};

/* Settings of all panels of a figure: a type of wire has the same colour in all of them. */
struct drawing {
    const char *mesh;
    double reach; /* mm, from the axis of the largest cylinder to its outside */
    double point; /* mm of a point of 1/72 inch */
    int n_types;
    const char *type[WB_FIGURES_BUNDLE_MOST * WB_BUNDLE_MODEL_TYPES];
};

/* A panel with the series that is being made for it. */
struct pen {
    struct wb_panel *panel;
    const struct wb_bundle_model *model;
    size_t n;
    double x[MOST_POINTS], y[MOST_POINTS]; /* mm: z to the right, y up */
};

static void add(struct pen *pen, double x, double y)
{
    if (pen->n == MOST_POINTS)
        return;
    pen->x[pen->n] = x;
    pen->y[pen->n++] = y;
}

static void lift(struct pen *pen)
{
    if (pen->n > 0)
        add(pen, (double)NAN, (double)NAN);
}

static void stroke(struct pen *pen, struct wb_colour colour, double width)
{
    const struct wb_figure_style style = {.colour = colour, .width = width};
    wb_figure_add_line(pen->panel, NULL, pen->n, pen->x, pen->y, &style);
    pen->n = 0;
}

static void fill(struct pen *pen, struct wb_colour colour)
{
    wb_figure_add_area(pen->panel, NULL, pen->n, pen->x, pen->y, colour);
    pen->n = 0;
}

static void add_circle(struct pen *pen, double x, double y, double radius)
{
    lift(pen);
    for (int i = 0; i <= CIRCLE; i++) {
        const double angle = 2.0 * pi * i / CIRCLE;
        add(pen, x + radius * cos(angle), y + radius * sin(angle));
    }
}

/* --- colours --- */

/* Between a colour and white. */
static struct wb_colour paler(struct wb_colour colour, double part)
{
    colour.red += part * (1.0 - colour.red);
    colour.green += part * (1.0 - colour.green);
    colour.blue += part * (1.0 - colour.blue);
    return colour;
}

static struct wb_colour darker(struct wb_colour colour, double part)
{
    colour.red *= 1.0 - part;
    colour.green *= 1.0 - part;
    colour.blue *= 1.0 - part;
    return colour;
}

static const struct wb_colour void_colour = {0.955, 0.962, 0.97, 1.0};
static const struct wb_colour tape_colour = {0.27, 0.30, 0.34, 1.0};

static struct wb_colour type_colour(const struct drawing *drawing, const char *name)
{
    int i = 0;
    while (i < drawing->n_types - 1 && strcmp(drawing->type[i], name) != 0)
        i++;
    return wb_palette_wire(i);
}

static void take_types(struct drawing *drawing, const struct wb_bundle_model *model)
{
    for (int i = 0; i < model->n_types; i++) {
        int k = 0;
        while (k < drawing->n_types && strcmp(drawing->type[k], model->type[i].name) != 0)
            k++;
        if (k == drawing->n_types)
            drawing->type[drawing->n_types++] = model->type[i].name;
    }
}

/* --- wires --- */

/* The lines of a section's quadrilaterals, each once. */
static void add_edges(struct pen *pen, const struct wb_swept_section *section,
                      const struct wb_packing_circle *wire)
{
    for (int q = 0; q < section->n_quads; q++) {
        for (int a = 0; a < 4; a++) {
            const int from = section->quad[q][a], to = section->quad[q][(a + 1) % 4];
            const double *const p = section->node[from], *const r = section->node[to];
            /* A line inside is met from both sides, one of the outline from one: outlines are drawn
             * on their own. */
            if (from > to)
                continue;
            lift(pen);
            add(pen, (wire->z + p[1]) / WB_MM, (wire->y + p[0]) / WB_MM);
            add(pen, (wire->z + r[1]) / WB_MM, (wire->y + r[0]) / WB_MM);
        }
    }
}

static void add_outline(struct pen *pen, const struct wb_swept_section *section,
                        const struct wb_packing_circle *wire)
{
    lift(pen);
    for (int i = 0; i <= section->n_outline; i++) {
        const double *const p = section->node[section->outline[i % section->n_outline]];
        add(pen, (wire->z + p[1]) / WB_MM, (wire->y + p[0]) / WB_MM);
    }
}

static enum wb_status draw_type(struct pen *pen, const struct wb_bundle_mesh *mesh, int type,
                                struct wb_colour colour)
{
    const struct wb_bundle_model *const m = pen->model;
    struct wb_swept_section section;
    WB_TRY(wb_swept_section_init_circle(&section, m->type[type].outer_diameter, mesh->core_quads,
                                        mesh->rings));
    for (int i = 0; i < m->packing.n; i++) {
        const struct wb_packing_circle *const wire = &m->packing.wire[i];
        if (m->type_of[i] != type)
            continue;
        add_circle(pen, wire->z / WB_MM, wire->y / WB_MM, wire->radius / WB_MM);
        fill(pen, paler(colour, 0.62));
        add_edges(pen, &section, wire);
        stroke(pen, paler(colour, 0.1), 0.35);
        add_outline(pen, &section, wire);
        stroke(pen, paler(colour, 0.1), 0.35);
        add_circle(pen, wire->z / WB_MM, wire->y / WB_MM, wire->radius / WB_MM);
        stroke(pen, darker(colour, 0.25), 0.7);
    }
    wb_swept_section_release(&section);
    return WB_OK;
}

/* --- tape --- */

static void add_face(struct pen *pen, const struct wb_hull *hull, double offset)
{
    const double length = wb_hull_length(hull, offset);
    lift(pen);
    for (int i = 0; i <= OUTLINE; i++) {
        const struct wb_hull_point p = wb_hull_at(hull, offset, length * i / OUTLINE);
        add(pen, p.z / WB_MM, p.y / WB_MM);
    }
}

/* Where the tape is bonded to a wire. */
static void add_bonds(struct pen *pen, const struct wb_hull *hull)
{
    const double length = wb_hull_length(hull, 0.0);
    bool drawing = false;
    for (int i = 0; i <= BONDS; i++) {
        const struct wb_hull_point p = wb_hull_at(hull, 0.0, length * i / BONDS);
        const bool bonded = wb_bundle_model_tape_wire(pen->model, p.y, p.z, 0.0) >= 0;
        if (bonded && !drawing)
            lift(pen);
        if (bonded)
            add(pen, p.z / WB_MM, p.y / WB_MM);
        drawing = bonded;
    }
}

static void draw_tape(struct pen *pen, const struct wb_bundle_mesh *mesh)
{
    const struct wb_bundle_tape *const tape = &pen->model->tape;
    const double inside = tape->gap, thickness = wb_taping_thickness(&tape->taping);
    const int n = wb_bundle_model_tape_quads(pen->model, mesh);
    add_face(pen, &tape->hull, inside);
    add_face(pen, &tape->hull, inside + thickness);
    fill(pen, tape_colour);
    /* The shells' nodes are equally spaced on the middle. */
    for (int i = 0; i < n; i++) {
        const struct wb_hull_point p =
            wb_hull_at(&tape->hull, inside + 0.5 * thickness, tape->taping.circumference * i / n);
        const double half = 0.5 * thickness / WB_MM;
        const double x = p.z / WB_MM, y = p.y / WB_MM;
        lift(pen);
        add(pen, x - half * cos(p.normal), y - half * sin(p.normal));
        add(pen, x + half * cos(p.normal), y + half * sin(p.normal));
    }
    stroke(pen, paler(tape_colour, 0.75), 0.35);
    if (tape->gap > 0.0)
        return;
    add_bonds(pen, &tape->hull);
    stroke(pen, (struct wb_colour){0.84, 0.15, 0.16, 1.0}, 1.1);
}

/* --- around the section --- */

/* "<disc> 10 x type3", side by side below the section. */
static void add_legend(struct pen *pen, const struct drawing *drawing, double y)
{
    char text[1024] = "";
    size_t length = 0;
    for (int i = 0; i < pen->model->n_types; i++) {
        const char *const name = pen->model->type[i].name;
        const struct wb_colour c = type_colour(drawing, name);
        const int n =
            snprintf(text + length, sizeof text - length,
                     "%s<span foreground=\"#%02x%02x%02x\">\xe2\x97\x8f</span> %d \xc3\x97 %s",
                     i > 0 ? "   " : "", (unsigned int)(255.0 * c.red + 0.5),
                     (unsigned int)(255.0 * c.green + 0.5), (unsigned int)(255.0 * c.blue + 0.5),
                     wb_bundle_model_count(pen->model, i), name);
        if (n < 0 || (size_t)n >= sizeof text - length) {
            text[length] = '\0';
            break;
        }
        length += (size_t)n;
    }
    wb_figure_add_text(pen->panel, 0.0, y, 0, text);
}

/* The diameter below the section, with the published one where it is another. */
static void add_dimension(struct pen *pen, double y, double point)
{
    const double diameter = wb_bundle_model_diameter(pen->model) / WB_MM, r = 0.5 * diameter;
    const double published = pen->model->published.outer_diameter / WB_MM;
    for (int side = -1; side <= 1; side += 2) {
        lift(pen);
        add(pen, side * r, 0.0);
        add(pen, side * r, y - 3.0 * point);
        lift(pen);
        add(pen, side * (r - 4.5 * point), y + 1.8 * point);
        add(pen, side * r, y);
        add(pen, side * (r - 4.5 * point), y - 1.8 * point);
    }
    lift(pen);
    add(pen, -r, y);
    add(pen, r, y);
    stroke(pen, wb_palette_grey(), 0.5);

    char text[160];
    const int n = snprintf(text, sizeof text, "<i>d</i><sub>o</sub> = %.2f mm", diameter);
    if (pen->model->has_published && fabs(published - diameter) > 0.005)
        snprintf(text + n, sizeof text - (size_t)n, " (printed: %.2f mm)", published);
    wb_figure_add_text(pen->panel, 0.0, y - 9.0 * point, 0, text);
}

/* Its length is 1, 2 or 5 of a power of ten, at most a sixth of the largest cylinder. */
static void add_scale_bar(struct pen *pen, const struct drawing *drawing, double x, double y)
{
    const double most = drawing->reach / 3.0;
    double length = pow(10.0, floor(log10(most)));
    length *= most >= 5.0 * length ? 5.0 : most >= 2.0 * length ? 2.0 : 1.0;
    char text[32];
    snprintf(text, sizeof text, "%g mm", length);
    add(pen, x, y);
    add(pen, x + length, y);
    stroke(pen, wb_palette_ink(), 1.8);
    wb_figure_add_text(pen->panel, x, y + 7.0 * drawing->point, -1, text);
}

/* Beside others only a short one has room. */
static void set_title(struct wb_panel *panel, const struct wb_bundle_model *model, bool alone)
{
    const size_t length = strlen(model->title);
    const bool fits = length > 0 && (alone || length <= TITLE);
    struct wb_text title = {0};
    wb_text_append_escaped(&title, fits ? model->title : model->name);
    wb_figure_set_title(panel, wb_text_string(&title));
    wb_text_release(&title);
}

static enum wb_status draw_section(struct pen *pen, const struct drawing *drawing)
{
    const struct wb_bundle_model *const m = pen->model;
    const struct wb_bundle_mesh *const mesh = wb_bundle_model_mesh(m, drawing->mesh);
    if (!mesh)
        return wb_fail(WB_ERR_NOT_FOUND, "bundle %s has no mesh %s", m->name, drawing->mesh);
    const double radius = 0.5 * wb_bundle_model_diameter(m) / WB_MM;
    add_circle(pen, 0.0, 0.0, radius);
    fill(pen, void_colour);
    for (int i = 0; i < m->n_types; i++)
        WB_TRY(draw_type(pen, mesh, i, type_colour(drawing, m->type[i].name)));
    if (m->has_tape)
        draw_tape(pen, mesh);
    add_circle(pen, 0.0, 0.0, radius);
    stroke(pen, wb_palette_grey(), 0.5);
    add_dimension(pen, -radius - 10.0 * drawing->point, drawing->point);
    add_legend(pen, drawing, -radius - 34.0 * drawing->point);
    return WB_OK;
}

/* --- the whole --- */

/* Points, beside each other and all around, and below the largest section. */
static const double gap = 10.0, margin = 6.0, above = 16.0, below = 42.0, footer = 10.0;

static double figure_width(int n)
{
    return n == 1 ? 280.0 : n == 2 ? 400.0 : WB_PDF_WIDTH;
}

/* Sections stand on one line; the scale is the same in all. */
static enum wb_status draw_panels(struct wb_figure *figure, struct pen *pen,
                                  const struct drawing *drawing, int n,
                                  const struct wb_bundle_model *const *models)
{
    const double point = drawing->point, half = drawing->reach + margin * point;
    for (int i = 0; i < n; i++) {
        const double foot = -0.5 * wb_bundle_model_diameter(models[i]) / WB_MM;
        const double head = foot + 2.0 * drawing->reach + margin * point;
        pen->panel = wb_figure_add_panel(figure);
        pen->model = models[i];
        pen->n = 0;
        wb_figure_hide_axes(pen->panel);
        wb_figure_set_equal_aspect(pen->panel);
        wb_figure_set_x_range(pen->panel, -half, half);
        wb_figure_set_y_range(pen->panel, foot - below * point, head);
        set_title(pen->panel, models[i], n == 1);
        WB_TRY(draw_section(pen, drawing));
        if (i == 0)
            add_scale_bar(pen, drawing, -half + 2.0 * point, head - 12.0 * point);
    }
    return WB_OK;
}

static void set_footer(struct wb_figure *figure, const struct wb_bundle_model *model,
                       const char *mesh_name)
{
    const struct wb_bundle_mesh *const mesh = wb_bundle_model_mesh(model, mesh_name);
    char text[160];
    snprintf(text, sizeof text, "mesh %s: %d quadrilaterals a wire%s", mesh_name,
             wb_bundle_model_section_quads(mesh),
             model->has_tape && model->tape.gap == 0.0 ? "; red: tape on wires" : "");
    wb_figure_set_footer(figure, text);
}

enum wb_status wb_figures_bundle_draw(struct wb_figure **figure, const char *figure_name, int n,
                                      const struct wb_bundle_model *const *models, const char *mesh)
{
    struct drawing drawing = {.mesh = mesh};
    if (n < 1 || n > WB_FIGURES_BUNDLE_MOST)
        return wb_fail(WB_ERR_ARGUMENT, "%d bundles in a figure, expected 1 to %d", n,
                       WB_FIGURES_BUNDLE_MOST);
    for (int i = 0; i < n; i++) {
        take_types(&drawing, models[i]);
        drawing.reach = fmax(drawing.reach, 0.5 * wb_bundle_model_diameter(models[i]) / WB_MM);
    }
    const double panel = (figure_width(n) - gap * (n - 1)) / n - 4.0;
    drawing.point = 2.0 * drawing.reach / (panel - 2.0 * margin);
    const double height = panel - margin + above + below + footer;

    struct pen *const pen = wb_memory_new(1, sizeof *pen);
    enum wb_status status = wb_figure_create(figure, figure_name, figure_width(n), height);
    if (status == WB_OK)
        status = draw_panels(*figure, pen, &drawing, n, models);
    free(pen);
    if (status == WB_OK)
        set_footer(*figure, models[0], mesh);
    if (status != WB_OK) {
        wb_figure_destroy(*figure);
        *figure = NULL;
    }
    return status;
}
