#include "analysis/import/sync.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "analysis/dataset/fit.h"
#include "analysis/import/reversal_lag.h"
#include "base/memory.h"

/* Duration (s) of a tap on each side of its middle: half of that of wb_signal_shake(), which shows
 * the tap again, inverted, on either side. */
#define TAP_HALF 0.1
/* A tap exceeds the noise of its signal by this factor, and this part of the largest value. */
#define TAP_NOISE 10.0
#define TAP_PART 0.3
/* Only values above this multiple of the noise contribute to the middle of a tap; otherwise small
 * values far away would shift it. */
#define FLOOR_NOISE 4.0
/* Events closer together than this, s, are one event. */
#define SAME_TAP 0.6
/* Smallest return that counts as a turn, as part of the whole range. */
#define TURN_PART 0.15
/* Lines to the top of a turn are fitted over at most this time, s, and this part of a branch. */
#define SIDE_WINDOW 2.5
#define SIDE_PART 0.4
/* Largest time between paired events after subtracting the lag, s. */
#define TAP_GATE 0.12
#define TURN_GATE 1.0
/* Number of iterations of the lag, which end when it changes by less than this, s. */
#define ROUNDS 6
#define ARRIVED 0.01
/* Largest uncertainty with which a lag is accepted, s. */
#define MOST_UNCERTAINTY 0.25
#define MOST_EVENTS 64

struct event {
    double t, deviation; /* s */
    /* Of a turn, s, approximate: beginning of its branch, beginning of the next branch, and
     * duration of its rest. */
    double from, until, rest;
};

struct events {
    int n;
    struct event at[MOST_EVENTS];
};

const char *wb_sync_name(enum wb_sync_method method)
{
    static const char *const names[] = {"none", "tap", "reversal", "given", "one clock"};
    return names[method];
}

static double median_period(const struct wb_signal *s)
{
    return s->n > 1 ? (s->t[s->n - 1] - s->t[0]) / (double)(s->n - 1) : 1.0;
}

/* --- taps --- */

/* Middle of the tap around sample i. */
static struct event tap_at(const struct wb_signal *shake, size_t i, double floor)
{
    const double middle = shake->t[i];
    double sum = 0.0, moment = 0.0;
    for (size_t k = wb_signal_index(shake, middle - TAP_HALF);
         k < shake->n && shake->t[k] <= middle + TAP_HALF; k++) {
        const double weight = fmax(fabs(shake->x[k]) - floor, 0.0);
        sum += weight;
        moment += weight * (shake->t[k] - middle);
    }
    const double period = median_period(shake);
    return (struct event){.t = middle + (sum > 0.0 ? moment / sum : 0.0),
                          .deviation = 0.5 * period};
}

static void find_taps(const struct wb_signal *shake, struct events *taps)
{
    double largest = 0.0;
    double *const sizes = wb_memory_new(shake->n, sizeof *sizes);
    taps->n = 0;
    for (size_t i = 0; i < shake->n; i++) {
        sizes[i] = fabs(shake->x[i]);
        largest = fmax(largest, sizes[i]);
    }
    const double noise = wb_fit_usual_size(sizes, shake->n);
    free(sizes);
    const double threshold = fmax(TAP_NOISE * noise, TAP_PART * largest);
    for (size_t i = 0; i < shake->n && largest > 0.0;) {
        if (!(fabs(shake->x[i]) >= threshold)) {
            i++;
            continue;
        }
        size_t best = i;
        const double until = shake->t[i] + SAME_TAP;
        for (; i < shake->n && shake->t[i] < until; i++)
            best = fabs(shake->x[i]) > fabs(shake->x[best]) ? i : best;
        if (taps->n < MOST_EVENTS)
            taps->at[taps->n++] = tap_at(shake, best, fmax(0.2 * threshold, FLOOR_NOISE * noise));
    }
}

/* --- reversals --- */

/* A turn: its highest sample, and the lowest before and after. */
struct turn {
    size_t before, peak, after;
};

/* Follows the signal up and down; an extremum is a turn if the signal returns far enough. */
static int find_turns(const double *y, size_t n, double least, struct turn *turns)
{
    size_t low = 0, high = 0;
    bool rising = true;
    int count = 0;
    for (size_t i = 0; i < n; i++) {
        if (rising) {
            if (y[i] > y[high])
                high = i;
            if (y[i] < y[low] && y[high] - y[low] < least)
                low = high = i;
            if (y[high] - y[i] > least && y[high] - y[low] > least && count < MOST_EVENTS) {
                turns[count++] = (struct turn){.before = low, .peak = high, .after = i};
                rising = false;
                low = i;
            }
        } else {
            if (y[i] < y[low])
                low = i;
            turns[count - 1].after = low;
            if (y[i] - y[low] > least) {
                rising = true;
                high = i;
            }
        }
    }
    return count;
}

/* Finds where a line through a side of a turn, from the sample `far` to `near`, reaches the value
 * `top`. */
static bool reaches(const struct wb_signal *s, const double *y, size_t far, size_t near, double top,
                    double *t)
{
    const double window = fmin(SIDE_WINDOW, SIDE_PART * fabs(s->t[near] - s->t[far]));
    const bool rises = far < near;
    const size_t from = rises ? wb_signal_index(s, s->t[near] - window) : near;
    const size_t until = rises ? near : wb_signal_index(s, s->t[near] + window);
    double *const x = wb_memory_new(until - from, sizeof *x);
    struct wb_fit_line line;
    for (size_t i = from; i < until; i++)
        x[i - from] = s->t[i] - s->t[near];
    const bool found = until > from + 5 && wb_fit_line(x, y + from, until - from, &line) &&
                       (rises ? line.slope > 0.0 : line.slope < 0.0);
    free(x);
    if (found)
        *t = s->t[near] + (top - line.value) / line.slope;
    return found && fabs(*t - s->t[near]) < 2.0 * SIDE_WINDOW;
}

/* Approximate turn: the middle between the straight lines that reach and leave it. */
static bool place(const struct wb_signal *s, const double *y, const struct turn *turn, double noise,
                  struct event *event)
{
    const double near = fmax(5.0 * noise, 0.003 * (y[turn->peak] - y[turn->before]));
    size_t first = turn->before, last = turn->after, n = 0;
    double top = 0.0, left;
    while (first < turn->peak && y[first] < y[turn->peak] - near)
        first++;
    while (last > turn->peak && y[last] < y[turn->peak] - near)
        last--;
    /* The largest of many samples is biased by noise. */
    for (size_t i = turn->peak < 10 ? 0 : turn->peak - 10; i < s->n && i <= turn->peak + 10; i++) {
        if (y[i] >= y[turn->peak] - near) {
            top += y[i];
            n++;
        }
    }
    top /= (double)n;
    if (!reaches(s, y, turn->before, first, top, &event->t) ||
        !reaches(s, y, turn->after, last, top, &left))
        return false;
    event->rest = fmax(0.0, left - event->t);
    event->from = s->t[turn->before];
    event->until = s->t[turn->after];
    event->deviation = 1.0;
    return true;
}

/* Finds the approximate turns of |x - x(0)|. */
static void find_reversals(const struct wb_signal *s, struct events *events)
{
    struct turn turns[MOST_EVENTS];
    double *const y = wb_memory_new(s->n, sizeof *y);
    double most = 0.0;
    events->n = 0;
    const double noise = wb_signal_noise(s), zero = s->n > 0 ? s->x[0] : 0.0;
    double sign = 1.0;
    for (size_t i = 0; i < s->n; i++) {
        if (fabs(s->x[i] - zero) > fabs(most)) {
            most = s->x[i] - zero;
            sign = most < 0.0 ? -1.0 : 1.0;
        }
    }
    for (size_t i = 0; i < s->n; i++)
        y[i] = sign * (s->x[i] - zero);
    const double least = fmax(TURN_PART * fabs(most), 20.0 * noise);
    const int n = s->n > 16 && most != 0.0 ? find_turns(y, s->n, least, turns) : 0;
    for (int i = 0; i < n; i++)
        events->n += place(s, y, &turns[i], noise, &events->at[events->n]);
    free(y);
}

/* --- pairing --- */

struct pairing {
    int n;
    double lag, deviation, first;
};

/* The event of `b` that is paired with the event of `a` at this lag; -1: none. */
static int partner_of(const struct event *a, const struct events *b, double lag, double gate)
{
    int best = -1;
    for (int k = 0; k < b->n; k++) {
        const double off = fabs(a->t - b->at[k].t - lag);
        if (off < gate && (best < 0 || off < fabs(a->t - b->at[best].t - lag)))
            best = k;
    }
    return best;
}

static struct pairing pair_at(const struct events *a, const struct events *b, double lag,
                              double gate)
{
    struct wb_reversal_mean mean = {0};
    struct pairing pairing = {.first = HUGE_VAL};
    for (int i = 0; i < a->n; i++) {
        const int k = partner_of(&a->at[i], b, lag, gate);
        if (k < 0)
            continue;
        wb_reversal_mean_add(&mean, a->at[i].t - b->at[k].t,
                             hypot(a->at[i].deviation, b->at[k].deviation));
        pairing.first = fmin(pairing.first, a->at[i].t);
    }
    pairing.n = mean.n;
    if (mean.n > 0)
        wb_reversal_mean_find(&mean, &pairing.lag, &pairing.deviation);
    return pairing;
}

/* The lag that pairs the most events; false if another lag pairs as many. */
static bool pair(const struct events *a, const struct events *b, double gate, struct pairing *best)
{
    int rival = 0;
    *best = (struct pairing){0};
    for (int i = 0; i < a->n; i++) {
        for (int k = 0; k < b->n; k++) {
            const struct pairing p = pair_at(a, b, a->at[i].t - b->at[k].t, gate);
            const bool same = best->n > 0 && fabs(p.lag - best->lag) < 2.0 * gate;
            if (p.n > best->n) {
                rival = same ? rival : best->n;
                *best = p;
            } else if (!same) {
                rival = p.n > rival ? p.n : rival;
            }
        }
    }
    return best->n > 0 && best->n > rival && 2 * best->n >= (a->n < b->n ? a->n : b->n);
}

/* --- lags of reversals --- */

struct lag_search {
    const struct wb_signal *motion, *force;
    double filter_delay;
    double *shifted; /* (force->n), times of the force on the motion's clock */
    struct wb_reversal_mean mean;
};

/* Adds the lag at one turn, starting from an approximate lag. */
static void add_turn(struct lag_search *s, const struct wb_reversal *reversal, double lag)
{
    const struct wb_signal force = {s->shifted, s->force->x, s->force->n};
    struct wb_reversal_lag found = {.lag = HUGE_VAL};
    for (int round = 0; round < ROUNDS && !(fabs(found.lag) < ARRIVED); round++) {
        for (size_t i = 0; i < force.n; i++)
            s->shifted[i] = s->force->t[i] + lag;
        if (!wb_reversal_lag_find(&found, s->motion, &force, reversal, s->filter_delay))
            return;
        lag -= found.lag;
    }
    if (fabs(found.lag) < ARRIVED)
        wb_reversal_mean_add(&s->mean, lag,
                             fmax(found.uncertainty, 0.1 * median_period(s->motion)));
}

static void add_event(struct lag_search *s, const struct event *motion, double lag)
{
    struct wb_reversal reversals[2];
    const int n = wb_reversal_list(reversals, motion->from, motion->t, motion->t + motion->rest,
                                   motion->until);
    for (int i = 0; i < n; i++)
        add_turn(s, &reversals[i], lag);
}

static void find_lags(const struct wb_signal *motion, const struct wb_signal *force,
                      const struct events *a, const struct events *b, double filter_delay,
                      struct pairing *pairing)
{
    struct lag_search s = {.motion = motion,
                           .force = force,
                           .filter_delay = filter_delay,
                           .shifted = wb_memory_new(force->n, sizeof *s.shifted)};
    int n = 0;
    for (int i = 0; i < a->n; i++) {
        const int k = partner_of(&a->at[i], b, pairing->lag, TURN_GATE), before = s.mean.n;
        if (k < 0)
            continue;
        add_event(&s, &a->at[i], a->at[i].t - b->at[k].t);
        n += s.mean.n > before;
    }
    free(s.shifted);
    pairing->n = n;
    pairing->deviation = HUGE_VAL;
    if (n > 0)
        wb_reversal_mean_find(&s.mean, &pairing->lag, &pairing->deviation);
}

/* --- methods --- */

/* Whether the events of both signals can be paired in exactly one way. */
static bool match(struct pairing *pairing, enum wb_sync_method method, const struct events *a,
                  const struct events *b, char reason[120])
{
    if (a->n == 0 || b->n == 0)
        snprintf(reason, 120, "no %s in %s", wb_sync_name(method),
                 a->n == 0 && b->n == 0 ? "either signal"
                 : a->n == 0            ? "the motion"
                                        : "the force");
    else if (!pair(a, b, method == WB_SYNC_TAP ? TAP_GATE : TURN_GATE, pairing))
        snprintf(reason, 120, "%d %ss in the motion and %d in the force fit in more than one way",
                 a->n, wb_sync_name(method), b->n);
    else
        return true;
    return false;
}

static void set_lag(struct wb_sync *sync, enum wb_sync_method method, const struct pairing *pairing,
                    double extra, char reason[120])
{
    const double uncertainty = hypot(pairing->deviation, extra);
    if (!(uncertainty < HUGE_VAL)) {
        snprintf(reason, 120, "the force has no distinct corner at the %s", wb_sync_name(method));
        return;
    }
    if (!(uncertainty < MOST_UNCERTAINTY)) {
        snprintf(reason, 120, "the %s leaves %.0f ms of uncertainty", wb_sync_name(method),
                 uncertainty * 1e3);
        return;
    }
    if (sync->method != WB_SYNC_NONE && sync->uncertainty <= uncertainty)
        return;
    sync->method = method;
    sync->lag = pairing->lag;
    sync->uncertainty = uncertainty;
    sync->n_events = pairing->n;
    sync->first_event = pairing->first;
}

static void find_by_tap(struct wb_sync *sync, const struct wb_signal *shake,
                        const struct wb_signal *force, double filter_delay, char reason[120])
{
    struct events a, b;
    struct pairing pairing;
    double *const out = wb_memory_new(force->n, sizeof *out);
    wb_signal_shake(force, out);
    const struct wb_signal shaken = {force->t, out, force->n};
    find_taps(shake, &a);
    find_taps(&shaken, &b);
    free(out);
    /* A filter delays a short event less than a ramp. */
    if (match(&pairing, WB_SYNC_TAP, &a, &b, reason))
        set_lag(sync, WB_SYNC_TAP, &pairing, 0.5 * filter_delay, reason);
}

static void find_by_reversal(struct wb_sync *sync, const struct wb_signal *motion,
                             const struct wb_signal *force, double filter_delay, char reason[120])
{
    struct events a, b;
    struct pairing pairing;
    find_reversals(motion, &a);
    find_reversals(force, &b);
    if (!match(&pairing, WB_SYNC_REVERSAL, &a, &b, reason))
        return;
    find_lags(motion, force, &a, &b, filter_delay, &pairing);
    set_lag(sync, WB_SYNC_REVERSAL, &pairing, 0.0, reason);
}

void wb_sync_find(struct wb_sync *sync, const struct wb_signal *motion,
                  const struct wb_signal *shake, const struct wb_signal *force,
                  const struct wb_sync_settings *settings)
{
    char tap[120] = "", reversal[120] = "";
    *sync = (struct wb_sync){.lag = (double)NAN, .uncertainty = (double)NAN};
    if (settings->tap)
        find_by_tap(sync, shake, force, settings->filter_delay, tap);
    if (settings->reversal)
        find_by_reversal(sync, motion, force, settings->filter_delay, reversal);
    if (sync->method == WB_SYNC_NONE)
        snprintf(sync->reason, sizeof sync->reason, "%s%s%s", tap,
                 tap[0] && reversal[0] ? "; " : "", reversal);
}
