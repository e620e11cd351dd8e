#include "fe/solid/hex20.h"

#include <math.h>
#include <string.h>

#include "fe/solid/hex20_kernel.h"

enum {
    NODES = WB_HEX20_NODES,
    UNKNOWNS = WB_HEX20_UNKNOWNS,
    CORNERS = WB_HEX20_CORNER_POINTS,
    FACE = 8,
    MAX_RULE = 4, /* points along a line */
    ALL_POINTS = WB_HEX20_MOST_POINTS + WB_HEX20_CORNER_POINTS
};

/* --- the reference shape: shape functions and integrals --- */

/* Gauss rules with 2, 3 and 4 points per coordinate. */
struct rule {
    int n;
    double place[MAX_RULE], weight[MAX_RULE];
};

static const struct rule two = {2, {-0.57735026918962576451, 0.57735026918962576451}, {1.0, 1.0}};
static const struct rule three = {
    3, {-0.77459666924148337704, 0.0, 0.77459666924148337704}, {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0}};
/* Exact for the volume and face integrals of any shape, whose integrands have degree 7 in each
 * parent coordinate. */
static const struct rule four = {4,
                                 {-0.86113631159405257522, -0.33998104358485626480,
                                  0.33998104358485626480, 0.86113631159405257522},
                                 {0.34785484513745385737, 0.65214515486254614263,
                                  0.65214515486254614263, 0.34785484513745385737}};

/* Parent coordinates of the nodes. */
static const double node_place[NODES][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0},
};
static const double face_place[FACE][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                           {0, -1},  {1, 0},  {0, 1}, {-1, 0}};

/* Extrapolation weights above this limit are not trusted; for a box they are at most 2.55. */
static const double large_share = 8.0;

/* Serendipity shape functions (in [3]) and their derivatives (in [0..2]) at parent coordinates
 * x. */
static void find_shapes(const double x[3], double shape[4][NODES])
{
    for (int a = 0; a < NODES; a++) {
        const double *p = node_place[a];
        double f[3], d[3]; /* factors along each coordinate, and their derivatives */
        int middle = -1;
        for (int i = 0; i < 3; i++) {
            if (p[i] == 0.0)
                middle = i;
            f[i] = p[i] == 0.0 ? 1.0 - x[i] * x[i] : 1.0 + p[i] * x[i];
            d[i] = p[i] == 0.0 ? -2.0 * x[i] : p[i];
        }
        const double scale = middle >= 0 ? 0.25 : 0.125;
        /* Corner functions have the additional factor p . x - 2. */
        const double sum = middle >= 0 ? 1.0 : p[0] * x[0] + p[1] * x[1] + p[2] * x[2] - 2.0;
        for (int i = 0; i < 3; i++) {
            const double others = f[(i + 1) % 3] * f[(i + 2) % 3];
            const double rest = middle >= 0 ? 0.0 : f[i] * others * p[i];
            shape[i][a] = scale * (d[i] * others * sum + rest);
        }
        shape[3][a] = scale * f[0] * f[1] * f[2] * sum;
    }
}

/* Shape functions at parent coordinates x, position relative to node 0, so that no digits are lost
 * far from the origin, and the Jacobian dX_j / dx_i. */
static void find_place(const double x[3], const double position[NODES][3], double shape[4][NODES],
                       double place[3], double jacobian[3][3])
{
    find_shapes(x, shape);
    memset(place, 0, 3 * sizeof *place);
    memset(jacobian, 0, 3 * sizeof *jacobian);
    for (int a = 1; a < NODES; a++) {
        for (int j = 0; j < 3; j++) {
            const double away = position[a][j] - position[0][j];
            place[j] += shape[3][a] * away;
            for (int i = 0; i < 3; i++)
                jacobian[i][j] += shape[i][a] * away;
        }
    }
}

/* The Jacobian's determinant at x; `gradient` (3 x 20, 1/m) may be NULL. */
static double find_gradient(const double x[3], const double position[NODES][3],
                            double shape[4][NODES], double gradient[3][NODES])
{
    double place[3], jacobian[3][3], cofactor[3][3];

    find_place(x, position, shape, place, jacobian);
    const double determinant = wb_solid_point_cofactors((const double(*)[3])jacobian, cofactor);
    for (int j = 0; gradient && j < 3; j++) {
        for (int a = 0; a < NODES; a++) {
            gradient[j][a] = (cofactor[0][j] * shape[0][a] + cofactor[1][j] * shape[1][a] +
                              cofactor[2][j] * shape[2][a]) /
                             determinant;
        }
    }
    return determinant;
}

/* Gradients and weights at the points of a rule. */
static bool fill_points(const struct rule *rule, const double position[NODES][3],
                        double gradient[][3][NODES], double *weight)
{
    double shape[4][NODES];
    int point = 0;

    for (int k = 0; k < rule->n; k++) {
        for (int j = 0; j < rule->n; j++) {
            for (int i = 0; i < rule->n; i++, point++) {
                const double x[3] = {rule->place[i], rule->place[j], rule->place[k]};
                const double parent = rule->weight[i] * rule->weight[j] * rule->weight[k];
                const double determinant = find_gradient(x, position, shape, gradient[point]);
                weight[point] = parent * determinant;
                if (!(weight[point] > 0.0) || !isfinite(weight[point]))
                    return false;
            }
        }
    }
    return true;
}

/* The eight functions 1, x, y, z, xy, yz, zx, xyz. */
static void find_trilinear(const double x[3], double value[CORNERS])
{
    const double all[CORNERS] = {1.0,         x[0],        x[1],        x[2],
                                 x[0] * x[1], x[1] * x[2], x[2] * x[0], x[0] * x[1] * x[2]};
    memcpy(value, all, sizeof all);
}

/* Replaces the rows b by A^-1 b; false if A is singular. */
static bool solve_corners(double A[CORNERS][CORNERS], double b[CORNERS][NODES])
{
    for (int k = 0; k < CORNERS; k++) {
        int best = k;
        for (int r = k + 1; r < CORNERS; r++) {
            if (fabs(A[r][k]) > fabs(A[best][k]))
                best = r;
        }
        if (!(fabs(A[best][k]) > 0.0))
            return false;
        for (int c = 0; c < CORNERS; c++) {
            const double kept = A[k][c];
            A[k][c] = A[best][c];
            A[best][c] = kept;
        }
        for (int a = 0; a < NODES; a++) {
            const double kept = b[k][a];
            b[k][a] = b[best][a];
            b[best][a] = kept;
        }
        for (int r = 0; r < CORNERS; r++) {
            const double factor = r == k ? 0.0 : A[r][k] / A[k][k];
            for (int c = k; factor != 0.0 && c < CORNERS; c++)
                A[r][c] -= factor * A[k][c];
            for (int a = 0; factor != 0.0 && a < NODES; a++)
                b[r][a] -= factor * b[k][a];
        }
    }
    for (int k = 0; k < CORNERS; k++) {
        for (int a = 0; a < NODES; a++)
            b[k][a] /= A[k][k];
    }
    return true;
}

/* Extrapolation weights from corner points to nodes: trilinear functions of the affine coordinates
 * at the centre, so that fields linear in X are reproduced on elements with curved edges. False if
 * the element is so distorted that the weights exceed large_share. */
static bool find_affine_shares(const double position[NODES][3], double share[NODES][CORNERS])
{
    double shape[4][NODES], centre[3], at[3], jacobian[3][3], unused[3][3], cofactor[3][3];
    double A[CORNERS][CORNERS], b[CORNERS][NODES]; /* function x point, function x node */

    find_place((const double[3]){0.0}, position, shape, centre, jacobian);
    const double determinant = wb_solid_point_cofactors((const double(*)[3])jacobian, cofactor);
    for (int k = 0; k < CORNERS + NODES; k++) {
        const int a = k - CORNERS;
        double x[3], affine[3] = {0.0}, value[CORNERS];
        for (int i = 0; i < 3; i++)
            x[i] = k < CORNERS ? two.place[k >> i & 1] : node_place[a][i];
        find_place(x, position, shape, at, unused);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++)
                affine[i] += (at[j] - centre[j]) * cofactor[i][j] / determinant;
        }
        find_trilinear(affine, value);
        for (int m = 0; m < CORNERS; m++)
            *(k < CORNERS ? &A[m][k] : &b[m][a]) = value[m];
    }
    if (!solve_corners(A, b))
        return false;
    for (int a = 0; a < NODES; a++) {
        for (int c = 0; c < CORNERS; c++) {
            share[a][c] = b[c][a];
            if (!(fabs(share[a][c]) <= large_share))
                return false;
        }
    }
    return true;
}

/* The same with trilinear functions of parent coordinates, which exist for any shape. */
static void find_parent_shares(double share[NODES][CORNERS])
{
    for (int a = 0; a < NODES; a++) {
        for (int c = 0; c < CORNERS; c++) {
            share[a][c] = 1.0;
            for (int i = 0; i < 3; i++) {
                const double sign = c >> i & 1 ? 1.0 : -1.0;
                share[a][c] *= 0.5 * (1.0 + sqrt(3.0) * sign * node_place[a][i]);
            }
        }
    }
}

int wb_hex20_points(enum wb_integration integration)
{
    return integration == WB_INTEGRATION_SELECTIVE ? WB_HEX20_MOST_POINTS : WB_HEX20_CORNER_POINTS;
}

bool wb_hex20_geometry_init(struct wb_hex20_geometry *geometry, enum wb_integration integration,
                            const double position[NODES][3])
{
    const struct rule *rule = integration == WB_INTEGRATION_SELECTIVE ? &three : &two;

    memset(geometry, 0, sizeof *geometry);
    if (!fill_points(rule, position, geometry->gradient, geometry->weight) ||
        !fill_points(&two, position, geometry->corner_gradient, geometry->corner_weight))
        return false;
    for (int p = 0; p < wb_hex20_points(integration); p++)
        geometry->volume += geometry->weight[p];
    if (!find_affine_shares(position, geometry->nodal_share))
        find_parent_shares(geometry->nodal_share);
    return true;
}

void wb_hex20_volume_weights(const double position[NODES][3], double weight[NODES])
{
    double shape[4][NODES];

    for (int a = 0; a < NODES; a++)
        weight[a] = 0.0;
    for (int k = 0; k < four.n; k++) {
        for (int j = 0; j < four.n; j++) {
            for (int i = 0; i < four.n; i++) {
                const double x[3] = {four.place[i], four.place[j], four.place[k]};
                const double parent = four.weight[i] * four.weight[j] * four.weight[k];
                const double volume = parent * find_gradient(x, position, shape, NULL);
                for (int a = 0; a < NODES; a++)
                    weight[a] += volume * shape[3][a];
            }
        }
    }
}

/* Serendipity shape functions (in [2]) and derivatives of a face. */
static void find_face_shapes(const double x[2], double shape[3][FACE])
{
    for (int a = 0; a < FACE; a++) {
        const double *p = face_place[a];
        double f[2], d[2];
        bool corner = true;
        for (int i = 0; i < 2; i++) {
            corner = corner && p[i] != 0.0;
            f[i] = p[i] == 0.0 ? 1.0 - x[i] * x[i] : 1.0 + p[i] * x[i];
            d[i] = p[i] == 0.0 ? -2.0 * x[i] : p[i];
        }
        const double scale = corner ? 0.25 : 0.5;
        const double sum = corner ? p[0] * x[0] + p[1] * x[1] - 1.0 : 1.0;
        for (int i = 0; i < 2; i++) {
            const double rest = corner ? f[0] * f[1] * p[i] : 0.0;
            shape[i][a] = scale * (d[i] * f[1 - i] * sum + rest);
        }
        shape[2][a] = scale * f[0] * f[1] * sum;
    }
}

void wb_hex20_face_integrals(const double position[FACE][3], struct wb_hex20_face *face)
{
    memset(face, 0, sizeof *face);
    for (int j = 0; j < four.n; j++) {
        for (int i = 0; i < four.n; i++) {
            const double x[2] = {four.place[i], four.place[j]};
            double shape[3][FACE], at[3] = {0.0}, along[2][3] = {{0.0}};
            find_face_shapes(x, shape);
            for (int a = 0; a < FACE; a++) {
                for (int k = 0; k < 3; k++) {
                    at[k] += shape[2][a] * position[a][k];
                    along[0][k] += shape[0][a] * position[a][k];
                    along[1][k] += shape[1][a] * position[a][k];
                }
            }
            double square = 0.0;
            for (int k = 0; k < 3; k++) {
                const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
                const double n = along[0][k1] * along[1][k2] - along[0][k2] * along[1][k1];
                square += n * n;
            }
            const double area = four.weight[i] * four.weight[j] * sqrt(square);
            for (int a = 0; a < FACE; a++) {
                face->one[a] += area * shape[2][a];
                face->y[a] += area * at[1] * shape[2][a];
                face->z[a] += area * at[2] * shape[2][a];
            }
            face->area += area;
            face->yy += area * at[1] * at[1];
            face->zz += area * at[2] * at[2];
        }
    }
}

/* --- evaluation --- */

/* The points of an element during evaluation: deviatoric points, then volumetric points if they
 * differ. */
struct points {
    int n, n_deviatoric;
    struct wb_solid_point_motion motion[ALL_POINTS];
    struct wb_hex20_points_load load[ALL_POINTS];
    struct wb_hex20_kernel kernel;
};

/* Computes the motions of all points; false if J <= 0 at a point. */
static bool find_motions(struct points *points, const struct wb_hex20_geometry *geometry,
                         enum wb_integration integration, const double *restrict u)
{
    double relative[3][NODES], h[ALL_POINTS][9];
    const int n = wb_hex20_points(integration);

    /* Subtract the displacement of node 0: rigid translations may be large compared with the
     * element. */
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

/* Passes the response of point p on to forces and stiffness. */
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
                    const struct wb_material *material, const struct wb_solid_point_state *before,
                    struct wb_solid_point_state *after, bool tangent,
                    struct wb_hex20_result *result)
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

/* Checks all values, because a product of zero and a non-finite value is NaN. */
static bool all_finite(const double *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += 0.0 * x[i];
    return sum == 0.0;
}

bool wb_hex20_evaluate(const struct wb_hex20_geometry *geometry, enum wb_integration integration,
                       const struct wb_material *material, const double *restrict u,
                       const struct wb_solid_point_state *before,
                       struct wb_solid_point_state *after, double *restrict force,
                       double *restrict stiffness, struct wb_hex20_result *result)
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

/* Share of point p's value in corner point c. Values at 27 points are projected to the corner
 * points by the trilinear function that fits them best in the least-squares sense with Gauss
 * weights. Triquadratic functions keep their values at the corner points, where derivatives of
 * quadratic elements are most accurate. */
static double point_share(int points, int p, int c)
{
    /* Along a line: w (1 + sqrt 3 sign x) / 2 for w = 5/9, 8/9, 5/9 and x = -sqrt(3/5), 0,
     * sqrt(3/5). */
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
                               const struct wb_solid_point_state *state, double value[CORNERS][7])
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
        struct wb_solid_point_state after;
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
                           const double *restrict u, const struct wb_solid_point_state *state,
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
        /* Extrapolation must not make the equivalent plastic strain negative. */
        plastic[a] = sum[6] < 0.0 ? 0.0 : sum[6];
    }
}
