/* A calibration on whole cycles as JSON, for `calibrate --json` and report.json. */
#ifndef WB_ANALYSIS_CALIBRATION_PROPERTIES_CYCLE_JSON_H
#define WB_ANALYSIS_CALIBRATION_PROPERTIES_CYCLE_JSON_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/keys/keys.h"
#include "base/json.h"

/* Its keys. */
extern const struct wb_keys wb_cycle_json_keys;

/* Sets the quantities (quantity.h), the hardening rule, the law, the specimens and the budget as
 * members of `object`. Unknown values are null. */
void wb_cycle_json_put(struct wb_json *object, const struct wb_cycle_calibration *calibration);

#endif
