/* Sections of a law with a hardening rule: parallel parts, and Ludwik's curve as an overlay. */
#include "fe/material/law.h"
#include "tests/fe/rod/points.h"

/* The moment of a monotonic loading. */
static double virgin_moment(const struct wb_law *law, double kappa, int n)
{
    struct fibre_point p = make_point(law, n);
    const double M = bend(&p, kappa);
    fibre_point_release(&p);
    return M;
}

static struct wb_law parallel_law(double isotropic_share)
{
    static const struct wb_law_part parts[] = {
        {2.5e9, 2e-4}, {1.5e9, 8e-4}, {0.8e9, 3e-3}, {0.5e9, 9e-3}, {0.3e9, (double)INFINITY}};
    struct wb_law law;
    wb_law_init_parallel(&law, parts, 5, isotropic_share, 0.39);
    return law;
}

static struct wb_law ludwik_law(double isotropic_share)
{
    const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 5641e6, 0.39, 4.95e6, 850e6, 0.78};
    struct wb_law law;
    wb_law_init_ludwik(&law, &m);
    law.isotropic_share = isotropic_share;
    return law;
}

/* All laws of these tests: two forms, three rules. */
enum {
    LAWS = 5
};

static struct wb_law law_of(int i)
{
    switch (i) {
    case 0:
        return parallel_law(0.0);
    case 1:
        return parallel_law(0.4);
    case 2:
        return parallel_law(1.0);
    case 3:
        return ludwik_law(0.0);
    default:
        return ludwik_law(0.4);
    }
}

/* The moment of a part over the circle: elastic within y = c, yielding beyond. */
static double closed_form(double modulus, double yield_strain, double kappa)
{
    const double R = 0.5 * DIAMETER;
    const double u = fmin(1.0, yield_strain / (kappa * R));
    const double core =
        R * R * R * R / 8.0 * (asin(u) - u * sqrt(1.0 - u * u) * (1.0 - 2.0 * u * u));
    const double rim = R * R * R / 3.0 * pow(1.0 - u * u, 1.5);
    return 4.0 * modulus * (kappa * core + (u < 1.0 ? yield_strain * rim : 0.0));
}

static void the_moment_of_parallel_parts_is_that_of_the_closed_form(void **unused)
{
    (void)unused;
    const struct wb_law law = parallel_law(0.4);
    for (double kappa = 0.1; kappa < 60.0; kappa *= 1.7) {
        double M = 0.0;
        for (int i = 0; i < law.n_parts; i++)
            M += closed_form(law.parts[i].modulus, law.parts[i].yield_strain, kappa);
        assert_close_relative(virgin_moment(&law, kappa, 400), M, 2e-5);
        /* Twenty strips, as in a beam. */
        assert_close_relative(virgin_moment(&law, kappa, 20), M, 6e-3);
    }
}

static void a_perfectly_plastic_part_is_the_material_without_hardening(void **unused)
{
    (void)unused;
    const struct wb_law_part part = {3e9, 1e-3};
    const struct wb_material m = {WB_HARDENING_KINEMATIC_LINEAR, 3e9, 0.39, 3e6, 0.0, 0.0};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, 0.0, 0.39);
    struct fibre_point p = make_point(&law, 20);
    struct wb_section section;
    assert_int_equal(wb_section_init_circle(&section, DIAMETER, &m, 20), WB_OK);
    struct fibre_point other = fibre_point_make(&section);
    wb_section_release(&section);
    uint64_t random = 7;
    for (int step = 0; step < 300; step++) {
        const double kappa = 40.0 * (test_random(&random) - 0.5);
        assert_close(bend(&p, kappa), bend(&other, kappa), 1e-15);
    }
    fibre_point_release(&p);
    fibre_point_release(&other);
}

static void isotropic_overlays_follow_ludwiks_law_through_cycles(void **unused)
{
    (void)unused;
    struct wb_law law = ludwik_law(1.0);
    struct fibre_point exact = make_point(&law, 20);
    law.isotropic_share = 1.0 - 1e-12; /* an overlay, not the material */
    struct fibre_point overlay = make_point(&law, 20);
    const double path[] = {10.0, 30.0, 5.0, -20.0, -35.0, 0.0, 40.0, 12.0, 13.0, -40.0};
    const double scale = virgin_moment(&law, 30.0, 20);
    for (size_t i = 0; i < sizeof path / sizeof path[0]; i++)
        assert_close(bend(&overlay, path[i]), bend(&exact, path[i]), 2e-3 * scale);
    fibre_point_release(&exact);
    fibre_point_release(&overlay);
}

static void kinematic_branches_are_the_virgin_curve_at_twice_the_size(void **unused)
{
    (void)unused;
    for (int form = 0; form < 2; form++) {
        const struct wb_law law = form ? ludwik_law(0.0) : parallel_law(0.0);
        struct fibre_point p = make_point(&law, 20);
        const double top = bend(&p, 30.0);
        for (double kappa = 29.0; kappa > -30.0; kappa -= 1.3) {
            const double expected = top - 2.0 * virgin_moment(&law, 0.5 * (30.0 - kappa), 20);
            assert_close(bend(&p, kappa), expected, 1e-12 * top);
        }
        fibre_point_release(&p);
    }
}

static void kinematic_branches_return_to_the_reversal_point(void **unused)
{
    (void)unused;
    for (int form = 0; form < 2; form++) {
        const struct wb_law law = form ? ludwik_law(0.0) : parallel_law(0.0);
        struct fibre_point p = make_point(&law, 20);
        const double top = bend(&p, 30.0), low = bend(&p, -10.0);
        (void)bend(&p, 15.0);
        (void)bend(&p, 3.0);
        assert_close(bend(&p, 15.0), bend(&p, 15.0), 0.0);
        assert_close(bend(&p, -10.0), low, 1e-12 * top);
        (void)bend(&p, 12.0);
        assert_close(bend(&p, 30.0), top, 1e-12 * top);
        /* Beyond the first reversal the wire follows the monotonic curve again. */
        assert_close(bend(&p, 45.0), virgin_moment(&law, 45.0, 20), 1e-12 * top);
        fibre_point_release(&p);
    }
}

static void isotropic_hardening_yields_again_at_the_largest_moment(void **unused)
{
    (void)unused;
    const struct wb_law law = parallel_law(1.0);
    struct fibre_point p = make_point(&law, 20);
    (void)bend(&p, 30.0);
    /* The outermost fibre's stress changes from +F to -F elastically: strain range 2 F / E. */
    struct wb_section section;
    assert_int_equal(wb_section_init_law(&section, DIAMETER, &law, 20), WB_OK);
    const double outer = section.fibres[0].y;
    wb_section_release(&section);
    const double F = wb_law_virgin_stress(&law, 30.0 * fabs(outer), NULL);
    const double yields_at = 30.0 - 2.0 * F / law.material.youngs_modulus / fabs(outer);
    const double EI = wb_fibres_bending_stiffness(p.fibres);
    assert_close_relative(fibre_point_respond(&p, 0.0, yields_at + 0.01).D22, EI, 1e-12);
    assert_true(fibre_point_respond(&p, 0.0, yields_at - 0.2).D22 < 0.999 * EI);
    fibre_point_release(&p);
}

static void monotonic_loading_does_not_depend_on_the_rule(void **unused)
{
    (void)unused;
    for (double kappa = 0.5; kappa < 50.0; kappa *= 1.5) {
        const struct wb_law kinematic = parallel_law(0.0), mixed = parallel_law(0.4),
                            isotropic = parallel_law(1.0);
        const double M = virgin_moment(&kinematic, kappa, 20);
        assert_close_relative(virgin_moment(&mixed, kappa, 20), M, 1e-13);
        assert_close_relative(virgin_moment(&isotropic, kappa, 20), M, 1e-13);
    }
}

/* Work over closed paths of curvature, repeated until the moment loop is closed, too. */
static void no_closed_cycle_produces_work(void **unused)
{
    (void)unused;
    uint64_t random = 11;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        for (int trial = 0; trial < 20; trial++) {
            struct fibre_point p = make_point(&law, 20);
            double turns[6], work = 0.0, kappa = 0.0, M = 0.0;
            for (int k = 0; k < 6; k++)
                turns[k] = 60.0 * (test_random(&random) - 0.5);
            double largest = 0.0;
            for (int cycle = 0; cycle < 3; cycle++) {
                work = 0.0;
                for (int k = 0; k <= 6; k++) {
                    const double from = kappa, to = turns[k % 6];
                    for (int step = 1; step <= 60; step++) {
                        const double next = from + (to - from) * step / 60.0;
                        const double reached = bend(&p, next);
                        work += 0.5 * (M + reached) * (next - kappa);
                        largest = fmax(largest, fabs(reached));
                        M = reached;
                        kappa = next;
                    }
                }
            }
            assert_true(work > -1e-5 * largest * 60.0);
            fibre_point_release(&p);
        }
    }
}

static void tangents_agree_with_finite_differences(void **unused)
{
    (void)unused;
    uint64_t random = 3;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        struct fibre_point p = make_point(&law, 20);
        double kappa = 0.0;
        for (int step = 0; step < 120; step++) {
            kappa = 50.0 * (test_random(&random) - 0.5);
            const double eps = 1e-4 * (test_random(&random) - 0.5), h = 1e-7, k = 1e-5;
            const struct wb_fibres_response r = fibre_point_respond(&p, eps, kappa);
            const struct wb_fibres_response e1 = fibre_point_respond(&p, eps - h, kappa),
                                            e2 = fibre_point_respond(&p, eps + h, kappa);
            const struct wb_fibres_response k1 = fibre_point_respond(&p, eps, kappa - k),
                                            k2 = fibre_point_respond(&p, eps, kappa + k);
            /* At a corner the tangent may differ from the secant by a part of a fibre's
             * stiffness. */
            const double EA = wb_fibres_axial_stiffness(p.fibres);
            const double EI = wb_fibres_bending_stiffness(p.fibres), ES = sqrt(EA * EI);
            assert_close((e2.N - e1.N) / (2 * h), r.D11, 2e-2 * EA);
            assert_close((k2.N - k1.N) / (2 * k), r.D12, 2e-2 * ES);
            assert_close((e2.M - e1.M) / (2 * h), r.D12, 2e-2 * ES);
            assert_close((k2.M - k1.M) / (2 * k), r.D22, 2e-2 * EI);
            (void)fibre_point_respond(&p, eps, kappa);
            fibre_point_accept(&p);
        }
        fibre_point_release(&p);
    }
}

static void vector_instructions_do_not_change_a_bit(void **unused)
{
    (void)unused;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        assert_same_bits(&law);
    }
}

static void an_overlay_is_replaced_by_one_with_at_most_as_many_parts(void **unused)
{
    (void)unused;
    const struct wb_law five = parallel_law(0.0), other = parallel_law(0.4), many = ludwik_law(0.0);
    assert_exchanged(&five, &other);
    assert_not_exchanged(&five, &many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_moment_of_parallel_parts_is_that_of_the_closed_form),
        cmocka_unit_test(a_perfectly_plastic_part_is_the_material_without_hardening),
        cmocka_unit_test(isotropic_overlays_follow_ludwiks_law_through_cycles),
        cmocka_unit_test(kinematic_branches_are_the_virgin_curve_at_twice_the_size),
        cmocka_unit_test(kinematic_branches_return_to_the_reversal_point),
        cmocka_unit_test(isotropic_hardening_yields_again_at_the_largest_moment),
        cmocka_unit_test(monotonic_loading_does_not_depend_on_the_rule),
        cmocka_unit_test(no_closed_cycle_produces_work),
        cmocka_unit_test(tangents_agree_with_finite_differences),
        cmocka_unit_test(vector_instructions_do_not_change_a_bit),
        cmocka_unit_test(an_overlay_is_replaced_by_one_with_at_most_as_many_parts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
