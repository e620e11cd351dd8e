#include "tests/analysis/beam_data.h"

#include "analysis/calibration/paper/first_guess.h"

static const double mm = WB_MM, mpa = WB_MPA;

/* Eqs. 10 and 11 at one point require sigma_Y = 1.5 E (delta/L) (d/L); the eight rows of Tables 3
 * and 5 give delta/L = 0.040, not the 0.05 of the text. */
static void the_tables_of_the_paper_have_a_yield_point_of_four_percent(void **state)
{
    (void)state;
    const struct {
        double length, diameter, modulus, yield;
    } rows[] = {
        {85, 1.10, 5021, 3.90}, {85, 1.25, 5641, 4.95}, {85, 1.40, 4528, 4.52},
        {114, 4.6, 1114, 2.70}, {114, 5.8, 1022, 3.12}, {114, 7.4, 616, 2.40},
        {114, 7.4, 442, 1.72},  {114, 9.2, 449, 2.17},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const double L = rows[i].length * mm, d = rows[i].diameter * mm;
        const double modulus = rows[i].modulus * mpa;
        /* The force for E by eq. 10 at 4 % gives sigma_Y by eq. 11. */
        const double unit = wb_first_guess_modulus(1.0, 0.04 * L, L, d);
        const double force = modulus / unit;
        assert_close_relative(wb_first_guess_stress(force, L, d), rows[i].yield * mpa, 0.011);
        assert_close_relative(wb_first_guess_stress(force, L, d), 1.5 * modulus * 0.04 * d / L,
                              1e-12);
    }
}

static void equation_10_is_the_elastic_cantilever(void **state)
{
    (void)state;
    const double L = 0.085, d = 1.1e-3, force = 0.006;
    /* The paper's second form, with delta = 5 % L: 1280 F L^2 / (3 pi d^4). */
    assert_close_relative(wb_first_guess_modulus(force, 0.05 * L, L, d),
                          1280.0 * force * L * L / (3.0 * M_PI * pow(d, 4)), 1e-12);
}

static void stress_is_modulus_times_strain_in_the_elastic_zone(void **state)
{
    (void)state;
    const double L = 0.1, d = 1.4e-3, force = 0.01, deflection = 3 * mm;
    assert_close_relative(wb_first_guess_stress(force, L, d),
                          wb_first_guess_modulus(force, deflection, L, d) *
                              wb_first_guess_strain(deflection, L, d),
                          1e-12);
}

/* Eq. 13: Hollomon's stress at a strain beyond yield, Pa. */
static double hollomon(double modulus, double yield_stress, double exponent, double strain)
{
    return yield_stress * pow(modulus * strain / yield_stress, exponent);
}

/* Eq. 14: its tangent modulus at a stress beyond yield, Pa. */
static double tangent(double modulus, double yield_stress, double exponent, double stress)
{
    return exponent * modulus * pow(stress / yield_stress, 1.0 - 1.0 / exponent);
}

static void hollomon_continues_the_elastic_line_at_yield(void **state)
{
    (void)state;
    const double E = 5021 * mpa, yield = 3.9 * mpa;
    for (double n = 0.1; n < 1.2; n += 0.2) {
        const double K = wb_first_guess_strength(E, yield, n);
        const double strain = 3.0 * yield / E, h = 1e-6 * strain;
        assert_close_relative(hollomon(E, yield, n, yield / E), yield, 1e-12);
        /* Eq. 12 with the K of eq. 16 is eq. 13. */
        assert_close_relative(K * pow(strain, n), hollomon(E, yield, n, strain), 1e-12);
        /* Eq. 14 is the slope of eq. 13. */
        const double slope =
            (hollomon(E, yield, n, strain + h) - hollomon(E, yield, n, strain - h)) / (2.0 * h);
        assert_close_relative(tangent(E, yield, n, hollomon(E, yield, n, strain)), slope, 1e-6);
        /* Eq. 15: at yield it is n E. */
        assert_close_relative(tangent(E, yield, n, yield), n * E, 1e-12);
    }
}

/* F = 2 N/m up to 4 mm, then a slope of 0.8 N/m. */
static double bilinear(double x)
{
    return x < 4e-3 ? 2.0 * x : 8e-3 + 0.8 * (x - 4e-3);
}

static enum wb_status guess_of(struct wb_first_guess *guess, double (*force)(double), double last,
                               double elastic_zone, double yield_point)
{
    struct wb_dataset dataset;
    struct wb_curve curve;
    plain_dataset(&dataset, force, 0.1 * mm, last);
    dataset.info.length = 0.1;
    const struct wb_dataset *const datasets[] = {&dataset};
    assert_int_equal(curve_average(&curve, datasets, 1, 0.5 * mm), WB_OK);
    const enum wb_status status =
        wb_first_guess_run(guess, &curve, &dataset.info, elastic_zone, yield_point, NULL);
    wb_curve_release(&curve);
    wb_dataset_release(&dataset);
    return status;
}

static void guess_of_a_bilinear_curve_is_exact(void **state)
{
    (void)state;
    struct wb_first_guess guess;
    const double L = 0.1, d = 1.1e-3;
    assert_int_equal(guess_of(&guess, bilinear, 50 * mm, 0.02, 0.045), WB_OK);
    assert_close_relative(guess.youngs_modulus, wb_first_guess_modulus(2.0, 1.0, L, d), 1e-9);
    assert_close_relative(guess.yield_stress, wb_first_guess_stress(bilinear(4.5e-3), L, d), 0.02);
    /* Slope 0.8 of 2. */
    assert_close_relative(guess.hardening_exponent, 0.4, 1e-3);
    assert_close_relative(guess.tangent_modulus, 0.4 * guess.youngs_modulus, 1e-3);
    assert_close_relative(
        guess.strength_coefficient,
        wb_first_guess_strength(guess.youngs_modulus, guess.yield_stress, guess.hardening_exponent),
        1e-12);
}

static double reversed(double x)
{
    return -bilinear(x);
}

static double falling(double x)
{
    return x < 4e-3 ? 2.0 * x : 8e-3 - 0.1 * (x - 4e-3);
}

static double wavy(double x)
{
    return 1e-3 * sin(x / 1.5e-3);
}

static void unusable_curves_are_rejected_with_the_reason(void **state)
{
    (void)state;
    struct wb_first_guess guess;
    assert_int_equal(guess_of(&guess, bilinear, 6 * mm, 0.05, 0.04), WB_ERR_DATA);
    assert_message("yield is not reached");
    assert_int_equal(guess_of(&guess, reversed, 50 * mm, 0.05, 0.05), WB_ERR_DATA);
    assert_message("sign");
    assert_int_equal(guess_of(&guess, falling, 50 * mm, 0.03, 0.05), WB_ERR_DATA);
    assert_message("yield point (slope");
    assert_int_equal(guess_of(&guess, wavy, 50 * mm, 0.05, 0.05), WB_ERR_DATA);
    assert_message("does not rise steadily");
    assert_int_equal(guess_of(&guess, bilinear, 50 * mm, 0.005, 0.05), WB_ERR_DATA);
    assert_message("too few points");
}

static double stiffening(double x)
{
    return 2.0 * x + 1e3 * x * x;
}

static void the_exponent_is_limited(void **state)
{
    (void)state;
    struct wb_first_guess guess;
    assert_int_equal(guess_of(&guess, stiffening, 50 * mm, 0.02, 0.05), WB_OK);
    assert_close(guess.hardening_exponent, 1.2, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_tables_of_the_paper_have_a_yield_point_of_four_percent),
        cmocka_unit_test(equation_10_is_the_elastic_cantilever),
        cmocka_unit_test(stress_is_modulus_times_strain_in_the_elastic_zone),
        cmocka_unit_test(hollomon_continues_the_elastic_line_at_yield),
        cmocka_unit_test(guess_of_a_bilinear_curve_is_exact),
        cmocka_unit_test(unusable_curves_are_rejected_with_the_reason),
        cmocka_unit_test(the_exponent_is_limited),
    };
    return cmocka_run_group_tests(tests, silence, NULL);
}
