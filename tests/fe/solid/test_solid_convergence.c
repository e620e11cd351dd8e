/* The 3D solid under refinement: Cook's membrane, the thick cylinder, a cantilever block; no
 * locking near incompressibility and in the plastic limit. docs/verification.md has the numbers. */
#include "tests/fe/solid/solids.h"

#include "fe/solid/solid_private.h"

/* ---- Cook's membrane ---- */

static const double cook_thickness = 0.5;

static void cook_map(void *context, const double unit[3], double at[3])
{
    (void)context;
    at[0] = 48.0 * unit[0];
    at[1] = (1.0 - unit[1]) * 44.0 * unit[0] + unit[1] * (44.0 + 16.0 * unit[0]);
    at[2] = cook_thickness * unit[2];
}

/* n x n elements, E = 1; deflection at the middle of the loaded edge for a load of 1 per thickness
 * of 1. Plane strain: held in z everywhere. */
static double cook(int n, double nu, bool plane_strain, enum wb_integration integration)
{
    const struct wb_material material = test_solid_elastic(1.0, nu);
    const int elements[3] = {n, n, 1};
    const double scale = 1e-4;
    struct test_solid_pull pull = {{0.0, scale * cook_thickness, 0.0}, 16.0 * cook_thickness};
    struct test_solid t;
    test_solid_block(&t, elements, cook_map, NULL);
    test_solid_init(&t, &material, integration);
    for (int i = 0; i < t.mesh.n_nodes; i++) {
        const double *at = t.mesh.node[i];
        for (int k = 0; k < 2 && at[0] == 0.0; k++)
            test_solid_hold(&t, i, k, 0.0);
        if (plane_strain || at[2] == 0.0)
            test_solid_hold(&t, i, 2, 0.0);
    }
    test_solid_load_end(&t, true, test_solid_pull, &pull, t.force);
    test_solid_create(&t);
    test_solid_go(&t, 0.0, 1.0);
    const double answer =
        wb_solid_displacement(t.solid)[3 * test_solid_node_at(&t.mesh, 48.0, 52.0, 0.0) + 1] /
        scale;
    test_solid_release(&t);
    return answer;
}

/* Errors of 2 x 2, 4 x 4, 8 x 8 and 16 x 16 elements. */
static void cook_errors(double nu, bool plane_strain, double reference,
                        enum wb_integration integration, double error[4])
{
    for (int k = 0; k < 4; k++) {
        const double answer = cook(2 << k, nu, plane_strain, integration);
        error[k] = answer / reference - 1.0;
        print_message("Cook, nu = %g, %s, %d x %d, %s: %.4f, %+.2f %% of %.4f\n", nu,
                      plane_strain ? "plane strain" : "plane stress", 2 << k, 2 << k,
                      test_solid_rule_names[integration == WB_INTEGRATION_REDUCED], answer,
                      100.0 * error[k], reference);
    }
    print_message("orders of convergence %.2f, %.2f, %.2f\n", log2(error[0] / error[1]),
                  log2(error[1] / error[2]), log2(error[2] / error[3]));
}

/* References are extrapolated from 9-node elements, in plane strain with continuous bilinear
 * pressures, of 16 x 16, 32 x 32 and 64 x 64 elements; 23.96 is the known value. The stress at the
 * upper clamped corner is singular, which limits the order. */
static void cook_membrane_converges(void **unused)
{
    (void)unused;
    for (int integration = 0; integration < 2; integration++) {
        double e[4];
        cook_errors(1.0 / 3.0, false, 23.968, test_solid_rules[integration], e);
        for (int k = 0; k < 4; k++)
            assert_true(e[k] < 0.0);
        assert_close(e[0], 0.0, 0.045);
        assert_close(e[2], 0.0, 0.004);
        assert_close(e[3], 0.0, 0.002);
        assert_true(log2(e[1] / e[2]) > 1.3 && log2(e[2] / e[3]) > 1.3);
    }
}

/* Eight volume constraints for twelve unknowns of an element make convergence slow, but the error
 * does not grow further towards incompressibility. */
static void cook_membrane_does_not_lock(void **unused)
{
    (void)unused;
    for (int integration = 0; integration < 2; integration++) {
        double nearly[4], more[4];
        cook_errors(0.4999, true, 18.511, test_solid_rules[integration], nearly);
        cook_errors(0.499999, true, 18.509, test_solid_rules[integration], more);
        for (int k = 0; k < 4; k++)
            assert_close(more[k], nearly[k], 0.002);
        assert_close(nearly[3], 0.0, 0.015);
        assert_true(log2(nearly[1] / nearly[2]) > 1.1 && log2(nearly[2] / nearly[3]) > 1.1);
    }
}

/* ---- Thick cylinder in plane strain ---- */

static const double inner_radius = 100e-3, outer_radius = 200e-3, height = 20e-3;

static void ring_map(void *context, const double unit[3], double at[3])
{
    const double r = inner_radius + (outer_radius - inner_radius) * unit[0];
    const double angle = 0.5 * M_PI * unit[1];
    (void)context;
    at[0] = r * cos(angle);
    at[1] = r * sin(angle);
    at[2] = height * unit[2];
}

/* Pressure 1 on the inner side. */
static void push(void *context, const double at[3], const double normal[3], double force[3])
{
    (void)context, (void)at;
    for (int k = 0; k < 3; k++)
        force[k] = -normal[k];
}

/* A quarter of the ring; its inner side moves outward by `displacement` at factor 1. The forces for
 * a pressure of 1 are in `unit_pressure` (n_nodes), allocated. */
static void ring_begin(struct test_solid *t, const int n[3], const struct wb_material *material,
                       enum wb_integration integration, double displacement,
                       double (**unit_pressure)[3])
{
    test_solid_block(t, n, ring_map, NULL);
    test_solid_init(t, material, integration);
    for (int i = 0; i < t->mesh.n_nodes; i++) {
        const double *at = t->mesh.node[i], r = hypot(at[0], at[1]);
        const bool inside = fabs(r - inner_radius) < 1e-12;
        for (int k = 0; k < 2; k++) {
            if (inside || fabs(at[k]) < 1e-12)
                test_solid_hold(t, i, k, inside ? displacement * at[k] / r : 0.0);
        }
        test_solid_hold(t, i, 2, 0.0);
    }
    *unit_pressure = calloc((size_t)t->mesh.n_nodes, sizeof **unit_pressure);
    assert_non_null(*unit_pressure);
    test_solid_load_end(t, false, push, NULL, *unit_pressure);
    test_solid_create(t);
}

/* The pressure that does the same work as the reactions for a displacement of the inner side. */
static double ring_pressure(const struct test_solid *t, const double (*unit_pressure)[3])
{
    const double *force = wb_solid_internal_force(t->solid);
    double reaction = 0.0, unit = 0.0;
    for (int i = 0; i < t->mesh.n_nodes; i++) {
        const double *at = t->mesh.node[i], r = hypot(at[0], at[1]);
        for (int k = 0; k < 2 && fabs(r - inner_radius) < 1e-12; k++) {
            reaction += force[3 * i + k] * at[k] / r;
            unit += unit_pressure[i][k] * at[k] / r;
        }
    }
    return reaction / unit;
}

/* Lame: u(a) = p (1 + nu) a / E / (b^2 - a^2) ((1 - 2 nu) a^2 + b^2). */
static double ring_error(int m, double nu, enum wb_integration integration)
{
    const double E = 210e9, a = inner_radius, b = outer_radius, u = 1e-8;
    const double exact =
        u * E * (b * b - a * a) / (1.0 + nu) / a / ((1.0 - 2.0 * nu) * a * a + b * b);
    const struct wb_material material = test_solid_elastic(E, nu);
    const int n[3] = {m, 2 * m, 1};
    double(*unit)[3];
    struct test_solid t;
    ring_begin(&t, n, &material, integration, u, &unit);
    test_solid_go(&t, 1.0, 0.0);
    const double error = ring_pressure(&t, (const double(*)[3])unit) / exact - 1.0;
    print_message("elastic ring, nu = %g, %d x %d, %s: %+.2e\n", nu, n[0], n[1],
                  test_solid_rule_names[integration == WB_INTEGRATION_REDUCED], error);
    free(unit);
    test_solid_release(&t);
    return error;
}

/* Order 4 of the energy and so of the pressure at a given displacement; the reduced rule is better
 * still. */
static void elastic_ring_converges_with_fourth_order(void **unused)
{
    (void)unused;
    static const double ratio[2] = {0.3, 0.4999};
    for (int k = 0; k < 2; k++) {
        double e[4];
        for (int m = 0; m < 4; m++)
            e[m] = ring_error(1 << m, ratio[k], WB_INTEGRATION_SELECTIVE);
        print_message("orders of convergence %.2f, %.2f, %.2f\n", log2(e[0] / e[1]),
                      log2(e[1] / e[2]), log2(e[2] / e[3]));
        assert_close(e[0], 0.0, 4e-3);
        assert_close(log2(e[1] / e[2]), 4.0, 0.4);
        assert_close(log2(e[2] / e[3]), 4.0, 0.3);
        for (int m = 0; m < 3; m++)
            assert_true(fabs(ring_error(1 << m, ratio[k], WB_INTEGRATION_REDUCED)) <
                        0.05 * fabs(e[m]));
    }
}

static void thick_cylinder_reaches_its_limit_pressure(void **unused)
{
    (void)unused;
    /* Stiff, so that the limit load is reached before the ring has changed its shape. */
    const struct wb_material material = {
        WB_HARDENING_ISOTROPIC_POWER, 21e12, 0.3, 0.24e9, 0.0, 1.0};
    const double limit = 2.0 / sqrt(3.0) * 0.24e9 * log(2.0), steps = 10.0;
    for (int integration = 0; integration < 2; integration++) {
        const int n[3] = {4, 4, 1};
        double(*unit)[3], p = 0.0;
        struct test_solid t;
        ring_begin(&t, n, &material, test_solid_rules[integration], 1e-5, &unit);
        for (int k = 1; k <= (int)steps; k++) {
            const double before = p;
            test_solid_go(&t, k / steps, 0.0);
            p = ring_pressure(&t, (const double(*)[3])unit);
            print_message("limit of the thick cylinder, %s: %.5f GPa at %.0f um, %+.3f %%\n",
                          test_solid_rule_names[integration], 1e-9 * p, 1e6 * 1e-5 * k / steps,
                          100.0 * (p / limit - 1.0));
            assert_true(p > before && p < limit);
        }
        assert_close_relative(p, limit, 5e-4);
        free(unit);
        test_solid_release(&t);
    }
}

/* ---- A cantilever block ---- */

static void block_map(void *context, const double unit[3], double at[3])
{
    (void)context;
    at[0] = 4.0 * unit[0];
    at[1] = unit[1];
    at[2] = unit[2];
}

static double block(int m, enum wb_integration integration)
{
    const struct wb_material material = test_solid_elastic(1e9, 0.3);
    const int n[3] = {4 * m, m, m};
    struct test_solid_pull pull = {{0.0, 1e4, 0.0}, 1.0};
    struct test_solid t;
    test_solid_block(&t, n, block_map, NULL);
    test_solid_init(&t, &material, integration);
    test_solid_clamp(&t);
    test_solid_load_end(&t, true, test_solid_pull, &pull, t.force);
    test_solid_create(&t);
    test_solid_go(&t, 0.0, 1.0);
    const double answer = test_solid_compliance(&t) / 1e8;
    test_solid_release(&t);
    return answer;
}

/* Relative to the finest mesh; the stresses along the clamped edges are singular. */
static void cantilever_block_converges(void **unused)
{
    (void)unused;
    const double finest = block(6, WB_INTEGRATION_SELECTIVE);
    double e[3];
    for (int k = 0; k < 3; k++) {
        const int m = 1 << k;
        const double answer = block(m, WB_INTEGRATION_SELECTIVE);
        e[k] = answer / finest - 1.0;
        print_message("cantilever block, %d x %d x %d: %.6e, %+.3f %% of the finest\n", 4 * m, m, m,
                      answer, 100.0 * e[k]);
    }
    print_message("orders of convergence %.2f, %.2f\n", log2(e[0] / e[1]), log2(e[1] / e[2]));
    assert_true(e[0] < e[1] && e[1] < e[2] && e[2] < 0.0);
    assert_true(log2(e[0] / e[1]) > 2.0 && log2(e[1] / e[2]) > 2.0);
    assert_close(e[2], 0.0, 0.0015);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cook_membrane_converges),
        cmocka_unit_test(cook_membrane_does_not_lock),
        cmocka_unit_test(elastic_ring_converges_with_fourth_order),
        cmocka_unit_test(thick_cylinder_reaches_its_limit_pressure),
        cmocka_unit_test(cantilever_block_converges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
