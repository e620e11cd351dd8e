/* Shape functions and integrals of fe/hex20.h over the reference shape. */
#include <math.h>
#include <string.h>

#include "fe/hex20.h"

enum {
    NODES = WB_HEX20_NODES,
    FACE = 8,
    MOST_RULE = 4
};

/* Gauss' rules of 2, 3 and 4 points. */
struct rule {
    int n;
    double place[MOST_RULE], weight[MOST_RULE];
};

static const struct rule two = {2, {-0.57735026918962576451, 0.57735026918962576451}, {1.0, 1.0}};
static const struct rule three = {
    3, {-0.77459666924148337704, 0.0, 0.77459666924148337704}, {5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0}};
/* Exact for the volume and face integrals of any shape: their integrands are of degree 7 along each
 * parent coordinate. */
static const struct rule four = {4,
                                 {-0.86113631159405257522, -0.33998104358485626480,
                                  0.33998104358485626480, 0.86113631159405257522},
                                 {0.34785484513745385737, 0.65214515486254614263,
                                  0.65214515486254614263, 0.34785484513745385737}};

const double wb_hex20_node_place[NODES][3] = {
    {-1, -1, -1}, {1, -1, -1}, {1, 1, -1},  {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1},
    {-1, 1, 1},   {0, -1, -1}, {1, 0, -1},  {0, 1, -1},  {-1, 0, -1}, {0, -1, 1}, {1, 0, 1},
    {0, 1, 1},    {-1, 0, 1},  {-1, -1, 0}, {1, -1, 0},  {1, 1, 0},   {-1, 1, 0},
};
static const double face_place[FACE][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                           {0, -1},  {1, 0},  {0, 1}, {-1, 0}};

/* Serendipity shape functions and derivatives (at [3], [0..2]) at parent coordinates x. */
static void find_shapes(const double x[3], double shape[4][NODES])
{
    for (int a = 0; a < NODES; a++) {
        const double *p = wb_hex20_node_place[a];
        double f[3], d[3]; /* factors along each coordinate, and their slopes */
        int middle = -1;
        for (int i = 0; i < 3; i++) {
            if (p[i] == 0.0)
                middle = i;
            f[i] = p[i] == 0.0 ? 1.0 - x[i] * x[i] : 1.0 + p[i] * x[i];
            d[i] = p[i] == 0.0 ? -2.0 * x[i] : p[i];
        }
        const double scale = middle >= 0 ? 0.25 : 0.125;
        /* At corners a further factor, p . x - 2. */
        const double sum = middle >= 0 ? 1.0 : p[0] * x[0] + p[1] * x[1] + p[2] * x[2] - 2.0;
        for (int i = 0; i < 3; i++) {
            const double others = f[(i + 1) % 3] * f[(i + 2) % 3];
            const double rest = middle >= 0 ? 0.0 : f[i] * others * p[i];
            shape[i][a] = scale * (d[i] * others * sum + rest);
        }
        shape[3][a] = scale * f[0] * f[1] * f[2] * sum;
    }
}

/* The Jacobian's determinant at x; gradient (3 x 20, per metre) unless NULL. */
static double find_gradient(const double x[3], const double position[NODES][3],
                            double shape[4][NODES], double gradient[3][NODES])
{
    double jacobian[3][3] = {{0.0}}, cofactor[3][3]; /* dX_j / dx_i */

    find_shapes(x, shape);
    for (int a = 1; a < NODES; a++) {
        for (int i = 0; i < 3; i++) {
            /* Relative to node 0: far from the origin, too, the digits are those of the shape. */
            for (int j = 0; j < 3; j++)
                jacobian[i][j] += shape[i][a] * (position[a][j] - position[0][j]);
        }
    }
    for (int i = 0; i < 3; i++) {
        const double *u = jacobian[(i + 1) % 3], *v = jacobian[(i + 2) % 3];
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = u[j1] * v[j2] - u[j2] * v[j1];
        }
    }
    const double determinant = jacobian[0][0] * cofactor[0][0] + jacobian[0][1] * cofactor[0][1] +
                               jacobian[0][2] * cofactor[0][2];
    if (!gradient)
        return determinant;
    for (int j = 0; j < 3; j++) {
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

int wb_hex20_points(enum wb_hex20_integration integration)
{
    return integration == WB_HEX20_SELECTIVE ? WB_HEX20_MOST_POINTS : WB_HEX20_CORNER_POINTS;
}

bool wb_hex20_geometry_init(struct wb_hex20_geometry *geometry,
                            enum wb_hex20_integration integration, const double position[NODES][3])
{
    const struct rule *rule = integration == WB_HEX20_SELECTIVE ? &three : &two;

    memset(geometry, 0, sizeof *geometry);
    if (!fill_points(rule, position, geometry->gradient, geometry->weight) ||
        !fill_points(&two, position, geometry->corner_gradient, geometry->corner_weight))
        return false;
    for (int p = 0; p < wb_hex20_points(integration); p++)
        geometry->volume += geometry->weight[p];
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

/* Serendipity shape functions (at [2]) and derivatives of a face. */
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
