/* Bounds of what a validation finds, for a law that is right: specimens differ, and a few of them
 * never show their product's mean.
 *
 * Of n samples here and m of the calibration, with a standard deviation s between samples, the mean
 * difference of measured and computed is beyond
 *
 *     t(1 - a/2, v) s (1/n + 1/m)^(1/2)
 *
 * with the probability a. Of the loading s is that of the stiffness (validate.h), pooled over both.
 * Of the unloading and the residual deflection each sample's own loading says how stiff it is, and
 * s is what then remains between these samples, v = n - 1; s is at least 0.2 % of F_max or 0.2 mm.
 * To loading and unloading twice the law's misfit in the calibration is added in squares. Shapes do
 * not depend on the stiffness: the markers' offsets make them scatter, each its own, and Fisher's F
 * of as many degrees takes the place of t squared. The level a of each makes one of twenty
 * validations exceed any.
 */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_BOUNDS_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_BOUNDS_H

#include "analysis/validation/validate.h"

/* Fills in result->bounds. */
void wb_validate_bounds_find(struct wb_validate_result *result,
                             const struct wb_properties *properties);

/* "loading", "unloading", "residual deflection", "shapes". */
const char *wb_validate_part_name(enum wb_validate_part part);
/* "loading", "unloading", "residual_deflection_mm", "shapes_mm": of files; and the size in SI of
 * the unit. */
const char *wb_validate_part_key(enum wb_validate_part part);
double wb_validate_part_unit(enum wb_validate_part part);

/* Appends "loading, unloading": the parts whose bound is exceeded. */
void wb_validate_bounds_append(struct wb_text *text, const struct wb_validate_result *result);

/* Whether the law predicts these tests. */
enum wb_validate_verdict {
    WB_VALIDATE_PREDICTED,
    WB_VALIDATE_NOT_PREDICTED, /* a bound is exceeded */
    WB_VALIDATE_UNDECIDED,     /* without the bound of the loading: the scatter is not known */
    WB_VALIDATE_BEYOND,        /* bent further than the properties are known */
    WB_VALIDATE_NOT_CONVERGED  /* the beam did not reach the largest deflection */
};
enum wb_validate_verdict wb_validate_bounds_verdict(const struct wb_validate_result *result);

/* Whether any bound is exceeded; whether any is known. */
bool wb_validate_bounds_exceeded(const struct wb_validate_result *result);
bool wb_validate_bounds_known(const struct wb_validate_result *result);

#endif
