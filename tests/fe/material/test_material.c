#include "fe/material/material.h"

#include "tests/check.h"
#include "tests/twin/material_stress.h"

static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 5000e6, 0.39, 4e6, 900e6, 0.7};

/* Follows a strain and returns the stress; the state goes on. */
static double stretch(const struct wb_material *m, struct wb_material_state *state, double strain)
{
    double stress, tangent;
    wb_material_stress(m, strain, state, state, &stress, &tangent);
    return stress;
}

static void stress_below_yield_is_elastic(void **unused)
{
    (void)unused;
    struct wb_material_state state = {0};
    const double strain = 0.999 * copper.yield_stress / copper.youngs_modulus;
    assert_close_relative(stretch(&copper, &state, strain), 0.999 * copper.yield_stress, 1e-15);
    assert_close_relative(stretch(&copper, &state, -strain), -0.999 * copper.yield_stress, 1e-15);
    assert_true(state.accumulated_plastic_strain == 0.0 && state.plastic_strain == 0.0);
}

static void yielding_stress_follows_ludwik(void **unused)
{
    (void)unused;
    const double exponents[] = {0.05, 0.3, 0.7, 1.0, 1.5, 2.0};
    const double coefficients[] = {1e6, 900e6, 1e11};
    for (size_t i = 0; i < 6; i++) {
        for (size_t j = 0; j < 3; j++) {
            for (double ep = 1e-6; ep < 0.5; ep *= 3.0) {
                struct wb_material m = copper;
                m.hardening_exponent = exponents[i];
                m.strength_coefficient = coefficients[j];
                const double sigma =
                    m.yield_stress + m.strength_coefficient * pow(ep, exponents[i]);
                const double strain = sigma / m.youngs_modulus + ep;
                struct wb_material_state state = {0};
                /* Strain and stress are the parametric curve of the law. */
                assert_close_relative(stretch(&m, &state, -strain), -sigma, 1e-12);
                /* ep is what is left of the strain: its round-off is the strain's. */
                assert_close(state.accumulated_plastic_strain, ep, 1e-12 * (ep + strain));
                assert_close(state.plastic_strain, -ep, 1e-12 * (ep + strain));
            }
        }
    }
}

static void result_does_not_depend_on_steps_of_monotonic_loading(void **unused)
{
    (void)unused;
    struct wb_material_state once = {0}, often = {0};
    const double last = stretch(&copper, &once, 0.02);
    double stress = 0.0;
    for (int i = 1; i <= 500; i++)
        stress = stretch(&copper, &often, 0.02 * i / 500);
    assert_close_relative(stress, last, 1e-12);
    assert_close_relative(often.accumulated_plastic_strain, once.accumulated_plastic_strain, 1e-12);
}

static void unloading_is_elastic_and_yields_at_the_expanded_surface(void **unused)
{
    (void)unused;
    struct wb_material_state state = {0};
    const double top = stretch(&copper, &state, 0.01);
    const double ep = state.accumulated_plastic_strain;

    /* From +top to -top it is elastic: isotropic hardening, no Bauschinger effect. */
    const double back = 0.01 - 2.0 * top / copper.youngs_modulus;
    assert_close_relative(stretch(&copper, &state, back * (1.0 - 1e-9)), -top, 1e-6);
    assert_true(state.accumulated_plastic_strain == ep);
    stretch(&copper, &state, back - 1e-4);
    assert_true(state.accumulated_plastic_strain > ep);
    assert_true(state.plastic_strain < ep);
}

static void perfectly_plastic_stress_stays_at_yield(void **unused)
{
    (void)unused;
    struct wb_material m = copper;
    m.strength_coefficient = 0.0;
    struct wb_material_state state = {0};
    double stress, tangent;
    wb_material_stress(&m, 0.05, &state, &state, &stress, &tangent);
    assert_close_relative(stress, m.yield_stress, 1e-14);
    assert_close(tangent, 0.0, 1e-3);
}

static void kinematic_surface_moves_with_the_back_stress(void **unused)
{
    (void)unused;
    const struct wb_material m = {WB_HARDENING_KINEMATIC_LINEAR, 5000e6, 0.39, 4e6, 1000e6, 0.0};
    const double E = m.youngs_modulus, H = m.strength_coefficient;
    const double tangent = E * H / (E + H);
    struct wb_material_state state = {0};

    const double yield_strain = m.yield_stress / E;
    const double top = stretch(&m, &state, 0.01);
    assert_close_relative(top, m.yield_stress + tangent * (0.01 - yield_strain), 1e-13);
    assert_close_relative(state.back_stress, top - m.yield_stress, 1e-13);

    /* It yields again after a stress range of twice the yield stress (Bauschinger). */
    const double again = 0.01 - 2.0 * yield_strain;
    assert_close_relative(stretch(&m, &state, again), top - 2.0 * m.yield_stress, 1e-12);
    const double below = stretch(&m, &state, again - 0.001);
    assert_close_relative(below, top - 2.0 * m.yield_stress - tangent * 0.001, 1e-11);

    /* A closed strain cycle closes. */
    stretch(&m, &state, -0.01);
    assert_close_relative(stretch(&m, &state, 0.01), top, 1e-12);
}

static void tangent_is_the_derivative_of_the_stress(void **unused)
{
    (void)unused;
    const enum wb_hardening laws[] = {WB_HARDENING_NONE_ELASTIC, WB_HARDENING_ISOTROPIC_POWER,
                                      WB_HARDENING_KINEMATIC_LINEAR};
    for (size_t i = 0; i < 3; i++) {
        struct wb_material m = copper;
        m.hardening = laws[i];
        const struct wb_material_state before = {0.003, 0.004, 1e5};
        const double strains[] = {-0.02, 0.0032, 0.012};
        for (size_t j = 0; j < 3; j++) {
            const double d = 1e-7;
            struct wb_material_state after;
            double low, high, at, tangent, other;
            wb_material_stress(&m, strains[j] - d, &before, &after, &low, &other);
            wb_material_stress(&m, strains[j] + d, &before, &after, &high, &other);
            wb_material_stress(&m, strains[j], &before, &after, &at, &tangent);
            assert_close(tangent, (high - low) / (2.0 * d), 1e-6 * m.youngs_modulus);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stress_below_yield_is_elastic),
        cmocka_unit_test(yielding_stress_follows_ludwik),
        cmocka_unit_test(result_does_not_depend_on_steps_of_monotonic_loading),
        cmocka_unit_test(unloading_is_elastic_and_yields_at_the_expanded_surface),
        cmocka_unit_test(perfectly_plastic_stress_stays_at_yield),
        cmocka_unit_test(kinematic_surface_moves_with_the_back_stress),
        cmocka_unit_test(tangent_is_the_derivative_of_the_stress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
