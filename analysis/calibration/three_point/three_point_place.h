/* First contact and natural bow of a three-point bending test of a wire with a known law. The
 * priors are those of fits of the law (analysis/calibration/three_point/three_point_fit.h). */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_PLACE_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_PLACE_H

#include "analysis/calibration/three_point/three_point_data.h"
#include "analysis/calibration/three_point/three_point_fit.h"
#include "analysis/calibration/three_point/three_point_model.h"
#include "base/status.h"

struct wb_three_point_place {
    double first_contact; /* m of travel */
    double bow;           /* m, see struct wb_three_point_fit */
};

/* The natural bow's prior: its middle, m, and standard deviation, m, 0 if it is fixed. A value in
 * the specimen file fixes it, a range is two standard deviations on either side; without either the
 * wire is straight, or has the settings' bow_prior. */
void wb_three_point_place_bow(const struct wb_test_info *info,
                              const struct wb_three_point_fit_settings *settings, double *middle,
                              double *deviation);

/* Error of a point, N: the noise, or the settings' part of the largest force. */
double wb_three_point_place_error(const struct wb_three_point_data *data,
                                  const struct wb_three_point_fit_settings *settings);

/* Finds both from the loading, computed up to `deepest` (m of deflection), with a free factor of
 * the law's stiffness: otherwise the contact would compensate differences between specimens. A
 * fixed bow is not searched. The model keeps the run at the bow found; `run` is that run, and if it
 * did not reach its end, nothing was found. */
WB_MUST_CHECK enum wb_status
wb_three_point_place_find(struct wb_three_point_place *place, struct wb_three_point_model *model,
                          const struct wb_law *law, const struct wb_three_point_data *data,
                          double deepest, const struct wb_three_point_fit_settings *settings,
                          struct wb_three_point_run *run);

#endif
