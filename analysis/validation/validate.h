/* Validation of calibrated properties on other datasets, each part of a test scored separately: the
 * first loading by eqs. 18 and 19 with the linear elastic prediction for comparison, the distance
 * of the markers from the computed shapes, the unloading, the residual deflection, and the work of
 * later cycles (analysis/validation/validate_cycle.h).
 *
 * Even a perfect model, one of the product's mean, does not predict a few specimens exactly.
 * Specimen i is k_i times as stiff as the mean, ln k_i normal with standard deviation s. The mean
 * of n specimens of the validation and the model, calibrated on m others, then differ by
 *
 *   d = mean of ln k over n - mean of ln k over m,  normal with deviation s (1/n + 1/m)^(1/2),
 *   RMS = |d| G,  G = RMS over the grid of dF/d ln k, over F_max.
 *
 * G is found with all moduli and stresses of the law slightly increased and decreased. s is pooled
 * over these specimens and the calibration's, with v degrees of freedom; s G of these specimens is
 * the smaller of scatter and residual scatter, which also contain other differences between
 * specimens. The RMS of a perfect model then exceeds
 *
 *   RMS95 = t_0.975(v) s (1/n + 1/m)^(1/2) G
 *
 * in one of twenty validations, whatever s is.
 *
 * The parts of a test have bounds (analysis/validation/validate_bounds.h). A correct law exceeds
 * any of them in one of twenty validations. */
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
    WB_VALIDATE_SHAPES,    /* m, RMS of the markers' displacement averaged over the samples */
    WB_VALIDATE_PARTS
};

struct wb_validate_bound {
    double found, bound; /* NaN unknown: one sample does not show how samples scatter */
    bool is_exceeded;
};

/* A computed loading curve on the grid of a measured one. */
struct wb_prediction {
    int n;         /* as the curve's */
    int n_reached; /* points for which the solver converged; n if all did */
    union {        /* (n) NaN beyond n_reached; owned */
        double *value;
        double *force;      /* N, zeroed at zero deflection */
        double *deflection; /* m, of a follower test */
    };
    /* (n) eq. 18: |measured - computed| over wb_curve_scale() of the measured curve; owned. */
    double *error;
    double rms; /* eq. 19 over the grid */
    double max_error;
    double rms_from_5mm; /* the same beyond 5 mm, where the error of the zero matters less */
};

struct wb_validate_result {
    struct wb_curve curve;              /* measured average; owned */
    struct wb_prediction elastoplastic; /* mean of the samples', each with its own bow */
    struct wb_prediction elastic;       /* with the mean bow */
    /* m: RMS distance of the measured markers from the points of the computed axis at the same arc
     * length and deflection (follower test: force), first loading; without the clamp's marker,
     * which is the origin; NaN without shapes. */
    double shape_rms;
    double shape_max; /* m */
    int n_shape_points;
    struct wb_marker_mean shapes;
    struct wb_validate_bound bounds[WB_VALIDATE_PARTS];
    double scatter_rms, residual_scatter_rms; /* as in calibrate */
    double stiffness_deviation; /* s of ln k above, pooled; NaN unknown (a single sample), */
    int stiffness_degrees;      /* and v */
    /* Error of a perfect model at this scatter: root mean square over many validations, and the
     * value that one of twenty exceeds; NaN if s is unknown. */
    double expected_rms, expected_rms_95;
    /* expected_rms squared over the elastoplastic RMS squared, at most 1: the part of the mean
     * square error that this scatter explains on average; NaN as above. */
    double scatter_share;
    struct wb_validate_cycles cycles; /* owned; zero samples of a follower test */
    bool is_beyond; /* curvature of the clamp above the range in which the properties are known */
    bool is_rule_untested; /* no unloading was calibrated: it is an assumption of the law */
    struct wb_test_info info;
    double cpu_s;
};

/* Predicts the average first loading of n datasets of one kind. `settings` NULL: defaults.
 * WB_ERR_DATA: the properties are of another wire, or the datasets cannot be used.
 * WB_ERR_CONVERGENCE: the beam does not converge at all; stopping later is a result, see n_reached.
 * `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_validate_run(struct wb_validate_result *result,
                                             const struct wb_properties *properties,
                                             const struct wb_dataset *const *datasets, int n,
                                             const struct wb_calibrate_settings *settings,
                                             struct wb_reason *why);
/* Writes measured and computed forces and errors on the grid as CSV:
 * deflection_mm,measured_N,low_N,high_N,deviation_N,elastoplastic_N,elastoplastic_error,elastic_N,elastic_error;
 * for a follower test force_N first and deflections in mm. Replaces an existing file by an atomic
 * rename. */
WB_MUST_CHECK enum wb_status wb_validate_write_csv(const struct wb_validate_result *result,
                                                   const char *path);
/* Writes the mean unloading likewise: deflection_mm,measured_N,elastoplastic_N,elastoplastic_error;
 * forces are tensions less that at zero deflection. */
WB_MUST_CHECK enum wb_status wb_validate_write_unloading(const struct wb_validate_result *result,
                                                         const char *path);
/* Appends the scores, one row each: analysis/validation/validate_tables.h. */
void wb_validate_put_scores(struct wb_text *text, const struct wb_validate_result *result);

/* WB_ERR_DATA if the properties are of a wire of another diameter; another name causes a
 * warning. */
WB_MUST_CHECK enum wb_status wb_validate_check_wire(const struct wb_properties *properties,
                                                    const struct wb_test_info *info,
                                                    struct wb_reason *why);

/* Frees and zeroes; accepts a zeroed one. */
void wb_validate_result_release(struct wb_validate_result *result);

/* Computed shape of the model at a deflection, for drawing: n points at equal arc length into x and
 * y (m). WB_ERR_CONVERGENCE if the model cannot reach the deflection, as beyond the largest
 * deflection of a follower test. */
WB_MUST_CHECK enum wb_status wb_validate_shape(const struct wb_properties *properties,
                                               const struct wb_test_info *info, double deflection,
                                               int n, double *x, double *y);

#endif
