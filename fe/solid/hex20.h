/* The 20-node hexahedron at finite strain: total Lagrangian, logarithmic strain, J2 plasticity.
 *
 * The stored energy splits into a volumetric part in J = det F and a deviatoric one in the
 * logarithmic strain E = 1/2 ln(F^T F), so selective reduced integration is simply two sums:
 * volumetric on 2 x 2 x 2 points, deviatoric on 3 x 3 x 3. With WB_INTEGRATION_REDUCED both are on
 * 2 x 2 x 2. The stiffness is symmetric in both. Internally stresses are Kirchhoff stresses, tau =
 * J sigma; the yield stress limits tau (J differs from 1 only by the elastic volume change).
 * Source: C. Miehe, N. Apel, M. Lambrecht, CMAME 191 (2002) 5383 (additive plasticity in the
 * logarithmic strain space); O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method (selective
 * reduced integration).
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
 * gradient has three rows: the derivatives of the 20 shape functions along x, y and z. */
struct wb_hex20_geometry {
    double gradient[WB_HEX20_MOST_POINTS][3][WB_HEX20_NODES];          /* 1/m, deviatoric points */
    double weight[WB_HEX20_MOST_POINTS];                               /* m3 */
    double corner_gradient[WB_HEX20_CORNER_POINTS][3][WB_HEX20_NODES]; /* volumetric points */
    double corner_weight[WB_HEX20_CORNER_POINTS];
    double nodal_share[WB_HEX20_NODES]
                      [WB_HEX20_CORNER_POINTS]; /* extrapolation weights of the corner points */
    double volume;                              /* m3 */
};

/* Result of an evaluation besides forces and stiffness. */
struct wb_hex20_result {
    double elastic_energy; /* stored energy, J, including the back stress of kinematic hardening */
    double dissipated;     /* plastic work of this step, J, backward Euler */
    double smallest_jacobian; /* smallest J at any point */
    int yielding;             /* number of points that yield in this step */
};

/* Number of integration points, and so of histories, of an element: 27 or 8. */
int wb_hex20_points(enum wb_integration integration);

/* Computes the geometry from the nodes' reference positions. False if the Jacobian is not positive
 * at every point. */
bool wb_hex20_geometry_init(struct wb_hex20_geometry *geometry, enum wb_integration integration,
                            const double position[WB_HEX20_NODES][3]);

/* Internal forces `force` (60, N) and, unless NULL, tangent stiffness (60 x 60, symmetric, fully
 * stored, N/m) for displacements u (60, m) from the histories `before`; `after` receives the
 * histories at the end of the step (wb_hex20_points() each). False if the element is inverted (J <=
 * 0 at a point) or a value is not finite; the outputs are then undefined. No side effects. */
bool wb_hex20_evaluate(const struct wb_hex20_geometry *geometry, enum wb_integration integration,
                       const struct wb_material *material, const double *restrict u,
                       const struct wb_solid_point_state *before,
                       struct wb_solid_point_state *after, double *restrict force,
                       double *restrict stiffness, struct wb_hex20_result *result);

/* Cauchy stress (Pa, global frame) and equivalent plastic strain at the nodes for a converged state
 * with the histories `state`. Values at the points are extrapolated within the element; fields
 * linear in the reference position are reproduced, also on curved elements. NaN if the element is
 * inverted. */
void wb_hex20_nodal_stress(const struct wb_hex20_geometry *geometry,
                           enum wb_integration integration, const struct wb_material *material,
                           const double *restrict u, const struct wb_solid_point_state *state,
                           double stress[WB_HEX20_NODES][6], double plastic[WB_HEX20_NODES]);

/* Consistent nodal weights of a body force: integrals of the 20 shape functions over the reference
 * volume, m3. */
void wb_hex20_volume_weights(const double position[WB_HEX20_NODES][3],
                             double weight[WB_HEX20_NODES]);

/* Integrals over a flat or curved face with 8 nodes (fe/solid/solid_mesh.h): of f(position) times
 * its 8 shape functions for f = 1, y and z, the weights of section averages (m2, m3, m3); and of
 * y^2 and z^2 (m4). */
struct wb_hex20_face {
    double one[8], y[8], z[8];
    double area, yy, zz;
};
void wb_hex20_face_integrals(const double position[8][3], struct wb_hex20_face *face);

#endif
