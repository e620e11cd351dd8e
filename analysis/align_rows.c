/* Rows in the clamp's frame: markers identified, on the axis, averaged over a row's frames; the
 * load cell's reading at the same time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/align_private.h"
#include "analysis/shape.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "align"

/* The clamp's path is smoothed over +- so many seconds of bench time. */
#define CLAMP_WINDOW 0.1
/* A row whose markers miss the smooth axis by more is made without the worst of them. */
#define BAD_RESIDUAL (0.6 * WB_MM)
#define GOOD_RESIDUAL (0.4 * WB_MM)

/* --- markers --- */

static double typical_period(const struct wb_align *align)
{
    const size_t n = align->cloud.n_frames;
    double *const steps = malloc((n + 1) * sizeof *steps);
    if (!steps || n < 2) {
        free(steps);
        return 0.0;
    }
    for (size_t i = 1; i < n; i++)
        steps[i - 1] = align->frame_t[i] - align->frame_t[i - 1];
    const double period = wb_align_median(steps, n - 1);
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
    wb_align_set(plane, "planarity_rms_mm", frame->planarity / WB_MM);
    wb_align_set(plane, "plane_tilt_deg", frame->plane_tilt / WB_DEGREE);
    wb_align_set(plane, "clamp_motion_mm", frame->motion / WB_MM);
    wb_align_set(plane, "clamp_path_rms_mm", frame->straightness / WB_MM);
    wb_align_set(plane, "vertical_tilt_deg", frame->tilt / WB_DEGREE);
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
    WB_TRY(wb_markers_track(&align->tracks, &align->cloud, &align->specimen, &settings));
    if (wb_frame_is_reversed(&align->tracks, &align->cloud, up)) {
        if (!align->tracks.symmetric)
            wb_align_warn(align, "by their distances the markers are in the other order than by "
                                 "their motion (the clamp moves, the tip does not): markers_mm of "
                                 "the specimen may be the wrong way round");
        else
            wb_markers_reverse(&align->tracks);
    }
    WB_TRY(wb_frame_fit(&align->frame, &align->tracks, &align->cloud, align->frame_t, CLAMP_WINDOW,
                        up));
    if (align->frame.tilt > 5.0 * WB_DEGREE)
        wb_align_warn(align,
                      "the clamp's motion leans %.1f degrees from the server's %c axis: is "
                      "the rig's mocap.up right?",
                      align->frame.tilt / WB_DEGREE, align->rig.mocap.up);
    describe_markers(align);
    return WB_OK;
}

/* --- readings --- */

/* Index of the first reading at or after t. */
static size_t first_reading_at(const struct wb_align *align, double t)
{
    const struct wb_align_reading *const readings = wb_align_readings(align);
    size_t low = 0, high = align->readings.n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (readings[middle].t < t)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool wb_align_reading_at(const struct wb_align *align, double t, double half, double *reading)
{
    const struct wb_align_reading *const r = wb_align_readings(align);
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
    const double span = r[next].t - r[next - 1].t;
    const double part = span > 0.0 ? (t - r[next - 1].t) / span : 0.0;
    *reading = (1.0 - part) * r[next - 1].force + part * r[next].force - align->tare;
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
        if (!isfinite(height) ||
            !wb_markers_position(&align->tracks, &align->cloud, i, n_markers - 1))
            continue;
        means->n_tip++;
        means->t += align->frame_t[i];
        means->height += height;
        for (int k = 0; k < n_markers; k++) {
            const double *const p = wb_markers_position(&align->tracks, &align->cloud, i, k);
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

/* Fits the axis to the markers of a row but the one `left_out` (-1: none). */
static bool fit_axis(const struct wb_align *align, const struct means *means, int left_out,
                     struct wb_shape_fit *fit)
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
    const struct wb_shape_markers markers = {
        .n = n, .s = s, .x = x, .y = y, .offset = align->specimen.marker_offset};
    return wb_shape_fit(fit, align->specimen.length, &markers) == WB_OK;
}

/* The axis of a row. A marker that alone spoils the fit is dropped; a bad tip drops the row. */
static bool find_axis(const struct wb_align *align, struct means *means, struct wb_shape_fit *fit)
{
    const int tip = align->specimen.n_markers - 1;
    const bool fits = fit_axis(align, means, -1, fit);
    if (fits && fit->residual <= BAD_RESIDUAL)
        return true;
    int best = -1;
    struct wb_shape_fit best_fit = {.residual = GOOD_RESIDUAL};
    for (int k = 1; k <= tip; k++) {
        struct wb_shape_fit trial;
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

/* One row from frames first..last-1; false when they cannot make one. */
static bool make_row(const struct wb_align *align, size_t first, size_t last, double half,
                     struct wb_align_row *row)
{
    const struct wb_specimen *const specimen = &align->specimen;
    const int tip = specimen->n_markers - 1;
    struct means means;
    struct wb_shape_fit fit;
    average_frames(align, first, last, &means);
    memset(row, 0, sizeof *row);
    /* Beside a loss of tip or clamp a mean of the few frames left would stand at the bin's edge. */
    if (2 * (size_t)means.n_tip < last - first ||
        !wb_align_reading_at(align, means.t, half, &row->reading) ||
        !find_axis(align, &means, &fit))
        return false;
    row->t = means.t;
    row->travel = -means.height;
    for (int k = 0; k <= tip; k++) {
        row->x[k] = means.x[k];
        row->y[k] = means.y[k];
        if (means.n[k] > 0)
            wb_shape_to_axis(&fit, specimen->marker_offset, specimen->markers[k], &row->x[k],
                             &row->y[k]);
    }
    row->tip_x = row->x[tip];
    row->tip_y = row->y[tip];
    row->tip_angle = wb_shape_angle(&fit, specimen->length);
    row->commanded = (double)NAN;
    /* Direction of the strand: its upper end is straight above the straight wire's tip. */
    const double strand = align->rig.strand.length;
    const double lean = strand > 0.0 ? (specimen->length - row->tip_x) / strand : 0.0;
    row->lean_cosine = fabs(lean) < 1.0 ? sqrt(1.0 - lean * lean) : 0.0;
    return true;
}

/* Travel counts from where the clamp stood when the first cycle began. */
static void zero_travel(struct wb_align *align)
{
    double heights[10];
    size_t begin = 0, n = 0;
    while (begin < align->n_rows && align->rows[begin].t < 0.0)
        begin++;
    const size_t first = begin > 10 ? begin - 10 : 0;
    for (size_t i = first; i < align->n_rows && n < 10; i++)
        heights[n++] = align->rows[i].travel;
    const double zero = wb_align_median(heights, n);
    for (size_t i = 0; i < align->n_rows; i++)
        align->rows[i].travel -= zero;
}

enum wb_status wb_align_rows(struct wb_align *align)
{
    const size_t n_frames = align->cloud.n_frames;
    const double rate = align->settings.row_rate;
    const size_t n_readings = align->readings.n;
    const struct wb_align_reading *const readings = wb_align_readings(align);
    const double period =
        n_readings > 1 ? (readings[n_readings - 1].t - readings[0].t) / (double)(n_readings - 1)
                       : 0.0;
    const double half = fmax(0.5 / rate, 2.5 * period);
    align->rows = malloc((n_frames + 1) * sizeof *align->rows);
    if (!align->rows)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu rows", n_frames);
    for (size_t first = 0, last; first < n_frames; first = last) {
        const double bin = floor(align->frame_t[first] * rate);
        for (last = first + 1; last < n_frames; last++) {
            if (floor(align->frame_t[last] * rate) > bin)
                break;
        }
        if (make_row(align, first, last, half, &align->rows[align->n_rows]))
            align->n_rows++;
        else
            align->n_dropped_rows++;
    }
    if (align->n_rows < 20)
        return wb_fail(WB_ERR_DATA,
                       "%s: only %zu rows have tip, clamp and load cell at the same time",
                       align->name, align->n_rows);
    struct wb_align_row *const fitted = realloc(align->rows, align->n_rows * sizeof *align->rows);
    align->rows = fitted ? fitted : align->rows;
    zero_travel(align);
    const struct wb_align_correction correction = {
        .name = "marker offset",
        .unit = "mm",
        .factor = WB_MM,
        .value = align->specimen.marker_offset,
        .uncertainty = align->specimen.marker_offset_uncertainty,
    };
    wb_align_correct(align, &correction,
                     "taken off along the local normal of the axis fitted to all markers; the "
                     "uncertainty is a marker's own and goes into the deflection as it is");
    return WB_OK;
}
