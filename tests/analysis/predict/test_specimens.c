#include "analysis/predict/specimens_private.h"

#include <stdlib.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sort.h>

#include "analysis/predict/hypercube.h"
#include "base/random.h"
#include "base/units.h"
#include "tests/check.h"

enum {
    Q = WB_SPECIMENS_QUANTITIES,
    DRAWS = 4000
};

static struct wb_specimens specimens;
static double draws[DRAWS][Q], sorted[DRAWS];

/* Specimens whose q scatter with these deviations and one correlation, from random numbers. */
static void make(uint64_t seed, int n, struct wb_material *law)
{
    static const double mean[Q] = {22.2, 15.3, 15.8, 17.2}, deviation[Q] = {0.04, 0.1, 0.06, 0.05};
    const struct wb_material *pointer[WB_SPECIMENS_MOST];
    for (int i = 0; i < n; i++) {
        double q[Q];
        const double common = wb_random_normal(seed, 100, (uint64_t)i);
        for (int k = 0; k < Q; k++)
            q[k] = mean[k] +
                   deviation[k] *
                       (0.8 * common + 0.6 * wb_random_normal(seed, (uint64_t)k, (uint64_t)i));
        law[i] = (struct wb_material){.poissons_ratio = 0.39};
        assert_true(wb_specimens_law(q, 2.0, &law[i]));
        pointer[i] = &law[i];
    }
    wb_specimens_init(&specimens, n, pointer);
}

static void draw_all(int wires)
{
    const int dimensions = wb_specimens_dimensions(&specimens);
    double *const u = calloc(DRAWS, (size_t)dimensions * sizeof *u);
    assert_non_null(u);
    wb_hypercube_fill(11, DRAWS, dimensions, u);
    for (int i = 0; i < DRAWS; i++)
        wb_specimens_draw(&specimens, wires, u + (size_t)i * (size_t)dimensions, draws[i]);
    free(u);
}

/* Standard deviation s of a quantity over the specimens. */
static double spread(int k)
{
    double square = 0.0;
    for (int i = 0; i < specimens.n; i++)
        square += specimens.deviation[i][k] * specimens.deviation[i][k];
    return sqrt(square / (specimens.n - 1));
}

static void a_law_is_recovered_from_its_quantities(void **state)
{
    (void)state;
    const struct wb_material law = {.youngs_modulus = 4528e6,
                                    .yield_stress = 4.52e6,
                                    .strength_coefficient = 1327e6,
                                    .hardening_exponent = 0.9};
    struct wb_material back = {.poissons_ratio = 0.3};
    double q[Q];
    wb_specimens_quantities(&law, q);
    assert_close_relative(exp(q[0]), 4528e6, 1e-12);
    assert_close_relative(exp(q[1]), 4.52e6, 1e-12);
    assert_close_relative(exp(q[2]), 4.52e6 + 1327e6 * pow(1e-3, 0.9), 1e-12);
    assert_close_relative(exp(q[3]), 4.52e6 + 1327e6 * pow(1e-2, 0.9), 1e-12);
    assert_true(wb_specimens_law(q, 2.0, &back));
    assert_close_relative(back.strength_coefficient, 1327e6, 1e-10);
    assert_close_relative(back.hardening_exponent, 0.9, 1e-12);
    assert_close(back.poissons_ratio, 0.3, 0.0);
}

/* The stress at 1e-2 is kept; the other one is changed if necessary. */
static void quantities_without_a_law_give_the_nearest_law(void **state)
{
    (void)state;
    struct wb_material law = {.poissons_ratio = 0.3};
    const double steep[Q] = {22.0, log(4e6), log(4.001e6), log(9e6)};
    assert_false(wb_specimens_law(steep, 2.0, &law));
    assert_close(law.hardening_exponent, 2.0, 0.0);
    assert_close_relative(law.yield_stress + law.strength_coefficient * pow(1e-2, 2.0), 9e6, 1e-12);
    const double straight[Q] = {22.0, log(4e6), log(4.2e6), log(9e6)};
    assert_true(wb_specimens_law(straight, 2.0, &law));
    assert_false(wb_specimens_law(straight, 1.0, &law));
    const double falling[Q] = {22.0, log(4e6), log(3.9e6), log(3.8e6)};
    assert_false(wb_specimens_law(falling, 2.0, &law));
    assert_close(law.strength_coefficient, 0.0, 0.0);
    const double ideal[Q] = {22.0, log(4e6), log(4e6), log(4e6)};
    assert_true(wb_specimens_law(ideal, 2.0, &law));
}

/* Each quantity is t-distributed with n - 1 degrees of freedom and the scale
 * s sqrt(1/n + 1/N), in closed form. */
static void draws_have_the_predictive_t_distribution(void **state)
{
    (void)state;
    static const struct {
        int n, wires;
    } cases[] = {{3, 7}, {5, 1}, {8, 19}};
    static const double parts[] = {0.05, 0.25, 0.5, 0.75, 0.95};
    struct wb_material law[WB_SPECIMENS_MOST];

    for (size_t c = 0; c < 3; c++) {
        const int n = cases[c].n;
        make(c + 1, n, law);
        draw_all(cases[c].wires);
        for (int k = 0; k < Q; k++) {
            const double scale = spread(k) * sqrt(1.0 / n + 1.0 / cases[c].wires);
            for (int i = 0; i < DRAWS; i++)
                sorted[i] = (draws[i][k] - specimens.mean[k]) / scale;
            gsl_sort(sorted, 1, DRAWS);
            for (size_t p = 0; p < 5; p++) {
                /* As a probability: its deviation is at most 0.008 for 4000 random draws. */
                const double at = gsl_cdf_tdist_P(sorted[(int)(parts[p] * DRAWS)], n - 1);
                assert_close(at, parts[p], 0.02);
            }
        }
    }
}

/* q - m over its common scale has the specimens' covariance; rank correlations do not depend on the
 * scale. */
static void draws_keep_the_correlations_of_the_specimens(void **state)
{
    (void)state;
    struct wb_material law[WB_SPECIMENS_MOST];
    make(5, 12, law);
    draw_all(7);
    for (int a = 0; a < Q; a++)
        for (int b = 0; b < a; b++) {
            double expected = 0.0, product = 0.0, square_a = 0.0, square_b = 0.0;
            for (int i = 0; i < specimens.n; i++)
                expected += specimens.deviation[i][a] * specimens.deviation[i][b];
            expected /= (specimens.n - 1) * spread(a) * spread(b);
            for (int i = 0; i < DRAWS; i++) {
                const double p = draws[i][a] - specimens.mean[a],
                             r = draws[i][b] - specimens.mean[b];
                product += p * r;
                square_a += p * p;
                square_b += r * r;
            }
            assert_true(fabs(expected) > 0.2);
            assert_close(product / sqrt(square_a * square_b), expected, 0.05);
        }
}

/* Three specimens span two directions, and draws stay in them: the draws' covariance has the same
 * rank. */
static void directions_in_which_specimens_do_not_differ_stay_exact(void **state)
{
    (void)state;
    struct wb_material law[WB_SPECIMENS_MOST];
    make(5, 3, law);
    /* A vector of q space normal to all deviations: in the first three quantities, the vector
     * product of two deviations. */
    const double *const a = specimens.deviation[0], *const b = specimens.deviation[1];
    const double across[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                              a[0] * b[1] - a[1] * b[0]};
    const double length =
        sqrt(across[0] * across[0] + across[1] * across[1] + across[2] * across[2]);
    draw_all(7);
    for (int i = 0; i < DRAWS; i++) {
        double sum = 0.0, most = 0.0;
        for (int k = 0; k < 3; k++) {
            sum += across[k] / length * (draws[i][k] - specimens.mean[k]);
            most = fmax(most, fabs(draws[i][k] - specimens.mean[k]));
        }
        assert_close(sum, 0.0, 1e-12 + 1e-10 * most);
    }
}

/* Many truths, n specimens of each, and the mean of N further wires: the 90 % interval of the draws
 * contains it in 90 % of the cases. With 2000 cases the standard deviation is 0.7 %. */
static void nine_of_ten_means_of_further_wires_are_in_the_interval(void **state)
{
    (void)state;
    enum {
        CASES = 2000,
        SPECIMENS = 4,
        WIRES = 7,
        RUNS = 200
    };
    static double u[RUNS * (SPECIMENS + 1)], value[RUNS];
    struct wb_material law[SPECIMENS];
    int within = 0;
    wb_hypercube_fill(2, RUNS, SPECIMENS + 1, u);
    for (int c = 0; c < CASES; c++) {
        double truth = 0.0;
        const uint64_t seed = 1000 + (uint64_t)c;
        make(seed, SPECIMENS, law);
        for (int w = 0; w < WIRES; w++) {
            const uint64_t i = 50 + (uint64_t)w;
            truth += (15.8 + 0.06 * (0.8 * wb_random_normal(seed, 100, i) +
                                     0.6 * wb_random_normal(seed, 2, i))) /
                     WIRES;
        }
        for (int i = 0; i < RUNS; i++) {
            double q[Q];
            wb_specimens_draw(&specimens, WIRES, u + (size_t)i * (SPECIMENS + 1), q);
            value[i] = q[2];
        }
        gsl_sort(value, 1, RUNS);
        within += truth > value[10] && truth < value[RUNS - 11];
    }
    print_message("%.3f of %d means within\n", (double)within / CASES, CASES);
    assert_close((double)within / CASES, 0.9, 0.025);
}

/* Laws of all forms, fitted to nothing: 3000 MPa at first, yielding in the range of a bundle. */
static void make_laws(struct wb_law law[4])
{
    static const struct wb_law_part parts[] = {
        {1000e6, 5e-4}, {1500e6, 2e-3}, {300e6, 6e-3}, {200e6, (double)INFINITY}};
    static const struct wb_law_back backs[] = {{2000e6, 300.0}, {200e6, 0.0}};
    static const struct wb_material ludwik = {.hardening = WB_HARDENING_ISOTROPIC_POWER,
                                              .youngs_modulus = 3000e6,
                                              .poissons_ratio = 0.39,
                                              .yield_stress = 3e6,
                                              .strength_coefficient = 500e6,
                                              .hardening_exponent = 0.8};
    wb_law_init_ludwik(&law[0], &ludwik);
    wb_law_init_parallel(&law[1], parts, 4, 0.0, 0.39);
    wb_law_init_parallel(&law[2], parts, 3, 0.2, 0.39);
    law[2].is_combined = true;
    wb_law_init_chaboche(&law[3], &ludwik, 2e6, 100.0, backs, 2);
}

static void laws_of_all_forms_stay_with_the_mean_of_the_specimens(void **state)
{
    (void)state;
    struct wb_material material[5];
    struct wb_law laws[4];
    make(1, 5, material);
    make_laws(laws);
    for (int i = 0; i < 4; i++) {
        struct wb_law law = laws[i];
        (void)wb_specimens_shift(&specimens, specimens.mean, &law);
        for (double e = 1e-4; e < 0.03; e *= 1.3)
            assert_close_relative(wb_law_virgin_stress(&law, e, NULL),
                                  wb_law_virgin_stress(&laws[i], e, NULL), 1e-9);
    }
}

/* Stress at a strain over the nominal one, relative to the same ratio of the two Ludwik laws. */
static double relative_change(const struct wb_law *law, const struct wb_law *nominal,
                              const struct wb_law *to, const struct wb_law *from, double e)
{
    return wb_law_virgin_stress(law, e, NULL) / wb_law_virgin_stress(nominal, e, NULL) /
           (wb_law_virgin_stress(to, e, NULL) / wb_law_virgin_stress(from, e, NULL));
}

/* Chaboche's law has the changed stress at a strain of 1e-2; parallel parts have it at the yield
 * strains, but for the few draws with a part that would soften. */
static void laws_of_all_forms_follow_the_draw(void **state)
{
    (void)state;
    static const double yields[] = {5e-4, 2e-3, 6e-3};
    struct wb_material material[5], mean = {.hardening = WB_HARDENING_ISOTROPIC_POWER}, drawn;
    struct wb_law laws[4], from, to;
    int n = 0, n_exact = 0;
    make(1, 5, material);
    make_laws(laws);
    draw_all(1);
    drawn = mean;
    assert_true(wb_specimens_law(specimens.mean, 2.0, &mean));
    wb_law_init_ludwik(&from, &mean);
    for (int k = 0; k < 400; k++) {
        (void)wb_specimens_law(draws[k], 2.0, &drawn);
        wb_law_init_ludwik(&to, &drawn);
        for (int i = 0; i < 4; i++) {
            struct wb_law law = laws[i];
            (void)wb_specimens_shift(&specimens, draws[k], &law);
            assert_int_equal(wb_law_check(&law, NULL), WB_OK);
            if (i == 0 || i == 3)
                assert_close_relative(law.material.youngs_modulus / laws[i].material.youngs_modulus,
                                      drawn.youngs_modulus / mean.youngs_modulus, 1e-12);
            if (i == 3)
                assert_close(relative_change(&law, &laws[i], &to, &from, 1e-2), 1.0, 1e-9);
            for (int y = 0; y < 3 && (i == 1 || i == 2); y++, n++)
                n_exact +=
                    fabs(relative_change(&law, &laws[i], &to, &from, yields[y]) - 1.0) < 1e-9;
        }
    }
    print_message("parallel parts: %d of %d stresses are those of the draw\n", n_exact, n);
    assert_true(n_exact > 0.9 * n);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_law_is_recovered_from_its_quantities),
        cmocka_unit_test(quantities_without_a_law_give_the_nearest_law),
        cmocka_unit_test(draws_have_the_predictive_t_distribution),
        cmocka_unit_test(draws_keep_the_correlations_of_the_specimens),
        cmocka_unit_test(directions_in_which_specimens_do_not_differ_stay_exact),
        cmocka_unit_test(laws_of_all_forms_stay_with_the_mean_of_the_specimens),
        cmocka_unit_test(laws_of_all_forms_follow_the_draw),
        cmocka_unit_test(nine_of_ten_means_of_further_wires_are_in_the_interval),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
