/* Static equilibrium of a rod (fe/rod/rod.h) under tip loads and its weight: Newton's method in
 * automatic increments. The counterpart of fe/solid/solid.h.
 *
 * Loads at the tip: a dead force and a dead moment (about fixed axes), a follower force in the
 * frame of the tip's section, and a tension that prescribes the deflection. The tension is a
 * vertical force or acts along a strand. The strand's upper end stays at x = strand_x, z = 0 and
 * moves up with the tip, so that the strand is vertical when the tip is at x = strand_x:
 *
 *     direction of the tension (p, sqrt(1 - p^2 - q^2), q), p = (strand_x - x) / S, q = -z / S.
 *
 * A strand only pulls: if its tension would be negative it is slack and the tip is free under the
 * other loads.
 *
 * Newton's method may jump over a limit load or a buckling load to an unstable equilibrium. An
 * increment that ends in one is reverted and halved, and a move ends before such a critical point
 * as not converged. See docs/theory.md, "Critical points".
 */
#ifndef WB_FE_ROD_ROD_SOLVER_H
#define WB_FE_ROD_ROD_SOLVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/rod/rod.h"

struct wb_rod_solver_model {
    struct wb_rod *rod;   /* borrowed, just created or reset; must outlive the solver */
    double length;        /* m: length of the rod, to compare moments with forces */
    double strand_length; /* m; 0: a vertical force prescribes the deflection */
    double strand_x;      /* m */
    double most_rotation; /* largest rotation of any section in an increment, rad; 0: 0.25 */
};

/* All loads. */
struct wb_rod_loads {
    double weight; /* factor on the distributed load */
    struct wb_tip_loads tip;
    double tension; /* N: of the strand, or of the vertical force that prescribes the deflection */
};

enum wb_rod_control {
    WB_ROD_LOADS,     /* all loads move to the target, including the tension */
    WB_ROD_DEFLECTION /* the tip's y moves to `deflection`, the other loads to the target; the
                         tension is unknown */
};

enum wb_rod_end {
    WB_ROD_CONVERGED,
    WB_ROD_NOT_CONVERGED,
    WB_ROD_STOPPED /* the observer returned false */
};

struct wb_rod_move {
    enum wb_rod_control control;
    struct wb_rod_loads target; /* the tension is ignored for WB_ROD_DEFLECTION */
    double deflection;          /* m */
    /* Called after each increment; may be NULL; return false to stop. */
    bool (*observer)(void *context, double fraction, int iterations);
    void *context;
};

struct wb_rod_result {
    enum wb_rod_end end;
    double fraction; /* of the move that was completed */
    int increments, iterations, cutbacks;
    double residual;   /* relative, of the last iteration */
    char problem[240]; /* why the move did not converge; "" otherwise */
};

struct wb_rod_solver; /* opaque */

/* On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_rod_solver_create(struct wb_rod_solver **out,
                                                  const struct wb_rod_solver_model *model);
void wb_rod_solver_destroy(struct wb_rod_solver *solver); /* accepts NULL */

/* Returns to the virgin rod without loads. */
void wb_rod_solver_reset(struct wb_rod_solver *solver);

/* Moves from the current equilibrium towards the target. Not converging is a result: the state is
 * then that of the last converged increment. Allocates nothing. */
WB_MUST_CHECK enum wb_status wb_rod_solver_move(struct wb_rod_solver *solver,
                                                const struct wb_rod_move *move,
                                                struct wb_rod_result *result);

/* Loads of the last equilibrium. */
const struct wb_rod_loads *wb_rod_solver_loads(const struct wb_rod_solver *solver);
bool wb_rod_solver_is_slack(const struct wb_rod_solver *solver);
/* y of the tip, m; while the strand is slack, the prescribed y. */
double wb_rod_solver_deflection(const struct wb_rod_solver *solver);
/* Vertical component of the tension, N. */
double wb_rod_solver_vertical_force(const struct wb_rod_solver *solver);

#endif
