/* The chain of segments compared with closed forms of the wire that it represents. */
#include "analysis/cards/card_chain.h"
#include "tests/check.h"

static const struct wb_card_chain wire = {.n = 20,
                                          .length = 0.1,
                                          .diameter = 1e-3,
                                          .mass_per_length = 4e-3,
                                          .bending = 4e-4,
                                          .torsion = 3e-4};

static struct wb_card_chain_modes modes_of(const struct wb_card_chain *chain)
{
    struct wb_card_chain_modes modes;
    assert_int_equal(wb_card_chain_modes(chain, &modes), WB_OK);
    return modes;
}

static void segments_have_the_mass_beyond_the_clamped_half(void **state)
{
    (void)state;
    double mass = 0.0, length = 0.0;
    for (int i = 0; i < wire.n; i++) {
        const struct wb_card_chain_segment s = wb_card_chain_segment(&wire, i);
        mass += s.mass;
        length += s.length;
        assert_close_relative(s.along, 0.125 * s.mass * 1e-6, 1e-12);
        assert_close_relative(s.across, s.mass * (s.length * s.length / 12.0 + 1e-6 / 16.0), 1e-12);
    }
    assert_close_relative(length, 0.1 * (1.0 - 0.5 / wire.n), 1e-12);
    assert_close_relative(mass, 4e-3 * length, 1e-12);
}

/* Euler and Bernoulli: 1.8751^2 / L^2 sqrt(EI / m). */
static void the_lowest_bending_mode_converges_to_that_of_a_cantilever(void **state)
{
    (void)state;
    const double exact = 1.875104068711961 * 1.875104068711961 / (0.1 * 0.1) * sqrt(4e-4 / 4e-3);
    double before = 0.0;
    for (int n = 10; n <= 40; n *= 2) {
        struct wb_card_chain chain = wire;
        chain.n = n;
        const double error = modes_of(&chain).lowest_bending / exact - 1.0;
        print_message("    %d segments: %+.6f\n", n, error);
        assert_true(fabs(error) < 0.6 / (n * n) + 1e-4);
        assert_true(n == 10 || fabs(error) < 0.3 * fabs(before));
        before = error;
    }
}

/* Equal discs on equal springs, the last one half a disc: omega_k = 2 sqrt(k / I) sin(odd pi / (4
 * n)), a chain fixed at one end and reflected at the other; the highest odd number is 2 n - 1. */
static void the_highest_torsion_mode_is_that_of_discs_on_springs(void **state)
{
    (void)state;
    for (int n = 3; n <= 24; n *= 2) {
        struct wb_card_chain chain = wire;
        chain.n = n;
        const double h = 0.1 / n, k = 3e-4 / h, I = 4e-3 * h * 0.125e-6;
        const double exact = 2.0 * sqrt(k / I) * sin((2 * n - 1) * M_PI / (4 * n));
        assert_close_relative(modes_of(&chain).highest_torsion, exact, 1e-9);
    }
}

/* Two joints: the characteristic polynomial by hand. */
static void two_joints_have_the_modes_of_a_double_pendulum_on_springs(void **state)
{
    (void)state;
    struct wb_card_chain chain = wire;
    chain.n = 2;
    const struct wb_card_chain_segment a = wb_card_chain_segment(&chain, 0);
    const struct wb_card_chain_segment b = wb_card_chain_segment(&chain, 1);
    const double k = 4e-4 / 0.05, ca = 0.5 * a.length, cb = 0.5 * b.length;
    const double M11 = a.mass * ca * ca + a.across + b.mass * (0.05 + cb) * (0.05 + cb) + b.across;
    const double M12 = b.mass * cb * (0.05 + cb) + b.across, M22 = b.mass * cb * cb + b.across;
    /* det(k - w M) = 0 with w = omega^2 */
    const double A = M11 * M22 - M12 * M12, B = -k * (M11 + M22), C = k * k;
    const double root = sqrt(B * B - 4.0 * A * C);
    const struct wb_card_chain_modes modes = modes_of(&chain);
    assert_close_relative(modes.lowest_bending, sqrt((-B - root) / (2.0 * A)), 1e-9);
    assert_close_relative(modes.highest_bending, sqrt((-B + root) / (2.0 * A)), 1e-9);
}

static void invalid_chains_are_rejected(void **state)
{
    (void)state;
    struct wb_card_chain chain = wire;
    struct wb_card_chain_modes modes;
    chain.mass_per_length = 0.0;
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_card_chain_modes(&chain, &modes), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(segments_have_the_mass_beyond_the_clamped_half),
        cmocka_unit_test(the_lowest_bending_mode_converges_to_that_of_a_cantilever),
        cmocka_unit_test(the_highest_torsion_mode_is_that_of_discs_on_springs),
        cmocka_unit_test(two_joints_have_the_modes_of_a_double_pendulum_on_springs),
        cmocka_unit_test(invalid_chains_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
