/* Elements, displacements and materials for tests and the benchmark of fe/solid/hex20.c. */
#ifndef WB_TESTS_FE_SOLID_HEX20_CASES_H
#define WB_TESTS_FE_SOLID_HEX20_CASES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fe/solid/hex20.h"

/* Parent coordinates of the nodes, in the order of fe/solid/solid_mesh.h. */
static const double test_node_place[20][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0},
};

static inline double random_number(void) /* -1 to 1 */
{
    return 2.0 * rand() / RAND_MAX - 1.0;
}

/* A box of 2 x 3 x 1 mm whose nodes are moved by up to `distortion` of it. */
static inline void make_nodes(double distortion, double position[20][3])
{
    static const double size[3] = {2e-3, 3e-3, 1e-3};
    for (int a = 0; a < 20; a++) {
        for (int i = 0; i < 3; i++) {
            const double place = test_node_place[a][i] + distortion * random_number();
            position[a][i] = 0.5 * size[i] * place;
        }
    }
}

/* u = (R A - I) X + a random part of amplitude `wild` (m), R a rotation by `angle` about (1,1,1)
 * and A the identity plus `strain` times random numbers. */
static inline void make_displacement(double position[20][3], double angle, double strain,
                                     double wild, double *u)
{
    double A[3][3], R[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            A[i][j] = (i == j) + strain * random_number();
            R[i][j] = (i == j ? cos(angle) : 0.0) + (1.0 - cos(angle)) / 3.0 +
                      (i == j ? 0.0 : (j == (i + 1) % 3 ? -1.0 : 1.0) * sin(angle) / sqrt(3.0));
        }
    }
    for (int a = 0; a < 20; a++) {
        double moved[3] = {0.0};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                moved[i] += A[i][j] * position[a][j];
        }
        for (int i = 0; i < 3; i++) {
            u[3 * a + i] = wild * random_number() - position[a][i];
            for (int j = 0; j < 3; j++)
                u[3 * a + i] += R[i][j] * moved[j];
        }
    }
}

static inline bool make_geometry(struct wb_hex20_geometry *geometry,
                                 enum wb_integration integration, double position[20][3])
{
    return wb_hex20_geometry_init(geometry, integration, (const double(*)[3])position);
}

#endif
