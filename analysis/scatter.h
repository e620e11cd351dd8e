/* Scatter between samples that their bows do not explain: of what is left of each sample's curve
 * when the prediction with that sample's own natural shape is subtracted. */
#ifndef WB_ANALYSIS_SCATTER_H
#define WB_ANALYSIS_SCATTER_H

#include "analysis/computed.h"
#include "analysis/curve.h"
#include "analysis/dataset.h"
#include "base/status.h"

/* Root mean square over the grid of the standard deviation of these differences over the samples
 * (n - 1), over the average's wb_curve_scale(). 0 with one sample; NaN when a prediction does not
 * converge over the whole of `curve`, the average of all. */
WB_MUST_CHECK enum wb_status wb_scatter_residual(double *rms,
                                                 const struct wb_dataset *const *datasets, int n,
                                                 const struct wb_curve *curve,
                                                 const struct wb_material *material,
                                                 const struct wb_computed_settings *settings);

#endif
