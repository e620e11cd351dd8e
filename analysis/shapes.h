/* Distance between measured marker positions and the computed wire, first loading. */
#ifndef WB_ANALYSIS_SHAPES_H
#define WB_ANALYSIS_SHAPES_H

#include "analysis/computed.h"
#include "analysis/dataset.h"
#include "base/status.h"

struct wb_shapes_distance {
    double rms, largest; /* m; NaN without points */
    int n_points;
};

/* Runs the model to each deflection at which shapes were measured while the wire was first loaded
 * (frames are joined within `step`), and compares each marker with the computed point at its own
 * arc length. The marker on the clamp (arc length 0) is the origin and left out, and so are frames
 * outside 0..`last` (m). What the model does not reach is left out too. */
WB_MUST_CHECK enum wb_status wb_shapes_compare(struct wb_shapes_distance *distance,
                                               struct wb_computed *computed,
                                               const struct wb_material *material,
                                               const struct wb_dataset *const *datasets, int n,
                                               double step, double last);

#endif
