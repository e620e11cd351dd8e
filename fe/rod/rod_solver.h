/* Static equilibrium of a rod (fe/rod/rod.h) under tip loads and its weight: Newton's method in
 * automatic increments. The counterpart of fe/solid/solid.h.
 *
 * The tip's loads: a dead force and a dead moment (about fixed axes), a follower force in the frame
 * of the tip's section, and a tension that makes a deflection: a vertical force, or a strand whose
 * upper end stays at x = strand_x, z = 0, straight above the tip where that is at x = strand_x, and
 * moves up with it:
 *
 *     direction of the tension (p, sqrt(1 - p^2 - q^2), q), p = (strand_x - x) / S, q = -z / S.
 *
 * A strand only pulls: below zero tension it is slack and the tip is free under the other loads.
 *
 * Newton's method may jump over a limit load or a buckling load to an equilibrium that cannot
 * stand. An increment that leads to one is taken back and halved, and a move ends before such a
 * critical point, not converged. See docs/theory.md, "Critical points".
 */
#ifndef WB_FE_ROD_ROD_SOLVER_H
#define WB_FE_ROD_ROD_SOLVER_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/linear/trial.h"
#include "fe/rod/rod.h"

struct wb_rod_solver_model {
    struct wb_rod *rod;   /* borrowed, just created or reset; must outlive the solver */
    double length;        /* m: of the rod, to compare moments with forces */
    double strand_length; /* m; 0: a deflection is made by a vertical force */
    double strand_x;      /* m */
};

struct wb_rod_solver_settings {
    double force_tolerance;    /* residual over the largest internal force; 0: 1e-9 */
    double smallest_increment; /* share of a move; 0: 1e-5 */
    double largest_increment;  /* 0: 1 */
    double most_rotation;      /* rad by which an increment may turn any section; 0: 0.25 */
    int max_iterations;        /* 0: 25 */
};

/* All loads. */
struct wb_rod_loads {
    double weight; /* factor of the distributed load */
    struct wb_tip_loads tip;
    double tension; /* N: of the strand, or the vertical force that makes a deflection */
};

enum wb_rod_control {
    WB_ROD_LOADS,     /* loads go to the target, tension too */
    WB_ROD_DEFLECTION /* the other loads go to the target, the tip's y to `deflection`; the tension
                         follows */
};

enum wb_rod_end {
    WB_ROD_CONVERGED,
    WB_ROD_NOT_CONVERGED,
    WB_ROD_STOPPED /* by the observer */
};

struct wb_rod_move {
    enum wb_rod_control control;
    struct wb_rod_loads target; /* tension is ignored with WB_ROD_DEFLECTION */
    double deflection;          /* m */
    bool (*observer)(void *context, double fraction, int iterations); /* per increment; may be NULL.
                                                                         False stops */
    void *context;
};

struct wb_rod_result {
    enum wb_rod_end end;
    double fraction; /* of the move that was made */
    int increments, iterations, cutbacks;
    double residual;   /* relative, of the last iteration */
    char problem[240]; /* why it did not converge; "" otherwise */
};

struct wb_rod_solver; /* opaque */

/* `settings` may be NULL. On failure *out is NULL. */
WB_MUST_CHECK enum wb_status wb_rod_solver_create(struct wb_rod_solver **out,
                                                  const struct wb_rod_solver_model *model,
                                                  const struct wb_rod_solver_settings *settings);
void wb_rod_solver_destroy(struct wb_rod_solver *solver); /* accepts NULL */

/* Back to no loads and the virgin rod. */
void wb_rod_solver_reset(struct wb_rod_solver *solver);

/* From the present equilibrium towards the target. Not converging is a result: the state is then
 * the last converged increment's. Allocates nothing. */
WB_MUST_CHECK enum wb_status wb_rod_solver_move(struct wb_rod_solver *solver,
                                                const struct wb_rod_move *move,
                                                struct wb_rod_result *result);

/* Of the last equilibrium. */
const struct wb_rod_loads *wb_rod_solver_loads(const struct wb_rod_solver *solver);
bool wb_rod_solver_is_slack(const struct wb_rod_solver *solver);
/* y of the tip, or, where the strand is slack, where it would hold the tip, m. */
double wb_rod_solver_deflection(const struct wb_rod_solver *solver);
/* Vertical part of the tension, N. */
double wb_rod_solver_vertical_force(const struct wb_rod_solver *solver);

#endif
