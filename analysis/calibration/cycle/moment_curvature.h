/* Measured bending moment over curvature: from the shape of the wire and the tension alone, without
 * a law of its material.
 *
 * The places of the markers give the curvature; tension, counterweight and weight give the bending
 * moment at the same place. Each few millimetres of deflection of the first cycle give a curvature
 * and a moment at the clamp, and on the first loading also some along the wire. The cameras'
 * uncertainty of a curvature is about 0.1 /m, so points are meaningful from an eighth of the
 * largest curvature on; below, they only show a band of scatter. A law is compared with the points
 * and never fitted to them.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_MOMENT_CURVATURE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_MOMENT_CURVATURE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

struct wb_moment_point {
    double curvature; /* 1/m, relative to the natural one */
    double moment;    /* N m */
    double deviation; /* 1/m: standard error of the curvature; that of the moment is small */
    double s;         /* m, arc length of the place */
    bool is_unloading;
    bool is_band; /* curvature too small: shows scatter only */
};

struct wb_moment_cloud {
    int n;
    struct wb_moment_point
        *points;    /* (n), owned; first those of the loading, in the order of the test */
    double largest; /* 1/m: largest of the clamp on the loading */
};

/* Takes the points of the first cycle. `specimen`: bow and level of a fit; NULL: the natural shape
 * of the dataset. WB_ERR_DATA without shapes of at least three inner markers, or for a test whose
 * tip is not raised; `why` receives the reason; NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_moment_curvature_take(struct wb_moment_cloud *cloud,
                                                      const struct wb_dataset *dataset,
                                                      const struct wb_cycle_specimen *specimen,
                                                      struct wb_reason *why);
void wb_moment_curvature_release(struct wb_moment_cloud *cloud); /* accepts a zeroed one */

enum {
    WB_MOMENT_STRETCHES = 6
};

/* Points of a wire's specimens, averaged over a range of curvature, against a law. */
struct wb_moment_stretch {
    double first, last; /* 1/m */
    int n;              /* specimens with points in the range */
    double difference;  /* mean of (law's moment - measured) / measured, 1 */
    double deviation;   /* its standard error, 1 */
};

struct wb_moment_comparison {
    int n;
    struct wb_moment_stretch stretches[WB_MOMENT_STRETCHES]; /* ascending */
    bool is_apart;      /* the two differ by more than 3 standard deviations in some range; then: */
    double first, last; /* 1/m: curvature of this range */
    double difference;  /* 1: largest relative difference there */
    double in_deviations; /* this difference in standard deviations */
};

/* Compares the first loadings of n specimens with a law on a solid circle of that diameter, in
 * ranges of curvature in which at least half the specimens have two points. Without such a range,
 * no comparison is possible. The points of a specimen share the errors of its cameras and of its
 * bow, so the uncertainty of their average is that of one point; the scatter of several specimens
 * is included. A difference counts only if two neighbouring ranges agree. */
WB_MUST_CHECK enum wb_status
wb_moment_curvature_compare(const struct wb_moment_cloud *const *clouds, int n,
                            const struct wb_law *law, double diameter,
                            struct wb_moment_comparison *comparison);

/* Keys of a point. */
extern const struct wb_keys wb_moment_curvature_keys;

/* Appends each point to a JSON array: {curvature_1_m, curvature_deviation_1_m, moment_N_mm,
 * branch, s_mm, band}. */
void wb_moment_curvature_put(struct wb_json *array, const struct wb_moment_cloud *cloud);

#endif
