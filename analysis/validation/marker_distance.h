/* How far the measured markers lie from the computed wire during the first loading. */
#ifndef WB_ANALYSIS_VALIDATION_MARKER_DISTANCE_H
#define WB_ANALYSIS_VALIDATION_MARKER_DISTANCE_H

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"

/* Displacements of the markers from the computed wire, averaged over the samples at equal places of
 * wire and range. */
struct wb_marker_mean {
    double rms;                 /* m: of the means; NaN without places that all samples have */
    double scatter;             /* m: of the standard deviations between samples */
    int n_samples, n_positions; /* positions along the wire at which there are such places */
};

struct wb_marker_distance {
    double rms, largest; /* m; NaN without points */
    int n_points;
    struct wb_marker_mean mean;
};

/* Over which deflections (in a follower test: forces) the frames are compared. */
struct wb_marker_distance_range {
    double step; /* m or N between the model's shapes; frames between are interpolated */
    double last; /* m or N: frames from 0 to there count */
};

/* Runs the model through the range while the wire is first loaded, and compares each marker that
 * was measured there with the computed point at its own arc length. A follower test's force at a
 * marker's time is taken from its rows, and what comes after the largest is left out. The marker on
 * the clamp (arc length 0) is the origin and left out, and so is what the model does not reach. */
WB_MUST_CHECK enum wb_status wb_marker_distance_find(struct wb_marker_distance *distance,
                                                     struct wb_computed *computed,
                                                     const struct wb_material *material,
                                                     const struct wb_dataset *const *datasets,
                                                     int n,
                                                     const struct wb_marker_distance_range *range);

#endif
