/* K and n of a calibrated law fitted again, to a curve that differs little from the first.
 *
 * Gauss-Newton steps with Levenberg's damping need some fifteen runs, where a simplex would need
 * dozens and, with a looser tolerance, stop early in the narrow valley that K and n share.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_REFIT_H
#define WB_ANALYSIS_CALIBRATION_PAPER_REFIT_H

#include <stdbool.h>

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/curve.h"
#include "base/status.h"
#include "fe/material/material.h"

/* Changes K and n of `material`, from which the search starts. *settled is false when the beam did
 * not reach the end of the curve, K and n change the curve in the same way, or the steps ran out; K
 * and n are then of no use. *evaluations is increased by the beam runs made. */
WB_MUST_CHECK enum wb_status wb_refit_run(struct wb_material *material, bool *settled,
                                          struct wb_computed *computed,
                                          const struct wb_curve *curve, int *evaluations);

#endif
