/* Sums over the nodes of a 20-node hexahedron at its integration points, with the widest vectors
 * that the processor has. Products and sums are not contracted, so that all processors give
 * identical bits. */
#ifndef WB_FE_SOLID_HEX20_POINTS_H
#define WB_FE_SOLID_HEX20_POINTS_H

enum {
    WB_HEX20_NODES = 20,
    WB_HEX20_UNKNOWNS = 60,
    WB_HEX20_MOST_POINTS = 27,
    WB_HEX20_CORNER_POINTS = 8 /* 2 x 2 x 2 */
};

/* Contribution of a point to the forces. */
struct wb_hex20_points_load {
    double inverse[3][3]; /* dX_J / dx_i at [J][i] */
    double stress[6];     /* Kirchhoff stress times the point's weight, N m */
};

/* Displacement gradients du_i/dX_J at n points, 9 values each (row by row), of displacements u
 * (three rows of 20: along x, y and z); `gradient` as in struct wb_hex20_geometry. */
void wb_hex20_points_gradients(int n, const double *restrict gradient, const double *restrict u,
                               double *restrict h);

/* Spatial gradients of the shape functions at n points (three rows of 20 each). Their forces (three
 * rows of 20) are added to `force`. */
void wb_hex20_points_forces(int n, const double *restrict gradient,
                            const struct wb_hex20_points_load *restrict load,
                            double *restrict spatial, double *restrict force);

#endif
