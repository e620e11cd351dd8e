/* Contact with Coulomb friction between two 8-node faces that coincide in the reference
 * configuration: a core and its jacket. No adhesion: the interface opens freely.
 *
 * Small sliding, finite rotation: a point of the outer face keeps its partner on the inner one,
 * which is valid while the slip is small compared with an element (the slip is reported). Normal
 * contact by penalty (pressure = normal stiffness times penetration), friction by return mapping
 * with an elastic tangential stiffness: |t| <= mu p. Gap and slip are components of the distance
 * between the partners in a frame of unit vectors convected with the inner face, so rigid rotations
 * have no effect. Tractions are work-conjugate to these components, so forces and moments on both
 * faces balance exactly. Source: P. Wriggers, Computational Contact Mechanics, 2nd ed., chapters 5,
 * 6 and 9.
 */
#ifndef WB_FE_SOLID_JACKET_CONTACT_H
#define WB_FE_SOLID_JACKET_CONTACT_H

#include "fe/linear/trial.h"

enum {
    WB_JACKET_CONTACT_UNKNOWNS = 48, /* 8 inner nodes, then 8 outer ones */
    WB_JACKET_CONTACT_POINTS = 9     /* 3 x 3 Gauss points */
};

/* History of a point; all zero is virgin (touching without pressure). */
struct wb_jacket_contact_state {
    double traction[2]; /* tangential, Pa, in the convected frame: along the face's first parametric
                           direction (node 0 to node 1), and perpendicular to it */
    double gap[2];      /* tangential distance in that frame at the end of the last step, m */
    double slip;        /* accumulated frictional slip, m; constant while open */
};

struct wb_jacket_contact_result {
    double penetration;     /* m, largest */
    double opening;         /* m, largest */
    double slip;            /* m, largest accumulated */
    double sliding;         /* largest tangential distance of partners, also of open ones, m */
    double pressure;        /* Pa, largest */
    double dissipated;      /* friction work of this step, J, backward Euler */
    double stored;          /* elastic energy of penetration and sticking, J */
    int touching, slipping; /* points */
};

/* Forces (48, N) and, unless NULL, tangent (48 x 48, row-major, unsymmetric when slipping) for
 * reference positions X (16 x 3: inner, outer) and displacements u (48) from the histories
 * `before`; `after` (may be `before`) receives the histories at the end of the step. Pressures are
 * per reference area. Sign: internal forces, as for an element. Non-finite u gives non-finite
 * forces. No side effects. */
void wb_jacket_contact_evaluate(
    const struct wb_jacket_contact_law *law, const double X[16][3], const double *restrict u,
    const struct wb_jacket_contact_state before[WB_JACKET_CONTACT_POINTS],
    struct wb_jacket_contact_state after[WB_JACKET_CONTACT_POINTS], double *restrict force,
    double *restrict tangent, struct wb_jacket_contact_result *result);

#endif
