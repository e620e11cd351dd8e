/* Quasi-static equilibrium of a harness (fe/harness/harness.h): holds, loads and weight move to
 * targets in automatic increments, each solved by Newton's method. The counterpart of
 * fe/rod/rod_solver.h.
 *
 * An equilibrium is accepted only if it is stable. Where a stable path ends, the harness snaps: it
 * moves against a viscous drag, at fixed holds and loads, until it rests at a stable equilibrium. A
 * release is such a motion from the beginning. A drag acts on the length of wire; its steps in time
 * are so short that the stiffness together with the drag has no negative eigenvalue, and grow until
 * the drag is without effect. The last state is solved without drag.
 */
#ifndef WB_FE_HARNESS_HARNESS_SOLVER_H
#define WB_FE_HARNESS_HARNESS_SOLVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/harness/harness.h"

struct wb_harness_solver_model {
    struct wb_harness *harness; /* borrowed, just created or reset; must outlive the solver */
    double most_rotation;       /* largest rotation of a joint in an increment, rad; 0: 0.1 */
};

/* Where a held joint goes; of the rotation, what its hold needs. */
struct wb_harness_aim {
    int joint;
    struct wb_rod_node target;
};

/* Dead force and moment of a joint, N, N m. */
struct wb_harness_load {
    int joint;
    double load[6];
};

/* An increment at whose end the harness left its path. */
struct wb_harness_snap {
    double fraction; /* of the move */
    double distance; /* largest motion of a joint, m */
    int joint;       /* the one that moved farthest */
};

enum {
    WB_HARNESS_MOST_SNAPS = 8 /* recorded in a move */
};

struct wb_harness_move {
    int n_aims;
    const struct wb_harness_aim *aims;
    int n_loads;
    const struct wb_harness_load *loads;
    double weight; /* factor on the weight at the end */
    /* Called after each increment and each step of a snap; may be NULL; return false to stop. */
    bool (*observer)(void *context, double fraction);
    void *context;
};

enum wb_harness_end {
    WB_HARNESS_CONVERGED,
    WB_HARNESS_NOT_CONVERGED,
    WB_HARNESS_STOPPED /* the observer returned false */
};

struct wb_harness_result {
    enum wb_harness_end end;
    double fraction; /* of the move that was completed */
    int increments, iterations, cutbacks;
    int n_snaps;
    struct wb_harness_snap snaps[WB_HARNESS_MOST_SNAPS];
    double residual;     /* relative, of the last iteration */
    int worst_joint;     /* where it was */
    const char *problem; /* why the move did not converge; NULL otherwise */
};

struct wb_harness_solver; /* opaque */

/* On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_harness_solver_create(struct wb_harness_solver **out,
                                                      const struct wb_harness_solver_model *model);
void wb_harness_solver_destroy(struct wb_harness_solver *solver); /* accepts NULL */

/* Moves from the current equilibrium to the targets. Not converging is a result: the state is then
 * that of the last converged increment. Allocates nothing. */
void wb_harness_solver_move(struct wb_harness_solver *solver, const struct wb_harness_move *move,
                            struct wb_harness_result *result);

/* Lets the harness come to rest with its current holds and loads, under `weight` times its weight,
 * after a hold was let go or the weight has changed at once. */
void wb_harness_solver_settle(struct wb_harness_solver *solver, double weight,
                              bool (*observer)(void *context, double fraction), void *context,
                              struct wb_harness_result *result);

/* wb_harness_save() and its counterparts, with the state of the solver. */
size_t wb_harness_solver_state_size(const struct wb_harness_solver *solver);
void wb_harness_solver_save(const struct wb_harness_solver *solver, void *state);
void wb_harness_solver_restore(struct wb_harness_solver *solver, const void *state);

#endif
