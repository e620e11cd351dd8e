/* The stiffness of a 20-node hexahedron as one small matrix product.
 *
 * With the spatial gradients g_a and A_ijkl = c_ijkl + delta_ik tau_jl, block (a, b) is
 * K_ik = sum_points sum_j g_aj Y_ikjb, Y_ikjb = w sum_l A_ijkl g_bl. All points' (j, a) and
 * (j, ik, b) are stacked; only the six pairs i <= k are formed, the others follow by symmetry.
 */
#ifndef WB_FE_HEX20_KERNEL_H
#define WB_FE_HEX20_KERNEL_H

#include "fe/hex20.h"
#include "fe/solid_point.h"

enum {
    WB_HEX20_KERNEL_ROWS = 3 * (WB_HEX20_MOST_POINTS + WB_HEX20_CORNER_POINTS),
    WB_HEX20_KERNEL_PANELS = 3, /* of two pairs ik each */
    WB_HEX20_KERNEL_COLUMNS = 2 * WB_HEX20_NODES
};

/* Zero `rows` before the first point. */
struct wb_hex20_kernel {
    int rows;
    double g[WB_HEX20_KERNEL_ROWS][WB_HEX20_NODES];
    double y[WB_HEX20_KERNEL_PANELS][WB_HEX20_KERNEL_ROWS][WB_HEX20_KERNEL_COLUMNS];
};

/* A point of weight w (m3) with spatial gradients g (three rows: along x, y, z). At most
 * WB_HEX20_KERNEL_ROWS / 3 points. */
void wb_hex20_kernel_add(struct wb_hex20_kernel *kernel, double weight, const double *restrict g,
                         const struct wb_solid_point_response *response);

/* The 60 x 60 stiffness of all points, exactly symmetric. */
void wb_hex20_kernel_multiply(const struct wb_hex20_kernel *kernel, double *restrict stiffness);

#endif
