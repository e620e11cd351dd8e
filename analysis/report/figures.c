#include "analysis/report/figures.h"

#include <stdlib.h>
#include <string.h>

#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"

const struct wb_figure_style wb_figures_reference_style = {.colour = WB_PALETTE_PALE(0.75),
                                                           .width = 3.6};

/* --- the table --- */

static int count_of(const struct wb_figures_row *row, const void *results)
{
    return row->count ? row->count(results) : 1;
}

static enum wb_status draw_one(struct wb_figures *figures, const struct wb_figures_row *row,
                               const void *results, int index)
{
    struct wb_figures_item item = {.row = row, .results = results, .index = index};
    const enum wb_status status = row->draw(&item);
    if (item.figure)
        figures->items[figures->n++] = item;
    else
        wb_text_release(&item.caption);
    return status;
}

static enum wb_status draw_all(struct wb_figures *figures, const struct wb_figures_row *rows,
                               size_t n_rows, const void *results)
{
    for (size_t first = 0, end; first < n_rows; first = end) {
        const int n = count_of(&rows[first], results);
        for (end = first + 1; end < n_rows && rows[first].count; end++) {
            if (rows[end].count != rows[first].count)
                break;
        }
        for (int index = 0; index < n; index++) {
            for (size_t i = first; i < end; i++)
                WB_TRY(draw_one(figures, &rows[i], results, index));
        }
    }
    return WB_OK;
}

enum wb_status wb_figures_create(struct wb_figures *figures, const struct wb_figures_row *rows,
                                 size_t n_rows, const void *results)
{
    size_t most = 0;
    for (size_t i = 0; i < n_rows; i++)
        most += (size_t)count_of(&rows[i], results);
    *figures = (struct wb_figures){.n = 0};
    figures->items = wb_memory_new(most, sizeof *figures->items);
    const enum wb_status status = draw_all(figures, rows, n_rows, results);
    if (status != WB_OK)
        wb_figures_release(figures);
    return status;
}

void wb_figures_release(struct wb_figures *figures)
{
    for (int i = 0; i < figures->n; i++) {
        wb_figure_destroy(figures->items[i].figure);
        wb_text_release(&figures->items[i].caption);
    }
    free(figures->items);
    memset(figures, 0, sizeof *figures);
}

/* --- in the document --- */

static bool is_at(const struct wb_figures_item *item, const char *place, int index)
{
    return item->index == index && strcmp(item->row->place, place) == 0;
}

bool wb_figures_has(const struct wb_figures *figures, const char *place, int index)
{
    for (int i = 0; i < figures->n; i++) {
        if (is_at(&figures->items[i], place, index))
            return true;
    }
    return false;
}

void wb_figures_put(const struct wb_figures *figures, struct wb_document *document,
                    const char *place, int index)
{
    for (int i = 0; i < figures->n; i++) {
        const struct wb_figures_item *const item = &figures->items[i];
        const struct wb_figures_item *beside = NULL;
        if (!is_at(item, place, index))
            continue;
        if (item->row->half && i + 1 < figures->n && is_at(item + 1, place, index) &&
            item[1].row->half)
            beside = &figures->items[++i];
        wb_document_figures(document, item->figure, wb_text_string(&item->caption),
                            beside ? beside->figure : NULL,
                            beside ? wb_text_string(&beside->caption) : NULL);
    }
}

/* --- common parts of functions that draw --- */

enum wb_status wb_figures_start_simulation(struct wb_figure **figure, const char *name,
                                           double height)
{
    WB_TRY(wb_figure_create(figure, name, WB_PDF_WIDTH, height));
    wb_figure_set_footer(*figure, "simulation, no test");
    return WB_OK;
}

void wb_figures_set_title(struct wb_panel *panel, const char *plain)
{
    struct wb_text title = {0};
    wb_text_append_escaped(&title, plain);
    wb_figure_set_title(panel, wb_text_string(&title));
    wb_text_release(&title);
}

void wb_figures_add_point(struct wb_figures_points *points, double x, double y)
{
    points->x = wb_memory_room(points->x, &points->x_room, points->n + 1, sizeof *points->x);
    points->y = wb_memory_room(points->y, &points->y_room, points->n + 1, sizeof *points->y);
    points->x[points->n] = x;
    points->y[points->n++] = y;
}

void wb_figures_put_points(struct wb_panel *panel, const char *label,
                           struct wb_figures_points *points, const struct wb_figure_style *style)
{
    if (points->n > 0)
        wb_figure_add_line(panel, label, points->n, points->x, points->y, style);
    wb_figures_release_points(points);
}

void wb_figures_release_points(struct wb_figures_points *points)
{
    free(points->x);
    free(points->y);
    *points = (struct wb_figures_points){0};
}

double *wb_figures_scaled(const double *values, int n, double unit)
{
    double *const scaled = wb_memory_new((size_t)n, sizeof *scaled);
    for (int i = 0; i < n; i++)
        scaled[i] = values[i] / unit;
    return scaled;
}

static double *deflections(const struct wb_curve *curve)
{
    double *const mm = wb_memory_new((size_t)curve->n, sizeof *mm);
    for (int i = 0; i < curve->n; i++)
        mm[i] = i * curve->step / WB_MM;
    return mm;
}

void wb_figures_add_curve(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          const double *values, double unit, const struct wb_figure_style *style)
{
    double *const x = deflections(curve);
    double *const y = wb_figures_scaled(values, curve->n, unit);
    wb_figure_add_line(panel, label, (size_t)curve->n, x, y, style);
    free(x);
    free(y);
}

void wb_figures_add_range(struct wb_panel *panel, const char *label, const struct wb_curve *curve,
                          struct wb_colour colour)
{
    if (curve->n_samples < 2)
        return;
    double *const x = deflections(curve);
    double *const low = wb_figures_scaled(curve->low, curve->n, WB_MN);
    double *const high = wb_figures_scaled(curve->high, curve->n, WB_MN);
    const double *const edges[2] = {low, high};
    wb_figure_add_band(panel, label, (size_t)curve->n, x, edges, wb_palette_fade(colour, 0.22));
    free(x);
    free(low);
    free(high);
}
