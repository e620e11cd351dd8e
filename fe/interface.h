/* Contact with Coulomb friction between two faces of 8 nodes that coincide in the reference: a
 * core and its jacket. No adhesion: the interface opens freely.
 *
 * Small sliding, finite rotation: a point of the outer face stays with its partner of the inner
 * one, which holds while the slip is small beside an element (it is reported). Normal contact by
 * penalty (pressure = normal stiffness times penetration), friction by return mapping with an
 * elastic tangential stiffness: |t| <= mu p. Slip is measured and kept in the convected frame of
 * the inner face, so a rigid rotation changes nothing. Source: P. Wriggers, Computational Contact
 * Mechanics, 2nd ed., chapters 5, 6 and 9.
 */
#ifndef WB_FE_INTERFACE_H
#define WB_FE_INTERFACE_H

#include <stdbool.h>

enum {
    WB_INTERFACE_UNKNOWNS = 48, /* 8 inner nodes, then 8 outer ones */
    WB_INTERFACE_POINTS = 9     /* 3 x 3 Gauss points */
};

struct wb_interface_law {
    double normal_stiffness;     /* Pa/m */
    double tangential_stiffness; /* Pa/m, of sticking */
    double friction;             /* mu, 1 */
};

/* History of a point; all zero is virgin (touching without pressure). */
struct wb_interface_state {
    double traction[2]; /* Pa, tangential, in the convected frame (see .c) */
    double gap[2];      /* m, tangential relative displacement at the end of the last step */
    double slip;        /* m, accumulated frictional slip */
};

struct wb_interface_result {
    double penetration;     /* m, largest */
    double opening;         /* m, largest */
    double slip;            /* m, largest accumulated */
    double pressure;        /* Pa, largest */
    double dissipated;      /* J, in this step */
    int touching, slipping; /* points */
};

/* Forces (48, N) and, unless NULL, tangent (48 x 48, row-major, unsymmetric when slipping) for
 * reference positions X (16 x 3: inner, outer) and displacements u (48), from `before`; `after`
 * receives the histories at the end of the step. Sign: internal forces, as an element's. Pure. */
void wb_interface_evaluate(const struct wb_interface_law *law, const double X[16][3],
                           const double *restrict u,
                           const struct wb_interface_state before[WB_INTERFACE_POINTS],
                           struct wb_interface_state after[WB_INTERFACE_POINTS],
                           double *restrict force, double *restrict tangent,
                           struct wb_interface_result *result);

#endif
