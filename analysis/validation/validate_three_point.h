/* Validation of calibrated properties on three-point bending tests, each part of a test scored
 * apart: the first loading beside an elastic prediction, the unloading, and the deflection that is
 * left when the nose leaves the wire.
 *
 * Where a wire is first touched is the test's, not the law's: each test's first contact is found
 * with the law, within the prior that calibrations give it, as the bow of a cantilever is. The
 * score with the contact where the readings show it stands beside. Friction, nose and compliance
 * are the machine file's, or the middle of their bands; the score at the ends stands beside, too.
 *
 * What scatter between specimens makes of a perfect model's error is as in validate.h. The unit is
 * the test, or the series where calibration or datasets have several: what a series has in common
 * is not averaged away by its tests. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_THREE_POINT_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_THREE_POINT_H

#include <stdbool.h>

#include "analysis/calibration/properties/properties.h"
#include "analysis/calibration/three_point/three_point_calibrate.h"
#include "analysis/dataset/dataset.h"
#include "analysis/validation/expected.h"
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
    struct wb_reason why;      /* where it is not */
    double first_contact;      /* m of travel, found with the law */
    double bow;                /* m, see struct wb_three_point_fit */
    bool is_bow_searched;      /* else it is the specimen's, or none */
    double rms, unloading_rms; /* of its own points over its own F_max; NaN: no unloading */
    double left_measured,
        left_computed; /* m beyond the first contact, where the force comes to zero
                          during unloading, by a line through the last points */
};

/* Mean curves over the tests on an even grid. */
struct wb_validate_three_point_way {
    int n; /* WB_VALIDATE_THREE_POINT_GRID; 0: none, or no deflections that all tests have */
    double deflection[WB_VALIDATE_THREE_POINT_GRID]; /* m beyond the first contact */
    double measured[WB_VALIDATE_THREE_POINT_GRID];   /* N, */
    double deviation[WB_VALIDATE_THREE_POINT_GRID];  /* between tests; NaN of one, */
    double computed[WB_VALIDATE_THREE_POINT_GRID];
    double rms, largest_error; /* of their difference over F_max */
};

struct wb_validate_three_point {
    struct wb_test_info info;
    struct wb_three_point_bench bench;
    bool is_compliance_known; /* else taken as none */
    int n_tests, n_used, n_series;
    struct wb_validate_three_point_test *tests; /* (n_tests), owned */
    double max_force;                           /* N: F_max, largest of the mean loading */
    struct wb_validate_three_point_way loading, unloading;
    double elastic[WB_VALIDATE_THREE_POINT_GRID]; /* N, of the loading */
    double elastic_rms;
    double rms_as_read; /* of the loading with the contacts that the readings show */
    double bench_rms[WB_THREE_POINT_VARIANTS]; /* of the loading at the bench's ends, in the order
                                             of struct wb_three_point_calibration; NaN: known, or it
                                             does not come so far */
    struct wb_three_point_variant ends[WB_THREE_POINT_VARIANTS]; /* name and value of those */
    int n_unloading;                                             /* tests with unloading */
    double unloading_rms_of_tests;       /* of all their points, each test by itself, over F_max */
    double left_measured, left_computed; /* m, means over those tests; NaN none */
    double scatter_rms; /* standard deviation between tests, over F_max; NaN of one */
    bool is_by_series;
    struct wb_expected expected;
    double largest_curvature; /* 1/m, in the middle */
    bool is_beyond;           /* bent further than the properties are known */
    bool is_rule_untested;    /* the unloading is the law's guess */
    double cpu_s;
};

/* Predicts n tests of one wire on one bench, with the settings of a calibration, of which those of
 * the points, of contact and bow, and of the beam count. WB_ERR_DATA when the properties are
 * another wire's or no test can serve, WB_ERR_CONVERGENCE when the beam does not come to the end of
 * the tests. The reason goes to `why` (NULL: logged). */
WB_MUST_CHECK enum wb_status wb_validate_three_point_run(
    struct wb_validate_three_point *result, const struct wb_properties *properties,
    const struct wb_dataset *const *datasets, int n,
    const struct wb_three_point_calibrate_settings *settings, struct wb_reason *why);

/* Mean curves as CSV: deflection_mm,measured_N,deviation_N,computed_N,error,elastic_N; of the way
 * back without the last. Written atomically over an existing file. */
WB_MUST_CHECK enum wb_status
wb_validate_three_point_write_csv(const struct wb_validate_three_point *result, bool unloading,
                                  const char *path);

/* Appends its scores, a row each: analysis/validation/validate_tables.h. */
void wb_validate_three_point_put_scores(struct wb_text *text,
                                        const struct wb_validate_three_point *result);

/* Sets its numbers as members of an object. */
void wb_validate_three_point_put_json(struct wb_json *item,
                                      const struct wb_validate_three_point *result);

void wb_validate_three_point_release(struct wb_validate_three_point *result); /* accepts zeroed */

#endif
