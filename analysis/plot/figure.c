#include "analysis/plot/figure.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/plot/figure_private.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "figure"

static void replace_text(char **target, const char *text)
{
    free(*target);
    *target = text ? wb_memory_text(text) : NULL;
}

enum wb_status wb_figure_create(struct wb_figure **out, const char *name, double width,
                                double height)
{
    *out = NULL;
    for (const char *c = name; *c; c++) {
        if (!isalnum((unsigned char)*c) && *c != '-' && *c != '_')
            return wb_fail(WB_ERR_ARGUMENT, "'%s' cannot be the name of a figure", name);
    }
    if (!*name || !(width >= 60.0 && width <= 5000.0 && height >= 40.0 && height <= 5000.0))
        return wb_fail(WB_ERR_ARGUMENT, "figure '%s': no name, or a size of %g x %g points", name,
                       width, height);
    struct wb_figure *const figure = wb_memory_new(1, sizeof *figure);
    figure->name = wb_memory_text(name);
    figure->width = width;
    figure->height = height;
    *out = figure;
    return WB_OK;
}

static void destroy_panel(struct wb_panel *panel)
{
    if (!panel)
        return;
    for (int i = 0; i < panel->n_series; i++) {
        free(panel->series[i].label);
        free(panel->series[i].x);
        free(panel->series[i].y);
        free(panel->series[i].high);
        free(panel->series[i].pixels);
        wb_contour_release(&panel->series[i].contour);
    }
    free(panel->series);
    free(panel->x_label);
    free(panel->y_label);
    free(panel->right_label);
    free(panel->title);
    destroy_panel(panel->inset);
    free(panel);
}

void wb_figure_destroy(struct wb_figure *figure)
{
    if (!figure)
        return;
    for (int i = 0; i < figure->n_panels; i++)
        destroy_panel(figure->panels[i]);
    free(figure->name);
    free(figure->footer);
    free(figure);
}

const char *wb_figure_name(const struct wb_figure *figure)
{
    return figure->name;
}

double wb_figure_width(const struct wb_figure *figure)
{
    return figure->width;
}

double wb_figure_height(const struct wb_figure *figure)
{
    return figure->height;
}

void wb_figure_set_footer(struct wb_figure *figure, const char *markup)
{
    replace_text(&figure->footer, markup);
}

static struct wb_panel *create_panel(struct wb_figure *figure)
{
    struct wb_panel *const panel = wb_memory_new(1, sizeof *panel);
    panel->figure = figure;
    panel->x_range[0] = panel->x_range[1] = (double)NAN;
    panel->y_range[0] = panel->y_range[1] = (double)NAN;
    return panel;
}

struct wb_panel *wb_figure_add_panel(struct wb_figure *figure)
{
    if (figure->n_panels == WB_FIGURE_PANELS) {
        figure->failed = true;
        return figure->panels[WB_FIGURE_PANELS - 1];
    }
    return figure->panels[figure->n_panels++] = create_panel(figure);
}

void wb_figure_set_width(struct wb_panel *panel, double width)
{
    panel->width = width;
}

/* The number of colours that is drawn. */
static struct wb_figure_colours complete(const struct wb_figure_colours *colours)
{
    struct wb_figure_colours all = *colours;
    if (all.n == 0)
        all.n = 48;
    return all;
}

void wb_figure_add_colour_bar(struct wb_figure *figure, const struct wb_figure_colours *colours,
                              const char *label)
{
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    panel->is_bar = true;
    panel->width = 46.0;
    panel->colours = complete(colours);
    replace_text(&panel->y_label, label);
}

struct wb_panel *wb_figure_add_inset(struct wb_panel *panel)
{
    if (panel->inset || panel->is_inset) {
        panel->figure->failed = true;
        return panel;
    }
    panel->inset = create_panel(panel->figure);
    panel->inset->is_inset = true;
    return panel->inset;
}

void wb_figure_set_axes(struct wb_panel *panel, const char *x_label, const char *y_label)
{
    replace_text(&panel->x_label, x_label);
    replace_text(&panel->y_label, y_label);
}

void wb_figure_set_title(struct wb_panel *panel, const char *markup)
{
    replace_text(&panel->title, markup);
}

void wb_figure_set_x_range(struct wb_panel *panel, double low, double high)
{
    panel->x_range[0] = low;
    panel->x_range[1] = high;
}

void wb_figure_set_y_range(struct wb_panel *panel, double low, double high)
{
    panel->y_range[0] = low;
    panel->y_range[1] = high;
}

void wb_figure_set_logarithmic_y(struct wb_panel *panel)
{
    panel->logarithmic_y = true;
}

void wb_figure_set_y_names(struct wb_panel *panel, int n, const char *const *names)
{
    panel->n_y_names = n < WB_SCALE_TICKS ? n : WB_SCALE_TICKS;
    for (int i = 0; i < panel->n_y_names; i++)
        snprintf(panel->y_names[i], sizeof panel->y_names[i], "%s", names[i]);
}

void wb_figure_set_equal_aspect(struct wb_panel *panel)
{
    panel->equal_aspect = true;
}

void wb_figure_set_right_axis(struct wb_panel *panel, const char *label, double factor)
{
    replace_text(&panel->right_label, label);
    panel->right_factor = factor > 0.0 && isfinite(factor) ? factor : 0.0;
}

void wb_figure_hide_axes(struct wb_panel *panel)
{
    panel->hidden_axes = true;
}

static double *copy_values(const double *values, size_t n)
{
    double *const copy = wb_memory_new(n, sizeof *copy);
    if (n)
        memcpy(copy, values, n * sizeof *copy);
    return copy;
}

/* Adds a series of n points (x, y). */
static struct wb_series *add_series(struct wb_panel *panel, enum wb_series_kind kind,
                                    const char *label, size_t n, const double *x, const double *y)
{
    panel->series = wb_memory_room(panel->series, &panel->capacity, (size_t)panel->n_series + 1,
                                   sizeof *panel->series);
    struct wb_series *const series = &panel->series[panel->n_series++];
    *series = (struct wb_series){.kind = kind,
                                 .label = label ? wb_memory_text(label) : NULL,
                                 .n = n,
                                 .x = copy_values(x, n),
                                 .y = copy_values(y, n)};
    return series;
}

void wb_figure_add_line(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *y, const struct wb_figure_style *style)
{
    add_series(panel, WB_SERIES_LINE, label, n, x, y)->style = *style;
}

void wb_figure_add_band(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *const edges[2], struct wb_colour colour)
{
    struct wb_series *const series = add_series(panel, WB_SERIES_BAND, label, n, x, edges[0]);
    series->style.colour = colour;
    series->high = copy_values(edges[1], n);
}

void wb_figure_add_area(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *y, struct wb_colour colour)
{
    add_series(panel, WB_SERIES_AREA, label, n, x, y)->style.colour = colour;
}

void wb_figure_add_field(struct wb_panel *panel, int n_faces, const struct wb_contour_face *faces,
                         const struct wb_figure_colours *colours)
{
    struct wb_series *const series = add_series(panel, WB_SERIES_FIELD, NULL, 0, NULL, NULL);
    series->colours = complete(colours);
    const struct wb_contour_levels levels = {series->colours.low, series->colours.high,
                                             series->colours.n};
    const size_t n = (size_t)n_faces * 8;
    if (wb_contour_create(&series->contour, n_faces, faces, &levels) != WB_OK) {
        panel->figure->failed = true;
        return;
    }
    series->x = wb_memory_resize(series->x, n, sizeof *series->x);
    series->y = wb_memory_resize(series->y, n, sizeof *series->y);
    for (size_t i = 0; i < n; i++) {
        series->x[i] = faces[i / 8].x[i % 8];
        series->y[i] = faces[i / 8].y[i % 8];
    }
    series->n = n;
}

void wb_figure_add_image(struct wb_panel *panel, const struct wb_figure_image *image)
{
    const size_t n = (size_t)image->width * (size_t)image->height;
    const double x[2] = {image->low[0], image->high[0]}, y[2] = {image->low[1], image->high[1]};
    struct wb_series *const series = add_series(panel, WB_SERIES_IMAGE, NULL, 2, x, y);
    if (n == 0) {
        panel->figure->failed = true;
        return;
    }
    series->pixels = wb_memory_new(n, sizeof *series->pixels);
    memcpy(series->pixels, image->pixels, n * sizeof *series->pixels);
    series->pixels_across = image->width;
    series->pixels_down = image->height;
}

void wb_figure_add_text(struct wb_panel *panel, double x, double y, int side, const char *markup)
{
    add_series(panel, WB_SERIES_TEXT, markup, 1, &x, &y)->side = side;
}
