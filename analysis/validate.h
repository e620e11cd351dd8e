/* Validation of calibrated properties on other datasets: eqs. 18 and 19, the linear elastic
 * prediction beside it, and the distance of the markers from the computed shapes. */
#ifndef WB_ANALYSIS_VALIDATE_H
#define WB_ANALYSIS_VALIDATE_H

#include "analysis/curve.h"
#include "analysis/dataset.h"
#include "analysis/properties.h"
#include "base/reason.h"
#include "base/status.h"

/* A computed loading curve on the grid of a measured one, and shapes of the same model. */
struct wb_prediction {
    int n;         /* as the curve's */
    int n_reached; /* points reached before the solver gave up; n when all converged */
    union {        /* (n) NaN beyond n_reached; owned */
        double *value;
        double *force;      /* N, zeroed at zero deflection */
        double *deflection; /* m, of a follower test */
    };
    double
        *error; /* (n) eq. 18: |measured - computed| over wb_curve_scale() of the measured; owned */
    double rms; /* eq. 19 over the grid */
    double max_error;
    double rms_from_5mm; /* the same over what lies beyond 5 mm, where the zero matters less */
};

struct wb_validate_result {
    struct wb_curve curve; /* measured average; owned */
    struct wb_prediction elastoplastic, elastic;
    double shape_rms; /* m: RMS distance of measured markers from the points of the computed axis
                         at the same arc length and deflection (follower force, of a follower
                         test), first loading; the clamp's marker, which is the origin, is left
                         out; NaN without shapes */
    double shape_max; /* m */
    int n_shape_points;
    double scatter_rms, residual_scatter_rms; /* as in calibrate */
    /* RMS error to be expected from the scatter between samples alone, at most: standard errors of
     * this average and of the one calibrated on (as far as known), from the smaller of their
     * scatter and their residual scatter, added in squares. An upper bound: the residual scatter
     * holds the model's own error with the samples' bows too. */
    double expected_rms;
    /* expected_rms squared over the elastoplastic RMS squared, at most 1: the scatter explains at
     * most this share of the mean square error; NaN with one sample. */
    double scatter_share;
    struct wb_test_info info;
    double cpu_s;
};

/* Predicts the average first loading of n datasets of one kind. `settings` NULL: defaults.
 * WB_ERR_DATA when the properties are another wire's or the datasets cannot serve,
 * WB_ERR_CONVERGENCE when the beam does not get anywhere; stopping on the way is a result, see
 * n_reached. `why` receives why it failed; NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_validate_run(struct wb_validate_result *result,
                                             const struct wb_properties *properties,
                                             const struct wb_dataset *const *datasets, int n,
                                             const struct wb_calibrate_settings *settings,
                                             struct wb_reason *why);
/* Measured and computed forces and errors on the grid, as CSV:
 * deflection_mm,measured_N,low_N,high_N,deviation_N,elastoplastic_N,elastoplastic_error,elastic_N,
 * elastic_error; of a follower test force_N first and deflections in mm. Written atomically over an
 * existing file. */
WB_MUST_CHECK enum wb_status wb_validate_write_csv(const struct wb_validate_result *result,
                                                   const char *path);

/* Frees and zeroes; accepts a zeroed one. */
void wb_validate_result_release(struct wb_validate_result *result);

/* Computed shape of the model at a deflection, for drawing: n points at equal arc length into x
 * and y (m). WB_ERR_CONVERGENCE when the model cannot reach it; beyond the largest deflection of a
 * follower test it cannot. */
WB_MUST_CHECK enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                               const struct wb_test_info *info, double deflection,
                                               int n, double *x, double *y);

#endif
