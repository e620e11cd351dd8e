#include "daq/protocol/clock.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/units.h"

#define BURST_NS WB_NS_PER_S /* one probe is used per burst of this length */
#define LEAST_PROBE_SPAN 2.0 /* s, between the first and last probe, to fit the slope */
/* A temporary delay of the host is over after this time, and stamps arrive in time again. */
#define SETTLING_NS (5 * WB_NS_PER_S)

int64_t wb_clock_line_host_ns(const struct wb_clock_line *line, double device)
{
    /* Limit the extrapolation: a damaged stamp must not overflow an int64_t. */
    const double seconds = line->slope * (device - line->device_zero);
    if (!(fabs(seconds) < 1e9))
        return line->host_zero_ns;
    return line->host_zero_ns + wb_ns_from_seconds(seconds);
}

/* --- robust line --- */

struct point {
    double x, y;  /* s since the first point, on the clock of the device and of the host */
    double width; /* round trip, s */
    double weight;
};

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of n > 0 values; sorts them in place. */
static double median(double *values, size_t n)
{
    qsort(values, n, sizeof *values, compare_doubles);
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

struct fit {
    double mean_x, mean_y, slope;
    double sum_weight, sum_xx; /* sum of weights; weighted sum of squares about the mean */
};

/* Fits a line by weighted least squares; with `fixed` its slope is kept. */
static void fit_weighted(const struct point *points, size_t n, bool fixed, struct fit *fit)
{
    double sum = 0.0, sum_x = 0.0, sum_y = 0.0, xx = 0.0, xy = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += points[i].weight;
        sum_x += points[i].weight * points[i].x;
        sum_y += points[i].weight * points[i].y;
    }
    fit->mean_x = sum_x / sum;
    fit->mean_y = sum_y / sum;
    for (size_t i = 0; i < n; i++) {
        const double dx = points[i].x - fit->mean_x;
        xx += points[i].weight * dx * dx;
        xy += points[i].weight * dx * (points[i].y - fit->mean_y);
    }
    if (!fixed)
        fit->slope = xy / xx;
    fit->sum_weight = sum;
    fit->sum_xx = xx;
}

static double residual(const struct fit *fit, const struct point *point)
{
    return point->y - fit->mean_y - fit->slope * (point->x - fit->mean_x);
}

/* Huber's weights: 1 for residuals within 1.345 robust standard deviations, decreasing beyond.
 * `work`: n values of scratch. */
static void set_weights(const struct fit *fit, struct point *points, size_t n, double *work)
{
    for (size_t i = 0; i < n; i++)
        work[i] = fabs(residual(fit, &points[i]));
    const double limit = 1.345 * fmax(1.4826 * median(work, n), 1e-9);
    for (size_t i = 0; i < n; i++) {
        const double distance = fabs(residual(fit, &points[i]));
        points[i].weight = distance <= limit ? 1.0 : limit / distance;
    }
}

/* Robust fit to points of weight 1; returns the weighted standard deviation. */
static double fit_robust(struct point *points, size_t n, bool fixed, struct fit *fit, double *work)
{
    fit_weighted(points, n, fixed, fit);
    for (int iteration = 0; iteration < 20; iteration++) {
        set_weights(fit, points, n, work);
        fit_weighted(points, n, fixed, fit);
    }
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += points[i].weight * residual(fit, &points[i]) * residual(fit, &points[i]);
    return sqrt(sum / fit->sum_weight);
}

/* --- probes --- */

static int compare_probes(const void *a, const void *b)
{
    const struct wb_clock_probe *const x = a, *const y = b;
    return (x->t_sent_ns > y->t_sent_ns) - (x->t_sent_ns < y->t_sent_ns);
}

static int64_t round_trip(const struct wb_clock_probe *probe)
{
    return probe->t_received_ns - probe->t_sent_ns;
}

/* Keeps the probe with the shortest round trip of each second; sorts and compacts `probes`. */
static size_t keep_best(struct wb_clock_probe *probes, size_t n)
{
    qsort(probes, n, sizeof *probes, compare_probes);
    size_t n_kept = 0;
    for (size_t i = 0; i < n;) {
        size_t best = i, next = i;
        while (next < n && probes[next].t_sent_ns - probes[i].t_sent_ns < BURST_NS) {
            if (round_trip(&probes[next]) < round_trip(&probes[best]))
                best = next;
            next++;
        }
        probes[n_kept++] = probes[best];
        i = next;
    }
    return n_kept;
}

/* `points` and `work`: n values of scratch. */
static void fit_kept(struct wb_clock_line *line, const struct wb_clock_probe *kept, size_t n,
                     double nominal_slope, struct point *points, double *work)
{
    const int64_t zero_ns = kept[0].t_sent_ns;
    for (size_t i = 0; i < n; i++) {
        points[i].x = kept[i].t_device - kept[0].t_device;
        points[i].width = wb_seconds_from_ns(round_trip(&kept[i]));
        points[i].y = wb_seconds_from_ns(kept[i].t_sent_ns - zero_ns) + 0.5 * points[i].width;
        points[i].weight = 1.0;
    }
    const bool fixed =
        n < 3 || wb_seconds_from_ns(kept[n - 1].t_sent_ns - zero_ns) < LEAST_PROBE_SPAN;
    struct fit fit = {.slope = nominal_slope};
    line->scatter = fit_robust(points, n, fixed, &fit, work);
    for (size_t i = 0; i < n; i++)
        work[i] = points[i].width;
    const double own_error = line->scatter / sqrt((double)n);
    line->device_zero = kept[0].t_device + fit.mean_x;
    line->host_zero_ns = zero_ns + wb_ns_from_seconds(fit.mean_y);
    line->slope = fit.slope;
    line->slope_uncertainty = fixed ? (double)NAN : line->scatter / sqrt(fit.sum_xx);
    line->uncertainty = 0.5 * median(work, n) + own_error;
    line->n_used = n;
}

enum wb_status wb_clock_fit_probes(struct wb_clock_line *line, const struct wb_clock_probe *probes,
                                   size_t n, double nominal_slope)
{
    struct wb_clock_probe *const kept = malloc((n + 1) * sizeof *kept);
    struct point *const points = malloc((n + 1) * sizeof *points);
    double *const work = malloc((n + 1) * sizeof *work);
    enum wb_status status = WB_ERR_MEMORY;
    if (kept && points && work) {
        size_t n_kept = 0;
        for (size_t i = 0; i < n; i++) {
            if (isfinite(probes[i].t_device) && round_trip(&probes[i]) >= 0)
                kept[n_kept++] = probes[i];
        }
        *line = (struct wb_clock_line){.n_points = n};
        n_kept = keep_best(kept, n_kept);
        if (n_kept > 0)
            fit_kept(line, kept, n_kept, nominal_slope, points, work);
        status = n_kept > 0 ? WB_OK : WB_ERR_DATA;
    }
    free(kept);
    free(points);
    free(work);
    return status;
}

/* --- lower envelope --- */

static double cross(const struct point *o, const struct point *a, const struct point *b)
{
    return (a->x - o->x) * (b->y - o->y) - (a->y - o->y) * (b->x - o->x);
}

/* Lower convex hull of points with ascending x (Andrew's monotone chain), in place. */
static size_t lower_hull(struct point *points, size_t n)
{
    size_t n_hull = 0;
    for (size_t i = 0; i < n; i++) {
        while (n_hull >= 2 && cross(&points[n_hull - 2], &points[n_hull - 1], &points[i]) <= 0.0)
            n_hull--;
        points[n_hull++] = points[i];
    }
    return n_hull;
}

/* The sum of the distances of all points above a line depends only on the height of the line at
 * their mean x. The best line is therefore the edge of the hull there. */
static void choose_edge(const struct point *hull, size_t n, double mean_x, struct fit *fit)
{
    size_t edge = 0;
    while (edge + 2 < n && hull[edge + 1].x < mean_x)
        edge++;
    fit->mean_x = hull[edge].x;
    fit->mean_y = hull[edge].y;
    fit->slope = (hull[edge + 1].y - hull[edge].y) / (hull[edge + 1].x - hull[edge].x);
}

/* With a given slope the line passes through the lowest point. */
static void choose_lowest(const struct point *points, size_t n, struct fit *fit)
{
    size_t lowest = 0;
    for (size_t i = 1; i < n; i++) {
        if (points[i].y - fit->slope * points[i].x <
            points[lowest].y - fit->slope * points[lowest].x)
            lowest = i;
    }
    fit->mean_x = points[lowest].x;
    fit->mean_y = points[lowest].y;
}

enum wb_status wb_clock_fit_envelope(struct wb_clock_line *line, const double *device,
                                     const int64_t *host_ns, size_t n, double nominal_slope,
                                     double least_span)
{
    if (n == 0)
        return WB_ERR_DATA;
    struct point *const points = malloc(n * sizeof *points);
    double *const lateness = malloc(n * sizeof *lateness);
    if (!points || !lateness) {
        free(points);
        free(lateness);
        return WB_ERR_MEMORY;
    }
    double mean_x = 0.0;
    for (size_t i = 0; i < n; i++) {
        points[i] = (struct point){.x = device[i] - device[0],
                                   .y = wb_seconds_from_ns(host_ns[i] - host_ns[0])};
        mean_x += points[i].x / (double)n;
    }
    struct fit fit = {.slope = nominal_slope};
    const bool fixed = n < 3 || points[n - 1].x < least_span;
    size_t n_hull = 1;
    if (fixed) {
        choose_lowest(points, n, &fit);
    } else {
        n_hull = lower_hull(points, n);
        choose_edge(points, n_hull, mean_x, &fit);
    }
    for (size_t i = 0; i < n; i++)
        lateness[i] = wb_seconds_from_ns(host_ns[i] - host_ns[0]) - fit.mean_y -
                      fit.slope * (device[i] - device[0] - fit.mean_x);
    *line = (struct wb_clock_line){
        .device_zero = device[0] + fit.mean_x,
        .host_zero_ns = host_ns[0] + wb_ns_from_seconds(fit.mean_y),
        .slope = fit.slope,
        .scatter = median(lateness, n),
        .uncertainty = (double)NAN,
        .slope_uncertainty = (double)NAN,
        .n_points = n,
        .n_used = n_hull,
    };
    /* Each end of the edge may be off by about the scatter. */
    if (!fixed)
        line->slope_uncertainty = line->scatter / (device[n - 1] - device[0]);
    free(points);
    free(lateness);
    return WB_OK;
}

/* --- segments --- */

/* s, delay of stamp i relative to stamp `zero`. */
static double shift_of(const struct wb_clock_stamps *stamps, size_t i, size_t zero)
{
    const double *const device = stamps->device;
    const double elapsed = device ? device[i] - device[zero] : (double)i - (double)zero;
    return wb_seconds_from_ns(stamps->host_ns[i] - stamps->host_ns[zero]) -
           stamps->nominal_slope * elapsed;
}

/* s, smallest delay, relative to stamp `zero`, of stamps first, first + step, ... up to `end`
 * (exclusive) that arrived within SETTLING_NS of the first of them. */
static double least_shift(const struct wb_clock_stamps *stamps, size_t zero, size_t first,
                          size_t end, int step)
{
    double least = HUGE_VAL;
    for (size_t i = first; i != end; i += (size_t)step) {
        if (llabs(stamps->host_ns[i] - stamps->host_ns[first]) > SETTLING_NS)
            break;
        least = fmin(least, shift_of(stamps, i, zero));
    }
    return least;
}

/* Whether the delay still decreases from `first` to the last stamp: the host was busy and is still
 * processing a backlog when the stamps end. */
static bool is_catching_up(const struct wb_clock_stamps *stamps, size_t first)
{
    const size_t last = stamps->n - 1;
    const int64_t arrived_ns = stamps->host_ns[last] - stamps->host_ns[first];
    const double made = stamps->nominal_slope * (stamps->device[last] - stamps->device[first]);
    return arrived_ns <= SETTLING_NS && wb_seconds_from_ns(arrived_ns) <= 0.5 * made;
}

size_t wb_clock_split(const struct wb_clock_stamps *stamps, double jump, size_t *starts,
                      size_t most)
{
    size_t n_segments = 0;
    if (stamps->n > 0 && most > 0)
        starts[n_segments++] = 0;
    for (size_t i = 1; i < stamps->n && n_segments < most; i++) {
        if (fabs(shift_of(stamps, i, i - 1)) <= jump)
            continue;
        /* The delay of a busy host is temporary, a change of the clock is permanent. */
        const double before = least_shift(stamps, i - 1, i - 1, SIZE_MAX, -1);
        const double after = least_shift(stamps, i - 1, i, stamps->n, 1);
        const bool is_late = after > before && is_catching_up(stamps, i);
        if (!is_late && !(fabs(after - before) <= 0.5 * jump))
            starts[n_segments++] = i;
    }
    return n_segments;
}

/* s, period of the readings: from the median duration of windows of readings, which is insensitive
 * to single losses and delays. */
static double typical_period(const int64_t *host_ns, size_t n)
{
    enum {
        MOST = 512,
        LONG = 200
    };
    double periods[MOST];
    size_t n_periods = 0;
    if (n < 2)
        return 0.0;
    const size_t window = n > 2 * LONG ? LONG : n - 1;
    const size_t stride = 1 + (n - window) / MOST;
    for (size_t i = 0; i + window < n && n_periods < MOST; i += stride)
        periods[n_periods++] =
            wb_seconds_from_ns(host_ns[i + window] - host_ns[i]) / (double)window;
    return median(periods, n_periods);
}

/* s, typical jitter of arrivals: the median over windows of the range of the delays. */
static double usual_jitter(const struct wb_clock_stamps *readings)
{
    enum {
        MOST = 256,
        WINDOW = 32
    };
    double spreads[MOST];
    size_t n_spreads = 0;
    const size_t n = readings->n, stride = n / WINDOW > MOST ? n / MOST : WINDOW;
    for (size_t first = 0; first + WINDOW <= n && n_spreads < MOST; first += stride) {
        double most = -HUGE_VAL, least = HUGE_VAL;
        for (size_t i = first; i < first + WINDOW; i++) {
            most = fmax(most, shift_of(readings, i, first));
            least = fmin(least, shift_of(readings, i, first));
        }
        spreads[n_spreads++] = most - least;
    }
    return n_spreads > 0 ? median(spreads, n_spreads) : 0.0;
}

size_t wb_clock_split_readings(const int64_t *host_ns, size_t n, size_t *starts, size_t most)
{
    if (n == 0 || most == 0)
        return 0;
    const double period = typical_period(host_ns, n);
    /* The device's time is the number of the reading. */
    const struct wb_clock_stamps readings = {NULL, host_ns, n, period};
    const double jitter = usual_jitter(&readings);
    const double least_shift_s = fmax(fmax(0.8 * period, 3e-3), 1.5 * jitter);
    size_t n_segments = 0;
    starts[n_segments++] = 0;
    for (size_t i = 1; i < n && n_segments < most; i++) {
        /* The delay of a busy host is temporary, that of lost readings is permanent. */
        if (wb_seconds_from_ns(host_ns[i] - host_ns[i - 1]) < fmax(2.5 * period, 5e-3))
            continue;
        const double before = least_shift(&readings, i, i - 1, starts[n_segments - 1] - 1, -1);
        const double after = least_shift(&readings, i, i, n, 1);
        if (after - before > least_shift_s)
            starts[n_segments++] = i;
    }
    return n_segments;
}
