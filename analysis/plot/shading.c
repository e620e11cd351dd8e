#include "analysis/plot/shading.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static const double finest = 0.04; /* pt: by so much a drawn line may stray */

static struct wb_colour colour_of(const struct wb_figure_colours *colours, int level)
{
    return wb_palette_map(colours->map, (level + 0.5) / colours->n);
}

/* A loop in points, without those that nobody would see. */
static void trace_loop(cairo_t *cairo, const struct wb_layout_panel *layout, double (*points)[2],
                       int n)
{
    for (int k = 0; k < n; k++) {
        points[k][0] = wb_layout_x(layout, points[k][0]);
        points[k][1] = wb_layout_y(layout, points[k][1]);
    }
    const int kept = wb_contour_thin(points, n, finest);
    if (kept < 3)
        return;
    cairo_new_sub_path(cairo);
    for (int k = 0; k < kept; k++)
        cairo_line_to(cairo, points[k][0], points[k][1]);
    cairo_close_path(cairo);
}

/* Loops of one level as one path: what lies between them is filled once, without seams. Returns the
 * first loop of the next level. */
static int trace_level(cairo_t *cairo, const struct wb_layout_panel *layout,
                       const struct wb_contour *contour, int first, double (*points)[2])
{
    const int level = contour->loops[first].level;
    int i = first;
    cairo_new_path(cairo);
    for (; i < contour->n_loops && contour->loops[i].level == level; i++) {
        const struct wb_contour_loop *const loop = &contour->loops[i];
        memcpy(points, contour->points[loop->first], (size_t)loop->n * sizeof *points);
        trace_loop(cairo, layout, points, loop->n);
    }
    return i;
}

static void draw_outline(cairo_t *cairo, enum wb_figure_outline outline)
{
    const struct wb_colour white = {1.0, 1.0, 1.0, 0.75};
    wb_typeset_set_colour(cairo, outline == WB_OUTLINE_LIGHT ? white : wb_palette_ink());
    cairo_set_line_width(cairo, 0.45);
    cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
    cairo_set_dash(cairo, NULL, 0, 0.0);
    cairo_stroke(cairo);
}

void wb_shading_draw_field(cairo_t *cairo, const struct wb_layout_panel *layout,
                           const struct wb_series *series)
{
    const struct wb_contour *const contour = &series->contour;
    double(*const points)[2] = wb_memory_new((size_t)contour->n_points, sizeof *points);
    cairo_set_fill_rule(cairo, CAIRO_FILL_RULE_WINDING);
    for (int i = 0; i < contour->n_loops;) {
        const int level = contour->loops[i].level;
        i = trace_level(cairo, layout, contour, i, points);
        wb_typeset_set_colour(cairo, colour_of(&series->colours, level));
        cairo_fill(cairo);
    }
    /* Last, because it hides the edges of the layers. */
    if (contour->n_loops > 0 && contour->loops[0].level == 0) {
        (void)trace_level(cairo, layout, contour, 0, points);
        draw_outline(cairo, series->colours.outline);
    }
    free(points);
}

void wb_shading_draw_bar(cairo_t *cairo, const struct wb_layout_panel *layout)
{
    const struct wb_place_box *const plot = &layout->plot;
    const struct wb_figure_colours *const colours = &layout->panel->colours;
    /* From the lowest colour up, each to the upper end: no seams between them. */
    for (int i = 0; i < colours->n; i++) {
        cairo_rectangle(cairo, plot->x, plot->y, plot->width,
                        plot->height * (colours->n - i) / colours->n);
        wb_typeset_set_colour(cairo, colour_of(colours, i));
        cairo_fill(cairo);
    }
    cairo_set_line_width(cairo, 0.5);
    cairo_set_dash(cairo, NULL, 0, 0.0);
    wb_typeset_set_colour(cairo, wb_palette_grey());
    cairo_rectangle(cairo, plot->x, plot->y, plot->width, plot->height);
    cairo_stroke(cairo);

    struct wb_typeset_style style = wb_layout_tick_style(layout);
    const double right = plot->x + plot->width;
    for (int i = 0; i < layout->y.n_ticks; i++) {
        const double y = wb_layout_y(layout, layout->y.ticks[i]);
        const double height = wb_typeset_measure(cairo, layout->y.labels[i], &style).height;
        cairo_move_to(cairo, right, y);
        cairo_line_to(cairo, right + 2.5, y);
        wb_typeset_set_colour(cairo, wb_palette_grey());
        cairo_stroke(cairo);
        wb_typeset_draw(cairo, right + 4.0, y - 0.5 * height, layout->y.labels[i], &style);
    }
    if (!layout->panel->y_label)
        return;
    /* Above the bar: upright it would take room beside it. */
    style.colour = wb_palette_ink();
    const double height = wb_typeset_measure(cairo, layout->panel->y_label, &style).height;
    wb_typeset_draw(cairo, plot->x, plot->y - height - 3.0, layout->panel->y_label, &style);
}
