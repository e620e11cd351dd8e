#include "fe/solid/hex20.h"

#include <math.h>
#include <string.h>

#include "fe/solid/hex20_kernel.h"
#include "fe/solid/hex20_points.h"
#include "fe/solid/solid_point.h"

enum {
    NODES = WB_HEX20_NODES,
    UNKNOWNS = WB_HEX20_UNKNOWNS,
    CORNERS = WB_HEX20_CORNER_POINTS,
    ALL_POINTS = WB_HEX20_MOST_POINTS + WB_HEX20_CORNER_POINTS
};

/* Of an element under evaluation: the deviatoric points, then the volumetric ones where those are
 * others. */
struct points {
    int n, n_deviatoric;
    struct wb_solid_point_motion motion[ALL_POINTS];
    struct wb_hex20_points_load load[ALL_POINTS];
    struct wb_hex20_kernel kernel;
};

/* Motions of all points; false when J <= 0 at one. */
static bool find_motions(struct points *points, const struct wb_hex20_geometry *geometry,
                         enum wb_integration integration, const double *restrict u)
{
    double relative[3][NODES], h[ALL_POINTS][9];
    const int n = wb_hex20_points(integration);

    /* Rigid translations leave before strains are formed: they may be large against the element. */
    for (int a = 0; a < NODES; a++) {
        for (int i = 0; i < 3; i++)
            relative[i][a] = u[3 * a + i] - u[i];
    }
    points->n = points->n_deviatoric = n;
    wb_hex20_points_gradients(n, geometry->gradient[0][0], relative[0], h[0]);
    if (integration == WB_INTEGRATION_SELECTIVE) {
        wb_hex20_points_gradients(CORNERS, geometry->corner_gradient[0][0], relative[0], h[n]);
        points->n += CORNERS;
    }
    for (int p = 0; p < points->n; p++) {
        if (!wb_solid_point_motion_init(&points->motion[p], h[p]))
            return false;
    }
    wb_solid_point_diagonalise(points->motion, n);
    return true;
}

/* Hands on what point p answers. */
static void take_response(struct points *points, int p, double weight, bool tangent,
                          const struct wb_solid_point_response *response,
                          struct wb_hex20_result *result)
{
    struct wb_hex20_points_load *load = &points->load[p];

    memcpy(load->inverse, points->motion[p].inverse, sizeof load->inverse);
    for (int a = 0; a < 6; a++)
        load->stress[a] = weight * response->stress[a];
    if (tangent)
        wb_hex20_kernel_add(&points->kernel, weight, response);
    result->elastic_energy += weight * response->energy;
    result->dissipated += weight * response->dissipated;
    result->smallest_jacobian = fmin(result->smallest_jacobian, points->motion[p].jacobian);
    result->yielding += response->yields;
}

/* Stresses, histories and tangents at all points. */
static void respond(struct points *points, const struct wb_hex20_geometry *geometry,
                    const struct wb_material *material, const struct wb_hex20_state *before,
                    struct wb_hex20_state *after, bool tangent, struct wb_hex20_result *result)
{
    struct wb_solid_point_law law;
    struct wb_solid_point_response response;
    const int n = points->n_deviatoric;

    wb_solid_point_law_init(&law, material);
    *result = (struct wb_hex20_result){.smallest_jacobian = (double)INFINITY};
    points->kernel.points = 0;
    for (int p = 0; p < n; p++) {
        const struct wb_solid_point_motion *motion = &points->motion[p];
        wb_solid_point_deviatoric(&law, motion, &before[p], &after[p], tangent, &response);
        if (points->n == n)
            wb_solid_point_add_volumetric(&law, motion, tangent, &response);
        take_response(points, p, geometry->weight[p], tangent, &response, result);
    }
    for (int p = n; p < points->n; p++) {
        memset(&response, 0, sizeof response);
        wb_solid_point_add_volumetric(&law, &points->motion[p], tangent, &response);
        take_response(points, p, geometry->corner_weight[p - n], tangent, &response, result);
    }
}

/* A product with zero is not a number where a factor is not finite. */
static bool all_finite(const double *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += 0.0 * x[i];
    return sum == 0.0;
}

bool wb_hex20_evaluate(const struct wb_hex20_geometry *geometry, enum wb_integration integration,
                       const struct wb_material *material, const double *restrict u,
                       const struct wb_hex20_state *before, struct wb_hex20_state *after,
                       double *restrict force, double *restrict stiffness,
                       struct wb_hex20_result *result)
{
    struct points points;
    double rows[3][NODES] = {{0.0}}, accumulated = 0.0;

    if (!find_motions(&points, geometry, integration, u))
        return false;
    const int n = points.n_deviatoric;
    respond(&points, geometry, material, before, after, stiffness != NULL, result);
    wb_hex20_points_forces(n, geometry->gradient[0][0], points.load, points.kernel.g[0][0],
                           rows[0]);
    wb_hex20_points_forces(points.n - n, geometry->corner_gradient[0][0], &points.load[n],
                           points.kernel.g[n][0], rows[0]);
    for (int a = 0; a < NODES; a++) {
        for (int i = 0; i < 3; i++)
            force[3 * a + i] = rows[i][a];
    }
    for (int p = 0; p < n; p++)
        accumulated += after[p].accumulated;
    if (!all_finite(force, UNKNOWNS) || !isfinite(result->elastic_energy) ||
        !isfinite(result->dissipated) || !isfinite(accumulated))
        return false;
    if (!stiffness)
        return true;
    wb_hex20_kernel_multiply(&points.kernel, stiffness);
    return all_finite(stiffness, UNKNOWNS * UNKNOWNS);
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
static void find_corner_values(const struct points *points, const struct wb_material *material,
                               const struct wb_hex20_state *state, double value[CORNERS][7])
{
    struct wb_solid_point_law law;
    const int n = points->n_deviatoric;

    wb_solid_point_law_init(&law, material);
    for (int c = 0; c < CORNERS; c++) {
        const struct wb_solid_point_motion *motion = &points->motion[points->n - CORNERS + c];
        struct wb_solid_point_response response = {{0.0}};
        wb_solid_point_add_volumetric(&law, motion, false, &response);
        for (int a = 0; a < 6; a++)
            value[c][a] = response.stress[a] / motion->jacobian;
        value[c][6] = 0.0;
    }
    for (int p = 0; p < n; p++) {
        const struct wb_solid_point_motion *motion = &points->motion[p];
        struct wb_solid_point_response response;
        struct wb_hex20_state after;
        wb_solid_point_deviatoric(&law, motion, &state[p], &after, false, &response);
        for (int c = 0; c < CORNERS; c++) {
            const double share = point_share(n, p, c);
            for (int a = 0; a < 6; a++)
                value[c][a] += share * response.stress[a] / motion->jacobian;
            value[c][6] += share * state[p].accumulated;
        }
    }
}

void wb_hex20_nodal_stress(const struct wb_hex20_geometry *geometry,
                           enum wb_integration integration, const struct wb_material *material,
                           const double *restrict u, const struct wb_hex20_state *state,
                           double stress[WB_HEX20_NODES][6], double plastic[WB_HEX20_NODES])
{
    struct points points;
    double value[CORNERS][7];
    const bool good = find_motions(&points, geometry, integration, u);

    if (good)
        find_corner_values(&points, material, state, value);

    for (int a = 0; a < NODES; a++) {
        double sum[7] = {0.0};
        for (int c = 0; c < CORNERS; c++) {
            const double share = geometry->nodal_share[a][c];
            for (int k = 0; k < 7; k++)
                sum[k] += good ? share * value[c][k] : (double)NAN;
        }
        memcpy(stress[a], sum, 6 * sizeof sum[0]);
        /* Extrapolation must not make of a strain that never decreases one below zero. */
        plastic[a] = sum[6] < 0.0 ? 0.0 : sum[6];
    }
}
