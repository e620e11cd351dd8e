/* A chain of rigid segments that represents a wire, for programs of rigid bodies.
 *
 * A wire of length L becomes n joints at the middles of n equal parts h = L / n: the first half
 * part is clamped, followed by n - 1 segments of length h and a last one of h / 2. Each joint has
 * the bending stiffness EI / h of its part, about either transverse axis, and GJ / h about the
 * wire. That is the midpoint rule for the rotation: the tip deflection of a straight cantilever
 * under a transverse force is too small by 1 / (4 n^2), 0.25 % with ten joints. Joints at the ends
 * of the parts, with twice the stiffness at the clamp, are the trapezoidal rule with twice the
 * error.
 *
 * Largest time step: semi-implicit Euler (velocities, then positions with the new velocities) of an
 * undamped linear system is stable up to dt = 2 / omega of the highest mode (Courant; Hairer,
 * Lubich, Wanner, Geometric Numerical Integration, I.1.4). The modes are those of the straight
 * chain in bending and in torsion, which are uncoupled.
 */
#ifndef WB_ANALYSIS_CARDS_CARD_CHAIN_H
#define WB_ANALYSIS_CARDS_CARD_CHAIN_H

#include "base/status.h"

enum {
    WB_CARD_CHAIN_MOST = 200 /* segments */
};

struct wb_card_chain {
    int n;                  /* joints and moving segments, 2 to WB_CARD_CHAIN_MOST */
    double length;          /* m */
    double diameter;        /* m, of the solid circle */
    double mass_per_length; /* kg/m */
    double bending;         /* EI, N m2 */
    double torsion;         /* GJ, N m2 */
};

/* Moving segment i, from 0: length (m), mass (kg), moments of inertia about its centre along and
 * across the wire (kg m2) of a solid cylinder. */
struct wb_card_chain_segment {
    double length, mass, along, across;
};
struct wb_card_chain_segment wb_card_chain_segment(const struct wb_card_chain *chain, int i);

/* Angular frequencies, rad/s, of the straight chain without damping. */
struct wb_card_chain_modes {
    double lowest_bending, highest_bending, highest_torsion;
};
/* WB_ERR_ARGUMENT for values out of range. */
WB_MUST_CHECK enum wb_status wb_card_chain_modes(const struct wb_card_chain *chain,
                                                 struct wb_card_chain_modes *modes);

#endif
