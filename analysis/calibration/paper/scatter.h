/* Residual scatter between samples: the part that their bows do not explain. The curve predicted
 * with a sample's own natural shape is subtracted from its measured one, and the scatter of these
 * differences remains. */
#ifndef WB_ANALYSIS_CALIBRATION_PAPER_SCATTER_H
#define WB_ANALYSIS_CALIBRATION_PAPER_SCATTER_H

#include "analysis/calibration/paper/computed.h"
#include "analysis/dataset/curve.h"
#include "analysis/dataset/dataset.h"
#include "base/status.h"

/* At each point of the grid the standard deviation of these differences is taken over the samples
 * (n - 1); *rms receives its root mean square over the grid, divided by wb_curve_scale() of
 * `curve`, the average of all samples. 0 with one sample; NaN if a prediction does not converge
 * over the whole `curve`. */
WB_MUST_CHECK enum wb_status wb_scatter_residual(double *rms,
                                                 const struct wb_dataset *const *datasets, int n,
                                                 const struct wb_curve *curve,
                                                 const struct wb_material *material,
                                                 const struct wb_computed_settings *settings);

#endif
