#include "fe/rod/fibres.h"

#include <stdlib.h>

#include "fe/rod/fibres_private.h"
#include "tests/fe/rod/fibre_point.h"
#include "tests/fe/rod/wires.h"

static void vector_instructions_do_not_change_a_bit(void **unused)
{
    (void)unused;
    uint64_t random = 43;
    for (int trial = 0; trial < 12; trial++) {
        const struct test_wire wire = test_wire_type(1 + trial % 3);
        struct wb_section s = trial % 4 == 3 ? test_composite_section() : test_section(&wire);
        struct fibre_point fastest = fibre_point_make(&s), portable = fibre_point_make(&s);
        wb_fibres_set_portable(portable.fibres);
        for (int step = 0; step < 200; step++) {
            const double eps = 2e-3 * (test_random(&random) - 0.5);
            /* Also beyond the table, where the law is solved. */
            const double kappa = (step % 50 == 0 ? 1e5 : 80.0) * (test_random(&random) - 0.5);
            const struct wb_fibres_response a = fibre_point_respond(&fastest, eps, kappa);
            const struct wb_fibres_response b = fibre_point_respond(&portable, eps, kappa);
            assert_memory_equal(&a, &b, sizeof a);
            if (step % 3 == 0) {
                fibre_point_accept(&fastest);
                fibre_point_accept(&portable);
            }
        }
        assert_memory_equal(fastest.before, portable.before,
                            wb_fibres_history_size(portable.fibres) * sizeof(double));
        fibre_point_release(&fastest);
        fibre_point_release(&portable);
        wb_section_release(&s);
    }
}

static void tangent_is_the_derivative_of_the_resultants(void **unused)
{
    (void)unused;
    struct wb_section s = test_composite_section();
    struct fibre_point p = fibre_point_make(&s);
    fibre_point_respond(&p, 1e-3, 25.0);
    fibre_point_accept(&p);
    const double states[][2] = {{1.2e-3, 30.0}, {0.8e-3, 10.0}, {-1e-3, -40.0}};
    const double EA = wb_fibres_axial_stiffness(p.fibres);
    for (size_t i = 0; i < 3; i++) {
        const double eps = states[i][0], kappa = states[i][1], d = 1e-8, dk = 1e-4;
        const struct wb_fibres_response at = fibre_point_respond(&p, eps, kappa);
        const struct wb_fibres_response e0 = fibre_point_respond(&p, eps - d, kappa);
        const struct wb_fibres_response e1 = fibre_point_respond(&p, eps + d, kappa);
        const struct wb_fibres_response k0 = fibre_point_respond(&p, eps, kappa - dk);
        const struct wb_fibres_response k1 = fibre_point_respond(&p, eps, kappa + dk);
        assert_close(at.D11, (e1.N - e0.N) / (2.0 * d), 1e-5 * EA);
        assert_close(at.D12, (e1.M - e0.M) / (2.0 * d), 1e-5 * EA * 1e-3);
        assert_close(at.D12, (k1.N - k0.N) / (2.0 * dk), 1e-5 * EA * 1e-3);
        assert_close(at.D22, (k1.M - k0.M) / (2.0 * dk), 1e-5 * EA * 1e-6);
    }
    fibre_point_release(&p);
    wb_section_release(&s);
}

static void fully_plastic_moment_of_the_circle_is_four_thirds(void **unused)
{
    (void)unused;
    struct test_wire wire = test_wire_type(1);
    wire.material.strength_coefficient = 0.0;
    struct wb_section s;
    assert_int_equal(wb_section_init_circle(&s, wire.diameter, &wire.material, 400), WB_OK);
    struct fibre_point p = fibre_point_make(&s);

    const double R = 0.5 * wire.diameter, sigma = wire.material.yield_stress;
    const double plastic = fibre_point_respond(&p, 0.0, 1e4).M;
    assert_close_relative(plastic, 4.0 / 3.0 * sigma * R * R * R, 1e-4);

    /* The first fibre at y = R yields at M = pi R^3 sigma / 4: the ratio is 16 / (3 pi). */
    const double first =
        sigma / (wire.material.youngs_modulus * R) * wb_fibres_bending_stiffness(p.fibres);
    print_message("plastic over yield moment of the circle: %.5f (exact %.5f)\n", plastic / first,
                  16.0 / (3.0 * M_PI));
    assert_close_relative(plastic / first, 16.0 / (3.0 * M_PI), 1e-4);
    fibre_point_release(&p);
    wb_section_release(&s);
}

static void rectangle_follows_its_closed_form(void **unused)
{
    (void)unused;
    enum {
        STRIPS = 2000
    };
    const double b = 1e-3, height = 2e-3;
    struct wb_material m = test_wire_type(1).material;
    m.strength_coefficient = 0.0;
    struct wb_fibre *fibres = calloc(STRIPS, sizeof *fibres);
    assert_non_null(fibres);
    for (int i = 0; i < STRIPS; i++) {
        fibres[i].y = height * ((i + 0.5) / STRIPS - 0.5);
        fibres[i].area = b * height / STRIPS;
    }
    const struct wb_section s = {STRIPS, fibres, 1, &m, 1e3};
    struct fibre_point p = fibre_point_make(&s);
    const double yield_kappa = m.yield_stress / (m.youngs_modulus * 0.5 * height);
    const double Mp = m.yield_stress * b * height * height / 4.0;

    for (double over = 1.1; over < 20.0; over *= 1.5) {
        const double exact = Mp * (1.0 - 1.0 / (3.0 * over * over));
        assert_close_relative(fibre_point_respond(&p, 0.0, over * yield_kappa).M, exact, 1e-6);
    }
    assert_close_relative(fibre_point_respond(&p, 0.0, yield_kappa).M, Mp / 1.5, 1e-6);
    fibre_point_release(&p);
    free(fibres);
}

static void pure_power_law_moment_is_its_integral(void **unused)
{
    (void)unused;
    /* For E -> infinity and sigma_Y -> 0 the law is sigma = K e^n: M = 2 K kappa^n int y^(n+1) 2
     * sqrt(R^2 - y^2) dy = 2 K kappa^n R^(n+3) B((n+2)/2, 3/2). */
    const double R = 0.5e-3, K = 1e9, kappa = 20.0;
    const double exponents[] = {0.3, 0.6, 0.9};
    for (size_t i = 0; i < 3; i++) {
        const double n = exponents[i];
        const struct wb_material m = {WB_HARDENING_ISOTROPIC_POWER, 1e16, 0.3, 1e-3, K, n};
        const double beta = tgamma(0.5 * n + 1.0) * tgamma(1.5) / tgamma(0.5 * n + 2.5);
        const double exact = 2.0 * K * pow(kappa, n) * pow(R, n + 3.0) * beta;
        const int counts[] = {20, 200};
        for (size_t k = 0; k < 2; k++) {
            struct wb_section s;
            assert_int_equal(wb_section_init_circle(&s, 2.0 * R, &m, counts[k]), WB_OK);
            struct fibre_point p = fibre_point_make(&s);
            const double error = fibre_point_respond(&p, 0.0, kappa).M / exact - 1.0;
            print_message("power law moment, n = %.1f, %d fibres: %+.2g\n", n, counts[k], error);
            assert_close(error, 0.0, k == 0 ? 2e-3 : 2e-5);
            fibre_point_release(&p);
            wb_section_release(&s);
        }
    }
}

static void springback_is_elastic(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct wb_section s = test_section(&wire);
    struct fibre_point p = fibre_point_make(&s);
    const double kappa = 30.0;
    const double M = fibre_point_respond(&p, 0.0, kappa).M;
    fibre_point_accept(&p);
    const double left = kappa - M / wb_fibres_bending_stiffness(p.fibres);
    const struct wb_fibres_response r = fibre_point_respond(&p, 0.0, left);
    assert_close(r.M, 0.0, 1e-12 * M);
    assert_close_relative(r.D22, wb_fibres_bending_stiffness(p.fibres), 1e-13);
    /* Residual stresses remain: the resultants are zero, the fibres' stresses are not. */
    fibre_point_accept(&p);
    assert_true(wb_fibres_largest_plastic_strain(p.fibres, p.before) > 1e-3);
    fibre_point_release(&p);
    wb_section_release(&s);
}

static void replaced_materials_act_like_new_ones(void **unused)
{
    (void)unused;
    const struct test_wire one = test_wire_type(1), three = test_wire_type(3);
    struct test_wire mixed = one;
    mixed.material = three.material;
    struct wb_section a = test_section(&one), b = test_section(&mixed);
    struct fibre_point p = fibre_point_make(&a), q = fibre_point_make(&b);
    wb_fibres_set_materials(p.fibres, &three.material);
    const struct wb_fibres_response r = fibre_point_respond(&p, 1e-4, 20.0),
                                    t = fibre_point_respond(&q, 1e-4, 20.0);
    assert_true(r.N == t.N && r.M == t.M && r.D22 == t.D22);
    assert_close_relative(wb_fibres_shear_stiffness(p.fibres), wb_fibres_shear_stiffness(q.fibres),
                          1e-14);
    fibre_point_release(&p);
    fibre_point_release(&q);
    wb_section_release(&a);
    wb_section_release(&b);
}

/* A section whose law has Maxwell elements, and the moment of its relaxed law. */
struct relaxing {
    struct wb_section section, relaxed;
    struct fibre_point point, without;
    struct wb_law law;
};

static void make_relaxing(struct relaxing *r, int n)
{
    const struct test_wire wire = test_wire_type(2);
    const struct wb_law_part parts[] = {{1e9, 1e-3}, {2e9, (double)INFINITY}};
    wb_law_init_parallel(&r->law, parts, 2, 0.0, 0.39);
    assert_int_equal(wb_section_init_law(&r->relaxed, wire.diameter, &r->law, 0), WB_OK);
    r->law.n_maxwell = n;
    r->law.maxwell[0] = (struct wb_law_maxwell){0.5e9, 3.0};
    r->law.maxwell[1] = (struct wb_law_maxwell){0.2e9, 40.0};
    assert_int_equal(wb_section_init_law(&r->section, wire.diameter, &r->law, 0), WB_OK);
    r->point = fibre_point_make(&r->section);
    r->without = fibre_point_make(&r->relaxed);
}

static void release_relaxing(struct relaxing *r)
{
    fibre_point_release(&r->point);
    fibre_point_release(&r->without);
    wb_section_release(&r->section);
    wb_section_release(&r->relaxed);
}

/* Changes the curvature within a time, in n steps; returns the moment minus the relaxed law's, over
 * that of an elastic section of modulus 1. */
static double change_curvature(struct relaxing *r, double *kappa, double to, double time, int n)
{
    struct wb_fibres_response with = {0}, without = {0};
    const double from = *kappa;
    wb_fibres_set_duration(r->point.fibres, time / n);
    for (int i = 1; i <= n; i++) {
        *kappa = from + (to - from) * i / n;
        with = fibre_point_respond(&r->point, 0.0, *kappa);
        without = fibre_point_respond(&r->without, 0.0, *kappa);
        fibre_point_accept(&r->point);
        fibre_point_accept(&r->without);
    }
    const double I = wb_fibres_bending_stiffness(r->without.fibres) / 3e9;
    return (with.M - without.M) / I;
}

/* q' = E kappa' - q / tau for a ramp, a rest and a ramp back, in closed form; the same in one step
 * or many. */
static void maxwell_elements_follow_their_rate_form(void **unused)
{
    (void)unused;
    for (int n = 1; n <= 7; n += 3) {
        struct relaxing r;
        double kappa = 0.0, q[2] = {0.0, 0.0}, sum = 0.0;
        make_relaxing(&r, 2);
        const double ways[][2] = {{30.0, 50.0}, {30.0, 5.0}, {-4.0, 2.0}, {10.0, 1e6}};
        for (size_t k = 0; k < sizeof ways / sizeof ways[0]; k++) {
            const double time = ways[k][1], rate = (ways[k][0] - kappa) / time;
            sum = 0.0;
            for (int i = 0; i < 2; i++) {
                const double E = r.law.maxwell[i].modulus, tau = r.law.maxwell[i].time;
                q[i] = E * rate * tau + (q[i] - E * rate * tau) * exp(-time / tau);
                sum += q[i];
            }
            assert_close(change_curvature(&r, &kappa, ways[k][0], time, n), sum,
                         1e-9 * 0.7e9 * 30.0);
        }
        assert_close(sum, 0.0, 1e-3 * 0.7e9); /* all relaxed */
        /* A sudden change is elastic. */
        assert_close(change_curvature(&r, &kappa, 11.0, 0.0, 1), 0.7e9 + sum, 1e-9 * 0.7e9 * 30.0);
        /* A slow change adds no stress. */
        assert_close(change_curvature(&r, &kappa, 13.0, (double)INFINITY, 1), 0.0, 1e-9 * 0.7e9);
        release_relaxing(&r);
    }
}

static void tangent_of_a_relaxing_section_is_the_derivative(void **unused)
{
    (void)unused;
    struct relaxing r;
    double kappa = 0.0;
    make_relaxing(&r, 1);
    (void)change_curvature(&r, &kappa, 20.0, 4.0, 3);
    wb_fibres_set_duration(r.point.fibres, 2.0);
    const double at = 21.0, d = 1e-5, de = 1e-9;
    const struct wb_fibres_response low = fibre_point_respond(&r.point, 0.0, at - d);
    const struct wb_fibres_response high = fibre_point_respond(&r.point, 0.0, at + d);
    const struct wb_fibres_response out = fibre_point_respond(&r.point, de, at);
    const struct wb_fibres_response here = fibre_point_respond(&r.point, 0.0, at);
    assert_close_relative(here.D22, (high.M - low.M) / (2.0 * d), 1e-6);
    assert_close_relative(here.D11, (out.N - here.N) / de, 1e-4);
    release_relaxing(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vector_instructions_do_not_change_a_bit),
        cmocka_unit_test(tangent_is_the_derivative_of_the_resultants),
        cmocka_unit_test(fully_plastic_moment_of_the_circle_is_four_thirds),
        cmocka_unit_test(rectangle_follows_its_closed_form),
        cmocka_unit_test(pure_power_law_moment_is_its_integral),
        cmocka_unit_test(springback_is_elastic),
        cmocka_unit_test(replaced_materials_act_like_new_ones),
        cmocka_unit_test(maxwell_elements_follow_their_rate_form),
        cmocka_unit_test(tangent_of_a_relaxing_section_is_the_derivative),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
