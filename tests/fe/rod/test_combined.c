/* Sections with combined hardening: Chaboche's law, Ludwik's law with a yield surface that grows
 * and moves, and parallel elastic-plastic parts whose yield limits grow. The references are closed
 * forms and the rate equations, integrated independently in small steps. */
#include "fe/material/hardening.h"
#include "fe/material/law.h"
#include "fe/rod/lanes.h"
#include "tests/fe/rod/points.h"

static const struct wb_material elastic = {
    WB_HARDENING_NONE_ELASTIC, 5641.0 * WB_MPA, 0.39, 2.2 * WB_MPA, 0.0, 0.0};
static const struct wb_law_back two_backs[] = {{2600.0 * WB_MPA, 900.0}, {700.0 * WB_MPA, 60.0}};

static struct wb_law chaboche(double saturation, double rate, int n_backs)
{
    struct wb_law law;
    wb_law_init_chaboche(&law, &elastic, saturation, rate, two_backs, n_backs);
    return law;
}

static struct wb_law combined(double share)
{
    const struct wb_material m = {
        WB_HARDENING_ISOTROPIC_POWER, 5641.0 * WB_MPA, 0.39, 4.95 * WB_MPA, 850.0 * WB_MPA, 0.78};
    struct wb_law law;
    wb_law_init_ludwik(&law, &m);
    law.isotropic_share = share;
    law.is_combined = true;
    return law;
}

static struct wb_law growing_parts(double share)
{
    static const struct wb_law_part parts[] = {{1800.0 * WB_MPA, 6e-4},
                                               {1500.0 * WB_MPA, 1.5e-3},
                                               {900.0 * WB_MPA, 5e-3},
                                               {250.0 * WB_MPA, (double)INFINITY}};
    struct wb_law law;
    wb_law_init_parallel(&law, parts, sizeof parts / sizeof parts[0], share, 0.39);
    law.is_combined = true;
    return law;
}

enum {
    ONE_SURFACE = 7, /* the first laws of law_of() have a single yield surface */
    LAWS = 8
};

static struct wb_law law_of(int i)
{
    struct wb_law law = chaboche(1.4 * WB_MPA, 250.0, 2);
    switch (i) {
    case 0:
        return law;
    case 1:
        return chaboche(0.0, 0.0, 1);
    case 2:
        return chaboche(1.4 * WB_MPA, 250.0, 0);
    case 3:
        law.backs[1].recovery = 0.0; /* linear back stress, as in Prager's law */
        return law;
    case 4:
        return combined(0.0);
    case 5:
        return combined(0.3);
    case 6:
        return combined(1.0);
    default:
        return growing_parts(0.2);
    }
}

static double area(void)
{
    return M_PI * DIAMETER * DIAMETER / 4.0;
}

/* Stress of a section in pure tension, where it is equal in all fibres; commits the history. */
static double stretch(struct fibre_point *p, double strain, double *tangent)
{
    const struct wb_fibres_response r = fibre_point_respond(p, strain, 0.0);
    fibre_point_accept(p);
    if (tangent)
        *tangent = r.D11 / area();
    return r.N / area();
}

/* --- rate equations of a law, in small steps --- */

struct rates {
    const struct wb_law *law;
    double strain, plastic, accumulated, grown, back[WB_LAW_MOST_BACKS];
};

/* Stress minus back stresses. */
static double effective_stress(const struct rates *r)
{
    double stress = r->law->material.youngs_modulus * (r->strain - r->plastic);
    for (int i = 0; i < WB_LAW_MOST_BACKS; i++)
        stress -= r->back[i];
    return stress;
}

/* Derivatives of the isotropic hardening and of the back stresses with respect to the accumulated
 * plastic strain; s is the sign of the plastic flow. */
static void find_rates(const struct rates *r, double s, double *growth, double *back)
{
    const struct wb_law *const law = r->law;
    const struct wb_material *const m = &law->material;
    memset(back, 0, WB_LAW_MOST_BACKS * sizeof *back);
    if (law->form == WB_LAW_CHABOCHE) {
        *growth = law->rate * (law->saturation - r->grown);
        for (int i = 0; i < law->n_backs; i++)
            back[i] = s * law->backs[i].modulus - law->backs[i].recovery * r->back[i];
        return;
    }
    const double slope = m->strength_coefficient * m->hardening_exponent *
                         pow(r->accumulated, m->hardening_exponent - 1.0);
    *growth = law->isotropic_share * slope;
    back[0] = s * (1.0 - law->isotropic_share) * slope;
}

static void advance(struct rates *r, double s, double dp, double growth, const double *back)
{
    r->plastic += s * dp;
    r->accumulated += dp;
    r->grown += growth * dp;
    for (int i = 0; i < WB_LAW_MOST_BACKS; i++)
        r->back[i] += back[i] * dp;
}

/* Integrates to a strain in n steps of the midpoint rule; returns the stress. */
static double integrate(struct rates *r, double strain, int n)
{
    const double E = r->law->material.youngs_modulus, step = (strain - r->strain) / n;
    for (int k = 0; k < n; k++) {
        double growth, back[WB_LAW_MOST_BACKS];
        r->strain += step;
        double over = fabs(effective_stress(r)) - r->law->material.yield_stress - r->grown;
        if (over <= 0.0)
            continue;
        const double s = effective_stress(r) > 0.0 ? 1.0 : -1.0;
        struct rates middle = *r;
        if (middle.accumulated == 0.0)
            middle.accumulated = r->accumulated = 1e-30;
        for (int half = 0; half < 2; half++) {
            find_rates(&middle, s, &growth, back);
            double slope = E + growth;
            for (int i = 0; i < WB_LAW_MOST_BACKS; i++)
                slope += s * back[i];
            const double dp = over / slope;
            if (half == 0) {
                middle = *r;
                advance(&middle, s, 0.5 * dp, growth, back);
            } else {
                advance(r, s, dp, growth, back);
            }
        }
    }
    return E * (r->strain - r->plastic);
}

/* --- facts --- */

static void vector_exponential_agrees_with_expm1(void **unused)
{
    (void)unused;
    double largest = 0.0;
    for (double x = 1e-12; x < 720.0; x *= 1.01) {
        const lanes got = one_less_exponential((lanes){x, 0.5 * x, 0.0, 1.3 * x});
        largest = fmax(largest, fabs(got[0] / -expm1(-x) - 1.0));
        largest = fmax(largest, fabs(got[1] / -expm1(-0.5 * x) - 1.0));
        largest = fmax(largest, fabs(got[3] / -expm1(-1.3 * x) - 1.0));
        assert_true(got[2] == 0.0);
    }
    assert_true(largest < 5e-16);
}

static void first_loading_follows_the_virgin_curve_for_any_step_size(void **unused)
{
    (void)unused;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        struct fibre_point p = make_point(&law, 20);
        for (int k = 1; k <= 40; k++) {
            const double strain = 5e-4 * k;
            double slope, tangent;
            const double stress = wb_law_virgin_stress(&law, strain, &slope);
            assert_close_relative(stretch(&p, strain, &tangent), stress, 1e-10);
            assert_close(tangent, slope, 1e-9 * law.material.youngs_modulus);
            struct fibre_point fresh = make_point(&law, 20);
            assert_close_relative(stretch(&fresh, strain, NULL), stress, 1e-10);
            fibre_point_release(&fresh);
        }
        fibre_point_release(&p);
    }
}

static void virgin_curve_of_chaboche_agrees_with_the_closed_form(void **unused)
{
    (void)unused;
    const struct wb_law law = law_of(0);
    for (double p = 1e-6; p < 0.1; p *= 3.0) {
        double stress = law.material.yield_stress + law.saturation * (1.0 - exp(-law.rate * p));
        for (int i = 0; i < 2; i++)
            stress += law.backs[i].modulus / law.backs[i].recovery *
                      (1.0 - exp(-law.backs[i].recovery * p));
        const double strain = p + stress / law.material.youngs_modulus;
        assert_close_relative(wb_law_virgin_stress(&law, strain, NULL), stress, 1e-12);
    }
}

/* The difference from the rate equations must be small, and smaller with finer steps. */
static void reversals_follow_the_rate_equations(void **unused)
{
    (void)unused;
    static const double turns[] = {4e-3, -1e-3, 2e-3, -6e-3, 8e-3, 0.0};
    for (int i = 0; i < ONE_SURFACE; i++) {
        const struct wb_law law = law_of(i);
        double difference[2] = {0.0, 0.0};
        for (int fine = 0; fine < 2; fine++) {
            struct fibre_point p = make_point(&law, 4);
            struct rates rates = {.law = &law};
            for (size_t k = 0; k < sizeof turns / sizeof turns[0]; k++) {
                const double expected = integrate(&rates, turns[k], fine ? 160000 : 40000);
                const double got = stretch(&p, turns[k], NULL);
                difference[fine] = fmax(difference[fine], fabs(got - expected));
            }
            fibre_point_release(&p);
        }
        /* The tolerance is wider for Ludwik's law, whose initial slope is infinite. */
        assert_true(difference[1] < (law.form == WB_LAW_CHABOCHE ? 2e-5 : 1e-3) * WB_MPA);
        assert_true(difference[1] < 0.6 * difference[0]);
    }
}

static void tangents_agree_with_finite_differences(void **unused)
{
    (void)unused;
    uint64_t random = 11;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        struct fibre_point p = make_point(&law, 20);
        for (int step = 0; step < 100; step++) {
            const double eps = 2e-3 * (test_random(&random) - 0.5);
            const double kappa = 60.0 * (test_random(&random) - 0.5), d = 1e-8, dk = 1e-5;
            const struct wb_fibres_response r = fibre_point_respond(&p, eps, kappa);
            const struct wb_fibres_response e0 = fibre_point_respond(&p, eps - d, kappa);
            const struct wb_fibres_response e1 = fibre_point_respond(&p, eps + d, kappa);
            const struct wb_fibres_response k0 = fibre_point_respond(&p, eps, kappa - dk);
            const struct wb_fibres_response k1 = fibre_point_respond(&p, eps, kappa + dk);
            const double EA = wb_fibres_axial_stiffness(p.fibres);
            const double EI = wb_fibres_bending_stiffness(p.fibres);
            assert_close(r.D11, (e1.N - e0.N) / (2.0 * d), 1e-4 * EA);
            assert_close(r.D12, (k1.N - k0.N) / (2.0 * dk), 1e-4 * EA * DIAMETER);
            assert_close(r.D22, (k1.M - k0.M) / (2.0 * dk), 1e-4 * EI);
            (void)bend(&p, kappa);
        }
        fibre_point_release(&p);
    }
}

static void ludwik_is_isotropic_at_share_1_and_kinematic_at_share_0(void **unused)
{
    (void)unused;
    const struct wb_law growing = combined(1.0), moving = combined(0.0);
    struct wb_law plain = growing;
    uint64_t random = 5;
    plain.is_combined = false;
    struct fibre_point p = make_point(&growing, 20), same = make_point(&plain, 20);
    for (int step = 0; step < 200; step++) {
        const double kappa = 60.0 * (test_random(&random) - 0.5);
        const double M = bend(&same, kappa);
        assert_close(bend(&p, kappa), M, 1e-9 * fabs(M) + 1e-13);
    }
    fibre_point_release(&p);
    fibre_point_release(&same);

    struct fibre_point q = make_point(&moving, 4);
    const double E = moving.material.youngs_modulus, sigma_Y = moving.material.yield_stress;
    const double top = stretch(&q, 6e-3, NULL);
    const double elastic_range = 2.0 * sigma_Y / E;
    double tangent;
    assert_close_relative(stretch(&q, 6e-3 - 0.999 * elastic_range, &tangent),
                          top - 0.999 * 2.0 * sigma_Y, 1e-9);
    assert_close_relative(tangent, E, 1e-12);
    (void)stretch(&q, 6e-3 - 1.001 * elastic_range, &tangent);
    assert_true(tangent < 0.5 * E);
    fibre_point_release(&q);
}

/* A part is strained between +-w/2. In units of strain its yield limit a grows by h dp, with
 * h = share / (1 - share). Each half cycle therefore takes a to a + h (w - 2 a) / (1 + h), the
 * stress at its end over E. The sequence converges to w / 2, where yielding ends. */
static void part_with_growing_limit_shakes_down(void **unused)
{
    (void)unused;
    const double E = 3000.0 * WB_MPA, yields_at = 1e-3, strain = 4e-3, share = 0.2;
    const double h = share / (1.0 - share);
    const struct wb_law_part part = {E, yields_at};
    struct wb_law law;
    wb_law_init_parallel(&law, &part, 1, share, 0.39);
    law.is_combined = true;
    struct fibre_point p = make_point(&law, 4);
    double limit = yields_at + h * (strain - yields_at) / (1.0 + h), tangent;
    assert_close_relative(stretch(&p, strain, &tangent), E * limit, 1e-12);
    assert_close_relative(tangent, share * E, 1e-12);
    for (int turn = 1; turn < 60; turn++) {
        limit += h * fmax(2.0 * strain - 2.0 * limit, 0.0) / (1.0 + h);
        const double sign = turn % 2 ? -1.0 : 1.0;
        assert_close_relative(stretch(&p, sign * strain, NULL), sign * E * limit, 1e-12);
    }
    assert_close_relative(limit, strain, 1e-6);
    fibre_point_release(&p);
}

/* On an arbitrary path, the moment of all parts is the sum of the moments of each part alone. */
static void moments_of_parts_with_growing_limits_add_up(void **unused)
{
    (void)unused;
    const struct wb_law all = growing_parts(0.2);
    struct fibre_point p = make_point(&all, 20), parts[4];
    uint64_t random = 17;
    for (int i = 0; i < 4; i++) {
        struct wb_law one = all;
        wb_law_init_parallel(&one, &all.parts[i], 1, 0.2, 0.39);
        one.is_combined = true;
        parts[i] = make_point(&one, 20);
    }
    for (int step = 0; step < 200; step++) {
        const double kappa = 60.0 * (test_random(&random) - 0.5);
        double sum = 0.0;
        for (int i = 0; i < 4; i++)
            sum += bend(&parts[i], kappa);
        assert_close(bend(&p, kappa), sum, 1e-12 * fabs(sum) + 1e-16);
    }
    for (int i = 0; i < 4; i++)
        fibre_point_release(&parts[i]);
    fibre_point_release(&p);
}

static void parts_with_constant_limits_are_kinematic(void **unused)
{
    (void)unused;
    const struct wb_law growing = growing_parts(0.0);
    struct wb_law kinematic = growing;
    uint64_t random = 5;
    kinematic.is_combined = false;
    struct fibre_point p = make_point(&growing, 20), same = make_point(&kinematic, 20);
    for (int step = 0; step < 200; step++) {
        const double kappa = 60.0 * (test_random(&random) - 0.5);
        const double M = bend(&same, kappa);
        assert_close(bend(&p, kappa), M, 1e-12 * fabs(M) + 1e-16);
    }
    fibre_point_release(&p);
    fibre_point_release(&same);
}

/* Strains a section until it has this stress; returns the strain. */
static double reach_stress(struct fibre_point *p, double stress)
{
    double low = -0.1, high = 0.1;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (fibre_point_respond(p, middle, 0.0).N < stress * area())
            low = middle;
        else
            high = middle;
    }
    assert_close(stretch(p, high, NULL), stress, 1e-9 * WB_MPA);
    return high;
}

/* The stress is cycled between two limits, with one saturating back stress and no isotropic
 * hardening. By Lemaitre and Chaboche, Mechanics of Solid Materials, 5.4.4, the plastic strain of a
 * cycle is
 *
 *     1/gamma ln (((C/gamma)^2 - (least + sigma_Y)^2) / ((C/gamma)^2 - (most - sigma_Y)^2)).
 */
static void ratchetting_agrees_with_the_closed_form(void **unused)
{
    (void)unused;
    const struct wb_law law = law_of(1);
    const double ratio = law.backs[0].modulus / law.backs[0].recovery;
    const double most = law.material.yield_stress + 0.8 * ratio;
    const double least = -law.material.yield_stress - 0.5 * ratio;
    const double expected = log((1.0 - 0.5 * 0.5) / (1.0 - 0.8 * 0.8)) / law.backs[0].recovery;
    struct fibre_point p = make_point(&law, 4);
    double before = reach_stress(&p, most);
    for (int cycle = 0; cycle < 5; cycle++) {
        (void)reach_stress(&p, least);
        const double strain = reach_stress(&p, most);
        assert_close_relative(strain - before, expected, 1e-6);
        before = strain;
    }
    fibre_point_release(&p);
}

/* Cycled between two curvatures, the loop closes and its work is not negative. */
static void loops_close_and_dissipate_energy(void **unused)
{
    (void)unused;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        struct fibre_point p = make_point(&law, 20);
        double M[2] = {0.0, 0.0}, work = 0.0, last = 0.0, at = 0.0;
        for (int cycle = 0; cycle < 60; cycle++) {
            work = 0.0;
            for (int step = 1; step <= 80; step++) {
                const double part = step <= 40 ? step / 20.0 - 1.0 : 3.0 - step / 20.0;
                const double next = bend(&p, 25.0 * part);
                work += 0.5 * (last + next) * (25.0 * part - at);
                at = 25.0 * part;
                last = next;
                if (step == 40) {
                    M[0] = M[1];
                    M[1] = next;
                }
            }
            /* Without saturation of the isotropic hardening the cycles become elastic. */
            assert_true(work > (law.form == WB_LAW_CHABOCHE ? 1e-3 : -1e-12) * fabs(25.0 * last));
        }
        assert_close_relative(M[0], M[1], law.form == WB_LAW_CHABOCHE ? 1e-3 : 2e-2);
        fibre_point_release(&p);
    }
}

static void vector_instructions_give_identical_bits(void **unused)
{
    (void)unused;
    for (int i = 0; i < LAWS; i++) {
        const struct wb_law law = law_of(i);
        assert_same_bits(&law);
    }
}

static void law_can_be_replaced_by_a_compatible_one(void **unused)
{
    (void)unused;
    const struct wb_law two = law_of(0), one = law_of(1), other = combined(0.3);
    assert_exchanged(&two, &one);
    assert_not_exchanged(&one, &two);
    assert_not_exchanged(&two, &other);
    const struct wb_law growing = growing_parts(0.2), more = growing_parts(0.4);
    struct wb_law kinematic = growing_parts(0.2);
    kinematic.is_combined = false;
    assert_exchanged(&growing, &more);
    assert_exchanged(&growing, &kinematic);
    assert_not_exchanged(&kinematic, &growing);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vector_exponential_agrees_with_expm1),
        cmocka_unit_test(first_loading_follows_the_virgin_curve_for_any_step_size),
        cmocka_unit_test(virgin_curve_of_chaboche_agrees_with_the_closed_form),
        cmocka_unit_test(reversals_follow_the_rate_equations),
        cmocka_unit_test(tangents_agree_with_finite_differences),
        cmocka_unit_test(ludwik_is_isotropic_at_share_1_and_kinematic_at_share_0),
        cmocka_unit_test(part_with_growing_limit_shakes_down),
        cmocka_unit_test(moments_of_parts_with_growing_limits_add_up),
        cmocka_unit_test(parts_with_constant_limits_are_kinematic),
        cmocka_unit_test(ratchetting_agrees_with_the_closed_form),
        cmocka_unit_test(loops_close_and_dissipate_energy),
        cmocka_unit_test(vector_instructions_give_identical_bits),
        cmocka_unit_test(law_can_be_replaced_by_a_compatible_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
