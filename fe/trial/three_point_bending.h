/* Three-point bending, computed with the 1D beam: a wire rests freely on two rollers and a nose
 * presses it down between them.
 *
 * Frame: x along the straight wire, 0 at the nose; y upwards, 0 on the axis of a straight wire that
 * rests on the rollers. Rollers stand at x = -span/2 and span/2 with their axes at y = -(R + d/2);
 * the nose, of axis x = 0, comes down. Rollers and nose are rigid circles that do not rotate; R and
 * d/2 are the radii of roller or nose and wire.
 *
 *   - A roller touches the wire where the section's normal passes through the roller's axis: the
 *     contact's arc length on the wire and its angle on the roller change as the wire bends and is
 *     drawn in. The contact force acts along that normal. Coulomb friction acts on the wire's
 *     surface, d/2 below the axis, and therefore also bends the wire, which sticks or slides.
 *   - The nose pushes every node that would come closer to its axis than R + d/2: first one node,
 *     then an arc of nodes once the wire's curvature reaches the nose's. The middle section is held
 *     at x = 0 (by the nose's friction; in a symmetric test there is no force). Apart from that the
 *     nose has no friction: the wire rolls onto it without slipping, and the effect of the axial
 *     force along the arc is small compared with the nose's moment.
 *
 * Contacts are linear springs 1e5 (rollers) and 2e4 (nose) times stiffer than the elastic span, so
 * their compression is about 1e-5 of the deflection. By default half of the wire is computed,
 * clamped in the plane of symmetry; compute the whole wire, at twice the cost, if the natural
 * curvature is not symmetric.
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
    double overhang; /* initial length of wire beyond each roller's axis, m; 0: 0.3 span */
    double support_radius, nose_radius; /* R, m; 0: a knife's edge */
    double friction;                    /* mu at the rollers, 1 */
    double compliance; /* of the machine, m/N: travel = deflection + compliance * force */
    int n_elements;    /* of half the wire; 0: 80 */
    bool whole;        /* compute both halves */
    /* Natural curvature, 1/m, over the arc length from the middle (m; negative on the left, not
     * used for half a wire); positive is concave upwards, as the nose bends it. NULL: straight.
     * Called during creation and by wb_three_point_bending_set_curvature(). */
    double (*natural_curvature)(void *context, double from_middle);
    void *curvature_context;
};

enum wb_three_point_bending_end {
    WB_THREE_POINT_BENDING_CONVERGED,
    WB_THREE_POINT_BENDING_NOT_CONVERGED, /* stopped at the last equilibrium before the target */
    WB_THREE_POINT_BENDING_RAN_OFF,       /* stopped because the wire's end reached a roller */
    WB_THREE_POINT_BENDING_PINCHED /* stopped because the wire is pinched between nose and rollers
                                    */
};

/* One equilibrium. */
struct wb_three_point_bending_point {
    enum wb_three_point_bending_end end;
    double deflection; /* travel of the nose since it touched the wire at rest, m */
    double travel;     /* travel of the crosshead, including the machine's compliance, m */
    double force;      /* of the nose, N */
    bool slack;        /* the nose does not touch, or is about to lift off */
    double middle; /* downward displacement of the wire's middle, m; exceeds the nose's if the wire
                      lifts off between two lines of contact */
    double contact_angle;    /* slope of the wire at the right roller, rad */
    double draw_in;          /* length of wire drawn over the right roller towards the middle, m */
    double wrapped;          /* angle on the nose from the first to the last touching node, rad */
    double tension;          /* friction on the right roller, N; positive pulls the wire outwards */
    double middle_moment;    /* moment of the section nearest to the middle, N m; positive concave
                                upwards */
    double middle_curvature; /* curvature of that section minus its natural curvature, 1/m */
    double work;             /* of the nose since the virgin state, J */
    double internal_work;    /* of the section forces on the strains, J */
    double friction_work;    /* J */
    int iterations;          /* Newton iterations of all sub-steps */
    double residual;         /* last relative residual */
};

struct wb_three_point_bending; /* opaque */

/* Allocates all memory; the wire rests on the rollers and the nose just touches it. On failure *out
 * is NULL. */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_create(struct wb_three_point_bending **out,
                              const struct wb_three_point_bending_model *model);
void wb_three_point_bending_destroy(struct wb_three_point_bending *bending); /* accepts NULL */

/* Replaces the law by one of the same kind (see wb_cantilever_set_law()) and returns to the virgin
 * wire at rest. Keeps all memory. */
WB_MUST_CHECK enum wb_status wb_three_point_bending_set_law(struct wb_three_point_bending *bending,
                                                            const struct wb_law *law);

/* Replaces the natural curvature and returns to the virgin wire at rest. WB_ERR_ARGUMENT if the
 * wire is too curved to rest on the rollers: set another curvature before any further use. */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_set_curvature(struct wb_three_point_bending *bending,
                                     double (*natural_curvature)(void *context, double from_middle),
                                     void *context);

/* Moves the nose from its current position to a deflection, in as many sub-steps as convergence
 * needs. If the force decreases to zero during unloading, the nose lifts off: this point is slack,
 * and so are later points above that level. Not reaching the target is a result, not an error: see
 * point->end. */
WB_MUST_CHECK enum wb_status
wb_three_point_bending_move(struct wb_three_point_bending *bending, double deflection,
                            struct wb_three_point_bending_point *point);

/* Level of the nose at which it last touched or left the wire, as deflection in m. */
double wb_three_point_bending_contact_level(const struct wb_three_point_bending *bending);

/* "converged", "not converged", ... */
const char *wb_three_point_bending_end_name(enum wb_three_point_bending_end end);

#endif
