#include "analysis/calibration/cycle/cycle_data.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/calibration/cycle/cycle_hold.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "cycle"

/* Distance from the turn over which the deflection is linear in the travel of the stage. */
static const double turn_reach = 2.0 * WB_MM;

enum {
    FEWEST_ROWS = 4,   /* in a bin */
    FEWEST_POINTS = 8, /* of a loading */
    MOST_MARKERS = 64,
    MOST_POINTS = 4000
};

/* Rows farther from the line than this many standard deviations of the others are left out. */
static const double far_off = 4.5;
/* A gross outlier can tilt the line so far that its own residual becomes small. Rows this many
 * standard deviations off a line by medians, which outliers do not tilt, are left out first. The
 * medians of a few rows are rough, so the limit is wide. */
static const double out_of_bounds = 15.0;

const struct wb_setting wb_cycle_data_rows[WB_CYCLE_DATA_ROWS] = {
    {WB_ROW_QUANTITY(wb_cycle_data_settings, step, "data_step_mm", "mm", WB_MM, 0.1, 20.0, 1.0),
     WB_ROW_OPTION("data-step-mm", "H", "Deflection step of the points")},
    {WB_ROW_QUANTITY(wb_cycle_data_settings, fine_step, "fine_step_mm", "mm", WB_MM, 0.05, 20.0,
                     0.5),
     WB_ROW_OPTION("fine-step-mm", "H",
                   "Deflection step at the start of loading and of unloading")},
    {WB_ROW_QUANTITY(wb_cycle_data_settings, fine_reach, "fine_reach_mm", "mm", WB_MM, 0.1, 1e3,
                     4.0),
     WB_ROW_OPTION("fine-reach-mm", "D", "Deflection range of the fine step")},
    {WB_ROW_QUANTITY(wb_cycle_data_settings, turn_distance, "turn_distance_mm", "mm", WB_MM, 0.01,
                     100.0, 0.5),
     WB_ROW_OPTION("turn-distance-mm", "D",
                   "Distance below the turning point where unloading begins")},
    {WB_ROW_QUANTITY(wb_cycle_data_settings, smallest_tension, "smallest_tension_mN", "mN", 1e-3,
                     1e-3, 1e6, 2.5),
     WB_ROW_OPTION("smallest-tension-mn", "F", "Tension at which unloading ends")},
    {WB_ROW_QUANTITY(wb_cycle_data_settings, marker_step, "marker_step_mm", "mm", WB_MM, 0.1, 1e3,
                     4.0),
     WB_ROW_OPTION("marker-step-mm", "H", "Deflection step of the marker positions")},
};

/* Rows of a branch (loading or unloading) in their order; allocated for all rows of a test. */
struct rows {
    size_t n;
    double *x, *y;  /* deflection and tension, or another quantity over the deflection */
    double *t;      /* s; of a branch only */
    double *smooth; /* deflection with less noise, by which rows are put into bins */
    double *sorted; /* workspace */
    size_t n_line;
    double *line_x, *line_y; /* (n_line) points of the last fitted line, less their means */
};

static void take_memory(struct rows *rows, size_t most)
{
    double *const memory = wb_memory_new(7 * most, sizeof *memory);
    *rows = (struct rows){.x = memory,
                          .y = memory + most,
                          .smooth = memory + 2 * most,
                          .sorted = memory + 3 * most,
                          .line_x = memory + 4 * most,
                          .line_y = memory + 5 * most,
                          .t = memory + 6 * most};
}

/* Fits a line by medians: first the slope, from pairs of rows half the range apart, then the
 * intercept. Returns the standard deviation that corresponds to the median distance of rows from
 * it. */
static double rough_line(struct rows *rows, size_t begin, size_t end, struct wb_fit_line *line)
{
    const size_t n = end - begin, half = n / 2;
    size_t pairs = 0;
    for (size_t i = begin; i + half < end; i++) {
        const double dx = rows->x[i + half] - rows->x[i];
        if (dx != 0.0)
            rows->sorted[pairs++] = (rows->y[i + half] - rows->y[i]) / dx;
    }
    line->slope = pairs > 0 ? wb_fit_median(rows->sorted, pairs) : 0.0;
    for (size_t i = begin; i < end; i++)
        rows->sorted[i - begin] = rows->y[i] - line->slope * rows->x[i];
    line->value = wb_fit_median(rows->sorted, n);
    for (size_t i = begin; i < end; i++)
        rows->sorted[i - begin] = fabs(rows->y[i] - line->slope * rows->x[i] - line->value);
    return wb_fit_usual_size(rows->sorted, n);
}

/* Means of x and y of the rows from `begin` to `end`, without outliers from a straight line of y
 * over x. Noise of x does not bias the pair of means, whereas it makes the slope of a line too
 * small. Returns the number of rows left; *error is the standard error of the mean of y at the mean
 * of x. */
static size_t mean_of(struct rows *rows, size_t begin, size_t end, double *x, double *y,
                      double *error)
{
    struct wb_fit_line line = {0};
    double mean_x = 0.0, mean_y = 0.0;
    size_t kept = 0;

    if (end < begin + FEWEST_ROWS)
        return 0;
    for (int pass = 0; pass < 3; pass++) {
        double limit;
        if (pass == 0) {
            limit = out_of_bounds * rough_line(rows, begin, end, &line);
        } else {
            for (size_t i = begin; i < end; i++)
                rows->sorted[i - begin] =
                    fabs(rows->y[i] - mean_y - line.slope * (rows->x[i] - mean_x) - line.value);
            limit = far_off * wb_fit_usual_size(rows->sorted, end - begin);
        }
        double sum_x = 0.0, sum_y = 0.0;
        const double center_x = mean_x, center_y = mean_y;
        kept = 0;
        for (size_t i = begin; i < end; i++) {
            const double off =
                rows->y[i] - center_y - line.slope * (rows->x[i] - center_x) - line.value;
            if (fabs(off) > limit)
                continue;
            rows->line_x[kept] = rows->x[i];
            rows->line_y[kept++] = rows->y[i];
            sum_x += rows->x[i];
            sum_y += rows->y[i];
        }
        if (kept < FEWEST_ROWS)
            return 0;
        mean_x = sum_x / (double)kept;
        mean_y = sum_y / (double)kept;
        for (size_t i = 0; i < kept; i++) {
            rows->line_x[i] -= mean_x;
            rows->line_y[i] -= mean_y;
        }
        if (!wb_fit_line(rows->line_x, rows->line_y, kept, &line))
            return 0;
    }
    *x = mean_x;
    *y = mean_y;
    *error = line.residual / sqrt((double)kept);
    rows->n_line = kept;
    return kept;
}

static bool is_on_way(const struct wb_row *row, int cycle, bool unloading)
{
    return row->cycle == cycle && row->phase == (unloading ? WB_PHASE_UNLOAD : WB_PHASE_LOAD) &&
           isfinite(row->deflection) && isfinite(row->tension);
}

/* Slope of y over x of the rows that mean_of() used last. */
static double slope_of(const struct rows *rows)
{
    double xx = 0.0, xy = 0.0;
    for (size_t i = 0; i < rows->n_line; i++) {
        xx += rows->line_x[i] * rows->line_x[i];
        xy += rows->line_x[i] * rows->line_y[i];
    }
    return xx > 0.0 ? xy / xx : 0.0;
}

/* Whether a row is in the dwell, where the tension falls at constant deflection. */
static bool is_in_dwell(const struct wb_cycle_data *data, const struct wb_row *row)
{
    return data->n_held > 0 && row->t > data->arrival && row->t < data->departure;
}

/* Takes the rows of a branch and smooths their deflection over half a fine step. */
static void gather(struct rows *rows, const struct wb_cycle_data *data,
                   const struct wb_dataset *dataset, int cycle, bool unloading, double fine_step)
{
    double low = (double)INFINITY, high = -(double)INFINITY;
    rows->n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_on_way(row, cycle, unloading) || is_in_dwell(data, row))
            continue;
        rows->x[rows->n] = row->deflection;
        rows->t[rows->n] = row->t;
        rows->y[rows->n++] = row->tension;
        low = fmin(low, row->deflection);
        high = fmax(high, row->deflection);
    }
    const double in_step = (double)rows->n * fine_step / (high - low);
    const size_t half = (size_t)fmin(fmax(0.25 * in_step, 0.0), 50.0);
    for (size_t i = 0; i < rows->n; i++) {
        const size_t reach = i < half ? i : rows->n - 1 - i < half ? rows->n - 1 - i : half;
        double sum = 0.0;
        for (size_t k = i - reach; k <= i + reach; k++)
            sum += rows->x[k];
        rows->smooth[i] = sum / (double)(2 * reach + 1);
    }
}

/* Adds a point for each bin of a branch from deflection `first` to `last`: first bins of the fine
 * step, where the wire is elastic and its stiffness changes least, then bins of the step. */
static void take_points(struct wb_cycle_data *data, const struct wb_dataset *dataset,
                        struct rows *rows, const struct wb_cycle_data_settings *s, double first,
                        double last)
{
    const bool unloading = last < first;
    const double sense = unloading ? -1.0 : 1.0;
    double done = 0.0, step;
    size_t begin = 0;

    gather(rows, data, dataset, s->cycle, unloading, s->fine_step);
    while (data->n_points < MOST_POINTS) {
        const double left = fabs(last - first) - done;
        step = done < s->fine_reach - 1e-9 ? s->fine_step : s->step;
        if (unloading)
            step = fmin(step, left); /* the last bin may be shorter: the force reaches that at zero
                                        deflection in it */
        if (step > left + 1e-9 || step < s->fine_step - 1e-9)
            return;
        while (begin < rows->n && sense * (rows->smooth[begin] - first) < done)
            begin++;
        done += step;
        size_t end = begin;
        while (end < rows->n && sense * (rows->smooth[end] - first) < done)
            end++;
        struct wb_cycle_point point = {.is_unloading = unloading};
        const size_t kept =
            mean_of(rows, begin, end, &point.deflection, &point.tension, &point.deviation);
        if (kept == 0)
            continue;
        if (unloading && point.tension < s->smallest_tension)
            return;
        point.n_rows = (int)kept;
        for (size_t i = begin; i < end; i++)
            point.t += rows->t[i] / (double)(end - begin);
        data->n_outliers += (int)(end - begin - kept);
        data->points[data->n_points++] = point;
        begin = end;
    }
}

/* The same for a simulation: each row is a point. Without a strand the force may be negative. */
static void take_rows(struct wb_cycle_data *data, const struct wb_dataset *dataset,
                      struct rows *rows, const struct wb_cycle_data_settings *s, double first,
                      double last)
{
    const bool unloading = last < first;
    const double least = fmin(first, last) + (unloading ? 0.0 : 0.5 * s->fine_step);
    (void)rows;
    for (size_t i = 0; i < dataset->n_rows && data->n_points < MOST_POINTS; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (is_on_way(row, s->cycle, unloading) && row->deflection >= least - 1e-9 &&
            row->deflection <= fmax(first, last) + 1e-9)
            data->points[data->n_points++] = (struct wb_cycle_point){.deflection = row->deflection,
                                                                     .t = row->t,
                                                                     .tension = row->tension,
                                                                     .is_unloading = unloading,
                                                                     .n_rows = 1};
    }
}

/* Deflection of the turn. From a line of the deflection over the travel of the stage near the turn
 * if the travel is known, because the largest of many rows is biased by their noise. */
static double turn_of(const struct wb_dataset *dataset, int cycle, struct rows *rows)
{
    double top = -HUGE_VAL, end = -HUGE_VAL, x, y, error;
    bool has_stage = !dataset->info.is_simulation;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_on_way(row, cycle, false))
            continue;
        top = fmax(top, row->deflection);
        end = fmax(end, row->stage);
        has_stage = has_stage && isfinite(row->stage);
    }
    rows->n = 0;
    for (size_t i = 0; has_stage && i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_on_way(row, cycle, false) || row->stage < end - turn_reach)
            continue;
        rows->x[rows->n] = row->stage;
        rows->y[rows->n++] = row->deflection;
    }
    if (mean_of(rows, 0, rows->n, &x, &y, &error) == 0)
        return top;
    const double turn = y + slope_of(rows) * (end - x);
    return fabs(turn - top) < turn_reach ? turn : top;
}

static double mean_in_dwell(const struct wb_cycle_data *data, const struct wb_dataset *dataset,
                            int cycle)
{
    double sum = 0.0;
    long n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle != cycle || !is_in_dwell(data, row) || !isfinite(row->deflection))
            continue;
        sum += row->deflection;
        n++;
    }
    return n > 0 ? sum / (double)n : data->top;
}

/* Tension where the deflection crosses zero, on the first loading. */
static double tension_at_zero(const struct wb_dataset *dataset)
{
    double sum = 0.0;
    long n = 0;
    /* The alignment subtracted it from the vertical part of the tension. Near zero deflection the
     * strand hangs straight down and the two are the same. */
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (!is_on_way(row, 1, false) || !isfinite(row->force) ||
            !(fabs(row->deflection) < 2 * WB_MM))
            continue;
        sum += row->tension - row->force;
        n++;
    }
    return n > 0 ? sum / (double)n : 0.0;
}

/* Where the unloading crosses the tension of zero deflection. */
static double residual_of(const struct wb_cycle_data *data)
{
    for (int i = data->n_loading; i + 1 < data->n_points; i++) {
        const struct wb_cycle_point *const a = &data->points[i], *const b = a + 1;
        if (a->tension >= data->zero_tension && b->tension < data->zero_tension)
            return b->deflection + (a->deflection - b->deflection) *
                                       (data->zero_tension - b->tension) /
                                       (a->tension - b->tension);
    }
    return (double)NAN;
}

/* Places of the inner markers at every few points: from lines of x and y over the deflection
 * through the neighbouring frames. */
static void take_places(struct wb_cycle_data *data, const struct wb_dataset *dataset,
                        struct rows *rows, const struct wb_cycle_data_settings *s)
{
    enum {
        AXES = 2
    };
    const double length = data->info.length;
    double arc[MOST_MARKERS];
    int markers[MOST_MARKERS], n = 0;

    for (size_t i = 0; i < dataset->n_shape_rows; i++) {
        const struct wb_shape_row *const row = &dataset->shape_rows[i];
        bool known = !(row->s > 0.01 * length && row->s < 0.99 * length);
        for (int k = 0; k < n && !known; k++)
            known = markers[k] == row->marker;
        if (known || n == MOST_MARKERS)
            continue;
        markers[n] = row->marker;
        arc[n++] = row->s;
    }
    /* Frames after the time of the turn belong to the unloading. */
    double turn = (double)INFINITY, end = (double)INFINITY;
    for (size_t i = dataset->n_rows; i-- > 0;) {
        const struct wb_row *const row = &dataset->rows[i];
        turn = is_on_way(row, 1, true) ? row->t : turn;
        end = row->cycle > 1 ? row->t : end;
    }
    double next = 0.0;
    for (int p = 0; p < data->n_points; p++) {
        const struct wb_cycle_point *const point = &data->points[p];
        const double way = point->is_unloading ? data->top - point->deflection : point->deflection;
        if (p == 0 || p == data->n_loading)
            next = 0.0;
        if (way < next)
            continue;
        next = way + s->marker_step;
        for (int m = 0; m < n; m++) {
            struct wb_cycle_place place = {.point = p, .marker = m, .s = arc[m]};
            double value[AXES], at, error;
            bool good = true;
            for (int axis = 0; axis < AXES && good; axis++) {
                rows->n = 0;
                for (size_t i = 0; i < dataset->n_shape_rows; i++) {
                    const struct wb_shape_row *const row = &dataset->shape_rows[i];
                    if (row->marker != markers[m] || (row->t >= turn) != point->is_unloading ||
                        row->t >= end ||
                        !(fabs(row->deflection - point->deflection) < 1.6 * s->step))
                        continue;
                    rows->x[rows->n] = row->deflection;
                    rows->y[rows->n++] = axis == 0 ? row->x : row->y;
                }
                good = mean_of(rows, 0, rows->n, &at, &value[axis], &error) > 0;
                /* A marker moves in proportion to the tip over so short a range. */
                if (good)
                    value[axis] += slope_of(rows) * (point->deflection - at);
            }
            if (!good)
                continue;
            place.x = value[0];
            place.y = value[1];
            data->places[data->n_places++] = place;
        }
    }
    data->n_markers = n;
}

/* The given settings, with defaults in place of zeros. */
static struct wb_cycle_data_settings filled(const struct wb_cycle_data_settings *given)
{
    const struct wb_setting_table table = {.rows = wb_cycle_data_rows, .n = WB_CYCLE_DATA_ROWS};
    struct wb_cycle_data_settings all;
    wb_setting_fill(&table, &all);
    for (size_t i = 0; i < table.n; i++) {
        const size_t at = table.rows[i].offset;
        if (wb_setting_is_given(&table.rows[i], given))
            memcpy((char *)&all + at, (const char *)given + at, sizeof(double));
    }
    return all;
}

static enum wb_status take(struct wb_cycle_data *data, const struct wb_dataset *dataset,
                           struct rows *rows, const struct wb_cycle_data_settings *given,
                           struct wb_reason *why)
{
    struct wb_cycle_data_settings s = filled(given);
    s.cycle = given->cycle > 0 ? given->cycle : 1;
    const char *const wire = data->info.wire;

    data->top = turn_of(dataset, s.cycle, rows);
    if (!(data->top > 0.0))
        return wb_fail_to(why, WB_ERR_DATA, "wire '%s', sample %d: cycle %d has no loading", wire,
                          data->info.sample, s.cycle);
    data->zero_tension = tension_at_zero(dataset);
    wb_cycle_hold_find(data, dataset, s.cycle);
    if (data->n_held > 0)
        data->top = mean_in_dwell(data, dataset, s.cycle);
    void (*const way)(struct wb_cycle_data *, const struct wb_dataset *, struct rows *,
                      const struct wb_cycle_data_settings *, double, double) =
        data->info.is_simulation ? take_rows : take_points;
    way(data, dataset, rows, &s, 0.0, data->top);
    data->n_loading = data->n_points;
    if (data->n_loading < FEWEST_POINTS)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: the loading of cycle %d makes %d points of %g mm: "
                          "expected at least %d",
                          wire, data->info.sample, s.cycle, data->n_loading, s.step / WB_MM,
                          FEWEST_POINTS);
    way(data, dataset, rows, &s, data->top - s.turn_distance, 0.0);
    if (data->n_points - data->n_loading < FEWEST_POINTS)
        data->n_points = data->n_loading;
    for (int i = 0; i < data->n_points; i++)
        data->max_force = fmax(data->max_force, data->points[i].tension - data->zero_tension);
    if (!(data->max_force > 0.0))
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: the tension does not rise with the deflection: "
                          "expected a loading",
                          wire, data->info.sample);
    data->residual_deflection = residual_of(data);
    if (s.cycle == 1)
        take_places(data, dataset, rows, &s);
    return WB_OK;
}

enum wb_status wb_cycle_data_take(struct wb_cycle_data *data, const struct wb_dataset *dataset,
                                  const struct wb_cycle_data_settings *settings,
                                  struct wb_reason *why)
{
    const struct wb_cycle_data_settings defaults = {0};
    struct rows rows;
    *data = (struct wb_cycle_data){.info = dataset->info};
    if (dataset->info.is_follower || dataset->info.is_general)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: the tip is not raised by a strand or a vertical "
                          "force: expected such a test",
                          dataset->info.wire, dataset->info.sample);
    data->points = wb_memory_new(MOST_POINTS, sizeof *data->points);
    data->places = wb_memory_new(dataset->n_shape_rows, sizeof *data->places);
    take_memory(&rows, dataset->n_rows + dataset->n_shape_rows);
    const enum wb_status status = take(data, dataset, &rows, settings ? settings : &defaults, why);
    free(rows.x);
    if (status != WB_OK)
        wb_cycle_data_release(data);
    return status;
}

void wb_cycle_data_release(struct wb_cycle_data *data)
{
    free(data->points);
    free(data->places);
    *data = (struct wb_cycle_data){0};
}
