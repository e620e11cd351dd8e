/* Computes the first cycle of a bending test: the 1D beam with any law on the test's strand, with
 * weights, from the virgin wire on its rest up to the turn and back, at the deflections of struct
 * wb_cycle_data.
 *
 * A law with Maxwell elements relaxes over the times of the points and of the dwell.
 *
 * The tension is that of the strand, weights included. The caller gives the natural shape of the
 * specimen, and the level: the error of the measured deflections.
 */
#ifndef WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_MODEL_H
#define WB_ANALYSIS_CALIBRATION_CYCLE_CYCLE_MODEL_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_data.h"
#include "base/status.h"
#include "fe/material/law.h"

struct wb_cycle_model; /* opaque */

/* The natural angle at u = s/L is bow_angle u + uneven_angle (2 u - 3 u^2). The first term has
 * constant curvature. The second has its largest curvature at the clamp and the opposite sign at
 * the tip; for small slopes it does not move the tip, so the bow is bow_angle L/2. */
struct wb_cycle_specimen {
    double bow_angle;    /* rad */
    double level;        /* m */
    double uneven_angle; /* rad */
};

/* Writes the natural shape into `info`. */
void wb_cycle_model_bend(const struct wb_cycle_specimen *specimen, struct wb_test_info *info);

struct wb_cycle_run {
    bool reached;           /* all points were computed; else the other members are NaN */
    double first_curvature; /* 1/m: of the clamp at the first point, relative to the natural one */
    double clamp_curvature; /* 1/m: largest of all points */
    double turn_change; /* 1/m: its change from the turn to the first point of the unloading; NaN
                           without unloading */
};

struct wb_cycle_model_settings {
    int n_elements, n_fibres; /* 0: 50, 20 */
    int n_neighbours;         /* most neighbours of a run */
};

/* A law and a specimen close to those of a run, and the results of the same cycle with them, as in
 * wb_cycle_model_run(). */
struct wb_cycle_neighbour {
    struct wb_law law;
    struct wb_cycle_specimen specimen;
    double *tension, *distance;
    double held[WB_CYCLE_MOST_HELD]; /* N, see wb_cycle_model_held() */
};

/* Creates the model of one test for laws of one kind: a single law, or overlays of at most as many
 * parts as `law` has. `data` is borrowed. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_cycle_model_create(struct wb_cycle_model **out,
                                                   const struct wb_cycle_data *data,
                                                   const struct wb_law *law,
                                                   const struct wb_cycle_model_settings *settings);
void wb_cycle_model_destroy(struct wb_cycle_model *model); /* accepts NULL */

/* Deflection of the tip before and after a cycle, m: that of its rest, or zero without one. */
double wb_cycle_model_rest(const struct wb_test_info *info);

/* Tension in the dwell of the last run (data->n_held), N; for a law without Maxwell elements that
 * at the turn. */
const double *wb_cycle_model_held(const struct wb_cycle_model *model);

/* Computes the whole cycle: tension (data->n_points, N), and the distance of each measured place
 * above the axis at its arc length (data->n_places, m; NULL: not wanted). A cycle that the beam
 * cannot complete returns WB_OK with run->reached false. */
WB_MUST_CHECK enum wb_status wb_cycle_model_run(struct wb_cycle_model *model,
                                                const struct wb_law *law,
                                                const struct wb_cycle_specimen *specimen,
                                                double *tension, double *distance,
                                                struct wb_cycle_run *run);

/* The same, and the cycles of `n` neighbours, to second order in their differences:
 * wb_cantilever_lead(). */
WB_MUST_CHECK enum wb_status wb_cycle_model_run_beside(struct wb_cycle_model *model,
                                                       const struct wb_law *law,
                                                       const struct wb_cycle_specimen *specimen,
                                                       double *tension, double *distance, int n,
                                                       struct wb_cycle_neighbour *neighbours,
                                                       struct wb_cycle_run *run);

#endif
