/* Bow of a specimen whose law is known, from the tension of its strand at the start of the loading.
 *
 * The alignment, which has no law, extrapolates the loading to the natural position of the tip; a
 * wire that is bowed downwards has passed these millimetres before the first reading. With a law,
 * the bow is the one with which the beam has the measured tension at the first point of the
 * loading. All later points remain predictions.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BOW_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_BOW_H

#include "analysis/calibration/cycle/cycle_data.h"
#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"
#include "fe/material/law.h"

/* Finds the natural angle of the tip (rad) of the dataset's specimen from `data`, its first cycle.
 * This needs absolute tensions. The angle is that of the alignment for a dataset whose alignment
 * took no bow from the force, for a simulation, and if no bow explains the tension. */
WB_MUST_CHECK enum wb_status wb_cycle_bow_find(double *angle, const struct wb_dataset *dataset,
                                               const struct wb_cycle_data *data,
                                               const struct wb_law *law,
                                               const struct wb_cycle_model_settings *settings);

/* Standard deviation of the bow of the alignment, m; 0.3 mm if the alignment does not state it. */
double wb_cycle_bow_deviation(const struct wb_dataset *dataset);

#endif
