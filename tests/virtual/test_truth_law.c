#include "fixtures/virtual/truth_law.h"

#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "fe/rod/fibres.h"
#include "tests/virtual/setup.h"

enum {
    MAX_HISTORY = 16
};

/* A point and its last response. */
struct point {
    struct wb_point_law law;
    double history[MAX_HISTORY], stress, tangent;
};

static struct point make_point(const struct wb_truth_law *law)
{
    struct point p = {.law = wb_truth_law_point(law)};
    assert_true(p.law.n_history <= MAX_HISTORY);
    return p;
}

static double strain_to(struct point *p, double strain)
{
    double after[MAX_HISTORY];
    p->law.respond(p->law.context, strain, p->history, after, &p->stress, &p->tangent);
    memcpy(p->history, after, sizeof after);
    return p->stress;
}

static const double no_time = 0.0;

static void linear_hardening_grows_or_moves(void **unused)
{
    (void)unused;
    const double E = 10e9, H = 2e9, yield = 5e6;
    const struct wb_truth_law grows = {
        .modulus = E, .yield_stress = yield, .strength = H, .exponent = 1.0, .time_step = &no_time};
    const struct wb_truth_law moves = {
        .modulus = E, .yield_stress = yield, .back_modulus = {H, 0.0}, .time_step = &no_time};
    struct point a = make_point(&grows), b = make_point(&moves);
    const double top = 5e-3, slope = E * H / (E + H);
    const double expected = yield + slope * (top - yield / E);
    assert_close_relative(strain_to(&a, top), expected, 1e-12);
    assert_close_relative(strain_to(&b, top), expected, 1e-12);
    assert_close_relative(a.tangent, slope, 1e-12);
    assert_close_relative(b.tangent, slope, 1e-12);
    /* During unloading one law yields at -expected, the other 2 yield below the top. */
    const double back = top - 2.0 * yield / E - 1e-3;
    assert_close_relative(strain_to(&a, back), expected - E * (top - back), 1e-12);
    assert_close_relative(strain_to(&b, back), expected - 2.0 * yield - slope * 1e-3, 1e-11);
}

static void saturating_parts_follow_their_exponentials(void **unused)
{
    (void)unused;
    const struct wb_truth_law law = {.modulus = 10e9,
                                     .yield_stress = 5e6,
                                     .saturation = 8e6,
                                     .rate = 400.0,
                                     .back_modulus = {30e9, 5e9},
                                     .back_recovery = {1500.0, 30.0},
                                     .time_step = &no_time};
    struct point p = make_point(&law), at_once = make_point(&law);
    for (int i = 1; i <= 100; i++)
        (void)strain_to(&p, 1e-2 * i / 100.0);
    assert_close_relative(strain_to(&at_once, 1e-2), p.stress, 1e-10);
    const double plastic = p.history[1];
    double expected = 5e6 + 8e6 * (1.0 - exp(-400.0 * plastic));
    expected += 30e9 / 1500.0 * (1.0 - exp(-1500.0 * plastic));
    expected += 5e9 / 30.0 * (1.0 - exp(-30.0 * plastic));
    assert_close_relative(p.stress, expected, 1e-10);
    assert_close_relative(p.stress, 10e9 * (1e-2 - plastic), 1e-9);
}

static void a_maxwell_part_relaxes(void **unused)
{
    (void)unused;
    double step = 0.0;
    const struct wb_truth_law law = {
        .modulus = 1e9, .relaxing_modulus = 2e9, .relaxation_time = 15.0, .time_step = &step};
    struct point p = make_point(&law);
    assert_close_relative(strain_to(&p, 1e-3), 3e6, 1e-12);
    step = 3.0;
    for (int i = 1; i <= 10; i++)
        assert_close_relative(strain_to(&p, 1e-3), 1e6 + 2e6 * exp(-3.0 * i / 15.0), 1e-12);
}

/* Eyring's law: at the stress q0 relaxation is e times as fast, in small steps. */
static void a_maxwell_part_relaxes_faster_at_a_larger_stress(void **unused)
{
    (void)unused;
    const double step = 1e-3, tau = 10.0, modulus = 1e9;
    double left[2];
    for (int i = 0; i < 2; i++) {
        double strain = i == 0 ? 1e-6 : 1e-3;
        const struct wb_truth_law law = {.modulus = 1e3,
                                         .relaxing_modulus = modulus,
                                         .relaxation_time = tau,
                                         .relaxation_stress = modulus * 1e-3,
                                         .time_step = &step};
        struct point p = make_point(&law);
        const double start = strain_to(&p, strain);
        for (int k = 0; k < 100; k++)
            (void)strain_to(&p, strain);
        left[i] = p.stress / start;
    }
    assert_close_relative(1.0 - left[0], 0.1 / tau, 0.01);
    assert_close_relative(1.0 - left[1], 0.1 / tau * exp(1.0), 0.03);
}

/* A negative Q: the stress decreases once the part slips, and stays low during unloading. */
static void strands_carry_less_once_they_slip(void **unused)
{
    (void)unused;
    const double E = 10e9, yield = 1e6;
    const struct wb_truth_law law = {.modulus = E,
                                     .yield_stress = yield,
                                     .saturation = -0.4 * yield,
                                     .rate = 2000.0,
                                     .time_step = &no_time};
    struct point p = make_point(&law);
    assert_close_relative(strain_to(&p, 0.999 * yield / E), 0.999 * yield, 1e-9);
    for (int k = 1; k <= 100; k++)
        (void)strain_to(&p, yield / E + 1e-4 * k);
    assert_close_relative(p.stress, 0.6 * yield, 1e-3);
    assert_close_relative(strain_to(&p, yield / E + 5e-3), -0.6 * yield, 1e-3);
}

static void tangents_agree_with_finite_differences(void **unused)
{
    (void)unused;
    double step = 0.3;
    const struct wb_truth_law law = {.modulus = 10e9,
                                     .yield_stress = 5e6,
                                     .strength = 300e6,
                                     .exponent = 0.6,
                                     .saturation = 8e6,
                                     .rate = 400.0,
                                     .back_modulus = {30e9, 5e9},
                                     .back_recovery = {1500.0, 30.0},
                                     .relaxing_modulus = 2e9,
                                     .relaxation_time = 15.0,
                                     .time_step = &step};
    struct point p = make_point(&law);
    uint64_t random = 5;
    for (int i = 0; i < 200; i++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const double strain = 2e-2 * ((double)(random >> 11) / 9007199254740992.0 - 0.5);
        double low, high, slope, after[MAX_HISTORY];
        const double h = 1e-8;
        p.law.respond(&law, strain - h, p.history, after, &low, &slope);
        p.law.respond(&law, strain + h, p.history, after, &high, &slope);
        (void)strain_to(&p, strain);
        assert_close((high - low) / (2.0 * h), p.tangent, 2e-3 * 12e9);
    }
}

static void the_variants_differ_in_unloading_as_intended(void **unused)
{
    (void)unused;
    struct setup setup;
    setup_bench(&setup, "type2-L85-1", 3);
    double up[WB_COMPOSITE_VARIANTS], back[WB_COMPOSITE_VARIANTS];
    for (int variant = 0; variant < WB_COMPOSITE_VARIANTS; variant++) {
        struct wb_composite_laws laws = {.time_step = 0.1};
        struct wb_section section;
        struct wb_fibres *fibres;
        struct wb_fibres_response r;
        assert_int_equal(wb_composite_build_variant(&setup.composite, variant, &setup.wire, 1.0,
                                                    1.0, 12, &laws, &section),
                         WB_OK);
        assert_int_equal(wb_fibres_create(&fibres, &section), WB_OK);
        double *before = calloc(2 * wb_fibres_history_size(fibres), sizeof *before);
        double *const after = before + wb_fibres_history_size(fibres);
        assert_non_null(before);
        wb_fibres_respond(fibres, 0.0, 30.0, before, after, &r);
        up[variant] = r.M;
        wb_fibres_respond(fibres, 0.0, 15.0, after, before, &r);
        back[variant] = r.M;
        free(before);
        wb_fibres_destroy(fibres);
        wb_section_release(&section);
        print_message("    %-12s M(30 /m) = %.2f N mm, back at 15 /m %.2f\n",
                      wb_composite_variant_names[variant], up[variant] * 1e3, back[variant] * 1e3);
    }
    const double M = up[WB_COMPOSITE_KINEMATIC];
    assert_close_relative(up[WB_COMPOSITE_ISOTROPIC], M, 1e-9);
    assert_close_relative(up[WB_COMPOSITE_MIXED], M, 1e-9);
    /* All have similar forces, so that the same instruments can be used. */
    for (int variant = 0; variant < WB_COMPOSITE_VARIANTS; variant++)
        assert_true(up[variant] > 0.5 * M && up[variant] < 2.0 * M);
    assert_true(back[WB_COMPOSITE_ISOTROPIC] < back[WB_COMPOSITE_MIXED] - 0.05 * M);
    assert_true(back[WB_COMPOSITE_MIXED] < back[WB_COMPOSITE_KINEMATIC] - 0.05 * M);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_hardening_grows_or_moves),
        cmocka_unit_test(saturating_parts_follow_their_exponentials),
        cmocka_unit_test(a_maxwell_part_relaxes),
        cmocka_unit_test(a_maxwell_part_relaxes_faster_at_a_larger_stress),
        cmocka_unit_test(strands_carry_less_once_they_slip),
        cmocka_unit_test(tangents_agree_with_finite_differences),
        cmocka_unit_test(the_variants_differ_in_unloading_as_intended),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
