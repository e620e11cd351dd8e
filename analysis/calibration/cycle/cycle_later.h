/* Later cycles of a test, predicted by a law that was fitted to its first one.
 *
 * The fit does not use them, so they test the hardening rule: the beam computes the first cycle and
 * all later ones, with the specimen's own law, bow and level.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_LATER_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_LATER_H

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_fit.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"

struct wb_cycle_later_point {
    int cycle; /* from 2 */
    bool is_unloading;
    double deflection, t;      /* m, s */
    double measured, computed; /* N, tension; computed: NaN after a failure of the beam */
};

struct wb_cycle_later {
    int sample;
    int n_cycles; /* of the test, including the first; below 2: no points */
    int n;
    struct wb_cycle_later_point *points; /* (n), owned, in the order of the test */
    double rms;                          /* of computed minus measured, over the largest force */
    double measured_energy, computed_energy; /* J: mean energy lost in a later cycle */
};

/* Number of cycles of a dataset. */
int wb_cycle_later_count(const struct wb_dataset *dataset);

/* Predicts the later cycles of the dataset that `data` was taken from. Rows with a smaller tension
 * than the smallest of `data` are left out. */
WB_MUST_CHECK enum wb_status wb_cycle_later_predict(struct wb_cycle_later *later,
                                                    const struct wb_dataset *dataset,
                                                    const struct wb_cycle_data *data,
                                                    const struct wb_cycle_fit *fit);
void wb_cycle_later_release(struct wb_cycle_later *later); /* accepts a zeroed one */

#endif
