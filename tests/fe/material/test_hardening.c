#include "fe/material/hardening.h"

#include <stdlib.h>

#include "tests/check.h"

static struct wb_material power_law(double K, double n)
{
    const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 5000e6, 0.39, 4e6, K, n};
    return m;
}

static const double exponents[] = {0.05, 0.1,  0.2, 0.249, 0.26, 0.39, 0.41,
                                   0.7,  0.99, 1.0, 1.2,   1.5,  2.0};
static const double coefficients[] = {1e6, 1e7, 1e8, 1e9, 1e10, 1e11};
enum {
    N_EXPONENTS = sizeof exponents / sizeof exponents[0],
    N_COEFFICIENTS = sizeof coefficients / sizeof coefficients[0]
};

static void ratio_solves_its_equation(void **unused)
{
    (void)unused;
    for (int i = 0; i < N_EXPONENTS; i++) {
        for (int j = 0; j < N_COEFFICIENTS; j++) {
            const struct wb_material m = power_law(coefficients[j], exponents[i]);
            for (double c = 1e-3 * m.yield_stress; c < 1e4 * m.yield_stress; c *= 3.7) {
                const double r = wb_hardening_ratio(&m, c);
                const double p = r * c / m.youngs_modulus;
                const double sum =
                    m.youngs_modulus * p + m.strength_coefficient * pow(p, exponents[i]);
                assert_true(r > 0.0 && r <= 1.0);
                assert_close(sum / c, 1.0, 1e-13);
            }
        }
    }
}

static void table_agrees_with_the_solved_equation(void **unused)
{
    (void)unused;
    struct wb_hardening_table *table = malloc(sizeof *table);
    double worst = 0.0;
    assert_non_null(table);

    for (int i = 0; i < N_EXPONENTS; i++) {
        for (int j = 0; j < N_COEFFICIENTS; j++) {
            const struct wb_material m = power_law(coefficients[j], exponents[i]);
            wb_hardening_tabulate(table, &m);
            const double begin = ldexp(1.0, WB_HARDENING_LOWEST_OCTAVE);
            const double end = ldexp(begin, WB_HARDENING_OCTAVES);
            for (double z = begin; z < end; z *= 1.00371) {
                const double r = wb_hardening_lookup(table, z);
                const double exact = wb_hardening_ratio(&m, z * m.yield_stress);
                worst = fmax(worst, fabs(r - exact));
            }
        }
    }
    print_message("largest error of the table: %.2g of the overstress\n", worst);
    assert_true(worst < 1e-14);
    free(table);
}

static void table_knows_what_it_covers(void **unused)
{
    (void)unused;
    struct wb_hardening_table *table = malloc(sizeof *table);
    const struct wb_material m = power_law(1e9, 0.9);
    const double begin = ldexp(1.0, WB_HARDENING_LOWEST_OCTAVE);
    const double end = ldexp(begin, WB_HARDENING_OCTAVES);
    const double outside[] = {
        0.0, -1.0, 0.999 * begin, end, (double)INFINITY, -(double)INFINITY, (double)NAN};
    assert_non_null(table);
    wb_hardening_tabulate(table, &m);
    assert_true(wb_hardening_covers(begin) && wb_hardening_covers(0.999 * end));
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        assert_false(wb_hardening_covers(outside[i]));
        /* Of no meaning there, but no access outside the table either. */
        assert_true(isfinite(wb_hardening_lookup(table, outside[i])));
    }
    free(table);
}

static void ratio_is_one_without_hardening(void **unused)
{
    (void)unused;
    const struct wb_material m = power_law(0.0, 0.5);
    assert_true(wb_hardening_ratio(&m, 1e6) == 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratio_solves_its_equation),
        cmocka_unit_test(table_agrees_with_the_solved_equation),
        cmocka_unit_test(table_knows_what_it_covers),
        cmocka_unit_test(ratio_is_one_without_hardening),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
