#include "fixtures/virtual/live_wire.h"

#include "fe/trial/cantilever.h"
#include "fixtures/virtual/composite.h"
#include "tests/virtual/setup.h"

static struct wb_live_wire *make(const struct setup *setup,
                                 const struct wb_live_wire_settings *settings)
{
    struct wb_live_wire *wire;
    const struct wb_live_wire_parts parts = {&setup->truth, &setup->composite, &setup->wire,
                                             &setup->rig, &setup->specimen};
    assert_int_equal(wb_live_wire_create(&wire, &parts, settings), WB_OK);
    return wire;
}

static double tension_at(struct wb_live_wire *wire, double travel_mm)
{
    struct wb_live_wire_view view;
    wb_live_wire_move(wire, travel_mm * WB_MM, &view);
    assert_int_equal(wb_live_wire_failures(wire), 0);
    return view.tension;
}

static void the_start_is_unloaded_on_the_rest(void **state)
{
    (void)state;
    static const char *const specimens[] = {"type1-L85-1",  "type1-L100-1", "type2-L85-1",
                                            "type2-L100-1", "type3-L85-1",  "type3-L100-1"};
    for (size_t i = 0; i < sizeof specimens / sizeof specimens[0]; i++)
        for (uint64_t seed = 1; seed <= 8; seed++) {
            struct setup setup;
            struct wb_live_wire_view view;
            setup_bench(&setup, specimens[i], seed);
            struct wb_live_wire *const wire = make(&setup, NULL);
            for (double mm = 0.0; mm < 0.95; mm += 0.05) {
                wb_live_wire_move(wire, mm * WB_MM, &view);
                assert_close(view.tension, 0.0, 0.0);
                assert_close(view.deflection, -0.5 * WB_MM, 1e-9);
            }
            wb_live_wire_destroy(wire);
        }
}

static void the_tip_rises_by_the_travel_once_the_strand_is_taut(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_live_wire_view view;
    setup_bench(&setup, "type1-L85-1", 2);
    struct wb_live_wire *const wire = make(&setup, NULL);
    const double S = setup.rig.strand.length, L = setup.specimen.length;
    for (int mm = 2; mm <= 53; mm++) {
        wb_live_wire_move(wire, mm * WB_MM, &view);
        const double x = view.x[view.n_markers - 1];
        const double lean = S - sqrt(S * S - (L - x) * (L - x));
        assert_true(view.tension > 0.0);
        /* Taut at zero deflection after 1 mm of slack and 0.5 mm of the rest. */
        assert_close(view.deflection, (mm - 1.5) * WB_MM + lean, 2e-6);
        assert_close(view.y[view.n_markers - 1], view.deflection, 1e-12);
        assert_close(view.x[0], 0.0, 1e-12);
        assert_close(view.y[0], 0.0, 1e-12);
    }
    wb_live_wire_destroy(wire);
}

static void interpolation_equals_a_finer_grid(void **state)
{
    (void)state;
    static const double turns[] = {53.0, 0.0, 50.0};
    struct setup setup;
    setup_bench(&setup, "type3-L85-2", 3);
    const struct wb_live_wire_settings fine = {.grid = 0.01 * WB_MM};
    struct wb_live_wire *const coarse = make(&setup, NULL);
    struct wb_live_wire *const direct = make(&setup, &fine);
    double at = 0.0, worst = 0.0;
    for (int leg = 0; leg < 3; leg++) {
        const double step = turns[leg] > at ? 0.37 : -0.37;
        for (; (turns[leg] - at) * step > 0.0; at += step)
            worst = fmax(worst, fabs(tension_at(coarse, at) - tension_at(direct, at)));
        /* Reversals lie on both grids, like the ends of a test's strokes. */
        at = turns[leg];
        worst = fmax(worst, fabs(tension_at(coarse, at) - tension_at(direct, at)));
    }
    /* Half of a reading's noise, on 190 mN. */
    assert_true(worst < 0.05 * WB_MN);
    assert_true(worst > 0.0);
    wb_live_wire_destroy(coarse);
    wb_live_wire_destroy(direct);
}

static void coarse_mesh_and_strips_are_fine_enough(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L85-2", 3);
    const struct wb_live_wire_settings fine = {.n_elements = 60, .n_strips = 60};
    struct wb_live_wire *const coarse = make(&setup, NULL);
    struct wb_live_wire *const good = make(&setup, &fine);
    double worst = 0.0;
    for (double mm = 0.0; mm <= 53.0; mm += 0.5)
        worst = fmax(worst, fabs(tension_at(coarse, mm) - tension_at(good, mm)));
    assert_true(worst < 0.3 * WB_MN);
    wb_live_wire_destroy(coarse);
    wb_live_wire_destroy(good);
}

static void results_depend_on_the_path_and_not_on_the_calls(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_live_wire_view a, b;
    setup_bench(&setup, "type2-L85-1", 4);
    struct wb_live_wire *const often = make(&setup, NULL);
    struct wb_live_wire *const rarely = make(&setup, NULL);
    for (double mm = 0.0; mm < 40.0; mm += 0.0137)
        wb_live_wire_move(often, mm * WB_MM, &a);
    wb_live_wire_move(often, 40.03 * WB_MM, &a);
    for (double mm = 40.0; mm > 22.0; mm -= 0.0071)
        wb_live_wire_move(often, mm * WB_MM, &a);
    wb_live_wire_move(often, 22.0 * WB_MM, &a);
    wb_live_wire_move(rarely, 40.03 * WB_MM, &b);
    wb_live_wire_move(rarely, 22.0 * WB_MM, &b);
    /* The solver's tolerance is 1e-8 of the largest internal force. */
    assert_close(a.tension, b.tension, 1e-8);
    for (int i = 0; i < a.n_markers; i++) {
        assert_close(a.x[i], b.x[i], 1e-8);
        assert_close(a.y[i], b.y[i], 1e-8);
    }
    wb_live_wire_destroy(often);
    wb_live_wire_destroy(rarely);
}

/* Evaluating ahead into an interval and reversing has no effect. */
static void evaluating_ahead_is_reverted(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type2-L85-1", 4);
    struct wb_live_wire *const straight = make(&setup, NULL);
    struct wb_live_wire *const nosy = make(&setup, NULL);
    const double before = tension_at(straight, 40.0);
    assert_close(tension_at(nosy, 40.0), before, 0.0);
    assert_true(tension_at(nosy, 40.09) > before);
    assert_close(tension_at(nosy, 40.0), before, 0.0);
    for (int mm = 39; mm >= 20; mm--)
        assert_close(tension_at(nosy, mm), tension_at(straight, mm), 1e-8);
    wb_live_wire_destroy(straight);
    wb_live_wire_destroy(nosy);
}

static void the_same_seed_gives_the_same_wire_to_the_bit(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L100-3", 9);
    struct wb_live_wire *const one = make(&setup, NULL), *const two = make(&setup, NULL);
    for (double mm = 0.0; mm <= 53.0; mm += 0.9) {
        struct wb_live_wire_view a, b;
        memset(&a, 0, sizeof a);
        memset(&b, 0, sizeof b);
        wb_live_wire_move(one, mm * WB_MM, &a);
        wb_live_wire_move(two, mm * WB_MM, &b);
        assert_memory_equal(&a, &b, sizeof a);
    }
    wb_live_wire_destroy(one);
    wb_live_wire_destroy(two);
}

static void unloading_has_another_path_and_ends_without_load(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L85-1", 5);
    struct wb_live_wire *const wire = make(&setup, NULL);
    const double up_20 = tension_at(wire, 20.0), top = tension_at(wire, 53.0);
    const double down_20 = tension_at(wire, 20.0);
    assert_true(down_20 < up_20 - 0.1 * top);
    assert_close(tension_at(wire, 0.9), 0.0, 0.0);
    assert_close(tension_at(wire, 0.0), 0.0, 0.0);
    /* The second cycle starts from a bent wire: less force at first, about the same at the end. */
    assert_true(tension_at(wire, 10.0) < up_20);
    assert_close_relative(tension_at(wire, 53.0), top, 0.06);
    wb_live_wire_destroy(wire);
}

static double force_rms(struct setup *setup, double *peak)
{
    /* Straight, without scatter, no rest: compared with the paper's homogenised properties. */
    const struct wb_live_wire_settings plain = {.straight = true, .no_rest = true};
    setup->truth.stiffness_factor = setup->truth.yield_factor = 1.0;
    struct wb_live_wire *const wire = make(setup, &plain);
    struct wb_section section;
    struct wb_cantilever *paper;
    struct wb_cantilever_model model;
    struct wb_cantilever_point point;
    assert_int_equal(
        wb_section_init_circle(&section, setup->wire.outer_diameter, &setup->wire.material, 40),
        WB_OK);
    wb_cantilever_default_model(&model);
    model.section = &section;
    model.length = setup->specimen.length;
    model.strand_length = setup->rig.strand.length;
    model.counterweight = setup->rig.strand.counterweight;
    model.mass_per_length = wb_wire_mass_per_length(&setup->wire);
    assert_int_equal(wb_cantilever_create(&paper, &model, NULL), WB_OK);
    double sum = 0.0, zero = 0.0, paper_zero = 0.0;
    const int n = 104;
    for (int i = 0; i <= n; i++) {
        const double travel = 52.0 * WB_MM * i / n;
        struct wb_live_wire_view view;
        wb_live_wire_move(wire, travel, &view);
        assert_int_equal(wb_cantilever_move(paper, WB_CONTROL_STAGE, travel, &point), WB_OK);
        assert_int_equal(point.end, WB_CANTILEVER_CONVERGED);
        if (i == 0) {
            zero = view.tension;
            paper_zero = point.tension;
        }
        const double difference = view.tension - zero - (point.tension - paper_zero);
        sum += difference * difference;
    }
    *peak = point.tension - paper_zero;
    wb_cantilever_destroy(paper);
    wb_section_release(&section);
    wb_live_wire_destroy(wire);
    return sqrt(sum / (n + 1));
}

static void the_wires_resemble_the_paper_but_not_exactly(void **state)
{
    (void)state;
    static const char *const specimens[] = {"type1-L85-1", "type2-L85-1", "type3-L85-1"};
    for (int i = 0; i < 3; i++) {
        struct setup setup;
        double peak;
        setup_bench(&setup, specimens[i], 1);
        const double rms = force_rms(&setup, &peak);
        print_message("%s: RMS %.2f %% of F_max = %.1f mN\n", specimens[i], rms / peak / WB_PERCENT,
                      peak / WB_MN);
        assert_true(rms < 0.005 * peak);
        assert_true(rms > 0.0015 * peak);
    }
}

/* The same laws with isotropic hardening agree in loading and differ in unloading. */
static void kinematic_hardening_affects_unloading_only(void **state)
{
    (void)state;
    struct setup setup;
    setup_bench(&setup, "type1-L85-1", 1);
    double loads[2][2];
    for (int isotropic = 0; isotropic < 2; isotropic++) {
        struct wb_section section;
        struct wb_cantilever *cantilever;
        struct wb_cantilever_model model;
        struct wb_cantilever_point point;
        assert_int_equal(wb_composite_build_variant(&setup.composite, WB_COMPOSITE_KINEMATIC,
                                                    &setup.wire, 1.0, 1.0, 12, NULL, &section),
                         WB_OK);
        for (int i = 0; isotropic && i < section.n_materials; i++)
            if (section.materials[i].hardening == WB_HARDENING_KINEMATIC_LINEAR) {
                section.materials[i].hardening = WB_HARDENING_ISOTROPIC_POWER;
                section.materials[i].hardening_exponent = 1.0;
            }
        wb_cantilever_default_model(&model);
        model.section = &section;
        model.length = setup.specimen.length;
        model.n_elements = 24;
        assert_int_equal(wb_cantilever_create(&cantilever, &model, NULL), WB_OK);
        for (int i = 1; i <= 100; i++)
            assert_int_equal(
                wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 0.5 * i * WB_MM, &point),
                WB_OK);
        loads[isotropic][0] = point.tension;
        for (int i = 99; i >= 30; i--)
            assert_int_equal(
                wb_cantilever_move(cantilever, WB_CONTROL_DEFLECTION, 0.5 * i * WB_MM, &point),
                WB_OK);
        loads[isotropic][1] = point.tension;
        wb_cantilever_destroy(cantilever);
        wb_section_release(&section);
    }
    assert_close_relative(loads[0][0], loads[1][0], 1e-6);
    /* It yields earlier during unloading, so more force remains. */
    assert_true(loads[0][1] - loads[1][1] > 0.02 * loads[0][0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_start_is_unloaded_on_the_rest),
        cmocka_unit_test(the_tip_rises_by_the_travel_once_the_strand_is_taut),
        cmocka_unit_test(interpolation_equals_a_finer_grid),
        cmocka_unit_test(coarse_mesh_and_strips_are_fine_enough),
        cmocka_unit_test(results_depend_on_the_path_and_not_on_the_calls),
        cmocka_unit_test(evaluating_ahead_is_reverted),
        cmocka_unit_test(the_same_seed_gives_the_same_wire_to_the_bit),
        cmocka_unit_test(unloading_has_another_path_and_ends_without_load),
        cmocka_unit_test(the_wires_resemble_the_paper_but_not_exactly),
        cmocka_unit_test(kinematic_hardening_affects_unloading_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
