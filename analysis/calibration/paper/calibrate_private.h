/* Declarations for the tests of calibrate.c. */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_CALIBRATE_PRIVATE_H
#define WB_ANALYSIS_CALIBRATION_PAPER_CALIBRATE_PRIVATE_H

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"

/* Fills in result->deviation, starting from the calibrated result->material, and counts the beam
 * runs. */
WB_MUST_CHECK enum wb_status wb_calibrate_deviations(struct wb_calibrate_result *result,
                                                     const struct wb_dataset *const *datasets,
                                                     int n,
                                                     const struct wb_calibrate_settings *settings,
                                                     struct wb_reason *why);

#endif
