/* Fibres against their slow twin: one section on random strains, and a whole cantilever. */
#include <stdlib.h>

#include "fe/rod/fibres_private.h"
#include "tests/fe/rod/fibre_point.h"
#include "tests/fe/rod/wires.h"
#include "tests/twin/fibres_swap.h"

/* One section point with its history, in the fast way and in the slow one. */
struct point {
    const struct wb_section *section;
    struct fibre_point fast;
    struct wb_material_state *slow_before, *slow_after;
};

static struct point make_point(const struct wb_section *section)
{
    struct point p = {.section = section, .fast = fibre_point_make(section)};
    const size_t n = (size_t)section->n_fibres;
    p.slow_before = calloc(n, sizeof *p.slow_before);
    p.slow_after = calloc(n, sizeof *p.slow_after);
    assert_true(p.slow_before && p.slow_after);
    return p;
}

static void release_point(struct point *p)
{
    fibre_point_release(&p->fast);
    free(p->slow_before);
    free(p->slow_after);
}

static struct wb_fibres_response respond_slowly(struct point *p, double eps, double kappa)
{
    struct wb_fibres_response r;
    wb_fibres_twin_respond(p->section, eps, kappa, p->slow_before, p->slow_after, &r);
    return r;
}

static void accept(struct point *p)
{
    fibre_point_accept(&p->fast);
    struct wb_material_state *slow_old = p->slow_before;
    p->slow_before = p->slow_after;
    p->slow_after = slow_old;
}

static double largest_plastic_strain(const struct point *p)
{
    double largest = 0.0;
    for (int i = 0; i < p->section->n_fibres; i++)
        largest = fmax(largest, p->slow_before[i].accumulated_plastic_strain);
    return largest;
}

static void fast_fibres_agree_with_their_slow_twin(void **unused)
{
    (void)unused;
    uint64_t random = 42;
    for (int trial = 0; trial < 40; trial++) {
        struct test_wire wire = test_wire_type(1 + trial % 3);
        wire.material.strength_coefficient = 1e6 * pow(10.0, 5.0 * test_random(&random));
        wire.material.hardening_exponent = 0.05 + 1.45 * test_random(&random);
        struct wb_section s = trial % 4 == 3 ? test_composite_section() : test_section(&wire);
        struct point p = make_point(&s);
        const double scale = wb_fibres_axial_stiffness(p.fast.fibres) * 1e-3;

        for (int step = 0; step < 60; step++) {
            const double eps = 2e-3 * (test_random(&random) - 0.5);
            const double kappa = 80.0 * (test_random(&random) - 0.5);
            const struct wb_fibres_response a = fibre_point_respond(&p.fast, eps, kappa);
            const struct wb_fibres_response b = respond_slowly(&p, eps, kappa);
            assert_close(a.N, b.N, 1e-11 * scale);
            assert_close(a.M, b.M, 1e-11 * scale * 1e-3);
            assert_close(a.D11, b.D11, 1e-6 * scale);
            assert_close(a.D12, b.D12, 1e-6 * scale * 1e-3);
            assert_close(a.D22, b.D22, 1e-6 * scale * 1e-6);
            if (step % 3 == 0)
                accept(&p);
        }
        assert_close(wb_fibres_largest_plastic_strain(p.fast.fibres, p.fast.before),
                     largest_plastic_strain(&p), 1e-12);
        release_point(&p);
        wb_section_release(&s);
    }
}

static void virgin_shortcut_is_seamless(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct wb_section s = test_section(&wire);
    struct point p = make_point(&s);
    const double outermost = s.fibres[0].y;
    const double limit = wire.material.yield_stress / wire.material.youngs_modulus / outermost;
    for (int i = -3; i <= 3; i++) {
        const double kappa = limit * (1.0 + 1e-6 * i);
        assert_close_relative(fibre_point_respond(&p.fast, 0.0, kappa).M,
                              respond_slowly(&p, 0.0, kappa).M, 1e-13);
    }
    release_point(&p);
    wb_section_release(&s);
}

static void slow_fibres_give_the_same_curve(void **unused)
{
    (void)unused;
    enum {
        ROWS = 41
    };
    const struct test_wire wire = test_wire_type(3);
    struct wb_section section = test_section(&wire);
    struct wb_cantilever_model model;
    double tension[2][ROWS];
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = 0.085;
    for (int slow = 0; slow < 2; slow++) {
        slow_section = slow ? &section : NULL;
        struct wb_cantilever *const cantilever = test_cantilever(&model);
        for (int i = 0; i < ROWS; i++) {
            const double y = (i <= 20 ? i : 40 - i) * 2.5e-3;
            tension[slow][i] = test_move(cantilever, WB_CONTROL_DEFLECTION, y).tension;
        }
        wb_cantilever_destroy(cantilever);
    }
    slow_section = NULL;
    bool same = true;
    for (int i = 0; i < ROWS; i++) {
        assert_close(tension[0][i], tension[1][i], 1e-8);
        same = same && tension[0][i] == tension[1][i];
    }
    /* The sums are in another order: equal to the last bit it would not have been the twin. */
    assert_false(same);
    wb_section_release(&section);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_fibres_agree_with_their_slow_twin),
        cmocka_unit_test(virgin_shortcut_is_seamless),
        cmocka_unit_test(slow_fibres_give_the_same_curve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
