#include "analysis/calibration/three_point/three_point_data.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "three-point"

const struct wb_setting wb_three_point_data_rows[WB_THREE_POINT_DATA_ROWS] = {
    {WB_ROW_NUMBER(wb_three_point_data_settings, seating, "seating", 0.0, 0.1, 0.01),
     WB_ROW_OPTION("seating", "R",
                   "Part of the span, beyond the first contact, that is excluded from the fit")},
    {WB_ROW_QUANTITY(wb_three_point_data_settings, usable, "usable_mm", "mm", WB_MM, 1e-3, 1e5,
                     0.0),
     WB_ROW_OPTION("usable-mm", "D", "Largest travel that is used"),
     .otherwise = "as the specimen's file says, else up to a kink"},
    {WB_ROW_NUMBER(wb_three_point_data_settings, step, "point_step", 1e-4, 0.05, 5e-3),
     WB_ROW_OPTION("point-step", "R", "Part of the span between fitted points")},
};

enum {
    LEAST_POINTS = 10,
    LEAST_BEFORE = 5, /* fewest readings before the contact that give a zero */
    MOST_POINTS = 1000
};

/* Parts of the largest force between which a line is extrapolated back to the first contact; of
 * means over an odd number of readings, up to the limit, such that their noise is below the first
 * of them. */
static const double line_from = 0.02, line_to = 0.08;
enum {
    MOST_MEAN = 21
};
/* The zero comes from readings before the contact by this part of the span, or by this part of the
 * distance to it if that is short. */
static const double zero_distance = 0.01, zero_part = 0.5;
/* A kink: the force, as a mean over a quarter of this part of the span, decreases by more than this
 * part of its largest value so far (and several times its noise) within the part. Not where the
 * force is below this part of its largest value, where the noise of a soft wire is as large. */
static const double kink_drop = 0.03, kink_reach = 0.03, kink_noises = 6.0, kink_from = 0.2;
enum {
    KINK_MEANS = 4
};
/* Distance from the turn to the beginning of the unloading, as part of the span and at most of the
 * unloading: friction reverses there. */
static const double turn_distance = 0.02, turn_part = 0.25;
/* Part of the largest force at which the unloading ends; a wire with little springback has as many
 * points. */
static const double last_force = 0.03;
enum {
    LEAST_BACK = 12
};
static const double largest_part = 1.0 / 3.0; /* of the span */

const char *wb_three_point_limit_name(enum wb_three_point_limit limit)
{
    static const char *const names[WB_THREE_POINT_LIMITS] = {"end of the loading", "given", "kink",
                                                             "third of the span"};
    return names[limit];
}

/* The readings of the first loading, by increasing travel, and of the unloading. */
struct readings {
    size_t n, top;          /* number of readings; index of the largest travel */
    double *travel, *force; /* (n), one block */
};

static void collect(const struct wb_dataset *dataset, struct readings *r)
{
    r->travel = wb_memory_new(2 * dataset->n_rows, sizeof *r->travel);
    r->force = r->travel + dataset->n_rows;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle != dataset->rows[0].cycle || !isfinite(row->deflection) ||
            !isfinite(row->force))
            continue;
        r->travel[r->n] = row->deflection;
        r->force[r->n] = row->force;
        if (row->deflection > r->travel[r->top])
            r->top = r->n;
        r->n++;
    }
}

/* Mean of a reading with up to `half` others on each side, the same number on both. */
static double mean_about(const struct readings *r, size_t i, size_t half)
{
    const size_t room = i < r->top - i ? i : r->top - i, reach = half < room ? half : room;
    double sum = 0.0;
    for (size_t k = i - reach; k <= i + reach; k++)
        sum += r->force[k];
    return sum / (double)(2 * reach + 1);
}

/* Finds where the line through the first rise of the force is zero. */
static bool find_contact(const struct readings *r, double zero, double largest, double noise,
                         size_t last, double *contact)
{
    const double needed = pow(noise / (line_from * largest), 2);
    const size_t half = needed < MOST_MEAN ? (size_t)(0.5 * needed) : MOST_MEAN / 2;
    size_t from = 0, to = 0;
    for (size_t i = 0; i <= last && mean_about(r, i, half) - zero < line_to * largest; i++)
        to = i + 1;
    for (size_t i = 0; i < to; i++) {
        if (mean_about(r, i, half) - zero < line_from * largest)
            from = i + 1;
    }
    /* A coarse curve has few readings there: then the first two are used. */
    if (to < from + 3) {
        to = from + 3;
        if (to > last)
            return false;
    }
    struct wb_fit_line line;
    double *const force = wb_memory_new(to - from, sizeof *force);
    for (size_t i = from; i < to; i++)
        force[i - from] = r->force[i] - zero;
    const bool found = wb_fit_line(r->travel + from, force, to - from, &line) && line.slope > 0.0;
    free(force);
    *contact = found ? -line.value / line.slope : (double)NAN;
    return found;
}

/* Median of the readings before the contact by more than `distance`. */
static bool find_zero(const struct readings *r, double contact, double distance, double *zero)
{
    size_t n = 0;
    while (n < r->top && r->travel[n] < contact - distance)
        n++;
    if (n < LEAST_BEFORE)
        return false;
    double *const values = wb_memory_new(n, sizeof *values);
    memcpy(values, r->force, n * sizeof *values);
    *zero = wb_fit_median(values, n);
    free(values);
    return true;
}

/* Scatter of single readings about the mean of their neighbours. */
static double find_noise(const struct readings *r, size_t last)
{
    if (last < 3)
        return 0.0;
    double *const values = wb_memory_new(last, sizeof *values);
    for (size_t i = 1; i < last; i++)
        values[i - 1] = fabs(r->force[i] - 0.5 * (r->force[i - 1] + r->force[i + 1]));
    const double noise = wb_fit_usual_size(values, last - 1) / sqrt(1.5);
    free(values);
    return noise;
}

/* Index of the last reading before the force drops. */
static size_t find_kink(const struct readings *r, double reach, double noise)
{
    double lowest = r->force[0], most = r->force[0], highest = -HUGE_VAL, highest_at = 0.0;
    size_t largest = 0;
    for (size_t i = 1; i <= r->top; i++) {
        lowest = fmin(lowest, r->force[i]);
        most = fmax(most, r->force[i]);
    }
    const double from = lowest + kink_from * (most - lowest);
    for (size_t i = 0; i <= r->top;) {
        const double until = r->travel[i] + reach / KINK_MEANS;
        const size_t first = i;
        double mean = 0.0;
        for (; i <= r->top && (i == first || r->travel[i] < until); i++)
            mean += r->force[i];
        const double n = (double)(i - first);
        mean /= n;
        if (highest > from && r->travel[first] - highest_at < reach &&
            mean < highest - fmax(kink_drop * fabs(highest), kink_noises * noise / sqrt(n)))
            return largest;
        for (size_t k = first; k < i; k++)
            largest = r->force[k] > r->force[largest] ? k : largest;
        if (mean > highest) {
            highest = mean;
            highest_at = r->travel[i - 1];
        }
    }
    return r->top;
}

/* Force at a travel, from a line through the readings around it, or between two of them. */
static double force_at(const struct readings *r, size_t from, size_t to, double travel,
                       double half_step)
{
    size_t n = 0, first = from;
    double before_t = (double)NAN, before_f = 0.0;
    for (size_t i = from; i <= to; i++) {
        if (fabs(r->travel[i] - travel) <= half_step) {
            if (n == 0)
                first = i;
            n = i - first + 1;
        }
    }
    struct wb_fit_line line;
    if (n >= 4) {
        double *const x = wb_memory_new(n, sizeof *x);
        for (size_t i = 0; i < n; i++)
            x[i] = r->travel[first + i] - travel;
        const bool fitted = wb_fit_line(x, r->force + first, n, &line);
        free(x);
        if (fitted)
            return line.value;
    }
    for (size_t i = from; i <= to; i++) {
        if (isfinite(before_t) && (before_t - travel) * (r->travel[i] - travel) <= 0.0 &&
            before_t != r->travel[i])
            return before_f +
                   (travel - before_t) / (r->travel[i] - before_t) * (r->force[i] - before_f);
        before_t = r->travel[i];
        before_f = r->force[i];
    }
    return (double)NAN;
}

static void add_point(struct wb_three_point_data *data, double travel, double force,
                      bool is_unloading)
{
    if (!isfinite(force) || data->n_points == MOST_POINTS)
        return;
    data->points[data->n_points++] = (struct wb_three_point_point){travel, force, is_unloading};
    data->max_force = fmax(data->max_force, force);
}

/* The unloading is used if the wire was loaded within its usable range. */
static void add_unloading(struct wb_three_point_data *data, const struct readings *r, double span,
                          double step)
{
    const double first = data->points[0].travel, top = r->travel[r->top], largest = data->max_force;
    size_t end = r->top;
    if (data->usable < top - 0.5 * step)
        return;
    while (end + 1 < r->n && r->travel[end] > first &&
           r->force[end] - data->zero_force > last_force * largest)
        end++;
    const double distance = top - r->travel[end];
    const double from = top - fmin(turn_distance * span, turn_part * distance);
    step = fmin(step, (from - r->travel[end]) / LEAST_BACK);
    for (double at = from; step > 0.0 && at > first; at -= step) {
        const double force = force_at(r, r->top, end - 1, at, 0.5 * step) - data->zero_force;
        if (!(force > last_force * largest))
            break;
        add_point(data, at, force, true);
        data->has_unloading = true;
    }
}

static void add_points(struct wb_three_point_data *data, const struct readings *r, double span,
                       const struct wb_three_point_data_settings *s, size_t last)
{
    const double first = data->first_contact + s->seating * span;
    const double step = s->step * span;
    const int n = (int)floor((data->usable - first) / step);
    for (int i = 0; i <= n && i < MOST_POINTS / 2; i++) {
        const double at = data->usable - (n - i) * step;
        add_point(data, at, force_at(r, 0, last, at, 0.5 * step) - data->zero_force, false);
    }
    if (data->n_points > 0)
        add_unloading(data, r, span, step);
}

static enum wb_status fail_without_contact(const struct wb_three_point_data *data, double largest,
                                           struct wb_reason *why)
{
    char noise[80] = "";
    if (data->noise > line_from * largest)
        snprintf(noise, sizeof noise, "; its readings scatter by %.2g N, which may hide it",
                 data->noise);
    return wb_fail_to(
        why, WB_ERR_DATA,
        "wire '%s', sample %d: no first contact: the force does not rise from zero to %.3g N at "
        "%.3g mm (%s)%s: check the sign of the force, and that the test begins before the contact; "
        "or give the usable part of the test (usable_travel_mm, --usable-mm)",
        data->info.wire, data->info.sample, largest, data->usable / WB_MM,
        wb_three_point_limit_name(data->limit), noise);
}

static enum wb_status make(struct wb_three_point_data *data, const struct readings *r,
                           const struct wb_three_point_data_settings *s, struct wb_reason *why)
{
    const struct wb_test_info *const info = &data->info;
    const double span = info->length;
    const struct wb_band *const given = &info->piece.usable_travel;

    data->noise = find_noise(r, r->top);
    data->usable = r->travel[r->top];
    data->limit = WB_THREE_POINT_LIMIT_END;
    const double wanted = s->usable > 0.0 ? s->usable : given->known ? given->least : 0.0;
    size_t last = r->top;
    if (wanted > 0.0) {
        while (last > 0 && r->travel[last] > wanted)
            last--;
        if (wanted < data->usable)
            data->limit = WB_THREE_POINT_LIMIT_GIVEN;
        data->usable = fmin(data->usable, wanted);
    } else {
        last = find_kink(r, kink_reach * span, data->noise);
        if (last < r->top)
            data->limit = WB_THREE_POINT_LIMIT_KINK;
        data->usable = r->travel[last];
    }
    double largest = 0.0;
    for (size_t i = 0; i <= last; i++)
        largest = fmax(largest, r->force[i]);
    bool found = find_contact(r, 0.0, largest, data->noise, last, &data->first_contact);
    const double before = zero_part * (data->first_contact - r->travel[0]);
    data->is_zeroed = found && find_zero(r, data->first_contact, fmin(zero_distance * span, before),
                                         &data->zero_force);
    if (data->is_zeroed)
        found = find_contact(r, data->zero_force, largest - data->zero_force, data->noise, last,
                             &data->first_contact);
    if (!found)
        return fail_without_contact(data, largest, why);
    if (data->usable > data->first_contact + largest_part * span) {
        data->usable = data->first_contact + largest_part * span;
        data->limit = WB_THREE_POINT_LIMIT_THIRD;
    }
    data->points = wb_memory_new(MOST_POINTS, sizeof *data->points);
    add_points(data, r, span, s, r->top);
    if (data->n_points < LEAST_POINTS)
        return wb_fail_to(why, WB_ERR_DATA,
                          "wire '%s', sample %d: %d points from %.3g to %.3g mm of travel (%s), "
                          "expected at least %d: give the usable part of the test "
                          "(usable_travel_mm, --usable-mm), or use less seating (--seating)",
                          info->wire, info->sample, data->n_points,
                          (data->first_contact + s->seating * span) / WB_MM, data->usable / WB_MM,
                          wb_three_point_limit_name(data->limit), LEAST_POINTS);
    return WB_OK;
}

enum wb_status wb_three_point_data_make(struct wb_three_point_data *data,
                                        const struct wb_dataset *dataset,
                                        const struct wb_three_point_data_settings *settings,
                                        struct wb_reason *why)
{
    struct readings readings = {.n = 0};
    enum wb_status status = WB_OK;

    *data = (struct wb_three_point_data){.info = dataset->info};
    if (dataset->info.kind != WB_TEST_THREE_POINT)
        return wb_fail_to(why, WB_ERR_DATA, "wire '%s': not a three-point bending test",
                          dataset->info.wire);
    collect(dataset, &readings);
    if (readings.n < LEAST_POINTS)
        status = wb_fail_to(why, WB_ERR_DATA, "wire '%s', sample %d: %zu rows: expected %d",
                            dataset->info.wire, dataset->info.sample, readings.n, LEAST_POINTS);
    if (status == WB_OK)
        status = make(data, &readings, settings, why);
    free(readings.travel);
    if (status != WB_OK)
        wb_three_point_data_release(data);
    return status;
}

int wb_three_point_data_count_loading(const struct wb_three_point_data *data)
{
    int n = 0;
    while (n < data->n_points && !data->points[n].is_unloading)
        n++;
    return n;
}

double wb_three_point_data_force(const struct wb_three_point_data *data, double travel,
                                 bool is_unloading)
{
    const int loading = wb_three_point_data_count_loading(data);
    const int end = is_unloading ? data->n_points : loading;
    const double sense = is_unloading ? -1.0 : 1.0;
    int i = (is_unloading ? loading : 0) + 1;
    while (i + 1 < end && sense * data->points[i].travel < sense * travel)
        i++;
    const struct wb_three_point_point *const a = &data->points[i - 1], *const b = &data->points[i];
    return a->force + (travel - a->travel) / (b->travel - a->travel) * (b->force - a->force);
}

void wb_three_point_data_release(struct wb_three_point_data *data)
{
    free(data->points);
    data->points = NULL;
    data->n_points = 0;
}
