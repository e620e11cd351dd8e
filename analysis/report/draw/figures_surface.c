#include "analysis/report/draw/figures_surface.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/plot/view.h"
#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "report"

static const double default_width = 470.0, default_height = 165.0; /* pt */
static const double pixels_of_point = 2.5;
static const double most_pixels = 8000.0;          /* of wb_view_draw(), along and up */
static const double bar = 46.0, close_part = 0.21; /* pt; of the width: each end from nearby */
static const double glass_opacity = 0.22;
static const struct wb_colour glass = {0.62, 0.68, 0.76, 1.0};
static const struct wb_colour cut = {0.84, 0.84, 0.82, 1.0}; /* of the wires' ends */
/* Part of the window: margin around the picture. */
static const double margin = 0.03;

static const struct wb_view_camera from_side = {{0.22, 0.24, 1.0}, {0.0, 1.0, 0.0}};
static const struct wb_view_camera from_tip = {{0.75, 0.42, 1.0}, {0.0, 1.0, 0.0}};
static const struct wb_view_camera from_clamp = {{-0.7, 0.7, 1.0}, {0.0, 1.0, 0.0}};

/* Settings of both pictures of a figure; places in mm. */
struct drawing {
    const struct wb_surface *surface;
    struct wb_view_sheet *sheets;
    double (*position)[3];
    double *value; /* MPa */
    struct wb_figure_colours colours;
    double length; /* mm, of the bundle's axis */
    struct wb_memory memory;
};

double wb_figures_surface_most_stress(const struct wb_surface *surface)
{
    double most = 0.0;

    for (int b = 0; b < surface->n; b++) {
        const struct wb_surface_body *body = &surface->bodies[b];
        for (int i = 0; i < body->n_along * body->n_around && !body->is_tape; i++)
            most = fmax(most, body->nodes[i].von_mises);
    }
    return most;
}

/* Up to one, two, or five times a power of ten over five: 0.2, 0.4, 1, 2, 4, 10. */
static double round_up(double value)
{
    static const double steps[] = {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};
    if (!(value > 0.0) || !isfinite(value))
        return 1.0;
    const double power = pow(10.0, floor(log10(value)));
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++)
        if (value <= steps[i] * power * (1.0 + 1e-9))
            return steps[i] * power;
    return 10.0 * power;
}

/* --- the scene --- */

static int count_nodes(const struct wb_surface *surface)
{
    int n = 0;
    for (int b = 0; b < surface->n; b++)
        n += surface->bodies[b].n_along * surface->bodies[b].n_around;
    return n;
}

static void make_sheets(struct drawing *d)
{
    int at = 0;

    for (int b = 0; b < d->surface->n; b++) {
        const struct wb_surface_body *body = &d->surface->bodies[b];
        const int n = body->n_along * body->n_around;
        for (int i = 0; i < n; i++) {
            for (int c = 0; c < 3; c++)
                d->position[at + i][c] = body->nodes[i].position[c] / WB_MM;
            d->value[at + i] = body->nodes[i].von_mises / WB_MPA;
        }
        d->sheets[b] = (struct wb_view_sheet){
            .n_along = body->n_along,
            .n_around = body->n_around,
            .closed = body->closed,
            .capped = !body->is_tape,
            .position = (const double(*)[3])(d->position + at),
            .value = body->is_tape ? NULL : d->value + at,
            .opacity = body->is_tape ? glass_opacity : 1.0,
            .tint = body->is_tape ? glass : cut,
        };
        at += n;
    }
}

/* Mean place of a body's station. */
static void middle_of(const struct wb_view_sheet *sheet, int station, double middle[3])
{
    for (int c = 0; c < 3; c++)
        middle[c] = 0.0;
    for (int k = 0; k < sheet->n_around; k++)
        for (int c = 0; c < 3; c++)
            middle[c] += sheet->position[station * sheet->n_around + k][c] / sheet->n_around;
}

static double length_of(const struct wb_view_sheet *sheet)
{
    double length = 0.0, last[3], next[3];

    middle_of(sheet, 0, last);
    for (int j = 1; j < sheet->n_along; j++) {
        middle_of(sheet, j, next);
        length += wb_vec3_distance(last, next);
        memcpy(last, next, sizeof last);
    }
    return length;
}

static void make_drawing(struct drawing *d, const struct wb_surface *surface, double most_stress)
{
    const size_t nodes = (size_t)count_nodes(surface);

    *d = (struct drawing){.surface = surface};
    d->sheets = wb_memory_take(&d->memory, (size_t)surface->n, sizeof *d->sheets);
    d->position = wb_memory_take(&d->memory, nodes, sizeof *d->position);
    d->value = wb_memory_take(&d->memory, nodes, sizeof *d->value);
    make_sheets(d);
    if (!(most_stress > 0.0))
        most_stress = WB_MPA * round_up(wb_figures_surface_most_stress(surface) / WB_MPA);
    d->colours = (struct wb_figure_colours){
        .map = WB_PALETTE_SEQUENTIAL, .low = 0.0, .high = most_stress / WB_MPA};
    d->length = length_of(&d->sheets[0]);
}

/* --- windows --- */

struct window {
    double low[2], high[2];
};

static void include(struct window *window, const struct wb_view_camera *camera,
                    const double place[3])
{
    double at[3];

    wb_view_project(camera, place, at);
    for (int i = 0; i < 2; i++) {
        window->low[i] = fmin(window->low[i], at[i]);
        window->high[i] = fmax(window->high[i], at[i]);
    }
}

static struct window empty_window(void)
{
    return (struct window){{(double)INFINITY, (double)INFINITY},
                           {-(double)INFINITY, -(double)INFINITY}};
}

/* Widens a window to a ratio of width to height, with some room around. */
static void fit(struct window *window, double ratio)
{
    double size[2], middle[2];

    for (int i = 0; i < 2; i++) {
        middle[i] = 0.5 * (window->low[i] + window->high[i]);
        size[i] = (1.0 + 2.0 * margin) * (window->high[i] - window->low[i]);
    }
    size[0] = fmax(size[0], size[1] * ratio);
    size[1] = size[0] / ratio;
    for (int i = 0; i < 2; i++) {
        window->low[i] = middle[i] - 0.5 * size[i];
        window->high[i] = middle[i] + 0.5 * size[i];
    }
}

/* --- pictures --- */

static enum wb_status add_picture(struct wb_panel *panel, const struct drawing *d,
                                  const struct wb_view_camera *camera, const struct window *window,
                                  double width)
{
    const double size[2] = {window->high[0] - window->low[0], window->high[1] - window->low[1]};
    const double wide = ceil(pixels_of_point * width), high = ceil(wide * size[1] / size[0]);
    if (!(size[0] > 0.0 && size[1] > 0.0 && wide >= 1.0 && wide <= most_pixels && high >= 1.0 &&
          high <= most_pixels))
        return wb_fail(WB_ERR_DATA, "a bundle's surface of %g mm x %g mm cannot be drawn", size[0],
                       size[1]);
    const int across = (int)wide, down = (int)high;
    struct wb_view_scene scene = {
        .camera = *camera,
        .n_sheets = d->surface->n,
        .sheets = d->sheets,
        .colours = d->colours,
        .width = across,
        .height = down,
    };
    uint32_t *const pixels = wb_memory_new((size_t)across * (size_t)down, sizeof *pixels);

    memcpy(scene.low, window->low, sizeof scene.low);
    memcpy(scene.high, window->high, sizeof scene.high);
    const enum wb_status status = wb_view_draw(&scene, pixels);
    if (status == WB_OK) {
        struct wb_figure_image image = {.width = across, .height = down, .pixels = pixels};
        memcpy(image.low, window->low, sizeof image.low);
        memcpy(image.high, window->high, sizeof image.high);
        wb_figure_add_image(panel, &image);
    }
    free(pixels);
    wb_figure_hide_axes(panel);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_x_range(panel, window->low[0], window->high[0]);
    wb_figure_set_y_range(panel, window->low[1], window->high[1]);
    return status;
}

/* A line between two places. */
static void add_line(struct wb_panel *panel, const struct wb_view_camera *camera,
                     const double from[3], const double to[3], const struct wb_figure_style *style)
{
    double a[3], b[3];

    wb_view_project(camera, from, a);
    wb_view_project(camera, to, b);
    const double x[2] = {a[0], b[0]}, y[2] = {a[1], b[1]};
    wb_figure_add_line(panel, NULL, 2, x, y, style);
}

/* A length in the picture's plane, with its text, in the lower right corner. */
static void add_scale(struct wb_panel *panel, const struct window *window, double width)
{
    static const double lengths[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
    const struct wb_figure_style style = {.colour = wb_palette_ink(), .width = 1.4};
    const double size = window->high[0] - window->low[0], point = size / width;
    double length = lengths[0];
    char text[32];

    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++)
        if (lengths[i] <= 0.3 * size)
            length = lengths[i];
    const double right = window->high[0] - 6.0 * point, bottom = window->low[1] + 3.0 * point;
    const double x[2] = {right - length, right}, y[2] = {bottom, bottom};
    wb_figure_add_line(panel, NULL, 2, x, y, &style);
    snprintf(text, sizeof text, "%g mm", length);
    wb_figure_add_text(panel, right - 0.5 * length, bottom + 7.0 * point, 0, text);
}

/* The whole bundle, and where it lay straight, but for where it still covers that. */
static enum wb_status add_whole(struct wb_figure *figure, const struct drawing *d, double width,
                                double ratio, const char *title)
{
    const struct wb_figure_style dashed = {
        .colour = wb_palette_grey(), .width = 0.8, .dash = WB_DASH_DASHED};
    const double clear[3] = {0.25 * d->length, 0.0, 0.0}, straight[3] = {d->length, 0.0, 0.0};
    struct wb_panel *panel = wb_figure_add_panel(figure);
    struct window window = empty_window();

    for (int i = 0; i < count_nodes(d->surface); i++)
        include(&window, &from_side, d->position[i]);
    include(&window, &from_side, straight);
    fit(&window, ratio);
    if (title)
        wb_figure_set_title(panel, title);
    add_line(panel, &from_side, clear, straight, &dashed);
    add_scale(panel, &window, width);
    return add_picture(panel, d, &from_side, &window, width);
}

/* An end of the bundle from nearby. */
static enum wb_status add_end(struct wb_figure *figure, const struct drawing *d, bool is_tip,
                              double width, double ratio)
{
    const struct wb_view_camera *camera = is_tip ? &from_tip : &from_clamp;
    struct wb_panel *panel = wb_figure_add_panel(figure);
    struct window window = empty_window();

    for (int b = 0; b < d->surface->n; b++) {
        const struct wb_view_sheet *sheet = &d->sheets[b];
        const int last = sheet->n_along - 1, n = last < 2 ? last : 2;
        for (int j = is_tip ? last - n : 0; j <= (is_tip ? last : n); j++)
            for (int k = 0; k < sheet->n_around; k++)
                include(&window, camera, sheet->position[j * sheet->n_around + k]);
    }
    fit(&window, ratio);
    add_scale(panel, &window, width);
    wb_figure_set_title(panel, is_tip ? "tip" : "clamp");
    wb_figure_set_width(panel, width);
    return add_picture(panel, d, camera, &window, width);
}

enum wb_status wb_figures_surface_draw(struct wb_figure **figure, const char *figure_name,
                                       const struct wb_surface *surface,
                                       const struct wb_figures_surface_style *style)
{
    const struct wb_figures_surface_style none = {0}, *s = style ? style : &none;
    const double width = s->width > 0.0 ? s->width : default_width;
    const double height = s->height > 0.0 ? s->height : default_height;
    const double close = close_part * (width - bar), whole = width - bar - 2.0 * close;
    struct drawing d;

    *figure = NULL;
    if (surface->n == 0)
        return wb_fail(WB_ERR_ARGUMENT, "figure '%s': there is no surface", figure_name);
    make_drawing(&d, surface, s->most_stress);
    enum wb_status status = wb_figure_create(figure, figure_name, width, height);
    if (status == WB_OK)
        status = add_whole(*figure, &d, whole, whole / height, s->title);
    if (status == WB_OK)
        status = add_end(*figure, &d, false, close, close / height);
    if (status == WB_OK)
        status = add_end(*figure, &d, true, close, close / height);
    if (status == WB_OK) {
        wb_figure_add_colour_bar(*figure, &d.colours, "MPa");
    } else {
        wb_figure_destroy(*figure);
        *figure = NULL;
    }
    wb_memory_release(&d.memory);
    return status;
}
