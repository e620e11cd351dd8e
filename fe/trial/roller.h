/* Contact between a beam and a fixed round support.
 *
 * The contact lies at the arc length s of the beam where the section's normal n = (-sin t, cos t)
 * goes through the roller's axis c, (x - c) . (cos t, sin t) = 0; its distance g = (x - c) . n is
 * compared with R + d/2. Both s and the angle t change during bending. With positions and rotations
 * interpolated by the element's quadratics, and rotations continuous from element to element, force
 * and contact point vary smoothly across nodes.
 *
 * Slip: while the contact moves by ds along the wire and turns by dt, the wire's surface moves by
 * -(R dt + ds) along the roller, R the roller's own radius (strains of the surface are neglected).
 */
#ifndef WB_FE_TRIAL_ROLLER_H
#define WB_FE_TRIAL_ROLLER_H

#include <stdbool.h>

#include "fe/rod/beam.h"

struct wb_roller {
    double x, y;        /* of its axis, m */
    double radius;      /* m, including the wire's: distance of the wire's axis from the roller's */
    double wire_radius; /* m */
    double friction;    /* mu */
    double stiffness;   /* N/m, normal to the contact */
    double sticking;    /* N/m, tangential stiffness while the wire sticks */
};

/* The point of the beam whose section normal passes through the roller's axis. */
struct wb_roller_place {
    int element;
    double arc, angle, distance;                                /* s, m; t, rad; g, m */
    double N[WB_BEAM_ELEMENT_NODES], dN[WB_BEAM_ELEMENT_NODES]; /* shape functions; by s, 1/m */
};

/* State after a converged step. */
struct wb_roller_state {
    double arc, angle;
    double friction; /* tangential force on the wire, N, positive towards growing s */
};

struct wb_roller_contact {
    struct wb_roller_place place;
    double normal, friction;                 /* N, on the wire */
    double slip;                             /* slip of the wire since the start state, m */
    double force[3 * WB_BEAM_ELEMENT_NODES]; /* on the element's nodes: x, y (N), t (N m) */
    double tangent[3 * WB_BEAM_ELEMENT_NODES][3 * WB_BEAM_ELEMENT_NODES]; /* of that */
};

/* Searches for the contact point starting at arc length `near`; false if it is beyond an end of the
 * beam. */
bool wb_roller_find(const struct wb_roller *roller, const struct wb_beam *beam, double near,
                    struct wb_roller_place *place);

/* Contact force on the beam's trial state: a spring on the distance, which may also pull, and
 * Coulomb friction starting from that of `state`. False if the contact is beyond an end of the
 * beam. */
bool wb_roller_press(const struct wb_roller *roller, const struct wb_beam *beam,
                     const struct wb_roller_state *state, struct wb_roller_contact *contact);

/* Commits the contact; returns the work dissipated by its friction, J. */
double wb_roller_commit(const struct wb_roller *roller, const struct wb_roller_contact *contact,
                        struct wb_roller_state *state);

#endif
