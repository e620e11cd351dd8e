/* Model of a three-point bending test with any law: force over the travel beyond the first contact,
 * for the loading and, on request, the unloading. */
#ifndef WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_MODEL_H
#define WB_ANALYSIS_CALIBRATION_THREE_POINT_THREE_POINT_MODEL_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/status.h"
#include "fe/material/law.h"
#include "fe/trial/three_point_bending.h"

struct wb_three_point_model; /* opaque */

/* The parameters of the bench besides the span and rollers of the test. */
struct wb_three_point_bench {
    double friction, nose_radius, compliance; /* 1, m, m/N */
};

struct wb_three_point_run {
    bool reached;                        /* the requested end; otherwise `end` is the reason, */
    enum wb_three_point_bending_end end; /* and only travels below `travel` were computed */
    double travel;                       /* m, largest */
    double largest_curvature;            /* 1/m, at midspan, in excess of the natural one */
    double wrapped;                      /* largest wrap angle of the nose, rad */
    double residual; /* m of travel where the nose leaves the wire; NaN: no unloading */
};

/* Creates a model for tests with this span, rollers and diameter, and for laws of one kind: plain,
 * or overlays of at most as many parts as `law` has. `n_elements` of half the wire. On failure *out
 * is NULL. */
WB_MUST_CHECK enum wb_status wb_three_point_model_create(struct wb_three_point_model **out,
                                                         const struct wb_test_info *info,
                                                         const struct wb_three_point_bench *bench,
                                                         const struct wb_law *law, int n_elements);
void wb_three_point_model_destroy(struct wb_three_point_model *model); /* accepts NULL */

/* Natural curvature (1/m) of a uniformly bent wire whose middle is `bow` (m) below the line between
 * its points on the rollers: positive is hollow upwards. */
double wb_three_point_model_curvature(const struct wb_test_info *info, double bow);

/* Computes the virgin wire with this uniform natural curvature up to a deflection (m) and, on
 * request, the unloading until the nose leaves it. Not to reach the end is a result. */
WB_MUST_CHECK enum wb_status wb_three_point_model_run(struct wb_three_point_model *model,
                                                      const struct wb_law *law,
                                                      double natural_curvature, double deflection,
                                                      bool with_unloading,
                                                      struct wb_three_point_run *run);

/* Force (N) of the last run, which must have reached its end, at a travel beyond the first contact
 * (m); linear extrapolation beyond the end of the loading. */
double wb_three_point_model_force(const struct wb_three_point_model *model, double travel,
                                  bool is_unloading);

/* Derivative of the force with respect to the travel, N/m. */
double wb_three_point_model_stiffness(const struct wb_three_point_model *model, double travel,
                                      bool is_unloading);

#endif
