/* Where a three-point bending test of a wire whose law is known begins: its first contact, and the
 * natural bow of its wire. The same priors hold where the law is fitted with them
 * (analysis/calibration/three_point/three_point_fit.h).
 */
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

/* The natural bow's prior: its middle, m, and standard deviation, m, 0 where it is held. A number
 * in the specimen's file holds it, a band is two deviations on either side; without either the wire
 * counts as straight, or as the settings' bow_prior says. */
void wb_three_point_place_bow(const struct wb_test_info *info,
                              const struct wb_three_point_fit_settings *settings, double *middle,
                              double *deviation);

/* Error of a point, N: the noise, or the settings' part of the largest force. */
double wb_three_point_place_error(const struct wb_three_point_data *data,
                                  const struct wb_three_point_fit_settings *settings);

/* Finds both on the loading, computed up to `deepest` (m of deflection), with the law's stiffness
 * left free: specimens differ, and a contact should not make up for that. A bow that the priors
 * hold is not looked for. The model is left with the run at the bow that was found; `run` is that
 * run, and where it did not come to its end, nothing was found. */
WB_MUST_CHECK enum wb_status
wb_three_point_place_find(struct wb_three_point_place *place, struct wb_three_point_model *model,
                          const struct wb_law *law, const struct wb_three_point_data *data,
                          double deepest, const struct wb_three_point_fit_settings *settings,
                          struct wb_three_point_run *run);

#endif
