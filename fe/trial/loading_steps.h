/* A whole test of a cantilever: equal loading steps from zero to the largest value of the control
 * and back, in cycles.
 *
 * Rows: the first is at zero, then `steps` rows up to the maximum, and, with cycles, `steps` rows
 * down to zero; every further cycle adds as many again. Rows in which the strand is slack belong to
 * no fit and say so; after unloading ends in them the next loading begins with them.
 *
 * The force is zeroed as the bench zeroes it: vertical part of the tension less its value at zero
 * deflection on the first loading. Under a follower force it is that force's size, as it is.
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
    int cycles;                         /* 0: one loading, without unloading */
    int n_shape;                        /* positions recorded with every row; 0: none */
    const double *shape_s;              /* (n_shape) their reference arc lengths, m; borrowed */
    bool (*stop)(void *context);        /* asked before every row; NULL: never. True ends it */
    void *stop_context;
};

struct wb_loading_steps_row {
    int cycle; /* from 1 */
    enum wb_phase phase;
    double force; /* N, zeroed vertical force, or the follower force */
    struct wb_cantilever_point point;
};

struct wb_loading_steps {
    int n_rows, capacity;
    struct wb_loading_steps_row *rows; /* (n_rows), owned; only those that were reached */
    int n_shape;
    double *shape_x, *shape_y;      /* (n_rows x n_shape), m, owned; NULL without shape */
    double zero_force;              /* N: what was subtracted, vertical; 0 with a follower force */
    bool converged;                 /* false: the test ends early, at `end` */
    struct wb_cantilever_point end; /* of the last move: where it stopped short of its target */
    bool stopped;                   /* by plan->stop */
};

/* Rows of a plan that is not cut short. */
int wb_loading_steps_planned_rows(const struct wb_loading_steps_plan *plan);

/* Takes memory for a plan; wb_loading_steps_release() accepts zeroed ones. */
WB_MUST_CHECK enum wb_status wb_loading_steps_init(struct wb_loading_steps *loading,
                                                   const struct wb_loading_steps_plan *plan);
void wb_loading_steps_release(struct wb_loading_steps *loading);

/* Runs the plan from wherever the cantilever is (usually just created or reset). The rows must
 * have been made for a plan of as many rows. Not converging is a result, not an error. Allocates
 * nothing. */
WB_MUST_CHECK enum wb_status wb_loading_steps_run(struct wb_loading_steps *loading,
                                                  const struct wb_loading_steps_plan *plan,
                                                  struct wb_cantilever *cantilever);

#endif
