/* The default calibration method for datasets, for the command and the library. */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_METHOD_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_METHOD_H

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"

enum wb_method {
    WB_METHOD_CYCLE,       /* analysis/calibration/cycle/cycle_calibrate.h */
    WB_METHOD_PAPER,       /* analysis/calibration/paper/calibrate.h */
    WB_METHOD_THREE_POINT, /* analysis/calibration/three_point/three_point_calibrate.h */
    WB_METHODS
};

/* "cycle", "paper", "three-point"; NULL-terminated. */
extern const char *const wb_method_names[WB_METHODS + 1];
const char *wb_method_name(enum wb_method method);

/* Chooses the method: datasets of three-point bending have only one, cantilever tests with a
 * follower force need the paper's, all others are calibrated on whole cycles. WB_ERR_DATA for a
 * mixture of kinds; `names` of the n datasets (at least one) are for the message, which `why`
 * receives (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_method_choose(enum wb_method *method,
                                              const struct wb_dataset *const *datasets,
                                              const char *const *names, int n,
                                              struct wb_reason *why);

#endif
