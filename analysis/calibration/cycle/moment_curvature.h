/* Bending moment over curvature as measured: from the shape of the wire and the tension alone,
 * without any law of its material.
 *
 * The markers' places say how the wire is curved, tension, counterweight and weight say which
 * moment bends it there. Each few millimetres of deflection of the first cycle give a curvature and
 * a moment at the clamp, and on the first loading some along the wire too. Cameras see a curvature
 * to about a tenth of 1/m, so the points mean something from an eighth of the largest curvature on;
 * below they are a band. A law is compared with them and never fitted to them.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_MOMENT_CURVATURE_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_MOMENT_CURVATURE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_model.h"
#include "analysis/dataset/dataset.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

struct wb_moment_point {
    double curvature; /* 1/m, beyond the natural one */
    double moment;    /* N m */
    double deviation; /* 1/m: standard error of the curvature; that of the moment is small */
    double s;         /* m, arc length of the place */
    bool is_unloading;
    bool is_band; /* too little bent: shows scatter, not the wire */
};

struct wb_moment_cloud {
    int n;
    struct wb_moment_point *points; /* (n), owned; the loading's first, as they were measured */
    double largest;                 /* 1/m: of the clamp on the loading */
    double place_rms;               /* m, of the markers about the fitted shapes */
};

struct wb_moment_settings {
    double step;           /* m of deflection between shapes; 0: 3 mm */
    double smallest_share; /* of the largest curvature: below are bands; 0: 0.12 */
    double bow_deviation;  /* m, of the natural tip offset; 0: the dataset's, else 0.3 mm */
};

/* Takes the cloud of the first cycle. `specimen` is what a fit found of its bow and level; NULL:
 * the dataset's natural shape. `settings` NULL: defaults. WB_ERR_DATA where there are no shapes of
 * at least three inner markers, or for a test whose tip is not raised; `why` receives the reason;
 * NULL: it is logged. */
WB_MUST_CHECK enum wb_status wb_moment_curvature_take(struct wb_moment_cloud *cloud,
                                                      const struct wb_dataset *dataset,
                                                      const struct wb_cycle_specimen *specimen,
                                                      const struct wb_moment_settings *settings,
                                                      struct wb_reason *why);
void wb_moment_curvature_release(struct wb_moment_cloud *cloud); /* accepts a zeroed one */

enum {
    WB_MOMENT_STRETCHES = 6
};

/* The clouds of a wire's specimens, averaged over a stretch of curvature, against a law. */
struct wb_moment_stretch {
    double first, last; /* 1/m */
    int n;              /* specimens with points in it */
    double difference;  /* mean of (law's moment - measured) / measured, 1 */
    double deviation;   /* its standard error, 1 */
};

struct wb_moment_comparison {
    int n;
    struct wb_moment_stretch stretches[WB_MOMENT_STRETCHES]; /* ascending */
    bool is_apart;        /* somewhere the two part by more than 3 standard deviations; then: */
    double first, last;   /* 1/m: where, */
    double difference;    /* 1: the largest difference there, */
    double in_deviations; /* 1: and how many standard deviations it is */
};

/* Compares the first loadings of n clouds with a law on a solid circle of that diameter, in
 * stretches of curvature in which at least half the specimens have two points; a comparison without
 * stretches says nothing. A specimen's points share what their cameras and bow are off by, so that
 * an average over them is not taken to be better than one of them; the scatter of several specimens
 * counts too. Two neighbouring stretches must agree before they warn. */
WB_MUST_CHECK enum wb_status
wb_moment_curvature_compare(const struct wb_moment_cloud *const *clouds, int n,
                            const struct wb_law *law, double diameter,
                            struct wb_moment_comparison *comparison);

/* Appends each point to a JSON array: {curvature_1_m, curvature_deviation_1_m, moment_N_mm,
 * branch, s_mm, band}. */
void wb_moment_curvature_put(struct wb_json *array, const struct wb_moment_cloud *cloud);

#endif
