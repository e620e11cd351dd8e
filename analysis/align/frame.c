#include "analysis/align/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

#include "base/memory.h"
#include "base/units.h"
#include "base/vec3.h"

#define WB_LOG_DOMAIN "frame"

/* A direction is found only from a clamp that moved at least this far, m. */
#define LEAST_MOTION (5.0 * WB_MM)
/* Markers span a plane only if they spread from the vertical, or from their own line, by at least
 * this, m. */
#define LEAST_SPREAD (5.0 * WB_MM)
/* A position of the clamp's path is rejected if its variance exceeds this part of one frame's, or,
 * with too few frames for a line, if their mean is this far away, s. */
#define LARGEST_VARIANCE 0.5
#define FARTHEST_MEAN 0.01

/* --- scatter of points --- */

struct scatter {
    size_t n;
    double sum[3], products[3][3];
};

static void add_point(struct scatter *scatter, const double *p)
{
    scatter->n++;
    for (int i = 0; i < 3; i++) {
        scatter->sum[i] += p[i];
        for (int k = 0; k < 3; k++)
            scatter->products[i][k] += p[i] * p[k];
    }
}

/* Principal directions of the points about their mean, largest spread first, as columns of
 * `directions`; `spread` receives the standard deviation along each. The singular values of the
 * covariance matrix are the squares of those of the centred points. */
static void principal(const struct scatter *scatter, double directions[3][3], double spread[3])
{
    double covariance[9], v[9], s[3], work[3];
    const double n = (double)scatter->n;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            covariance[3 * i + k] =
                scatter->products[i][k] / n - scatter->sum[i] / n * (scatter->sum[k] / n);
    }
    gsl_matrix_view matrix = gsl_matrix_view_array(covariance, 3, 3);
    gsl_matrix_view right = gsl_matrix_view_array(v, 3, 3);
    gsl_vector_view values = gsl_vector_view_array(s, 3);
    gsl_vector_view scratch = gsl_vector_view_array(work, 3);
    gsl_linalg_SV_decomp(&matrix.matrix, &right.matrix, &values.vector, &scratch.vector);
    for (int i = 0; i < 3; i++) {
        spread[i] = sqrt(fmax(s[i], 0.0));
        for (int k = 0; k < 3; k++)
            directions[i][k] = v[3 * k + i];
    }
}

/* --- the clamp's motion --- */

/* Range of a marker along a direction. */
static double range_along(const struct wb_marker_tracks *tracks, int marker,
                          const double *direction)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t frame = 0; frame < tracks->n_frames; frame++) {
        const double *const p = wb_markers_position(tracks, frame, marker);
        if (!p)
            continue;
        low = fmin(low, wb_vec3_dot(p, direction));
        high = fmax(high, wb_vec3_dot(p, direction));
    }
    return high >= low ? high - low : 0.0;
}

bool wb_frame_is_reversed(const struct wb_marker_tracks *tracks, const double server_up[3])
{
    const double first = range_along(tracks, 0, server_up);
    const double last = range_along(tracks, tracks->n_markers - 1, server_up);
    return last > LEAST_MOTION && last > first;
}

/* Fits the vertical to the clamp's path. Positions are relative to the first one seen, which keeps
 * the digits of the sums of squares. */
static enum wb_status fit_motion(struct wb_bench_frame *frame,
                                 const struct wb_marker_tracks *tracks, const double *server_up,
                                 struct wb_reason *why)
{
    struct scatter scatter = {0};
    const double *first = NULL;
    for (size_t i = 0; i < tracks->n_frames; i++) {
        const double *const p = wb_markers_position(tracks, i, 0);
        if (!p)
            continue;
        first = first ? first : p;
        const double relative[3] = {p[0] - first[0], p[1] - first[1], p[2] - first[2]};
        add_point(&scatter, relative);
    }
    if (!first)
        return wb_fail_to(why, WB_ERR_DATA, "the clamp's marker is not seen in any frame");
    double directions[3][3], spread[3];
    principal(&scatter, directions, spread);
    memcpy(frame->up, server_up, sizeof frame->up);
    frame->motion = range_along(tracks, 0, directions[0]);
    frame->up_from_motion = frame->motion >= LEAST_MOTION;
    frame->straightness = frame->up_from_motion ? hypot(spread[1], spread[2]) : 0.0;
    frame->up_uncertainty =
        frame->up_from_motion ? spread[1] / (spread[0] * sqrt((double)scatter.n)) : (double)NAN;
    if (frame->up_from_motion) {
        const double sign = wb_vec3_dot(directions[0], server_up) < 0.0 ? -1.0 : 1.0;
        for (int k = 0; k < 3; k++)
            frame->up[k] = sign * directions[0][k];
    }
    /* From the cross product: the cosine of a small angle would lose it to round-off. */
    double cross[3];
    wb_vec3_cross(frame->up, server_up, cross);
    frame->tilt = atan2(sqrt(wb_vec3_dot(cross, cross)), fabs(wb_vec3_dot(frame->up, server_up)));
    return WB_OK;
}

/* --- smoothing the clamp's path --- */

/* Straight line through the clamp marker's coordinates over frames first..last-1, evaluated at time
 * t. */
static bool local_line(const struct wb_marker_tracks *tracks, const double *times, size_t first,
                       size_t last, double t, double *position)
{
    double n = 0.0, sum_t = 0.0, sum_tt = 0.0, sum_p[3] = {0.0}, sum_tp[3] = {0.0};
    for (size_t i = first; i < last; i++) {
        const double *const p = wb_markers_position(tracks, i, 0);
        if (!p)
            continue;
        const double dt = times[i] - t;
        n += 1.0;
        sum_t += dt;
        sum_tt += dt * dt;
        for (int k = 0; k < 3; k++) {
            sum_p[k] += p[k];
            sum_tp[k] += dt * p[k];
        }
    }
    if (n < 1.0)
        return false;
    const double determinant = n * sum_tt - sum_t * sum_t;
    const bool is_line = n > 2.0 && determinant > 1e-12 * n * sum_tt;
    /* Next to a loss the line would be extrapolated: its value at t has the variance of one
     * position times sum_tt / determinant. A mean is valid only close to its own time. */
    if (is_line ? sum_tt > LARGEST_VARIANCE * determinant : fabs(sum_t) > FARTHEST_MEAN * n)
        return false;
    for (int k = 0; k < 3; k++)
        position[k] =
            is_line ? (sum_tt * sum_p[k] - sum_t * sum_tp[k]) / determinant : sum_p[k] / n;
    return true;
}

static void smooth_clamp(struct wb_bench_frame *frame, const struct wb_marker_tracks *tracks,
                         const double *times, double window)
{
    size_t first = 0, last = 0;
    for (size_t i = 0; i < tracks->n_frames; i++) {
        while (first < i && times[i] - times[first] > window)
            first++;
        if (last <= i)
            last = i + 1;
        while (last < tracks->n_frames && times[last] - times[i] <= window)
            last++;
        if (!local_line(tracks, times, first, last, times[i], frame->clamp[i]))
            frame->clamp[i][0] = frame->clamp[i][1] = frame->clamp[i][2] = (double)NAN;
    }
}

/* --- the bending plane --- */

static void relative_to_clamp(const struct wb_bench_frame *frame, size_t index, const double *p,
                              double *relative)
{
    for (int k = 0; k < 3; k++)
        relative[k] = p[k] - frame->clamp[index][k];
}

/* Position of a marker relative to the clamp in frame `index`; false if either is not seen. */
static bool find_from_clamp(const struct wb_bench_frame *frame,
                            const struct wb_marker_tracks *tracks, size_t index, int marker,
                            double *relative)
{
    const double *const p = wb_markers_position(tracks, index, marker);
    if (!p || !isfinite(frame->clamp[index][0]))
        return false;
    relative_to_clamp(frame, index, p, relative);
    return true;
}

/* Horizontal direction of the largest spread of the markers' horizontal parts, pointing from the
 * clamp to the tip. */
static enum wb_status fit_along(struct wb_bench_frame *frame, const struct wb_marker_tracks *tracks,
                                struct wb_reason *why)
{
    struct scatter flat = {0}, full = {0};
    for (size_t i = 0; i < tracks->n_frames; i++) {
        for (int marker = 1; marker < tracks->n_markers; marker++) {
            double r[3];
            if (!find_from_clamp(frame, tracks, i, marker, r))
                continue;
            add_point(&full, r);
            const double height = wb_vec3_dot(r, frame->up);
            for (int k = 0; k < 3; k++)
                r[k] -= height * frame->up[k];
            add_point(&flat, r);
        }
    }
    if (flat.n < 3)
        return wb_fail_to(why, WB_ERR_DATA,
                          "too few frames show both the clamp's and another marker");
    double directions[3][3], spread[3];
    /* A single marker besides the clamp's has no spread: its mean gives the direction. */
    if (tracks->n_markers > 2)
        principal(&flat, directions, spread);
    else
        memcpy(directions[0], flat.sum, sizeof directions[0]);
    const double sign = wb_vec3_dot(directions[0], flat.sum) < 0.0 ? -1.0 : 1.0;
    const double vertical = wb_vec3_dot(directions[0], frame->up);
    for (int k = 0; k < 3; k++)
        frame->along[k] = sign * (directions[0][k] - vertical * frame->up[k]);
    if (!(wb_vec3_normalise(frame->along) > 0.0) ||
        !(wb_vec3_dot(flat.sum, frame->along) / (double)flat.n > LEAST_SPREAD))
        return wb_fail_to(why, WB_ERR_DATA,
                          "the markers lie on one line along the clamp's motion, which gives no "
                          "bending plane: check mocap.up of the rig file");
    wb_vec3_cross(frame->along, frame->up, frame->normal);
    principal(&full, directions, spread);
    frame->plane_tilt = 0.0;
    if (tracks->n_markers > 2 && spread[1] > LEAST_SPREAD)
        frame->plane_tilt = asin(fmin(1.0, fabs(wb_vec3_dot(directions[2], frame->up))));
    return WB_OK;
}

static void measure_planarity(struct wb_bench_frame *frame, const struct wb_marker_tracks *tracks)
{
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (size_t i = 0; i < tracks->n_frames; i++) {
        for (int marker = 1; marker < tracks->n_markers; marker++) {
            double r[3];
            if (!find_from_clamp(frame, tracks, i, marker, r))
                continue;
            const double z = wb_vec3_dot(r, frame->normal);
            n += 1.0;
            sum += z;
            squares += z * z;
        }
    }
    frame->planarity = sqrt(fmax(0.0, squares / n - sum / n * (sum / n)));
}

enum wb_status wb_frame_fit(struct wb_bench_frame *frame, const struct wb_marker_tracks *tracks,
                            const double *times, double window, const double server_up[3],
                            struct wb_reason *why)
{
    memset(frame, 0, sizeof *frame);
    struct wb_bench_frame fitted = {.clamp = NULL};
    WB_TRY(fit_motion(&fitted, tracks, server_up, why));
    fitted.clamp = wb_memory_new(tracks->n_frames, sizeof *fitted.clamp);
    smooth_clamp(&fitted, tracks, times, window);
    const enum wb_status status = fit_along(&fitted, tracks, why);
    if (status != WB_OK) {
        free(fitted.clamp);
        return status;
    }
    measure_planarity(&fitted, tracks);
    *frame = fitted;
    return WB_OK;
}

void wb_frame_release(struct wb_bench_frame *frame)
{
    free(frame->clamp);
    memset(frame, 0, sizeof *frame);
}

void wb_frame_coordinates(const struct wb_bench_frame *frame, size_t index, const double point[3],
                          double *x, double *y, double *z)
{
    double r[3];
    relative_to_clamp(frame, index, point, r);
    *x = wb_vec3_dot(r, frame->along);
    *y = wb_vec3_dot(r, frame->up);
    if (z)
        *z = wb_vec3_dot(r, frame->normal);
}

double wb_frame_clamp_height(const struct wb_bench_frame *frame, size_t index)
{
    return wb_vec3_dot(frame->clamp[index], frame->up);
}
