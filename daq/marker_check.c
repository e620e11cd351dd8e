#include "daq/marker_check.h"

#include <math.h>
#include <string.h>

#include "daq/acquisition.h"

#define MAX_CANDIDATES 32

struct cloud {
    int n;
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
        cloud->n++;
    }
}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

/* How many markers fit a straight wire that has marker i at point p and marker j at point q; the
 * sum of their distances breaks ties. */
static int count_fit(const struct cloud *cloud, const struct wb_specimen *specimen,
                     const int markers[2], const int points[2], double tolerance, bool *seen,
                     double *misfit)
{
    const double *const s = specimen->markers;
    const double *const p = cloud->at[points[0]], *const q = cloud->at[points[1]];
    int n_seen = 0;
    *misfit = 0.0;
    for (int m = 0; m < specimen->n_markers; m++) {
        const double along = (s[m] - s[markers[0]]) / (s[markers[1]] - s[markers[0]]);
        const double expected[3] = {p[0] + along * (q[0] - p[0]), p[1] + along * (q[1] - p[1]),
                                    p[2] + along * (q[2] - p[2])};
        double nearest = (double)INFINITY;
        for (int c = 0; c < cloud->n; c++)
            nearest = fmin(nearest, distance(expected, cloud->at[c]));
        seen[m] = nearest <= tolerance;
        if (seen[m]) {
            n_seen++;
            *misfit += nearest;
        }
    }
    return n_seen;
}

int wb_marker_check_frame(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                          bool seen[WB_SPECIMEN_MAX_MARKERS])
{
    struct cloud cloud;
    gather(frame, &cloud);
    const int n = specimen->n_markers;
    double spacing = (double)INFINITY;
    for (int m = 1; m < n; m++)
        spacing = fmin(spacing, specimen->markers[m] - specimen->markers[m - 1]);
    const double tolerance = 0.4 * spacing;
    int best = 0;
    double best_misfit = (double)INFINITY;
    memset(seen, 0, WB_SPECIMEN_MAX_MARKERS * sizeof seen[0]);
    /* Pairs far apart fix the line well; when one end is hidden, the next one serves. */
    for (int i = 0; i < n; i++) {
        for (int j = n - 1; j > i && j - i >= n / 2 && best < n; j--) {
            const double apart = specimen->markers[j] - specimen->markers[i];
            for (int p = 0; p < cloud.n; p++) {
                for (int q = 0; q < cloud.n; q++) {
                    if (q == p || !(fabs(distance(cloud.at[p], cloud.at[q]) - apart) <= tolerance))
                        continue;
                    bool fits[WB_SPECIMEN_MAX_MARKERS];
                    double misfit;
                    const int count = count_fit(&cloud, specimen, (const int[]){i, j},
                                                (const int[]){p, q}, tolerance, fits, &misfit);
                    if (count > best || (count == best && misfit < best_misfit)) {
                        best = count;
                        best_misfit = misfit;
                        memcpy(seen, fits, (size_t)n * sizeof seen[0]);
                    }
                }
            }
        }
    }
    /* One marker alone fixes no line, but it is seen. */
    if (best == 0 && cloud.n > 0) {
        seen[0] = true;
        best = 1;
    }
    return best;
}
