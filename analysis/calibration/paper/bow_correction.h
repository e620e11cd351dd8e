/* Effect of specimens' bows on the closed forms of E and sigma_Y.
 *
 * Eqs. 10 and 11 assume a straight wire; for a sample with a bow their modulus and yield stress are
 * biased. The bias is found by applying them to curves that are computed for the same samples with
 * a known material.
 */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_BOW_CORRECTION_H
#define WB_ANALYSIS_CALIBRATION_PAPER_BOW_CORRECTION_H

#include "analysis/calibration/paper/computed.h"
#include "analysis/calibration/paper/first_guess.h"
#include "analysis/dataset/curve.h"
#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"

struct wb_bow_samples {
    const struct wb_dataset *const *datasets; /* (n) */
    int n;
    const struct wb_curve *curve;     /* their average, whose grid is used */
    double elastic_zone, yield_point; /* deflection over length of eqs. 10 and 11 */
    const struct wb_computed_settings *how;
};

/* Applies eqs. 10 and 11 to the mean of the curves computed with `material` for the samples, each
 * with its own natural shape. The bows change E by the ratio of this modulus to the material's, and
 * sigma_Y likewise. WB_ERR_CONVERGENCE if a beam does not reach the end of the grid. *evaluations
 * is increased by the number of beam runs. `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_bow_correction_guess(struct wb_first_guess *guess,
                                                     const struct wb_bow_samples *samples,
                                                     const struct wb_material *material,
                                                     int *evaluations, struct wb_reason *why);

#endif
