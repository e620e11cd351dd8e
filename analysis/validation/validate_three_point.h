/* Validation of calibrated properties on three-point bending tests, each part of a test scored
 * separately: the first loading with an elastic prediction for comparison, the unloading, and the
 * residual deflection at which the nose leaves the wire.
 *
 * The first contact with the wire belongs to the test, not to the law: it is found with the law for
 * each test, within the prior that calibrations give it, like the bow of a cantilever. The score
 * with the contact that the readings show is given for comparison. Friction, nose and compliance
 * come from the machine file, or are the middle of their ranges; the scores at the ends of the
 * ranges are given as well.
 *
 * The error expected from scatter between specimens is that of validate.h. Its unit is the test, or
 * the series where calibration or datasets have several: what the tests of a series have in common
 * does not average out over them. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_THREE_POINT_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_THREE_POINT_H

#include <stdbool.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "analysis/dataset/dataset.h"
#include "analysis/validation/expected.h"
#include "analysis/validation/validate_bounds.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "base/text.h"

enum {
    WB_VALIDATE_THREE_POINT_GRID = 61
};

struct wb_validate_three_point_test {
    struct wb_three_point_data data; /* owned */
    bool is_used;
    struct wb_reason why;      /* why it is not used */
    double first_contact;      /* m of travel, found with the law */
    double bow;                /* m, see struct wb_three_point_fit */
    bool is_bow_searched;      /* else it is the specimen's, or zero */
    double rms, unloading_rms; /* of its own points over its own F_max; NaN: no unloading */
    double residual_measured,
        residual_computed; /* m beyond the first contact: the unloading extrapolated to zero force
                              by a line through its last points */
};

/* Mean curves over the tests on an even grid. */
struct wb_validate_three_point_branch {
    int n; /* WB_VALIDATE_THREE_POINT_GRID; 0: no branch, or no deflections that all tests have */
    double deflection[WB_VALIDATE_THREE_POINT_GRID]; /* m beyond the first contact */
    double measured[WB_VALIDATE_THREE_POINT_GRID];   /* N, */
    double deviation[WB_VALIDATE_THREE_POINT_GRID];  /* between tests; NaN for a single test, */
    double computed[WB_VALIDATE_THREE_POINT_GRID];
    double rms, largest_error; /* of their difference over F_max */
};

struct wb_validate_three_point {
    struct wb_test_info info;
    struct wb_three_point_bench bench;
    bool is_compliance_known; /* else assumed to be 0 */
    int n_tests, n_used, n_series;
    struct wb_validate_three_point_test *tests; /* (n_tests), owned */
    double max_force;                           /* N: F_max, largest of the mean loading */
    struct wb_validate_three_point_branch loading, unloading;
    double elastic[WB_VALIDATE_THREE_POINT_GRID]; /* N, of the loading */
    double elastic_rms;
    double rms_as_read; /* of the loading, with the contacts that the readings show */
    double bench_rms[WB_THREE_POINT_VARIANTS]; /* of the loading at the ends of the bench's ranges,
                                                  in the order of struct wb_three_point_calibration;
                                                  NaN: known exactly, or not reached */
    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS]; /* their names and values */
    int n_unloading;                                             /* tests with unloading */
    double unloading_rms_of_tests; /* of all their points, each test separately, over F_max */
    double residual_measured,
        residual_computed; /* m, means over those tests; NaN if there are none */
    double scatter_rms;    /* standard deviation between tests, over F_max; NaN for a single test */
    bool is_by_series;
    struct wb_expected expected;
    double largest_curvature; /* 1/m, at midspan */
    bool is_beyond; /* largest_curvature is above the range in which the properties are known */
    bool is_rule_untested; /* the unloading is an assumption of the law */
    double cpu_s;
};

/* Predicts n tests of one wire on one bench. Of a calibration's settings those of the points, of
 * contact and bow, and of the beam are used. WB_ERR_DATA: the properties are of another wire, or no
 * test can be used; WB_ERR_CONVERGENCE: the beam does not reach the end of the tests. `why`
 * receives the reason (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_validate_three_point_run(
    struct wb_validate_three_point *result, const struct wb_properties *properties,
    const struct wb_dataset *const *datasets, int n,
    const struct wb_three_point_calibrate_settings *settings, struct wb_reason *why);

/* The verdict on the loading, by the error that scatter between specimens explains. */
enum wb_validate_verdict
wb_validate_three_point_verdict(const struct wb_validate_three_point *result);

/* Writes the mean curves as CSV: deflection_mm,measured_N,deviation_N,computed_N,error,elastic_N;
 * the last column is absent for the unloading. Replaces an existing file by an atomic rename. */
WB_MUST_CHECK enum wb_status
wb_validate_three_point_write_csv(const struct wb_validate_three_point *result, bool unloading,
                                  const char *path);

/* Appends the scores, one row each: analysis/validation/validate_tables.h. */
void wb_validate_three_point_put_scores(struct wb_text *text,
                                        const struct wb_validate_three_point *result);

/* Sets the numbers as members of an object. */
void wb_validate_three_point_put_json(struct wb_json *item,
                                      const struct wb_validate_three_point *result);

void wb_validate_three_point_release(struct wb_validate_three_point *result); /* accepts zeroed */

#endif
