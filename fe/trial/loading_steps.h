/* A complete cantilever test: equal loading steps from zero to the maximum of the control and back,
 * in cycles.
 *
 * Rows: the first is at zero, then `steps` rows up to the maximum, and, with cycles, `steps` rows
 * down to zero; every further cycle adds as many again. Rows with a slack strand have the phase
 * WB_PHASE_SLACK and are excluded from fits; if unloading ends with such rows, the next loading
 * begins with them.
 *
 * The force is zeroed as on the bench: vertical component of the tension minus its value at zero
 * deflection of the first loading. A follower force is not zeroed.
 */
#ifndef WB_FE_TRIAL_LOADING_STEPS_H
#define WB_FE_TRIAL_LOADING_STEPS_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/trial/cantilever.h"

struct wb_loading_steps_plan {
    enum wb_cantilever_control control; /* WB_CONTROL_DEFLECTION in the usual test */
    double maximum;                     /* in the control's unit; may be negative */
    int steps;                          /* equal steps from zero to the maximum, at least 1 */
    int cycles;                         /* 0: one loading without unloading */
    int n_shape;                        /* positions recorded with each row; 0: none */
    const double *shape_s;              /* (n_shape) their reference arc lengths, m; borrowed */
    bool (*stop)(void *context); /* called before each row, true stops the test; may be NULL */
    void *stop_context;
};

struct wb_loading_steps_row {
    int cycle; /* from 1 */
    enum wb_phase phase;
    double force; /* zeroed vertical force, or the follower force, N */
    struct wb_cantilever_point point;
};

struct wb_loading_steps {
    int n_rows, capacity;
    struct wb_loading_steps_row *rows; /* (n_rows), owned; only completed rows */
    int n_shape;
    double *shape_x, *shape_y; /* (n_rows x n_shape), m, owned; NULL without shape */
    double zero_force;         /* vertical force that was subtracted, N; 0 for a follower force */
    bool converged;            /* false: the test stopped early, at `end` */
    struct wb_cantilever_point end; /* result of the last move, converged or not */
    bool stopped;                   /* by plan->stop */
};

/* Number of rows of a complete test. */
int wb_loading_steps_planned_rows(const struct wb_loading_steps_plan *plan);

/* Allocates memory for a plan. wb_loading_steps_release() accepts a zeroed struct. */
WB_MUST_CHECK enum wb_status wb_loading_steps_init(struct wb_loading_steps *loading,
                                                   const struct wb_loading_steps_plan *plan);
void wb_loading_steps_release(struct wb_loading_steps *loading);

/* Runs the plan from the cantilever's current state (usually just created or reset). `loading` must
 * have been allocated for at least as many rows. Not converging is a result, not an error.
 * Allocates nothing. */
WB_MUST_CHECK enum wb_status wb_loading_steps_run(struct wb_loading_steps *loading,
                                                  const struct wb_loading_steps_plan *plan,
                                                  struct wb_cantilever *cantilever);

#endif
