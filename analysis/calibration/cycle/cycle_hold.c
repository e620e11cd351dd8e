#include "analysis/calibration/cycle/cycle_hold.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "cycle"

/* Nothing moves where it stays within this, m, for this time, s, beyond what the test's own speed
 * takes to come in and to leave. */
static const double stop_reach = 0.15 * WB_MM, stop_time = 0.8;
/* A fall is seen from so many standard errors and this part of the largest force on. */
static const double seen_errors = 4.0, seen_share = 1e-3;
/* One exponential is not enough where it misses by more than this many standard errors and this
 * part of the fall. */
static const double missed_errors = 3.0, missed_share = 0.03;
/* Each period of a dwell is longer than the one before by this factor. */
static const double growth = 1.5;

enum {
    FEWEST_ROWS = 3,
    MOST_STOPS = 64,
    TIMES = 60
};

/* A test's rows, and what moves: the stage where all rows know it, else the deflection. */
struct motion {
    const struct wb_row *rows;
    size_t n;
    bool has_stage;
    double speed; /* m/s; NaN unknown */
};

static double place_of(const struct motion *m, size_t i)
{
    return m->has_stage ? m->rows[i].stage : m->rows[i].deflection;
}

/* The median of the speed over times that are long beside the noise of a place. */
static double find_speed(const struct motion *m)
{
    double *const speeds = wb_memory_new(m->n, sizeof *speeds);
    size_t from = 0, n = 0;
    for (size_t i = 0; i < m->n; i++) {
        const double past = m->rows[i].t - m->rows[from].t;
        if (past < stop_time)
            continue;
        const double speed = fabs(place_of(m, i) - place_of(m, from)) / past;
        if (isfinite(speed))
            speeds[n++] = speed;
        from = i;
    }
    const double median = n > 0 ? wb_fit_median(speeds, n) : (double)NAN;
    free(speeds);
    return median;
}

/* The first stop from row `from` on. */
static bool find_stop(const struct motion *m, double least_tension, size_t from,
                      struct wb_cycle_stop *stop)
{
    const double passing = 2.0 * stop_reach / m->speed; /* s, within reach without a stop */
    for (size_t i = from; i < m->n; i++) {
        if (!(m->rows[i].tension > least_tension) || !isfinite(place_of(m, i)))
            continue;
        size_t end = i + 1;
        while (end < m->n && fabs(place_of(m, end) - place_of(m, i)) <= stop_reach)
            end++;
        const double begin = m->rows[i].t + passing, last = m->rows[end - 1].t - passing;
        if (last - begin < stop_time)
            continue;
        *stop = (struct wb_cycle_stop){i, end, begin - 0.5 * passing, last + 0.5 * passing};
        while (m->rows[stop->first].t < begin)
            stop->first++;
        while (m->rows[stop->end - 1].t > last)
            stop->end--;
        return true;
    }
    return false;
}

int wb_cycle_hold_stops(const struct wb_dataset *dataset, double least_tension,
                        struct wb_cycle_stop *stops, int most)
{
    struct motion m = {.rows = dataset->rows, .n = dataset->n_rows, .has_stage = true};
    for (size_t i = 0; i < m.n; i++)
        m.has_stage = m.has_stage && isfinite(m.rows[i].stage);
    m.speed = find_speed(&m);
    size_t from = 0;
    int n = 0;
    while (n < most && m.speed > 0.0 && find_stop(&m, least_tension, from, &stops[n]))
        from = stops[n++].end;
    return n;
}

/* Means of the tension over the periods of a stop. */
static void take_periods(struct wb_cycle_data *data, const struct wb_row *rows,
                         const struct wb_cycle_stop *stop)
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

/* Time of the largest deflection on the loading of a cycle; NaN: it has none. */
static double time_of_top(const struct wb_dataset *dataset, int cycle)
{
    double t = (double)NAN, top = -(double)INFINITY;
    for (size_t i = 0; i < dataset->n_rows; i++) {
        const struct wb_row *const row = &dataset->rows[i];
        if (row->cycle == cycle && row->phase == WB_PHASE_LOAD && row->deflection > top) {
            top = row->deflection;
            t = row->t;
        }
    }
    return t;
}

void wb_cycle_hold_find(struct wb_cycle_data *data, const struct wb_dataset *dataset, int cycle)
{
    struct wb_cycle_stop stops[MOST_STOPS];
    const int n = data->info.is_simulation
                      ? 0
                      : wb_cycle_hold_stops(dataset, -(double)INFINITY, stops, MOST_STOPS);
    const double t = time_of_top(dataset, cycle);
    data->n_held = 0;
    data->arrival = data->departure = t;
    for (int i = 0; i < n; i++) {
        if (t < stops[i].arrival - stop_time || t > stops[i].departure + stop_time)
            continue;
        data->arrival = stops[i].arrival;
        data->departure = stops[i].departure;
        take_periods(data, dataset->rows, &stops[i]);
        return;
    }
}

/* Sum of squares, in standard errors, by which a + b exp(-t / time) misses the periods; *worst is
 * the largest miss, N. */
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

int wb_cycle_hold_elements(const struct wb_cycle_data *const *data, int n)
{
    int seen = 0, two = 0;
    for (int i = 0; i < n; i++) {
        struct wb_cycle_relaxation r;
        wb_cycle_hold_describe(data[i], &r);
        seen += r.is_seen;
        two += r.needs_two;
    }
    return 2 * seen < n || seen == 0 ? 0 : 2 * two < n || two == 0 ? 1 : 2;
}
