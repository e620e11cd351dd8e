/* A dataset of a comparison: read, checked against its model, with its data at the end of the
 * history; and distances between the axes of two of them.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_RUN_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_RUN_H

#include "analysis/dataset/fields.h"
#include "analysis/report/wires/wires.h"
#include "analysis/report/wires/wires_rod.h"

/* A dataset, and its data on the simulation; numbers are NaN where it has none. */
struct wb_wires_run {
    struct wb_simulation_result simulation;
    double elements, unknowns, iterations, memory_MB;
    double slip, slip_limit, opening; /* m, of an interface with friction */
    struct wb_fields fields;          /* of a usable one, as all that follows */
    double force, tip_angle;          /* N, rad: at its end */
    double tip[3];                    /* m */
    int n_shape;
    double *s;           /* (n_shape) m, owned */
    double (*shape)[3];  /* (n_shape) m, owned */
    int n_loading;       /* rows of the last step; 0 when its forces are not known */
    double *loading;     /* (n_loading) N, the follower force, owned */
    double (*loaded)[3]; /* (n_loading) m, the tip under it, owned */
};

/* Reads the dataset of a case and solver into a zeroed run. An error is kept in the run.
 */
void wb_wires_run_load(struct wb_wires_run *run, const struct wb_wires_case *item,
                       enum wb_wires_solver solver);
void wb_wires_run_release(struct wb_wires_run *run); /* accepts a zeroed one */

/* A field of a run (NULL: there is none) as of wb_fields_find(). */
const struct wb_field *wb_wires_field(const struct wb_wires_run *run, const char *state, double x);

/* A point of a run's axis at an arc length within it, m; smooth between those that it holds. */
void wb_wires_axis_point(const struct wb_wires_run *run, double s, double point[3]);

/* Distance of a point from that of a run's axis at an arc length, m. */
double wb_wires_distance_at(const struct wb_wires_run *run, double s, const double point[3]);

/* Distance of a run's tip from another's under the same follower force of its last step, m, at a
 * row of `run`'s loading; NaN where the other has none. */
double wb_wires_tip_distance(const struct wb_wires_run *run, int row,
                             const struct wb_wires_run *other);

/* The largest of them over all rows; NaN without any. */
double wb_wires_effect(const struct wb_wires_run *run, const struct wb_wires_run *other);

/* Largest distance of two axes at the same arc length, m, over the second one's points. */
double wb_wires_distance(const struct wb_wires_run *run, const struct wb_wires_run *other);
double wb_wires_rod_distance(const struct wb_wires_run *run, const struct wb_wires_rod *rod);

#endif
