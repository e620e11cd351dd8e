/* The 20-node hexahedron at finite strain: total Lagrangian, logarithmic strain, J2 plasticity.
 *
 * The stored energy splits into a volumetric part in J = det F and a deviatoric one in the
 * logarithmic strain E = 1/2 ln(F^T F), so selective reduced integration is simply two sums:
 * volumetric on 2 x 2 x 2 points, deviatoric on 3 x 3 x 3. With WB_INTEGRATION_REDUCED both are on
 * 2 x 2 x 2. The stiffness is symmetric in both. Stresses inside are Kirchhoff's, tau = J sigma;
 * the yield stress bounds tau (J differs from 1 by the elastic change of volume only).
 * Source: C. Miehe, N. Apel, M. Lambrecht, CMAME 191 (2002) 5383 (additive plasticity in the
 * logarithmic strain space); O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method
 * (selective reduced integration).
 *
 * Node order: fe/solid/solid_mesh.h. Unknown 3 a + i is displacement i of node a.
 */
#ifndef WB_FE_SOLID_HEX20_H
#define WB_FE_SOLID_HEX20_H

#include <stdbool.h>

#include "fe/linear/trial.h"
#include "fe/material/material.h"
#include "fe/solid/hex20_points.h"
#include "fe/solid/solid_point.h"

/* Gradients with respect to the reference position, and weights, at all points of one element. A
 * gradient is stored as three rows: the derivatives of the 20 shape functions along x, y and z. */
struct wb_hex20_geometry {
    double gradient[WB_HEX20_MOST_POINTS][3][WB_HEX20_NODES];          /* 1/m, deviatoric points */
    double weight[WB_HEX20_MOST_POINTS];                               /* m3 */
    double corner_gradient[WB_HEX20_CORNER_POINTS][3][WB_HEX20_NODES]; /* volumetric points */
    double corner_weight[WB_HEX20_CORNER_POINTS];
    double nodal_share[WB_HEX20_NODES][WB_HEX20_CORNER_POINTS]; /* of the corner points' values */
    double volume;                                              /* m3 */
};

/* What an evaluation found, besides forces and stiffness. */
struct wb_hex20_result {
    double elastic_energy;    /* J, stored (with kinematic hardening also in the back stress) */
    double dissipated;        /* J, plastic work done in this step, backward Euler */
    double smallest_jacobian; /* least J at any point */
    int yielding;             /* points that yield in this step */
};

/* States of an element: 27 or 8. */
int wb_hex20_points(enum wb_integration integration);

/* From the nodes' reference positions. False when the Jacobian is not positive at every point. */
bool wb_hex20_geometry_init(struct wb_hex20_geometry *geometry, enum wb_integration integration,
                            const double position[WB_HEX20_NODES][3]);

/* Internal forces `force` (60, N) and, unless NULL, tangent stiffness (60 x 60, symmetric, all of
 * it filled, N/m) for displacements u (60, m), from the histories `before`; `after` receives those
 * at the end of the step (both as many as wb_hex20_points()). False when an element is inverted
 * (J <= 0 at a point) or anything is not finite: outputs are then of no meaning. Pure. */
bool wb_hex20_evaluate(const struct wb_hex20_geometry *geometry, enum wb_integration integration,
                       const struct wb_material *material, const double *restrict u,
                       const struct wb_solid_point_state *before,
                       struct wb_solid_point_state *after, double *restrict force,
                       double *restrict stiffness, struct wb_hex20_result *result);

/* Cauchy stress (Pa, global frame) and equivalent plastic strain at the nodes, of a converged state
 * (its histories are `state`): values at the points extrapolated in the element; what is linear in
 * the reference position stays so, on curved elements too.
 * Not a number where an element is inverted. */
void wb_hex20_nodal_stress(const struct wb_hex20_geometry *geometry,
                           enum wb_integration integration, const struct wb_material *material,
                           const double *restrict u, const struct wb_solid_point_state *state,
                           double stress[WB_HEX20_NODES][6], double plastic[WB_HEX20_NODES]);

/* Consistent nodal weights of a body force: integrals of the 20 shape functions over the reference
 * volume, m3. */
void wb_hex20_volume_weights(const double position[WB_HEX20_NODES][3],
                             double weight[WB_HEX20_NODES]);

/* Integrals over a flat or curved face of 8 nodes (fe/solid/solid_mesh.h) of f(position) times its
 * 8 shape functions, for f = 1, y and z: the weights of section averages. m2, m3, m3. And of y^2
 * and z^2 without shape functions (m4). */
struct wb_hex20_face {
    double one[8], y[8], z[8];
    double area, yy, zz;
};
void wb_hex20_face_integrals(const double position[8][3], struct wb_hex20_face *face);

#endif
