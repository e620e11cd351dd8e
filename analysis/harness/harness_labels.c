#include "analysis/harness/harness_labels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/text.h"

/* Of a name, points: width of a character and height, as figures set names of small panels. */
static const double character = 4.3, line = 8.5;
static const double mark = 3.0; /* half the width of a mark with its margin, points */

/* What it costs to cover a point of a line, a mark or a name, to leave the panel, and to stand
 * farther from the point. */
static const double cost_of_point = 1.0, cost_of_mark = 30.0, cost_of_name = 1e4,
                    cost_outside = 100.0, cost_of_distance = 0.6;

void wb_harness_labels_release(struct wb_harness_labels *labels)
{
    free(labels->x);
    free(labels->y);
    free(labels->boxes);
    *labels = (struct wb_harness_labels){0};
}

void wb_harness_labels_add_point(struct wb_harness_labels *labels, double x, double y)
{
    labels->x = wb_memory_room(labels->x, &labels->x_room, labels->n_points + 1, sizeof *labels->x);
    labels->y = wb_memory_room(labels->y, &labels->y_room, labels->n_points + 1, sizeof *labels->y);
    labels->x[labels->n_points] = x;
    labels->y[labels->n_points++] = y;
}

static void add_box(struct wb_harness_labels *labels, const struct wb_harness_labels_box *box)
{
    labels->boxes =
        wb_memory_room(labels->boxes, &labels->room, labels->n_boxes + 1, sizeof *labels->boxes);
    labels->boxes[labels->n_boxes++] = *box;
}

void wb_harness_labels_add_mark(struct wb_harness_labels *labels, double x, double y)
{
    const double half = mark * labels->scale;
    const struct wb_harness_labels_box box = {{x - half, y - half}, {x + half, y + half}, false};
    add_box(labels, &box);
}

static bool overlap(const struct wb_harness_labels_box *a, const struct wb_harness_labels_box *b)
{
    return a->low[0] < b->high[0] && b->low[0] < a->high[0] && a->low[1] < b->high[1] &&
           b->low[1] < a->high[1];
}

static double cost_of(const struct wb_harness_labels *labels,
                      const struct wb_harness_labels_box *box)
{
    double cost = 0.0;
    for (int k = 0; k < 2; k++)
        cost += box->low[k] < labels->panel.low[k] || box->high[k] > labels->panel.high[k]
                    ? cost_outside
                    : 0.0;
    for (size_t i = 0; i < labels->n_points; i++)
        cost += labels->x[i] > box->low[0] && labels->x[i] < box->high[0] &&
                        labels->y[i] > box->low[1] && labels->y[i] < box->high[1]
                    ? cost_of_point
                    : 0.0;
    for (size_t i = 0; i < labels->n_boxes; i++) {
        if (overlap(box, &labels->boxes[i]))
            cost += labels->boxes[i].is_name ? cost_of_name : cost_of_mark;
    }
    return cost;
}

/* Around the point: a direction, and which end of the text is nearer to it. */
struct candidate {
    double x, y;
    int side;
};

static struct wb_harness_labels_box box_at(double x, double y, int side, double width,
                                           double height)
{
    const double left = side < 0 ? x : side > 0 ? x - width : x - 0.5 * width;
    return (struct wb_harness_labels_box){
        {left, y - 0.5 * height}, {left + width, y + 0.5 * height}, true};
}

static void add_leader(const struct wb_harness_labels *labels, struct wb_panel *panel, double x,
                       double y, const struct wb_harness_labels_box *box)
{
    static const double nearest = 8.0; /* points: of names that need none */
    const struct wb_figure_style style = {.colour = wb_palette_fade(wb_palette_grey(), 0.6),
                                          .width = 0.4};
    const double end[2] = {fmin(fmax(x, box->low[0]), box->high[0]),
                           fmin(fmax(y, box->low[1]), box->high[1])};
    const double xs[2] = {x, end[0]}, ys[2] = {y, end[1]};
    if (hypot(end[0] - x, end[1] - y) > nearest * labels->scale)
        wb_figure_add_line(panel, NULL, 2, xs, ys, &style);
}

bool wb_harness_labels_put(struct wb_harness_labels *labels, struct wb_panel *panel, double x,
                           double y, const char *plain, bool is_italic)
{
    static const struct candidate candidates[] = {{1, 0.7, -1},  {-1, 0.7, 1}, {1, -0.7, -1},
                                                  {-1, -0.7, 1}, {0, 1, 0},    {0, -1, 0},
                                                  {1, 0, -1},    {-1, 0, 1}};
    const double width = character * (double)strlen(plain) * labels->scale;
    const double height = line * labels->scale;
    double least = cost_of_name, at[2] = {x, y};
    int side = -1;
    struct wb_harness_labels_box best = {{0}, {0}, true};
    for (int ring = 0; ring < 3; ring++) {
        const double way = (5.0 + 9.0 * ring) * labels->scale;
        for (size_t i = 0; i < sizeof candidates / sizeof candidates[0]; i++) {
            const struct candidate *const c = &candidates[i];
            const double cx = x + way * c->x, cy = y + fmax(way, 0.9 * height) * c->y;
            const struct wb_harness_labels_box box = box_at(cx, cy, c->side, width, height);
            const double cost = cost_of(labels, &box) + cost_of_distance * (8.0 * ring + (double)i);
            if (cost >= least)
                continue;
            least = cost;
            at[0] = cx;
            at[1] = cy;
            side = c->side;
            best = box;
        }
    }
    if (least >= cost_of_name)
        return false;
    struct wb_text text = {0};
    wb_text_append(&text, is_italic ? "<i>" : "");
    wb_text_append_escaped(&text, plain);
    wb_text_append(&text, is_italic ? "</i>" : "");
    add_leader(labels, panel, x, y, &best);
    wb_figure_add_text(panel, at[0], at[1], side, wb_text_string(&text));
    wb_text_release(&text);
    add_box(labels, &best);
    return true;
}
