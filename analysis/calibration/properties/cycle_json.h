/* A calibration on whole cycles as JSON: the same in `calibrate --json` and report.json. */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_JSON_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_JSON_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "base/json.h"

/* Sets the members flexural_rigidity_N_mm2, residual_curvature_ratio, loop_energy_mJ_per_m,
 * moment_curvature, hardening_rule, law, ludwik_equivalent, identifiable and specimens of `object`.
 * What is not known is null. */
void wb_cycle_json_put(struct wb_json *object, const struct wb_cycle_calibration *calibration);

#endif
