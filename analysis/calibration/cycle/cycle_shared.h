/* Quantities that all specimens of a wire share. Their errors cannot be seen in the data of a
 * bending test: a cell that reads 1 % too much makes every specimen 1 % stiffer. Relaxation cannot
 * be seen either unless the tip is held for a while.
 *
 * This module alters the data of a specimen as another value of such a quantity would; the fit
 * finds the change of its law with them (cycle_fit.h). The diameter needs no altered data: stress
 * and strain are derived from moment and curvature, so moments do not change, and E is proportional
 * to the inverse fourth power of the diameter; only the weight changes, with the square.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SHARED_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SHARED_H

#include "analysis/calibration/cycle/cycle_data.h"

enum wb_cycle_shared {
    WB_SHARED_GAIN,          /* of the load cell */
    WB_SHARED_LENGTH,        /* from the clamp to the strand */
    WB_SHARED_COUNTERWEIGHT, /* mass */
    WB_SHARED_DENSITY,
    WB_SHARED_MARKERS,    /* their distance from the axis, which changes all deflections */
    WB_SHARED_RELAXATION, /* part of the force that would relax in a long dwell, for a test without
                             one; the fit adds a Maxwell element to its law */
    WB_SHARED_DIAMETER,   /* needs no altered data */
    WB_SHARED
};

/* "gain of the load cell", ... */
const char *wb_cycle_shared_name(enum wb_cycle_shared shared);
/* "cell_gain", ... */
const char *wb_cycle_shared_key(enum wb_cycle_shared shared);

/* Change over which a fit is linear: relative, of the markers in m. */
double wb_cycle_shared_change(enum wb_cycle_shared shared);

/* Whether the quantity applies to a test. */
bool wb_cycle_shared_applies(const struct wb_cycle_data *data, enum wb_cycle_shared shared);

/* Standard uncertainty that the files of the test state, in the same unit; 0: not stated. For
 * relaxation, which no file states, the prior. */
double wb_cycle_shared_uncertainty(const struct wb_cycle_data *data, double relaxation_prior,
                                   enum wb_cycle_shared shared);

/* Makes data with the quantity increased by a change in that unit (for the gain, the readings). The
 * caller releases them with wb_cycle_data_release(). False, with nothing to release, if the
 * quantity does not apply to the test. */
bool wb_cycle_shared_alter(struct wb_cycle_data *altered, const struct wb_cycle_data *data,
                           enum wb_cycle_shared shared, double change);

#endif
