#include "analysis/plot/canvas.h"

#include <math.h>

#include "analysis/plot/layout.h"
#include "analysis/plot/shading.h"

#define WB_LOG_DOMAIN "figure"

static const double pi = 3.14159265358979323846;

enum wb_status wb_canvas_status(cairo_status_t status, const char *what)
{
    if (status == CAIRO_STATUS_SUCCESS)
        return WB_OK;
    const enum wb_status code = status == CAIRO_STATUS_NO_MEMORY ? WB_ERR_MEMORY : WB_ERR_IO;
    return wb_fail(code, "cannot draw %s: %s", what, cairo_status_to_string(status));
}

cairo_status_t wb_canvas_append(void *closure, const unsigned char *bytes, unsigned int n)
{
    wb_text_append_bytes(closure, bytes, n);
    return CAIRO_STATUS_SUCCESS;
}

static void set_line(cairo_t *cairo, const struct wb_figure_style *style)
{
    const double w = fmax(style->width, 0.4);
    const double dashed[] = {4.0 * w, 2.2 * w}, dotted[] = {0.01, 2.2 * w};
    const double mixed[] = {5.0 * w, 2.0 * w, 0.01, 2.0 * w};
    cairo_set_line_width(cairo, style->width);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(cairo, style->dash == WB_DASH_DOTTED || style->dash == WB_DASH_MIXED
                                  ? CAIRO_LINE_CAP_ROUND
                                  : CAIRO_LINE_CAP_BUTT);
    switch (style->dash) {
    case WB_DASH_DASHED:
        cairo_set_dash(cairo, dashed, 2, 0.0);
        break;
    case WB_DASH_DOTTED:
        cairo_set_dash(cairo, dotted, 2, 0.0);
        break;
    case WB_DASH_MIXED:
        cairo_set_dash(cairo, mixed, 4, 0.0);
        break;
    case WB_DASH_SOLID:
        cairo_set_dash(cairo, NULL, 0, 0.0);
        break;
    }
    wb_typeset_set_colour(cairo, style->colour);
}

static void draw_marker(cairo_t *cairo, double x, double y, const struct wb_figure_style *style)
{
    const double r = 0.5 * (style->marker_size > 0.0 ? style->marker_size : 4.0);
    cairo_new_path(cairo);
    switch (style->marker) {
    case WB_MARKER_NONE:
        return;
    case WB_MARKER_CIRCLE:
    case WB_MARKER_RING:
        cairo_arc(cairo, x, y, r, 0.0, 2.0 * pi);
        break;
    case WB_MARKER_SQUARE:
        cairo_rectangle(cairo, x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
        break;
    case WB_MARKER_TRIANGLE:
        cairo_move_to(cairo, x, y - 1.15 * r);
        cairo_line_to(cairo, x + r, y + 0.75 * r);
        cairo_line_to(cairo, x - r, y + 0.75 * r);
        cairo_close_path(cairo);
        break;
    case WB_MARKER_DIAMOND:
        cairo_move_to(cairo, x, y - 1.2 * r);
        cairo_line_to(cairo, x + 1.2 * r, y);
        cairo_line_to(cairo, x, y + 1.2 * r);
        cairo_line_to(cairo, x - 1.2 * r, y);
        cairo_close_path(cairo);
        break;
    }
    if (style->marker == WB_MARKER_RING) {
        cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
        cairo_fill_preserve(cairo);
        wb_typeset_set_colour(cairo, style->colour);
        cairo_set_dash(cairo, NULL, 0, 0.0);
        cairo_set_line_width(cairo, 0.9);
        cairo_stroke(cairo);
        return;
    }
    wb_typeset_set_colour(cairo, style->colour);
    cairo_fill(cairo);
}

static void draw_line(cairo_t *cairo, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    bool open = false;
    double last_x = 0.0, last_y = 0.0;
    if (!(series->style.width > 0.0))
        return;
    cairo_new_path(cairo);
    for (size_t i = 0; i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]), y = wb_layout_y(layout, series->y[i]);
        if (!isfinite(x) || !isfinite(y)) {
            open = false;
            continue;
        }
        /* What nobody can see is not drawn, and far points are kept within Cairo's numbers. */
        const bool breaks_off = i + 1 == series->n || !isfinite(series->y[i + 1]);
        if (open && !breaks_off && hypot(x - last_x, y - last_y) < 0.2)
            continue;
        const double far_x = fmin(fmax(x, -1e4), 1e4), far_y = fmin(fmax(y, -1e4), 1e4);
        if (open)
            cairo_line_to(cairo, far_x, far_y);
        else
            cairo_move_to(cairo, far_x, far_y);
        open = true;
        last_x = x;
        last_y = y;
    }
    set_line(cairo, &series->style);
    cairo_stroke(cairo);
}

static void draw_band(cairo_t *cairo, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    cairo_new_path(cairo);
    size_t start = 0;
    while (start < series->n) {
        size_t end = start;
        while (end < series->n && isfinite(series->x[end] + series->y[end] + series->high[end]))
            end++;
        for (size_t i = start; i < end; i++)
            cairo_line_to(cairo, wb_layout_x(layout, series->x[i]),
                          wb_layout_y(layout, series->high[i]));
        for (size_t i = end; i > start; i--)
            cairo_line_to(cairo, wb_layout_x(layout, series->x[i - 1]),
                          wb_layout_y(layout, series->y[i - 1]));
        if (end > start)
            cairo_close_path(cairo);
        cairo_new_sub_path(cairo);
        start = end + 1;
    }
    wb_typeset_set_colour(cairo, series->style.colour);
    cairo_fill(cairo);
}

static void draw_area(cairo_t *cairo, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    cairo_new_path(cairo);
    for (size_t i = 0; i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]), y = wb_layout_y(layout, series->y[i]);
        if (!isfinite(x) || !isfinite(y)) {
            cairo_new_sub_path(cairo);
            continue;
        }
        /* Far points are kept within Cairo's numbers. */
        cairo_line_to(cairo, fmin(fmax(x, -1e4), 1e4), fmin(fmax(y, -1e4), 1e4));
    }
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_EVEN_ODD);
    wb_typeset_set_colour(cairo, series->style.colour);
    cairo_fill(cairo);
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_WINDING);
}

static void draw_points(cairo_t *cairo, const struct wb_layout_panel *layout,
                        const struct wb_series *series)
{
    const struct wb_place_box *const plot = &layout->plot;
    for (size_t i = 0; i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]), y = wb_layout_y(layout, series->y[i]);
        if (x >= plot->x - 0.5 && x <= plot->x + plot->width + 0.5 && y >= plot->y - 0.5 &&
            y <= plot->y + plot->height + 0.5)
            draw_marker(cairo, x, y, &series->style);
    }
}

static void draw_text(cairo_t *cairo, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    struct wb_typeset_style style = wb_layout_tick_style(layout);
    style.colour = wb_palette_ink();
    style.align = series->side < 0   ? WB_ALIGN_LEFT
                  : series->side > 0 ? WB_ALIGN_RIGHT
                                     : WB_ALIGN_CENTRE;
    const double height = wb_typeset_measure(cairo, series->label, &style).height;
    wb_typeset_draw(cairo, wb_layout_x(layout, series->x[0]),
                    wb_layout_y(layout, series->y[0]) - 0.5 * height, series->label, &style);
}

/* The fields, below all else. */
static void draw_image(cairo_t *cairo, const struct wb_layout_panel *layout,
                       const struct wb_series *series)
{
    const double left = wb_layout_x(layout, series->x[0]), top = wb_layout_y(layout, series->y[1]);
    const double width = wb_layout_x(layout, series->x[1]) - left;
    const double height = wb_layout_y(layout, series->y[0]) - top;
    const int across = series->pixels_across, down = series->pixels_down;
    cairo_surface_t *const image =
        cairo_image_surface_create_for_data((unsigned char *)series->pixels, CAIRO_FORMAT_ARGB32,
                                            across, down, (int)sizeof(uint32_t) * across);
    cairo_save(cairo);
    cairo_translate(cairo, left, top);
    cairo_scale(cairo, width / across, height / down);
    cairo_set_source_surface(cairo, image, 0.0, 0.0);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_GOOD);
    cairo_paint(cairo);
    cairo_restore(cairo);
    cairo_surface_destroy(image);
}

/* Draws the series of one kind that have points. */
static void
draw_kind(cairo_t *cairo, const struct wb_layout_panel *layout, enum wb_series_kind kind,
          void (*draw)(cairo_t *, const struct wb_layout_panel *, const struct wb_series *))
{
    for (int i = 0; i < layout->panel->n_series; i++) {
        const struct wb_series *const series = &layout->panel->series[i];
        if (series->kind == kind && series->n > 0)
            draw(cairo, layout, series);
    }
}

static void draw_fields(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const plot = &layout->plot;
    cairo_save(cairo);
    cairo_rectangle(cairo, plot->x, plot->y, plot->width, plot->height);
    cairo_clip(cairo);
    draw_kind(cairo, layout, WB_SERIES_IMAGE, draw_image);
    draw_kind(cairo, layout, WB_SERIES_FIELD, wb_shading_draw_field);
    cairo_restore(cairo);
}

static void draw_series(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_panel *const panel = layout->panel;
    const struct wb_place_box *const plot = &layout->plot;
    cairo_save(cairo);
    cairo_rectangle(cairo, plot->x, plot->y, plot->width, plot->height);
    cairo_clip(cairo);
    draw_kind(cairo, layout, WB_SERIES_BAND, draw_band);
    draw_kind(cairo, layout, WB_SERIES_AREA, draw_area);
    draw_kind(cairo, layout, WB_SERIES_LINE, draw_line);
    cairo_restore(cairo);
    for (int i = 0; i < panel->n_series; i++) {
        const struct wb_series *const series = &panel->series[i];
        if (series->kind == WB_SERIES_LINE && series->style.marker != WB_MARKER_NONE)
            draw_points(cairo, layout, series);
        if (series->kind == WB_SERIES_TEXT && series->n > 0 && series->label)
            draw_text(cairo, layout, series);
    }
}

static void rule(cairo_t *cairo, double x0, double y0, double x1, double y1)
{
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
}

static void draw_grid(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const plot = &layout->plot;
    const struct wb_figure_style thin = {.colour = wb_palette_rule(), .width = 0.5};
    set_line(cairo, &thin);
    for (int i = 0; i < layout->x.n_ticks; i++) {
        const double x = wb_layout_x(layout, layout->x.ticks[i]);
        rule(cairo, x, plot->y, x, plot->y + plot->height);
    }
    for (int i = 0; i < layout->y.n_ticks; i++) {
        const double y = wb_layout_y(layout, layout->y.ticks[i]);
        rule(cairo, plot->x, y, plot->x + plot->width, y);
    }
}

/* A label that reads upwards, with its middle at (x, y); x is the side of its top. */
static void draw_upright(cairo_t *cairo, double x, double y, const char *markup,
                         const struct wb_typeset_style *style)
{
    cairo_save(cairo);
    cairo_translate(cairo, x, y);
    cairo_rotate(cairo, -0.5 * pi);
    wb_typeset_draw(cairo, 0.0, 0.0, markup, style);
    cairo_restore(cairo);
}

/* Ticks of a scale at the left (side -1) or right (1) of the plot, from its frame outwards. */
static void draw_side_ticks(cairo_t *cairo, const struct wb_layout_panel *layout,
                            const struct wb_scale *scale, int side)
{
    const struct wb_place_box *const plot = &layout->plot;
    const double frame = side < 0 ? plot->x : plot->x + plot->width, end = frame + 2.5 * side;
    struct wb_typeset_style style = wb_layout_tick_style(layout);
    style.align = side < 0 ? WB_ALIGN_RIGHT : WB_ALIGN_LEFT;
    for (int i = 0; i < scale->n_ticks; i++) {
        const double y = plot->y + plot->height * (1.0 - wb_scale_position(scale, scale->ticks[i]));
        const double height = wb_typeset_measure(cairo, scale->labels[i], &style).height;
        rule(cairo, fmin(frame, end), y, fmax(frame, end), y);
        wb_typeset_draw(cairo, frame + 4.5 * side, y - 0.5 * height, scale->labels[i], &style);
    }
}

static void draw_tick_labels(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const plot = &layout->plot;
    struct wb_typeset_style style = wb_layout_tick_style(layout);
    style.align = WB_ALIGN_CENTRE;
    const double bottom = plot->y + plot->height;
    for (int i = 0; i < layout->x.n_ticks; i++) {
        const double x = wb_layout_x(layout, layout->x.ticks[i]);
        rule(cairo, x, bottom, x, bottom + 2.5);
        wb_typeset_draw(cairo, x, bottom + 3.5, layout->x.labels[i], &style);
    }
    draw_side_ticks(cairo, layout, &layout->y, -1);
    if (layout->panel->right_factor > 0.0)
        draw_side_ticks(cairo, layout, &layout->right, 1);
}

static void draw_axes(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_panel *const panel = layout->panel;
    const struct wb_place_box *const plot = &layout->plot;
    const struct wb_figure_style frame = {.colour = wb_palette_grey(), .width = 0.7};
    set_line(cairo, &frame);
    draw_tick_labels(cairo, layout);
    set_line(cairo, &frame);
    cairo_rectangle(cairo, plot->x, plot->y, plot->width, plot->height);
    cairo_stroke(cairo);

    const struct wb_typeset_style style = wb_layout_label_style(layout);
    const double middle = plot->y + 0.5 * plot->height;
    if (panel->x_label)
        wb_typeset_draw(cairo, plot->x + 0.5 * plot->width,
                        plot->y + plot->height + 1.35 * layout->text_size + 4.0, panel->x_label,
                        &style);
    if (panel->y_label)
        draw_upright(cairo, layout->room.x + 1.0, middle, panel->y_label, &style);
    if (panel->right_label && panel->right_factor > 0.0) {
        const double height = wb_typeset_measure(cairo, panel->right_label, &style).height;
        draw_upright(cairo, layout->room.x + layout->room.width - height - 1.0, middle,
                     panel->right_label, &style);
    }
}

struct legend_pen {
    cairo_t *cairo;
    const struct wb_layout_panel *layout;
};

static void draw_entry(void *context, const struct wb_series *series, double x, double y)
{
    const struct legend_pen *const pen = context;
    struct wb_typeset_style style = wb_layout_tick_style(pen->layout);
    style.colour = wb_palette_ink();
    const double height = wb_typeset_measure(pen->cairo, series->label, &style).height;
    const double middle = y + 0.5 * height;
    if (series->kind == WB_SERIES_BAND || series->kind == WB_SERIES_AREA) {
        cairo_rectangle(pen->cairo, x, middle - 3.0, WB_LAYOUT_SWATCH, 6.0);
        wb_typeset_set_colour(pen->cairo, series->style.colour);
        cairo_fill(pen->cairo);
    }
    if (series->style.width > 0.0) {
        set_line(pen->cairo, &series->style);
        rule(pen->cairo, x, middle, x + WB_LAYOUT_SWATCH, middle);
    }
    draw_marker(pen->cairo, x + 0.5 * WB_LAYOUT_SWATCH, middle, &series->style);
    wb_typeset_draw(pen->cairo, x + WB_LAYOUT_SWATCH + 4.0, y, series->label, &style);
}

static void draw_legend(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const box = &layout->legend;
    if (!layout->legend_outside) {
        cairo_rectangle(cairo, box->x, box->y, box->width, box->height);
        cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
        cairo_fill_preserve(cairo);
        const struct wb_figure_style thin = {.colour = wb_palette_rule(), .width = 0.6};
        set_line(cairo, &thin);
        cairo_stroke(cairo);
    }
    struct legend_pen pen = {cairo, layout};
    struct wb_typeset_size size;
    (void)wb_layout_legend(layout, cairo, draw_entry, &pen, &size);
}

/* White below an inset's frame and its labels, and nowhere else: the outer panel's grid goes on
 * around them. */
static void clear_behind(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const room = &layout->room, *const plot = &layout->plot;
    const double margin = 2.0, half_label = 0.6 * layout->text_size;
    const double right = plot->x + plot->width, bottom = plot->y + plot->height;
    const bool has_right = layout->panel->right_factor > 0.0;
    cairo_set_source_rgb(cairo, 1.0, 1.0, 1.0);
    cairo_rectangle(cairo, plot->x, plot->y - margin, plot->width + margin,
                    plot->height + 2.0 * margin);
    /* Tick labels stand out by half their size at the ends of the axes. */
    cairo_rectangle(cairo, room->x, plot->y - half_label, plot->x - room->x,
                    plot->height + 2.0 * half_label);
    cairo_rectangle(cairo, plot->x - half_label, bottom, plot->width + 2.0 * half_label,
                    room->y + room->height - bottom);
    if (has_right)
        cairo_rectangle(cairo, right, plot->y - half_label, room->x + room->width - right,
                        plot->height + 2.0 * half_label);
    if (layout->panel->title)
        cairo_rectangle(cairo, plot->x, room->y, plot->width, plot->y - room->y);
    cairo_fill(cairo);
}

static void draw_panel(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_panel *const panel = layout->panel;
    if (panel->is_bar) {
        wb_shading_draw_bar(cairo, layout);
        return;
    }
    if (panel->is_inset)
        clear_behind(cairo, layout);
    if (!panel->hidden_axes)
        draw_grid(cairo, layout);
    draw_fields(cairo, layout);
    draw_series(cairo, layout);
    if (!panel->hidden_axes)
        draw_axes(cairo, layout);
    if (panel->title) {
        const struct wb_typeset_style style = wb_layout_title_style(layout);
        wb_typeset_draw(cairo, layout->plot.x, layout->room.y + 1.0, panel->title, &style);
    }
    if (layout->has_legend)
        draw_legend(cairo, layout);
}

enum wb_status wb_canvas_draw_figure(cairo_t *cairo, const struct wb_figure *figure, double x,
                                     double y)
{
    if (figure->failed)
        return wb_fail(WB_ERR_ARGUMENT,
                       "figure '%s' has too many panels, a field without a range of colours, or an "
                       "empty image",
                       figure->name);
    cairo_save(cairo);
    cairo_translate(cairo, x, y);
    struct wb_layout layout;
    wb_layout_compute(&layout, figure, cairo);
    for (int i = 0; i < layout.n_panels; i++) {
        draw_panel(cairo, &layout.panels[i]);
        if (layout.insets[i].panel)
            draw_panel(cairo, &layout.insets[i]);
    }
    if (figure->footer) {
        const struct wb_typeset_style style = wb_layout_footer_style();
        wb_typeset_draw(cairo, figure->width - 1.0, layout.footer_y, figure->footer, &style);
    }
    cairo_restore(cairo);
    return wb_canvas_status(cairo_status(cairo), figure->name);
}
