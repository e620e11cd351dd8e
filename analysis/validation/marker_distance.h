/* Distance of the measured markers from the computed wire during the first loading. */
#ifndef WB_ANALYSIS_VALIDATION_MARKER_DISTANCE_H
#define WB_ANALYSIS_VALIDATION_MARKER_DISTANCE_H

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"

/* Displacements of the markers from the computed wire, averaged over the samples at equal arc
 * lengths and parts of the range. */
struct wb_marker_mean {
    double rms;                 /* m: of the means; NaN if no place exists in all samples */
    double scatter;             /* m: of the standard deviations between samples */
    int n_samples, n_positions; /* positions along the wire that exist in all samples */
};

struct wb_marker_distance {
    double rms, largest; /* m; NaN without points */
    int n_points;
    struct wb_marker_mean mean;
};

/* Range of deflection (follower test: force) over which the frames are compared. */
struct wb_marker_distance_range {
    double step; /* m or N between the model's shapes; frames between are interpolated */
    double last; /* m or N: frames from 0 to there count */
};

/* Runs the model through the range of the first loading, and compares each measured marker with the
 * computed point at its own arc length. The force of a follower test at a marker's time comes from
 * its rows; frames after the largest force are left out. So is the marker on the clamp (arc length
 * 0), which is the origin, and every frame that the model does not reach. */
WB_MUST_CHECK enum wb_status wb_marker_distance_find(struct wb_marker_distance *distance,
                                                     struct wb_computed *computed,
                                                     const struct wb_material *material,
                                                     const struct wb_dataset *const *datasets,
                                                     int n,
                                                     const struct wb_marker_distance_range *range);

#endif
