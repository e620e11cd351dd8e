/* The compliance of a machine from computed tests of steel bars. */
#include "analysis/calibration/three_point/machine_compliance.h"

#include <stdlib.h>

#include "base/units.h"
#include "fe/rod/section.h"
#include "fe/trial/three_point_bending.h"
#include "tests/check.h"
#include "tests/fe/rod/wires.h"

enum {
    MOST = 3,
    READINGS = 80
};

static const double span = 40e-3, roller = 2e-3, modulus = 200e9, true_compliance = 2e-6;

struct bar {
    double diameter; /* m */
    double noise;    /* m of travel */
    double scatter;  /* of the compliance between tests */
    double yield;    /* Pa; 0: elastic */
    double exponent; /* of its hardening; 0: one half */
    bool with_unloading;
    double slip;   /* m, at the turn */
    double softer; /* m/N, during unloading, from a fifth of the largest force on */
};

static struct wb_dataset datasets[MOST];

static double rigidity_of(double diameter)
{
    return modulus * M_PI * pow(diameter, 4) / 64.0;
}

static void make(struct wb_dataset *dataset, const struct bar *bar, int index)
{
    static uint64_t random = 20261123;
    const struct wb_material steel = {
        .hardening = bar->yield > 0.0 ? WB_HARDENING_ISOTROPIC_POWER : WB_HARDENING_NONE_ELASTIC,
        .youngs_modulus = modulus,
        .yield_stress = bar->yield,
        .strength_coefficient = bar->exponent > 0.0 ? 100e9 : 1e9,
        .hardening_exponent = bar->exponent > 0.0 ? bar->exponent : 0.5,
        .poissons_ratio = 0.3,
    };
    const struct wb_band unknown = {false, (double)NAN, (double)NAN, (double)NAN};
    struct wb_section section;
    struct wb_three_point_bending *bending;
    double largest = 0.0;
    wb_dataset_init(dataset);
    dataset->info = (struct wb_test_info){.wire = "bar",
                                          .sample = index + 1,
                                          .length = span,
                                          .outer_diameter = bar->diameter,
                                          .kind = WB_TEST_THREE_POINT,
                                          .has_machine = true,
                                          .machine = {.kind = WB_TEST_THREE_POINT,
                                                      .span = span,
                                                      .roller_radius = roller,
                                                      .nose_radius = {true, 2e-3, 2e-3, 2e-3},
                                                      .friction = {true, 0.2, 0.1, 0.3},
                                                      .compliance = unknown,
                                                      .speed = unknown}};
    assert_int_equal(wb_section_init_circle(&section, bar->diameter, &steel, 40), WB_OK);
    const struct wb_three_point_bending_model model = {
        .section = &section,
        .diameter = bar->diameter,
        .span = span,
        .support_radius = roller,
        .nose_radius = 2e-3,
        .friction = 0.2,
        .compliance = true_compliance * (1.0 + bar->scatter * (index - 1)),
    };
    assert_int_equal(wb_three_point_bending_create(&bending, &model), WB_OK);
    wb_section_release(&section);
    for (int i = 0; i <= (bar->with_unloading ? 2 : 1) * READINGS; i++) {
        struct wb_three_point_bending_point point;
        const double part = (double)(i <= READINGS ? i : 2 * READINGS - i) / READINGS;
        assert_int_equal(wb_three_point_bending_move(bending, 0.1e-3 * part, &point), WB_OK);
        assert_int_equal(point.end, WB_THREE_POINT_BENDING_CONVERGED);
        largest = fmax(largest, point.force);
        const double back =
            i > READINGS ? bar->slip + bar->softer * (point.force - 0.2 * largest) : 0.0;
        const struct wb_row row = {.cycle = 1,
                                   .deflection = 0.3e-3 + point.travel + back +
                                                 bar->noise * (2.0 * test_random(&random) - 1.0),
                                   .force = point.force + 5.0}; /* the cell is not zeroed */
        wb_dataset_add_row(dataset, &row);
    }
    wb_three_point_bending_destroy(bending);
}

static enum wb_status find(struct wb_machine_compliance *c, const struct bar *bar, int n,
                           double rigidity_error, struct wb_reason *why)
{
    const struct wb_dataset *pointers[MOST];
    const struct wb_machine_compliance_settings settings = {.rigidity = rigidity_of(bar->diameter),
                                                            .rigidity_error = rigidity_error,
                                                            .from_force = 0.2};
    for (int i = 0; i < n; i++) {
        make(&datasets[i], bar, i);
        pointers[i] = &datasets[i];
    }
    const enum wb_status status = wb_machine_compliance_find(c, pointers, n, &settings, why);
    for (int i = 0; i < n; i++)
        wb_dataset_release(&datasets[i]);
    return status;
}

static void print(const struct wb_machine_compliance *c)
{
    print_message("%.3g mm/N (%.3g to %.3g), true %.3g; bar %.3g; halves: readings %.2g, rigidity "
                  "%.2g, friction %.2g\n",
                  1e3 * c->value, 1e3 * c->low, 1e3 * c->high, 1e3 * true_compliance,
                  1e3 * c->of_bar, 1e3 * c->of_readings, 1e3 * c->of_rigidity,
                  1e3 * c->of_friction);
}

static void compliance_is_found_within_its_interval(void **unused)
{
    (void)unused;
    const struct bar bars[] = {
        {6e-3, 0.0, 0.0, 0.0}, {6e-3, 1e-6, 0.0, 0.0}, {4e-3, 1e-6, 0.0, 0.0}};
    for (size_t i = 0; i < sizeof bars / sizeof *bars; i++) {
        struct wb_machine_compliance c;
        assert_int_equal(find(&c, &bars[i], 1, 0.02, NULL), WB_OK);
        print(&c);
        assert_true(c.is_straight && c.is_identifiable);
        assert_true(c.low < true_compliance && true_compliance < c.high);
        assert_close_relative(c.value, true_compliance, i == 0 ? 2e-3 : 0.02);
        assert_close_relative(c.of_rigidity,
                              0.02 * pow(span, 3) / (48.0 * rigidity_of(bars[i].diameter)), 1e-9);
    }
}

static void with_a_compliant_bar_the_compliance_is_not_identifiable(void **unused)
{
    (void)unused;
    const struct bar bar = {1e-3, 0.0, 0.0, 0.0};
    struct wb_machine_compliance c;
    assert_int_equal(find(&c, &bar, 1, 0.02, NULL), WB_OK);
    print(&c);
    assert_false(c.is_identifiable);
    assert_true(c.low < 0.0 && c.high > true_compliance);
    assert_true(c.of_rigidity > c.of_readings);
}

static void with_a_yielding_bar_the_compliance_is_not_identifiable(void **unused)
{
    (void)unused;
    const struct bar bar = {6e-3, 0.0, 0.0, 100e6};
    struct wb_machine_compliance c;
    assert_int_equal(find(&c, &bar, 1, 0.02, NULL), WB_OK);
    print(&c);
    assert_true(!c.is_straight && !c.is_identifiable && c.low > 0.0);
}

/* It yields at a fiftieth of its largest force, with linear hardening: its loading is a line. */
static void a_bar_that_yields_early_is_not_reversible(void **unused)
{
    (void)unused;
    struct bar bar = {4e-3, 0.2e-6, 0.0, 5e6, .exponent = 1.0};
    struct wb_machine_compliance c;
    assert_int_equal(find(&c, &bar, 1, 0.02, NULL), WB_OK);
    print(&c);
    assert_true(c.is_straight && !c.has_unloading && c.is_identifiable);
    assert_false(c.low < true_compliance);
    bar.with_unloading = true;
    assert_int_equal(find(&c, &bar, 1, 0.02, NULL), WB_OK);
    print_message("back %.3g mm/N, left %.3g of %.3g mm\n", 1e3 * c.value_unloading,
                  1e3 * c.residual, 1e3 * c.most_travel);
    assert_true(c.is_straight && c.has_unloading && !c.is_reversible && !c.is_identifiable);
    assert_close_relative(c.value_unloading, true_compliance, 0.1);
    assert_true(c.residual > 0.1 * c.most_travel);
}

static void slip_and_another_slope_are_detected(void **unused)
{
    (void)unused;
    const struct bar bars[] = {{6e-3, 0.0, 0.0, 0.0, .with_unloading = true, .slip = -0.08e-3},
                               {6e-3, 0.0, 0.0, 0.0, .with_unloading = true, .slip = 0.08e-3},
                               {6e-3, 0.0, 0.0, 0.0, .with_unloading = true, .softer = -0.1e-6}};
    for (size_t i = 0; i < sizeof bars / sizeof *bars; i++) {
        struct wb_machine_compliance c;
        assert_int_equal(find(&c, &bars[i], 1, 0.02, NULL), WB_OK);
        assert_true(c.is_straight && !c.is_reversible && !c.is_identifiable);
        assert_close_relative(c.value_unloading, true_compliance + bars[i].softer, 0.01);
        assert_close(c.residual, bars[i].slip, 0.01e-3);
    }
}

static void an_elastic_bar_is_reversible(void **unused)
{
    (void)unused;
    const struct bar bars[] = {{6e-3, 0.0, 0.0, 0.0, .with_unloading = true},
                               {6e-3, 2e-6, 0.0, 0.0, .with_unloading = true},
                               {4e-3, 1e-6, 0.0, 0.0, .with_unloading = true}};
    for (size_t i = 0; i < sizeof bars / sizeof *bars; i++) {
        struct wb_machine_compliance c;
        assert_int_equal(find(&c, &bars[i], 1, 0.02, NULL), WB_OK);
        print_message("back %.3g mm/N, left %.3g of %.3g mm\n", 1e3 * c.value_unloading,
                      1e3 * c.residual, 1e3 * c.most_travel);
        assert_true(c.has_unloading && c.is_reversible && c.is_identifiable);
        assert_close_relative(c.value_unloading, true_compliance, 0.03);
        assert_close_relative(c.strain, 6.0 * bars[i].diameter * 0.1e-3 / (span * span), 0.05);
    }
}

static void the_first_cycle_is_used(void **unused)
{
    (void)unused;
    const struct bar bar = {6e-3, 0.0, 0.0, 0.0, .with_unloading = true};
    const struct wb_machine_compliance_settings settings = {
        .rigidity = rigidity_of(bar.diameter), .rigidity_error = 0.02, .from_force = 0.2};
    const struct wb_dataset *const pointer = &datasets[0];
    struct wb_machine_compliance c;
    make(&datasets[0], &bar, 0);
    /* A second loading, further, after a slip. */
    for (size_t i = 0, n = datasets[0].n_rows; i < n; i++) {
        struct wb_row row = datasets[0].rows[i];
        row.cycle = 2;
        row.deflection = 1.3 * row.deflection + 0.2e-3;
        row.force *= 1.2;
        wb_dataset_add_row(&datasets[0], &row);
    }
    assert_int_equal(wb_machine_compliance_find(&c, &pointer, 1, &settings, NULL), WB_OK);
    assert_true(c.has_unloading && c.is_reversible && c.is_identifiable);
    assert_close_relative(c.value, true_compliance, 2e-3);
    wb_dataset_release(&datasets[0]);
}

static void several_tests_scatter(void **unused)
{
    (void)unused;
    const struct bar bar = {6e-3, 0.0, 0.1, 0.0};
    struct wb_machine_compliance c;
    assert_int_equal(find(&c, &bar, 3, 1e-3, NULL), WB_OK);
    print(&c);
    assert_int_equal(c.n_tests, 3);
    /* For 0.9, 1 and 1.1: t of two degrees of freedom, 4.303, over the root of three. */
    assert_close_relative(c.of_readings, 4.303 * 0.1 * true_compliance / sqrt(3.0), 0.01);
    assert_close_relative(c.value, true_compliance, 0.01);
}

static void unusable_tests_are_rejected(void **unused)
{
    (void)unused;
    const struct bar bar = {6e-3, 0.0, 0.0, 0.0};
    struct wb_machine_compliance_settings settings = {.rigidity_error = 0.02, .from_force = 0.2};
    const struct wb_dataset *const pointers[] = {&datasets[0], &datasets[1]};
    struct wb_machine_compliance c;
    struct wb_reason why;
    make(&datasets[0], &bar, 0);
    make(&datasets[1], &bar, 1);
    assert_int_equal(wb_machine_compliance_find(&c, pointers, 2, &settings, &why), WB_ERR_ARGUMENT);
    assert_non_null(strstr(why.text, "--rigidity-n-mm2"));
    settings.rigidity = rigidity_of(bar.diameter);
    datasets[1].info.length = 2.0 * span;
    assert_int_equal(wb_machine_compliance_find(&c, pointers, 2, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "one bar on one bench"));
    datasets[0].n_rows = 5;
    assert_int_equal(wb_machine_compliance_find(&c, pointers, 1, &settings, &why), WB_ERR_DATA);
    assert_non_null(strstr(why.text, "readings above"));
    wb_dataset_release(&datasets[0]);
    wb_dataset_release(&datasets[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(compliance_is_found_within_its_interval),
        cmocka_unit_test(with_a_compliant_bar_the_compliance_is_not_identifiable),
        cmocka_unit_test(with_a_yielding_bar_the_compliance_is_not_identifiable),
        cmocka_unit_test(a_bar_that_yields_early_is_not_reversible),
        cmocka_unit_test(slip_and_another_slope_are_detected),
        cmocka_unit_test(an_elastic_bar_is_reversible),
        cmocka_unit_test(the_first_cycle_is_used),
        cmocka_unit_test(several_tests_scatter),
        cmocka_unit_test(unusable_tests_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
