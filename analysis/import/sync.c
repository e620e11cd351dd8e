#include "analysis/import/sync.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/dataset/fit.h"

#define WB_LOG_DOMAIN "sync"

/* A tap is over within this time, s, on each side of its middle. */
#define TAP_HALF 0.2
/* A tap rises above the noise of its signal by this factor, and over this part of the largest. */
#define TAP_NOISE 10.0
#define TAP_PART 0.3
/* Events nearer than this, s, are one. */
#define SAME_TAP 0.6
/* A turn is a way back by this part of the whole way. */
#define TURN_PART 0.15
/* Parabolas at a corner see so much time, s, or the time in which the signal moves by so many
 * deviations of its noise, and this part of a branch at most. */
#define CORNER_WINDOW 2.5
#define CORNER_NOISE 50.0
/* Windows of this part show how much the parabolas leave out of the curve. */
#define SHORTER 0.6
#define CORNER_PART 0.4
/* A motion that stays for longer than this, s, rests before it turns. */
#define DWELL 0.3
/* Pairs of events may be apart by this, s, once the lag is taken off. */
#define PAIR_GATE 0.12
/* A lag is given only if it is known to this, s. */
#define MOST_UNCERTAINTY 0.25
#define MOST_EVENTS 64

struct event {
    double t, deviation; /* s */
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

/* --- signals --- */

static size_t index_at(const struct wb_sync_signal *s, double t)
{
    return wb_fit_first_at(s->t, sizeof *s->t, s->n, t);
}

/* Straight between samples; the ends go on. */
static double value_at(const struct wb_sync_signal *s, double t)
{
    const size_t next = index_at(s, t);
    if (next == 0)
        return s->x[0];
    if (next == s->n)
        return s->x[s->n - 1];
    const double part = (t - s->t[next - 1]) / (s->t[next] - s->t[next - 1]);
    return (1.0 - part) * s->x[next - 1] + part * s->x[next];
}

static double median_period(const struct wb_sync_signal *s)
{
    return s->n > 1 ? (s->t[s->n - 1] - s->t[0]) / (double)(s->n - 1) : 1.0;
}

double wb_sync_noise(const struct wb_sync_signal *s)
{
    if (s->n < 8)
        return 0.0;
    double *const second = malloc(s->n * sizeof *second);
    if (!second)
        return (double)NAN;
    for (size_t i = 1; i + 1 < s->n; i++)
        second[i - 1] = fabs(s->x[i - 1] - 2.0 * s->x[i] + s->x[i + 1]);
    const double median = wb_fit_median(second, s->n - 2);
    free(second);
    return 1.4826 * median / sqrt(6.0);
}

void wb_sync_shake(const struct wb_sync_signal *s, double *out)
{
    for (size_t i = 0; i < s->n; i++) {
        const double t = s->t[i];
        const bool inside = t - TAP_HALF >= s->t[0] && t + TAP_HALF <= s->t[s->n - 1];
        out[i] =
            inside ? s->x[i] - 0.5 * (value_at(s, t - TAP_HALF) + value_at(s, t + TAP_HALF)) : 0.0;
    }
}

/* --- taps --- */

/* Middle of what stands out around sample i. */
static struct event tap_at(const struct wb_sync_signal *shake, size_t i, double floor)
{
    const double middle = shake->t[i];
    double sum = 0.0, moment = 0.0;
    for (size_t k = index_at(shake, middle - TAP_HALF);
         k < shake->n && shake->t[k] <= middle + TAP_HALF; k++) {
        const double weight = fmax(fabs(shake->x[k]) - floor, 0.0);
        sum += weight;
        moment += weight * (shake->t[k] - middle);
    }
    const double period = median_period(shake);
    return (struct event){.t = middle + (sum > 0.0 ? moment / sum : 0.0),
                          .deviation = 0.5 * period};
}

static enum wb_status find_taps(const struct wb_sync_signal *shake, struct events *taps)
{
    double largest = 0.0;
    double *const sizes = malloc((shake->n + 1) * sizeof *sizes);
    taps->n = 0;
    if (!sizes)
        return WB_ERR_MEMORY;
    for (size_t i = 0; i < shake->n; i++) {
        sizes[i] = fabs(shake->x[i]);
        largest = fmax(largest, sizes[i]);
    }
    const double noise = 1.4826 * wb_fit_median(sizes, shake->n);
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
            taps->at[taps->n++] = tap_at(shake, best, 0.2 * threshold);
    }
    return WB_OK;
}

/* --- reversals --- */

/* A turn: its highest sample, and the lowest before and after. */
struct turn {
    size_t before, peak, after;
};

/* Walks up and down; a turn counts when the way back is long enough. */
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

/* Parabola through the samples from..to of time, about `zero`: value, slope and curvature there. */
static bool fit_side(const struct wb_sync_signal *s, const double *y, double from, double to,
                     double zero, double c[3], double *deviation)
{
    const size_t first = index_at(s, from), last = index_at(s, to);
    const size_t n = last > first ? last - first : 0;
    if (n < 6)
        return false;
    double *const x = malloc(n * sizeof *x);
    if (!x)
        return false;
    for (size_t i = 0; i < n; i++)
        x[i] = s->t[first + i] - zero;
    const bool fitted = wb_fit_parabola(x, y + first, n, c, deviation);
    free(x);
    return fitted;
}

/* The root of c0 + c1 x + c2 x^2 nearest to 0, no farther than `most`. */
static bool nearest_root(const double c[3], double most, double *root)
{
    const double d = c[1] * c[1] - 4.0 * c[2] * c[0];
    if (!(d >= 0.0) || c[1] == 0.0)
        return false;
    *root = -2.0 * c[0] / (c[1] + copysign(sqrt(d), c[1]));
    return fabs(*root) <= most;
}

struct corner {
    double level_from, level_to; /* s: the signal is at its peak between these */
    double left, right;          /* s, of the parabolas' windows: their outer ends */
    double guard;                /* s */
};

/* Where two parabolas, or one and a level (right side NULL), meet. Twice, the second time about
 * the meeting point, so that deviations are those of values there. */
static bool meet(const struct wb_sync_signal *s, const double *y, const struct corner *corner,
                 const double *level, struct event *event)
{
    double zero = corner->level_from, moved = 0.0;
    for (int round = 0; round < 2; round++) {
        double a[3], b[3] = {0.0}, da, db = 0.0;
        if (!fit_side(s, y, corner->left, corner->level_from - corner->guard, zero, a, &da))
            return false;
        if (level)
            b[0] = *level;
        else if (!fit_side(s, y, corner->level_to + corner->guard, corner->right, zero, b, &db))
            return false;
        const double c[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
        if (!nearest_root(c, corner->right - corner->left, &moved))
            return false;
        const double slope = fabs(c[1] + 2.0 * c[2] * moved);
        event->t = zero + moved;
        event->deviation = hypot(da, db) / slope;
        /* Corners must stand out of what their sides scatter. */
        if (!(slope > 0.0) || !isfinite(event->deviation))
            return false;
        zero = event->t;
    }
    return true;
}

/* Length of the window on the branch between the samples `far` and `near`, s. */
static double window_of(const struct wb_sync_signal *s, const double *y, size_t far, size_t near,
                        double noise)
{
    const double time = fabs(s->t[near] - s->t[far]), way = fabs(y[near] - y[far]);
    const double needed = way > 0.0 ? CORNER_NOISE * noise * time / way : 0.0;
    return fmin(fmax(CORNER_WINDOW, needed), CORNER_PART * time);
}

static void place_corner(const struct wb_sync_signal *s, const double *y, const struct turn *turn,
                         double noise, double guard, struct corner *corner)
{
    const double near = fmax(5.0 * noise, 0.003 * (y[turn->peak] - y[turn->before]));
    size_t first = turn->peak, last = turn->peak;
    while (first > turn->before && y[first - 1] >= y[turn->peak] - near)
        first--;
    while (last < turn->after && y[last + 1] >= y[turn->peak] - near)
        last++;
    /* Noise may leave and come back. */
    for (size_t i = turn->before; i < first; i++)
        if (y[i] >= y[turn->peak] - near)
            first = i;
    for (size_t i = turn->after; i > last; i--)
        if (y[i] >= y[turn->peak] - near)
            last = i;
    corner->level_from = s->t[first];
    corner->level_to = s->t[last];
    corner->guard = guard;
    corner->left = corner->level_from - guard - window_of(s, y, turn->before, first, noise);
    corner->right = corner->level_to + guard + window_of(s, y, turn->after, last, noise);
}

/* How long the motion rests between its two ramps at a turn, s. */
static double dwell_of(const struct wb_sync_signal *s, const double *y, const struct corner *corner)
{
    double a[3], b[3], deviation;
    const double top = value_at(&(struct wb_sync_signal){s->t, y, s->n},
                                0.5 * (corner->level_from + corner->level_to));
    if (!fit_side(s, y, corner->left, corner->level_from - corner->guard, corner->level_from, a,
                  &deviation) ||
        !fit_side(s, y, corner->level_to + corner->guard, corner->right, corner->level_to, b,
                  &deviation) ||
        !(a[1] > 0.0) || !(b[1] < 0.0))
        return 0.0;
    const double came = corner->level_from + (top - a[0]) / a[1];
    const double left = corner->level_to + (top - b[0]) / b[1];
    return left - came;
}

/* Mean at the top, over at most half a second from where it was reached. */
static double level_of(const struct wb_sync_signal *s, const double *y, const struct corner *corner)
{
    const size_t first = index_at(s, corner->level_from);
    const size_t last = index_at(s, fmin(corner->level_to, corner->level_from + 1.0));
    const size_t begin = first + (last - first) / 2;
    double sum = 0.0;
    size_t n = 0;
    for (size_t i = begin; i <= last && i < s->n; i++, n++)
        sum += y[i];
    return n > 0 ? sum / (double)n : y[first];
}

/* Corners of |x - x(0)| at its turns. `rests` is said by the motion and applied to the force. */
static enum wb_status find_reversals(const struct wb_sync_signal *s, double guard,
                                     const bool *rests, bool *do_rest, struct events *events)
{
    struct turn turns[MOST_EVENTS];
    double *const y = malloc((s->n + 1) * sizeof *y);
    double most = 0.0;
    events->n = 0;
    if (!y)
        return WB_ERR_MEMORY;
    const double noise = wb_sync_noise(s), zero = s->n > 0 ? s->x[0] : 0.0;
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
    for (int i = 0; i < n; i++) {
        struct corner corner;
        struct event event;
        place_corner(s, y, &turns[i], noise, guard, &corner);
        bool rest = rests ? *rests : dwell_of(s, y, &corner) > DWELL;
        if (do_rest && i == 0)
            *do_rest = rest;
        if (do_rest)
            rest = *do_rest;
        const double level = level_of(s, y, &corner);
        if (!meet(s, y, &corner, rest ? &level : NULL, &event))
            continue;
        struct corner shorter = corner;
        struct event other;
        shorter.left += (1.0 - SHORTER) * (corner.level_from - guard - corner.left);
        shorter.right -= (1.0 - SHORTER) * (corner.right - corner.level_to - guard);
        if (meet(s, y, &shorter, rest ? &level : NULL, &other))
            event.deviation = fmax(event.deviation, fabs(other.t - event.t));
        event.deviation = fmax(event.deviation, 0.1 * median_period(s));
        if (event.deviation < MOST_UNCERTAINTY)
            events->at[events->n++] = event;
    }
    free(y);
    return WB_OK;
}

/* --- pairing --- */

struct pairing {
    int n;
    double lag, deviation, first;
};

static struct pairing pair_at(const struct events *a, const struct events *b, double lag)
{
    double weights = 0.0, sum = 0.0, squares = 0.0;
    struct pairing pairing = {.first = HUGE_VAL};
    for (int i = 0; i < a->n; i++) {
        int best = -1;
        for (int k = 0; k < b->n; k++)
            if (fabs(a->at[i].t - b->at[k].t - lag) < PAIR_GATE &&
                (best < 0 ||
                 fabs(a->at[i].t - b->at[k].t - lag) < fabs(a->at[i].t - b->at[best].t - lag)))
                best = k;
        if (best < 0)
            continue;
        const double variance =
            a->at[i].deviation * a->at[i].deviation + b->at[best].deviation * b->at[best].deviation;
        const double difference = a->at[i].t - b->at[best].t;
        pairing.n++;
        weights += 1.0 / variance;
        sum += difference / variance;
        squares += difference * difference / variance;
        pairing.first = fmin(pairing.first, a->at[i].t);
    }
    if (pairing.n > 0) {
        pairing.lag = sum / weights;
        const double chi = fmax(squares - weights * pairing.lag * pairing.lag, 0.0);
        const double inflation = pairing.n > 1 ? fmax(1.0, chi / (double)(pairing.n - 1)) : 1.0;
        pairing.deviation = sqrt(inflation / weights);
    }
    return pairing;
}

/* The lag that pairs the most events; false where another pairs as many. */
static bool pair(const struct events *a, const struct events *b, struct pairing *best)
{
    int rival = 0;
    *best = (struct pairing){0};
    for (int i = 0; i < a->n; i++) {
        for (int k = 0; k < b->n; k++) {
            const struct pairing p = pair_at(a, b, a->at[i].t - b->at[k].t);
            const bool same = best->n > 0 && fabs(p.lag - best->lag) < 2.0 * PAIR_GATE;
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

/* --- all --- */

static void take(struct wb_sync *sync, enum wb_sync_method method, const struct events *a,
                 const struct events *b, double extra, char reason[120])
{
    struct pairing pairing;
    reason[0] = '\0';
    if (a->n == 0 || b->n == 0) {
        snprintf(reason, 120, "no %s in %s", wb_sync_name(method),
                 a->n == 0 && b->n == 0 ? "either signal"
                 : a->n == 0            ? "the motion"
                                        : "the force");
        return;
    }
    if (!pair(a, b, &pairing)) {
        snprintf(reason, 120, "%d %ss in the motion and %d in the force fit in more than one way",
                 a->n, wb_sync_name(method), b->n);
        return;
    }
    const double uncertainty = hypot(pairing.deviation, extra);
    if (!(uncertainty < MOST_UNCERTAINTY)) {
        snprintf(reason, 120, "the %s leaves %.0f ms of uncertainty", wb_sync_name(method),
                 uncertainty * 1e3);
        return;
    }
    if (sync->method != WB_SYNC_NONE && sync->uncertainty <= uncertainty)
        return;
    sync->method = method;
    sync->lag = pairing.lag;
    sync->uncertainty = uncertainty;
    sync->n_events = pairing.n;
    sync->first_event = pairing.first;
}

enum wb_status wb_sync_find(struct wb_sync *sync, const struct wb_sync_signal *motion,
                            const struct wb_sync_signal *shake, const struct wb_sync_signal *force,
                            const struct wb_sync_settings *settings)
{
    struct events a, b;
    char tap[120] = "", reversal[120] = "";
    *sync = (struct wb_sync){.lag = (double)NAN, .uncertainty = (double)NAN};
    if (settings->tap) {
        double *const out = malloc((force->n + 1) * sizeof *out);
        if (!out)
            return WB_ERR_MEMORY;
        wb_sync_shake(force, out);
        const struct wb_sync_signal shaken = {force->t, out, force->n};
        enum wb_status status = find_taps(shake, &a);
        if (status == WB_OK)
            status = find_taps(&shaken, &b);
        free(out);
        WB_TRY(status);
        /* A filter delays a short event by less than a ramp. */
        take(sync, WB_SYNC_TAP, &a, &b, 0.5 * settings->filter_delay, tap);
    }
    if (settings->reversal) {
        bool rests = false;
        WB_TRY(find_reversals(motion, 0.05, NULL, &rests, &a));
        WB_TRY(find_reversals(force, fmax(0.05, 3.0 * settings->filter_delay), &rests, NULL, &b));
        take(sync, WB_SYNC_REVERSAL, &a, &b, 0.0, reversal);
    }
    if (sync->method == WB_SYNC_NONE)
        snprintf(sync->reason, sizeof sync->reason, "%s%s%s", tap,
                 tap[0] && reversal[0] ? "; " : "", reversal);
    return WB_OK;
}
