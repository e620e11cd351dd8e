/* The planar geometrically exact (Simo-Reissner) beam, quadratic three-node element.
 *
 * A section at arc length s has position (x, y) and rotation t. Its strains are
 *
 *     eps   =  x' cos t + y' sin t   less the same of the reference configuration,
 *     gamma = -x' sin t + y' cos t   less the same of the reference configuration,
 *     kappa =  t'                    less the natural curvature,
 *
 * and its resultants N, Q, M do work on them (Simo 1985, CMAME 49:55; Reissner 1972). Position and
 * rotation are interpolated with the same quadratics, x' = sum N_i' x_i; two Gauss points an
 * element (reduced integration) keep it from locking. Unknowns of a node: x, y, t.
 */
#ifndef WB_FE_ROD_BEAM_ELEMENT_H
#define WB_FE_ROD_BEAM_ELEMENT_H

#include "fe/rod/rod_shape.h"

enum {
    WB_BEAM_ELEMENT_NODES = WB_ROD_SHAPE_NODES,
    WB_BEAM_ELEMENT_POINTS = WB_ROD_SHAPE_POINTS
};

/* x, y, t of one node. */
struct wb_beam_node {
    double x, y, t;
};

/* One Gauss point: strains of the reference, current kinematics, resultants. */
struct wb_beam_point {
    double reference_a, reference_b, reference_k;
    double cosine, sine; /* of t */
    double a, b, k;      /* x' cos t + y' sin t, -x' sin t + y' cos t, t' */
    double N, Q, M;
    double D11, D12, D22, G; /* tangents: d(N, M)/d(eps, kappa), dQ/d(gamma) */
};

/* Symmetric blocks of an element's stiffness, row-major 3 x 3, K[i][j] for i <= j. */
struct wb_beam_element_stiffness {
    double K11[9], K12[9], K13[9], K22[9], K23[9], K33[9];
};

/* Computes the cosine and sine of the rotation at Gauss point g. */
void wb_beam_element_turn(const struct wb_rod_shape *shape, int g, const struct wb_beam_node *nodes,
                          struct wb_beam_point *point);

/* Derivative t' of the rotation at Gauss point g, 1/m. */
double wb_beam_element_curvature(const struct wb_rod_shape *shape, int g,
                                 const struct wb_beam_node *nodes);

/* Computes all kinematics of Gauss point g from nodal positions: cosine, sine, a, b, k. */
void wb_beam_element_kinematics(const struct wb_rod_shape *shape, int g,
                                const struct wb_beam_node *nodes, struct wb_beam_point *point);

/* Adds the internal forces of Gauss point g to f (3 nodes x 3). */
void wb_beam_element_add_forces(const struct wb_rod_shape *shape, int g,
                                const struct wb_beam_point *point, double *restrict f);

/* Computes the element's tangent stiffness from its two points. */
void wb_beam_element_stiffness(const struct wb_rod_shape *shape, const struct wb_beam_point *points,
                               struct wb_beam_element_stiffness *restrict stiffness);

#endif
