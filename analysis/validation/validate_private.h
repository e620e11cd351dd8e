/* Declarations for the tests of validate.c. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_PRIVATE_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_PRIVATE_H

#include "analysis/validation/validate.h"

/* Points at equal arc length from the clamp to the tip; arrays of the caller. */
struct wb_validate_points {
    int n;
    double *x, *y; /* (n) m */
    double *angle; /* (n) rad; may be NULL */
};

/* The shape of a follower test under a force (N), otherwise as wb_validate_shape(). The force may
 * be one under which the wire has curled up and the deflection decreases again. */
WB_MUST_CHECK enum wb_status wb_validate_follower_shape(const struct wb_properties *properties,
                                                        const struct wb_test_info *info,
                                                        double force,
                                                        const struct wb_validate_points *points);

#endif
