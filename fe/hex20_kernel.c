#include "fe/hex20_kernel.h"

#include <string.h>

enum {
    NODES = WB_HEX20_NODES,
    UNKNOWNS = WB_HEX20_UNKNOWNS,
    PAIRS = 6
};

/* The pairs ik in the order of the panels, and the places of components among the six. */
static const int pair_row[PAIRS] = {0, 1, 2, 0, 1, 2};
static const int pair_column[PAIRS] = {0, 1, 2, 1, 2, 0};
static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

void wb_hex20_kernel_add(struct wb_hex20_kernel *kernel, double weight, const double *restrict g,
                         const struct wb_solid_point_response *response)
{
    const int first = kernel->rows;
    memcpy(kernel->g[first], g, 3 * NODES * sizeof *g);
    kernel->rows += 3;

    for (int pair = 0; pair < PAIRS; pair++) {
        const int i = pair_row[pair], k = pair_column[pair];
        for (int j = 0; j < 3; j++) {
            double A[3];
            for (int l = 0; l < 3; l++) {
                const double geometric = i == k ? response->stress[place[j][l]] : 0.0;
                A[l] = weight * (response->tangent[place[i][j]][place[k][l]] + geometric);
            }
            double *y = &kernel->y[pair / 2][first + j][pair % 2 * NODES];
            for (int b = 0; b < NODES; b++)
                y[b] = A[0] * g[b] + A[1] * g[NODES + b] + A[2] * g[2 * NODES + b];
        }
    }
}

void wb_hex20_kernel_multiply(const struct wb_hex20_kernel *kernel, double *restrict stiffness)
{
    double(*K)[UNKNOWNS] = (double(*)[UNKNOWNS])stiffness;

    for (int panel = 0; panel < WB_HEX20_KERNEL_PANELS; panel++) {
        double block[NODES][WB_HEX20_KERNEL_COLUMNS] = {{0.0}};
        for (int a = 0; a < NODES; a++) {
            for (int row = 0; row < kernel->rows; row++) {
                const double factor = kernel->g[row][a];
                for (int column = 0; column < WB_HEX20_KERNEL_COLUMNS; column++)
                    block[a][column] += factor * kernel->y[panel][row][column];
            }
        }
        for (int half = 0; half < 2; half++) {
            const int i = pair_row[2 * panel + half], k = pair_column[2 * panel + half];
            for (int a = 0; a < NODES; a++) {
                for (int b = i == k ? a : 0; b < NODES; b++)
                    K[3 * a + i][3 * b + k] = K[3 * b + k][3 * a + i] = block[a][half * NODES + b];
            }
        }
    }
}
