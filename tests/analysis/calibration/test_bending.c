/* Pure bending of a wire by its law, compared with closed forms of the circle. */
#include "analysis/calibration/law/bending.h"
#include "fe/trial/cantilever.h"
#include "tests/check.h"

#define DIAMETER 1.25e-3

static const double largest = 30.0; /* 1/m */

/* Moment of an elastic, perfectly plastic part over the circle: elastic within y = c. */
static double part_moment(double modulus, double yield_strain, double kappa)
{
    const double R = 0.5 * DIAMETER;
    const double u = fmin(1.0, yield_strain / (kappa * R));
    const double core =
        R * R * R * R / 8.0 * (asin(u) - u * sqrt(1.0 - u * u) * (1.0 - 2.0 * u * u));
    const double rim = R * R * R / 3.0 * pow(1.0 - u * u, 1.5);
    return 4.0 * modulus * (kappa * core + (u < 1.0 ? yield_strain * rim : 0.0));
}

static double second_moment(void)
{
    return M_PI * pow(DIAMETER, 4.0) / 64.0;
}

static struct wb_law bilinear(double modulus, double yield_strain, double remainder)
{
    const struct wb_law_part parts[] = {{modulus, yield_strain}, {remainder, (double)INFINITY}};
    struct wb_law law;
    wb_law_init_parallel(&law, parts, remainder > 0.0 ? 2 : 1, 0.0, 0.39);
    return law;
}

static double bilinear_moment(const struct wb_law *law, double kappa)
{
    double M = part_moment(law->parts[0].modulus, law->parts[0].yield_strain, kappa);
    if (law->n_parts > 1)
        M += law->parts[1].modulus * second_moment() * kappa;
    return M;
}

static void the_springback_of_a_perfectly_plastic_circle_is_the_closed_form(void **unused)
{
    (void)unused;
    const struct wb_law law = bilinear(5e9, 2e-3, 0.0);
    struct wb_bending bending;
    assert_int_equal(wb_bending_describe(&law, DIAMETER, largest, &bending), WB_OK);
    const double EI = 5e9 * second_moment();
    assert_close_relative(bending.flexural_rigidity, EI, 1e-9);
    /* It unloads elastically, because the moment changes by less than twice the yield moment. */
    const double expected = 1.0 - bilinear_moment(&law, largest) / (EI * largest);
    assert_true(expected > 0.5);
    assert_close(bending.residual_curvature_ratio, expected, 2e-4);
}

/* Closed form of an elastic circle with a Maxwell element, loaded and unloaded at one rate. */
static void a_relaxing_circle_follows_its_strain_rate(void **unused)
{
    (void)unused;
    const double E = 2e9, relaxing = 0.5e9, tau = 12.0, rate = 0.6; /* 1/(m s) */
    struct wb_law law = bilinear(E, 0.5, 0.0);
    law.n_maxwell = 1;
    law.maxwell[0] = (struct wb_law_maxwell){relaxing, tau};
    law.strain_rate = rate * 0.5 * DIAMETER;
    const double kappa[] = {3.0, 30.0}, I = second_moment();
    double M[2], secant, unloading;
    struct wb_bending bending;
    assert_int_equal(wb_bending_moments(&law, DIAMETER, 2, kappa, M), WB_OK);
    double q = 0.0;
    for (int i = 0; i < 2; i++) {
        q = relaxing * rate * tau * -expm1(-kappa[i] / rate / tau);
        assert_close_relative(M[i], I * (E * kappa[i] + q), 1e-6);
    }
    const double change = 2.0, decay = exp(-change / rate / tau);
    const double back = q * decay - relaxing * rate * tau * (1.0 - decay);
    assert_int_equal(
        wb_bending_stiffness(&law, DIAMETER, largest, 1, kappa, &secant, 1, &change, &unloading),
        WB_OK);
    assert_close_relative(secant, M[0] / kappa[0], 1e-12);
    assert_close_relative(unloading, I * (E + (q - back) / change), 1e-6);
    /* The curvature at which the moment is zero, at the same rate. */
    assert_int_equal(wb_bending_describe(&law, DIAMETER, largest, &bending), WB_OK);
    assert_close_relative(bending.flexural_rigidity, I * (E + relaxing), 1e-6);
    const double left = bending.residual_curvature_ratio * largest;
    const double then = exp(-(largest - left) / rate / tau);
    assert_close(E * left + q * then - relaxing * rate * tau * (1.0 - then), 0.0, 1e-6 * E);
    /* Without a rate it is the relaxed law. */
    law.strain_rate = 0.0;
    assert_int_equal(wb_bending_moments(&law, DIAMETER, 1, kappa, M), WB_OK);
    assert_close_relative(M[0], I * E * kappa[0], 1e-6);
}

static void an_elastic_circle_has_no_residual_curvature(void **unused)
{
    (void)unused;
    const struct wb_law law = bilinear(1e9, 0.5, 2e9);
    struct wb_bending bending;
    assert_int_equal(wb_bending_describe(&law, DIAMETER, largest, &bending), WB_OK);
    assert_close(bending.residual_curvature_ratio, 0.0, 1e-12);
    assert_close(bending.loop_energy, 0.0, 1e-12 * 3e9 * second_moment() * largest * largest);
}

/* Masing's rule: unloading is the first loading at twice the size, from the turn. */
static void a_hardening_circle_springs_back_by_masings_rule(void **unused)
{
    (void)unused;
    const struct wb_law law = bilinear(4e9, 1e-3, 1e9);
    struct wb_bending bending;
    assert_int_equal(wb_bending_describe(&law, DIAMETER, largest, &bending), WB_OK);
    const double M = bilinear_moment(&law, largest);
    double low = 0.0, high = largest;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (M - 2.0 * bilinear_moment(&law, 0.5 * (largest - middle)) > 0.0)
            high = middle;
        else
            low = middle;
    }
    assert_true(low / largest > 0.1);
    assert_close(bending.residual_curvature_ratio, low / largest, 3e-4);
}

/* By Masing's rule a branch is the first loading at twice the size; an isotropic wire and an
 * elastic one come back with EI. */
static void unloading_stiffness_is_the_secant_stiffness_at_half_the_curvature(void **unused)
{
    (void)unused;
    static const double changes[] = {0.5, 1.0, 2.0, 20.0}, halves[] = {0.25, 0.5, 1.0, 10.0};
    const struct wb_law_part parts[] = {
        {2.5e9, 2e-4}, {1.5e9, 8e-4}, {0.8e9, 3e-3}, {0.5e9, (double)INFINITY}};
    for (int rule = 0; rule < 3; rule++) {
        struct wb_law law;
        double secant[4], unloading[4];
        wb_law_init_parallel(&law, rule == 2 ? parts + 3 : parts, rule == 2 ? 1 : 4, rule, 0.39);
        law.isotropic_share = rule == 0 ? 0.0 : 1.0;
        assert_int_equal(
            wb_bending_stiffness(&law, DIAMETER, 30.0, 4, halves, secant, 4, changes, unloading),
            WB_OK);
        const double EI = law.material.youngs_modulus * M_PI * pow(DIAMETER, 4) / 64.0;
        for (int k = 0; k < 4; k++) {
            assert_true(secant[k] <= EI * (1.0 + 1e-12));
            if (rule == 0)
                assert_close_relative(unloading[k], secant[k], 1e-9);
            else if (rule == 2 || k < 3) /* at larger changes the isotropic wire yields again */
                assert_close_relative(unloading[k], EI, 1e-6);
        }
        assert_true(rule == 2 || secant[3] < 0.7 * EI);
    }
}

static double clamp_curvature(const struct wb_law *law, double moment)
{
    double low = 0.0, high = 1e3;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        double M;
        assert_int_equal(wb_bending_moments(law, DIAMETER, 1, &middle, &M), WB_OK);
        *(M < moment ? &low : &high) = middle;
    }
    return low;
}

/* Springback of the deflection by the beam elements of the bending test. */
static void assert_springback(const struct wb_law *law, double deflection)
{
    const double length = 0.085;
    const int steps = 40;
    struct wb_section section;
    struct wb_cantilever *cantilever;
    struct wb_cantilever_model model;
    struct wb_cantilever_point point;
    assert_int_equal(wb_section_init_law(&section, DIAMETER, law, 100), WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = length;
    model.gravity_y = 0.0;
    assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
    for (int i = 1; i <= steps; i++)
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, deflection * i / steps, &point),
            WB_OK);
    const double largest_curvature = clamp_curvature(law, point.root_moment), F = point.tension;
    for (int i = steps - 1; i >= 0; i--)
        assert_int_equal(
            wb_cantilever_move(cantilever, WB_CONTROL_DEAD_FORCE, F * i / steps, &point), WB_OK);
    assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
    double springback;
    assert_int_equal(wb_bending_springback(law, DIAMETER, length, largest_curvature, &springback),
                     WB_OK);
    print_message("springback of the deflection %.4f, of the beam %.4f\n", springback,
                  1.0 - point.deflection / deflection);
    assert_close(springback, 1.0 - point.deflection / deflection, 2e-3);
    wb_cantilever_destroy(cantilever);
    wb_section_release(&section);
}

static void the_deflection_springs_back_as_that_of_the_beam(void **unused)
{
    (void)unused;
    const struct wb_material copper = {
        .hardening = WB_HARDENING_ISOTROPIC_POWER,
        .youngs_modulus = 5e9,
        .poissons_ratio = 0.39,
        .yield_stress = 5e6,
        .strength_coefficient = 60e6,
        .hardening_exponent = 0.4,
    };
    struct wb_law law = bilinear(5e9, 2e-3, 1e9);
    assert_springback(&law, 0.02);
    assert_springback(&law, 0.06);
    wb_law_init_ludwik(&law, &copper);
    assert_springback(&law, 0.02);
    assert_springback(&law, 0.06);
    law = bilinear(5e9, 0.5, 0.0); /* elastic */
    double springback;
    assert_int_equal(wb_bending_springback(&law, DIAMETER, 0.085, largest, &springback), WB_OK);
    assert_close(springback, 1.0, 1e-9);
}

static void the_loops_energy_is_the_integral_between_its_branches(void **unused)
{
    (void)unused;
    enum {
        STEPS = 20000
    };
    const struct wb_law law = bilinear(4e9, 1e-3, 1e9);
    const double half = 0.5 * largest;
    struct wb_bending bending;
    double under = 0.0;
    assert_int_equal(wb_bending_describe(&law, DIAMETER, largest, &bending), WB_OK);
    for (int i = 0; i < STEPS; i++)
        under += bilinear_moment(&law, (i + 0.5) * half / STEPS) * half / STEPS;
    const double expected = 8.0 * under - 2.0 * largest * bilinear_moment(&law, half);
    assert_true(expected > 0.1 * under);
    assert_close_relative(bending.loop_energy, expected, 1e-3);
}

static void each_moment_is_that_of_a_first_loading(void **unused)
{
    (void)unused;
    const struct wb_law law = bilinear(4e9, 1e-3, 1e9);
    const double curvature[] = {30.0, 0.0, 3.0, 10.0};
    double moment[4];
    assert_int_equal(wb_bending_moments(&law, DIAMETER, 4, curvature, moment), WB_OK);
    assert_close(moment[1], 0.0, 1e-15);
    for (int i = 0; i < 4; i++) {
        if (i != 1)
            assert_close_relative(moment[i], bilinear_moment(&law, curvature[i]), 2e-4);
    }
}

static void the_equivalent_of_ludwiks_law_is_itself(void **unused)
{
    (void)unused;
    static const struct wb_material materials[] = {
        {WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78},
        {WB_HARDENING_ISOTROPIC_POWER, 4528e6, 0.39, 4.52e6, 1327e6, 0.90},
        {WB_HARDENING_ISOTROPIC_POWER, 9000e6, 0.30, 12e6, 200e6, 0.40},
    };
    for (int i = 0; i < 3; i++) {
        const struct wb_material *const given = &materials[i];
        struct wb_material found;
        struct wb_law law;
        double misfit;
        wb_law_init_ludwik(&law, given);
        assert_int_equal(wb_bending_ludwik(&law, DIAMETER, largest, &found, &misfit), WB_OK);
        assert_true(misfit < 1e-6);
        assert_close_relative(found.youngs_modulus, given->youngs_modulus, 1e-4);
        assert_close_relative(found.yield_stress, given->yield_stress, 1e-3);
        assert_close_relative(found.strength_coefficient, given->strength_coefficient, 1e-3);
        assert_close(found.hardening_exponent, given->hardening_exponent, 1e-4);
    }
}

/* A law of another form has nearly the same first loading. */
static void the_equivalent_of_parallel_parts_has_nearly_their_first_loading(void **unused)
{
    (void)unused;
    static const struct wb_law_part parts[] = {
        {2.5e9, 2e-4}, {1.5e9, 8e-4}, {0.8e9, 3e-3}, {0.5e9, 9e-3}, {0.3e9, (double)INFINITY}};
    struct wb_law law, ludwik;
    struct wb_material found;
    double misfit, M[2], other[2];
    const double curvature[] = {3.0, 25.0};
    wb_law_init_parallel(&law, parts, 5, 0.3, 0.39);
    assert_int_equal(wb_bending_ludwik(&law, DIAMETER, largest, &found, &misfit), WB_OK);
    assert_true(misfit > 1e-4 && misfit < 0.03);
    assert_close(found.poissons_ratio, 0.39, 0.0);
    wb_law_init_ludwik(&ludwik, &found);
    assert_int_equal(wb_bending_moments(&law, DIAMETER, 2, curvature, M), WB_OK);
    assert_int_equal(wb_bending_moments(&ludwik, DIAMETER, 2, curvature, other), WB_OK);
    for (int i = 0; i < 2; i++)
        assert_close_relative(other[i], M[i], 3.0 * misfit);
}

/* The first part yields before the first curvature that is compared: without a bound the best yield
 * stress would be zero. */
static void the_equivalent_of_a_wire_that_yields_at_once_has_a_yield_stress(void **unused)
{
    (void)unused;
    const double strain = 0.5 * DIAMETER * largest;
    for (double first = 1e-6; first < 2e-3; first *= 10.0) {
        const struct wb_law_part parts[] = {{9e9, first * strain},
                                            {1e9, 0.02 * strain},
                                            {1e9, 0.3 * strain},
                                            {0.5e9, (double)INFINITY}};
        struct wb_law law;
        struct wb_material found;
        double misfit;
        wb_law_init_parallel(&law, parts, 4, 0.0, 0.39);
        assert_int_equal(wb_bending_ludwik(&law, DIAMETER, largest, &found, &misfit), WB_OK);
        assert_true(found.yield_stress >= 0.999e-3 * strain * found.youngs_modulus);
        assert_true(found.hardening_exponent >= 1e-3 && found.strength_coefficient > 0.0);
        assert_true(misfit < 0.1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_springback_of_a_perfectly_plastic_circle_is_the_closed_form),
        cmocka_unit_test(an_elastic_circle_has_no_residual_curvature),
        cmocka_unit_test(a_relaxing_circle_follows_its_strain_rate),
        cmocka_unit_test(a_hardening_circle_springs_back_by_masings_rule),
        cmocka_unit_test(unloading_stiffness_is_the_secant_stiffness_at_half_the_curvature),
        cmocka_unit_test(the_deflection_springs_back_as_that_of_the_beam),
        cmocka_unit_test(the_loops_energy_is_the_integral_between_its_branches),
        cmocka_unit_test(each_moment_is_that_of_a_first_loading),
        cmocka_unit_test(the_equivalent_of_ludwiks_law_is_itself),
        cmocka_unit_test(the_equivalent_of_a_wire_that_yields_at_once_has_a_yield_stress),
        cmocka_unit_test(the_equivalent_of_parallel_parts_has_nearly_their_first_loading),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
