/* Checks that a law fits no worse than a law that it contains. */
#ifndef WB_TESTS_ANALYSIS_CALIBRATION_CONTAINING_H
#define WB_TESTS_ANALYSIS_CALIBRATION_CONTAINING_H

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "tests/check.h"

/* Largest relative excess of the misfit of a law over that of a law it contains, over all
 * specimens. */
static inline double worst_of_containing(const struct wb_cycle_calibration *c)
{
    static const struct {
        enum wb_candidate containing, contained;
    } pairs[] = {
        {WB_CANDIDATE_LUDWIK_MIXED, WB_CANDIDATE_LUDWIK_ISOTROPIC},
        {WB_CANDIDATE_LUDWIK_MIXED, WB_CANDIDATE_LUDWIK_KINEMATIC},
        {WB_CANDIDATE_PARALLEL_MIXED, WB_CANDIDATE_PARALLEL_KINEMATIC},
        {WB_CANDIDATE_PARALLEL_COMBINED, WB_CANDIDATE_PARALLEL_KINEMATIC},
        {WB_CANDIDATE_LUDWIK_COMBINED, WB_CANDIDATE_LUDWIK_ISOTROPIC},
        {WB_CANDIDATE_CHABOCHE_TWO, WB_CANDIDATE_CHABOCHE_ONE},
    };
    double worst = 0.0;
    for (int i = 0; i < c->n_members; i++) {
        /* A fit that started from a contained law has the form of the containing one. */
        const struct wb_cycle_answer *const all = c->members[i].answers;
        if (all[WB_CANDIDATE_LUDWIK_COMBINED].is_fitted)
            assert_true(all[WB_CANDIDATE_LUDWIK_COMBINED].fit.law.is_combined);
        if (all[WB_CANDIDATE_PARALLEL_COMBINED].is_fitted)
            assert_true(all[WB_CANDIDATE_PARALLEL_COMBINED].fit.law.is_combined);
        if (all[WB_CANDIDATE_CHABOCHE_TWO].is_fitted)
            assert_int_equal(all[WB_CANDIDATE_CHABOCHE_TWO].fit.law.n_backs, 2);
        for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
            const struct wb_cycle_answer *const answers = c->members[i].answers;
            const struct wb_cycle_answer *const containing = &answers[pairs[k].containing];
            const struct wb_cycle_answer *const contained = &answers[pairs[k].contained];
            if (!containing->is_fitted || !contained->is_fitted)
                continue;
            const double off = containing->fit.misfit - contained->fit.misfit;
            worst = fmax(worst, off / contained->fit.misfit);
        }
    }
    return worst;
}

#endif
