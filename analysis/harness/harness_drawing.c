#include "analysis/harness/harness_drawing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/harness/harness_found.h"
#include "analysis/harness/harness_labels.h"
#include "analysis/plot/view.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/units.h"
#include "base/vec3.h"

#define WIDTH 1000.0 /* points, of a figure with all panels */
#define PERSPECTIVE 280.0
#define PNG_SCALE 2.5

/* Points of a panel beside its plot: axes with numbers and labels, title, footer of the figure. */
#define BESIDE 48.0
#define ABOVE 52.0
#define GAP 10.0 /* between panels */

enum {
    VIEWS = 3
};

/* Distance of the eye from the middle over half the diagonal of all that is shown. */
static const double eye_distance = 4.0;
static const struct wb_view_camera camera = {.toward = {0.45, -0.80, 0.40}, .up = {0.0, 0.0, 1.0}};

/* How places in space become points of a panel, mm. */
struct view {
    const char *title, *labels[2];
    int axes[2]; /* of space, that a parallel view shows */
    bool is_perspective;
    double low[3], high[3]; /* of all that is shown, m */
    double middle[3];       /* of a perspective: what the eye looks at, m */
    double distance;        /* of the eye from it, m */
    double grid;            /* between the lines on its floor, m */
    double width, height;   /* of the panel's plot, points */
};

static const struct view parallel_views[VIEWS] = {
    {"Side view", {"<i>x</i> (mm)", "<i>z</i> (mm)"}, .axes = {0, 2}},
    {"Top view", {"<i>x</i> (mm)", "<i>y</i> (mm)"}, .axes = {0, 1}},
    {"Front view", {"<i>y</i> (mm)", "<i>z</i> (mm)"}, .axes = {1, 2}},
};

static void project(const struct view *view, const double place[3], double *x, double *y)
{
    double from[3], seen[3];
    *x = place[view->axes[0]] / WB_MM;
    *y = place[view->axes[1]] / WB_MM;
    if (!view->is_perspective)
        return;
    for (int k = 0; k < 3; k++)
        from[k] = place[k] - view->middle[k];
    wb_view_project(&camera, from, seen);
    const double scale = view->distance / (view->distance - seen[2]);
    *x = scale * seen[0] / WB_MM;
    *y = scale * seen[1] / WB_MM;
}

/* --- lines --- */

/* A line through places in space; starts zeroed. */
struct path {
    size_t n, x_room, y_room;
    double *x, *y;
};

static void add_point(struct path *path, double x, double y)
{
    path->x = wb_memory_room(path->x, &path->x_room, path->n + 1, sizeof *path->x);
    path->y = wb_memory_room(path->y, &path->y_room, path->n + 1, sizeof *path->y);
    path->x[path->n] = x;
    path->y[path->n++] = y;
}

static void add_place(struct path *path, const struct view *view, const double place[3])
{
    double x, y;
    project(view, place, &x, &y);
    add_point(path, x, y);
}

/* A piece between two places that is not joined to the one before. */
static void add_piece(struct path *path, const struct view *view, const double from[3],
                      const double to[3])
{
    add_place(path, view, from);
    add_place(path, view, to);
    add_point(path, (double)NAN, (double)NAN);
}

/* Adds the line to a panel and empties it. */
static void put_path(struct path *path, struct wb_panel *panel, const char *label,
                     const struct wb_figure_style *style)
{
    if (path->n > 0)
        wb_figure_add_line(panel, label, path->n, path->x, path->y, style);
    free(path->x);
    free(path->y);
    *path = (struct path){0};
}

static double thickest_wire(const struct wb_harness_plan *plan)
{
    double thickest = 0.0;
    for (int i = 0; i < plan->n_branches; i++)
        thickest = fmax(thickest, plan->wires[plan->branches[i].wire].diameter);
    return thickest;
}

/* Each branch as a line, thicker for thicker wires; `floor`: its height, m, of a shadow; NAN: the
 * shape itself. */
static void add_shape(struct wb_panel *panel, const struct view *view,
                      const struct wb_harness_result_set *set,
                      const struct wb_harness_drawing_shape *shape, double floor)
{
    const struct wb_harness_plan *const plan = set->plan;
    struct wb_text label = {0};
    if (shape->label)
        wb_text_append_escaped(&label, shape->label);
    for (int i = 0; i < set->n_places;) {
        const int branch = shape->places[i].branch;
        const double diameter = plan->wires[plan->branches[branch].wire].diameter;
        struct wb_figure_style style = shape->style;
        struct path path = {0};
        style.width *= sqrt(diameter / thickest_wire(plan));
        for (; i < set->n_places && shape->places[i].branch == branch; i++) {
            const double *const at = shape->places[i].position;
            const double place[3] = {at[0], at[1], isnan(floor) ? at[2] : floor};
            add_place(&path, view, place);
        }
        put_path(&path, panel, label.length > 0 ? wb_text_string(&label) : NULL, &style);
        wb_text_release(&label); /* once in the legend */
    }
    wb_text_release(&label);
}

/* --- items --- */

/* The place in a shape that is nearest along a branch; -1: the root. */
static const struct wb_harness_place *place_of(const struct wb_harness_result_set *set,
                                               const struct wb_harness_place *places, int branch,
                                               double at)
{
    const int own = branch < 0 ? 0 : branch;
    int best = 0;
    double nearest = (double)INFINITY;
    for (int i = 0; i < set->n_places; i++) {
        if (places[i].branch == own && fabs(places[i].s - at) < nearest) {
            nearest = fabs(places[i].s - at);
            best = i;
        }
    }
    return &places[best];
}

/* Where an item is in the last shape. */
static const double *position_of(const struct wb_harness_drawing *drawing, int item)
{
    const struct wb_harness_result_set *const set = drawing->set;
    const double at = wb_harness_run_place(
        set->plan, drawing->step < 0 ? NULL : set->results[drawing->step].forces, item);
    return place_of(set, drawing->shapes[drawing->n_shapes - 1].places,
                    set->plan->items[item].branch, at)
        ->position;
}

static struct wb_figure_style style_of_item(const struct wb_harness_drawing *drawing, int item)
{
    static const enum wb_figure_marker markers[] = {
        [WB_HARNESS_ROOT] = WB_MARKER_DIAMOND,
        [WB_HARNESS_CONNECTOR] = WB_MARKER_SQUARE,
        [WB_HARNESS_CLIP] = WB_MARKER_CIRCLE,
    };
    struct wb_figure_style style = {
        .colour = wb_palette_ink(),
        .marker = markers[drawing->set->plan->items[item].kind],
        .marker_size = 4.5,
    };
    if (drawing->step < 0)
        return style;
    const struct wb_harness_force *const force = &drawing->set->results[drawing->step].forces[item];
    if (!force->is_mounted)
        style.colour = wb_palette_fade(wb_palette_grey(), 0.6);
    else if (force->exceeds_force || force->exceeds_moment)
        style.colour = wb_palette_warning();
    return style;
}

static void add_items(struct wb_panel *panel, const struct view *view,
                      const struct wb_harness_drawing *drawing, struct wb_harness_labels *labels)
{
    const struct wb_harness_result_set *const set = drawing->set;
    const struct wb_harness_plan *const plan = set->plan;
    const struct wb_harness_place *const places = drawing->shapes[drawing->n_shapes - 1].places;
    double x, y;
    for (int i = 0; i < plan->n_items; i++) {
        const struct wb_figure_style style = style_of_item(drawing, i);
        project(view, position_of(drawing, i), &x, &y);
        wb_figure_add_line(panel, NULL, 1, &x, &y, &style);
        wb_harness_labels_add_mark(labels, x, y);
    }
    for (int i = 0; i < plan->n_items; i++) {
        project(view, position_of(drawing, i), &x, &y);
        wb_harness_labels_put(labels, panel, x, y, plan->items[i].name, false);
    }
    for (int i = 0; drawing->names_branches && i < plan->n_branches; i++) {
        project(view, place_of(set, places, i, 0.5 * plan->branches[i].length)->position, &x, &y);
        wb_harness_labels_put(labels, panel, x, y, plan->branches[i].name, true);
    }
}

/* Where the steps mount items, and a line to each from the item. */
static void add_targets(struct wb_panel *panel, const struct view *view,
                        const struct wb_harness_drawing *drawing, bool has_legend,
                        struct wb_harness_labels *labels)
{
    const struct wb_harness_plan *const plan = drawing->set->plan;
    const struct wb_figure_style style = {
        .colour = wb_palette_warning(), .marker = WB_MARKER_RING, .marker_size = 4.5};
    const struct wb_figure_style way = {
        .colour = wb_palette_warning(), .width = 0.9, .dash = WB_DASH_DOTTED};
    struct path path = {0}, ways = {0};
    for (int i = 0; i < plan->n_steps; i++) {
        const struct wb_harness_step *const step = &plan->steps[i];
        if (step->kind != WB_HARNESS_MOUNT)
            continue;
        add_place(&path, view, step->position);
        add_piece(&ways, view, position_of(drawing, step->item), step->position);
        wb_harness_labels_add_mark(labels, path.x[path.n - 1], path.y[path.n - 1]);
    }
    put_path(&ways, panel, NULL, &way);
    put_path(&path, panel, has_legend ? "mounted at" : NULL, &style);
}

/* The line between the first and the last shape at the place that is farthest. */
static void add_distance(struct wb_panel *panel, const struct view *view,
                         const struct wb_harness_drawing *drawing, struct wb_harness_labels *labels)
{
    static const double least_shown = 0.6; /* part of it that a view with the number shows */
    const struct wb_figure_style style = {
        .colour = wb_palette_ink(), .width = 0.8, .dash = WB_DASH_DOTTED};
    const double *const from = drawing->shapes[0].places[drawing->farthest].position;
    const double *const to =
        drawing->shapes[drawing->n_shapes - 1].places[drawing->farthest].position;
    const double distance = wb_vec3_distance(from, to) / WB_MM;
    struct path path = {0};
    double middle[3], x, y;
    char text[48];
    add_piece(&path, view, from, to);
    const double shown = hypot(path.x[1] - path.x[0], path.y[1] - path.y[0]);
    put_path(&path, panel, NULL, &style);
    if (shown < least_shown * distance)
        return;
    for (int k = 0; k < 3; k++)
        middle[k] = 0.5 * (from[k] + to[k]);
    project(view, middle, &x, &y);
    snprintf(text, sizeof text, "%.*f mm",
             distance < 10.0    ? 2
             : distance < 100.0 ? 1
                                : 0,
             distance);
    wb_harness_labels_put(labels, panel, x, y, text, false);
}

/* --- obstacles --- */

enum {
    AROUND = 24 /* points of a circle */
};

static void place_in(const struct wb_obstacle *body, double x, double y, double z, double place[3])
{
    const double own[3] = {x, y, z};
    double R[9];
    wb_rod_element_matrix(body->rotation, R);
    wb_vec3_turn(R, own, place);
    for (int k = 0; k < 3; k++)
        place[k] += body->place[k];
}

/* A line between two places of an obstacle's frame. */
static void add_edge(struct path *path, const struct view *view, const struct wb_obstacle *body,
                     const double from[3], const double to[3])
{
    double a[3], b[3];
    place_in(body, from[0], from[1], from[2], a);
    place_in(body, to[0], to[1], to[2], b);
    add_piece(path, view, a, b);
}

/* The middle of what is shown in an obstacle's frame, and half its diagonal. */
static double find_middle(const struct view *view, const struct wb_obstacle *body, double own[3])
{
    double middle[3], diagonal[3], R[9];
    wb_rod_element_matrix(body->rotation, R);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (view->low[k] + view->high[k]) - body->place[k];
        diagonal[k] = view->high[k] - view->low[k];
    }
    wb_vec3_turn_back(R, middle, own);
    return 0.5 * wb_vec3_length(diagonal);
}

static void add_box_edges(struct path *path, const struct view *view,
                          const struct wb_obstacle *body, const double low[3], const double high[3])
{
    for (int axis = 0; axis < 3; axis++) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int corner = 0; corner < 4; corner++) {
            double from[3], to[3];
            from[axis] = low[axis];
            to[axis] = high[axis];
            from[u] = to[u] = corner % 2 ? high[u] : low[u];
            from[v] = to[v] = corner / 2 ? high[v] : low[v];
            add_edge(path, view, body, from, to);
        }
    }
}

static void add_cylinder_edges(struct path *path, const struct view *view,
                               const struct wb_obstacle *body, double low, double high)
{
    for (int i = 0; i < AROUND; i++) {
        const double a = 2.0 * M_PI * i / AROUND, b = 2.0 * M_PI * (i + 1) / AROUND;
        const double r = body->size[0];
        for (int end = 0; end < 2; end++) {
            const double x = end == 0 ? low : high;
            add_edge(path, view, body, (const double[3]){x, r * cos(a), r * sin(a)},
                     (const double[3]){x, r * cos(b), r * sin(b)});
        }
        if (i % 3 == 0)
            add_edge(path, view, body, (const double[3]){low, r * cos(a), r * sin(a)},
                     (const double[3]){high, r * cos(a), r * sin(a)});
    }
}

/* A plane that a parallel view shows as an area, which would hide nothing and show nothing. */
static bool is_face_on(const struct view *view, const struct wb_obstacle *body)
{
    double R[9];
    wb_rod_element_matrix(body->rotation, R);
    const int across = 3 - view->axes[0] - view->axes[1];
    return body->kind == WB_OBSTACLE_PLANE && !view->is_perspective && fabs(R[3 * across]) > 0.9;
}

/* The edges of all obstacles; of what has no end the part beside the harness. */
static void add_obstacles(struct wb_panel *panel, const struct view *view,
                          const struct wb_harness_plan *plan, bool has_legend)
{
    const struct wb_figure_style style = {.colour = wb_palette_grey(), .width = 0.8};
    struct path path = {0};
    for (int i = 0; i < plan->n_obstacles; i++) {
        const struct wb_obstacle *const body = &plan->obstacles[i].body;
        double middle[3];
        const double half = find_middle(view, body, middle);
        if (is_face_on(view, body))
            continue;
        if (body->kind == WB_OBSTACLE_CYLINDER) {
            const bool ends = isfinite(body->size[1]);
            add_cylinder_edges(&path, view, body, ends ? -0.5 * body->size[1] : middle[0] - half,
                               ends ? 0.5 * body->size[1] : middle[0] + half);
            continue;
        }
        const bool is_box = body->kind == WB_OBSTACLE_BOX;
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = is_box ? -0.5 * body->size[k] : k == 0 ? 0.0 : middle[k] - 0.5 * half;
            high[k] = is_box ? 0.5 * body->size[k] : k == 0 ? 0.0 : middle[k] + 0.5 * half;
        }
        add_box_edges(&path, view, body, low, high);
    }
    put_path(&path, panel, has_legend ? "obstacle" : NULL, &style);
}

/* --- the floor of a perspective --- */

static void widen(double low[3], double high[3], const double place[3])
{
    for (int k = 0; k < 3; k++) {
        low[k] = fmin(low[k], place[k]);
        high[k] = fmax(high[k], place[k]);
    }
}

/* By the nearest point of a plane or an endless cylinder, unless it is far away. */
static void widen_by_nearest(const struct wb_obstacle *body, double low[3], double high[3])
{
    double middle[3], diagonal[3], normal[3], curvature[9];
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * (low[k] + high[k]);
        diagonal[k] = high[k] - low[k];
    }
    const double away = wb_obstacle_distance(body, middle, normal, curvature);
    if (fabs(away) > wb_vec3_length(diagonal))
        return;
    for (int k = 0; k < 3; k++)
        middle[k] -= away * normal[k];
    widen(low, high, middle);
}

/* By the corners of those that have ends. */
static void widen_by_obstacles(const struct wb_harness_plan *plan, double low[3], double high[3])
{
    for (int i = 0; i < plan->n_obstacles; i++) {
        const struct wb_obstacle *const body = &plan->obstacles[i].body;
        const bool is_box = body->kind == WB_OBSTACLE_BOX;
        if (body->kind == WB_OBSTACLE_PLANE || !(is_box || isfinite(body->size[1]))) {
            widen_by_nearest(body, low, high);
            continue;
        }
        const double half[3] = {0.5 * body->size[!is_box],
                                is_box ? 0.5 * body->size[1] : body->size[0],
                                is_box ? 0.5 * body->size[2] : body->size[0]};
        for (int corner = 0; corner < 8; corner++) {
            double place[3];
            place_in(body, corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1],
                     corner & 4 ? half[2] : -half[2], place);
            widen(low, high, place);
        }
    }
}

static void find_box(const struct wb_harness_drawing *drawing, double low[3], double high[3])
{
    const struct wb_harness_plan *const plan = drawing->set->plan;
    for (int k = 0; k < 3; k++) {
        low[k] = (double)INFINITY;
        high[k] = -(double)INFINITY;
    }
    for (int s = 0; s < drawing->n_shapes; s++) {
        for (int i = 0; i < drawing->set->n_places; i++)
            widen(low, high, drawing->shapes[s].places[i].position);
    }
    for (int i = 0; drawing->has_targets && i < plan->n_steps; i++) {
        if (plan->steps[i].kind == WB_HARNESS_MOUNT)
            widen(low, high, plan->steps[i].position);
    }
    widen_by_obstacles(plan, low, high);
}

/* 1, 2 or 5 times a power of ten, so that a length has three to eight of them. */
static double grid_step(double length)
{
    const double power = pow(10.0, floor(log10(length / 3.0)));
    const double part = length / 3.0 / power;
    return power * (part < 2.0 ? 1.0 : part < 5.0 ? 2.0 : 5.0);
}

static void add_floor(struct wb_panel *panel, const struct view *view,
                      struct wb_harness_labels *labels)
{
    const struct wb_figure_style style = {.colour = wb_palette_rule(), .width = 0.5};
    const double *const low = view->low, *const high = view->high;
    const double step = view->grid;
    struct path path = {0};
    double x, y;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; low[k] + i * step < high[k] + 0.5 * step; i++) {
            const double at = low[k] + i * step;
            double from[3] = {low[0], low[1], low[2]}, to[3] = {high[0], high[1], low[2]};
            from[k] = to[k] = at;
            add_piece(&path, view, from, to);
        }
    }
    put_path(&path, panel, NULL, &style);
    const double x_end[3] = {high[0], low[1], low[2]}, y_end[3] = {high[0], high[1], low[2]};
    project(view, x_end, &x, &y);
    wb_harness_labels_put(labels, panel, x, y, "x", true);
    project(view, y_end, &x, &y);
    wb_harness_labels_put(labels, panel, x, y, "y", true);
}

/* Vertical lines from the items down to the floor. */
static void add_drops(struct wb_panel *panel, const struct view *view,
                      const struct wb_harness_drawing *drawing)
{
    const struct wb_figure_style style = {.colour = wb_palette_rule(), .width = 0.7};
    struct path path = {0};
    for (int i = 0; i < drawing->set->plan->n_items; i++) {
        const double *const at = position_of(drawing, i);
        const double below[3] = {at[0], at[1], view->low[2]};
        add_piece(&path, view, at, below);
    }
    put_path(&path, panel, NULL, &style);
}

/* --- panels --- */

/* The range of a panel around all that is shown, so that a unit is as long on both axes and the
 * drawing is in the middle; and the points that names should not cover. */
static void fit_panel(const struct view *view, const struct wb_harness_drawing *drawing,
                      struct wb_harness_labels *labels)
{
    static const double margin[2] = {20.0, 13.0}; /* points, for names */
    struct wb_harness_labels_box box = {{(double)INFINITY, (double)INFINITY},
                                        {-(double)INFINITY, -(double)INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        double place[3], at[2];
        for (int k = 0; k < 3; k++)
            place[k] = (corner >> k) % 2 ? view->high[k] : view->low[k];
        project(view, place, &at[0], &at[1]);
        for (int k = 0; k < 2; k++) {
            box.low[k] = fmin(box.low[k], at[k]);
            box.high[k] = fmax(box.high[k], at[k]);
        }
    }
    const double room[2] = {view->width, view->height};
    labels->scale = 1e-3;
    for (int k = 0; k < 2; k++)
        labels->scale =
            fmax(labels->scale, (box.high[k] - box.low[k]) / fmax(room[k] - 2.0 * margin[k], 20.0));
    for (int k = 0; k < 2; k++) {
        const double middle = 0.5 * (box.low[k] + box.high[k]);
        labels->panel.low[k] = middle - 0.5 * labels->scale * room[k];
        labels->panel.high[k] = middle + 0.5 * labels->scale * room[k];
    }
    for (int s = 0; s < drawing->n_shapes; s++) {
        for (int i = 0; i < drawing->set->n_places; i++) {
            double x, y;
            project(view, drawing->shapes[s].places[i].position, &x, &y);
            wb_harness_labels_add_point(labels, x, y);
        }
    }
}

static void add_panel(struct wb_panel *panel, const struct view *view,
                      const struct wb_harness_drawing *drawing, bool has_legend)
{
    struct wb_harness_labels labels = {0};
    fit_panel(view, drawing, &labels);
    wb_figure_set_title(panel, view->title);
    wb_figure_set_equal_aspect(panel);
    wb_figure_set_x_range(panel, labels.panel.low[0], labels.panel.high[0]);
    wb_figure_set_y_range(panel, labels.panel.low[1], labels.panel.high[1]);
    if (view->is_perspective) {
        struct wb_harness_drawing_shape shadow = drawing->shapes[drawing->n_shapes - 1];
        shadow.label = NULL;
        shadow.style = (struct wb_figure_style){.colour = wb_palette_rule(), .width = 1.8};
        wb_figure_hide_axes(panel);
        add_floor(panel, view, &labels);
        add_shape(panel, view, drawing->set, &shadow, view->low[2]);
        add_drops(panel, view, drawing);
    } else {
        wb_figure_set_axes(panel, view->labels[0], view->labels[1]);
    }
    add_obstacles(panel, view, drawing->set->plan, has_legend);
    for (int i = 0; i < drawing->n_shapes; i++) {
        struct wb_harness_drawing_shape shape = drawing->shapes[i];
        shape.label = has_legend ? shape.label : NULL;
        add_shape(panel, view, drawing->set, &shape, (double)NAN);
    }
    if (drawing->has_targets)
        add_targets(panel, view, drawing, has_legend, &labels);
    add_items(panel, view, drawing, &labels);
    for (int i = 0; i < drawing->set->plan->n_obstacles; i++) {
        const struct wb_harness_plan_obstacle *const obstacle = &drawing->set->plan->obstacles[i];
        double x, y;
        project(view, obstacle->body.place, &x, &y);
        if (!is_face_on(view, &obstacle->body))
            wb_harness_labels_put(&labels, panel, x, y, obstacle->name, true);
    }
    if (drawing->farthest >= 0)
        add_distance(panel, view, drawing, &labels);
    wb_harness_labels_release(&labels);
}

/* Widths of the three plots, points: a unit is as long in all, but none is very narrow. */
static void share_width(const struct wb_harness_drawing *drawing, double width,
                        double widths[VIEWS])
{
    static const double narrowest = 0.45; /* of the widest */
    double low[3], high[3], sum = 0.0, widest = 1e-9;
    find_box(drawing, low, high);
    for (int i = 0; i < VIEWS; i++) {
        const int k = parallel_views[i].axes[0];
        widest = fmax(widest, high[k] - low[k]);
    }
    for (int i = 0; i < VIEWS; i++) {
        const int k = parallel_views[i].axes[0];
        widths[i] = fmax(high[k] - low[k], narrowest * widest);
        sum += widths[i];
    }
    for (int i = 0; i < VIEWS; i++)
        widths[i] *= (width - VIEWS * BESIDE - (VIEWS - 1) * GAP) / sum;
}

double wb_harness_drawing_height(const struct wb_harness_drawing *drawing, double width)
{
    double low[3], high[3], widths[VIEWS], height = 0.25 * width;
    find_box(drawing, low, high);
    share_width(drawing, width, widths);
    for (int i = 0; i < VIEWS; i++) {
        const int *const k = parallel_views[i].axes;
        height = fmax(height, ABOVE + widths[i] * (high[k[1]] - low[k[1]]) /
                                          fmax(high[k[0]] - low[k[0]], 1e-9));
    }
    return fmin(height, 0.45 * width);
}

void wb_harness_drawing_add_views(const struct wb_harness_drawing *drawing,
                                  struct wb_figure *figure, double width)
{
    double widths[VIEWS];
    share_width(drawing, width, widths);
    for (int i = 0; i < VIEWS; i++) {
        struct wb_panel *const panel = wb_figure_add_panel(figure);
        struct view view = parallel_views[i];
        view.width = widths[i];
        view.height = wb_figure_height(figure) - ABOVE;
        find_box(drawing, view.low, view.high);
        wb_figure_set_width(panel, widths[i] + BESIDE);
        add_panel(panel, &view, drawing, false);
    }
}

void wb_harness_drawing_add_perspective(const struct wb_harness_drawing *drawing,
                                        struct wb_figure *figure, double width)
{
    struct view view = {.is_perspective = true, .width = width - 4.0};
    double diagonal[3];
    char title[80];
    find_box(drawing, view.low, view.high);
    view.height = wb_figure_height(figure) - 28.0;
    view.grid = grid_step(fmax(view.high[0] - view.low[0], view.high[1] - view.low[1]));
    for (int k = 0; k < 2; k++) {
        const double first = floor(view.low[k] / view.grid);
        view.low[k] = view.grid * first;
        view.high[k] = view.grid * fmax(ceil(view.high[k] / view.grid), first + 1.0);
    }
    for (int k = 0; k < 3; k++) {
        view.middle[k] = 0.5 * (view.low[k] + view.high[k]);
        diagonal[k] = view.high[k] - view.low[k];
    }
    view.distance = 0.5 * eye_distance * wb_vec3_length(diagonal);
    snprintf(title, sizeof title, "Perspective, grid of %g mm", view.grid / WB_MM);
    view.title = title;
    struct wb_panel *const panel = wb_figure_add_panel(figure);
    wb_figure_set_width(panel, width);
    add_panel(panel, &view, drawing, true);
}

/* --- what is drawn --- */

static const struct wb_figure_style dashed = {
    .colour = {0.45, 0.45, 0.45, 1.0}, .width = 0.9, .dash = WB_DASH_DASHED};

static struct wb_harness_drawing_shape shape_of(const struct wb_harness_place *places,
                                                const char *label, struct wb_figure_style style)
{
    return (struct wb_harness_drawing_shape){places, label, style};
}

static struct wb_figure_style solid(struct wb_colour colour)
{
    return (struct wb_figure_style){.colour = colour, .width = 2.0};
}

void wb_harness_drawing_of_natural(struct wb_harness_drawing *drawing,
                                   const struct wb_harness_result_set *set)
{
    *drawing = (struct wb_harness_drawing){
        .set = set,
        .n_shapes = 1,
        .shapes = {shape_of(set->natural, "free of stress", solid(wb_palette_wire(0)))},
        .step = -1,
        .names_branches = true,
        .has_targets = true,
        .farthest = -1,
    };
}

void wb_harness_drawing_of_step(struct wb_harness_drawing *drawing,
                                const struct wb_harness_result_set *set, int step)
{
    const bool is_first = step == 0;
    *drawing = (struct wb_harness_drawing){
        .set = set,
        .n_shapes = 2,
        .shapes = {shape_of(is_first ? set->natural : set->results[step - 1].places,
                            is_first ? "free of stress" : "before", dashed),
                   shape_of(set->results[step].places, "after", solid(wb_palette_wire(0)))},
        .step = step,
        .farthest = -1,
    };
}

void wb_harness_drawing_of_steps(struct wb_harness_drawing *drawing,
                                 const struct wb_harness_result_set *set)
{
    int off = -1, mounted = -1;
    for (int i = 0; i < set->n_steps; i++)
        *(set->plan->steps[i].kind == WB_HARNESS_TAKE_OFF ? &off : &mounted) = i;
    *drawing = (struct wb_harness_drawing){
        .set = set,
        .n_shapes = 1,
        .shapes = {shape_of(set->natural, "free of stress", dashed)},
        .step = mounted,
        .farthest = -1,
    };
    if (off >= 0) {
        struct wb_figure_style style = solid(wb_palette_warning());
        style.width = 1.2;
        drawing->shapes[drawing->n_shapes++] =
            shape_of(set->results[off].places, "taken off", style);
    }
    if (mounted >= 0)
        drawing->shapes[drawing->n_shapes++] =
            shape_of(set->results[mounted].places, set->plan->steps[mounted].name,
                     solid(wb_palette_wire(0)));
}

void wb_harness_drawing_of_residual(struct wb_harness_drawing *drawing,
                                    const struct wb_harness_result_set *set, int step)
{
    *drawing = (struct wb_harness_drawing){
        .set = set,
        .n_shapes = 2,
        .shapes = {shape_of(set->natural, "free of stress before", dashed),
                   shape_of(set->results[step].places, "taken off", solid(wb_palette_warning()))},
        .step = -1,
        .farthest = wb_harness_found_farthest(set, step),
    };
}

/* --- figures of their own --- */

enum wb_status wb_harness_drawing_create(const struct wb_harness_drawing *drawing,
                                         const char *footer, struct wb_figure **figure)
{
    const double views = WIDTH - PERSPECTIVE - GAP;
    WB_TRY(wb_figure_create(figure, "harness", WIDTH, wb_harness_drawing_height(drawing, views)));
    wb_harness_drawing_add_views(drawing, *figure, views);
    wb_harness_drawing_add_perspective(drawing, *figure, PERSPECTIVE);
    wb_figure_set_footer(*figure, footer);
    return WB_OK;
}

enum wb_status wb_harness_drawing_write(const struct wb_harness_result_set *set, const char *path)
{
    struct wb_harness_drawing drawing;
    struct wb_figure *figure;
    char footer[160];
    bool is_virtual = false;
    wb_harness_drawing_of_steps(&drawing, set);
    for (int i = 0; i < set->plan->n_wires; i++)
        is_virtual |= set->plan->wires[i].is_virtual;
    snprintf(footer, sizeof footer, "%s: simulation, %s%s", set->plan->name,
             set->settings.is_elastic ? "elastic" : "elastoplastic",
             is_virtual ? ", with wires of a virtual rig" : "");
    WB_TRY(wb_harness_drawing_create(&drawing, footer, &figure));
    const enum wb_status status = wb_figure_write_file(figure, PNG_SCALE, path);
    wb_figure_destroy(figure);
    return status;
}
