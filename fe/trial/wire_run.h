/* A run: one computation of a wire model, by the 3D solid (fe/trial/wire3d.h) or by the 1D rod
 * (fe/trial/wire1d.h). It contains rows along the model's loading steps, the deformed axis at each
 * row, and the reason for an early end.
 */
#ifndef WB_FE_TRIAL_WIRE_RUN_H
#define WB_FE_TRIAL_WIRE_RUN_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/model/wire_model.h"

struct wb_wire_row {
    int step;                  /* index into the model's steps */
    double fraction;           /* of the step, (0, 1]; the very first row is at 0 */
    int cycle;                 /* from 1; each loading after an unloading starts a new one */
    enum wb_phase phase;       /* slack: the strand carries no force */
    struct wb_tip_loads loads; /* that act */
    double tip[3];             /* position of the axis' end, m */
    double tangent[3];         /* unit vector along the wire at the tip */
    double tip_angle; /* atan2 of the tangent's y and x, rad, continuous over the rows even if the
                         wire curls past pi */
    double tension;   /* strand tension, or the vertical force that prescribes the deflection;
                         otherwise the vertical component of all tip forces, N */
    double vertical_force; /* vertical component of the tension, N */
    double force; /* the dataset's `force`, N: the follower force in a follower test; otherwise the
                     vertical force, minus that of the first row if the first step prescribes a
                     deflection */
    int increments, iterations; /* since the previous row */
};

struct wb_wire_run {
    int n_rows, capacity;
    struct wb_wire_row *rows; /* (n_rows), owned; only completed rows */
    int n_shape;
    double *shape_s;                      /* (n_shape) m, reference arc lengths, owned */
    double (*shape)[3];                   /* (n_rows x n_shape), m, owned */
    double (*axis)[3];                    /* (n_shape) m, workspace: shape of the next row */
    bool converged;                       /* false: the rows end early */
    bool stopped;                         /* by the observer */
    char problem[320];                    /* where and why it did not converge; "" otherwise */
    int increments, iterations, cutbacks; /* in all */
    int n_elements, n_unknowns;
    double zero_force; /* N: subtracted from `force` */
    double tip_angle;  /* direction of the tip's tangent, rad, tracked through all increments */
};

/* Callbacks of a run; each may be NULL. */
struct wb_wire_observer {
    /* After each converged increment: step, fraction of the step, iterations of the increment,
     * fraction of all steps (to estimate the remaining time). False stops the run. */
    bool (*increment)(void *context, const struct wb_wire_run *run, int step, double fraction,
                      int iterations, double done);
    /* After each row; `last`: the last row of its step. The solver is in the row's state. */
    enum wb_status (*row)(void *context, const struct wb_wire_run *run, bool last);
    void *context;
};

/* Progress of a run, maintained by wire1d.c and wire3d.c. */
struct wb_wire_progress {
    struct wb_wire_run *run;
    const struct wb_wire_model *model;
    const struct wb_wire_observer *observer; /* may be NULL */
    int step, row;                           /* current; row from 1, 0 under the weight alone */
    int increments, iterations;              /* since the previous row */
    enum wb_status status;                   /* of the observer */
};

/* The target of a row. */
struct wb_wire_target {
    struct wb_tip_loads tip;
    double tension; /* of the strand, or of the vertical force that prescribes the deflection, N */
    bool is_held;   /* the tip's y moves to `deflection`; the tension is unknown */
    double deflection; /* m */
};

enum {
    WB_WIRE_RUN_SPARE = 400 /* maximum number of rows in addition to the planned ones, on paths past
                               a limit point */
};

/* Allocates memory for a model's planned and spare rows, and for n_shape equally spaced positions
 * from 0 to its length (none, or 2 to 1000). */
WB_MUST_CHECK enum wb_status wb_wire_run_init(struct wb_wire_run *run,
                                              const struct wb_wire_model *model, int n_shape);
void wb_wire_run_release(struct wb_wire_run *run); /* accepts a zeroed one */

/* Number of rows of a complete run: one at the start and those of each step. */
int wb_wire_run_planned_rows(const struct wb_wire_model *model);

/* The target at `share` of `step`, which began in the state `start`. */
struct wb_wire_target wb_wire_run_target(const struct wb_wire_step *step,
                                         const struct wb_wire_target *start, double share);

/* Counts a converged increment, at `fraction` of the current row with the tip's tangent `tangent`,
 * and calls the observer. Returns false if the run should stop. */
bool wb_wire_run_end_increment(struct wb_wire_progress *progress, const double tangent[3],
                               double fraction, int iterations);

/* Sets a row's tension and vertical force. Models that prescribe a deflection use the given values;
 * others use the vertical component of the row's loads. `frame`: the tip's axes, as rows. */
void wb_wire_run_set_forces(struct wb_wire_row *row, const struct wb_wire_model *model,
                            double tension, double vertical, const double frame[3][3]);

/* Appends a row that has fraction, loads, tip, tangent and forces, and fills in step, cycle, phase,
 * angle, force. `slack`: the strand carries no force. The shape is in run->axis. Calls the observer
 * and keeps its status. */
void wb_wire_run_end_row(struct wb_wire_progress *progress, struct wb_wire_row *row, bool slack);

#endif
