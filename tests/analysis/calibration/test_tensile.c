/* Tensile curves of known laws in closed form: at plastic strain ep the true stress is sigma =
 * sigma_Y + K ep^n and the true strain ep + sigma/E, so that e = exp(eps) - 1 and S = sigma / (1 +
 * e). */
#include "analysis/calibration/constituents/tensile.h"

#include <stdlib.h>

#include "analysis/calibration/constituents/tensile_material.h"
#include "base/file.h"
#include "base/units.h"
#include "fe/material/material_file.h"
#include "tests/messages.h"
#include "tests/own_folder.h"

#define LENGTH 0.05
#define AREA 0.326e-6

struct truth {
    double modulus, yield, strength, exponent, largest; /* Pa, Pa, Pa, 1, plastic strain */
    double slack;                                       /* strain */
    double compliance;                                  /* m/N of the machine */
    double noise;                                       /* N */
};

static const struct truth copper = {70e9, 100e6, 300e6, 0.5, 0.15, 0.004, 0.0, 0.0};

static struct wb_dataset datasets[3];
static struct wb_tensile_result result;
static struct wb_tensile_settings settings;
static struct wb_reason why;

static void add(struct wb_dataset *dataset, const struct truth *truth, double e, double stress)
{
    const double force = stress * AREA;
    const double tremble = (dataset->n_rows % 2 ? 1.0 : -1.0) * truth->noise;
    const struct wb_row row = {
        .t = (double)NAN,
        .cycle = 1,
        .phase = WB_PHASE_LOAD,
        .deflection = LENGTH * (e + truth->slack) + truth->compliance * force,
        .tension = force + tremble,
        .force = force + tremble,
        .stage = (double)NAN,
        .tip_x = (double)NAN,
        .tip_angle = (double)NAN,
    };
    wb_dataset_add_row(dataset, &row);
}

static void make(struct wb_dataset *dataset, const struct truth *truth, int sample, bool own)
{
    wb_dataset_release(dataset);
    wb_dataset_init(dataset);
    struct wb_test_info *const info = &dataset->info;
    strcpy(info->wire, "made up");
    info->sample = sample;
    info->kind = info->machine.kind = WB_TEST_TENSILE;
    info->has_machine = true;
    info->length = info->machine.gauge_length = LENGTH;
    info->machine.own_elongation = own;
    info->piece.area = AREA;
    info->piece.constituent = WB_CONDUCTOR;
    info->outer_diameter = 1e-3;
    for (int i = 0; i < 10; i++)
        add(dataset, truth, -truth->slack * (1.0 - 0.1 * i), 0.0);
    for (int i = 0; i < 30; i++) {
        const double sigma = truth->yield * i / 30.0, e = expm1(sigma / truth->modulus);
        add(dataset, truth, e, sigma / (1.0 + e));
    }
    for (int i = 0; i <= 400; i++) {
        const double plastic = truth->largest * pow(i / 400.0, 2.0);
        const double sigma = truth->yield + truth->strength * pow(plastic, truth->exponent);
        const double e = expm1(plastic + sigma / truth->modulus);
        add(dataset, truth, e, sigma / (1.0 + e));
    }
}

static enum wb_status run(int n)
{
    const struct wb_dataset *const pointers[3] = {&datasets[0], &datasets[1], &datasets[2]};
    wb_tensile_release(&result);
    memset(&why, 0, sizeof why);
    return wb_tensile_run(&result, pointers, n, &settings, &why);
}

static void the_numbers_of_a_synthetic_curve_are_recovered(void **state)
{
    (void)state;
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    make(&datasets[0], &copper, 1, true);
    assert_int_equal(run(1), WB_OK);
    const struct wb_tensile_specimen *const s = &result.specimens[0];
    /* The engineering curve of the start deviates from a line by eps: 1.4e-3 at yield. */
    assert_close_relative(s->slope, copper.modulus, 3e-3);
    assert_close(s->slack, copper.slack, 1e-5);
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        assert_close_relative(s->stress[k], 100e6 + 300e6 * sqrt(wb_tensile_plastic_strains[k]),
                              2e-3);
    assert_close_relative(s->direct.yield_stress, 100e6, 5e-3);
    assert_close_relative(s->direct.strength_coefficient, 300e6, 5e-3);
    assert_close_relative(s->direct.hardening_exponent, 0.5, 5e-3);
    assert_true(s->direct.rms < 1e5);
    /* S and e of the offset line: e = S/E + 0.002. */
    const double sigma = 100e6 + 300e6 * sqrt(0.002);
    assert_close_relative(s->proof_stress, sigma, 5e-3);
    assert_close_relative(result.youngs_modulus.mean, copper.modulus, 3e-3);
    assert_true(isnan(result.youngs_modulus.low));
}

static void strength_is_the_largest_force_over_the_area(void **state)
{
    (void)state;
    const double sigma = 100e6 + 300e6 * sqrt(0.15), e = expm1(0.15 + sigma / 70e9);
    wb_tensile_default_settings(&settings);
    make(&datasets[0], &copper, 1, true);
    /* The specimen necks after the largest force: these rows are left out. */
    add(&datasets[0], &copper, e + 0.01, 100e6);
    add(&datasets[0], &copper, e + 0.02, 50e6);
    assert_int_equal(run(1), WB_OK);
    assert_close_relative(result.strength.mean, sigma / (1.0 + e), 1e-9);
    assert_close_relative(result.uniform_strain.mean, e, 1e-3);
}

static void eq_7_with_the_true_yield_stress_gives_k_and_n(void **state)
{
    (void)state;
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    settings.proof_offset = 1e-5; /* the proof stress is then within 1 % of the yield stress */
    settings.fit_from = 0.005;
    make(&datasets[0], &copper, 1, true);
    assert_int_equal(run(1), WB_OK);
    assert_close_relative(result.specimens[0].eq7.hardening_exponent, 0.5, 0.03);
    assert_close_relative(result.specimens[0].eq7.strength_coefficient, 300e6, 0.03);
    /* With the usual offset sigma_Y is larger, and n is too large: a bias of eq. 7. */
    settings.proof_offset = 0.002;
    assert_int_equal(run(1), WB_OK);
    assert_true(result.specimens[0].eq7.hardening_exponent > 0.55);
}

static void a_crosshead_gives_no_modulus_but_the_same_plastic_curve(void **state)
{
    (void)state;
    struct truth truth = copper;
    truth.compliance = 5e-6;
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    make(&datasets[0], &truth, 1, false);
    assert_int_equal(run(1), WB_OK);
    assert_int_equal(result.youngs_modulus.n, 0);
    assert_true(isnan(result.youngs_modulus.mean));
    /* The slope is that of specimen and machine in series. */
    const double expected = 1.0 / (1.0 / 70e9 + 5e-6 * AREA / LENGTH);
    assert_close_relative(result.slope.mean, expected, 5e-3);
    for (int k = 0; k < WB_TENSILE_STRESSES; k++)
        assert_close_relative(result.stress[k].mean,
                              100e6 + 300e6 * sqrt(wb_tensile_plastic_strains[k]), 4e-3);
    assert_close_relative(result.direct_exponent.mean, 0.5, 0.03);
    /* A known compliance is subtracted; that of the grips remains, so there is still no E. */
    datasets[0].info.machine.compliance = (struct wb_band){true, 5e-6, 5e-6, 5e-6};
    assert_int_equal(run(1), WB_OK);
    assert_int_equal(result.youngs_modulus.n, 0);
    assert_close_relative(result.slope.mean, 70e9, 5e-3);
    /* An extensometer does not measure the machine's deformation. */
    make(&datasets[0], &copper, 1, true);
    datasets[0].info.machine.compliance = (struct wb_band){true, 5e-6, 5e-6, 5e-6};
    assert_int_equal(run(1), WB_OK);
    assert_close_relative(result.youngs_modulus.mean, 70e9, 3e-3);
}

static void the_range_of_exponents_that_fit_alike_is_found(void **state)
{
    (void)state;
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    make(&datasets[0], &copper, 1, true);
    /* Within 1 % of the strength many exponents fit the curve; within 0.05 % only one does. */
    assert_int_equal(run(1), WB_OK);
    assert_true(result.follows);
    assert_false(result.identifiable);
    assert_true(result.n_low < 0.42 && result.n_high > 0.6);
    settings.alike = 5e-4;
    assert_int_equal(run(1), WB_OK);
    assert_true(result.identifiable);
    assert_true(result.n_low > 0.45 && result.n_low < 0.5 && result.n_high > 0.5 &&
                result.n_high < 0.55);
    /* With noise above that, none fits. */
    struct truth noisy = copper;
    noisy.noise = 0.1;
    make(&datasets[0], &noisy, 1, true);
    assert_int_equal(run(1), WB_OK);
    assert_false(result.follows);
    assert_int_equal(result.n_followed, 0);
    assert_true(isnan(result.n_low) && isnan(result.of_mean_n_low));
    /* Together with a curve that is fitted it counts as not fitted. */
    settings.alike = 0.01;
    make(&datasets[0], &copper, 1, true);
    noisy.noise = 0.8;
    make(&datasets[1], &noisy, 2, true);
    assert_int_equal(run(2), WB_OK);
    assert_false(result.follows);
    assert_int_equal(result.n_followed, 1);
    assert_true(result.of_mean_n_low < 0.5 && result.of_mean_n_high > 0.5);
}

/* Rubber: the curve bends over from the first row, to a tenth of its slope. With a preload,
 * however, a straight start stays straight. */
static void a_curved_start_has_no_plastic_strain(void **state)
{
    (void)state;
    struct wb_tensile_material_settings material = {4e6, 1100.0, (double)NAN};
    wb_tensile_default_settings(&settings);
    make(&datasets[0], &copper, 1, false);
    datasets[0].n_rows = 0;
    for (int i = 0; i <= 100; i++) {
        const double e = 0.03 * i;
        add(&datasets[0], &copper, e, 2e6 * e + 1e6 * (1.0 - exp(-e / 0.1)));
    }
    assert_int_equal(run(1), WB_OK);
    assert_false(result.specimens[0].start_is_straight);
    assert_false(result.follows);
    assert_int_equal(result.proof_stress.n, 0);
    assert_int_equal(result.stress[0].n, 0);
    assert_int_equal(result.direct_exponent.n, 0);
    assert_close_relative(result.strength.mean, 7e6, 1e-3);
    assert_int_equal(wb_tensile_material_write(&result, NULL, &material, folder, &why),
                     WB_ERR_DATA);
    assert_non_null(strstr(why.text, "sample 1: the start"));

    make(&datasets[0], &copper, 1, true);
    size_t first = 0;
    while (datasets[0].rows[first].force < 50e6 * AREA)
        first++;
    const double zero = datasets[0].rows[first].deflection;
    datasets[0].n_rows -= first;
    memmove(datasets[0].rows, datasets[0].rows + first, datasets[0].n_rows * sizeof(struct wb_row));
    for (size_t i = 0; i < datasets[0].n_rows; i++)
        datasets[0].rows[i].deflection -= zero;
    settings.stretch = 0.15;
    assert_int_equal(run(1), WB_OK);
    assert_true(result.specimens[0].slack < 0.0);
    assert_true(result.specimens[0].start_is_straight);
    assert_close_relative(result.youngs_modulus.mean, 70e9, 5e-3);
}

static void intervals_are_those_of_the_mean_of_logarithms(void **state)
{
    (void)state;
    static const double factors[3] = {0.9, 1.0, 1.1};
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < 3; i++) {
        struct truth truth = copper;
        truth.yield *= factors[i];
        truth.strength *= factors[i];
        make(&datasets[i], &truth, i + 1, true);
        sum += log(factors[i]);
        squares += log(factors[i]) * log(factors[i]);
    }
    assert_int_equal(run(3), WB_OK);
    const double mean = sum / 3.0, s = sqrt((squares - 3.0 * mean * mean) / 2.0);
    const double half = 4.302653 * s / sqrt(3.0); /* t of 0.975, two degrees of freedom */
    assert_int_equal(result.stress[1].n, 3);
    assert_close_relative(result.stress[1].mean, 130e6 * exp(mean), 2e-3);
    /* All three curves are multiples of one, and so is their mean. */
    assert_close_relative(result.of_mean.yield_stress, 100e6, 0.01);
    assert_close_relative(result.of_mean.strength_coefficient, 300e6, 0.01);
    assert_close_relative(result.of_mean.hardening_exponent, 0.5, 0.01);
    assert_close_relative(log(result.stress[1].high / result.stress[1].low), 2.0 * half, 0.02);
}

static void other_tests_and_mixtures_are_rejected(void **state)
{
    (void)state;
    wb_tensile_default_settings(&settings);
    make(&datasets[0], &copper, 1, true);
    make(&datasets[1], &copper, 2, true);
    datasets[1].info.piece.constituent = WB_JACKET;
    assert_int_equal(run(2), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "are not specimens of one constituent"));
    datasets[1].info.kind = WB_TEST_THREE_POINT;
    assert_int_equal(run(2), WB_ERR_UNSUPPORTED);
    assert_non_null(strstr(why.text, "sample 2 is a three-point test"));
    make(&datasets[0], &copper, 1, true);
    datasets[0].n_rows = 3;
    assert_int_equal(run(1), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "too few"));
}

static void a_material_file_contains_origin_and_intervals(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_material_file file;
    struct wb_tensile_material_settings material = {0.0, 8960.0, 0.34};
    wb_tensile_default_settings(&settings);
    settings.stretch = 0.3;
    for (int i = 0; i < 3; i++) {
        struct truth truth = copper;
        truth.yield *= 0.9 + 0.1 * i;
        make(&datasets[i], &truth, i + 1, false);
    }
    assert_int_equal(run(3), WB_OK);
    assert_int_equal(wb_file_join(path, folder, "m.yaml"), WB_OK);
    memset(&why, 0, sizeof why);
    assert_int_equal(wb_tensile_material_write(&result, NULL, &material, path, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "--youngs-modulus-mpa"));
    material.youngs_modulus = 117e9;
    assert_int_equal(wb_tensile_material_write(&result, "odd: \"name\"", &material, path, &why),
                     WB_OK);
    assert_int_equal(wb_material_file_read(&file, path), WB_OK);
    assert_string_equal(file.name, "odd: \"name\"");
    assert_string_equal(file.origin, "tensile tests");
    assert_close_relative(file.material.youngs_modulus, 117e9, 1e-5);
    assert_close_relative(file.material.yield_stress, result.of_mean.yield_stress, 1e-5);
    assert_close_relative(file.material.hardening_exponent, result.of_mean.hardening_exponent,
                          1e-5);
    assert_close_relative(file.interval[WB_MATERIAL_YIELD][0], result.direct_yield.low, 1e-3);
    assert_close_relative(file.interval[WB_MATERIAL_EXPONENT][1], result.direct_exponent.high,
                          1e-3);
    assert_true(isnan(file.interval[WB_MATERIAL_MODULUS][0]));
}

static int finish(void **state)
{
    for (int i = 0; i < 3; i++)
        wb_dataset_release(&datasets[i]);
    wb_tensile_release(&result);
    return remove_folder(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_numbers_of_a_synthetic_curve_are_recovered),
        cmocka_unit_test(strength_is_the_largest_force_over_the_area),
        cmocka_unit_test(eq_7_with_the_true_yield_stress_gives_k_and_n),
        cmocka_unit_test(a_crosshead_gives_no_modulus_but_the_same_plastic_curve),
        cmocka_unit_test(the_range_of_exponents_that_fit_alike_is_found),
        cmocka_unit_test(a_curved_start_has_no_plastic_strain),
        cmocka_unit_test(intervals_are_those_of_the_mean_of_logarithms),
        cmocka_unit_test(other_tests_and_mixtures_are_rejected),
        cmocka_unit_test(a_material_file_contains_origin_and_intervals),
    };
    return cmocka_run_group_tests(tests, make_folder, finish);
}
