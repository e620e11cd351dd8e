/* Three-point bending, computed with the 1D beam: a wire rests freely on two rollers and a nose
 * presses it down between them.
 *
 * Frame: x along the straight wire, 0 at the nose; y upwards, 0 on the axis of a straight wire that
 * rests on the rollers. Rollers stand at x = -span/2 and span/2 with their axes at y = -(R + d/2);
 * the nose, of axis x = 0, comes down. Rollers and nose are rigid circles that neither turn nor
 * yield, R and d/2 the radii of body and wire.
 *
 *   - A roller touches the wire where the section's normal goes through the roller's axis: there
 *     the contact's arc length on the wire and its angle on the roller both wander as the wire is
 *     bent and drawn in. Its force acts along that normal. Friction (Coulomb) acts along the wire
 *     on its surface, d/2 below the axis, and so bends it, too; the wire sticks, or slides.
 *   - The nose pushes every node that would come nearer to its axis than R + d/2: one at first,
 *     the nodes of an arc once the wire is bent as sharply as the nose is round. The section where
 *     the wire is in the middle is held to x = 0 (the nose's friction holds it; where all is
 *     symmetric nothing pulls at it). Otherwise the nose has no friction: the wire rolls on to it
 *     without slipping, and what the axial force would change in the arc is small against the
 *     nose's own moment.
 *
 * Contacts are linear springs, stiffer than the span by 1e5, so that they yield by 1e-5 of the
 * deflection. By default half of the wire is computed, clamped to the plane of symmetry; the whole
 * wire is for natural curvatures that are not symmetric (and costs twice as much).
 *
 * The wire has no weight: a machine is tared with the wire in it.
 */
#ifndef WB_FE_TRIAL_THREE_POINT_BENDING_H
#define WB_FE_TRIAL_THREE_POINT_BENDING_H

#include <stdbool.h>

#include "base/status.h"
#include "fe/material/law.h"
#include "fe/rod/section.h"

struct wb_three_point_bending_model {
    const struct wb_section *section; /* borrowed during creation only */
    double diameter;                  /* d, m: outer */
    double span;                      /* m, between the rollers' axes */
    double overhang; /* m, of the wire beyond each roller's axis at first; 0: 0.3 span */
    double support_radius, nose_radius; /* R, m; 0: a knife's edge */
    double friction;                    /* mu on the rollers, 1 */
    double compliance;                  /* m/N, of the machine: travel = deflection + it * force */
    int n_elements;                     /* of half the wire; 0: 80 */
    bool whole;                         /* compute both halves */
    /* Natural curvature, 1/m, over the arc length from the middle (m; negative on the left, never
     * asked for by half a wire); positive is hollow upwards, as the nose bends it. NULL: straight.
     * Called at creation, and by wb_three_point_bending_set_curvature(). */
    double (*natural_curvature)(void *context, double from_middle);
    void *curvature_context;
};

enum wb_three_point_bending_end {
    WB_THREE_POINT_BENDING_CONVERGED,
    WB_THREE_POINT_BENDING_NOT_CONVERGED, /* the state is at the last equilibrium short of the
                                             target */
    WB_THREE_POINT_BENDING_RAN_OFF,       /* the same: the wire's end comes to a roller */
    WB_THREE_POINT_BENDING_PINCHED /* the same: the wire is caught between nose and rollers */
};

/* One equilibrium. */
struct wb_three_point_bending_point {
    enum wb_three_point_bending_end end;
    double deflection;    /* way of the nose since it touched the wire at rest, m */
    double travel;        /* the crosshead's: with the machine's compliance, m */
    double force;         /* of the nose, N */
    bool slack;           /* the nose does not touch, or is just about to leave */
    double middle;        /* way of the wire's middle, downwards, m: more than the nose's where it
                             springs off between two lines of contact */
    double contact_angle; /* of the wire on the right roller, rad: its slope there */
    double draw_in;       /* wire that was drawn over the right roller towards the middle, m */
    double wrapped;       /* angle of the nose from the first to the last touching node, rad */
    double tension;       /* friction on the right roller, N; positive pulls the wire outwards */
    double middle_moment; /* N m, of the section nearest to the middle; positive hollow upwards */
    double middle_curvature; /* 1/m, of it, beyond its natural curvature */
    double work;             /* of the nose since the virgin state, J */
    double internal_work;    /* of the wire's sections on their strains, J */
    double friction_work;    /* J */
    int iterations;          /* Newton iterations spent, all sub-steps together */
    double residual;         /* last relative residual */
};

struct wb_three_point_bending; /* opaque */

/* Takes all memory; the wire lies on the rollers, the nose just touches it. On failure *out is
 * NULL. */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_create(struct wb_three_point_bending **out,
                              const struct wb_three_point_bending_model *model);
void wb_three_point_bending_destroy(struct wb_three_point_bending *bending); /* accepts NULL */

/* Exchanges the law for one of the same kind as the section's (wb_cantilever_set_law()), and goes
 * back to the virgin wire at rest. Keeps all memory. */
WB_MUST_CHECK enum wb_status wb_three_point_bending_set_law(struct wb_three_point_bending *bending,
                                                            const struct wb_law *law);

/* Exchanges the natural curvature, as in the model, and goes back to the virgin wire at rest.
 * WB_ERR_ARGUMENT where it is too bent to lie on the rollers: then only another curvature serves.
 */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_set_curvature(struct wb_three_point_bending *bending,
                                     double (*natural_curvature)(void *context, double from_middle),
                                     void *context);

/* Moves the nose to a deflection from wherever it is, in as many sub-steps as convergence needs.
 * Where the force comes down to zero on the way up, the nose leaves the wire there: the point is
 * slack, and so is every later one above that level. WB_OK also when it did not arrive: point->end
 * says so. */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_move(struct wb_three_point_bending *bending, double deflection,
                            struct wb_three_point_bending_point *point);

/* Level of the nose at which it last touched or left the wire, m of deflection. */
double wb_three_point_bending_contact_level(const struct wb_three_point_bending *bending);

/* "converged", "not converged", ... */
const char *wb_three_point_bending_end_name(enum wb_three_point_bending_end end);

#endif
