/* The figures of a report of a harness. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_drawing.h"
#include "analysis/report/harnesses/harnesses_kind.h"
#include "analysis/report/pages.h"
#include "analysis/report/pdf.h"
#include "base/memory.h"
#include "base/units.h"

#define HALF_HEIGHT 190.0 /* points, of perspectives */
#define WHOLE_HEIGHT 235.0
#define CURVE_HEIGHT 145.0

enum {
    MOST_NAMES = 16, /* on a y axis */
    FIGURE_NAME = 64
};

static int count_steps(const void *context)
{
    const struct wb_harnesses_results *const results = context;
    return results->set.n_steps;
}

static int count_branches(const void *context)
{
    const struct wb_harnesses_results *const results = context;
    return results->campaign->plan->n_branches;
}

/* --- shapes --- */

static enum wb_status start(struct wb_figure **figure, const char *name, double width,
                            double height)
{
    WB_TRY(wb_figure_create(figure, name, width, height));
    wb_figure_set_footer(*figure, "simulation, no test");
    return WB_OK;
}

static enum wb_status draw_views(struct wb_figure **figure, const char *name,
                                 const struct wb_harness_drawing *drawing)
{
    WB_TRY(start(figure, name, WB_PDF_WIDTH, wb_harness_drawing_height(drawing, WB_PDF_WIDTH)));
    wb_harness_drawing_add_views(drawing, *figure, WB_PDF_WIDTH);
    return WB_OK;
}

static enum wb_status draw_perspective(struct wb_figure **figure, const char *name,
                                       const struct wb_harness_drawing *drawing, double width)
{
    WB_TRY(start(figure, name, width, width > WB_PDF_HALF_WIDTH ? WHOLE_HEIGHT : HALF_HEIGHT));
    wb_harness_drawing_add_perspective(drawing, *figure, width);
    return WB_OK;
}

static enum wb_status draw_found(struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    struct wb_harness_drawing drawing;
    wb_harness_drawing_of_steps(&drawing, &results->set);
    wb_text_append(&item->caption, "The harness in perspective: free of stress, mounted, and, "
                                   "where the file takes it off, afterwards.");
    return draw_perspective(&item->figure, "harness", &drawing, WB_PDF_HALF_WIDTH);
}

static void append_step_name(struct wb_text *text, const struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    wb_text_append(text, "Step %d, ", item->index + 1);
    wb_text_append_escaped(text, results->campaign->plan->steps[item->index].name);
}

/* The drawing of a step, the name of its figure, and the beginning of the caption. */
static void begin_step(struct wb_figures_item *item, struct wb_harness_drawing *drawing,
                       char name[FIGURE_NAME], const char *suffix)
{
    const struct wb_harnesses_results *const results = item->results;
    snprintf(name, FIGURE_NAME, "step-%d%s", item->index + 1, suffix);
    wb_harness_drawing_of_step(drawing, &results->set, item->index);
    append_step_name(&item->caption, item);
}

static enum wb_status draw_step(struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    struct wb_harness_drawing drawing;
    char name[FIGURE_NAME];
    begin_step(item, &drawing, name, "");
    wb_text_append(&item->caption,
                   ". Line: the shape after it. Dashed: %s. Marks: diamond root, squares "
                   "connectors, circles clips; pale ones are free%s.",
                   item->index == 0 ? "the stress-free shape" : "the shape before it",
                   results->found.n_limits > 0 ? ", red ones exceed a limit" : "");
    return draw_views(&item->figure, name, &drawing);
}

static enum wb_status draw_step_perspective(struct wb_figures_item *item)
{
    struct wb_harness_drawing drawing;
    char name[FIGURE_NAME];
    begin_step(item, &drawing, name, "-perspective");
    wb_text_append(&item->caption, ", in perspective, with the shadow on a floor.");
    return draw_perspective(&item->figure, name, &drawing, WB_PDF_HALF_WIDTH);
}

static enum wb_status draw_residual(struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    struct wb_harness_drawing drawing;
    if (!results->found.is_taken_off)
        return WB_OK;
    wb_harness_drawing_of_residual(&drawing, &results->set, results->found.residual.step);
    wb_text_append(&item->caption,
                   "Residual shape (line) over the stress-free shape before (dashed), both held at "
                   "the root and without weight; dotted: the largest distance between them.");
    return draw_views(&item->figure, "residual", &drawing);
}

static enum wb_status draw_residual_perspective(struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    struct wb_harness_drawing drawing;
    if (!results->found.is_taken_off)
        return WB_OK;
    wb_harness_drawing_of_residual(&drawing, &results->set, results->found.residual.step);
    wb_text_append(&item->caption, "The residual shape in perspective.");
    return draw_perspective(&item->figure, "residual-perspective", &drawing, WB_PDF_WIDTH);
}

/* --- forces --- */

/* Forces of an item after a step, or the largest ones of all steps; NAN: there is none. */
struct values {
    double at_end, largest, elastic, limit;
};

static struct values values_of(const struct wb_harnesses_results *results, int step, int item)
{
    const double limit = results->campaign->plan->items[item].largest_force;
    struct values values = {.at_end = (double)NAN, .limit = limit > 0.0 ? limit : (double)NAN};
    struct wb_harness_extreme force, moment;
    if (step >= 0) {
        values.at_end = results->set.results[step].forces[item].size;
        values.largest = results->set.results[step].forces[item].largest;
        values.elastic = wb_harnesses_elastic_force(results, step, item);
        return values;
    }
    wb_harness_found_largest(&results->set, item, &force, &moment);
    values.largest = force.value;
    values.elastic = wb_harnesses_elastic_largest(results, item);
    return values;
}

static void add_value(struct wb_figures_points *points, double value, int row)
{
    if (isfinite(value))
        wb_figures_add_point(points, value, row);
}

static bool is_shown(const struct wb_harnesses_results *results, int step, int item)
{
    return step < 0 || results->set.results[step].forces[item].is_mounted;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* The largest force that is not shown, N, where there are more items than names; -1: all are. */
static double largest_hidden(const struct wb_harnesses_results *results, int step)
{
    const int n_items = results->campaign->plan->n_items;
    double *const sizes = wb_memory_new((size_t)n_items, sizeof *sizes);
    int n = 0;
    for (int k = 0; k < n_items; k++) {
        if (is_shown(results, step, k))
            sizes[n++] = values_of(results, step, k).largest;
    }
    qsort(sizes, (size_t)n, sizeof *sizes, by_size);
    const double hidden = n > MOST_NAMES ? sizes[MOST_NAMES] : -1.0;
    free(sizes);
    return hidden;
}

/* `step` -1: the largest forces of all steps. */
static void add_forces(struct wb_panel *panel, const struct wb_harnesses_results *results, int step)
{
    const struct wb_harness_plan *const plan = results->campaign->plan;
    const struct wb_figure_style end = {
        .colour = wb_palette_wire(0), .marker = WB_MARKER_CIRCLE, .marker_size = 5.0};
    const struct wb_figure_style most = {
        .colour = wb_palette_wire(0), .marker = WB_MARKER_RING, .marker_size = 7.0};
    const struct wb_figure_style grey = {
        .colour = wb_palette_grey(), .marker = WB_MARKER_DIAMOND, .marker_size = 5.0};
    const struct wb_figure_style red = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_TRIANGLE, .marker_size = 6.0};
    struct wb_figures_points at_end = {0}, largest = {0}, elastic = {0}, limit = {0};
    const double hidden = largest_hidden(results, step);
    const char *names[MOST_NAMES];
    int n = 0;
    for (int k = plan->n_items - 1; k >= 0 && n < MOST_NAMES; k--) {
        const struct values values = values_of(results, step, k);
        if (!is_shown(results, step, k) || values.largest <= hidden)
            continue;
        add_value(&at_end, values.at_end, n);
        add_value(&largest, values.largest, n);
        add_value(&elastic, values.elastic, n);
        add_value(&limit, values.limit, n);
        names[n++] = plan->items[k].name;
    }
    wb_figure_set_axes(panel, "Force (N)", NULL);
    wb_figure_set_y_names(panel, n, names);
    wb_figure_set_x_range(panel, 0.0, (double)NAN);
    wb_figure_set_y_range(panel, -0.7, n - 0.3);
    wb_figures_put_points(panel, "limit", &limit, &red);
    wb_figures_put_points(panel, step < 0 ? "largest, elastic" : "at the end, elastic", &elastic,
                          &grey);
    wb_figures_put_points(panel, "largest", &largest, &most);
    wb_figures_put_points(panel, "at the end", &at_end, &end);
}

static void append_hidden(struct wb_text *text, const struct wb_harnesses_results *results,
                          int step)
{
    if (largest_hidden(results, step) >= 0.0)
        wb_text_append(text, " The table has all; here are those with the largest forces.");
}

static enum wb_status draw_largest(struct wb_figures_item *item)
{
    WB_TRY(start(&item->figure, "forces", WB_PDF_HALF_WIDTH, HALF_HEIGHT));
    add_forces(wb_figure_add_panel(item->figure), item->results, -1);
    wb_text_append(&item->caption, "Largest force on the wire during all steps, with the laws of "
                                   "the wires and with elastic wires.");
    append_hidden(&item->caption, item->results, -1);
    return WB_OK;
}

static enum wb_status draw_forces(struct wb_figures_item *item)
{
    char name[64];
    snprintf(name, sizeof name, "step-%d-forces", item->index + 1);
    WB_TRY(start(&item->figure, name, WB_PDF_HALF_WIDTH, HALF_HEIGHT));
    add_forces(wb_figure_add_panel(item->figure), item->results, item->index);
    append_step_name(&item->caption, item);
    wb_text_append(&item->caption, ": forces on what is mounted.");
    append_hidden(&item->caption, item->results, item->index);
    return WB_OK;
}

/* --- curvature along a branch --- */

/* The curve of a branch after a step, or of the stress-free shape; `radius`: its bend radius. */
static void add_curve(struct wb_panel *panel, const char *label,
                      const struct wb_harness_result_set *set,
                      const struct wb_harness_place *places, int branch, bool radius,
                      const struct wb_figure_style *style)
{
    static const double straight = 1e-3; /* 1/m: no radius is drawn */
    struct wb_figures_points points = {0};
    struct wb_text escaped = {0};
    for (int i = 0; i < set->n_places; i++) {
        const double curvature = places[i].curvature;
        if (places[i].branch == branch && (!radius || curvature > straight))
            wb_figures_add_point(&points, places[i].s / WB_MM,
                                 radius ? 1.0 / curvature / WB_MM : curvature);
    }
    if (label)
        wb_text_append_escaped(&escaped, label);
    wb_figures_put_points(panel, label ? wb_text_string(&escaped) : NULL, &points, style);
    wb_text_release(&escaped);
}

static void add_level(struct wb_panel *panel, const char *label, double length, double level,
                      const struct wb_figure_style *style)
{
    const double x[2] = {0.0, length / WB_MM}, y[2] = {level, level};
    wb_figure_add_line(panel, label, 2, x, y, style);
}

/* The steps that are drawn with a colour of their own: that of the least radius, and the last. */
static void add_steps(struct wb_panel *panel, const struct wb_harness_result_set *set, int branch,
                      bool radius, bool has_legend)
{
    const struct wb_figure_style other = {.colour = wb_palette_fade(wb_palette_grey(), 0.45),
                                          .width = 0.8};
    const struct wb_figure_style tightest = {.colour = wb_palette_wire(0), .width = 1.6};
    const struct wb_figure_style end = {
        .colour = wb_palette_wire(1), .width = 1.2, .dash = WB_DASH_DASHED};
    const int last = set->n_steps - 1, least = wb_harness_found_radius(set, branch).step;
    const char *label = has_legend ? "other steps" : NULL;
    char name[120];
    for (int i = 0; i < last; i++) {
        if (i == least)
            continue;
        add_curve(panel, label, set, set->results[i].places, branch, radius, &other);
        label = NULL;
    }
    snprintf(name, sizeof name, "%d, %s", least + 1, set->plan->steps[least].name);
    add_curve(panel, has_legend ? name : NULL, set, set->results[least].places, branch, radius,
              &tightest);
    if (last == least)
        return;
    snprintf(name, sizeof name, "%d, %s", last + 1, set->plan->steps[last].name);
    add_curve(panel, has_legend ? name : NULL, set, set->results[last].places, branch, radius,
              &end);
}

static void add_radius_panel(struct wb_figure *figure, const struct wb_harness_result_set *set,
                             int branch)
{
    static const double largest = 1.0; /* m; the wire is nearly straight beyond */
    const struct wb_harness_plan_branch *const of = &set->plan->branches[branch];
    const struct wb_figure_style limit = {
        .colour = wb_palette_warning(), .width = 1.0, .dash = WB_DASH_DOTTED};
    const double least = fmin(wb_harness_found_radius(set, branch).value, 0.5 * largest);
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_axes(panel, "<i>s</i> (mm)", "Bend radius (mm)");
    wb_figure_set_logarithmic_y(panel);
    wb_figure_set_x_range(panel, 0.0, of->length / WB_MM);
    wb_figure_set_y_range(
        panel, 0.8 * (of->least_radius > 0.0 ? fmin(least, of->least_radius) : least) / WB_MM,
        largest / WB_MM);
    add_steps(panel, set, branch, true, false);
    if (of->least_radius > 0.0)
        add_level(panel, "limit", of->length, of->least_radius / WB_MM, &limit);
}

static enum wb_status draw_branch(struct wb_figures_item *item)
{
    const struct wb_harnesses_results *const results = item->results;
    const struct wb_harness_result_set *const set = &results->set;
    const struct wb_harness_plan_branch *const branch = &set->plan->branches[item->index];
    const double range = set->plan->wires[branch->wire].largest_curvature;
    const struct wb_figure_style calibrated = {
        .colour = wb_palette_warning(), .width = 1.0, .dash = WB_DASH_DOTTED};
    char name[64];
    snprintf(name, sizeof name, "branch-%d", item->index + 1);
    WB_TRY(wb_figures_start_simulation(&item->figure, name, CURVE_HEIGHT));
    struct wb_panel *const panel = wb_figure_add_panel(item->figure);
    wb_figure_set_axes(panel, "<i>s</i> (mm)", "Curvature (1/m)");
    wb_figure_set_x_range(panel, 0.0, branch->length / WB_MM);
    wb_figure_set_y_range(panel, 0.0, (double)NAN);
    add_steps(panel, set, item->index, false, true);
    if (isfinite(range) && branch->n_curve == 0)
        add_level(panel, "calibrated to", branch->length, range, &calibrated);
    add_radius_panel(item->figure, set, item->index);
    wb_text_append(&item->caption, "Branch ");
    wb_text_append_escaped(&item->caption, branch->name);
    wb_text_append(&item->caption,
                   ": curvature and bend radius along it from its beginning, at the ends of the "
                   "steps; in colour the step of the least radius and the last one.");
    return WB_OK;
}

const struct wb_figures_row wb_harnesses_figures[WB_HARNESSES_FIGURES] = {
    {.place = "found", .draw = draw_found, .half = true},
    {.place = "found", .draw = draw_largest, .half = true},
    {.place = "step", .count = count_steps, .draw = draw_step},
    {.place = "step", .count = count_steps, .draw = draw_step_perspective, .half = true},
    {.place = "step", .count = count_steps, .draw = draw_forces, .half = true},
    {.place = "branch", .count = count_branches, .draw = draw_branch},
    {.place = "residual", .draw = draw_residual},
    {.place = "residual", .draw = draw_residual_perspective},
};
