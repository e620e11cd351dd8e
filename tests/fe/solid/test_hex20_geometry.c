#include "tests/check.h"
#include "tests/fe/solid/hex20_cases.h"

static const enum wb_integration integrations[] = {WB_INTEGRATION_SELECTIVE,
                                                   WB_INTEGRATION_REDUCED};

/* The shape functions span 20 monomials, whose derivatives must be exact. */
static void gradients_are_those_of_the_serendipity_functions(void **unused)
{
    (void)unused;
    static const int powers[20][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0},
                                      {0, 2, 0}, {0, 0, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1},
                                      {2, 1, 0}, {2, 0, 1}, {1, 2, 0}, {0, 2, 1}, {1, 0, 2},
                                      {0, 1, 2}, {1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}};
    static const double gauss[2][3] = {{-0.7745966692414834, 0.0, 0.7745966692414834},
                                       {-0.5773502691896258, 0.5773502691896258, 0.0}};
    double position[20][3];
    for (int a = 0; a < 20; a++)
        memcpy(position[a], test_node_place[a], sizeof position[a]);

    for (int rule = 0; rule < 2; rule++) {
        const int n = 3 - rule;
        struct wb_hex20_geometry geometry;
        assert_true(make_geometry(&geometry, integrations[rule], position));
        assert_int_equal(wb_hex20_points(integrations[rule]), n * n * n);
        assert_close(geometry.volume, 8.0, 1e-13);
        for (int p = 0; p < n * n * n; p++) {
            const double x[3] = {gauss[rule][p % n], gauss[rule][p / n % n],
                                 gauss[rule][p / n / n]};
            for (int m = 0; m < 20; m++) {
                for (int j = 0; j < 3; j++) {
                    double expected = powers[m][j], sum = 0.0;
                    for (int i = 0; i < 3 && expected != 0.0; i++)
                        expected *= pow(x[i], powers[m][i] - (i == j));
                    for (int a = 0; a < 20; a++) {
                        double value = 1.0;
                        for (int i = 0; i < 3; i++)
                            value *= pow(position[a][i], powers[m][i]);
                        sum += geometry.gradient[p][j][a] * value;
                    }
                    assert_close(sum, expected, 1e-14);
                }
            }
        }
    }
}

/* A box 2 long, 1 high and 3 wide with a parabolic roof, 1 + b (1 - x^2) high. */
static void make_vault(double b, double position[20][3])
{
    for (int a = 0; a < 20; a++) {
        const double *p = test_node_place[a];
        const double roof = 1.0 + b * (1.0 - p[0] * p[0]);
        position[a][0] = p[0];
        position[a][1] = 0.5 * (1.0 + p[1]) * roof;
        position[a][2] = 1.5 * p[2];
    }
}

static void volumes_of_curved_elements_are_exact(void **unused)
{
    (void)unused;
    double position[20][3], weight[20], one = 0.0, moment[3] = {0.0};
    struct wb_hex20_geometry geometry;
    const double b = 0.3;

    make_vault(b, position);
    assert_true(make_geometry(&geometry, WB_INTEGRATION_SELECTIVE, position));
    const double volume = 3.0 * (2.0 + 4.0 / 3.0 * b);
    assert_close(geometry.volume, volume, 1e-13);
    wb_hex20_volume_weights((const double(*)[3])position, weight);
    for (int a = 0; a < 20; a++) {
        one += weight[a];
        for (int i = 0; i < 3; i++)
            moment[i] += weight[a] * position[a][i];
    }
    assert_close(one, volume, 1e-13);
    /* int y = 3/2 int h^2 dx. */
    assert_close(moment[0], 0.0, 1e-13);
    assert_close(moment[1], 1.5 * (2.0 + 8.0 / 3.0 * b + 16.0 / 15.0 * b * b), 1e-13);
    assert_close(moment[2], 0.0, 1e-13);

    /* The well-known ones of a box: corners -1/8, edges 1/6 of the volume. */
    make_nodes(0.0, position);
    wb_hex20_volume_weights((const double(*)[3])position, weight);
    for (int a = 0; a < 20; a++)
        assert_close(weight[a] / 6e-9, a < 8 ? -0.125 : 1.0 / 6.0, 1e-14);
}

static void face_integrals_are_exact(void **unused)
{
    (void)unused;
    /* The vault's front in the plane of y and z: its length along y, its height along z, both away
     * from the axis. */
    static const double place[8][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1},
                                       {0, -1},  {1, 0},  {0, 1}, {-1, 0}};
    const double b = 0.3, y0 = 0.7, z0 = -0.4;
    double position[8][3], sums[5] = {0.0};
    struct wb_hex20_face face;
    for (int a = 0; a < 8; a++) {
        const double roof = 1.0 + b * (1.0 - place[a][0] * place[a][0]);
        position[a][0] = 5.0;
        position[a][1] = y0 + place[a][0];
        position[a][2] = z0 + 0.5 * (1.0 + place[a][1]) * roof;
    }
    wb_hex20_face_integrals((const double(*)[3])position, &face);

    /* int h, h^2, h^3 dx and int x^2 h dx with h = 1 + b (1 - x^2). */
    const double h1 = 2.0 + 4.0 / 3.0 * b, h2 = 2.0 + 8.0 / 3.0 * b + 16.0 / 15.0 * b * b;
    const double h3 = 2.0 + 4.0 * b + 16.0 / 5.0 * b * b + 32.0 / 35.0 * b * b * b;
    const double x2h = 2.0 / 3.0 + 4.0 / 15.0 * b;
    assert_close(face.area, h1, 1e-13);
    assert_close(face.yy, x2h + y0 * y0 * h1, 1e-13);
    assert_close(face.zz, h3 / 3.0 + z0 * h2 + z0 * z0 * h1, 1e-13);
    for (int a = 0; a < 8; a++) {
        sums[0] += face.one[a];
        sums[1] += face.y[a];
        sums[2] += face.z[a];
        sums[3] += face.one[a] * position[a][1];
        sums[4] += face.z[a] * position[a][2];
    }
    assert_close(sums[0], h1, 1e-13);
    assert_close(sums[1], y0 * h1, 1e-13);
    assert_close(sums[2], 0.5 * h2 + z0 * h1, 1e-13);
    assert_close(sums[3], sums[1], 1e-13);
    assert_close(sums[4], face.zz, 1e-13);
}

/* Constant stress then does the same work at both sets of points, which makes a patch of distorted
 * elements exact. With curved edges the corner points integrate gradients only approximately. */
static void both_rules_integrate_gradients_alike_between_straight_edges(void **unused)
{
    (void)unused;
    static const int edge[12][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6},
                                    {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}};
    srand(1);
    for (int k = 0; k < 10; k++) {
        struct wb_hex20_geometry geometry;
        double position[20][3];
        make_nodes(0.3, position);
        for (int e = 0; e < 12; e++) {
            for (int i = 0; i < 3; i++)
                position[8 + e][i] = 0.5 * (position[edge[e][0]][i] + position[edge[e][1]][i]);
        }
        assert_true(make_geometry(&geometry, WB_INTEGRATION_SELECTIVE, position));
        for (int a = 0; a < 20; a++) {
            for (int j = 0; j < 3; j++) {
                double sum = 0.0, corner_sum = 0.0;
                for (int p = 0; p < 27; p++)
                    sum += geometry.weight[p] * geometry.gradient[p][j][a];
                for (int p = 0; p < 8; p++)
                    corner_sum += geometry.corner_weight[p] * geometry.corner_gradient[p][j][a];
                assert_close(corner_sum, sum, 1e-14 * 6e-6);
            }
        }
    }
}

/* Position at parent coordinates x, with the standard shape functions. */
static void find_position(const double x[3], double position[20][3], double at[3])
{
    at[0] = at[1] = at[2] = 0.0;
    for (int a = 0; a < 20; a++) {
        const double *p = test_node_place[a];
        const bool corner = p[0] * p[1] * p[2] != 0.0;
        double N = corner ? (p[0] * x[0] + p[1] * x[1] + p[2] * x[2] - 2.0) / 8.0 : 0.25;
        for (int i = 0; i < 3; i++)
            N *= p[i] == 0.0 ? 1.0 - x[i] * x[i] : 1.0 + p[i] * x[i];
        for (int i = 0; i < 3; i++)
            at[i] += N * position[a][i];
    }
}

static void find_corner_points(double position[20][3], double at[8][3])
{
    for (int c = 0; c < 8; c++) {
        double x[3];
        for (int i = 0; i < 3; i++)
            x[i] = (c >> i & 1 ? 1.0 : -1.0) / sqrt(3.0);
        find_position(x, position, at[c]);
    }
}

/* Values linear in the position at the corner points are linear at the nodes, for any shape. */
static void linear_values_reach_the_nodes_of_curved_elements(void **unused)
{
    (void)unused;
    srand(9);
    for (int k = 0; k < 30; k++) {
        struct wb_hex20_geometry geometry;
        double position[20][3], point[8][3];
        if (k < 3)
            make_vault(0.4 * k, position);
        else
            make_nodes(0.2, position);
        assert_true(make_geometry(&geometry, integrations[k % 2], position));
        find_corner_points(position, point);
        for (int a = 0; a < 20; a++) {
            double sum[4] = {0.0};
            for (int c = 0; c < 8; c++) {
                sum[3] += geometry.nodal_share[a][c];
                for (int i = 0; i < 3; i++)
                    sum[i] += geometry.nodal_share[a][c] * point[c][i];
            }
            assert_close(sum[3], 1.0, 1e-12);
            for (int i = 0; i < 3; i++)
                assert_close(sum[i], position[a][i], k < 3 ? 1e-12 : 1e-14);
        }
    }
}

/* Distorted so much that the affine extrapolation is rejected: parent coordinates are used.
 * Constants stay constant, and the weights stay moderate. */
static void far_distorted_elements_keep_moderate_shares(void **unused)
{
    (void)unused;
    for (int k = 0; k <= 40; k++) {
        struct wb_hex20_geometry geometry;
        double position[20][3];
        for (int a = 0; a < 20; a++) { /* a sector of a ring, thick and wide */
            const double *p = test_node_place[a];
            const double angle = 0.06 * k * p[0], radius = 2.0 + p[1];
            position[a][0] = radius * sin(angle) + 1e-6 * p[0];
            position[a][1] = radius * cos(angle);
            position[a][2] = p[2];
        }
        if (k == 0 || !make_geometry(&geometry, integrations[k % 2], position))
            continue;
        for (int a = 0; a < 20; a++) {
            double sum = 0.0;
            for (int c = 0; c < 8; c++) {
                sum += geometry.nodal_share[a][c];
                assert_true(fabs(geometry.nodal_share[a][c]) <= 8.0);
            }
            assert_close(sum, 1.0, 1e-12);
        }
    }
}

static void invalid_shapes_are_rejected(void **unused)
{
    (void)unused;
    struct wb_hex20_geometry geometry;
    double position[20][3];
    for (int k = 0; k < 2; k++) {
        make_nodes(0.0, position);
        position[6][0] = -1.5e-3; /* a corner pushed through */
        position[6][1] = -2e-3;
        assert_false(make_geometry(&geometry, integrations[k], position));
        make_nodes(0.0, position);
        for (int a = 0; a < 20; a++)
            position[a][2] = -position[a][2]; /* a mirror image */
        assert_false(make_geometry(&geometry, integrations[k], position));
        make_nodes(0.0, position);
        position[13][1] = (double)NAN;
        assert_false(make_geometry(&geometry, integrations[k], position));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(gradients_are_those_of_the_serendipity_functions),
        cmocka_unit_test(volumes_of_curved_elements_are_exact),
        cmocka_unit_test(face_integrals_are_exact),
        cmocka_unit_test(both_rules_integrate_gradients_alike_between_straight_edges),
        cmocka_unit_test(linear_values_reach_the_nodes_of_curved_elements),
        cmocka_unit_test(far_distorted_elements_keep_moderate_shares),
        cmocka_unit_test(invalid_shapes_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
