/* Comparison of two properties files. */
#include "tests/messages.h"

#include <gsl/gsl_cdf.h>

#include "analysis/calibration/law/bending.h"
#include "analysis/compare/compare.h"
#include "base/units.h"

static const char *const names[] = {"a.yaml", "b.yaml"};
static const double E = 5e9, diameter = 1.1e-3;

static int set_up(void **state)
{
    (void)state;
    keep_messages();
    return 0;
}

/* Moments come first. */
enum {
    UNLOADING = WB_CYCLE_MOMENTS,
    RESIDUAL_CURVATURE,
    RIGIDITY
};

/* An interval as in calibrations: of n specimens whose logarithms scatter by s. */
static struct wb_estimate estimate(double value, double s, int n)
{
    const double half = gsl_cdf_tdist_Qinv(0.025, n - 1) * s / sqrt(n);
    return (struct wb_estimate){
        .value = value, .low = value * exp(-half), .high = value * exp(half)};
}

/* Properties of an elastoplastic wire up to a curvature, all values times `factor`. */
static void make(struct wb_properties *p, double largest, double factor, double s, int n)
{
    const struct wb_material material = {.hardening = WB_HARDENING_ISOTROPIC_POWER,
                                         .youngs_modulus = E,
                                         .poissons_ratio = 0.39,
                                         .yield_stress = 4e6,
                                         .strength_coefficient = 1.5e9,
                                         .hardening_exponent = 0.9};
    struct wb_bending bending;
    double moment[WB_CYCLE_MOMENTS];
    *p = (struct wb_properties){.n_samples = n, .outer_diameter = diameter};
    snprintf(p->wire, sizeof p->wire, "made-up");
    wb_law_init_ludwik(&p->law, &material);
    p->largest_curvature = largest;
    p->n_moments = WB_CYCLE_MOMENTS;
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        p->curvature[k] = wb_cycle_moment_parts[k] * largest;
    assert_int_equal(wb_bending_describe(&p->law, diameter, largest, &bending), WB_OK);
    assert_int_equal(wb_bending_moments(&p->law, diameter, WB_CYCLE_MOMENTS, p->curvature, moment),
                     WB_OK);
    p->rigidity = estimate(factor * bending.flexural_rigidity, s, n);
    p->residual_curvature_ratio = estimate(factor * bending.residual_curvature_ratio, s, n);
    const double change = 1.0;
    double unloading;
    assert_int_equal(
        wb_bending_stiffness(&p->law, diameter, largest, 0, NULL, NULL, 1, &change, &unloading),
        WB_OK);
    p->unloading = (struct wb_cycle_stiffness){
        .n = 1, .curvature = {change}, .estimate = {estimate(factor * unloading, s, n)}};
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++)
        p->moment[k] = estimate(factor * moment[k], s, n);
}

static enum wb_status run(struct wb_compare *compare, const struct wb_properties *a,
                          const struct wb_properties *b, double within)
{
    const struct wb_properties *const both[] = {a, b};
    return wb_compare_run(compare, both, names, within);
}

/* Mean, scatter and number of specimens are recovered from the intervals, and the difference is the
 * ratio. */
static void groups_are_recovered_from_the_intervals(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.03, 5);
    make(&b, 30.0, 1.04, 0.05, 8);
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_int_equal(c.n_compared, WB_COMPARE_QUANTITIES);
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++) {
        const struct wb_compare_quantity *const q = &c.quantities[k];
        assert_null(q->reason);
        assert_close(q->groups[0].deviation, 0.03, 1e-12);
        assert_close(q->groups[1].deviation, 0.05, 1e-12);
        assert_int_equal(q->groups[0].n, 5);
        assert_int_equal(q->groups[1].degrees, 7);
        assert_close(q->welch.difference, log(1.04), 1e-9);
        /* By hand: standard error and degrees of Welch and Satterthwaite. */
        const double va = 0.03 * 0.03 / 5, vb = 0.05 * 0.05 / 8;
        const double v = pow(va + vb, 2) / (va * va / 4 + vb * vb / 7);
        const double half = gsl_cdf_tdist_Qinv(0.05, v) * sqrt(va + vb);
        assert_close(q->welch.low, log(1.04) - half, 1e-9);
        assert_close(q->welch.high, log(1.04) + half, 1e-9);
        assert_int_equal(q->verdict, WB_GROUPS_EQUIVALENT);
    }
    assert_close(exp(c.quantities[RIGIDITY].groups[0].mean), E * M_PI * pow(diameter, 4) / 64.0,
                 1e-9);
    assert_int_equal(c.verdict, WB_GROUPS_EQUIVALENT);
}

/* One wire, measured up to 30 and up to 18 1/m: the same values at the same curvatures. */
static void values_are_compared_at_the_same_curvatures(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.03, 5);
    make(&b, 18.0, 1.0, 0.03, 5);
    assert_true(a.residual_curvature_ratio.value < 0.95 * b.residual_curvature_ratio.value ||
                a.residual_curvature_ratio.value > 1.05 * b.residual_curvature_ratio.value);
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_close(c.curvature, 18.0, 0.0);
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++)
        assert_close(c.quantities[k].welch.difference, 0.0, 1e-6);
    assert_string_equal(c.quantities[WB_CYCLE_MOMENTS - 1].name, "M at 18 /m");
}

static void one_quantity_that_differs_makes_batches_different(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.01, 5);
    make(&b, 30.0, 1.0, 0.01, 5);
    b.residual_curvature_ratio = estimate(1.3 * b.residual_curvature_ratio.value, 0.01, 5);
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_int_equal(c.quantities[RESIDUAL_CURVATURE].verdict, WB_GROUPS_DIFFERENT);
    assert_int_equal(c.verdict, WB_GROUPS_DIFFERENT);
    b.residual_curvature_ratio = estimate(a.residual_curvature_ratio.value * exp(0.08), 0.03, 5);
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_int_equal(c.quantities[RESIDUAL_CURVATURE].verdict, WB_GROUPS_UNDECIDED);
    assert_int_equal(c.verdict, WB_GROUPS_UNDECIDED);
    assert_true(c.more > 0 && c.more == c.quantities[RESIDUAL_CURVATURE].more);
}

/* If the data do not support the hardening rule there is no residual curvature ratio. */
static void missing_values_are_not_compared(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.01, 5);
    make(&b, 30.0, 1.0, 0.01, 5);
    b.residual_curvature_ratio.value = b.residual_curvature_ratio.low =
        b.residual_curvature_ratio.high = (double)NAN;
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_non_null(c.quantities[RESIDUAL_CURVATURE].reason);
    assert_int_equal(c.n_compared, WB_COMPARE_QUANTITIES - 1);
    assert_int_equal(c.verdict, WB_GROUPS_EQUIVALENT);
    /* A file of an earlier release. */
    b.unloading.n = 0;
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_non_null(c.quantities[UNLOADING].reason);
    assert_int_equal(c.n_compared, WB_COMPARE_QUANTITIES - 2);
}

/* A deviation pooled over several wires has their degrees of freedom. */
static void pooled_intervals_have_the_degrees_of_the_pool(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.03, 3);
    make(&b, 30.0, 1.0, 0.03, 3);
    const double half = gsl_cdf_tdist_Qinv(0.025, 20) * 0.03 / sqrt(3.0);
    a.rigidity.low = a.rigidity.value * exp(-half);
    a.rigidity.high = a.rigidity.value * exp(half);
    a.pooled_degrees = 20;
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    assert_int_equal(c.quantities[RIGIDITY].groups[0].degrees, 20);
    assert_close(c.quantities[RIGIDITY].groups[0].deviation, 0.03, 1e-12);
}

/* Errors common to both benches are in the intervals, but not in the scatter of the specimens. */
static void a_stated_scatter_is_used_instead_of_the_interval(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.03, 5);
    make(&b, 30.0, 1.0, 0.03, 5);
    for (int k = 0; k < WB_CYCLE_MOMENTS; k++) {
        a.moment[k].deviation = 0.02;
        a.moment[k].low *= 0.5;
        a.moment[k].high *= 2.0;
    }
    assert_int_equal(run(&c, &a, &b, 0.1), WB_OK);
    const struct wb_compare_quantity *const last = &c.quantities[WB_COMPARE_QUANTITIES - 1];
    int found = 0;
    for (int k = 0; k < WB_COMPARE_QUANTITIES; k++)
        found += fabs(c.quantities[k].groups[0].deviation - 0.02) < 1e-12;
    assert_true(found >= 1);
    assert_close(last->groups[1].deviation, 0.03, 1e-12);
}

static void files_without_intervals_are_rejected(void **state)
{
    (void)state;
    static struct wb_properties a, b;
    struct wb_compare c;
    make(&a, 30.0, 1.0, 0.03, 3);
    make(&b, 30.0, 1.0, 0.03, 1 + 1);
    b.n_samples = 1;
    assert_int_equal(run(&c, &a, &b, 0.1), WB_ERR_DATA);
    assert_message("b.yaml: 1 specimen");
    b.n_moments = 0;
    assert_int_equal(run(&c, &a, &b, 0.1), WB_ERR_DATA);
    assert_message("b.yaml: no moments with intervals");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(groups_are_recovered_from_the_intervals),
        cmocka_unit_test(values_are_compared_at_the_same_curvatures),
        cmocka_unit_test(one_quantity_that_differs_makes_batches_different),
        cmocka_unit_test(missing_values_are_not_compared),
        cmocka_unit_test(pooled_intervals_have_the_degrees_of_the_pool),
        cmocka_unit_test(a_stated_scatter_is_used_instead_of_the_interval),
        cmocka_unit_test(files_without_intervals_are_rejected),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
