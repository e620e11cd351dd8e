/* Contact with Coulomb friction between two faces of 8 nodes that coincide in the reference: a
 * core and its jacket. No adhesion: the interface opens freely.
 *
 * Small sliding, finite rotation: a point of the outer face stays with its partner of the inner
 * one, which holds while the slip is small beside an element (it is reported). Normal contact by
 * penalty (pressure = normal stiffness times penetration), friction by return mapping with an
 * elastic tangential stiffness: |t| <= mu p. Gap and slip are components of the distance between
 * the partners in a frame of unit vectors convected with the inner face, so a rigid rotation
 * changes nothing; tractions do work on these components, so that the forces on both faces balance
 * exactly, and their moments too. Source: P. Wriggers, Computational Contact Mechanics, 2nd ed.,
 * chapters 5, 6 and 9.
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
    double traction[2]; /* Pa, tangential, in the convected frame: along the face's first parametric
                           direction (node 0 to node 1), and across it */
    double gap[2];      /* m, tangential distance in that frame at the end of the last step */
    double slip;        /* m, accumulated frictional slip; it does not grow while open */
};

struct wb_jacket_contact_result {
    double penetration;     /* m, largest */
    double opening;         /* m, largest */
    double slip;            /* m, largest accumulated */
    double sliding;         /* m, largest distance of partners along the face, open ones too */
    double pressure;        /* Pa, largest */
    double dissipated;      /* J, by friction in this step, backward Euler */
    double stored;          /* J, in the springs of penetration and of sticking */
    int touching, slipping; /* points */
};

/* Forces (48, N) and, unless NULL, tangent (48 x 48, row-major, unsymmetric when slipping) for
 * reference positions X (16 x 3: inner, outer) and displacements u (48), from `before`; `after`
 * receives the histories at the end of the step (it may be `before`). Pressures are per reference
 * area. Sign: internal forces, as an element's. What is not finite in u comes out as forces that
 * are not. Pure. */
void wb_jacket_contact_evaluate(
    const struct wb_jacket_contact_law *law, const double X[16][3], const double *restrict u,
    const struct wb_jacket_contact_state before[WB_JACKET_CONTACT_POINTS],
    struct wb_jacket_contact_state after[WB_JACKET_CONTACT_POINTS], double *restrict force,
    double *restrict tangent, struct wb_jacket_contact_result *result);

#endif
