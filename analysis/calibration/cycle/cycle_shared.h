/* What all specimens of a wire share leaves no trace in the data of a bending test: a cell that
 * shows 1 % too much makes every specimen 1 % stiffer.
 *
 * That a wire relaxes leaves none either, unless the tip is held for a while.
 *
 * A specimen's data as they would be with another size of it. The fit asks with them how its law
 * changes (cycle_fit.h). The diameter is exact: stress and strain are derived from moment and
 * curvature, so moments stay, and E goes with the inverse fourth power of the diameter; only the
 * weight goes with its square.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SHARED_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SHARED_H

#include "analysis/calibration/cycle/cycle_data.h"

enum wb_cycle_shared {
    WB_SHARED_GAIN,          /* of the load cell */
    WB_SHARED_LENGTH,        /* from the clamp to the strand */
    WB_SHARED_COUNTERWEIGHT, /* mass */
    WB_SHARED_DENSITY,
    WB_SHARED_MARKERS,    /* their distance from the axis, and with it all deflections */
    WB_SHARED_RELAXATION, /* part of the force that would go in a long dwell, of a test without one;
                             the fit adds a Maxwell element to its law */
    WB_SHARED_DIAMETER,   /* has no data of its own */
    WB_SHARED
};

/* "gain of the load cell", ... */
const char *wb_cycle_shared_name(enum wb_cycle_shared shared);
/* "cell_gain", ... */
const char *wb_cycle_shared_key(enum wb_cycle_shared shared);

/* A change of it over which a fit is linear: a part of it, of the markers m. */
double wb_cycle_shared_change(enum wb_cycle_shared shared);

/* Whether a test has such a thing. */
bool wb_cycle_shared_applies(const struct wb_cycle_data *data, enum wb_cycle_shared shared);

/* Its standard uncertainty as the test's files state it, in the same unit; 0: not stated. Of
 * relaxation, which no file states, the prior. */
double wb_cycle_shared_uncertainty(const struct wb_cycle_data *data, double relaxation_prior,
                                   enum wb_cycle_shared shared);

/* Data with it larger by a change in that unit, of the gain the readings; release with
 * wb_cycle_data_release(). False, and nothing to release, where the test has no such thing. */
bool wb_cycle_shared_alter(struct wb_cycle_data *altered, const struct wb_cycle_data *data,
                           enum wb_cycle_shared shared, double change);

#endif
