#include "fe/hex20.h"

#include <math.h>
#include <string.h>

#include "fe/hex20_kernel.h"
#include "fe/solid_point.h"

enum {
    NODES = WB_HEX20_NODES,
    UNKNOWNS = WB_HEX20_UNKNOWNS,
    MOST_POINTS = WB_HEX20_MOST_POINTS,
    CORNERS = WB_HEX20_CORNER_POINTS
};

static const int place[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/* What is gathered over the points of an element. */
struct sums {
    double u[3][NODES];     /* displacements relative to node 0's */
    double force[3][NODES]; /* N */
    struct wb_hex20_result result;
    double accumulated;             /* of all points, to see that they are numbers */
    struct wb_hex20_kernel *kernel; /* NULL without stiffness */
};

/* Rigid translations leave before strains are formed: they may be large against the element. */
static void take_displacements(const double *restrict u, double relative[3][NODES])
{
    for (int a = 0; a < NODES; a++) {
        for (int i = 0; i < 3; i++)
            relative[i][a] = u[3 * a + i] - u[i];
    }
}

/* `gradient` holds three rows of 20; so do others below. */
static bool find_motion(double u[3][NODES], const double *gradient,
                        struct wb_solid_point_motion *motion)
{
    double h[9];

    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double sum = 0.0;
            for (int a = 0; a < NODES; a++)
                sum += u[i][a] * gradient[j * NODES + a];
            h[3 * i + j] = sum;
        }
    }
    return wb_solid_point_motion_init(motion, h);
}

/* Adds a point's force and stiffness. */
static void add_point(struct sums *sums, const double *gradient, double weight,
                      const struct wb_solid_point_motion *motion,
                      const struct wb_solid_point_response *response)
{
    const double *along_x = gradient, *along_y = gradient + NODES, *along_z = gradient + 2 * NODES;
    double plain[3][NODES]; /* derivatives with respect to the present position */
    double(*g)[NODES] = sums->kernel ? sums->kernel->g[sums->kernel->points] : plain;

    for (int i = 0; i < 3; i++) {
        const double f[3] = {motion->inverse[0][i], motion->inverse[1][i], motion->inverse[2][i]};
        for (int a = 0; a < NODES; a++)
            g[i][a] = f[0] * along_x[a] + f[1] * along_y[a] + f[2] * along_z[a];
    }
    for (int i = 0; i < 3; i++) {
        const double t[3] = {weight * response->stress[place[i][0]],
                             weight * response->stress[place[i][1]],
                             weight * response->stress[place[i][2]]};
        for (int a = 0; a < NODES; a++)
            sums->force[i][a] += t[0] * g[0][a] + t[1] * g[1][a] + t[2] * g[2][a];
    }
    sums->result.elastic_energy += weight * response->energy;
    sums->result.smallest_jacobian = fmin(sums->result.smallest_jacobian, motion->jacobian);
    if (sums->kernel)
        wb_hex20_kernel_add(sums->kernel, weight, response);
}

static bool add_deviatoric(const struct wb_hex20_geometry *geometry, int points,
                           const struct wb_solid_point_law *law,
                           const struct wb_hex20_state *before, struct wb_hex20_state *after,
                           struct sums *sums)
{
    for (int p = 0; p < points; p++) {
        struct wb_solid_point_motion motion;
        struct wb_solid_point_response response;
        if (!find_motion(sums->u, geometry->gradient[p][0], &motion))
            return false;
        wb_solid_point_deviatoric(law, &motion, &before[p], &after[p], sums->kernel != NULL,
                                  &response);
        add_point(sums, geometry->gradient[p][0], geometry->weight[p], &motion, &response);
        sums->result.dissipated += geometry->weight[p] * response.dissipated;
        sums->result.yielding += response.yields;
        sums->accumulated += after[p].accumulated;
    }
    return true;
}

static bool add_volumetric(const struct wb_hex20_geometry *geometry,
                           const struct wb_solid_point_law *law, struct sums *sums)
{
    for (int p = 0; p < CORNERS; p++) {
        struct wb_solid_point_motion motion;
        struct wb_solid_point_response response;
        if (!find_motion(sums->u, geometry->corner_gradient[p][0], &motion))
            return false;
        wb_solid_point_volumetric(law, &motion, sums->kernel != NULL, &response);
        add_point(sums, geometry->corner_gradient[p][0], geometry->corner_weight[p], &motion,
                  &response);
    }
    return true;
}

/* A product with zero is not a number where a factor is not finite. */
static bool all_finite(const double *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += 0.0 * x[i];
    return sum == 0.0;
}

bool wb_hex20_evaluate(const struct wb_hex20_geometry *geometry,
                       enum wb_hex20_integration integration, const struct wb_material *material,
                       const double *restrict u, const struct wb_hex20_state *before,
                       struct wb_hex20_state *after, double *restrict force,
                       double *restrict stiffness, struct wb_hex20_result *result)
{
    struct wb_solid_point_law law;
    struct wb_hex20_kernel kernel;
    struct sums sums = {.kernel = stiffness ? &kernel : NULL};

    kernel.points = 0;
    sums.result.smallest_jacobian = (double)INFINITY;
    wb_solid_point_law_init(&law, material);
    take_displacements(u, sums.u);
    if (!add_deviatoric(geometry, wb_hex20_points(integration), &law, before, after, &sums) ||
        !add_volumetric(geometry, &law, &sums))
        return false;

    for (int a = 0; a < NODES; a++) {
        for (int i = 0; i < 3; i++)
            force[3 * a + i] = sums.force[i][a];
    }
    *result = sums.result;
    if (!all_finite(force, UNKNOWNS) || !isfinite(result->elastic_energy) ||
        !isfinite(result->dissipated) || !isfinite(sums.accumulated))
        return false;
    if (!stiffness)
        return true;
    wb_hex20_kernel_multiply(&kernel, stiffness);
    return all_finite(stiffness, UNKNOWNS * UNKNOWNS);
}

/* Values at the corner points (the 2 x 2 x 2 rule) go to the nodes by the trilinear function
 * through them: the share of corner point c at parent coordinates x. */
static double corner_share(int c, const double x[3])
{
    double share = 1.0;
    for (int i = 0; i < 3; i++) {
        const double sign = c >> i & 1 ? 1.0 : -1.0;
        share *= 0.5 * (1.0 + sqrt(3.0) * sign * x[i]);
    }
    return share;
}

/* Values at 27 points go to the corner points by the trilinear function nearest to them in least
 * squares, weighted as by Gauss. Triquadratic functions keep their values there; and there the
 * derivatives of quadratic elements are most accurate. */
static double point_share(int points, int p, int c)
{
    /* Along a line: w (1 + sqrt 3 sign x) / 2 at w = 5/9, 8/9, 5/9, x = -sqrt(3/5), 0, sqrt(3/5).
     */
    static const double line[3][2] = {
        {0.65045577402774279, -0.094900218472187187},
        {4.0 / 9.0, 4.0 / 9.0},
        {-0.094900218472187187, 0.65045577402774279},
    };
    if (points == CORNERS)
        return p == c;
    return line[p % 3][c & 1] * line[p / 3 % 3][c >> 1 & 1] * line[p / 9][c >> 2];
}

/* Cauchy stress and equivalent plastic strain at the corner points. */
static bool corner_values(const struct wb_hex20_geometry *geometry, int points,
                          const struct wb_material *material, const double *restrict u,
                          const struct wb_hex20_state *state, double value[CORNERS][7])
{
    struct wb_solid_point_law law;
    struct wb_solid_point_motion motion;
    struct wb_solid_point_response response;
    struct wb_hex20_state after;
    double relative[3][NODES];

    wb_solid_point_law_init(&law, material);
    take_displacements(u, relative);
    for (int c = 0; c < CORNERS; c++) {
        if (!find_motion(relative, geometry->corner_gradient[c][0], &motion))
            return false;
        wb_solid_point_volumetric(&law, &motion, false, &response);
        for (int a = 0; a < 6; a++)
            value[c][a] = response.stress[a] / motion.jacobian;
        value[c][6] = 0.0;
    }
    for (int p = 0; p < points; p++) {
        if (!find_motion(relative, geometry->gradient[p][0], &motion))
            return false;
        wb_solid_point_deviatoric(&law, &motion, &state[p], &after, false, &response);
        for (int c = 0; c < CORNERS; c++) {
            const double share = point_share(points, p, c);
            for (int a = 0; a < 6; a++)
                value[c][a] += share * response.stress[a] / motion.jacobian;
            value[c][6] += share * state[p].accumulated;
        }
    }
    return true;
}

void wb_hex20_nodal_stress(const struct wb_hex20_geometry *geometry,
                           enum wb_hex20_integration integration,
                           const struct wb_material *material, const double *restrict u,
                           const struct wb_hex20_state *state, double stress[WB_HEX20_NODES][6],
                           double plastic[WB_HEX20_NODES])
{
    double value[CORNERS][7];
    const bool good =
        corner_values(geometry, wb_hex20_points(integration), material, u, state, value);

    for (int a = 0; a < NODES; a++) {
        double sum[7] = {0.0};
        for (int c = 0; c < CORNERS; c++) {
            const double share = corner_share(c, wb_hex20_node_place[a]);
            for (int k = 0; k < 7; k++)
                sum[k] += good ? share * value[c][k] : (double)NAN;
        }
        memcpy(stress[a], sum, 6 * sizeof sum[0]);
        /* Extrapolation must not make of a strain that never decreases one below zero. */
        plastic[a] = sum[6] < 0.0 ? 0.0 : sum[6];
    }
}
