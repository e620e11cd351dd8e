/* A bar of the 3D solid: pure bending, rigid rotation after it has yielded, balance of energy. */
#include "tests/fe/solid/solids.h"

/* Tractions along x for bending of a block whose middle is at y = 5 mm, opposite at its two
 * ends. */
static void bend(void *context, const double at[3], const double normal[3], double force[3])
{
    const double slope = *(const double *)context;
    force[0] = slope * (at[1] - 5e-3) * normal[0];
    force[1] = force[2] = 0.0;
}

static void bar_map(void *context, const double unit[3], double at[3])
{
    (void)context;
    at[0] = 40e-3 * unit[0];
    at[1] = 10e-3 * unit[1];
    at[2] = 10e-3 * unit[2];
}

/* Six supports that prevent only rigid motions; the last one lifts the far corner, which is
 * returned, by `lift` at factor 1. */
static int hold_as_a_body(struct test_solid *t, double lift)
{
    const int near_corner = test_solid_node_at(&t->mesh, 0.0, 0.0, 0.0);
    const int beside = test_solid_node_at(&t->mesh, 0.0, 0.0, 10e-3);
    const int far_corner = test_solid_node_at(&t->mesh, 40e-3, 0.0, 0.0);
    for (int k = 0; k < 3; k++)
        test_solid_hold(t, near_corner, k, 0.0);
    test_solid_hold(t, beside, 0, 0.0);
    test_solid_hold(t, beside, 1, 0.0);
    test_solid_hold(t, far_corner, 1, lift);
    return far_corner;
}

/* On bricks the exact displacements are quadratic, and these elements contain all quadratic
 * functions. */
static void stress_of_pure_bending_is_exact(void **unused)
{
    (void)unused;
    const struct wb_material material = test_solid_elastic(68.2e9, 0.34);
    const int n[3] = {4, 2, 2};
    for (int integration = 0; integration < 2; integration++) {
        double slope = 1e5 / 5e-3;
        struct test_solid t;
        test_solid_block(&t, n, bar_map, NULL);
        test_solid_init(&t, &material, test_solid_rules[integration]);
        (void)hold_as_a_body(&t, 0.0);
        for (int last = 0; last < 2; last++)
            test_solid_load_end(&t, last, bend, &slope, t.force);
        test_solid_create(&t);
        test_solid_go(&t, 0.0, 1.0);
        for (int e = 0; e < t.mesh.n_elements; e++) {
            double stress[20][6], plastic[20];
            wb_solid_nodal_stress(t.solid, e, stress, plastic);
            for (int a = 0; a < 20; a++) {
                const double y = t.mesh.node[t.mesh.element[e][a]][1] - 5e-3;
                for (int k = 0; k < 6; k++)
                    assert_close(stress[a][k], k == 0 ? slope * y : 0.0, 1e-4 * 1e5);
            }
        }
        test_solid_release(&t);
    }
}

/* Stress of an element's nodes rotated about z by (c, s). */
static void turn_stress(double stress[6], double c, double s)
{
    const double xx = stress[0], yy = stress[1], xy = stress[3], yz = stress[4], zx = stress[5];
    stress[0] = c * c * xx + s * s * yy - 2.0 * c * s * xy;
    stress[1] = s * s * xx + c * c * yy + 2.0 * c * s * xy;
    stress[3] = c * s * (xx - yy) + (c * c - s * s) * xy;
    stress[4] = s * zx + c * yz;
    stress[5] = c * zx - s * yz;
}

/* A bar is bent until it yields, unloaded, and then rotated as a rigid body by six supports. */
static void rotating_a_yielded_body_rotates_its_residual_stress(void **unused)
{
    (void)unused;
    const struct wb_material copper = {
        WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 300e6, 0.5};
    const int n[3] = {4, 2, 2};
    for (int integration = 0; integration < 2; integration++) {
        double slope = 1.4 * copper.yield_stress / 5e-3;
        struct test_solid t;
        test_solid_block(&t, n, bar_map, NULL);
        test_solid_init(&t, &copper, test_solid_rules[integration]);
        const int B = hold_as_a_body(&t, 35e-3);
        for (int last = 0; last < 2; last++)
            test_solid_load_end(&t, last, bend, &slope, t.force);
        test_solid_create(&t);
        test_solid_go(&t, 0.0, 1.0);
        test_solid_go(&t, 0.0, 0.0);

        const int n_u = 3 * t.mesh.n_nodes, n_e = t.mesh.n_elements;
        double *before = malloc((size_t)n_u * sizeof *before);
        double(*stress)[20][6] = malloc((size_t)n_e * sizeof *stress);
        double(*plastic)[20] = malloc((size_t)n_e * sizeof *plastic);
        assert_true(before && stress && plastic);
        memcpy(before, wb_solid_displacement(t.solid), (size_t)n_u * sizeof *before);
        double largest = 0.0, most = 0.0;
        for (int e = 0; e < n_e; e++) {
            wb_solid_nodal_stress(t.solid, e, stress[e], plastic[e]);
            for (int a = 0; a < 20; a++) {
                largest = fmax(largest, fabs(stress[e][a][0]));
                most = fmax(most, plastic[e][a]);
            }
        }

        test_solid_go(&t, 1.0, 0.0);
        const double *u = wb_solid_displacement(t.solid);
        const double s = 35e-3 / (40e-3 + before[3 * B]), c = sqrt(1.0 - s * s);
        print_message("turned by %.2f degrees: residual stress %.1f MPa, plastic strain %.5f, %d "
                      "increments\n",
                      asin(s) * 180.0 / M_PI, 1e-6 * largest, most, t.point.increments);
        assert_true(largest > 0.1 * copper.yield_stress && most > 1e-3);
        for (int i = 0; i < t.mesh.n_nodes; i++) {
            const double *X = t.mesh.node[i], *b = &before[3 * i];
            const double x = X[0] + b[0], y = X[1] + b[1];
            assert_close(X[0] + u[3 * i], c * x - s * y, 1e-11);
            assert_close(X[1] + u[3 * i + 1], s * x + c * y, 1e-11);
            assert_close(u[3 * i + 2], b[2], 1e-11);
        }
        for (int e = 0; e < n_e; e++) {
            double now[20][6], strain[20];
            wb_solid_nodal_stress(t.solid, e, now, strain);
            for (int a = 0; a < 20; a++) {
                turn_stress(stress[e][a], c, s);
                for (int k = 0; k < 6; k++)
                    assert_close(now[a][k], stress[e][a][k], 1e-6 * largest);
                assert_close(strain[a], plastic[e][a], 1e-12);
            }
        }
        free(before);
        free(stress);
        free(plastic);
        test_solid_release(&t);
    }
}

/* A cantilever bar is loaded beyond yield and unloaded, in increments of a share; returns the
 * energy imbalance at either end, over the work of loading. */
static void energy_imbalance(const struct wb_material *material, enum wb_integration integration,
                             double increment, double missing[2])
{
    const int n[3] = {4, 2, 1};
    struct test_solid_pull pull = {{0.0, 1600.0, 0.0}, 1e-4};
    struct wb_solid_balance b[2];
    struct test_solid t;
    test_solid_block(&t, n, bar_map, NULL);
    test_solid_init(&t, material, integration);
    t.settings.first_increment = t.settings.largest_increment = increment;
    test_solid_clamp(&t);
    test_solid_load_end(&t, true, test_solid_pull, &pull, t.force);
    test_solid_create(&t);
    for (int k = 0; k < 2; k++) {
        test_solid_go(&t, 0.0, k == 0 ? 1.0 : 0.0);
        wb_solid_balance(t.solid, &b[k]);
        missing[k] = (b[k].work - b[k].elastic - b[k].dissipated) / b[0].work;
        print_message("%s: work %.5f J, stored %.5f J, dissipated %.5f J, missing %+.3f %%\n",
                      k == 0 ? "loaded" : "unloaded", b[k].work, b[k].elastic, b[k].dissipated,
                      100.0 * missing[k]);
    }
    assert_true(b[0].dissipated > 0.3 * b[0].work);
    assert_true(b[1].elastic < 0.5 * b[0].elastic);
    test_solid_release(&t);
}

/* The error of backward Euler's dissipation is of first order in the increment. */
static void work_is_stored_and_dissipated(void **unused)
{
    (void)unused;
    static const struct wb_material materials[2] = {
        {WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 300e6, 0.5},
        {WB_HARDENING_KINEMATIC_LINEAR, 68.2e9, 0.34, 182e6, 3e9, 1.0},
    };
    for (int k = 0; k < 4; k++) {
        double coarse[2], fine[2];
        print_message("%s hardening, %s\n", k / 2 ? "kinematic" : "isotropic",
                      test_solid_rule_names[k % 2]);
        energy_imbalance(&materials[k / 2], test_solid_rules[k % 2], 0.05, coarse);
        energy_imbalance(&materials[k / 2], test_solid_rules[k % 2], 0.025, fine);
        for (int end = 0; end < 2; end++) {
            assert_close(fine[end], 0.0, 0.01);
            assert_true(fabs(fine[end]) < 0.6 * fabs(coarse[end]));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_of_pure_bending_is_exact),
        cmocka_unit_test(rotating_a_yielded_body_rotates_its_residual_stress),
        cmocka_unit_test(work_is_stored_and_dissipated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
