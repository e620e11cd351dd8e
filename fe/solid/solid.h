/* Static equilibrium of a body of 20-node hexahedra at finite strain: Newton's method in automatic
 * increments.
 *
 * Loads of the body: weight, nodal forces, prescribed displacements, each by a factor. Loads of the
 * tip act through the section at the free end as a whole: with E-weighted averages over the end
 * faces of position, x_t = sum w_a x_a, and of its gradients, g_y = sum c_a x_a, g_z = sum d_a x_a
 * (the least-squares images of the section's axes), the tip loads do work on z = (x_t, g_y, g_z)
 * only. Forces are distributed over the section like its stiffness, moments as linear tractions.
 * Everything that depends on the tip's motion (followers, moments, a strand, a controlled
 * deflection, the arc length) is then a system of nine unknowns, and the body's system stays
 * symmetric and banded.
 */
#ifndef WB_FE_SOLID_SOLID_H
#define WB_FE_SOLID_SOLID_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/solid/jacket_contact.h"
#include "fe/solid/solid_model.h"

struct wb_solid_settings {
    double force_tolerance;    /* largest residual over the largest force at any node; 0: 1e-6 */
    double first_increment;    /* share of a move; 0: 1 */
    double smallest_increment; /* 0: 1e-5 */
    double largest_increment;  /* 0: 1 */
};

/* All loads. */
struct wb_solid_loads {
    double weight, supports, nodal; /* factors */
    struct wb_tip_loads tip;
    double tension; /* N: of the strand, or of the vertical force that prescribes the deflection */
};

/* Position of the tip: averages over the end faces. */
struct wb_solid_tip {
    double position[3];
    double frame[3][3]; /* rows: unit vectors along the wire, the section's y, its z */
};

enum wb_solid_control {
    WB_SOLID_LOADS,      /* all loads move to the target, including the tension */
    WB_SOLID_DEFLECTION, /* the tip's y moves to `deflection`, the other loads to the target; the
                            tension is unknown */
    WB_SOLID_ARC /* loads follow the path of equilibria towards the target, past limit points; their
                    share of the move is unknown */
};

enum wb_solid_end {
    WB_SOLID_CONVERGED,
    WB_SOLID_NOT_CONVERGED,
    WB_SOLID_STOPPED, /* by the observer */
    WB_SOLID_SLACK /* a strand only pulls: its tension decreased to zero before the deflection was
                      reached; the state is at zero tension */
};

struct wb_solid_move {
    enum wb_solid_control control;
    struct wb_solid_loads target; /* the tension is ignored for WB_SOLID_DEFLECTION */
    double deflection;            /* m */
    double arc_length;   /* m: length of the tip's path (position and radius of gyration times the
                            change of frame) per increment */
    int most_increments; /* for WB_SOLID_ARC: end after this many increments, or when the share
                            reaches 1; 0: 1 */
    /* Called after each increment; may be NULL; return false to stop. */
    bool (*observer)(void *context, double fraction, int iterations);
    void *context;
};

struct wb_solid_point {
    enum wb_solid_end end;
    double fraction; /* of the move that was completed */
    int increments, iterations, cutbacks;
    double residual;     /* relative, of the last equilibrium */
    int negative_pivots; /* of the last factorisation */
    bool unstable;       /* the equilibrium is unstable under its control: it lies on a path past a
                            critical point (a limit load, buckling). Moves by loads or deflection never
                            pass such a point: they end before it, not converged */
    char problem[240];   /* why the move did not converge; "" otherwise */
};

struct wb_solid_balance {
    double work;       /* J, of all loads since the virgin state (trapezoidal over increments) */
    double elastic;    /* J, stored, including the interface's springs */
    double dissipated; /* J plastic */
    double friction;   /* J */
    struct wb_jacket_contact_result jacket_contact; /* of the last equilibrium */
};

struct wb_solid; /* opaque */

WB_MUST_CHECK enum wb_status wb_solid_create(struct wb_solid **out,
                                             const struct wb_solid_model *model,
                                             const struct wb_solid_settings *settings);
void wb_solid_destroy(struct wb_solid *solid); /* accepts NULL */

/* Moves from the current equilibrium towards the target. Not converging is a result, not an error:
 * the state is then that of the last converged increment. */
WB_MUST_CHECK enum wb_status wb_solid_move(struct wb_solid *solid, const struct wb_solid_move *move,
                                           struct wb_solid_point *point);

int wb_solid_unknowns(const struct wb_solid *solid);

/* Loads of the last equilibrium. */
const struct wb_solid_loads *wb_solid_loads(const struct wb_solid *solid);
void wb_solid_tip(const struct wb_solid *solid, struct wb_solid_tip *tip);
const double *wb_solid_displacement(const struct wb_solid *solid); /* (3 n_nodes), m */
void wb_solid_balance(const struct wb_solid *solid, struct wb_solid_balance *balance);

/* Cauchy stress and equivalent plastic strain at the nodes of element e, extrapolated from its own
 * points. */
void wb_solid_nodal_stress(const struct wb_solid *solid, int e, double stress[20][6],
                           double plastic[20]);

#endif
