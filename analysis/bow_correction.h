/* Eqs. 10 and 11 hold for a straight wire. What they make of bowed samples is found by applying
 * them to computed curves of the same samples. */
#ifndef WB_ANALYSIS_BOW_CORRECTION_H
#define WB_ANALYSIS_BOW_CORRECTION_H

#include "analysis/computed.h"
#include "analysis/curve.h"
#include "analysis/dataset.h"
#include "analysis/first_guess.h"
#include "base/status.h"

struct wb_bow_samples {
    const struct wb_dataset *const *datasets; /* (n) */
    int n;
    const struct wb_curve *curve;     /* their average: its grid is taken */
    double elastic_zone, yield_point; /* deflection over length of eqs. 10 and 11 */
    const struct wb_computed_settings *how;
};

/* Eqs. 10 and 11 on the mean of the curves computed with `material` for the samples, each with its
 * own natural shape. Their modulus over the material's is what the bows
 * make of E, and so for the yield stress. WB_ERR_CONVERGENCE when a beam does not reach the end of
 * the grid; *evaluations is increased by the beam runs made. */
WB_MUST_CHECK enum wb_status wb_bow_correction_guess(struct wb_first_guess *guess,
                                                     const struct wb_bow_samples *samples,
                                                     const struct wb_material *material,
                                                     int *evaluations);

#endif
