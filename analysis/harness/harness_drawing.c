#include "analysis/harness/harness_drawing.h"

#include <math.h>
#include <stdio.h>

#include "analysis/plot/figure.h"
#include "base/memory.h"
#include "base/units.h"

#define WIDTH 760.0 /* points */
#define HEIGHT 340.0
#define PNG_SCALE 2.5

enum {
    VIEWS = 3
};

/* The two axes of space that a view shows. */
static const struct view {
    const char *title, *labels[2];
    int axes[2];
} views[VIEWS] = {
    {"From the side", {"<i>x</i> (mm)", "<i>z</i> (mm)"}, {0, 2}},
    {"From above", {"<i>x</i> (mm)", "<i>y</i> (mm)"}, {0, 1}},
    {"From the front", {"<i>y</i> (mm)", "<i>z</i> (mm)"}, {1, 2}},
};

/* The last step in which the harness is mounted, and the one in which it was taken off; -1: none.
 */
static void find_steps(const struct wb_harness_result_set *set, int *mounted, int *off)
{
    *off = *mounted = -1;
    for (int i = 0; i < set->n_steps; i++)
        *(set->plan->steps[i].kind == WB_HARNESS_TAKE_OFF ? off : mounted) = i;
}

static void add_shape(struct wb_panel *panel, const struct view *view, const char *label,
                      const struct wb_harness_result_set *set,
                      const struct wb_harness_place *places, const struct wb_figure_style *style)
{
    struct wb_memory memory = {0};
    const size_t most = 2 * (size_t)set->n_places;
    double *const x = wb_memory_take(&memory, most, sizeof *x);
    double *const y = wb_memory_take(&memory, most, sizeof *y);
    size_t n = 0;
    for (int i = 0; i < set->n_places; i++) {
        if (i > 0 && places[i].branch != places[i - 1].branch)
            x[n] = y[n] = (double)NAN, n++;
        x[n] = places[i].position[view->axes[0]] / WB_MM;
        y[n++] = places[i].position[view->axes[1]] / WB_MM;
    }
    wb_figure_add_line(panel, label, n, x, y, style);
    wb_memory_release(&memory);
}

/* The place of an item in a shape; the nearest along its branch. */
static const struct wb_harness_place *place_of(const struct wb_harness_result_set *set,
                                               const struct wb_harness_place *places,
                                               const struct wb_harness_item *item)
{
    const int branch = item->branch < 0 ? 0 : item->branch;
    int best = 0;
    double nearest = (double)INFINITY;
    for (int i = 0; i < set->n_places; i++) {
        if (places[i].branch == branch && fabs(places[i].s - item->at) < nearest) {
            nearest = fabs(places[i].s - item->at);
            best = i;
        }
    }
    return &places[best];
}

static void add_items(struct wb_panel *panel, const struct view *view,
                      const struct wb_harness_result_set *set, int step)
{
    static const enum wb_figure_marker markers[] = {
        [WB_HARNESS_ROOT] = WB_MARKER_DIAMOND,
        [WB_HARNESS_CONNECTOR] = WB_MARKER_SQUARE,
        [WB_HARNESS_CLIP] = WB_MARKER_CIRCLE,
    };
    for (int i = 0; i < set->plan->n_items; i++) {
        const struct wb_harness_item *const item = &set->plan->items[i];
        const struct wb_harness_place *const place = place_of(set, set->results[step].places, item);
        const double x = place->position[view->axes[0]] / WB_MM;
        const double y = place->position[view->axes[1]] / WB_MM;
        const struct wb_figure_style style = {
            .colour = wb_palette_ink(), .marker = markers[item->kind], .marker_size = 4.5};
        char label[WB_HARNESS_NAME + 2];
        wb_figure_add_line(panel, NULL, 1, &x, &y, &style);
        snprintf(label, sizeof label, " %s", item->name);
        wb_figure_add_text(panel, x, y, -1, label);
    }
}

static void add_view(struct wb_figure *figure, const struct view *view,
                     const struct wb_harness_result_set *set, bool has_legend)
{
    const struct wb_figure_style natural = {
        .colour = wb_palette_grey(), .width = 0.8, .dash = WB_DASH_DASHED};
    const struct wb_figure_style mounted = {.colour = wb_palette_wire(0), .width = 1.6};
    const struct wb_figure_style remaining = {.colour = wb_palette_warning(), .width = 1.1};
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    int step, off;
    find_steps(set, &step, &off);
    wb_figure_set_title(panel, view->title);
    wb_figure_set_axes(panel, view->labels[0], view->labels[1]);
    wb_figure_set_equal_aspect(panel);
    add_shape(panel, view, has_legend ? "free of stress" : NULL, set, set->natural, &natural);
    if (off >= 0)
        add_shape(panel, view, has_legend ? "taken off" : NULL, set, set->results[off].places,
                  &remaining);
    if (step < 0)
        return;
    add_shape(panel, view, has_legend ? set->plan->steps[step].name : NULL, set,
              set->results[step].places, &mounted);
    add_items(panel, view, set, step);
}

enum wb_status wb_harness_drawing_write(const struct wb_harness_result_set *set, const char *path)
{
    struct wb_figure *figure;
    char footer[160];
    WB_TRY(wb_figure_create(&figure, "harness", WIDTH, HEIGHT));
    for (int i = 0; i < VIEWS; i++)
        add_view(figure, &views[i], set, i == 0);
    snprintf(footer, sizeof footer, "%s: simulation, %s", set->plan->name,
             set->settings.is_elastic ? "elastic" : "elastoplastic");
    wb_figure_set_footer(figure, footer);
    const enum wb_status status = wb_figure_write_file(figure, PNG_SCALE, path);
    wb_figure_destroy(figure);
    return status;
}
