#include "analysis/plot/layout.h"

#include <math.h>
#include <string.h>

struct wb_typeset_style wb_layout_tick_style(const struct wb_layout_panel *panel)
{
    return (struct wb_typeset_style){.size = panel->text_size, .colour = wb_palette_grey()};
}

struct wb_typeset_style wb_layout_label_style(const struct wb_layout_panel *panel)
{
    return (struct wb_typeset_style){
        .size = panel->text_size + 0.5, .colour = wb_palette_ink(), .align = WB_ALIGN_CENTRE};
}

struct wb_typeset_style wb_layout_title_style(const struct wb_layout_panel *panel)
{
    return (struct wb_typeset_style){
        .size = panel->text_size + 0.8, .bold = true, .colour = wb_palette_ink()};
}

struct wb_typeset_style wb_layout_footer_style(void)
{
    return (struct wb_typeset_style){
        .size = 6.4, .colour = wb_palette_grey(), .align = WB_ALIGN_RIGHT};
}

double wb_layout_x(const struct wb_layout_panel *panel, double value)
{
    return panel->plot.x + panel->plot.width * wb_scale_position(&panel->x, value);
}

double wb_layout_y(const struct wb_layout_panel *panel, double value)
{
    return panel->plot.y + panel->plot.height * (1.0 - wb_scale_position(&panel->y, value));
}

static void widen(double range[2], double value, bool positive_only)
{
    if (!isfinite(value) || (positive_only && !(value > 0.0)))
        return;
    if (!(value >= range[0]))
        range[0] = value;
    if (!(value <= range[1]))
        range[1] = value;
}

/* Ranges of the data; NaN while there are none. Levels count for y only. */
static void find_ranges(const struct wb_panel *panel, double x[2], double y[2])
{
    x[0] = x[1] = y[0] = y[1] = (double)NAN;
    for (int i = 0; i < panel->n_series; i++) {
        const struct wb_series *const series = &panel->series[i];
        for (size_t k = 0; k < series->n; k++) {
            if (!isfinite(series->y[k]))
                continue;
            if (series->x)
                widen(x, series->x[k], false);
            widen(y, series->y[k], panel->logarithmic_y);
            if (series->high)
                widen(y, series->high[k], panel->logarithmic_y);
        }
    }
}

static void set_scale(struct wb_scale *scale, const double data[2], const double given[2],
                      bool logarithmic)
{
    const double low = isfinite(given[0]) ? given[0] : data[0];
    const double high = isfinite(given[1]) ? given[1] : data[1];
    wb_scale_fit(scale, low, high, logarithmic);
    /* A bound that was asked for gets no room. */
    if (isfinite(given[0]) && given[0] < scale->high)
        scale->low = given[0];
    if (isfinite(given[1]) && given[1] > scale->low)
        scale->high = given[1];
}

static void fit_scales(struct wb_layout_panel *layout)
{
    const struct wb_panel *const panel = layout->panel;
    double x[2], y[2];
    find_ranges(panel, x, y);
    set_scale(&layout->x, x, panel->x_range, false);
    set_scale(&layout->y, y, panel->y_range, panel->logarithmic_y);
}

static double widest_label(cairo_t *cairo, const struct wb_layout_panel *layout,
                           const struct wb_scale *scale)
{
    const struct wb_typeset_style style = wb_layout_tick_style(layout);
    double widest = 0.0;
    for (int i = 0; i < scale->n_ticks; i++)
        widest = fmax(widest, wb_typeset_measure(cairo, scale->labels[i], &style).width);
    return widest;
}

static void place_names(struct wb_scale *scale, const struct wb_panel *panel)
{
    scale->n_ticks = 0;
    for (int i = 0; i < panel->n_y_names; i++) {
        if (i < scale->low || i > scale->high)
            continue;
        scale->ticks[scale->n_ticks] = i;
        memcpy(scale->labels[scale->n_ticks++], panel->y_names[i], WB_SCALE_TEXT);
    }
}

static void place_ticks(struct wb_layout_panel *layout)
{
    const double every_x = 6.5 * layout->text_size, every_y = 3.6 * layout->text_size;
    wb_scale_place_ticks(&layout->x, (int)(layout->plot.width / every_x));
    if (layout->panel->n_y_names > 0)
        place_names(&layout->y, layout->panel);
    else
        wb_scale_place_ticks(&layout->y, (int)(layout->plot.height / every_y));
    layout->right = layout->y;
    if (layout->panel->right_factor > 0.0) {
        layout->right.low *= layout->panel->right_factor;
        layout->right.high *= layout->panel->right_factor;
        wb_scale_place_ticks(&layout->right, (int)(layout->plot.height / every_y));
    }
}

/* With equal aspect, widens the roomier axis at its high end, or on both sides of a drawing. */
static void equalise(struct wb_layout_panel *layout)
{
    if (!layout->panel->equal_aspect)
        return;
    const double x_span = layout->x.high - layout->x.low, y_span = layout->y.high - layout->y.low;
    const double scale = fmin(layout->plot.width / x_span, layout->plot.height / y_span);
    const double x_more = layout->plot.width / scale - x_span;
    const double y_more = layout->plot.height / scale - y_span;
    const double low_part = layout->panel->hidden_axes ? 0.5 : 0.0;
    layout->x.low -= low_part * x_more;
    layout->x.high += (1.0 - low_part) * x_more;
    layout->y.low -= low_part * y_more;
    layout->y.high += (1.0 - low_part) * y_more;
}

/* The frame within the room, after its tick labels, labels and title. */
static void frame_plot(struct wb_layout_panel *layout, cairo_t *cairo, double legend_height)
{
    const struct wb_panel *const panel = layout->panel;
    double left = 2.0, right = 2.0, top = 3.0 + legend_height, bottom = 2.0;
    if (!panel->hidden_axes) {
        const double line = 1.35 * layout->text_size;
        left = widest_label(cairo, layout, &layout->y) + 5.0 + (panel->y_label ? line + 5.0 : 0.0);
        bottom = line + 3.0 + (panel->x_label ? line + 2.0 : 0.0);
        /* Half of the last tick label of x may stand out to the right. */
        right = panel->right_factor > 0.0 ? widest_label(cairo, layout, &layout->right) + 5.0 +
                                                (panel->right_label ? line + 5.0 : 0.0)
                                          : fmax(4.0, 1.2 * layout->text_size);
        top = fmax(top, 0.6 * layout->text_size + legend_height);
    }
    if (panel->title)
        top += 1.9 * layout->text_size;
    layout->plot = (struct wb_place_box){layout->room.x + left, layout->room.y + top,
                                         fmax(8.0, layout->room.width - left - right),
                                         fmax(8.0, layout->room.height - top - bottom)};
}

static void lay_axes(struct wb_layout_panel *layout, cairo_t *cairo, double legend_height)
{
    layout->plot = layout->room;
    /* Labels, frame and ranges depend on each other; the third round changes nothing any more. */
    for (int round = 0; round < 3; round++) {
        fit_scales(layout);
        equalise(layout);
        place_ticks(layout);
        frame_plot(layout, cairo, legend_height);
    }
    fit_scales(layout);
    equalise(layout);
    place_ticks(layout);
}

static void mark_line(struct wb_place *place, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    const double half_line = 0.5 * series->style.width;
    const double half_marker =
        series->style.marker == WB_MARKER_NONE
            ? 0.0
            : 0.5 * (series->style.marker_size > 0.0 ? series->style.marker_size : 4.0);
    double last_x = (double)NAN, last_y = (double)NAN;
    for (size_t i = 0; i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]) - layout->plot.x;
        const double y = wb_layout_y(layout, series->y[i]) - layout->plot.y;
        if (series->style.marker != WB_MARKER_NONE)
            wb_place_mark_segment(place, x, y, x, y, half_marker);
        if (series->style.width > 0.0)
            wb_place_mark_segment(place, last_x, last_y, x, y, half_line);
        last_x = x;
        last_y = y;
    }
}

static void mark_band(struct wb_place *place, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    for (size_t i = 1; i < series->n; i++) {
        const double x0 = wb_layout_x(layout, series->x[i - 1]);
        const double x1 = wb_layout_x(layout, series->x[i]);
        const double low0 = wb_layout_y(layout, series->y[i - 1]);
        const double low1 = wb_layout_y(layout, series->y[i]);
        const double high0 = wb_layout_y(layout, series->high[i - 1]);
        const double high1 = wb_layout_y(layout, series->high[i]);
        if (!isfinite(x0 + x1 + low0 + low1 + high0 + high1))
            continue;
        const int n = (int)fmin(4096.0, ceil(fabs(x1 - x0)));
        for (int k = 0; k <= n; k++) {
            const double part = n ? (double)k / n : 0.0;
            const double x = x0 + part * (x1 - x0) - layout->plot.x;
            wb_place_mark_segment(place, x, low0 + part * (low1 - low0) - layout->plot.y, x,
                                  high0 + part * (high1 - high0) - layout->plot.y, 0.5);
        }
    }
}

/* The edges of the faces and their diagonals: faces are small, so that leaves no room in them. */
static void mark_field(struct wb_place *place, const struct wb_layout_panel *layout,
                       const struct wb_series *series)
{
    static const int ends[6][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {1, 3}};
    for (size_t i = 0; i + 8 <= series->n; i += 8) {
        for (int k = 0; k < 6; k++) {
            const double *const x = &series->x[i], *const y = &series->y[i];
            const int a = ends[k][0], b = ends[k][1];
            wb_place_mark_segment(place, wb_layout_x(layout, x[a]) - layout->plot.x,
                                  wb_layout_y(layout, y[a]) - layout->plot.y,
                                  wb_layout_x(layout, x[b]) - layout->plot.x,
                                  wb_layout_y(layout, y[b]) - layout->plot.y, 1.5);
        }
    }
}

/* The outline, and lines from it to its middle: areas are round enough to have no room in them. */
static void mark_area(struct wb_place *place, const struct wb_layout_panel *layout,
                      const struct wb_series *series)
{
    double middle[2] = {0.0, 0.0}, last[2] = {(double)NAN, (double)NAN};
    size_t n = 0;
    for (size_t i = 0; i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]) - layout->plot.x;
        const double y = wb_layout_y(layout, series->y[i]) - layout->plot.y;
        if (isfinite(x + y)) {
            middle[0] += x;
            middle[1] += y;
            n++;
        }
    }
    for (size_t i = 0; n > 0 && i < series->n; i++) {
        const double x = wb_layout_x(layout, series->x[i]) - layout->plot.x;
        const double y = wb_layout_y(layout, series->y[i]) - layout->plot.y;
        wb_place_mark_segment(place, last[0], last[1], x, y, 1.0);
        wb_place_mark_segment(place, x, y, middle[0] / (double)n, middle[1] / (double)n, 1.0);
        last[0] = x;
        last[1] = y;
    }
}

static void mark_text(struct wb_place *place, const struct wb_layout_panel *layout,
                      const struct wb_series *series, cairo_t *cairo)
{
    const struct wb_typeset_style style = wb_layout_tick_style(layout);
    const struct wb_typeset_size size = wb_typeset_measure(cairo, series->label, &style);
    const double x = wb_layout_x(layout, series->x[0]) - layout->plot.x;
    const double y = wb_layout_y(layout, series->y[0]) - layout->plot.y;
    const struct wb_place_box box = {x - 0.5 * (1 + series->side) * size.width,
                                     y - 0.5 * size.height, size.width, size.height};
    wb_place_mark_box(place, &box);
}

static void mark_series(struct wb_place *place, const struct wb_layout_panel *layout,
                        cairo_t *cairo)
{
    for (int i = 0; i < layout->panel->n_series; i++) {
        const struct wb_series *const series = &layout->panel->series[i];
        if (series->n == 0)
            continue;
        switch (series->kind) {
        case WB_SERIES_IMAGE:
            break;
        case WB_SERIES_FIELD:
            mark_field(place, layout, series);
            break;
        case WB_SERIES_LINE:
            mark_line(place, layout, series);
            break;
        case WB_SERIES_BAND:
            mark_band(place, layout, series);
            break;
        case WB_SERIES_AREA:
            mark_area(place, layout, series);
            break;
        case WB_SERIES_TEXT:
            if (series->label)
                mark_text(place, layout, series, cairo);
            break;
        }
    }
}

int wb_layout_legend(const struct wb_layout_panel *panel, cairo_t *cairo,
                     void (*visit)(void *context, const struct wb_series *series, double x,
                                   double y),
                     void *context, struct wb_typeset_size *size)
{
    const struct wb_typeset_style style = wb_layout_tick_style(panel);
    /* A box lists its entries one below the other; outside they run in lines. */
    const double pad = panel->legend_outside ? 0.0 : WB_LAYOUT_PADDING;
    const double widest = panel->legend_outside ? panel->legend.width : (double)INFINITY;
    double x = pad, y = pad, row = 0.0, right = 0.0;
    int n = 0;
    for (int i = 0; i < panel->panel->n_series; i++) {
        const struct wb_series *const series = &panel->panel->series[i];
        if (!series->label || series->kind == WB_SERIES_TEXT)
            continue;
        const struct wb_typeset_size text = wb_typeset_measure(cairo, series->label, &style);
        const double entry = WB_LAYOUT_SWATCH + 4.0 + text.width;
        if (n > 0 && (!panel->legend_outside || x + entry > widest)) {
            x = pad;
            y += row + 1.5;
        }
        if (visit)
            visit(context, series, panel->legend.x + x, panel->legend.y + y);
        row = fmax(row, text.height);
        right = fmax(right, x + entry);
        if (panel->legend_outside)
            x += entry + 12.0;
        n++;
    }
    *size = (struct wb_typeset_size){right + pad, n ? y + row + pad : 0.0};
    return n;
}

/* Finds room for an inset of some size that covers no data, larger ones first. */
static bool place_inset(struct wb_place *place, const struct wb_layout_panel *outer,
                        struct wb_layout_panel *inset)
{
    static const double parts[] = {0.50, 0.46, 0.43, 0.40, 0.38, 0.36,
                                   0.34, 0.32, 0.30, 0.28, 0.26};
    double ratio = 0.7;
    if (inset->panel->equal_aspect) {
        fit_scales(inset);
        ratio = (inset->y.high - inset->y.low) / (inset->x.high - inset->x.low);
        ratio = fmin(fmax(ratio, 0.3), 1.5);
    }
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const double width = parts[i] * outer->plot.width;
        const double height = fmin(ratio * (width - 32.0) + 34.0, 0.75 * outer->plot.height);
        struct wb_place_box box;
        if (width < 70.0 || !wb_place_find(place, width, height, 5.0, &box))
            continue;
        wb_place_mark_box(place, &box);
        box.x += outer->plot.x;
        box.y += outer->plot.y;
        inset->room = box;
        return true;
    }
    return false;
}

/* The axes, below a legend that stands above them when it found no room inside. */
static void lay_frame(struct wb_layout_panel *layout, cairo_t *cairo)
{
    double legend_height = 0.0;
    if (layout->legend_outside) {
        struct wb_typeset_size size;
        layout->legend = (struct wb_place_box){layout->room.x + 24.0, layout->room.y + 2.0,
                                               layout->room.width - 30.0, 0.0};
        wb_layout_legend(layout, cairo, NULL, NULL, &size);
        layout->legend.height = size.height;
        legend_height = size.height + 5.0;
        if (layout->panel->title)
            layout->legend.y += 1.9 * layout->text_size;
    }
    lay_axes(layout, cairo, legend_height);
}

/* Places what there is of inset and legend into the plot as it is laid; tells which found room. */
static void place_inside(struct wb_layout_panel *layout, struct wb_layout_panel *inset,
                         cairo_t *cairo, bool *inset_fits, bool *legend_fits)
{
    struct wb_place *const place = wb_place_create(layout->plot.width, layout->plot.height);
    mark_series(place, layout, cairo);
    *inset_fits = !inset->panel || place_inset(place, layout, inset);
    *legend_fits = true;
    if (layout->has_legend && !layout->legend_outside) {
        struct wb_typeset_size size;
        wb_layout_legend(layout, cairo, NULL, NULL, &size);
        *legend_fits = wb_place_find(place, size.width, size.height, 5.0, &layout->legend);
        layout->legend.x += layout->plot.x;
        layout->legend.y += layout->plot.y;
    }
    wb_place_destroy(place);
}

static void lay_panel(struct wb_layout_panel *layout, struct wb_layout_panel *inset, cairo_t *cairo)
{
    struct wb_typeset_size size;
    bool inset_fits, legend_fits;
    layout->has_legend = wb_layout_legend(layout, cairo, NULL, NULL, &size) > 0;
    lay_frame(layout, cairo);
    place_inside(layout, inset, cairo, &inset_fits, &legend_fits);
    if (!legend_fits) {
        /* The legend goes above the axes; the plot is smaller then, so the inset moves too. */
        layout->legend_outside = true;
        lay_frame(layout, cairo);
        place_inside(layout, inset, cairo, &inset_fits, &legend_fits);
    }
    if (inset_fits)
        return;

    /* An inset without room stands to the right of the axes. */
    inset->room = layout->room;
    inset->room.width *= 0.36;
    layout->room.width -= inset->room.width + 6.0;
    inset->room.x = layout->room.x + layout->room.width + 6.0;
    lay_frame(layout, cairo);
    struct wb_layout_panel none = {0};
    place_inside(layout, &none, cairo, &inset_fits, &legend_fits);
    if (!legend_fits) {
        layout->legend_outside = true;
        lay_frame(layout, cairo);
    }
}

/* A colour bar, as high as the plot before it. */
static void lay_bar(struct wb_layout_panel *layout, const struct wb_layout_panel *before)
{
    const struct wb_figure_colours *const colours = &layout->panel->colours;
    layout->plot =
        (struct wb_place_box){layout->room.x + 3.0, layout->room.y, 8.0, layout->room.height};
    if (before) {
        layout->plot.y = before->plot.y;
        layout->plot.height = before->plot.height;
    }
    /* Its label stands above it, half of a tick's label below it. */
    const double above = layout->panel->y_label ? 1.9 * layout->text_size : 0.6 * layout->text_size;
    const double most_y = layout->room.y + above;
    if (layout->plot.y < most_y) {
        layout->plot.height -= most_y - layout->plot.y;
        layout->plot.y = most_y;
    }
    const double bottom = layout->room.y + layout->room.height - 0.6 * layout->text_size;
    layout->plot.height = fmax(8.0, fmin(layout->plot.height, bottom - layout->plot.y));
    layout->y = (struct wb_scale){.low = colours->low, .high = colours->high};
    wb_scale_place_ticks(&layout->y, (int)(layout->plot.height / (2.2 * layout->text_size)));
}

/* Where each panel begins and ends: given widths first, the others share the rest. */
static void share_width(struct wb_layout *layout, const struct wb_figure *figure, double height)
{
    const double gap = 10.0;
    double rest = figure->width - gap * (figure->n_panels - 1), x = 0.0;
    int n = 0;
    for (int i = 0; i < figure->n_panels; i++) {
        rest -= figure->panels[i]->width;
        n += !(figure->panels[i]->width > 0.0);
    }
    for (int i = 0; i < figure->n_panels; i++) {
        const double given = figure->panels[i]->width;
        const double width = given > 0.0 ? given : fmax(8.0, rest / n);
        layout->panels[i].room = (struct wb_place_box){x, 0.0, width, height};
        x += width + gap;
    }
}

void wb_layout_compute(struct wb_layout *layout, const struct wb_figure *figure, cairo_t *cairo)
{
    memset(layout, 0, sizeof *layout);
    const struct wb_typeset_style footer = wb_layout_footer_style();
    double height = figure->height;
    if (figure->footer)
        height -= wb_typeset_measure(cairo, figure->footer, &footer).height + 2.0;
    layout->footer_y = height + 1.0;
    layout->n_panels = figure->n_panels;
    share_width(layout, figure, height);
    for (int i = 0; i < figure->n_panels; i++) {
        struct wb_layout_panel *const panel = &layout->panels[i];
        panel->panel = figure->panels[i];
        panel->text_size = panel->room.width < 300.0 ? 7.0 : 7.6;
        if (panel->panel->is_bar) {
            lay_bar(panel, i > 0 ? panel - 1 : NULL);
            continue;
        }
        struct wb_layout_panel *const inset = &layout->insets[i];
        inset->panel = panel->panel->inset;
        inset->text_size = 6.2;
        lay_panel(panel, inset, cairo);
        struct wb_layout_panel none = {0};
        if (inset->panel)
            lay_panel(inset, &none, cairo);
    }
}
