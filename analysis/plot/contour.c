/* How the regions are found. Every face is cut into triangles, on which position and value are
 * linear. The outline of a region is made of two kinds of segments: isolines through triangles, and
 * parts of edges where the region ends with the triangle. An edge between two triangles whose
 * values agree along it never is an outline, so it is not looked at for any level. The segments of
 * a level are then chained into loops. Points are identified by their coordinates, rounded to a
 * small part of the extent: shared edges give the same points but for round-off.
 */
#include "analysis/plot/contour.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "contour"

/* Intervals along an edge of a face, points of a face. */
#define CUTS 8
#define ACROSS (CUTS + 1)
#define POINTS (ACROSS * ACROSS)
/* Points that are left out in a row. */
#define LONGEST_SKIP 64

/* Points nearer than this part of the extent are the same, and values than this part of a scale. */
static const double same_place = 1e-7, same_value = 1e-7;
/* A line may stray by this part of the extent when points are left out. */
static const double stray = 1.5e-4;

struct point {
    int64_t place[2], level; /* rounded */
    double x, y, value;
    int index, position, vertex; /* where it came from; numbers of its place, of place and value */
};

struct triangle {
    int vertex[3]; /* counterclockwise */
};

/* A side of a triangle, which lies on its left. */
struct side {
    int from, to;   /* vertices */
    int low, high;  /* positions, low < high: what two sides of an edge have in common */
    bool is_inside; /* the triangle behind it goes on without a jump */
    int other;      /* the side behind it where the value jumps; -1 none */
};

struct segment {
    int level;
    double from[2], to[2];
    bool used;
};

struct work {
    const struct wb_contour_levels *levels;
    double origin[2], grid, grain; /* of rounding: places, values */
    int n_points, n_vertices, n_triangles, n_sides;
    struct point *points;
    struct point *vertices; /* one for each vertex */
    struct triangle *triangles;
    struct side *sides;
    int n_segments;
    size_t capacity;
    struct segment *segments;
    double (*loop)[2]; /* the loop that is being chained */
    int n_loop;
    size_t loop_capacity;
};

/* --- points and triangles --- */

static void shape_functions(double r, double s, double n[8])
{
    const double a = 1.0 - r, b = 1.0 + r, c = 1.0 - s, d = 1.0 + s;
    n[0] = 0.25 * a * c * (-r - s - 1.0);
    n[1] = 0.25 * b * c * (r - s - 1.0);
    n[2] = 0.25 * b * d * (r + s - 1.0);
    n[3] = 0.25 * a * d * (-r + s - 1.0);
    n[4] = 0.5 * a * b * c;
    n[5] = 0.5 * b * c * d;
    n[6] = 0.5 * a * b * d;
    n[7] = 0.5 * a * c * d;
}

static double weigh(const double n[8], const double values[8])
{
    double sum = 0.0;
    for (int i = 0; i < 8; i++)
        sum += n[i] * values[i];
    return sum;
}

static bool is_finite(const struct wb_contour_face *face)
{
    double sum = 0.0;
    for (int i = 0; i < 8; i++)
        sum += fabs(face->x[i]) + fabs(face->y[i]) + fabs(face->value[i]);
    return isfinite(sum);
}

static void place_points(struct work *work, int n_faces, const struct wb_contour_face *faces)
{
    double low[2] = {(double)INFINITY, (double)INFINITY};
    double high[2] = {-(double)INFINITY, -(double)INFINITY};
    for (int f = 0; f < n_faces; f++) {
        if (!is_finite(&faces[f]))
            continue;
        for (int i = 0; i < POINTS; i++) {
            double n[8];
            const double r = 2.0 * (i % ACROSS) / CUTS - 1.0, s = 2.0 * (i / ACROSS) / CUTS - 1.0;
            shape_functions(r, s, n);
            struct point *const point = &work->points[work->n_points];
            point->x = weigh(n, faces[f].x);
            point->y = weigh(n, faces[f].y);
            point->value = weigh(n, faces[f].value);
            point->index = work->n_points++;
            low[0] = fmin(low[0], point->x);
            low[1] = fmin(low[1], point->y);
            high[0] = fmax(high[0], point->x);
            high[1] = fmax(high[1], point->y);
        }
    }
    const double extent = fmax(high[0] - low[0], high[1] - low[1]);
    work->origin[0] = low[0];
    work->origin[1] = low[1];
    work->grid = same_place * (extent > 0.0 ? extent : 1.0);
    work->grain = same_value * (work->levels->high - work->levels->low);
}

static void round_points(struct work *work)
{
    /* So far beyond the levels a value's size does not matter, and it must fit an integer. */
    const double span = work->levels->high - work->levels->low, most = 1e6 * span;
    for (int i = 0; i < work->n_points; i++) {
        struct point *const point = &work->points[i];
        point->value =
            work->levels->low + fmin(fmax(point->value - work->levels->low, -most), most);
        point->place[0] = llround((point->x - work->origin[0]) / work->grid);
        point->place[1] = llround((point->y - work->origin[1]) / work->grid);
        point->level = llround((point->value - work->levels->low) / work->grain);
    }
}

static int by_place_and_value(const void *a, const void *b)
{
    const struct point *const p = a, *const q = b;
    for (int i = 0; i < 2; i++) {
        if (p->place[i] != q->place[i])
            return p->place[i] < q->place[i] ? -1 : 1;
    }
    if (p->level != q->level)
        return p->level < q->level ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

static int by_index(const void *a, const void *b)
{
    const struct point *const p = a, *const q = b;
    return p->index < q->index ? -1 : p->index > q->index;
}

/* Numbers places and vertices; of each vertex the first point stands for all. */
static void number_vertices(struct work *work)
{
    int position = -1;
    qsort(work->points, (size_t)work->n_points, sizeof *work->points, by_place_and_value);
    for (int i = 0; i < work->n_points; i++) {
        struct point *const point = &work->points[i];
        const struct point *const before = i > 0 ? point - 1 : NULL;
        const bool moved = !before || memcmp(before->place, point->place, sizeof point->place) != 0;
        position += moved;
        point->position = position;
        if (moved || before->level != point->level)
            work->vertices[work->n_vertices++] = *point;
        point->vertex = work->n_vertices - 1;
    }
    qsort(work->points, (size_t)work->n_points, sizeof *work->points, by_index);
}

static void add_triangle(struct work *work, int a, int b, int c)
{
    const struct point *const p = work->vertices;
    const double area =
        (p[b].x - p[a].x) * (p[c].y - p[a].y) - (p[c].x - p[a].x) * (p[b].y - p[a].y);
    if (p[a].position == p[b].position || p[b].position == p[c].position ||
        p[c].position == p[a].position || area == 0.0)
        return;
    struct triangle *const triangle = &work->triangles[work->n_triangles++];
    *triangle = (struct triangle){{a, area > 0.0 ? b : c, area > 0.0 ? c : b}};
}

static void cut_faces(struct work *work)
{
    for (int f = 0; f < work->n_points / POINTS; f++) {
        const struct point *const points = &work->points[f * POINTS];
        for (int i = 0; i < CUTS * CUTS; i++) {
            const int first = (i / CUTS) * ACROSS + i % CUTS;
            const int a = points[first].vertex, b = points[first + 1].vertex;
            const int c = points[first + ACROSS + 1].vertex, d = points[first + ACROSS].vertex;
            add_triangle(work, a, b, c);
            add_triangle(work, a, c, d);
        }
    }
}

/* --- edges --- */

static int by_edge(const void *a, const void *b)
{
    const struct side *const p = a, *const q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    if (p->from != q->from)
        return p->from < q->from ? -1 : 1;
    return p->to < q->to ? -1 : p->to > q->to;
}

/* Two sides of one edge: either the field goes on, or both know of each other. */
static void match(struct side *sides, int i)
{
    struct side *const one = &sides[i], *const two = &sides[i + 1];
    if (one->from == two->to && one->to == two->from) {
        one->is_inside = two->is_inside = true;
        return;
    }
    one->other = i + 1;
    two->other = i;
}

static void find_edges(struct work *work)
{
    for (int t = 0; t < work->n_triangles; t++) {
        for (int k = 0; k < 3; k++) {
            const int from = work->triangles[t].vertex[k];
            const int to = work->triangles[t].vertex[(k + 1) % 3];
            const int p = work->vertices[from].position, q = work->vertices[to].position;
            work->sides[work->n_sides++] =
                (struct side){from, to, p < q ? p : q, p < q ? q : p, false, -1};
        }
    }
    qsort(work->sides, (size_t)work->n_sides, sizeof *work->sides, by_edge);
    for (int i = 0; i < work->n_sides;) {
        int n = 1;
        while (i + n < work->n_sides && work->sides[i + n].low == work->sides[i].low &&
               work->sides[i + n].high == work->sides[i].high)
            n++;
        const int p = work->vertices[work->sides[i].from].position;
        /* Where faces lie on each other more than two meet: each side is an outline then. */
        if (n == 2 && p != work->vertices[work->sides[i + 1].from].position)
            match(work->sides, i);
        i += n;
    }
}

/* --- segments --- */

static double level_begin(const struct work *work, int level)
{
    const struct wb_contour_levels *const levels = work->levels;
    /* All that there is belongs to the lowest level. */
    return level == 0 ? -(double)INFINITY
                      : levels->low + (levels->high - levels->low) * level / levels->n;
}

/* Levels that begin at or below a value: 1..n. */
static int levels_reached(const struct work *work, double value)
{
    const struct wb_contour_levels *const levels = work->levels;
    const double part = (value - levels->low) / (levels->high - levels->low) * levels->n;
    int n = part < 0.0 ? 0 : part >= levels->n ? levels->n - 1 : (int)part;
    while (n > 0 && level_begin(work, n) > value)
        n--;
    while (n + 1 < levels->n && level_begin(work, n + 1) <= value)
        n++;
    return n + 1;
}

/* Where the edge between two vertices reaches a level; the same from both of its triangles. */
static void cross(const struct work *work, int a, int b, double begin, double at[2])
{
    const struct point *const p = &work->vertices[a < b ? a : b];
    const struct point *const q = &work->vertices[a < b ? b : a];
    const double part = fmin(fmax((begin - p->value) / (q->value - p->value), 0.0), 1.0);
    at[0] = p->x + part * (q->x - p->x);
    at[1] = p->y + part * (q->y - p->y);
}

static void add_segment(struct work *work, int level, const double from[2], const double to[2])
{
    work->segments = wb_memory_room(work->segments, &work->capacity, (size_t)work->n_segments + 1,
                                    sizeof *work->segments);
    work->segments[work->n_segments++] =
        (struct segment){level, {from[0], from[1]}, {to[0], to[1]}, false};
}

/* The isolines through a triangle: from where its outline leaves the region to where it enters. */
static void cut_triangle(struct work *work, const struct triangle *triangle)
{
    const int *const v = triangle->vertex;
    const double values[3] = {work->vertices[v[0]].value, work->vertices[v[1]].value,
                              work->vertices[v[2]].value};
    const int first = levels_reached(work, fmin(values[0], fmin(values[1], values[2])));
    const int last = levels_reached(work, fmax(values[0], fmax(values[1], values[2])));
    for (int level = first; level < last; level++) {
        const double begin = level_begin(work, level);
        double leaves[2] = {0.0, 0.0}, enters[2] = {0.0, 0.0};
        for (int k = 0; k < 3; k++) {
            const int next = (k + 1) % 3;
            if (values[k] >= begin && values[next] < begin)
                cross(work, v[k], v[next], begin, leaves);
            if (values[k] < begin && values[next] >= begin)
                cross(work, v[k], v[next], begin, enters);
        }
        add_segment(work, level, leaves, enters);
    }
}

/* The parts of a side that end a region. */
static void cut_side(struct work *work, const struct side *side)
{
    const struct point *const a = &work->vertices[side->from], *const b = &work->vertices[side->to];
    const int all = levels_reached(work, fmin(a->value, b->value));
    const int last = levels_reached(work, fmax(a->value, b->value));
    int first = 0;
    if (side->other >= 0) {
        /* Levels that both sides reach all along go on behind it. */
        const struct side *const other = &work->sides[side->other];
        first = levels_reached(
            work, fmin(work->vertices[other->from].value, work->vertices[other->to].value));
        first = first < all ? first : all;
    }
    for (int level = first; level < last; level++) {
        double from[2] = {a->x, a->y}, to[2] = {b->x, b->y};
        const double begin = level_begin(work, level);
        if (a->value < begin)
            cross(work, side->from, side->to, begin, from);
        if (b->value < begin)
            cross(work, side->from, side->to, begin, to);
        add_segment(work, level, from, to);
    }
}

/* --- loops --- */

static int64_t rounded(const struct work *work, const double at[2], int axis)
{
    return llround((at[axis] - work->origin[axis]) / work->grid);
}

static int compare_places(const struct work *work, const double p[2], const double q[2])
{
    for (int i = 0; i < 2; i++) {
        const int64_t a = rounded(work, p, i), b = rounded(work, q, i);
        if (a != b)
            return a < b ? -1 : 1;
    }
    return 0;
}

static int by_level_and_start(const void *a, const void *b, void *context)
{
    const struct segment *const p = a, *const q = b;
    if (p->level != q->level)
        return p->level < q->level ? -1 : 1;
    const int places = compare_places(context, p->from, q->from);
    return places ? places : compare_places(context, p->to, q->to);
}

/* The first unused segment of [first, end) that starts at a place; -1: none. */
static int find_start(const struct work *work, int first, int end, const double at[2])
{
    int low = first, high = end;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (compare_places(work, work->segments[middle].from, at) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    for (; low < end && compare_places(work, work->segments[low].from, at) == 0; low++) {
        if (!work->segments[low].used)
            return low;
    }
    return -1;
}

static void push(struct work *work, const double at[2])
{
    work->loop = wb_memory_room(work->loop, &work->loop_capacity, (size_t)work->n_loop + 1,
                                sizeof *work->loop);
    memcpy(work->loop[work->n_loop++], at, sizeof *work->loop);
}

/* Follows the segments from one on until they come back or end. */
static void chain(struct work *work, int first, int end, int start)
{
    work->n_loop = 0;
    for (int i = start; i >= 0; i = find_start(work, first, end, work->segments[i].to)) {
        work->segments[i].used = true;
        if (compare_places(work, work->segments[i].from, work->segments[i].to) != 0)
            push(work, work->segments[i].from);
    }
}

/* Whether all points between two of a loop lie near the line that joins them. */
static bool is_straight(double (*const points)[2], int n, int from, int to, double most)
{
    const double *const a = points[from], *const b = points[to % n];
    const double dx = b[0] - a[0], dy = b[1] - a[1], length = hypot(dx, dy);
    for (int i = from + 1; i < to; i++) {
        const double x = points[i][0] - a[0], y = points[i][1] - a[1];
        const double along = length > 0.0 ? (x * dx + y * dy) / length : 0.0;
        const double off = length > 0.0 ? fabs(x * dy - y * dx) / length : hypot(x, y);
        if (off > most || along < -most || along > length + most)
            return false;
    }
    return true;
}

int wb_contour_thin(double (*points)[2], int n, double most)
{
    int kept = 0;
    for (int from = 0; from < n;) {
        int to = from + 1;
        while (to < n && to - from < LONGEST_SKIP && is_straight(points, n, from, to + 1, most))
            to++;
        memmove(points[kept++], points[from], sizeof *points);
        from = to;
    }
    return kept;
}

static void take_loop(struct wb_contour *contour, const struct work *work, int level)
{
    if (work->n_loop < 3)
        return;
    const size_t n_points = (size_t)contour->n_points + (size_t)work->n_loop;
    contour->loops =
        wb_memory_resize(contour->loops, (size_t)contour->n_loops + 1, sizeof *contour->loops);
    contour->points = wb_memory_resize(contour->points, n_points, sizeof *contour->points);
    contour->loops[contour->n_loops++] =
        (struct wb_contour_loop){level, contour->n_points, work->n_loop};
    memcpy(contour->points[contour->n_points], work->loop,
           (size_t)work->n_loop * sizeof *work->loop);
    contour->n_points += work->n_loop;
}

static void chain_all(struct wb_contour *contour, struct work *work)
{
    if (work->n_segments == 0)
        return;
    qsort_r(work->segments, (size_t)work->n_segments, sizeof *work->segments, by_level_and_start,
            work);
    for (int first = 0, end; first < work->n_segments; first = end) {
        const int level = work->segments[first].level;
        for (end = first; end < work->n_segments && work->segments[end].level == level; end++)
            ;
        for (int i = first; i < end; i++) {
            if (work->segments[i].used)
                continue;
            chain(work, first, end, i);
            work->n_loop =
                wb_contour_thin(work->loop, work->n_loop, stray / same_place * work->grid);
            take_loop(contour, work, level);
        }
    }
}

/* --- all of it --- */

static void find_regions(struct wb_contour *contour, struct work *work, int n_faces,
                         const struct wb_contour_face *faces)
{
    const size_t n = (size_t)n_faces * POINTS, n_triangles = (size_t)n_faces * 2 * CUTS * CUTS;
    work->points = wb_memory_new(n, sizeof *work->points);
    work->vertices = wb_memory_new(n, sizeof *work->vertices);
    work->triangles = wb_memory_new(n_triangles, sizeof *work->triangles);
    work->sides = wb_memory_new(3 * n_triangles, sizeof *work->sides);
    place_points(work, n_faces, faces);
    round_points(work);
    number_vertices(work);
    cut_faces(work);
    find_edges(work);
    for (int i = 0; i < work->n_triangles; i++)
        cut_triangle(work, &work->triangles[i]);
    for (int i = 0; i < work->n_sides; i++) {
        if (!work->sides[i].is_inside)
            cut_side(work, &work->sides[i]);
    }
    chain_all(contour, work);
}

enum wb_status wb_contour_create(struct wb_contour *contour, int n_faces,
                                 const struct wb_contour_face *faces,
                                 const struct wb_contour_levels *levels)
{
    memset(contour, 0, sizeof *contour);
    if (!(levels->low < levels->high) || !isfinite(levels->high - levels->low) || levels->n < 1 ||
        levels->n > 1000 || n_faces < 0 || n_faces > 100000)
        return wb_fail(
            WB_ERR_ARGUMENT,
            "%d faces and %d levels from %g to %g cannot be drawn: expected at most 100000 "
            "faces, 1 to 1000 levels, and a range that rises",
            n_faces, levels->n, levels->low, levels->high);
    struct work work = {.levels = levels};
    find_regions(contour, &work, n_faces, faces);
    free(work.points);
    free(work.vertices);
    free(work.triangles);
    free(work.sides);
    free(work.segments);
    free(work.loop);
    return WB_OK;
}

void wb_contour_release(struct wb_contour *contour)
{
    free(contour->loops);
    free(contour->points);
    memset(contour, 0, sizeof *contour);
}
