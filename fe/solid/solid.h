/* Static equilibrium of a body of 20-node hexahedra at finite strain: Newton's method in automatic
 * increments.
 *
 * Loads of the body: weight, nodal forces, prescribed displacements, each by a factor. Loads of the
 * tip act through the section at the free end as a whole: with E-weighted averages over the end
 * faces of position, x_t = sum w_a x_a, and of its gradients, g_y = sum c_a x_a, g_z = sum d_a x_a
 * (the least-squares images of the section's axes), the tip loads do work on z = (x_t, g_y, g_z)
 * only. Forces spread over the section as its rigidity does, moments as linear tractions. So all
 * that depends on the tip's motion (followers, moments, a strand, a controlled deflection, the arc
 * length) is a system of nine unknowns beside the body's, which stays symmetric and banded.
 */
#ifndef WB_FE_SOLID_SOLID_H
#define WB_FE_SOLID_SOLID_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"
#include "fe/solid/jacket_contact.h"
#include "fe/solid/solid_model.h"

struct wb_solid_settings {
    double force_tolerance;    /* residual over the largest force at any node; 0: 1e-6 */
    double first_increment;    /* share of a move; 0: 1 */
    double smallest_increment; /* 0: 1e-5 */
    double largest_increment;  /* 0: 1 */
    double most_rotation;      /* rad by which an increment may turn the tip; 0: 0.25 */
    int max_iterations;        /* 0: 12 */
};

/* All loads. */
struct wb_solid_loads {
    double weight, supports, nodal; /* factors */
    struct wb_tip_loads tip;
    double tension; /* N: of the strand, or the vertical force that makes a deflection */
};

/* Where the tip is: averages over the end faces. */
struct wb_solid_tip {
    double position[3];
    double frame[3][3]; /* rows: unit vectors along the wire, the section's y, its z */
};

enum wb_solid_control {
    WB_SOLID_LOADS,      /* loads go to the target, tension too */
    WB_SOLID_DEFLECTION, /* the other loads go to the target, the tip's y to `deflection`; the
                            tension follows */
    WB_SOLID_ARC         /* loads go towards the target along the path of equilibria, past limit
                            points; their share of the way follows */
};

enum wb_solid_end {
    WB_SOLID_CONVERGED,
    WB_SOLID_NOT_CONVERGED,
    WB_SOLID_STOPPED, /* by the observer */
    WB_SOLID_SLACK    /* a strand only pulls: its tension came down to zero before the deflection
                         was reached. The state is that at which it did */
};

struct wb_solid_move {
    enum wb_solid_control control;
    struct wb_solid_loads target; /* tension is ignored with WB_SOLID_DEFLECTION */
    double deflection;            /* m */
    double arc_length;   /* m: of the tip's way (position and 1/2 d frame), one increment each */
    int most_increments; /* with WB_SOLID_ARC: ends after these, or when the share of the way
                            reaches 1; 0: 1 */
    bool (*observer)(void *context, double fraction, int iterations); /* per increment; may be NULL.
                                                                         False stops */
    void *context;
};

struct wb_solid_point {
    enum wb_solid_end end;
    double fraction; /* of the move that was made */
    int increments, iterations, cutbacks;
    double residual;     /* relative, of the last equilibrium */
    int negative_pivots; /* of the last factorisation */
    bool unstable;       /* the equilibrium cannot stand under its control: it is on a path past a
                            critical point (a limit load, buckling). Moves by loads or deflection
                            never step over such a point: they end before it, not converged */
    char problem[240];   /* why it did not converge; "" otherwise */
};

struct wb_solid_balance {
    double work;       /* J by all loads since the virgin state (trapezoidal over increments) */
    double elastic;    /* J stored, in the interface's springs too */
    double dissipated; /* J plastic */
    double friction;   /* J */
    struct wb_jacket_contact_result jacket_contact; /* of the last equilibrium */
};

struct wb_solid; /* opaque */

WB_MUST_CHECK enum wb_status wb_solid_create(struct wb_solid **out,
                                             const struct wb_solid_model *model,
                                             const struct wb_solid_settings *settings);
void wb_solid_destroy(struct wb_solid *solid); /* accepts NULL */

/* From the present equilibrium towards the target. Not converging is a result: the state is then
 * the last converged increment's. */
WB_MUST_CHECK enum wb_status wb_solid_move(struct wb_solid *solid, const struct wb_solid_move *move,
                                           struct wb_solid_point *point);

int wb_solid_unknowns(const struct wb_solid *solid);

/* Of the last equilibrium. */
const struct wb_solid_loads *wb_solid_loads(const struct wb_solid *solid);
void wb_solid_tip(const struct wb_solid *solid, struct wb_solid_tip *tip);
const double *wb_solid_displacement(const struct wb_solid *solid); /* (3 n_nodes), m */
void wb_solid_balance(const struct wb_solid *solid, struct wb_solid_balance *balance);

/* Cauchy stress and equivalent plastic strain at the nodes of element e, from its own points. */
void wb_solid_nodal_stress(const struct wb_solid *solid, int e, double stress[20][6],
                           double plastic[20]);

#endif
