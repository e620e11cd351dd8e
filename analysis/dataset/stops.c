#include "analysis/dataset/stops.h"

#include <math.h>
#include <stdlib.h>

#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

/* A stop: the position stays within this range, m, for this time, s, longer than the cycle's own
 * speed needs to pass through the range. */
static const double stop_reach = 0.15 * WB_MM, stop_time = 0.8;

enum {
    MOST_STOPS = 64 /* of a cycle */
};

/* The rows of a cycle, and the position that is examined. */
struct motion {
    const struct wb_row *rows;
    size_t begin, end; /* of the cycle's rows */
    bool has_stage;
    double speed; /* m/s; NaN: nothing moves */
};

static double place_of(const struct motion *m, size_t i)
{
    return m->has_stage ? m->rows[i].stage : m->rows[i].deflection;
}

/* Median of the speed over stretches in motion that are long compared with the noise of a place. */
static double find_speed(const struct motion *m)
{
    double *const speeds = wb_memory_new(m->end - m->begin, sizeof *speeds);
    size_t from = m->begin, n = 0;
    for (size_t i = m->begin; i < m->end; i++) {
        const double past = m->rows[i].t - m->rows[from].t;
        const double way = fabs(place_of(m, i) - place_of(m, from));
        if (!isfinite(place_of(m, from)))
            from = i;
        if (past < stop_time || !(way > 2.0 * stop_reach))
            continue;
        speeds[n++] = way / past;
        from = i;
    }
    const double median = n > 0 ? wb_fit_median(speeds, n) : (double)NAN;
    free(speeds);
    return median;
}

/* The first stop from row `from` on. */
static bool find_stop(const struct motion *m, double least_tension, size_t from,
                      struct wb_stop *stop)
{
    const double passing = 2.0 * stop_reach / m->speed; /* s: time in the range without a stop */
    for (size_t i = from; i < m->end; i++) {
        if (!(m->rows[i].tension > least_tension) || !isfinite(place_of(m, i)))
            continue;
        size_t end = i + 1;
        while (end < m->end && fabs(place_of(m, end) - place_of(m, i)) <= stop_reach)
            end++;
        const double begin = m->rows[i].t + passing, last = m->rows[end - 1].t - passing;
        if (!(last - begin >= stop_time))
            continue;
        *stop = (struct wb_stop){i, end, begin - 0.5 * passing, last + 0.5 * passing};
        while (m->rows[stop->first].t < begin)
            stop->first++;
        while (m->rows[stop->end - 1].t > last)
            stop->end--;
        return true;
    }
    return false;
}

int wb_stops_find(const struct wb_dataset *dataset, int cycle, double least_tension,
                  struct wb_stop *stops, int most)
{
    struct motion m = {.rows = dataset->rows, .has_stage = true};
    int n = 0;
    for (size_t i = 0; i < dataset->n_rows; i++)
        m.has_stage = m.has_stage && isfinite(m.rows[i].stage);
    for (; m.begin < dataset->n_rows && !dataset->info.is_simulation; m.begin = m.end) {
        m.end = m.begin + 1;
        while (m.end < dataset->n_rows && m.rows[m.end].cycle == m.rows[m.begin].cycle)
            m.end++;
        if (cycle > 0 && m.rows[m.begin].cycle != cycle)
            continue;
        m.speed = find_speed(&m);
        size_t from = m.begin;
        while (n < most && m.speed > 0.0 && find_stop(&m, least_tension, from, &stops[n]))
            from = stops[n++].end;
    }
    return n;
}

double wb_stops_turn_time(const struct wb_dataset *dataset, int cycle)
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

bool wb_stops_at_turn(const struct wb_dataset *dataset, int cycle, struct wb_stop *stop)
{
    struct wb_stop stops[MOST_STOPS];
    const int n = wb_stops_find(dataset, cycle, -(double)INFINITY, stops, MOST_STOPS);
    const double t = wb_stops_turn_time(dataset, cycle);
    for (int i = 0; i < n; i++) {
        if (t < stops[i].arrival - stop_time || t > stops[i].departure + stop_time)
            continue;
        *stop = stops[i];
        return true;
    }
    return false;
}
