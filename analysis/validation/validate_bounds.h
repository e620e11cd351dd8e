/* Bounds of a validation's errors for a correct law: specimens differ, and the mean of a few is not
 * that of the product.
 *
 * With n samples here, m of the calibration and a standard deviation s between samples, the mean
 * difference of measured and computed values exceeds
 *
 *   t(1 - a/2, v) s (1/n + 1/m)^(1/2)
 *
 * with probability a. For the loading, s is that of the stiffness (validate.h), pooled over both
 * groups. For the unloading and the residual deflection the law is first made as stiff as each
 * sample's own loading, and s is the deviation that then remains between these samples, v = n - 1;
 * s is at least 0.2 % of F_max or 0.2 mm. For loading and unloading, twice the law's misfit in the
 * calibration is added in quadrature. Shapes do not depend on the stiffness: they scatter because
 * of the markers' offsets, one per marker, and Fisher's F of as many degrees of freedom replaces t
 * squared. The level a of each part is such that one of twenty validations exceeds any bound.
 */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_BOUNDS_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_BOUNDS_H

#include "analysis/validation/validate.h"

/* Fills in result->bounds. */
void wb_validate_bounds_find(struct wb_validate_result *result,
                             const struct wb_properties *properties);

/* "loading", "unloading", "residual deflection", "shapes". */
const char *wb_validate_part_name(enum wb_validate_part part);
/* Keys in files: "loading", "unloading", "residual_deflection_mm", "shapes_mm"; and their units in
 * SI. */
const char *wb_validate_part_key(enum wb_validate_part part);
double wb_validate_part_unit(enum wb_validate_part part);

/* Appends the names of the parts whose bound is exceeded: "loading, unloading". */
void wb_validate_bounds_append(struct wb_text *text, const struct wb_validate_result *result);

/* Verdict whether the law predicts these tests. */
enum wb_validate_verdict {
    WB_VALIDATE_PREDICTED,
    WB_VALIDATE_NOT_PREDICTED, /* a bound is exceeded */
    WB_VALIDATE_UNDECIDED,     /* no bound of the loading: the scatter is unknown */
    WB_VALIDATE_BEYOND,        /* curvature above the range in which the properties are known */
    WB_VALIDATE_NOT_CONVERGED  /* the beam did not reach the largest deflection */
};
enum wb_validate_verdict wb_validate_bounds_verdict(const struct wb_validate_result *result);

/* Whether any bound is exceeded, and whether any is known. */
bool wb_validate_bounds_exceeded(const struct wb_validate_result *result);
bool wb_validate_bounds_known(const struct wb_validate_result *result);

#endif
