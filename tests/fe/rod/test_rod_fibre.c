/* The rod's material point compared with the uniaxial law, closed forms, its slow twin, finite
 * differences and the rate equations. */
#include "fe/rod/rod_fibre.h"

#include "tests/fe/rod/wires.h"
#include "tests/twin/material_stress.h"
#include "tests/twin/rod_fibre_twin.h"

static const struct wb_material copper = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 292e6, 0.31};
static const struct wb_material prager = {
    WB_HARDENING_KINEMATIC_LINEAR, 68.2e9, 0.34, 182e6, 2e9, 1.0};
static const struct wb_material perfect = {
    WB_HARDENING_ISOTROPIC_POWER, 68.2e9, 0.34, 182e6, 0.0, 1.0};

static struct wb_hardening_table table;

static void respond(const struct wb_material *m, const struct wb_hardening_table *with,
                    const double strain[2], const struct wb_rod_fibre_state *before,
                    struct wb_rod_fibre_state *after, struct wb_rod_fibre_response *response)
{
    struct wb_rod_fibre_law law;
    wb_rod_fibre_law_init(&law, m, with);
    wb_rod_fibre_respond(&law, strain, before, after, response);
}

static struct wb_rod_fibre_state virgin(const struct wb_material *m)
{
    return (struct wb_rod_fibre_state){.yield = m->yield_stress};
}

static void response_without_shear_is_the_uniaxial_law(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager, &perfect};
    for (size_t law = 0; law < 3; law++) {
        const struct wb_material *m = laws[law];
        struct wb_rod_fibre_state state = virgin(m);
        struct wb_material_state uniaxial = {0};
        uint64_t seed = 7;
        int yields = 0;
        if (m->hardening == WB_HARDENING_ISOTROPIC_POWER)
            wb_hardening_tabulate(&table, m);
        for (int i = 0; i < 400; i++) {
            const double strain[2] = {0.02 * (test_random(&seed) - 0.4), 0.0};
            struct wb_rod_fibre_response r;
            double stress, tangent;
            respond(m, &table, strain, &state, &state, &r);
            wb_material_stress(m, strain[0], &uniaxial, &uniaxial, &stress, &tangent);
            assert_close(r.axial, stress, 1e-10 * m->yield_stress);
            assert_close(r.D11, tangent, 1e-9 * m->youngs_modulus);
            assert_close(r.D12, 0.0, 0.0);
            assert_close(r.shear, 0.0, 0.0);
            assert_close_relative(state.accumulated, uniaxial.accumulated_plastic_strain, 1e-10);
            yields += r.yields;
        }
        assert_true(yields > 50);
    }
}

/* Pure torsion: sqrt(3) t = sigma_Y + K (g_p / sqrt(3))^n. */
static void pure_shear_follows_the_law_in_equivalent_stress_and_strain(void **unused)
{
    (void)unused;
    const double G = 68.2e9 / 2.0 / 1.34;
    wb_hardening_tabulate(&table, &copper);
    for (int i = 1; i <= 40; i++) {
        struct wb_rod_fibre_state state = virgin(&copper);
        const double strain[2] = {0.0, 1e-3 * i};
        struct wb_rod_fibre_response r;
        respond(&copper, &table, strain, &state, &state, &r);
        const double plastic = strain[1] - r.shear / G;
        assert_close(r.axial, 0.0, 0.0);
        if (i < 3) {
            assert_close_relative(r.shear, G * strain[1], 1e-14);
            continue;
        }
        if (!r.yields)
            continue;
        assert_close_relative(sqrt(3.0) * r.shear, 182e6 + 292e6 * pow(plastic / sqrt(3.0), 0.31),
                              1e-10);
        assert_close_relative(state.accumulated, plastic / sqrt(3.0), 1e-9);
    }
    /* Yielding begins at sigma_Y / sqrt(3) / G. */
    for (int side = -1; side <= 1; side += 2) {
        struct wb_rod_fibre_state state = virgin(&copper);
        const double strain[2] = {0.0, 182e6 / sqrt(3.0) / G * (1.0 + side * 1e-9)};
        struct wb_rod_fibre_response r;
        respond(&copper, &table, strain, &state, &state, &r);
        assert_true(r.yields == (side > 0));
    }
}

/* Checks that the result satisfies the equations of backward Euler. */
static void check_equations(const struct wb_material *m, const double strain[2],
                            const struct wb_rod_fibre_state *was,
                            const struct wb_rod_fibre_state *is,
                            const struct wb_rod_fibre_response *r)
{
    const double E = m->youngs_modulus, G = E / 2.0 / (1.0 + m->poissons_ratio);
    const bool kinematic = m->hardening == WB_HARDENING_KINEMATIC_LINEAR;
    const double K = m->strength_coefficient;
    const double s = r->axial - (kinematic ? K * is->plastic : 0.0);
    const double t = r->shear - (kinematic ? K / 3.0 * is->plastic_shear : 0.0);
    const double q = sqrt(s * s + 3.0 * t * t), l = is->accumulated - was->accumulated;

    assert_close(r->axial, E * (strain[0] - is->plastic), 1e-9 * m->yield_stress);
    assert_close(r->shear, G * (strain[1] - is->plastic_shear), 1e-9 * m->yield_stress);
    if (!r->yields)
        return;
    const double bound = kinematic
                             ? m->yield_stress
                             : m->yield_stress + K * pow(is->accumulated, m->hardening_exponent);
    assert_close_relative(q, bound, 1e-10);
    assert_close(is->plastic - was->plastic, l * s / q, 1e-13);
    assert_close(is->plastic_shear - was->plastic_shear, 3.0 * l * t / q, 1e-13);
    assert_true(l > 0.0);
}

static void return_mapping_satisfies_backward_euler(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager, &perfect};
    for (size_t law = 0; law < 3; law++) {
        const struct wb_material *m = laws[law];
        uint64_t seed = 11;
        int yields = 0;
        if (m->hardening == WB_HARDENING_ISOTROPIC_POWER)
            wb_hardening_tabulate(&table, m);
        for (int path = 0; path < 200; path++) {
            struct wb_rod_fibre_state state = virgin(m);
            for (int i = 0; i < 10; i++) {
                const double size = pow(10.0, -4.0 + 3.0 * test_random(&seed));
                const double strain[2] = {size * (2.0 * test_random(&seed) - 1.0),
                                          size * (2.0 * test_random(&seed) - 1.0)};
                struct wb_rod_fibre_state after;
                struct wb_rod_fibre_response r;
                respond(m, &table, strain, &state, &after, &r);
                check_equations(m, strain, &state, &after, &r);
                yields += r.yields;
                state = after;
            }
        }
        assert_true(yields > 500);
    }
}

static void response_agrees_with_its_slow_twin(void **unused)
{
    (void)unused;
    const double exponents[] = {0.1, 0.31, 0.9, 1.0, 1.7};
    double worst = 0.0;
    for (size_t k = 0; k < sizeof exponents / sizeof exponents[0]; k++) {
        struct wb_material m = copper;
        m.hardening_exponent = exponents[k];
        uint64_t seed = 3;
        wb_hardening_tabulate(&table, &m);
        struct wb_rod_fibre_state fast = virgin(&m), slow = fast;
        for (int i = 0; i < 2000; i++) {
            const double strain[2] = {0.1 * (test_random(&seed) - 0.5),
                                      0.1 * (test_random(&seed) - 0.5)};
            struct wb_rod_fibre_response a, b;
            if (i % 20 == 0)
                fast = slow = virgin(&m);
            respond(&m, &table, strain, &fast, &fast, &a);
            wb_rod_fibre_twin_respond(&m, strain, &slow, &slow, &b);
            worst = fmax(worst, fabs(a.axial - b.axial) / m.yield_stress);
            worst = fmax(worst, fabs(a.shear - b.shear) / m.yield_stress);
            assert_close(a.D11, b.D11, 1e-7 * m.youngs_modulus);
            assert_close(a.D12, b.D12, 1e-7 * m.youngs_modulus);
        }
    }
    print_message("largest difference from the slow twin: %.2g of the yield stress\n", worst);
    assert_true(worst < 1e-9);
}

static void tangent_agrees_with_finite_differences(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&copper, &prager, &perfect};
    double worst = 0.0;
    int checked = 0;
    for (size_t law = 0; law < 3; law++) {
        const struct wb_material *m = laws[law];
        uint64_t seed = 5;
        if (m->hardening == WB_HARDENING_ISOTROPIC_POWER)
            wb_hardening_tabulate(&table, m);
        struct wb_rod_fibre_state state = virgin(m);
        for (int i = 0; i < 400; i++) {
            const double strain[2] = {0.02 * (test_random(&seed) - 0.5),
                                      0.03 * (test_random(&seed) - 0.5)};
            const double d = 1e-8;
            struct wb_rod_fibre_state after, ignored;
            struct wb_rod_fibre_response r, near[4];
            respond(m, &table, strain, &state, &after, &r);
            for (int k = 0; k < 4; k++) {
                double moved[2] = {strain[0], strain[1]};
                moved[k / 2] += k % 2 == 0 ? d : -d;
                respond(m, &table, moved, &state, &ignored, &near[k]);
            }
            const bool same_branch = near[0].yields == near[1].yields &&
                                     near[2].yields == near[3].yields && near[0].yields == r.yields;
            const double unit = 0.5 / d / m->youngs_modulus;
            if (same_branch && r.yields) {
                worst = fmax(worst, fabs(unit * (near[0].axial - near[1].axial) -
                                         r.D11 / m->youngs_modulus));
                worst = fmax(worst, fabs(unit * (near[0].shear - near[1].shear) -
                                         r.D12 / m->youngs_modulus));
                worst = fmax(worst, fabs(unit * (near[2].axial - near[3].axial) -
                                         r.D12 / m->youngs_modulus));
                worst = fmax(worst, fabs(unit * (near[2].shear - near[3].shear) -
                                         r.D22 / m->youngs_modulus));
                checked++;
            }
            if (i % 5 == 0)
                state = after;
        }
    }
    print_message(
        "largest difference between tangent and finite differences: %.2g of E (%d points)\n", worst,
        checked);
    assert_true(checked > 600);
    assert_true(worst < 2e-6);
}

/* Integrates the rate equations ds = E (de - dl s/q), dt = G (dg - 3 dl t/q), with dl from
 * dq = H' dl, in explicit substeps, for perfect plasticity and Prager's law. */
static void integrate_rates(const struct wb_material *m, int n, const double strain[2],
                            double stress[2])
{
    const double E = m->youngs_modulus, G = E / 2.0 / (1.0 + m->poissons_ratio);
    const double H = m->hardening == WB_HARDENING_KINEMATIC_LINEAR ? m->strength_coefficient : 0.0;
    const double de = strain[0] / n, dg = strain[1] / n;
    double s = 0.0, t = 0.0, back_s = 0.0, back_t = 0.0;

    /* Non-proportional path: the axial strain in the first half, the shear in the second. */
    for (int i = 0; i < 2 * n; i++) {
        const double e = i < n ? de : 0.0, g = i < n ? 0.0 : dg;
        const double xs = s - back_s, xt = t - back_t, q = sqrt(xs * xs + 3.0 * xt * xt);
        double l = 0.0;
        if (q >= m->yield_stress) {
            const double a = xs / q, b = xt / q;
            /* The last term returns to the yield surface, from which explicit steps drift. */
            l = (a * E * e + 3.0 * b * G * g + (q - m->yield_stress)) /
                (a * a * (E + H) + 3.0 * b * b * (3.0 * G + H));
            l = fmax(l, 0.0);
            s -= E * l * a;
            t -= 3.0 * G * l * b;
            back_s += H * l * a;
            back_t += H * l * b;
        }
        s += E * e;
        t += G * g;
    }
    stress[0] = s;
    stress[1] = t;
}

static void solution_converges_to_the_rate_equations(void **unused)
{
    (void)unused;
    const struct wb_material *laws[] = {&perfect, &prager};
    const double strain[2] = {0.006, 0.012};
    for (size_t law = 0; law < 2; law++) {
        const struct wb_material *m = laws[law];
        double exact[2], error[2];
        integrate_rates(m, 2000000, strain, exact);
        if (law == 0)
            wb_hardening_tabulate(&table, m);
        for (int k = 0; k < 2; k++) {
            const int n = k == 0 ? 20 : 40;
            struct wb_rod_fibre_state state = virgin(m);
            struct wb_rod_fibre_response r = {0};
            for (int i = 1; i <= 2 * n; i++) {
                const double at[2] = {strain[0] * fmin(1.0, (double)i / n),
                                      strain[1] * fmax(0.0, (double)(i - n) / n)};
                respond(m, &table, at, &state, &state, &r);
            }
            error[k] = hypot(r.axial - exact[0], sqrt(3.0) * (r.shear - exact[1]));
        }
        print_message("error with 20 and 40 steps per strain: %.3g, %.3g of the yield stress\n",
                      error[0] / m->yield_stress, error[1] / m->yield_stress);
        assert_true(error[1] < 0.02 * m->yield_stress);
        /* The error is of first order in the step. */
        assert_close(error[0] / error[1], 2.0, 0.25);
    }
}

static void non_finite_input_gives_non_finite_output(void **unused)
{
    (void)unused;
    wb_hardening_tabulate(&table, &copper);
    const double strain[2] = {(double)NAN, 0.001};
    struct wb_rod_fibre_state state = virgin(&copper);
    struct wb_rod_fibre_response r;
    respond(&copper, &table, strain, &state, &state, &r);
    assert_true(isnan(r.axial));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(response_without_shear_is_the_uniaxial_law),
        cmocka_unit_test(pure_shear_follows_the_law_in_equivalent_stress_and_strain),
        cmocka_unit_test(return_mapping_satisfies_backward_euler),
        cmocka_unit_test(response_agrees_with_its_slow_twin),
        cmocka_unit_test(tangent_agrees_with_finite_differences),
        cmocka_unit_test(solution_converges_to_the_rate_equations),
        cmocka_unit_test(non_finite_input_gives_non_finite_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
