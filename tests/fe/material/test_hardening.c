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

static void all_overstress_is_plastic_where_nothing_grows(void **unused)
{
    (void)unused;
    struct wb_material m = power_law(1e9, 0.5);
    m.hardening = WB_HARDENING_KINEMATIC_LINEAR;
    assert_true(wb_hardening_ratio(&m, m.yield_stress) == 1.0);
    m.hardening = WB_HARDENING_NONE_ELASTIC;
    assert_true(wb_hardening_ratio(&m, m.yield_stress) == 1.0);
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

/* Materials of every law that yields. */
static struct wb_material material_of(enum wb_hardening law)
{
    const struct wb_material m = {law, 5000e6, 0.39, 4e6, 900e6, 0.7};
    return m;
}

static void every_law_has_what_its_surface_needs(void **unused)
{
    (void)unused;
    for (int i = 0; i < WB_HARDENING_LAWS; i++) {
        const struct wb_hardening_law *law = &wb_hardening_laws[i];
        const struct wb_material m = material_of((enum wb_hardening)i);
        assert_ptr_equal(wb_hardening_law(&m), law);
        assert_int_equal(law->name != NULL, law->yields);
        assert_int_equal(law->growth != NULL, law->yields && !law->moves);
        assert_int_equal(law->mean_growth != NULL, law->growth != NULL);
        assert_int_equal(law->ratio != NULL, law->growth != NULL);
        assert_int_equal(law->back_modulus != NULL, law->moves);
        for (int k = 0; k < i; k++)
            assert_false(law->name && wb_hardening_laws[k].name &&
                         strcmp(law->name, wb_hardening_laws[k].name) == 0);
    }
}

static void functions_of_a_growing_surface_agree(void **unused)
{
    (void)unused;
    for (int i = 0; i < WB_HARDENING_LAWS; i++) {
        const struct wb_hardening_law *law = &wb_hardening_laws[i];
        const struct wb_material m = material_of((enum wb_hardening)i);
        for (double p = 1e-4; law->growth && p < 0.2; p *= 3.0) {
            const double step = 1e-5;
            const double up = law->growth(&m, p * exp(step)),
                         down = law->growth(&m, p * exp(-step));
            assert_close(wb_hardening_exponent(&m, p), log(up / down) / (2.0 * step), 1e-8);

            /* d(p mean) / dp is the growth. */
            const double d = 1e-4 * p;
            const double more = (p + d) * law->mean_growth(&m, p + d);
            const double less = (p - d) * law->mean_growth(&m, p - d);
            assert_close_relative((more - less) / (2.0 * d), law->growth(&m, p), 1e-7);
            assert_close(wb_hardening_mean_stress(&m, p), m.yield_stress + law->mean_growth(&m, p),
                         0.0);

            const double c = m.youngs_modulus * p + law->growth(&m, p);
            assert_close_relative(wb_hardening_ratio(&m, c), m.youngs_modulus * p / c, 1e-13);
            assert_close_relative(law->ratio(&m, log(c / m.youngs_modulus), -1.0),
                                  m.youngs_modulus * p / c, 1e-13);
        }
    }
}

static void moduli_are_of_surfaces_that_move(void **unused)
{
    (void)unused;
    const struct wb_material moving = material_of(WB_HARDENING_KINEMATIC_LINEAR);
    const struct wb_material growing = material_of(WB_HARDENING_ISOTROPIC_POWER);
    assert_true(wb_hardening_back_modulus(&moving) == moving.strength_coefficient);
    assert_true(wb_hardening_back_modulus(&growing) == 0.0);
    assert_true(wb_hardening_mean_stress(&moving, 0.1) == moving.yield_stress);
}

static void impossible_numbers_are_named(void **unused)
{
    (void)unused;
    const double nan = (double)NAN, infinite = (double)INFINITY;
    const struct {
        struct wb_material material;
        const char *named; /* NULL: possible */
    } cases[] = {
        {{WB_HARDENING_NONE_ELASTIC, 1.0, 0.3, nan, nan, nan}, NULL},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 1.0, 0.0, 2.0}, NULL},
        {{WB_HARDENING_KINEMATIC_LINEAR, 1.0, 0.3, 1.0, 1.0, nan}, NULL},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 0.0, 1.0, 1.0}, "yield_stress 0 Pa: "},
        {{WB_HARDENING_KINEMATIC_LINEAR, 1.0, 0.3, infinite, 1.0, 1.0}, "yield_stress inf Pa: "},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 1.0, -1.0, 1.0}, "strength_coefficient -1 Pa: "},
        {{WB_HARDENING_KINEMATIC_LINEAR, 1.0, 0.3, 1.0, infinite, 1.0}, "strength_coefficient inf"},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 1.0, 1.0, 0.0}, "hardening_exponent 0: "},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 1.0, 1.0, 2.01}, "hardening_exponent 2.01: "},
        {{WB_HARDENING_ISOTROPIC_POWER, 1.0, 0.3, 1.0, 1.0, nan}, "hardening_exponent "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char why[120] = "";
        const bool possible = wb_hardening_is_possible(&cases[i].material, why, sizeof why);
        assert_int_equal(possible, cases[i].named == NULL);
        if (!possible && strncmp(why, cases[i].named, strlen(cases[i].named)) != 0)
            fail_msg("case %zu: '%s' does not begin with '%s'", i, why, cases[i].named);
    }
}

static double octave_lookup(const double *table, int terms, double x)
{
    int exponent;
    const double t = 2.0 * frexp(x, &exponent) - 1.5;
    double r = 0.0;
    for (int k = terms - 1; k >= 0; k--)
        r = r * t +
            table[k * WB_HARDENING_TABLE_OCTAVES + exponent - 1 - WB_HARDENING_TABLE_LOWEST];
    return r;
}

static void octave_table_agrees_with_the_solved_equation(void **unused)
{
    (void)unused;
    double table[7 * WB_HARDENING_TABLE_OCTAVES], worst = 0.0;
    for (int terms = 6; terms <= 7; terms++) {
        for (double n = terms == 6 ? 0.65 : 0.35; n < 2.0; n += 0.15) {
            const struct wb_material m = power_law(900e6, n);
            assert_int_equal(wb_hardening_tabulate_octaves(&m, terms, table), WB_OK);
            for (double x = ldexp(1.0, -31); x < 2.0; x *= 1.137) {
                const double c = x * m.youngs_modulus, exact = wb_hardening_ratio(&m, c);
                const double error = fabs(octave_lookup(table, terms, x) - exact) * c;
                worst = fmax(worst, error / (m.yield_stress + (1.0 - exact) * c));
            }
        }
    }
    print_message("largest error of the octave table: %.2g of the stress\n", worst);
    assert_true(worst < 1.1e-5);
}

static void octave_table_is_zero_without_growth_and_refuses_what_it_cannot(void **unused)
{
    (void)unused;
    double table[6 * WB_HARDENING_TABLE_OCTAVES] = {1.0};
    const struct wb_material elastic = material_of(WB_HARDENING_NONE_ELASTIC);
    const struct wb_material steep = power_law(900e6, 0.05);
    assert_int_equal(wb_hardening_tabulate_octaves(&elastic, 6, table), WB_OK);
    for (int i = 0; i < 6 * WB_HARDENING_TABLE_OCTAVES; i++)
        assert_true(table[i] == 0.0);
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_hardening_tabulate_octaves(&steep, 6, table), WB_ERR_UNSUPPORTED);
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ratio_solves_its_equation),
        cmocka_unit_test(all_overstress_is_plastic_where_nothing_grows),
        cmocka_unit_test(table_agrees_with_the_solved_equation),
        cmocka_unit_test(table_knows_what_it_covers),
        cmocka_unit_test(ratio_is_one_without_hardening),
        cmocka_unit_test(every_law_has_what_its_surface_needs),
        cmocka_unit_test(functions_of_a_growing_surface_agree),
        cmocka_unit_test(moduli_are_of_surfaces_that_move),
        cmocka_unit_test(impossible_numbers_are_named),
        cmocka_unit_test(octave_table_agrees_with_the_solved_equation),
        cmocka_unit_test(octave_table_is_zero_without_growth_and_refuses_what_it_cannot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
