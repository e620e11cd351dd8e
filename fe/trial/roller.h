/* A beam on a fixed round support: where it touches, and what acts there.
 *
 * The contact lies at the arc length s of the beam where the section's normal n = (-sin t, cos t)
 * goes through the roller's axis c, (x - c) . (cos t, sin t) = 0; its distance g = (x - c) . n is
 * compared with R + d/2. Both s and the angle t at it wander. With positions and rotations
 * interpolated by the element's quadratics, and rotations continuous from element to element, force
 * and contact point move smoothly over the nodes.
 *
 * Slip: while the contact moves by ds along the wire and turns by dt, the wire's surface moves by
 * -(R dt + ds) along the roller, R the roller's own radius (strains of the surface left out).
 */
#ifndef WB_FE_TRIAL_ROLLER_H
#define WB_FE_TRIAL_ROLLER_H

#include <stdbool.h>

#include "fe/rod/beam.h"

struct wb_roller {
    double x, y;        /* of its axis, m */
    double radius;      /* m, with the wire's: of the wire's axis around it */
    double wire_radius; /* m */
    double friction;    /* mu */
    double stiffness;   /* N/m, normal to the contact */
    double sticking;    /* N/m, along it while the wire sticks */
};

/* A place of the beam under which the roller's axis lies. */
struct wb_roller_place {
    int element;
    double arc, angle, distance;                                /* s, m; t, rad; g, m */
    double N[WB_BEAM_ELEMENT_NODES], dN[WB_BEAM_ELEMENT_NODES]; /* shape functions; by s, 1/m */
};

/* What a converged step leaves behind. */
struct wb_roller_state {
    double arc, angle;
    double friction; /* along the wire, N; on the wire, in the direction of growing s */
};

struct wb_roller_contact {
    struct wb_roller_place place;
    double normal, friction;                 /* N, on the wire */
    double slip;                             /* m, of the wire since the state it started from */
    double force[3 * WB_BEAM_ELEMENT_NODES]; /* on the element's nodes: x, y (N), t (N m) */
    double tangent[3 * WB_BEAM_ELEMENT_NODES][3 * WB_BEAM_ELEMENT_NODES]; /* of that */
};

/* Looks for the place from arc length `near` on; false where the beam ends before. */
bool wb_roller_find(const struct wb_roller *roller, const struct wb_beam *beam, double near,
                    struct wb_roller_place *place);

/* Force on the beam's trial state: a spring against the distance, which also pulls, and Coulomb's
 * friction from that of `state` on. False where the beam ends before. */
bool wb_roller_press(const struct wb_roller *roller, const struct wb_beam *beam,
                     const struct wb_roller_state *state, struct wb_roller_contact *contact);

/* Takes over the contact; returns the work that its friction used up, J. */
double wb_roller_commit(const struct wb_roller *roller, const struct wb_roller_contact *contact,
                        struct wb_roller_state *state);

#endif
