/* Fits K and n of a calibrated law again to a curve that differs little from the first.
 *
 * Gauss-Newton steps with Levenberg's damping need about fifteen runs. A simplex would need dozens
 * and, with a looser tolerance, stop early, because K and n are strongly correlated.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_REFIT_H
#define WB_ANALYSIS_CALIBRATION_PAPER_REFIT_H

#include <stdbool.h>

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/curve.h"
#include "base/status.h"
#include "fe/material/material.h"

/* Changes K and n of `material`, the initial guess. *converged is false if the beam did not reach
 * the end of the curve, K and n have the same effect on the curve, or the steps were exhausted; K
 * and n are then invalid. *evaluations is increased by the number of beam runs. */
WB_MUST_CHECK enum wb_status wb_refit_run(struct wb_material *material, bool *converged,
                                          struct wb_computed *computed,
                                          const struct wb_curve *curve, int *evaluations);

#endif
