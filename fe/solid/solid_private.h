/* Shared by solid.c (moves, increments) and solid_newton.c (one equilibrium); nobody else. */
#ifndef WB_FE_SOLID_SOLID_PRIVATE_H
#define WB_FE_SOLID_SOLID_PRIVATE_H

#include "fe/solid/solid.h"
#include "fe/solid/solid_body.h"
#include "fe/solid/solid_tip.h"
#include "fe/solid/solid_update.h"

/* Columns of the right-hand sides. */
enum {
    WB_SOLID_COLUMN_RESIDUAL,
    WB_SOLID_COLUMN_LOADS, /* change of the body's loads with the share, for the arc length */
    WB_SOLID_COLUMN_TIP,
    WB_SOLID_COLUMNS = WB_SOLID_COLUMN_TIP + WB_SOLID_TIP_UNKNOWNS
};

/* What drives an increment, as numbers, to tell whether it continues the one before. */
enum {
    WB_SOLID_DRIVES = 3 + 9 + 2 /* factors, tip loads, deflection, tension */
};

/* One equilibrium to be found: a share of a move. */
struct wb_solid_increment {
    const struct wb_solid_move *move;
    struct wb_solid_loads start;          /* of the move */
    double start_deflection;              /* m, of the move */
    double from, share;                   /* of the move: last equilibrium's, the one wanted */
    double arc_length;                    /* m; with WB_SOLID_ARC */
    const double *last_direction;         /* (9) change of z in the increment before; NULL: none */
    double change[WB_SOLID_TIP_UNKNOWNS]; /* out: of z */
};

struct wb_solid {
    struct wb_solid_settings settings;
    struct wb_solid_body body;
    struct wb_solid_tip_section tip;
    struct wb_solid_update update;
    struct wb_solid_tip_strand strand;
    int n_supports;
    struct wb_solid_support *supports;
    double *nodal_force; /* (3 n_nodes); NULL: none */

    /* Displacements: trial, of the last equilibrium, of the one before. */
    double *u, *committed, *before;
    struct wb_solid_loads loads, committed_loads, before_loads;
    double *committed_force; /* (3 n_nodes) */
    double drive[WB_SOLID_DRIVES];
    bool can_continue; /* `before` and `drive` belong to the last equilibrium's own increment */
    double last_change[WB_SOLID_TIP_UNKNOWNS]; /* of z, in the last increment */
    bool on_arc;     /* the last increment was one of an arc towards arc_target */
    double arc_pace; /* m: that increment's length */
    struct wb_solid_loads arc_target;
    double largest_force; /* N: ever met at a node */
    double pace;          /* share of a move that the last increment took */
    struct wb_solid_balance balance;

    /* Workspace of Newton's method. */
    double *right; /* (n_equations x WB_SOLID_COLUMNS) */
    double *step;  /* (3 n_nodes) */
    double *base;  /* (3 n_nodes) u before the step */
    double *held;  /* (3 n_nodes) */
    double *held_force;
    double compliance[WB_SOLID_TIP_UNKNOWNS * WB_SOLID_TIP_UNKNOWNS];
    double tip_derivative[WB_SOLID_TIP_UNKNOWNS * WB_SOLID_TIP_UNKNOWNS];
    struct wb_solid_body_result found;
    double residual; /* relative */
    int worst_node;
    int iterations;
    int negative_pivots;
    bool unstable; /* of the last equilibrium */
    char problem[240];
};

/* Loads of a move at a share of it; the tension is that of `now` where it is an unknown. */
struct wb_solid_loads wb_solid_loads_at(const struct wb_solid_increment *increment, double share,
                                        double tension);

/* Finds the equilibrium, from the trial state that the caller has set: solid->u and solid->loads.
 * `predicted` says that the trial state already holds the new supports. True when it converged: the
 * trial state, histories and solid->found are then those of the equilibrium, and increment->share
 * the share that was reached. Otherwise solid->problem says why. */
bool wb_solid_newton(struct wb_solid *solid, struct wb_solid_increment *increment, bool predicted);

/* Whether the equilibrium just found is unstable under its control (with an arc: under its loads).
 * Of conservative loads by the signature of the tangent; of loads that turn with the tip, and with
 * contact, by the sign of its determinant, which two critical points at once leave as it is. */
bool wb_solid_newton_unstable(const struct wb_solid *solid,
                              const struct wb_solid_increment *increment);

#endif
