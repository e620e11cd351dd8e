/* The rod's mesh: reference, balance, tangent, invariance to rotation. */
#include "fe/rod/rod.h"

#include "fe/linear/banded.h"
#include "fe/rod/rod_element.h"
#include "fe/rod/rod_private.h"
#include "tests/fe/rod/rods.h"

static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};

static const struct test_rod_plan plan = {.diameter = 3.26e-3, .length = 0.1, .n_elements = 12};

static struct test_rod make_copper(void)
{
    struct test_rod_plan copper_plan = plan;
    copper_plan.material = copper;
    return test_rod_make(&copper_plan);
}

/* Bending and twist in the plastic range, in no plane. */
static const struct wb_tip_loads bent = {.force = {-5.0, 5.0, 2.0}, .moment = {0.4, -0.3, 0.2}};

static void spiral(void *context, double s, double curvature[3])
{
    (void)context, (void)s;
    curvature[0] = 20.0;
    curvature[2] = 40.0;
}

static void natural_curvature_is_free_of_stress(void **unused)
{
    (void)unused;
    struct test_rod_plan helix = plan;
    helix.material = copper;
    helix.natural_curvature = spiral;
    helix.n_elements = 48;
    struct test_rod t = test_rod_make(&helix);
    struct wb_rod_balance balance;
    wb_rod_evaluate(t.rod, 1.0, &balance);
    assert_true(balance.largest_force == 0.0);
    assert_true(balance.largest_residual == 0.0);

    /* The helix with torsion 20 and curvature 40, from the clamp: x' = R e, R = exp(s [k x]). */
    const double size = hypot(20.0, 40.0), u = 20.0 / size, w = 40.0 / size;
    for (int i = 0; i <= 20; i++) {
        const double s = 0.1 * i / 20, a = size * s;
        const struct wb_rod_node node = wb_rod_position(t.rod, s);
        assert_close(node.position[0], (u * u * a + w * w * sin(a)) / size, 2e-7);
        assert_close(node.position[1], w * (1.0 - cos(a)) / size, 2e-7);
        assert_close(node.position[2], u * w * (a - sin(a)) / size, 2e-7);
        assert_close(node.rotation[0], cos(0.5 * a), 1e-13);
        assert_close(node.rotation[1], u * sin(0.5 * a), 1e-13);
        assert_close(node.rotation[3], w * sin(0.5 * a), 1e-13);
    }
    test_rod_release(&t);
}

static void clamp_carries_all_loads(void **unused)
{
    (void)unused;
    struct test_rod_plan heavy = plan;
    heavy.material = copper;
    heavy.load[0] = 10.0;
    heavy.load[1] = -80.0;
    heavy.load[2] = 30.0;
    struct test_rod t = test_rod_make(&heavy);
    struct wb_rod_balance balance;
    test_rod_load(&t, &bent);
    wb_rod_evaluate(t.rod, 1.0, &balance);
    const double *r = wb_rod_tip(t.rod)->position, *f = bent.force;
    double moment[3] = {r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2],
                        r[0] * f[1] - r[1] * f[0]};
    /* The weight acts at the mean position of the axis. */
    double mean[3] = {0};
    for (int i = 0; i < 24000; i++) {
        const struct wb_rod_node at = wb_rod_position(t.rod, 0.1 * (i + 0.5) / 24000);
        for (int k = 0; k < 3; k++)
            mean[k] += at.position[k] / 24000;
    }
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        moment[k] += bent.moment[k] + 0.1 * (mean[a] * heavy.load[b] - mean[b] * heavy.load[a]);
        assert_close(-balance.clamp[k], f[k] + 0.1 * heavy.load[k], 1e-7);
        assert_close(-balance.clamp[3 + k], moment[k], 1e-7);
    }
    test_rod_release(&t);
}

/* Loads the virgin rod in one step of its history, approached gradually, and returns the tip's
 * position and condensed stiffness. */
static void load_tip(struct wb_rod *rod, const double *force, struct wb_rod_node *tip, double *K)
{
    struct wb_rod_balance balance;
    double right[6];
    wb_rod_reset(rod);
    for (int i = 1; i <= 45; i++) {
        const double part = fmin(1.0, i / 20.0);
        wb_rod_evaluate(rod, 1.0, &balance);
        wb_rod_condense(rod, K, right);
        for (int k = 0; k < 6; k++)
            right[k] += part * force[k];
        double matrix[36];
        memcpy(matrix, K, sizeof matrix);
        wb_banded_solve_small(6, 6, matrix, right);
        wb_rod_advance(rod, right, 0.5);
    }
    wb_rod_evaluate(rod, 1.0, &balance);
    wb_rod_condense(rod, K, right);
    assert_true(balance.largest_residual < 1e-9);
    *tip = *wb_rod_tip(rod);
}

/* Small motion between two states of the tip: displacement and spin. */
static void motion(const struct wb_rod_node *from, const struct wb_rod_node *to, double d[6])
{
    const double back[4] = {from->rotation[0], -from->rotation[1], -from->rotation[2],
                            -from->rotation[3]};
    double q[4];
    wb_rod_element_compose(to->rotation, back, q);
    for (int k = 0; k < 3; k++) {
        d[k] = to->position[k] - from->position[k];
        d[3 + k] = 2.0 * q[k + 1];
    }
}

static void condensed_stiffness_is_the_derivative_of_the_tip_forces(void **unused)
{
    (void)unused;
    struct test_rod_plan fine = plan;
    fine.material = copper;
    fine.n_elements = 24;
    struct test_rod t = test_rod_make(&fine);
    const double force[6] = {-5.0, 5.0, 2.0, 0.4, -0.3, 0.2};
    const double unit[6] = {1.0, 1.0, 1.0, 0.1, 0.1, 0.1};
    double K[36], other[36], worst = 0.0;
    struct wb_rod_node tip;
    load_tip(t.rod, force, &tip, K);
    assert_true(wb_rod_point(t.rod, 0)->section.yielding > 20);
    for (int j = 0; j < 6; j++) {
        struct wb_rod_node side[2];
        double d[6];
        const double step = 1e-4 * unit[j];
        for (int k = 0; k < 2; k++) {
            double changed[6];
            memcpy(changed, force, sizeof changed);
            changed[j] += k == 0 ? -step : step;
            load_tip(t.rod, changed, &side[k], other);
        }
        motion(&side[0], &side[1], d);
        /* K times the change of position is the change of force. */
        for (int i = 0; i < 6; i++) {
            double sum = 0.0;
            for (int k = 0; k < 6; k++)
                sum += K[6 * i + k] * d[k];
            worst = fmax(worst, fabs(sum - (i == j ? 2.0 * step : 0.0)) / unit[i] / 2e-4);
        }
    }
    print_message("condensed tangent against differences: %.2g\n", worst);
    assert_true(worst < 1e-3);
    test_rod_release(&t);
}

static void turn_vector(const double q[4], const double *v, double *turned)
{
    double R[9];
    wb_rod_element_matrix(q, R);
    for (int i = 0; i < 3; i++)
        turned[i] = R[3 * i] * v[0] + R[3 * i + 1] * v[1] + R[3 * i + 2] * v[2];
}

/* Clamp and dead loads rotate together by a full turn: the rod stays in balance. */
static void rotating_a_loaded_rod_changes_nothing(void **unused)
{
    (void)unused;
    struct test_rod t = make_copper();
    struct wb_rod_balance balance, first;
    double strain[4], turned_strain[4], s;
    const double *history;
    test_rod_load(&t, &bent);
    const struct wb_rod_node tip = *wb_rod_tip(t.rod);
    wb_rod_evaluate(t.rod, 1.0, &first);
    wb_rod_point_state(t.rod, 3, &s, strain, &history);

    for (int i = 1; i <= 8; i++) {
        const double angle = M_PI / 4.0 * i;
        const double axis[3] = {angle * 2.0 / 3.0, angle / 3.0, -angle * 2.0 / 3.0};
        double q[4], force[3], moment[3], position[3], rotation[4];
        wb_rod_element_exponential(axis, q);
        wb_rod_set_clamp(t.rod, q);
        wb_rod_evaluate(t.rod, 1.0, &balance);
        turn_vector(q, bent.force, force);
        turn_vector(q, bent.moment, moment);
        turn_vector(q, tip.position, position);
        wb_rod_element_compose(q, tip.rotation, rotation);
        assert_close(test_rod_distance(wb_rod_tip(t.rod)->position, position), 0.0, 1e-15);
        for (int k = 0; k < 4; k++)
            assert_close(wb_rod_tip(t.rod)->rotation[k], rotation[k], 1e-14);
        for (int k = 0; k < 3; k++) {
            assert_close(balance.tip[k], force[k], 1e-7);
            assert_close(balance.tip[3 + k], moment[k], 1e-9);
        }
        assert_true(balance.largest_residual < first.largest_residual + 1e-10);
        wb_rod_commit(t.rod);
        wb_rod_point_state(t.rod, 3, &s, turned_strain, &history);
        for (int k = 0; k < 4; k++)
            assert_close(turned_strain[k], strain[k], 0.0);
    }
    test_rod_release(&t);
}

/* An elastic rod has no memory: two paths to the same loads, one of them with a large rotation out
 * of the plane, end in the same state. */
static void elastic_rod_is_path_independent(void **unused)
{
    (void)unused;
    struct test_rod_plan elastic = plan;
    elastic.material = copper;
    elastic.material.hardening = WB_HARDENING_NONE_ELASTIC;
    struct test_rod a = test_rod_make(&elastic), b = test_rod_make(&elastic);
    const struct wb_tip_loads target = {.force = {0.0, 40.0, 0.0}, .moment = {1.0, 2.0, 0.0}};
    const struct wb_tip_loads turns[] = {{.moment = {0.0, 6.0, 0.0}},
                                         {.moment = {4.0, 6.0, 3.0}, .force = {0.0, 30.0, 30.0}},
                                         {.force = {0.0, 30.0, -40.0}, .moment = {4.0, 0.0, 3.0}},
                                         {.force = {0.0, 40.0, 0.0}}};
    test_rod_load(&a, &target);
    for (size_t i = 0; i < sizeof turns / sizeof turns[0]; i++)
        test_rod_load(&b, &turns[i]);
    assert_true(test_rod_distance(wb_rod_tip(a.rod)->position, wb_rod_tip(b.rod)->position) > 1e-3);
    test_rod_load(&b, &target);
    assert_true(test_rod_distance(wb_rod_tip(a.rod)->position, wb_rod_tip(b.rod)->position) < 1e-9);
    for (int g = 0; g < 24; g++) {
        double s, strain[2][4];
        const double *history;
        wb_rod_point_state(a.rod, g, &s, strain[0], &history);
        wb_rod_point_state(b.rod, g, &s, strain[1], &history);
        for (int k = 1; k < 4; k++)
            assert_close(strain[0][k], strain[1][k], 1e-6);
    }
    test_rod_release(&a);
    test_rod_release(&b);
}

static void advance_does_not_stretch_a_rotating_rod(void **unused)
{
    (void)unused;
    struct test_rod t = make_copper();
    struct wb_rod_balance balance;
    double K[36], right[6], strain[4], s;
    const double *history;
    wb_rod_evaluate(t.rod, 1.0, &balance);
    wb_rod_condense(t.rod, K, right);
    /* Moved sideways by a third of its length in one linear step. */
    const double tip[6] = {0.0, 0.03, 0.02, 0.3, -0.3, 0.5};
    assert_close(wb_rod_advance(t.rod, tip, 1.0), 1.0, 0.0);
    wb_rod_evaluate(t.rod, 1.0, &balance);
    wb_rod_commit(t.rod);
    for (int g = 0; g < 24; g++) {
        wb_rod_point_state(t.rod, g, &s, strain, &history);
        assert_close(strain[0], 0.0, 1e-9);
    }
    /* No node rotates by more than the limit. */
    const double far[6] = {0.0, 0.3, 0.2, 0.3, -0.3, 5.0};
    wb_rod_evaluate(t.rod, 1.0, &balance);
    wb_rod_condense(t.rod, K, right);
    assert_true(wb_rod_advance(t.rod, far, 0.1) < 0.03);
    assert_true(wb_rod_turn(t.rod) < 0.101);
    test_rod_release(&t);
}

static void invalid_rods_are_rejected(void **unused)
{
    (void)unused;
    struct test_rod t = make_copper();
    struct wb_rod_model model = {.section = t.section, .length = 0.1, .n_elements = 0};
    struct wb_rod *rod = NULL;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_rod_create(&rod, &model), WB_ERR_ARGUMENT);
    model.n_elements = 10;
    model.length = (double)NAN;
    assert_int_equal(wb_rod_create(&rod, &model), WB_ERR_ARGUMENT);
    model.length = 0.1;
    model.load[2] = (double)INFINITY;
    assert_int_equal(wb_rod_create(&rod, &model), WB_ERR_ARGUMENT);
    model.load[2] = 0.0;
    model.section = NULL;
    assert_int_equal(wb_rod_create(&rod, &model), WB_ERR_ARGUMENT);
    assert_null(rod);
    wb_log_set_sink(NULL, NULL);
    test_rod_release(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(natural_curvature_is_free_of_stress),
        cmocka_unit_test(clamp_carries_all_loads),
        cmocka_unit_test(condensed_stiffness_is_the_derivative_of_the_tip_forces),
        cmocka_unit_test(rotating_a_loaded_rod_changes_nothing),
        cmocka_unit_test(elastic_rod_is_path_independent),
        cmocka_unit_test(advance_does_not_stretch_a_rotating_rod),
        cmocka_unit_test(invalid_rods_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
