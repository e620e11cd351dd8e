/* Scores of a validation beyond the first loading as JSON, for `validate --json` and
 * report.json. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_JSON_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_JSON_H

#include "analysis/keys/keys.h"
#include "analysis/validation/validate.h"
#include "base/json.h"

/* Keys of these scores. */
extern const struct wb_keys wb_validate_json_keys;

/* Sets the members clamp_curvature_1_m, beyond_known_curvature, unloading,
 * residual_deflection_mm and loop_energy_mJ of `item`; without unloading `unloading` is null and
 * the last two are absent. */
void wb_validate_json_put_cycles(struct wb_json *item, const struct wb_validate_result *result);

#endif
