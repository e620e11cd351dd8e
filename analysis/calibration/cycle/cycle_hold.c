#include "analysis/calibration/cycle/cycle_hold.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/dataset/stops.h"

/* Least fall that counts as relaxation, in standard errors and as a part of the largest force. */
static const double seen_errors = 4.0, seen_share = 1e-3;
/* One exponential is not enough if its largest residual exceeds this many standard errors and this
 * part of the fall. */
static const double missed_errors = 3.0, missed_share = 0.03;
/* Ratio of the durations of consecutive periods of a dwell. */
static const double growth = 1.5;

enum {
    FEWEST_ROWS = 3,
    TIMES = 60
};

/* Means of the tension over the periods of a stop. */
static void take_periods(struct wb_cycle_data *data, const struct wb_row *rows,
                         const struct wb_stop *stop)
{
    const double first = rows[stop->first].t, last = rows[stop->end - 1].t;
    double length = (last - first) * (growth - 1.0) / (pow(growth, WB_CYCLE_MOST_HELD) - 1.0);
    double end = first;
    size_t i = stop->first;
    for (int k = 0; k < WB_CYCLE_MOST_HELD; k++, length *= growth) {
        double sum = 0.0, squares = 0.0, times = 0.0;
        size_t n = 0;
        end = k == WB_CYCLE_MOST_HELD - 1 ? last : end + length;
        for (; i < stop->end && rows[i].t <= end; i++) {
            if (!isfinite(rows[i].tension))
                continue;
            sum += rows[i].tension;
            squares += rows[i].tension * rows[i].tension;
            times += rows[i].t;
            n++;
        }
        if (n < FEWEST_ROWS)
            continue;
        const double mean = sum / (double)n;
        const double variance = fmax(squares / (double)n - mean * mean, 0.0) / (double)(n - 1);
        data->held[data->n_held++] = (struct wb_cycle_held){
            .t = times / (double)n, .tension = mean, .deviation = sqrt(variance)};
    }
    if (data->n_held < 2)
        data->n_held = 0;
}

void wb_cycle_hold_find(struct wb_cycle_data *data, const struct wb_dataset *dataset, int cycle)
{
    struct wb_stop stop;
    data->n_held = 0;
    data->arrival = data->departure = wb_stops_turn_time(dataset, cycle);
    if (!wb_stops_at_turn(dataset, cycle, &stop))
        return;
    data->arrival = stop.arrival;
    data->departure = stop.departure;
    take_periods(data, dataset->rows, &stop);
}

/* Sum of squared residuals of a + b exp(-t / time) over the periods, in standard errors; *worst is
 * the largest residual, N. */
static double miss_of(const struct wb_cycle_data *data, double time, double *worst)
{
    double w = 0.0, e = 0.0, y = 0.0, ee = 0.0, ey = 0.0, sum = 0.0;
    for (int i = 0; i < data->n_held; i++) {
        const struct wb_cycle_held *const held = &data->held[i];
        const double weight = 1.0 / (held->deviation * held->deviation);
        const double x = exp(-(held->t - data->arrival) / time);
        w += weight;
        e += weight * x;
        y += weight * held->tension;
        ee += weight * x * x;
        ey += weight * x * held->tension;
    }
    const double b = (ey - e * y / w) / (ee - e * e / w), a = (y - b * e) / w;
    *worst = 0.0;
    for (int i = 0; i < data->n_held; i++) {
        const struct wb_cycle_held *const held = &data->held[i];
        const double off = a + b * exp(-(held->t - data->arrival) / time) - held->tension;
        sum += off * off / (held->deviation * held->deviation);
        *worst = fmax(*worst, fabs(off));
    }
    return sum;
}

void wb_cycle_hold_describe(const struct wb_cycle_data *data,
                            struct wb_cycle_relaxation *relaxation)
{
    struct wb_cycle_relaxation *const r = relaxation;
    *r = (struct wb_cycle_relaxation){.duration = 0.0};
    if (data->n_held < 2)
        return;
    const struct wb_cycle_held *const first = &data->held[0];
    const struct wb_cycle_held *const last = &data->held[data->n_held - 1];
    r->duration = data->departure - data->arrival;
    r->fall = first->tension - last->tension;
    r->deviation = hypot(first->deviation, last->deviation);
    r->time = r->duration;
    r->is_seen = r->fall > seen_errors * r->deviation && r->fall > seen_share * data->max_force;
    if (!r->is_seen || data->n_held < 4)
        return;
    double least = (double)INFINITY, worst = 0.0;
    for (int k = 0; k < TIMES; k++) {
        const double time = r->duration * 0.02 * pow(500.0, (double)k / (TIMES - 1));
        double largest;
        const double sum = miss_of(data, time, &largest);
        if (sum < least) {
            least = sum;
            worst = largest;
            r->time = time;
        }
    }
    r->needs_two =
        sqrt(least / (data->n_held - 3)) > missed_errors && worst > missed_share * r->fall;
}
