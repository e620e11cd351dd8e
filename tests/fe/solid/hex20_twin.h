/* The slow twin of fe/solid/hex20.c: point by point, B^T c B with a full B, and the geometric term.
 * Material points are compared with their own slow twin in test_solid_point.c. */
#ifndef WB_TESTS_FE_SOLID_HEX20_TWIN_H
#define WB_TESTS_FE_SOLID_HEX20_TWIN_H

#include <string.h>

#include "fe/solid/hex20.h"
#include "fe/solid/solid_point.h"

/* Spatial gradients g[a][i] of the shape functions, and the 6 x 60 matrix of 2 d (shear) and d. */
static void twin_strains(const struct wb_solid_point_motion *motion, const double *gradient,
                         double g[20][3], double B[6][60])
{
    static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
    memset(B, 0, 360 * sizeof B[0][0]);
    for (int a = 0; a < 20; a++) {
        for (int i = 0; i < 3; i++) {
            g[a][i] = 0.0;
            for (int j = 0; j < 3; j++)
                g[a][i] += motion->inverse[j][i] * gradient[20 * j + a];
        }
        for (int k = 0; k < 6; k++) {
            const int i = row[k], j = column[k];
            B[k][3 * a + i] += g[a][j];
            if (k >= 3)
                B[k][3 * a + j] += g[a][i];
        }
    }
}

static void twin_add(const struct wb_solid_point_motion *motion, const double *gradient,
                     double weight, const struct wb_solid_point_response *response, double *force,
                     double *stiffness)
{
    static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    double g[20][3], B[6][60];

    twin_strains(motion, gradient, g, B);
    for (int p = 0; p < 60; p++) {
        for (int k = 0; k < 6; k++)
            force[p] += weight * B[k][p] * response->stress[k];
    }
    for (int p = 0; p < 60; p++) {
        double row[6] = {0.0};
        for (int k = 0; k < 6; k++) {
            for (int l = 0; l < 6; l++)
                row[l] += B[k][p] * response->tangent[k][l];
        }
        for (int q = 0; q < 60; q++) {
            double sum = 0.0;
            for (int l = 0; l < 6; l++)
                sum += row[l] * B[l][q];
            for (int k = 0; p % 3 == q % 3 && k < 9; k++)
                sum += g[p / 3][k / 3] * response->stress[place[k / 3][k % 3]] * g[q / 3][k % 3];
            stiffness[60 * p + q] += weight * sum;
        }
    }
}

static bool twin_motion(const double *u, const double *gradient,
                        struct wb_solid_point_motion *motion)
{
    double h[9] = {0.0};
    for (int a = 0; a < 20; a++) {
        for (int k = 0; k < 9; k++)
            h[k] += u[3 * a + k / 3] * gradient[20 * (k % 3) + a];
    }
    return wb_solid_point_motion_init(motion, h);
}

/* As wb_hex20_evaluate(), always with stiffness. With `full` the volumetric part is integrated at
 * the deviatoric points: an element that locks. */
static inline bool twin_evaluate(const struct wb_hex20_geometry *geometry, int points, bool full,
                                 const struct wb_material *material, const double *u,
                                 const struct wb_solid_point_state *before,
                                 struct wb_solid_point_state *after, double *force,
                                 double *stiffness)
{
    struct wb_solid_point_law law;
    struct wb_solid_point_motion motion;
    struct wb_solid_point_response response;
    const int corners = full ? points : WB_HEX20_CORNER_POINTS;

    wb_solid_point_law_init(&law, material);
    memset(force, 0, 60 * sizeof *force);
    memset(stiffness, 0, 3600 * sizeof *stiffness);
    for (int p = 0; p < points; p++) {
        if (!twin_motion(u, geometry->gradient[p][0], &motion))
            return false;
        wb_solid_point_diagonalise(&motion, 1);
        wb_solid_point_deviatoric(&law, &motion, &before[p], &after[p], true, &response);
        twin_add(&motion, geometry->gradient[p][0], geometry->weight[p], &response, force,
                 stiffness);
    }
    for (int p = 0; p < corners; p++) {
        const double *gradient = full ? geometry->gradient[p][0] : geometry->corner_gradient[p][0];
        const double weight = full ? geometry->weight[p] : geometry->corner_weight[p];
        if (!twin_motion(u, gradient, &motion))
            return false;
        memset(&response, 0, sizeof response);
        wb_solid_point_add_volumetric(&law, &motion, true, &response);
        twin_add(&motion, gradient, weight, &response, force, stiffness);
    }
    return true;
}

#endif
