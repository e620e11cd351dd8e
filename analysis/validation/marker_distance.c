#include "analysis/validation/marker_distance.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/dataset/curve.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"

#define WB_LOG_DOMAIN "marker_distance"

/* Largest number of different arc lengths of markers. */
#define MOST_POSITIONS 256
/* Parts of the range over which a marker's displacements are averaged. */
#define PARTS 10

/* A measured marker in a frame. */
struct point {
    const struct wb_shape_row *row;
    double place; /* deflection, m; follower test: force, N */
    int sample, position;
};

/* The measured markers, and shapes of the model at equal steps of deflection or follower force, at
 * the arc lengths of all markers. */
struct gallery {
    size_t n_points, room;
    struct point *points;
    int n_positions, n_frames, n_reached;
    double s[MOST_POSITIONS];
    double *x, *y; /* (n_frames * n_positions) */
    double step;
    bool is_follower;
};

/* Time at which the first loading ends. */
static double end_of_loading(const struct wb_dataset *dataset)
{
    const size_t n = wb_curve_end_of_loading(dataset, 0.0);
    return n > 0 ? dataset->rows[n - 1].t : -HUGE_VAL;
}

/* Force at a time, linear between the rows, which ascend in time; NaN outside. */
static double force_at(const struct wb_dataset *dataset, double t)
{
    const size_t n = dataset->n_rows;
    const size_t at = n > 0 ? wb_fit_first_at(&dataset->rows->t, sizeof *dataset->rows, n, t) : 0;
    if (at < n && dataset->rows[at].t == t)
        return dataset->rows[at].force;
    if (at == 0 || at == n)
        return (double)NAN;
    const struct wb_row *const a = &dataset->rows[at - 1], *const b = &dataset->rows[at];
    return a->force + (b->force - a->force) * (t - a->t) / (b->t - a->t);
}

static int find_position(const struct gallery *gallery, double s)
{
    for (int i = 0; i < gallery->n_positions; i++) {
        if (fabs(gallery->s[i] - s) < 1e-9)
            return i;
    }
    return -1;
}

/* Collects the markers of the first loadings from zero to `last`, and their positions. */
static enum wb_status collect_points(struct gallery *gallery,
                                     const struct wb_dataset *const *datasets, int n, double last,
                                     struct wb_reason *why)
{
    for (int i = 0; i < n; i++) {
        const double end = end_of_loading(datasets[i]);
        for (size_t k = 0; k < datasets[i]->n_shape_rows; k++) {
            const struct wb_shape_row *const row = &datasets[i]->shape_rows[k];
            if (!(row->t <= end && row->s > 0.0 && isfinite(row->x) && isfinite(row->y)))
                continue;
            const double place =
                gallery->is_follower ? force_at(datasets[i], row->t) : row->deflection;
            if (!(place >= 0.0 && place <= last * (1.0 + 1e-9)))
                continue;
            int position = find_position(gallery, row->s);
            if (position < 0 && gallery->n_positions == MOST_POSITIONS)
                return wb_fail_to(why, WB_ERR_DATA,
                                  "wire '%s': markers at more than %d arc lengths",
                                  datasets[i]->info.wire, MOST_POSITIONS);
            if (position < 0) {
                position = gallery->n_positions++;
                gallery->s[position] = row->s;
            }
            gallery->points = wb_memory_room(gallery->points, &gallery->room, gallery->n_points + 1,
                                             sizeof *gallery->points);
            gallery->points[gallery->n_points++] = (struct point){row, place, i, position};
        }
    }
    return WB_OK;
}

static enum wb_status fill(struct gallery *gallery, struct wb_computed *computed,
                           const struct wb_material *material)
{
    enum wb_status (*const go)(struct wb_computed *, double, double *, bool *) =
        gallery->is_follower ? wb_computed_push : wb_computed_move;
    bool reached;
    double found;
    WB_TRY(wb_computed_start(computed, material, &reached));
    for (int i = 0; reached && i < gallery->n_frames; i++) {
        if (i > 0)
            WB_TRY(go(computed, i * gallery->step, &found, &reached));
        if (!reached)
            break;
        wb_computed_shape(computed, gallery->n_positions, gallery->s,
                          gallery->x + i * gallery->n_positions,
                          gallery->y + i * gallery->n_positions, NULL);
        gallery->n_reached = i + 1;
    }
    return WB_OK;
}

/* Displacement of one marker from the model; false if the model did not reach its place. */
static bool displacement(const struct gallery *gallery, const struct point *point, double *dx,
                         double *dy)
{
    const double place = point->place / gallery->step;
    int frame = (int)place;
    if (frame == gallery->n_frames - 1)
        frame--;
    if (frame < 0 || frame + 1 >= gallery->n_reached)
        return false;
    const double part = place - frame;
    const int at = frame * gallery->n_positions + point->position;
    const int next = at + gallery->n_positions;
    const double x = (1.0 - part) * gallery->x[at] + part * gallery->x[next];
    const double y = (1.0 - part) * gallery->y[at] + part * gallery->y[next];
    *dx = point->row->x - x;
    *dy = point->row->y - y;
    return true;
}

/* Displacements of a sample at a position within a part of the range. */
struct cell {
    double dx, dy;
    int n;
};

/* Averages over the samples; `cells` has n_positions x PARTS for each. */
static void average(struct wb_marker_mean *mean, const struct cell *cells, int n_positions, int n)
{
    const int n_cells = n_positions * PARTS;
    double squares = 0.0, variance = 0.0;
    int used = 0;
    mean->n_samples = n;
    mean->n_positions = 0;
    int counted = -1; /* the last position that was counted */
    for (int c = 0; c < n_cells; c++) {
        double sum[2] = {0.0, 0.0}, square = 0.0;
        int count = 0;
        for (int i = 0; i < n; i++) {
            const struct cell *const cell = &cells[i * n_cells + c];
            if (cell->n == 0)
                continue;
            const double x = cell->dx / cell->n, y = cell->dy / cell->n;
            sum[0] += x;
            sum[1] += y;
            square += x * x + y * y;
            count++;
        }
        if (count < n || n < 2)
            continue;
        const double of_mean = (sum[0] * sum[0] + sum[1] * sum[1]) / n;
        squares += of_mean / n;
        variance += fmax(square - of_mean, 0.0) / (n - 1);
        used++;
        mean->n_positions += c / PARTS != counted;
        counted = c / PARTS;
    }
    mean->rms = used > 0 ? sqrt(squares / used) : (double)NAN;
    mean->scatter = used > 0 ? sqrt(variance / used) : (double)NAN;
}

static void compare(struct wb_marker_distance *distance, const struct gallery *gallery, int n,
                    double last)
{
    const int n_cells = gallery->n_positions * PARTS;
    struct cell *const cells = wb_memory_new((size_t)n_cells * (size_t)n, sizeof *cells);
    double squares = 0.0, largest = 0.0;
    for (size_t k = 0; k < gallery->n_points; k++) {
        const struct point *const point = &gallery->points[k];
        double dx, dy;
        if (!displacement(gallery, point, &dx, &dy))
            continue;
        const int part = (int)fmin(PARTS * point->place / last, PARTS - 1.0);
        struct cell *const cell = &cells[point->sample * n_cells + point->position * PARTS + part];
        const double d = hypot(dx, dy);
        cell->dx += dx;
        cell->dy += dy;
        cell->n++;
        squares += d * d;
        largest = fmax(largest, d);
        distance->n_points++;
    }
    if (distance->n_points > 0) {
        distance->rms = sqrt(squares / distance->n_points);
        distance->largest = largest;
    }
    average(&distance->mean, cells, gallery->n_positions, n);
    free(cells);
}

enum wb_status wb_marker_distance_find(struct wb_marker_distance *distance,
                                       struct wb_computed *computed,
                                       const struct wb_material *material,
                                       const struct wb_dataset *const *datasets, int n,
                                       const struct wb_marker_distance_range *range)
{
    const double step = range->step, last = range->last;
    struct wb_marker_distance result = {.rms = (double)NAN,
                                        .largest = (double)NAN,
                                        .mean = {.rms = (double)NAN, .scatter = (double)NAN}};
    struct gallery gallery = {.step = step, .is_follower = datasets[0]->info.is_follower};
    enum wb_status status =
        collect_points(&gallery, datasets, n, last, wb_computed_reason(computed));
    if (status == WB_OK && gallery.n_positions > 0) {
        gallery.n_frames = (int)ceil(last / step - 1e-9) + 1;
        const size_t size = (size_t)gallery.n_frames * (size_t)gallery.n_positions;
        gallery.x = wb_memory_new(size, sizeof *gallery.x);
        gallery.y = wb_memory_new(size, sizeof *gallery.y);
        status = fill(&gallery, computed, material);
        if (status == WB_OK)
            compare(&result, &gallery, n, last);
    }
    if (status == WB_OK)
        *distance = result;
    free(gallery.points);
    free(gallery.x);
    free(gallery.y);
    return status;
}
