#include "daq/protocol/loss.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* s; a time stamp that goes back by more shows a restart of the device. */
#define RESTART 0.5
/* s; a longer silence is an interruption of the stream, which is reported elsewhere. */
#define LONGEST 60.0
/* Fractions of the period. */
#define SAME 0.25     /* stamps with a smaller difference are equal */
#define LONG 1.6      /* a longer interval between arrivals may contain a lost sample */
#define IN_RHYTHM 0.4 /* tolerance of a regular interval */
/* Least fraction of regular intervals; with fewer, the arrivals have no period. */
#define LEAST_RHYTHM 0.6
/* If the typical interval is shorter than the mean by more than this factor, lines arrive in
 * bundles; a loss of more than half of the lines is excluded. */
#define MOST_OFTEN 2.5
/* Number of stamps in order after which a gap is final: more than networks reorder. At the
 * beginning of a stream as many stamps are not evaluated, because the first one may be out of
 * order. */
#define TURNED_ROUND 8
/* Least number of arrivals and duration (s) of a window: longer than short delays of a busy
 * computer.
 */
#define WINDOW 16
#define WINDOW_TIME 0.1
/* With fewer windows, a period cannot be distinguished from one that differs by a line per window.
 */
#define LEAST_WINDOWS 8
/* Largest mean square of the fractions of periods, in periods; above it, there is no period. */
#define MOST_MISFIT 0.05
/* Relative uncertainty of the period from intervals: lower bound, and factor of the square of the
 * relative scatter of the intervals. Covers all of 2000 simulated streams of each kind. */
#define LEAST_DOUBT 0.005
#define DOUBT 3.5
/* Upper bound of the samples missing between two windows: a damaged recording has random stamps. */
#define MOST_MISSING 1e9
/* Fraction of arrivals that may seem to be missing on a busy computer. */
#define CHANCE 0.02

void wb_loss_init(struct wb_loss *loss, bool stamped, double period)
{
    memset(loss, 0, sizeof *loss);
    loss->stamped = stamped;
    loss->counts.period = period;
}

/* --- the period --- */

static int ascending(const void *a, const void *b)
{
    const double left = *(const double *)a, right = *(const double *)b;
    return (left > right) - (left < right);
}

/* The period of the stored times; 0: none. Lost samples make intervals longer, never shorter:
 * therefore the lower quartile is used for stamps, which tolerates three quarters of lost samples.
 * Arrivals scatter, and the median is used. */
static double find_period(const struct wb_loss *loss, double *doubt)
{
    double intervals[WB_LOSS_LEARNT];
    int n = 0;
    for (int i = 1; i < loss->n_times; i++) {
        const double interval = loss->times[i] - loss->times[i - 1];
        if (interval >= 0.0 && (interval > 0.0 || !loss->stamped))
            intervals[n++] = interval;
    }
    if (n < WB_LOSS_LEARNT / 4)
        return 0.0;
    qsort(intervals, (size_t)n, sizeof *intervals, ascending);
    const double typical = intervals[loss->stamped ? n / 4 : n / 2];
    double sum = 0.0, squares = 0.0;
    int used = 0;
    for (int i = 0; i < n; i++) {
        const double off = intervals[i] - typical;
        if (fabs(off) > IN_RHYTHM * typical)
            continue;
        sum += off;
        squares += off * off;
        used++;
    }
    const double least = loss->stamped ? 0.1 : LEAST_RHYTHM;
    const double mean = (loss->times[loss->n_times - 1] - loss->times[0]) / (loss->n_times - 1);
    if (!loss->stamped && mean > MOST_OFTEN * typical)
        return 0.0;
    if (!(typical > 0.0) || used < least * n)
        return 0.0;
    const double off = sum / used;
    *doubt = fmax(DOUBT * (squares / used - off * off) / (typical * typical), LEAST_DOUBT);
    return typical + off;
}

/* --- stamped --- */

static bool is_recent(const struct wb_loss *loss, double t)
{
    for (int i = 0; i < loss->n_times; i++) {
        if (fabs(t - loss->times[i]) < SAME * loss->counts.period)
            return true;
    }
    return false;
}

static void remember(struct wb_loss *loss, double t)
{
    loss->times[loss->next] = t;
    loss->next = (loss->next + 1) % WB_LOSS_RECENT;
    if (loss->n_times < WB_LOSS_RECENT)
        loss->n_times++;
}

static void add_open(struct wb_loss_counts *counts, const struct wb_loss_open *open)
{
    counts->missing += open->missing;
    counts->gaps += open->gaps;
    counts->longest_gap = fmax(counts->longest_gap, open->longest_gap);
}

static void open_gap(struct wb_loss *loss, double step)
{
    loss->young.missing += (uint64_t)(round(step / loss->counts.period) - 1.0);
    loss->young.gaps++;
    loss->young.longest_gap = fmax(loss->young.longest_gap, step - loss->counts.period);
}

/* Makes gaps final that are old enough. */
static void grow_old(struct wb_loss *loss)
{
    if (++loss->n_passed < TURNED_ROUND)
        return;
    loss->has_begun = true;
    add_open(&loss->counts, &loss->old);
    loss->old = loss->young;
    memset(&loss->young, 0, sizeof loss->young);
    loss->n_passed = 0;
}

/* A late sample closes a gap, most likely one of the latest. */
static void make_up(struct wb_loss *loss)
{
    struct wb_loss_open *const open = loss->young.missing > 0 ? &loss->young : &loss->old;
    loss->counts.overtaken++;
    if (open->missing == 0)
        loss->counts.missing -= loss->counts.missing > 0;
    else if (--open->missing == 0)
        memset(open, 0, sizeof *open);
}

static void take_stamp(struct wb_loss *loss, double t)
{
    const double period = loss->counts.period, step = loss->has_last ? t - loss->last : period;
    if (is_recent(loss, t)) {
        loss->counts.repeated++;
        return;
    }
    loss->counts.received++;
    remember(loss, t);
    if (step < 0.0 && step > -RESTART) {
        make_up(loss);
        return;
    }
    grow_old(loss);
    if (loss->has_begun && step > 1.5 * period && step < LONGEST)
        open_gap(loss, step);
    loss->last = t;
    loss->has_last = true;
}

/* --- arrivals --- */

/* Number of periods between two arrivals minus the number of lines received: nearly an integer. */
static double periods_more(const struct wb_loss_arrival *from, const struct wb_loss_arrival *to,
                           double period)
{
    return (to->t - from->t) / period - (to->number - from->number);
}

/* Mean square of the fractions of a period over the windows; fewer periods than lines count as the
 * largest fraction. */
static double misfit(const struct wb_loss *loss, double period)
{
    double sum = 0.0;
    for (int i = 1; i < loss->n_windows; i++) {
        const double more =
            periods_more(&loss->windows[i - 1].earliest, &loss->windows[i].earliest, period);
        const double off = more > -0.5 ? more - round(more) : 0.5;
        sum += off * off;
    }
    return sum / (loss->n_windows - 1);
}

/* Finds the period near that from the intervals with the smallest misfit; of equal ones the
 * longest.
 */
static void fit_period(struct wb_loss *loss)
{
    const struct wb_loss_arrival *const first = &loss->windows[0].earliest,
                                        *const last = &loss->windows[loss->n_windows - 1].earliest;
    const double step = 0.04 * (loss->n_windows - 1) / (last->number - first->number);
    const bool is_clear = loss->doubt < 0.5 / WINDOW;
    double best = (double)INFINITY;
    for (double off = loss->doubt; off > -loss->doubt; off -= step) {
        const double period = loss->learnt * (1.0 + off), left = misfit(loss, period);
        if (left < best) {
            best = left;
            loss->counts.period = period;
        }
    }
    loss->is_fitted = best < MOST_MISFIT && (is_clear || loss->n_windows >= LEAST_WINDOWS);
}

/* Adds the samples missing between window i and the window before. */
static void add_missing(const struct wb_loss *loss, int i, struct wb_loss_open *sum)
{
    const struct wb_loss_window *const window = &loss->windows[i], *const before = window - 1;
    const double more = periods_more(&before->earliest, &window->earliest, loss->counts.period);
    const double missing = fmin(round(more), MOST_MISSING);
    if (!(missing >= 1.0))
        return;
    const int n_long = before->n_long + window->n_long;
    const double widest = fmax(before->widest, window->widest);
    sum->missing += (uint64_t)missing;
    sum->gaps += n_long < 1 ? 1 : n_long < missing ? (uint64_t)n_long : (uint64_t)missing;
    sum->longest_gap = fmax(sum->longest_gap, widest - loss->counts.period);
}

/* Removes the oldest window; the samples missing up to the next one become final. */
static void settle(struct wb_loss *loss)
{
    struct wb_loss_open open = {0};
    if (loss->is_fitted)
        add_missing(loss, 1, &open);
    add_open(&loss->counts, &open);
    loss->n_windows--;
    memmove(loss->windows, loss->windows + 1, (size_t)loss->n_windows * sizeof *loss->windows);
}

/* Removes windows whose earliest arrival was delayed, as shown by a later window: the computer had
 * not processed its backlog yet. */
static void drop_late(struct wb_loss *loss)
{
    int kept = loss->n_windows - 1; /* index of the first window kept */
    for (int i = kept - 1; i >= 0; i--)
        if (periods_more(&loss->windows[i].earliest, &loss->windows[kept].earliest,
                         loss->counts.period) >= -0.5)
            loss->windows[--kept] = loss->windows[i];
    loss->n_windows -= kept;
    memmove(loss->windows, loss->windows + kept, (size_t)loss->n_windows * sizeof *loss->windows);
}

static void close_window(struct wb_loss *loss)
{
    if (loss->n_windows == WB_LOSS_WINDOWS)
        settle(loss);
    loss->windows[loss->n_windows++] = loss->window;
    loss->n_window = 0;
    memset(&loss->recent, 0, sizeof loss->recent);
    if (loss->n_windows < 2)
        return;
    const struct wb_loss_arrival *const from = &loss->windows[0].earliest,
                                        *const to = &loss->windows[loss->n_windows - 1].earliest;
    loss->slope = (to->t - from->t) / (to->number - from->number);
    fit_period(loss);
    if (!loss->is_fitted)
        return;
    drop_late(loss);
    for (int i = 1; i < loss->n_windows - 1; i++)
        add_missing(loss, i, &loss->recent);
}

/* Starts counting again after an interruption of the stream, which is reported elsewhere. */
static void begin_again(struct wb_loss *loss)
{
    add_open(&loss->counts, &loss->recent);
    memset(&loss->recent, 0, sizeof loss->recent);
    loss->n_windows = loss->n_window = 0;
}

static void take_arrival(struct wb_loss *loss, double t)
{
    const double interval = loss->has_last ? t - loss->last : 0.0;
    struct wb_loss_window *const window = &loss->window;
    if (interval > LONGEST)
        begin_again(loss);
    loss->counts.received++;
    const struct wb_loss_arrival arrival = {(double)loss->counts.received, t};
    loss->tail[loss->counts.received % WB_LOSS_TAIL] = arrival;
    if (loss->n_window++ == 0) {
        *window = (struct wb_loss_window){.earliest = arrival};
        loss->begun = t;
    }
    if (periods_more(&window->earliest, &arrival, loss->slope) < 0.0)
        window->earliest = arrival;
    window->n_long += interval >= LONG * loss->counts.period && interval <= LONGEST;
    window->widest = fmax(window->widest, interval <= LONGEST ? interval : 0.0);
    loss->last = t;
    loss->has_last = true;
    if (loss->n_window >= WINDOW && t - loss->begun >= WINDOW_TIME)
        close_window(loss);
}

/* --- both --- */

static void take(struct wb_loss *loss, double t)
{
    if (loss->stamped)
        take_stamp(loss, t);
    else
        take_arrival(loss, t);
}

/* Finds the period once there are enough times, and counts them. Without a period the oldest half
 * is discarded; later times may be regular. */
static void learn(struct wb_loss *loss)
{
    double times[WB_LOSS_LEARNT + 1];
    const int n = loss->n_times;
    const double period = find_period(loss, &loss->doubt);
    memcpy(times, loss->times, sizeof times);
    loss->n_times = loss->next = 0;
    if (period > 0.0) {
        loss->counts.period = loss->learnt = period;
        loss->slope = (times[n - 1] - times[0]) / (n - 1);
        for (int i = 0; i < n; i++)
            take(loss, times[i]);
        return;
    }
    loss->counts.received += (uint64_t)(n / 2);
    for (int i = n / 2; i < n; i++)
        loss->times[loss->n_times++] = times[i];
}

void wb_loss_add(struct wb_loss *loss, double t)
{
    if (!isfinite(t)) {
        loss->counts.received++;
    } else if (loss->counts.period > 0.0) {
        take(loss, t);
    } else {
        loss->times[loss->n_times++] = t;
        if (loss->n_times > WB_LOSS_LEARNT)
            learn(loss);
    }
}

/* Adds the samples missing up to and after the last window, which may still arrive. */
static void add_end(const struct wb_loss *loss, struct wb_loss_counts *counts)
{
    struct wb_loss_open open = {0};
    double least = (double)INFINITY;
    if (!loss->is_fitted || loss->n_windows < 2)
        return;
    const struct wb_loss_window *const last = &loss->windows[loss->n_windows - 1];
    add_missing(loss, loss->n_windows - 1, &open);
    for (int i = 0; i < WB_LOSS_TAIL && loss->n_window >= WB_LOSS_TAIL; i++)
        least = fmin(least, periods_more(&last->earliest, &loss->tail[i], counts->period));
    const double missing = isfinite(least) ? fmin(round(least), MOST_MISSING) : 0.0;
    if (missing >= 1.0) {
        open.missing += (uint64_t)missing;
        open.gaps++;
        open.longest_gap = fmax(open.longest_gap, loss->window.widest - counts->period);
    }
    add_open(counts, &open);
}

struct wb_loss_counts wb_loss_counts(const struct wb_loss *loss)
{
    struct wb_loss_counts counts = loss->counts;
    if (!(counts.period > 0.0))
        counts.received += (uint64_t)loss->n_times;
    add_open(&counts, &loss->recent);
    if (!loss->stamped)
        add_end(loss, &counts);
    return counts;
}

double wb_loss_share(const struct wb_loss_counts *counts)
{
    const double all = (double)counts->received + (double)counts->missing;
    return all > 0.0 ? (double)counts->missing / all : 0.0;
}

bool wb_loss_is_significant(const struct wb_loss *loss)
{
    struct wb_loss_counts counts = loss->counts;
    add_open(&counts, &loss->recent);
    return counts.missing > 0 && (loss->stamped || wb_loss_share(&counts) > CHANCE);
}
