/* The first cycle of a bending test, computed: the 1D beam of any law on the test's strand, with
 * weights, from the virgin wire on its rest up to the turn and back, at the deflections of struct
 * wb_cycle_data.
 *
 * A law with Maxwell elements relaxes over the times of the points, and of the dwell.
 *
 * The tension is the strand's, weights included. Two things of a specimen are the caller's: its
 * shape by nature, and the level, by which measured deflections are too large.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_MODEL_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_MODEL_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

struct wb_cycle_model; /* opaque */

/* The natural angle at u = s/L is bow_angle u + uneven_angle (2 u - 3 u^2): the first bends the
 * wire evenly, the second more at the clamp and the other way at the tip, which stays at its
 * height where slopes are small: the bow is bow_angle L/2. */
struct wb_cycle_specimen {
    double bow_angle;    /* rad */
    double level;        /* m */
    double uneven_angle; /* rad */
};

/* Writes its natural shape into `info`. */
void wb_cycle_model_bend(const struct wb_cycle_specimen *specimen, struct wb_test_info *info);

struct wb_cycle_run {
    bool reached;           /* all points: else the others are NaN */
    double first_curvature; /* 1/m: of the clamp at the first point, beyond the natural one, */
    double clamp_curvature; /* and the largest of all points */
    double turn_change;     /* change of that from the turn to the first point of the unloading; NaN
                               without one */
};

struct wb_cycle_model_settings {
    int n_elements, n_fibres; /* 0: 50, 20 */
    int n_neighbours;         /* most of a run */
};

/* A law and a specimen near those of a run, and what the same cycle makes of them; all as those of
 * wb_cycle_model_run(). */
struct wb_cycle_neighbour {
    struct wb_law law;
    struct wb_cycle_specimen specimen;
    double *tension, *distance;
    double held[WB_CYCLE_MOST_HELD]; /* N, see wb_cycle_model_held() */
};

/* For one test and laws of one kind: plain, or overlays of at most as many parts as `law` has.
 * `data` is borrowed. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_cycle_model_create(struct wb_cycle_model **out,
                                                   const struct wb_cycle_data *data,
                                                   const struct wb_law *law,
                                                   const struct wb_cycle_model_settings *settings);
void wb_cycle_model_destroy(struct wb_cycle_model *model); /* accepts NULL */

/* Deflection at which the tip lies before a cycle and comes back to after it, m: on its rest, or at
 * zero without one. */
double wb_cycle_model_rest(const struct wb_test_info *info);

/* Tension in the dwell of the last run, N, (data->n_held); of a law without Maxwell elements that
 * of the turn. */
const double *wb_cycle_model_held(const struct wb_cycle_model *model);

/* Computes the whole cycle: tension (data->n_points, N), and how far each measured place lies above
 * the axis at its arc length (data->n_places, m; NULL: not wanted). Not to reach all points is a
 * result. */
WB_MUST_CHECK enum wb_status wb_cycle_model_run(struct wb_cycle_model *model,
                                                const struct wb_law *law,
                                                const struct wb_cycle_specimen *specimen,
                                                double *tension, double *distance,
                                                struct wb_cycle_run *run);

/* The same, and beside it the cycles of `n` neighbours, to second order in what they differ by:
 * wb_cantilever_lead(). */
WB_MUST_CHECK enum wb_status wb_cycle_model_run_beside(struct wb_cycle_model *model,
                                                       const struct wb_law *law,
                                                       const struct wb_cycle_specimen *specimen,
                                                       double *tension, double *distance, int n,
                                                       struct wb_cycle_neighbour *neighbours,
                                                       struct wb_cycle_run *run);

#endif
