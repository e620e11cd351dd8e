/* A cable between sliding and bonded wires, compared with closed forms and synthetic tests. */
#include "analysis/calibration/constituents/cable.h"

#include "base/units.h"
#include "tests/check.h"

static struct wb_cable_ring ring_of(double modulus, double yield, double strength)
{
    return (struct wb_cable_ring){
        6,
        0.85e-3,
        0.05e-6,
        {.hardening = yield > 0.0 ? WB_HARDENING_ISOTROPIC_POWER : WB_HARDENING_NONE_ELASTIC,
         .youngs_modulus = modulus,
         .poissons_ratio = 0.34,
         .yield_stress = yield,
         .strength_coefficient = strength,
         .hardening_exponent = 0.5}};
}

static void curvature_and_moment_give_the_elastic_beam(void **state)
{
    (void)state;
    const double EI = 3e-5, L = 0.04, d = 1e-3, force = 48.0 * EI * d / pow(L, 3.0);
    assert_close_relative(wb_cable_moment(force, L), EI * wb_cable_curvature(d, L), 1e-12);
    assert_close_relative(wb_cable_deflection(wb_cable_curvature(d, L), L), d, 1e-12);
}

/* F(d) = (L1/L) (6 F1 + Fc) at d L1^2 / L^2 is the sum of moments at equal curvature. */
static void adding_moments_is_equivalent_to_the_rule_for_forces(void **state)
{
    (void)state;
    const double L1 = 12.8e-3, L = 40e-3, d = 5e-3, d1 = d * L1 * L1 / (L * L);
    const double F1 = 0.3, Fc = 0.02, F = L1 / L * (6.0 * F1 + Fc);
    assert_close_relative(wb_cable_curvature(d1, L1), wb_cable_curvature(d, L), 1e-12);
    assert_close_relative(wb_cable_moment(F, L),
                          6.0 * wb_cable_moment(F1, L1) + wb_cable_moment(Fc, L1), 1e-12);
}

static void elastic_bonded_wires_carry_E_A_times_arm_squared(void **state)
{
    (void)state;
    const struct wb_cable_ring ring = ring_of(117e9, 0.0, 0.0);
    static const double curvature[4] = {0.0, 0.01, 3.0, 60.0};
    double moment[4];
    assert_int_equal(wb_cable_axial_moments(&ring, curvature, 4, moment, NULL), WB_OK);
    for (int i = 0; i < 4; i++)
        assert_close_relative(moment[i],
                              0.5 * 6.0 * 117e9 * 0.05e-6 * 0.85e-3 * 0.85e-3 * curvature[i], 1e-4);
}

/* A perfectly plastic ring carries 6 A sigma_Y r 2/pi, and a hinge rotates under this moment. */
static void plastic_bonded_wires_form_a_hinge(void **state)
{
    (void)state;
    const struct wb_cable_ring ring = ring_of(117e9, 150e6, 0.0);
    static const double curvature[3] = {1.0, 20.0, 200.0}; /* yield curvature: 1.5 */
    const double hinge = 6.0 * 0.05e-6 * 150e6 * 0.85e-3 * 2.0 / M_PI;
    double moment[3];
    assert_int_equal(wb_cable_axial_moments(&ring, curvature, 3, moment, NULL), WB_OK);
    assert_close_relative(moment[0], 3.0 * 117e9 * 0.05e-6 * pow(0.85e-3, 2.0), 1e-3);
    assert_close_relative(moment[1], hinge, 1e-3);
    assert_close_relative(moment[2], hinge, 1e-3);
}

/* If stress is K eps^0.5, M is proportional to kappa^0.5 and the section has 4/3 of the nominal
 * curvature: kappa = (M/C)^2 gives 3 int (M s / C)^2 s ds = 3/4 kappa. */
static void nominal_curvature_follows_from_the_deflection(void **state)
{
    (void)state;
    const struct wb_cable_ring ring = ring_of(1e15, 1.0, 300e6);
    static const double curvature[2] = {5.0, 20.0};
    double moment[2], integral = 0.0;
    for (int i = 0; i < 100000; i++)
        integral += pow(cos(0.5 * M_PI * (i + 0.5) / 100000), 1.5) / 100000;
    assert_int_equal(wb_cable_axial_moments(&ring, curvature, 2, moment, NULL), WB_OK);
    for (int i = 0; i < 2; i++)
        assert_close_relative(moment[i],
                              6.0 * 0.05e-6 * 300e6 * sqrt(4.0 / 3.0 * curvature[i]) *
                                  pow(0.85e-3, 1.5) * integral,
                              2e-3);
}

static void kinematic_conductors_are_rejected(void **state)
{
    (void)state;
    struct wb_cable_ring ring = ring_of(117e9, 150e6, 1e9);
    struct wb_reason why;
    const double curvature = 1.0;
    double moment;
    ring.conductor.hardening = WB_HARDENING_KINEMATIC_LINEAR;
    assert_int_equal(wb_cable_axial_moments(&ring, &curvature, 1, &moment, &why), WB_ERR_ARGUMENT);
    ring = ring_of(117e9, 0.0, 0.0);
    ring.radius = 0.0;
    assert_int_equal(wb_cable_axial_moments(&ring, &curvature, 1, &moment, &why), WB_ERR_ARGUMENT);
}

static void the_scatter_of_series_does_not_average_out(void **state)
{
    (void)state;
    static const double values[7] = {1.1, 0.9, 1.0, (double)NAN, 2.1, 1.9, 2.0};
    static const int two[7] = {0, 0, 0, 0, 1, 1, 1}, one[7] = {0};
    const struct wb_cable_mean over_series = wb_cable_mean(values, two, 7);
    const struct wb_cable_mean over_tests = wb_cable_mean(values, one, 7);
    assert_int_equal(over_series.n_series, 2);
    assert_int_equal(over_series.n, 6);
    assert_close(over_series.mean, 1.5, 1e-12);
    assert_close(over_series.variance, 0.25, 1e-12); /* of 1 and 2 */
    assert_close(over_series.degrees, 1.0, 0.0);
    assert_close(over_tests.mean, 1.5, 1e-12);
    assert_close(over_tests.variance, (6 * 0.25 + 4 * 0.01) / 5.0 / 6.0, 1e-12);
    assert_close(over_tests.degrees, 5.0, 0.0);
    assert_true(isnan(wb_cable_mean(values, two, 1).variance));
}

static void sliding_wires_are_at_0_and_bonded_ones_at_1(void **state)
{
    (void)state;
    const struct wb_cable_mean wire = {3, 1, 2.0, 0.01, 2.0}, core = {3, 1, 1.0, 0.0, 2.0};
    struct wb_cable_mean cable = {3, 1, 6 * 2.0 + 1.0, 0.04, 2.0};
    struct wb_cable_place place;
    wb_cable_place(&place, &cable, &wire, &core, 6, 100.0);
    assert_close(place.chi.value, 0.0, 1e-12);
    assert_close(place.ratio.value, 1.0, 1e-12);
    assert_close(place.bonded - place.free, 100.0, 1e-12);
    /* Variances 0.04 and 0.36, each of 2 degrees: 0.16 / (0.0016/2 + 0.1296/2) = 2.439. */
    assert_close(place.chi.high - place.chi.value, 3.6403 * sqrt(0.40) / 100.0, 2e-5);
    assert_close_relative(place.ratio.high / place.ratio.value, place.ratio.value / place.ratio.low,
                          1e-12);
    cable.mean += 100.0;
    wb_cable_place(&place, &cable, &wire, &core, 6, 100.0);
    assert_close(place.chi.value, 1.0, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curvature_and_moment_give_the_elastic_beam),
        cmocka_unit_test(adding_moments_is_equivalent_to_the_rule_for_forces),
        cmocka_unit_test(elastic_bonded_wires_carry_E_A_times_arm_squared),
        cmocka_unit_test(plastic_bonded_wires_form_a_hinge),
        cmocka_unit_test(nominal_curvature_follows_from_the_deflection),
        cmocka_unit_test(kinematic_conductors_are_rejected),
        cmocka_unit_test(the_scatter_of_series_does_not_average_out),
        cmocka_unit_test(sliding_wires_are_at_0_and_bonded_ones_at_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
