/* Rows in the clamp's frame: markers identified, on the axis, averaged over a row's frames; the
 * load cell's reading at the same time; cycles and phases from the turning points of the clamp's
 * own path; the stage, commanded against measured travel, and its lost steps. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_multifit.h>

#include "analysis/align/align_private.h"
#include "analysis/align/axis_fit.h"
#include "analysis/dataset/fit.h"
#include "base/memory.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

/* Half width of the window that smooths the clamp's path, s of bench time. */
#define CLAMP_WINDOW 0.1
/* Largest residual of a marker from the smooth axis; above it the worst marker is left out. */
#define BAD_RESIDUAL (0.6 * WB_MM)
#define GOOD_RESIDUAL (0.4 * WB_MM)
/* Return travel that makes an extremum a turning point, as part of the clamp's range. */
#define TURN_PART 0.05
#define LEAST_TURN (1.0 * WB_MM)
/* Half width of the window for the clamp's speed, s of bench time. */
#define SPEED_WINDOW 0.05
/* Reports that the host read later than this (s of bench time) are not used. */
#define MOST_LATENESS 0.1
/* Number of reports at either end of the test that give the stage's position there. */
#define STANDING 5

/* --- markers --- */

static double typical_period(const struct wb_align *align)
{
    const size_t n = align->cloud.n_frames;
    if (n < 2)
        return 0.0;
    double *const steps = wb_memory_new(n, sizeof *steps);
    for (size_t i = 1; i < n; i++)
        steps[i - 1] = align->frame_t[i] - align->frame_t[i - 1];
    const double period = wb_fit_median(steps, n - 1);
    free(steps);
    return period;
}

static void describe_markers(struct wb_align *align)
{
    const struct wb_marker_tracks *const tracks = &align->tracks;
    const struct wb_bench_frame *const frame = &align->frame;
    struct wb_json *const object = wb_json_set_object(align->checks, "markers");
    wb_json_set_integer(object, "frames", (int64_t)tracks->n_frames);
    const double all = (double)tracks->n_frames * tracks->n_markers;
    wb_align_set(object, "seen_percent", 100.0 * (1.0 - (double)tracks->n_missing / all));
    wb_json_set_integer(object, "stray_points", (int64_t)tracks->n_strays);
    wb_json_set_integer(object, "occluded_left_out", (int64_t)align->cloud.n_occluded);
    wb_json_set_integer(object, "model_filled_left_out", (int64_t)align->cloud.n_filled);
    wb_json_set_integer(object, "chain_searches", (int64_t)tracks->n_searches);
    struct wb_json *const plane = wb_json_set_object(align->checks, "bending_plane");
    WB_PUT(plane, &wb_align_plane_keys, struct wb_bench_frame, frame);
    wb_align_set(plane, "vertical_uncertainty_mrad", frame->up_uncertainty * 1e3);
    wb_json_set_text(plane, "vertical",
                     frame->up_from_motion ? "direction of the clamp's motion"
                                           : "the motion-capture server's up axis");
}

enum wb_status wb_align_markers(struct wb_align *align)
{
    const double up[3] = {0.0, align->rig.mocap.up == 'z' ? 0.0 : 1.0,
                          align->rig.mocap.up == 'z' ? 1.0 : 0.0};
    const struct wb_marker_settings settings = {
        .noise = align->rig.mocap.marker_noise,
        .frame_period = typical_period(align),
    };
    WB_TRY(
        wb_markers_track(&align->tracks, &align->cloud, &align->specimen, &settings, align->why));
    if (wb_frame_is_reversed(&align->tracks, up)) {
        if (!align->tracks.symmetric)
            wb_align_warn(align,
                          "the markers' distances and their motion give opposite orders (the clamp "
                          "moves, the tip does not): markers_mm of the specimen may be reversed");
        else
            wb_markers_reverse(&align->tracks);
    }
    WB_TRY(
        wb_frame_fit(&align->frame, &align->tracks, align->frame_t, CLAMP_WINDOW, up, align->why));
    /* At more than 45 degrees the direction of up, and with it the sign of the force, is a
     * guess. */
    if (align->frame.tilt > 45.0 * WB_DEGREE)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the clamp's motion leans %.1f degrees from the server's %c axis: "
                          "set mocap.up of the rig file to %c (align takes a corrected one with "
                          "--rig)",
                          align->name, align->frame.tilt / WB_DEGREE, align->rig.mocap.up,
                          align->rig.mocap.up == 'z' ? 'y' : 'z');
    if (align->frame.tilt > 5.0 * WB_DEGREE)
        wb_align_warn(align,
                      "the clamp's motion leans %.1f degrees from the server's %c axis: check "
                      "mocap.up of the rig file",
                      align->frame.tilt / WB_DEGREE, align->rig.mocap.up);
    describe_markers(align);
    return WB_OK;
}

/* --- readings --- */

/* Index of the first reading at or after t. */
static size_t first_reading_at(const struct wb_align *align, double t)
{
    const struct wb_align_reading *const readings = align->readings.items;
    return wb_fit_first_at(&readings->t, sizeof *readings, align->readings.n, t);
}

/* Reading less tare at bench time t: from a local straight line over +-half seconds, or linear
 * between the two neighbours. False if a neighbour is farther away than the longest gap. */
static bool reading_at(const struct wb_align *align, double t, double half, double *reading)
{
    const struct wb_align_reading *const r = align->readings.items;
    const size_t next = first_reading_at(align, t);
    const double longest = align->settings.longest_gap;
    if (next == 0 || next == align->readings.n || t - r[next - 1].t > longest ||
        r[next].t - t > longest)
        return false;
    const size_t first = first_reading_at(align, t - half);
    const size_t last = first_reading_at(align, t + half);
    double n = 0.0, sum = 0.0, sum_t = 0.0, sum_tt = 0.0, sum_tf = 0.0;
    for (size_t i = first; i < last; i++) {
        const double dt = r[i].t - t, force = r[i].force - align->tare;
        n += 1.0;
        sum += force;
        sum_t += dt;
        sum_tt += dt * dt;
        sum_tf += dt * force;
    }
    const double determinant = n * sum_tt - sum_t * sum_t;
    if (n >= 3.0 && determinant > 1e-6 * n * n * half * half) {
        *reading = (sum_tt * sum - sum_t * sum_tf) / determinant;
        return true;
    }
    *reading =
        wb_fit_between(t, r[next - 1].t, r[next - 1].force, r[next].t, r[next].force) - align->tare;
    return true;
}

/* --- rows --- */

struct means {
    double t, height;
    int n_tip;
    int n[WB_SPECIMEN_MAX_MARKERS];
    double x[WB_SPECIMEN_MAX_MARKERS], y[WB_SPECIMEN_MAX_MARKERS];
};

/* Mean places of the markers over frames first..last-1, relative to the clamp point. */
static void average_frames(const struct wb_align *align, size_t first, size_t last,
                           struct means *means)
{
    const int n_markers = align->specimen.n_markers;
    memset(means, 0, sizeof *means);
    for (size_t i = first; i < last; i++) {
        const double height = wb_frame_clamp_height(&align->frame, i);
        if (!isfinite(height) || !wb_markers_position(&align->tracks, i, n_markers - 1))
            continue;
        means->n_tip++;
        means->t += align->frame_t[i];
        means->height += height;
        for (int k = 0; k < n_markers; k++) {
            const double *const p = wb_markers_position(&align->tracks, i, k);
            double x, y;
            if (!p)
                continue;
            wb_frame_coordinates(&align->frame, i, p, &x, &y, NULL);
            means->n[k]++;
            means->x[k] += x;
            means->y[k] += y + align->specimen.marker_offset;
        }
    }
    for (int k = 0; k < n_markers; k++) {
        means->x[k] = means->n[k] > 0 ? means->x[k] / means->n[k] : (double)NAN;
        means->y[k] = means->n[k] > 0 ? means->y[k] / means->n[k] : (double)NAN;
    }
    if (means->n_tip > 0) {
        means->t /= means->n_tip;
        means->height /= means->n_tip;
    }
}

/* Fits the axis to the markers of a row except `left_out` (-1: all). */
static bool fit_axis(const struct wb_align *align, const struct means *means, int left_out,
                     struct wb_axis_fit *fit)
{
    double s[WB_SPECIMEN_MAX_MARKERS], x[WB_SPECIMEN_MAX_MARKERS], y[WB_SPECIMEN_MAX_MARKERS];
    int n = 0;
    for (int k = 1; k < align->specimen.n_markers; k++) {
        if (means->n[k] == 0 || k == left_out)
            continue;
        s[n] = align->specimen.markers[k];
        x[n] = means->x[k];
        y[n++] = means->y[k];
    }
    const struct wb_axis_fit_markers markers = {
        .n = n, .s = s, .x = x, .y = y, .offset = align->specimen.marker_offset};
    return wb_axis_fit(fit, align->specimen.length, &markers) == WB_OK;
}

/* Finds the axis of a row. A marker that spoils the fit is dropped; if that is the tip's, the row
 * is. */
static bool find_axis(const struct wb_align *align, struct means *means, struct wb_axis_fit *fit)
{
    const int tip = align->specimen.n_markers - 1;
    const bool fits = fit_axis(align, means, -1, fit);
    if (fits && fit->residual <= BAD_RESIDUAL)
        return true;
    int best = -1;
    struct wb_axis_fit best_fit = {.residual = GOOD_RESIDUAL};
    for (int k = 1; k <= tip; k++) {
        struct wb_axis_fit trial;
        if (means->n[k] > 0 && fit_axis(align, means, k, &trial) &&
            trial.residual < best_fit.residual) {
            best = k;
            best_fit = trial;
        }
    }
    if (best < 0 || best == tip)
        return false;
    means->n[best] = 0;
    means->x[best] = means->y[best] = (double)NAN;
    *fit = best_fit;
    return true;
}

/* Makes one row from frames first..last-1; false if they do not suffice. */
static bool make_row(const struct wb_align *align, size_t first, size_t last, double half,
                     struct wb_align_row *row)
{
    const struct wb_specimen *const specimen = &align->specimen;
    const int tip = specimen->n_markers - 1;
    struct means means;
    struct wb_axis_fit fit;
    average_frames(align, first, last, &means);
    memset(row, 0, sizeof *row);
    /* Next to a loss of tip or clamp the mean of the few remaining frames would lie at the bin's
     * edge. */
    if (2 * (size_t)means.n_tip < last - first ||
        !reading_at(align, means.t, half, &row->reading) || !find_axis(align, &means, &fit))
        return false;
    row->t = means.t;
    row->travel = -means.height;
    for (int k = 0; k <= tip; k++) {
        row->x[k] = means.x[k];
        row->y[k] = means.y[k];
        if (means.n[k] > 0)
            wb_axis_fit_move(&fit, specimen->marker_offset, specimen->markers[k], &row->x[k],
                             &row->y[k]);
    }
    row->tip_x = row->x[tip];
    row->tip_y = row->y[tip];
    row->tip_angle = wb_axis_fit_angle(&fit, specimen->length);
    row->commanded = (double)NAN;
    /* Direction of the strand, whose upper end is vertically above the straight wire's tip. */
    const double strand = align->rig.strand.length;
    const double lean = strand > 0.0 ? (specimen->length - row->tip_x) / strand : 0.0;
    row->lean_cosine = fabs(lean) < 1.0 ? sqrt(1.0 - lean * lean) : 0.0;
    return true;
}

/* Sets travel to zero where the first cycle began. */
static void zero_travel(struct wb_align *align)
{
    double heights[10];
    size_t begin = 0, n = 0;
    while (begin < align->n_rows && align->rows[begin].t < 0.0)
        begin++;
    const size_t first = begin > 10 ? begin - 10 : 0;
    for (size_t i = first; i < align->n_rows && n < 10; i++)
        heights[n++] = align->rows[i].travel;
    const double zero = wb_fit_median(heights, n);
    for (size_t i = 0; i < align->n_rows; i++)
        align->rows[i].travel -= zero;
}

enum wb_status wb_align_rows(struct wb_align *align)
{
    const size_t n_frames = align->cloud.n_frames;
    const double rate = align->settings.row_rate;
    const double half = fmax(0.5 / rate, 2.5 * wb_align_reading_period(align));
    align->rows = wb_memory_new(n_frames, sizeof *align->rows);
    for (size_t first = 0, last; first < n_frames; first = last) {
        const double bin = floor(align->frame_t[first] * rate);
        for (last = first + 1; last < n_frames; last++) {
            if (floor(align->frame_t[last] * rate) > bin)
                break;
        }
        /* While the test is held the wire relaxes, which is not part of the curve. */
        if (wb_align_is_held(align, align->frame_t[first], align->frame_t[last - 1]))
            align->n_held_rows++;
        else if (make_row(align, first, last, half, &align->rows[align->n_rows]))
            align->n_rows++;
        else
            align->n_dropped_rows++;
    }
    if (align->n_rows < 20)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: only %zu rows have tip, clamp and load cell at the same time",
                          align->name, align->n_rows);
    align->rows = wb_memory_resize(align->rows, align->n_rows, sizeof *align->rows);
    zero_travel(align);
    const struct wb_align_correction correction = {"marker offset", "mm", WB_MM,
                                                   align->specimen.marker_offset,
                                                   align->specimen.marker_offset_uncertainty};
    wb_align_correct(align, &correction,
                     "removed along the local normal of the axis fitted to all markers; the "
                     "uncertainty is that of one marker and enters the deflection in full");
    return WB_OK;
}

/* --- cycles --- */

static void find_range(const struct wb_align *align, double *low, double *high)
{
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (size_t i = 0; i < align->n_rows; i++) {
        *low = fmin(*low, align->rows[i].travel);
        *high = fmax(*high, align->rows[i].travel);
    }
}

/* A branch of the travel ends once the travel has come back by `threshold`. */
static void cut_cycles(struct wb_align *align, double threshold)
{
    struct wb_align_row *const rows = align->rows;
    bool loading = false;
    align->n_cycles = 0;
    for (size_t i = 0; i < align->n_rows;) {
        loading = !loading;
        align->n_cycles += loading;
        const size_t end = wb_fit_branch_end(&rows->travel, sizeof *rows, align->n_rows, i,
                                             loading ? threshold : -threshold);
        for (; i < end; i++) {
            rows[i].cycle = align->n_cycles;
            rows[i].phase = loading ? WB_PHASE_LOAD : WB_PHASE_UNLOAD;
        }
    }
}

/* Typical speed of the clamp on the way down: the median over the moving rows. */
static void measure_speed(struct wb_align *align)
{
    double *const speeds = wb_memory_new(align->n_rows, sizeof *speeds);
    size_t n = 0;
    for (size_t i = 20; i < align->n_rows; i++) {
        const struct wb_align_row *const a = &align->rows[i - 20], *const b = &align->rows[i];
        if (b->phase == WB_PHASE_LOAD && a->cycle == b->cycle &&
            b->travel - a->travel > 0.5 * WB_MM)
            speeds[n++] = (b->travel - a->travel) / (b->t - a->t);
    }
    align->speed = n > 0 ? wb_fit_median(speeds, n) : 0.0;
    free(speeds);
}

enum wb_status wb_align_cycles(struct wb_align *align)
{
    double low, high;
    find_range(align, &low, &high);
    if (high - low < LEAST_TURN)
        return wb_fail_to(align->why, WB_ERR_DATA,
                          "%s: the clamp moved by only %.2f mm along the server's %c axis: not a "
                          "bending test, or the rig's mocap.up is wrong",
                          align->name, (high - low) / WB_MM, align->rig.mocap.up);
    cut_cycles(align, fmax(TURN_PART * (high - low), LEAST_TURN));
    if (align->n_cycle_starts > 0 && align->n_cycle_starts != align->n_cycles)
        wb_align_warn(align,
                      "the recording has %d cycle starts, but the clamp's path has %d cycles",
                      align->n_cycle_starts, align->n_cycles);
    measure_speed(align);
    return WB_OK;
}

/* --- commanded against measured --- */

struct pair {
    double commanded, measured, speed; /* m, m, m/s */
};

/* Height of the clamp at bench time t; false in a gap. */
static bool clamp_at(const struct wb_align *align, double t, double *height)
{
    const double *const times = align->frame_t;
    const size_t n = align->cloud.n_frames, next = wb_fit_first_at(times, sizeof *times, n, t);
    if (next == 0 || next == n || times[next] - times[next - 1] > align->settings.longest_gap)
        return false;
    *height = wb_fit_between(t, times[next - 1], wb_frame_clamp_height(&align->frame, next - 1),
                             times[next], wb_frame_clamp_height(&align->frame, next));
    return isfinite(*height);
}

/* How late the host read what arrived at t_ns, s of bench time, from the lateness of the camera
 * frames around it. A busy host stamps all streams late, and a moving stage then seems to be
 * elsewhere. */
static double host_lateness(const struct wb_align *align, int64_t t_ns)
{
    const struct wb_point_frame *const frames = align->cloud.frames;
    size_t low = 0, high = align->cloud.n_frames;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (frames[middle].t_ns < t_ns)
            low = middle + 1;
        else
            high = middle;
    }
    double late = 0.0;
    for (size_t i = low > 0 ? low - 1 : 0; i <= low && i < align->cloud.n_frames; i++)
        late = fmax(late, wb_align_bench_time(align, frames[i].t_ns) - align->frame_t[i]);
    return late;
}

/* Pairs of the stage's reports and the clamp's measured height at their arrival. Both travels count
 * downwards from their first value. */
static size_t make_pairs(const struct wb_align *align, struct pair *pairs)
{
    const struct wb_align_report_point *const reports = align->reports.items;
    const double begin = align->rows[0].t, end = align->rows[align->n_rows - 1].t;
    size_t n = 0;
    for (size_t i = 0; i < align->reports.n; i++) {
        double before, at, after;
        if (reports[i].t < fmax(begin, -1.0) || reports[i].t > end ||
            host_lateness(align, reports[i].t_ns) > MOST_LATENESS ||
            !clamp_at(align, reports[i].t, &at) ||
            !clamp_at(align, reports[i].t - SPEED_WINDOW, &before) ||
            !clamp_at(align, reports[i].t + SPEED_WINDOW, &after))
            continue;
        pairs[n++] = (struct pair){
            .commanded = reports[i].travel,
            .measured = -at,
            .speed = (before - after) / (2.0 * SPEED_WINDOW),
        };
    }
    for (size_t i = n; i-- > 0;) {
        pairs[i].commanded -= pairs[0].commanded;
        pairs[i].measured -= pairs[0].measured;
    }
    return n;
}

struct stage_fit {
    double offset, slope, lag; /* m, 1, s: measured = offset + slope (commanded + lag speed) */
    double slope_deviation;
    double rms, largest; /* m: residuals; the largest of medians of three */
    double returned;     /* m: measured less commanded travel at the end, less that at the start */
    double lost_at;      /* m, commanded: where the difference passed half of `returned` */
};

/* Whether the stage moved both ways; otherwise a lag cannot be separated from an offset. */
static bool goes_both_ways(const struct pair *pairs, size_t n)
{
    double slowest = 0.0, fastest = 0.0;
    for (size_t i = 0; i < n; i++) {
        slowest = fmin(slowest, pairs[i].speed);
        fastest = fmax(fastest, pairs[i].speed);
    }
    return slowest < -0.2 * fastest && fastest > 0.0;
}

/* Robust least squares (Tukey's bisquare), so that lost steps do not bend the line. */
static bool fit_pairs(const struct pair *pairs, size_t n, bool with_lag, struct stage_fit *fit)
{
    const size_t p = with_lag && goes_both_ways(pairs, n) ? 3 : 2;
    gsl_matrix *const x = wb_memory_need(gsl_matrix_alloc(n, p));
    gsl_vector *const y = wb_memory_need(gsl_vector_alloc(n));
    gsl_vector *const c = wb_memory_need(gsl_vector_alloc(p));
    gsl_matrix *const covariance = wb_memory_need(gsl_matrix_alloc(p, p));
    gsl_multifit_robust_workspace *const work =
        wb_memory_need(gsl_multifit_robust_alloc(gsl_multifit_robust_bisquare, n, p));
    for (size_t i = 0; i < n; i++) {
        gsl_matrix_set(x, i, 0, 1.0);
        gsl_matrix_set(x, i, 1, pairs[i].commanded);
        if (p == 3)
            gsl_matrix_set(x, i, 2, pairs[i].speed);
        gsl_vector_set(y, i, pairs[i].measured);
    }
    const int code = gsl_multifit_robust(x, y, c, covariance, work);
    fit->offset = gsl_vector_get(c, 0);
    fit->slope = gsl_vector_get(c, 1);
    fit->lag = p == 3 ? gsl_vector_get(c, 2) / fit->slope : 0.0;
    fit->slope_deviation = sqrt(gsl_matrix_get(covariance, 1, 1));
    gsl_multifit_robust_free(work);
    gsl_matrix_free(covariance);
    gsl_vector_free(c);
    gsl_vector_free(y);
    gsl_matrix_free(x);
    return (code == GSL_SUCCESS || code == GSL_EMAXITER) && isfinite(fit->slope) &&
           isfinite(fit->lag) && fit->slope > 0.0;
}

static double median_of_three(double a, double b, double c)
{
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

static double difference(const struct stage_fit *fit, const struct pair *pair)
{
    return pair->measured - pair->commanded - fit->lag * pair->speed;
}

static void measure_residuals(const struct pair *pairs, size_t n, struct stage_fit *fit)
{
    double squares = 0.0, last[3] = {0.0};
    fit->largest = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double residual = pairs[i].measured - fit->offset -
                                fit->slope * (pairs[i].commanded + fit->lag * pairs[i].speed);
        squares += residual * residual;
        last[i % 3] = residual;
        if (i >= 2)
            fit->largest = fmax(fit->largest, fabs(median_of_three(last[0], last[1], last[2])));
    }
    fit->rms = sqrt(squares / (double)n);
    double start[STANDING], end[STANDING];
    for (size_t i = 0; i < STANDING; i++) {
        start[i] = difference(fit, &pairs[i]);
        end[i] = difference(fit, &pairs[n - 1 - i]);
    }
    const double at_start = wb_fit_median(start, STANDING);
    fit->returned = wb_fit_median(end, STANDING) - at_start;
    fit->lost_at = (double)NAN;
    for (size_t i = 0; i < n; i++) {
        if (fabs(difference(fit, &pairs[i]) - at_start) > 0.5 * fabs(fit->returned)) {
            fit->lost_at = pairs[i].commanded;
            break;
        }
    }
}

static bool lost_steps(const struct wb_align *align, const struct stage_fit *fit)
{
    const double limit = align->settings.lost_steps;
    return fit->largest > limit || fabs(fit->returned) > limit;
}

/* Fits lag and line. Lost steps look like a lag on the way down or up, so with lost steps no lag is
 * fitted. */
static bool fit_stage(const struct wb_align *align, const struct pair *pairs, size_t n,
                      struct stage_fit *fit)
{
    if (n < 4 * STANDING || !fit_pairs(pairs, n, true, fit))
        return false;
    measure_residuals(pairs, n, fit);
    if (!lost_steps(align, fit))
        return true;
    if (!fit_pairs(pairs, n, false, fit))
        return false;
    measure_residuals(pairs, n, fit);
    return true;
}

static void describe_stage(struct wb_align *align, const struct stage_fit *fit, size_t n)
{
    struct wb_json *const object = wb_json_set_object(align->checks, "stage");
    const bool lost = lost_steps(align, fit);
    wb_json_set_integer(object, "reports", (int64_t)n);
    wb_align_set(object, "slope", fit->slope);
    wb_align_set(object, "slope_uncertainty", fit->slope_deviation);
    wb_align_set(object, "offset_mm", fit->offset / WB_MM);
    wb_align_set(object, "report_lag_ms", fit->lag * 1e3);
    wb_align_set(object, "residual_rms_mm", fit->rms / WB_MM);
    wb_align_set(object, "largest_residual_mm", fit->largest / WB_MM);
    wb_align_set(object, "not_returned_mm", fit->returned / WB_MM);
    wb_json_set_boolean(object, "lost_steps", lost);
    if (lost)
        wb_align_warn(
            align,
            "the stage seems to have lost steps near %.1f mm of travel: measured and commanded "
            "travel differ by up to %.2f mm from their line, and after the test the clamp is %.2f "
            "mm from its start. The deflection is measured at the markers and is not affected",
            fit->lost_at / WB_MM, fit->largest / WB_MM, fit->returned / WB_MM);
    else if (fabs(fit->slope - 1.0) > 0.01)
        wb_align_warn(align,
                      "the clamp moves %.4f mm for each millimetre commanded: check the stage's "
                      "steps per mm and the cameras' calibration",
                      fit->slope);
}

/* Commanded travel at the rows' times, from the reports, their lag removed. */
static void command_rows(struct wb_align *align, double lag, double zero)
{
    const struct wb_align_report_point *const reports = align->reports.items;
    const double mean_period =
        (reports[align->reports.n - 1].t - reports[0].t) / (double)(align->reports.n - 1);
    const double longest = fmax(1.0, 6.0 * mean_period);
    size_t next = 0;
    for (size_t i = 0; i < align->n_rows; i++) {
        struct wb_align_row *const row = &align->rows[i];
        const double t = row->t + lag;
        while (next < align->reports.n && reports[next].t < t)
            next++;
        if (next == 0 || next == align->reports.n)
            continue;
        const struct wb_align_report_point *const a = &reports[next - 1], *const b = &reports[next];
        if (b->t - a->t <= longest)
            row->commanded = wb_fit_between(t, a->t, a->travel, b->t, b->travel) - zero;
    }
}

/* Commanded position where the test began: the last report before, or the first. */
static double commanded_zero(const struct wb_align *align)
{
    const struct wb_align_report_point *const reports = align->reports.items;
    size_t i = 0;
    while (i + 1 < align->reports.n && reports[i + 1].t <= 0.0)
        i++;
    return reports[i].travel;
}

void wb_align_stage(struct wb_align *align)
{
    struct pair *const pairs = wb_memory_new(align->reports.n, sizeof *pairs);
    struct stage_fit fit = {0};
    const size_t n = make_pairs(align, pairs);
    const bool fitted = fit_stage(align, pairs, n, &fit);
    if (fitted) {
        describe_stage(align, &fit, n);
    } else if (n >= 4 * STANDING) {
        wb_json_set_boolean(wb_json_set_object(align->checks, "stage"), "lost_steps", true);
        wb_align_warn(
            align, "the clamp did not follow the stage's reported travel: it jammed, or the motor "
                   "lost its steps. The deflection is measured at the markers and is not affected");
    } else {
        wb_align_warn(align,
                      "too few reports of the stage (%zu) to compare its travel with the clamp's: "
                      "lost steps would not be detected",
                      n);
    }
    free(pairs);
    if (align->reports.n >= 2)
        command_rows(align, fitted ? fit.lag : 0.0, commanded_zero(align));
}
