#include "daq/acquire/marker_check.h"

#include <math.h>

#include "base/vec3.h"
#include "daq/acquire/acquisition.h"

#define MAX_CANDIDATES 32 /* measured markers considered in a frame */

struct cloud {
    int n;
    int index[MAX_CANDIDATES];    /* in frame->markers */
    double at[MAX_CANDIDATES][3]; /* m */
};

static void gather(const struct wb_mocap_frame *frame, struct cloud *cloud)
{
    cloud->n = 0;
    for (int i = 0; i < frame->n_markers && cloud->n < MAX_CANDIDATES; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        if (!wb_acquisition_marker_measured(marker))
            continue;
        for (int k = 0; k < 3; k++)
            cloud->at[cloud->n][k] = (double)marker->position[k];
        cloud->index[cloud->n++] = i;
    }
}

/* A straight wire through two points of the cloud, and the markers that fit it. */
struct line_fit {
    int markers[2], points[2]; /* marker i is at point i */
    struct wb_marker_places places;
    double misfit; /* m, sum of the distances to the line; decides between equal counts */
};

static void fit(const struct cloud *cloud, const struct wb_specimen *specimen, double tolerance,
                struct line_fit *lay)
{
    const double *const s = specimen->markers;
    const double *const p = cloud->at[lay->points[0]], *const q = cloud->at[lay->points[1]];
    const double begin = s[lay->markers[0]], length = s[lay->markers[1]] - begin;
    struct wb_marker_places *const places = &lay->places;
    places->n_seen = 0;
    lay->misfit = 0.0;
    for (int m = 0; m < specimen->n_markers; m++) {
        const double along = (s[m] - begin) / length;
        const double expected[3] = {p[0] + along * (q[0] - p[0]), p[1] + along * (q[1] - p[1]),
                                    p[2] + along * (q[2] - p[2])};
        double nearest = (double)INFINITY;
        places->index[m] = -1;
        for (int c = 0; c < cloud->n; c++) {
            const double off = wb_vec3_distance(expected, cloud->at[c]);
            if (off < nearest && off <= tolerance)
                places->index[m] = cloud->index[c];
            nearest = fmin(nearest, off);
        }
        if (places->index[m] >= 0) {
            places->n_seen++;
            lay->misfit += nearest;
        }
    }
}

/* Tries marker i at every point and marker j at every other point at the expected distance. */
static void try_pair(const struct cloud *cloud, const struct wb_specimen *specimen,
                     const int markers[2], double tolerance, struct line_fit *best)
{
    const double apart = specimen->markers[markers[1]] - specimen->markers[markers[0]];
    struct line_fit lay = {.markers = {markers[0], markers[1]}};
    for (int p = 0; p < cloud->n; p++) {
        for (int q = 0; q < cloud->n; q++) {
            if (q == p ||
                !(fabs(wb_vec3_distance(cloud->at[p], cloud->at[q]) - apart) <= tolerance))
                continue;
            lay.points[0] = p;
            lay.points[1] = q;
            fit(cloud, specimen, tolerance, &lay);
            if (lay.places.n_seen > best->places.n_seen ||
                (lay.places.n_seen == best->places.n_seen && lay.misfit < best->misfit))
                *best = lay;
        }
    }
}

void wb_marker_check_frame(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                           struct wb_marker_places *places)
{
    struct cloud cloud;
    gather(frame, &cloud);
    const int n = specimen->n_markers;
    double spacing = (double)INFINITY;
    for (int m = 1; m < n; m++)
        spacing = fmin(spacing, specimen->markers[m] - specimen->markers[m - 1]);
    const double tolerance = 0.4 * spacing;
    struct line_fit best = {.misfit = (double)INFINITY};
    for (int m = 0; m < WB_SPECIMEN_MAX_MARKERS; m++)
        best.places.index[m] = -1;
    /* Distant pairs define the line best; if an end is hidden, the next marker is used. */
    for (int i = 0; i < n; i++)
        for (int j = n - 1; j > i && j - i >= n / 2 && best.places.n_seen < n; j--)
            try_pair(&cloud, specimen, (const int[]){i, j}, tolerance, &best);
    *places = best.places;
    /* One marker does not define a line, but it counts as seen. */
    if (places->n_seen == 0 && cloud.n > 0) {
        places->index[0] = cloud.index[0];
        places->n_seen = 1;
    }
}

int wb_marker_check_nearest(const struct wb_mocap_frame *frame, const double at[3], double reach)
{
    double nearest = reach;
    int found = -1;
    for (int i = 0; i < frame->n_markers; i++) {
        const float *const p = frame->markers[i].position;
        const double off =
            wb_vec3_distance((double[]){(double)p[0], (double)p[1], (double)p[2]}, at);
        if (wb_acquisition_marker_measured(&frame->markers[i]) && off < nearest) {
            nearest = off;
            found = i;
        }
    }
    return found;
}
