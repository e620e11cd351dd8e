#include "live/live_chart.h"

#include <math.h>

#include "base/units.h"

/* A limit beyond the data by a larger factor is not shown, because it would compress the curve. */
#define NEAR_LIMIT 1.4
#define NO_CYCLE (-1)

/* Range of the data, m and N. */
struct extent {
    double deflection, lowest, force;
};

static void extend_by_points(struct extent *extent, const struct wb_live_frame_point *points,
                             size_t n)
{
    for (size_t i = 0; i < n; i++) {
        extent->deflection = fmax(extent->deflection, (double)points[i].deflection);
        extent->lowest = fmin(extent->lowest, (double)points[i].force);
        extent->force = fmax(extent->force, (double)points[i].force);
    }
}

void wb_live_chart_range(struct wb_live_chart *chart, const struct wb_live_plan *plan,
                         const struct wb_live_history *history)
{
    struct extent extent = {.deflection = plan->travel};
    extend_by_points(&extent, history->points, history->n_points);
    extend_by_points(&extent, plan->earlier, plan->n_earlier);
    double deflection = extent.deflection, force = extent.force;
    for (int i = 0; i < plan->n_predicted; i++)
        force = fmax(force, plan->tension[i]);
    if (!(force > 0.0))
        force = plan->force_limit > 0.0 ? plan->force_limit : 1.0 * WB_MN;
    chart->shows_force_limit = plan->force_limit > 0.0 && plan->force_limit <= NEAR_LIMIT * force;
    if (chart->shows_force_limit)
        force = fmax(force, plan->force_limit);
    if (plan->travel_limit > 0.0 && plan->travel_limit <= NEAR_LIMIT * deflection)
        deflection = fmax(deflection, plan->travel_limit);
    wb_scale_fit(&chart->deflection, 0.0, deflection / WB_MM, false);
    wb_scale_fit(&chart->force, extent.lowest / WB_MN, force / WB_MN, false);
    wb_scale_place_ticks(&chart->deflection, 7);
    wb_scale_place_ticks(&chart->force, 6);
}

static void find_dot(const struct wb_live_chart *chart, const struct wb_live_raster *raster,
                     double deflection, double force, double dot[2])
{
    dot[0] = wb_scale_position(&chart->deflection, deflection / WB_MM) * (raster->width - 1);
    dot[1] = wb_scale_position(&chart->force, force / WB_MN) * (raster->height - 1);
}

static void draw_limits(const struct wb_live_chart *chart, const struct wb_live_plan *plan,
                        struct wb_live_raster *raster)
{
    double from[2], to[2];
    if (chart->shows_force_limit) {
        find_dot(chart, raster, 0.0, plan->force_limit, from);
        to[0] = raster->width - 1;
        to[1] = from[1];
        wb_live_raster_line(raster, from, to, WB_LIVE_RASTER_LIMIT, 3);
    }
    if (plan->travel_limit > 0.0) {
        find_dot(chart, raster, plan->travel_limit, 0.0, from);
        from[1] = 0.0;
        to[0] = from[0];
        to[1] = raster->height - 1;
        wb_live_raster_line(raster, from, to, WB_LIVE_RASTER_LIMIT, 3);
    }
}

/* Draws a curve per number (cycle or test) of the points; that of `bright` is highlighted. */
static void draw_points(const struct wb_live_chart *chart, struct wb_live_raster *raster,
                        const struct wb_live_frame_point *points, size_t n, int bright)
{
    double before[2] = {0.0, 0.0}, dot[2];
    for (size_t i = 0; i < n; i++) {
        const struct wb_live_frame_point *const point = &points[i];
        find_dot(chart, raster, (double)point->deflection, (double)point->force, dot);
        if (i > 0 && points[i - 1].cycle == point->cycle)
            wb_live_raster_line(
                raster, before, dot,
                point->cycle == bright ? WB_LIVE_RASTER_NOW : WB_LIVE_RASTER_EARLIER, 1);
        before[0] = dot[0];
        before[1] = dot[1];
    }
}

void wb_live_chart_draw(const struct wb_live_chart *chart, const struct wb_live_plan *plan,
                        const struct wb_live_history *history, struct wb_live_raster *raster)
{
    double before[2], dot[2];
    const int cycle = history->n_points > 0 ? history->points[history->n_points - 1].cycle : 0;
    draw_limits(chart, plan, raster);
    for (int i = 0; i < plan->n_predicted; i++) {
        find_dot(chart, raster, plan->deflection[i], plan->tension[i], dot);
        if (i > 0)
            wb_live_raster_line(raster, before, dot, WB_LIVE_RASTER_PREDICTED, 2);
        before[0] = dot[0];
        before[1] = dot[1];
    }
    draw_points(chart, raster, plan->earlier, plan->n_earlier, NO_CYCLE);
    draw_points(chart, raster, history->points, history->n_points, cycle);
}

void wb_live_chart_wire(const struct wb_live_plan *plan, const struct wb_live_frame *frame,
                        struct wb_live_raster *raster, double place[WB_SPECIMEN_MAX_MARKERS][2])
{
    /* Space for the travel of the tip, and some below for the sag of the wire. */
    const double below = 0.05 * plan->length;
    const double scale = fmin((raster->width - 3) / plan->length,
                              (raster->height - 2) / (plan->travel + 2.0 * below));
    const double clamp[2] = {0.0, scale * below};
    const double wall[2][2] = {{0.0, clamp[1] - 4.0}, {0.0, clamp[1] + 4.0}};
    wb_live_raster_line(raster, wall[0], wall[1], WB_LIVE_RASTER_EARLIER, 1);
    for (int i = 0; i < frame->n_markers; i++) {
        place[i][0] = 1.0 + scale * (double)frame->marker[i][0];
        place[i][1] = scale * (below + (double)frame->marker[i][1]);
        if (i > 0)
            wb_live_raster_line(raster, place[i - 1], place[i], WB_LIVE_RASTER_NOW, 1);
    }
}
