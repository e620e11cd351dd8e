/* A run: one computation of a wire model, by the 3D solid (fe/trial/wire3d.h) or by the 1D rod
 * (fe/trial/wire1d.h). It gives rows along the model's loading steps, the deformed axis at each
 * row, and how it ended.
 */
#ifndef WB_FE_TRIAL_WIRE_RUN_H
#define WB_FE_TRIAL_WIRE_RUN_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/model/wire_model.h"

struct wb_wire_row {
    int step;                   /* index into the model's steps */
    double fraction;            /* of the step, (0, 1]; the first row of all is at 0 */
    int cycle;                  /* from 1; a new one begins with each loading after an unloading */
    enum wb_phase phase;        /* slack: the strand carries nothing */
    struct wb_tip_loads loads;  /* that act */
    double tip[3];              /* m, of the axis' end */
    double tangent[3];          /* unit vector along the wire at the tip */
    double tip_angle;           /* rad, atan2 of the tangent's y and x, continued over the rows so
                                   that it has no jump where a wire curls past pi */
    double tension;             /* N: strand's tension or vertical force that makes the deflection;
                                   without either the vertical part of all tip forces */
    double vertical_force;      /* N: vertical part of the tension */
    double force;               /* N: the dataset's `force`. Of a follower test the follower force;
                                   else the vertical force, less that of the first row where the
                                   first step is a deflection */
    int increments, iterations; /* spent since the row before */
};

struct wb_wire_run {
    int n_rows, capacity;
    struct wb_wire_row *rows; /* (n_rows), owned; only those reached */
    int n_shape;
    double *shape_s;                      /* (n_shape) m, reference arc lengths, owned */
    double (*shape)[3];                   /* (n_rows x n_shape), m, owned */
    bool converged;                       /* false: they end early */
    bool stopped;                         /* by the observer */
    char problem[320];                    /* where and why it did not converge; "" otherwise */
    int increments, iterations, cutbacks; /* in all */
    int n_elements, n_unknowns;
    double zero_force; /* N: subtracted from `force` */
    double tip_angle;  /* rad: where the tip's tangent points to, followed through all increments */
};

/* Functions of the caller that a run calls; each may be NULL. */
struct wb_wire_observer {
    /* After every converged increment: step, share of it done, iterations of the increment, share
     * of all steps done (for the time left). False stops the run. */
    bool (*increment)(void *context, const struct wb_wire_run *run, int step, double fraction,
                      int iterations, double done);
    /* After every row; `last` in its step. The solver stands at that state. */
    enum wb_status (*row)(void *context, const struct wb_wire_run *run, bool last);
    void *context;
};

/* Where a run stands, kept by wire1d.c and wire3d.c. */
struct wb_wire_progress {
    struct wb_wire_run *run;
    const struct wb_wire_model *model;
    const struct wb_wire_observer *observer; /* may be NULL */
    int step, row;                           /* under way; row from 1, 0 under the weight alone */
    int increments, iterations;              /* since the row before */
    enum wb_status status;                   /* of the observer */
};

/* The target of a row. */
struct wb_wire_target {
    struct wb_tip_loads tip;
    double tension;    /* N: of the strand, or the vertical force that makes a deflection */
    bool is_held;      /* the tip's y goes to `deflection`, and the tension follows */
    double deflection; /* m */
};

enum {
    WB_WIRE_RUN_SPARE = 400 /* rows that may come on top of the planned ones, on a path that is
                               followed past a limit point */
};

/* Takes memory for a model's rows, spare ones, and n_shape equally spaced positions from 0 to its
 * length (none, or 2 to 1000). */
WB_MUST_CHECK enum wb_status wb_wire_run_init(struct wb_wire_run *run,
                                              const struct wb_wire_model *model, int n_shape);
void wb_wire_run_release(struct wb_wire_run *run); /* accepts a zeroed one */

/* Rows of a run that is not cut short: one at the start and those of every step. */
int wb_wire_run_planned_rows(const struct wb_wire_model *model);

/* What is to be reached at `share` of the way of `step`, which began in the state `start`. */
struct wb_wire_target wb_wire_run_target(const struct wb_wire_step *step,
                                         const struct wb_wire_target *start, double share);

/* Counts a converged increment, which ended at the share `fraction` of the row under way with the
 * tip's tangent `tangent`, and calls the observer. False: the run is to stop. */
bool wb_wire_run_tell(struct wb_wire_progress *progress, const double tangent[3], double fraction,
                      int iterations);

/* Sets a row's tension and vertical force: of a model with a deflection as they are given, of
 * others the vertical part of the row's loads. `frame`: the tip's axes, rows. */
void wb_wire_run_set_forces(struct wb_wire_row *row, const struct wb_wire_model *model,
                            double tension, double vertical, const double frame[3][3]);

/* Appends a row that has fraction, loads, tip, tangent and forces, and completes it: step, cycle,
 * phase, angle, force. `slack`: the strand carries nothing. `shape` is (n_shape x 3). Calls the
 * observer and keeps its status. */
void wb_wire_run_end_row(struct wb_wire_progress *progress, struct wb_wire_row *row, bool slack,
                         const double (*shape)[3]);

#endif
