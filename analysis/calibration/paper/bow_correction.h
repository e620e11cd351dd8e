/* What a bow changes in the closed forms of E and sigma_Y.
 *
 * Eqs. 10 and 11 hold for a straight wire; of a sample with a bow they give a modulus and a yield
 * stress that are not the material's. How far off they are is found by applying them to curves that
 * are computed for the same samples from a known material. */
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
    const struct wb_curve *curve;     /* their average: its grid is taken */
    double elastic_zone, yield_point; /* deflection over length of eqs. 10 and 11 */
    const struct wb_computed_settings *how;
};

/* Eqs. 10 and 11 on the mean of the curves computed with `material` for the samples, each with its
 * own natural shape. The bows change E by the factor of this modulus over the material's, and
 * sigma_Y likewise. WB_ERR_CONVERGENCE when a beam does not reach the end of the grid; *evaluations
 * is increased by the beam runs made. `why` receives why it failed; NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_bow_correction_guess(struct wb_first_guess *guess,
                                                     const struct wb_bow_samples *samples,
                                                     const struct wb_material *material,
                                                     int *evaluations, struct wb_reason *why);

#endif
