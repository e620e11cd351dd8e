#include "analysis/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WB_LOG_DOMAIN "shapes"

/* Most different arc lengths at which markers sit. */
#define MOST_POSITIONS 256

/* Shapes of the model at equal steps of deflection, at every arc length that has a marker. */
struct gallery {
    int n_positions, n_frames, n_reached;
    double s[MOST_POSITIONS];
    double *x, *y; /* (n_frames * n_positions) */
    double step;
};

/* Time at which the first loading ends. */
static double end_of_loading(const struct wb_dataset *dataset)
{
    double end = -HUGE_VAL;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == 1 && row->phase == WB_PHASE_LOAD)
            end = fmax(end, row->t);
    }
    return end;
}

static bool counts(const struct wb_shape_row *row, double end, double last)
{
    return row->t <= end && row->s > 0.0 && row->deflection >= 0.0 && row->deflection <= last &&
           isfinite(row->x) && isfinite(row->y);
}

static int find_position(const struct gallery *gallery, double s)
{
    for (int i = 0; i < gallery->n_positions; i++) {
        if (fabs(gallery->s[i] - s) < 1e-9)
            return i;
    }
    return -1;
}

static enum wb_status collect_positions(struct gallery *gallery,
                                        const struct wb_dataset *const *datasets, int n,
                                        double last)
{
    for (int i = 0; i < n; i++) {
        const double end = end_of_loading(datasets[i]);
        for (size_t k = 0; k < datasets[i]->n_shape_rows; k++) {
            const struct wb_shape_row *const row = &datasets[i]->shape_rows[k];
            if (!counts(row, end, last) || find_position(gallery, row->s) >= 0)
                continue;
            if (gallery->n_positions == MOST_POSITIONS)
                return wb_fail(WB_ERR_DATA, "wire '%s': markers at more than %d arc lengths",
                               datasets[i]->info.wire, MOST_POSITIONS);
            gallery->s[gallery->n_positions++] = row->s;
        }
    }
    return WB_OK;
}

static enum wb_status fill(struct gallery *gallery, struct wb_computed *computed,
                           const struct wb_material *material)
{
    bool reached;
    double force;
    WB_TRY(wb_computed_start(computed, material, &reached));
    for (int i = 0; reached && i < gallery->n_frames; i++) {
        if (i > 0)
            WB_TRY(wb_computed_move(computed, i * gallery->step, &force, &reached));
        if (!reached)
            break;
        wb_computed_shape(computed, gallery->n_positions, gallery->s,
                          gallery->x + i * gallery->n_positions,
                          gallery->y + i * gallery->n_positions);
        gallery->n_reached = i + 1;
    }
    return WB_OK;
}

/* Distance of one marker; false when the model did not get there. */
static bool marker_distance(const struct gallery *gallery, const struct wb_shape_row *row,
                            double *distance)
{
    const double place = row->deflection / gallery->step;
    int frame = (int)place;
    if (frame == gallery->n_frames - 1)
        frame--;
    if (frame < 0 || frame + 1 >= gallery->n_reached)
        return false;
    const double part = place - frame;
    const int at = frame * gallery->n_positions + find_position(gallery, row->s);
    const int next = at + gallery->n_positions;
    const double x = (1.0 - part) * gallery->x[at] + part * gallery->x[next];
    const double y = (1.0 - part) * gallery->y[at] + part * gallery->y[next];
    *distance = hypot(row->x - x, row->y - y);
    return true;
}

static void compare(struct wb_shapes_distance *distance, const struct gallery *gallery,
                    const struct wb_dataset *const *datasets, int n, double last)
{
    double squares = 0.0;
    distance->largest = 0.0;
    for (int i = 0; i < n; i++) {
        const double end = end_of_loading(datasets[i]);
        for (size_t k = 0; k < datasets[i]->n_shape_rows; k++) {
            const struct wb_shape_row *const row = &datasets[i]->shape_rows[k];
            double d;
            if (!counts(row, end, last) || !marker_distance(gallery, row, &d))
                continue;
            squares += d * d;
            distance->largest = fmax(distance->largest, d);
            distance->n_points++;
        }
    }
    if (distance->n_points > 0)
        distance->rms = sqrt(squares / distance->n_points);
    else
        distance->rms = distance->largest = (double)NAN;
}

enum wb_status wb_shapes_compare(struct wb_shapes_distance *distance, struct wb_computed *computed,
                                 const struct wb_material *material,
                                 const struct wb_dataset *const *datasets, int n,
                                 const struct wb_shapes_range *range)
{
    const double step = range->step, last = range->last;
    struct wb_shapes_distance result = {(double)NAN, (double)NAN, 0};
    struct gallery gallery = {.step = step};
    WB_TRY(collect_positions(&gallery, datasets, n, last));
    if (gallery.n_positions == 0) {
        *distance = result;
        return WB_OK;
    }
    gallery.n_frames = (int)ceil(last / step - 1e-9) + 1;
    const size_t size = (size_t)gallery.n_frames * (size_t)gallery.n_positions;
    gallery.x = malloc(size * sizeof *gallery.x);
    gallery.y = malloc(size * sizeof *gallery.y);
    enum wb_status status = WB_OK;
    if (!gallery.x || !gallery.y)
        status = wb_fail(WB_ERR_MEMORY, "no memory for %d shapes", gallery.n_frames);
    if (status == WB_OK)
        status = fill(&gallery, computed, material);
    if (status == WB_OK) {
        compare(&result, &gallery, datasets, n, last);
        *distance = result;
    }
    free(gallery.x);
    free(gallery.y);
    return status;
}
