/* What all specimens of a wire share leaves no trace in the data of a bending test: a cell that
 * shows 1 % too much makes every specimen 1 % stiffer. What such an error does to the results is
 * told apart, in percent per percent.
 *
 * It is found by fitting the chosen law to one specimen again, with the reading or the length
 * changed by a small part; with parallel parts, whose first moduli are loosely known, to some
 * tenths. The diameter is exact: stress and strain are derived from moment and
 * curvature, so EI and M(kappa) stay, and E goes with the inverse fourth power of the diameter.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SENSITIVITY_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_SENSITIVITY_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "base/json.h"
#include "base/status.h"

enum wb_cycle_shared {
    WB_SHARED_GAIN, /* of the load cell */
    WB_SHARED_LENGTH,
    WB_SHARED_COUNTERWEIGHT,
    WB_SHARED_DIAMETER,
    WB_SHARED
};

/* "gain of the load cell", ... */
const char *wb_cycle_shared_name(enum wb_cycle_shared shared);

/* Percent per percent of what is shared; NaN: unknown. */
struct wb_cycle_sensitivity {
    double rigidity, modulus; /* EI, E */
    double moment;            /* M at the largest curvature */
    double springback;        /* NaN without a way back */
};

/* Of the first specimen of a calibration that ended well; of one that was stopped nothing is
 * looked for. A fit that fails or does not converge leaves NaN. */
WB_MUST_CHECK enum wb_status
wb_cycle_sensitivity_find(const struct wb_cycle_calibration *calibration,
                          const struct wb_cycle_calibrate_settings *settings,
                          struct wb_cycle_sensitivity sensitivities[WB_SHARED]);

/* Appends an object for each to an array. */
void wb_cycle_sensitivity_put(struct wb_json *array,
                              const struct wb_cycle_sensitivity sensitivities[WB_SHARED]);

#endif
