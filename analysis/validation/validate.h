/* Validation of calibrated properties on other datasets, each part of a test scored apart: the
 * first loading by eqs. 18 and 19 with the linear elastic prediction beside it, the distance of the
 * markers from the computed shapes, the unloading, the residual deflection, and the work of
 * later cycles (analysis/validate_cycle.h).
 *
 * Not even a perfect model, one of the product's mean, predicts a few specimens exactly. Specimen i
 * is k_i times as stiff as the mean, ln k_i normal with standard deviation s. The mean of n
 * specimens here and the model, calibrated on m others, then differ by
 *
 *     d = mean of ln k over n - mean of ln k over m,  normal with deviation s (1/n + 1/m)^(1/2),
 *     RMS = |d| G,  G = RMS over the grid of dF/d ln k, over F_max.
 *
 * G is found with moduli and stresses of the law all a little larger and smaller. s is pooled over
 * these specimens (s G is the smaller of scatter and residual scatter, which hold all else that
 * tells specimens apart as well) and the calibration's, with v degrees of freedom; so the RMS of a
 * perfect model is beyond
 *
 *     RMS95 = t_0.975(v) s (1/n + 1/m)^(1/2) G
 *
 * in one of twenty validations, whatever s is.
 *
 * The parts of a test have bounds (analysis/validation/validate_bounds.h) of which a right law
 * exceeds any in one of twenty validations. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_H

#include "analysis/calibration/properties/properties.h"
#include "analysis/dataset/curve.h"
#include "analysis/dataset/dataset.h"
#include "analysis/validation/marker_distance.h"
#include "analysis/validation/validate_cycle.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

/* Parts of a test that have a bound. */
enum wb_validate_part {
    WB_VALIDATE_LOADING,   /* RMS over F_max */
    WB_VALIDATE_UNLOADING, /* RMS over F_max, with the law as stiff as each sample's loading */
    WB_VALIDATE_RESIDUAL,  /* m, of the mean residual deflection, likewise */
    WB_VALIDATE_SHAPES,    /* m, RMS of the markers' mean displacement over the samples */
    WB_VALIDATE_PARTS
};

struct wb_validate_bound {
    double found, bound; /* NaN unknown: one sample does not show how samples scatter */
    bool is_exceeded;
};

/* A computed loading curve on the grid of a measured one. */
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
    struct wb_curve curve;              /* measured average; owned */
    struct wb_prediction elastoplastic; /* mean of the samples', each with its own bow */
    struct wb_prediction elastic;       /* with the mean bow */
    double shape_rms; /* m: RMS distance of measured markers from the points of the computed axis
                         at the same arc length and deflection (follower force, of a follower
                         test), first loading; the clamp's marker, which is the origin, is left
                         out; NaN without shapes */
    double shape_max; /* m */
    int n_shape_points;
    struct wb_marker_mean shapes;
    struct wb_validate_bound bounds[WB_VALIDATE_PARTS];
    double scatter_rms, residual_scatter_rms; /* as in calibrate */
    double stiffness_deviation; /* s of ln k above, pooled; NaN unknown: one sample and no other, */
    int stiffness_degrees;      /* and v */
    /* What a perfect model gets with this scatter: root mean square over many such validations, and
     * the value that one of twenty exceeds; NaN where s is not known. */
    double expected_rms, expected_rms_95;
    /* expected_rms squared over the elastoplastic RMS squared, at most 1: how much of the mean
     * square error such scatter makes on average; NaN as above. */
    double scatter_share;
    struct wb_validate_cycles cycles; /* owned; zero samples of a follower test */
    bool is_beyond;        /* bent further than the properties are known: curvature of the clamp */
    bool is_rule_untested; /* the properties are of a loading alone: the unloading is its guess */
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
/* The mean unloading likewise: deflection_mm,measured_N,elastoplastic_N,elastoplastic_error; forces
 * are tensions less that at zero deflection. */
WB_MUST_CHECK enum wb_status wb_validate_write_unloading(const struct wb_validate_result *result,
                                                         const char *path);
/* Appends its scores, a row each: analysis/validation/validate_tables.h. */
void wb_validate_put_scores(struct wb_text *text, const struct wb_validate_result *result);

/* WB_ERR_DATA where the properties are of a wire of another diameter; another name is warned about.
 */
WB_MUST_CHECK enum wb_status wb_validate_check_wire(const struct wb_properties *properties,
                                                    const struct wb_test_info *info,
                                                    struct wb_reason *why);

/* Frees and zeroes; accepts a zeroed one. */
void wb_validate_result_release(struct wb_validate_result *result);

/* Computed shape of the model at a deflection, for drawing: n points at equal arc length into x
 * and y (m). WB_ERR_CONVERGENCE when the model cannot reach it; beyond the largest deflection of a
 * follower test it cannot. */
WB_MUST_CHECK enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                               const struct wb_test_info *info, double deflection,
                                               int n, double *x, double *y);

#endif
