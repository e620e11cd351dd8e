/* Rods of one branch against closed forms. */
#include "tests/fe/harness/harnesses.h"

/* A cantilever with a dead force across, F L^2 / EI = 10 (Bisshopp and Drucker 1945). */
static void bends_as_the_elastica(void **unused)
{
    (void)unused;
    struct test_harness t = test_single_branch(test_elastic_section(1e-3, 0.0), 20);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    const struct wb_harness_load load = {tip, {0.0, 1e-2}};
    const struct wb_harness_move move = {.n_loads = 1, .loads = &load};
    (void)test_harness_move(&t, &move);
    const double *const r = wb_harness_node(t.harness, tip)->position;
    assert_close(r[0], 0.445004, 2e-6);
    assert_close(r[1], 0.810609, 4e-6);
    double reaction[6];
    wb_harness_reaction(t.harness, 0, reaction);
    assert_close(reaction[1], -1e-2, 1e-12);
    assert_close(reaction[5], -1e-2 * r[0], 1e-12);
    test_harness_release(&t);
}

/* The helix with curvature kappa and torsion tau from the origin, tangent to x, at arc length s. */
static struct wb_rod_node helix(double kappa, double tau, double twist, double s)
{
    const double turn[3] = {tau * s, 0.0, kappa * s}, own[3] = {twist * s, 0.0, 0.0};
    const double size = hypot(kappa, tau), u = size > 0.0 ? tau / size : 1.0,
                 w = size > 0.0 ? kappa / size : 0.0, a = size * s;
    struct wb_rod_node node = {
        .position = {u * u * s + (size > 0.0 ? w * w * sin(a) / size : 0.0),
                     size > 0.0 ? w * (1.0 - cos(a)) / size : 0.0,
                     size > 0.0 ? u * w * (a - sin(a)) / size : 0.0},
    };
    double q[4];
    wb_rod_element_exponential(turn, node.rotation);
    wb_rod_element_exponential(own, q);
    wb_rod_element_compose(node.rotation, q, node.rotation);
    return node;
}

/* A straight rod that is bent and twisted to a helix (Love, Mathematical Theory of Elasticity,
 * 271): with curvature kappa, torsion tau and twist t of its material, m = EI kappa b + GJ t r',
 * and a force n along the axis of the helix. */
static void holds_a_helix_with_loves_wrench(void **unused)
{
    (void)unused;
    /* Half of a turn and more; the whole of a turn would be unstable. */
    const double EI = 1e-3, GJ = 0.8e-3, kappa = 6.0, tau = 2.5, more = 1.5;
    struct test_harness t = test_single_branch(test_elastic_section(EI, GJ), 60);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    wb_harness_set_hold(t.harness, tip, WB_HARNESS_FIXED, wb_harness_node(t.harness, tip));
    for (int i = 1; i <= 40; i++) {
        const double part = i / 40.0;
        const struct wb_rod_node target = helix(part * kappa, part * tau, part * more, 1.0);
        (void)test_harness_aim(&t, tip, &target);
    }
    for (int i = 0; i <= 20; i++) {
        const struct wb_rod_node exact = helix(kappa, tau, more, i / 20.0);
        const struct wb_rod_node node = wb_harness_position(t.harness, 0, i / 20.0);
        for (int k = 0; k < 3; k++)
            assert_close(node.position[k], exact.position[k], 1e-6);
    }
    /* m' = n x r' and n' = 0 give n = (GJ t - EI tau) (tau r' + kappa b); at the root r' is x, b is
     * z. */
    const double twist = tau + more, n = GJ * twist - EI * tau;
    const double size = EI * kappa * kappa;
    double reaction[6];
    wb_harness_reaction(t.harness, 0, reaction);
    assert_close(reaction[0], -n * tau, 1e-4 * size);
    assert_close(reaction[1], 0.0, 1e-4 * size);
    assert_close(reaction[2], -n * kappa, 1e-4 * size);
    assert_close(reaction[3], -GJ * twist, 2e-5 * EI * kappa);
    assert_close(reaction[4], 0.0, 2e-5 * EI * kappa);
    assert_close(reaction[5], -EI * kappa, 2e-5 * EI * kappa);
    test_harness_release(&t);
}

/* Negative eigenvalues of an equilibrium at the current holds and loads, stable or not; 1 if none
 * is found. */
static int negative_at_rest(struct wb_harness *h)
{
    struct wb_harness_balance balance;
    wb_harness_evaluate(h, 0.0, &balance);
    for (int i = 0; i < 30; i++) {
        wb_harness_solve(h);
        if (balance.largest_residual <= 1e-9 * balance.largest_force + 1e-13 &&
            balance.farthest_hold < 1e-10 && balance.farthest_turn < 1e-10)
            return wb_harness_negative(h);
        (void)wb_harness_advance(h, 0.5, &balance);
    }
    return 1;
}

/* The parameter between `low` (stable) and `high` at which an equilibrium loses its stability. */
static double critical(int (*negative)(double parameter), double low, double high)
{
    assert_int_equal(negative(low), 0);
    assert_true(negative(high) > 0);
    while (high - low > 2e-5 * high) {
        const double middle = 0.5 * (low + high);
        if (negative(middle) > 0)
            high = middle;
        else
            low = middle;
    }
    return 0.5 * (low + high);
}

static int negative_of_a_column(double force)
{
    struct test_harness t = test_single_branch(test_elastic_section(1.0, 0.0), 20);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    const double load[6] = {-force};
    wb_harness_set_load(t.harness, tip, load);
    const int negative = negative_at_rest(t.harness);
    test_harness_release(&t);
    return negative;
}

static void column_buckles_at_eulers_load(void **unused)
{
    (void)unused;
    assert_close_relative(critical(negative_of_a_column, 1.0, 4.0), M_PI * M_PI / 4.0, 1e-4);
}

/* A straight rod with EI = 1, GJ = 10, length 1, clamped at both ends, twisted by a moment. */
static int negative_of_a_twisted_rod(double moment)
{
    struct test_harness t = test_single_branch(test_elastic_section(1.0, 10.0), 40);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    struct wb_rod_node target = *wb_harness_node(t.harness, tip);
    const double turn[3] = {moment / 10.0, 0.0, 0.0};
    wb_rod_element_exponential(turn, target.rotation);
    wb_harness_set_hold(t.harness, tip, WB_HARNESS_FIXED, &target);
    const int negative = negative_at_rest(t.harness);
    test_harness_release(&t);
    return negative;
}

static void twisted_rod_buckles_at_greenhills_moment(void **unused)
{
    (void)unused;
    assert_close_relative(critical(negative_of_a_twisted_rod, 5.0, 12.0), 8.98682, 1e-3);
}

/* A straight rod with EI = 1, GJ = 4 that is bent to a ring of length 1 and joined with a twist.
 * The ring turns inside out without a force, which a small drag prevents. */
static int negative_of_a_ring(double twist)
{
    struct test_harness t = test_single_branch(test_elastic_section(1.0, 4.0), 40);
    const int tip = wb_harness_joint(t.harness, 0, 1.0);
    int negative = 0;
    wb_harness_set_drag(t.harness, 0.3, 0.0);
    for (int i = 1; i <= 192 && negative == 0; i++) {
        const struct wb_rod_node target =
            helix(2.0 * M_PI * fmin(i / 32.0, 1.0), 0.0, twist * fmax(i - 32, 0.0) / 160.0, 1.0);
        wb_harness_set_hold(t.harness, tip, WB_HARNESS_FIXED, &target);
        negative = negative_at_rest(t.harness);
        wb_harness_commit(t.harness);
    }
    test_harness_release(&t);
    return negative;
}

static void twisted_ring_buckles_at_michells_angle(void **unused)
{
    (void)unused;
    assert_close_relative(critical(negative_of_a_ring, 1.5, 4.0), 2.0 * M_PI * sqrt(3.0) / 4.0,
                          1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bends_as_the_elastica),
        cmocka_unit_test(holds_a_helix_with_loves_wrench),
        cmocka_unit_test(column_buckles_at_eulers_load),
        cmocka_unit_test(twisted_rod_buckles_at_greenhills_moment),
        cmocka_unit_test(twisted_ring_buckles_at_michells_angle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
