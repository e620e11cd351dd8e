/* The stiffness of a 20-node hexahedron as one small matrix product.
 *
 * With the spatial gradients g_a and A_ijkl = w (c_ijkl + delta_ik tau_jl), block (a, b) is K_ik =
 * sum_points sum_j g_aj Y_ikjb, Y_ikjb = sum_l A_ijkl g_bl. The (j, a) and (j, ik, b) of all points
 * are stacked; only six of the nine pairs ik are computed, the others follow by symmetry. This is
 * half the arithmetic of B^T c B, as a matrix product that processors compute fast.
 */
#ifndef WB_FE_SOLID_HEX20_KERNEL_H
#define WB_FE_SOLID_HEX20_KERNEL_H

#include "fe/solid/hex20_points.h"
#include "fe/solid/solid_point.h"

enum {
    WB_HEX20_KERNEL_POINTS = WB_HEX20_MOST_POINTS + WB_HEX20_CORNER_POINTS,
    WB_HEX20_KERNEL_PAIRS = 6
};

/* Set `points` to 0 before the first point. */
struct wb_hex20_kernel {
    int points;
    double g[WB_HEX20_KERNEL_POINTS][3][WB_HEX20_NODES];
    double A[WB_HEX20_KERNEL_POINTS][WB_HEX20_KERNEL_PAIRS][3][3]; /* N m: [ik][j][l] */
};

/* Adds a point of weight w (m3). The caller has stored its spatial gradients (three rows: along x,
 * y, z) in kernel->g[kernel->points]. At most WB_HEX20_KERNEL_POINTS points. */
void wb_hex20_kernel_add(struct wb_hex20_kernel *kernel, double weight,
                         const struct wb_solid_point_response *response);

/* Computes the 60 x 60 stiffness of all points, exactly symmetric, with the fastest instructions
 * that the processor has. */
void wb_hex20_kernel_multiply(const struct wb_hex20_kernel *kernel, double *restrict stiffness);

#endif
