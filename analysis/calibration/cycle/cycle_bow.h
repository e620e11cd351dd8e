/* The bow of a specimen whose law is known, from what its strand carries before it is bent.
 *
 * The alignment knows no law: it extrapolates the loading to the natural tip, over millimetres that
 * a wire bowed downwards has left behind before the first reading. With a law the beam does that:
 * the bow is the one with which it carries, at the first point of the loading, what was measured
 * there. Everything after that point stays a prediction.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BOW_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BOW_H

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"
#include "fe/material/law.h"

/* The natural angle of the tip (rad) of the dataset's specimen, `data` being its first cycle.
 * Tensions have to be absolute: of a dataset whose alignment took no bow from the force, of a
 * simulation, and where no bow explains the tension, it is the alignment's. */
WB_MUST_CHECK enum wb_status wb_cycle_bow_find(double *angle, const struct wb_dataset *dataset,
                                               const struct wb_cycle_data *data,
                                               const struct wb_law *law,
                                               const struct wb_cycle_model_settings *settings);

#endif
