#include "fe/trial/loading_steps.h"

#include <stdlib.h>

#include "tests/fe/rod/wires.h"

struct rig {
    struct wb_section section;
    struct wb_cantilever *cantilever;
};

static struct rig bench_rig(const struct test_wire *wire, double counterweight)
{
    struct rig rig = {.section = test_section(wire)};
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = 0.085;
    model.strand_length = 0.76;
    model.mass_per_length = test_wire_mass(wire);
    model.counterweight = counterweight;
    rig.cantilever = test_cantilever(&model);
    return rig;
}

static void release_rig(struct rig *rig)
{
    wb_cantilever_destroy(rig->cantilever);
    wb_section_release(&rig->section);
}

static void one_loading_has_a_row_at_zero_and_one_per_step(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct rig rig = bench_rig(&wire, 0.0027);
    const double s[] = {0.0, 0.0425, 0.085};
    const struct wb_loading_steps_plan plan = {
        .maximum = 0.053, .steps = 53, .n_shape = 3, .shape_s = s};
    struct wb_loading_steps h;
    assert_int_equal(wb_loading_steps_init(&h, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&h, &plan, rig.cantilever), WB_OK);
    assert_true(h.converged && !h.stopped);
    assert_int_equal(h.n_rows, 54);
    assert_true(h.rows[0].force == 0.0);
    assert_true(h.zero_force > 0.0027 * WB_STANDARD_GRAVITY);
    for (int i = 0; i < 54; i++) {
        const struct wb_loading_steps_row *row = &h.rows[i];
        assert_int_equal(row->cycle, 1);
        assert_int_equal(row->phase, WB_PHASE_LOAD);
        assert_close(row->point.deflection, i * WB_MM, 1e-9);
        assert_close(row->force, row->point.vertical_force - h.zero_force, 1e-15);
        /* Shapes belong to their rows. */
        assert_close(h.shape_x[3 * i + 2], row->point.tip_x, 1e-12);
        assert_close(h.shape_y[3 * i + 2], row->point.deflection, 1e-12);
        assert_true(h.shape_x[3 * i] == 0.0 && h.shape_y[3 * i] == 0.0);
    }
    assert_true(h.rows[53].point.control == 0.053);
    wb_loading_steps_release(&h);
    release_rig(&rig);
}

static void cycles_load_and_unload_and_go_slack(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(2);
    struct rig rig = bench_rig(&wire, 0.0);
    const struct wb_loading_steps_plan plan = {.maximum = 0.053, .steps = 20, .cycles = 3};
    struct wb_loading_steps h;
    assert_int_equal(wb_loading_steps_init(&h, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&h, &plan, rig.cantilever), WB_OK);
    assert_int_equal(h.n_rows, 1 + 3 * 40);
    assert_int_equal(h.n_rows, wb_loading_steps_planned_rows(&plan));
    for (int i = 1; i < h.n_rows; i++) {
        const struct wb_loading_steps_row *row = &h.rows[i];
        const int within = (i - 1) % 40;
        assert_int_equal(row->cycle, 1 + (i - 1) / 40);
        if (row->point.slack)
            assert_int_equal(row->phase, WB_PHASE_SLACK);
        else
            assert_int_equal(row->phase, within < 20 ? WB_PHASE_LOAD : WB_PHASE_UNLOAD);
        const int step = within < 20 ? within + 1 : 39 - within;
        assert_close(row->point.control, 0.053 * step / 20.0, 1e-15);
    }
    assert_int_equal(h.rows[40].phase, WB_PHASE_SLACK);
    assert_int_equal(h.rows[41].phase, WB_PHASE_SLACK);
    assert_string_equal(wb_trial_phase_name(h.rows[40].phase), "slack");
    /* A slack strand's vertical force is zero, so its zeroed force is negative. */
    assert_close(h.rows[40].force, -h.zero_force, 1e-15);
    wb_loading_steps_release(&h);
    release_rig(&rig);
}

static void run_can_be_repeated_after_a_reset(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(3);
    struct rig rig = bench_rig(&wire, 0.0027);
    const struct wb_loading_steps_plan plan = {.maximum = 0.053, .steps = 10, .cycles = 1};
    struct wb_loading_steps one, two;
    assert_int_equal(wb_loading_steps_init(&one, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_init(&two, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&one, &plan, rig.cantilever), WB_OK);
    wb_cantilever_reset(rig.cantilever);
    assert_int_equal(wb_loading_steps_run(&two, &plan, rig.cantilever), WB_OK);
    assert_int_equal(one.n_rows, two.n_rows);
    for (int i = 0; i < one.n_rows; i++)
        assert_true(one.rows[i].force == two.rows[i].force);
    wb_loading_steps_release(&one);
    wb_loading_steps_release(&two);
    release_rig(&rig);
}

static void curve_ends_where_there_is_no_equilibrium(void **unused)
{
    (void)unused;
    struct test_wire wire = test_wire_type(1);
    wire.material.strength_coefficient = 0.0;
    struct rig rig = {.section = test_section(&wire)};
    struct wb_cantilever_model model;
    wb_cantilever_default_model(&model);
    model.section = &rig.section;
    model.length = 0.085;
    rig.cantilever = test_cantilever(&model);
    const double R = 0.5 * wire.diameter;
    const double plastic = 4.0 / 3.0 * wire.material.yield_stress * R * R * R;
    const struct wb_loading_steps_plan plan = {
        .control = WB_CONTROL_TIP_MOMENT, .maximum = 1.5 * plastic, .steps = 15, .cycles = 1};
    struct wb_loading_steps h;
    assert_int_equal(wb_loading_steps_init(&h, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&h, &plan, rig.cantilever), WB_OK);
    assert_false(h.converged);
    assert_in_range(h.n_rows, 10, 11);
    assert_int_equal(h.end.end, WB_CANTILEVER_NOT_CONVERGED);
    for (int i = 0; i < h.n_rows; i++)
        assert_int_equal(h.rows[i].point.end, WB_CANTILEVER_CONVERGED);
    wb_loading_steps_release(&h);
    release_rig(&rig);
}

static bool stop_after_five(void *context)
{
    return ++*(int *)context > 5;
}

static void stop_ends_the_test(void **unused)
{
    (void)unused;
    const struct test_wire wire = test_wire_type(1);
    struct rig rig = bench_rig(&wire, 0.0);
    int asked = 0;
    const struct wb_loading_steps_plan plan = {
        .maximum = 0.01, .steps = 10, .stop = stop_after_five, .stop_context = &asked};
    struct wb_loading_steps h;
    assert_int_equal(wb_loading_steps_init(&h, &plan), WB_OK);
    assert_int_equal(wb_loading_steps_run(&h, &plan, rig.cantilever), WB_OK);
    assert_true(h.stopped && h.converged);
    assert_int_equal(h.n_rows, 5);
    wb_loading_steps_release(&h);
    release_rig(&rig);
}

static int messages;

static void count_message(void *context, enum wb_log_level level, const char *domain,
                          const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
    messages++;
}

static void invalid_plans_are_rejected(void **unused)
{
    (void)unused;
    const struct wb_loading_steps_plan plans[] = {
        {.maximum = 0.0, .steps = 1},
        {.maximum = (double)NAN, .steps = 1},
        {.maximum = 0.01, .steps = 0},
        {.maximum = 0.01, .steps = 1, .cycles = -1},
        {.maximum = 0.01, .steps = 1000000, .cycles = 100000},
        {.maximum = 0.01, .steps = 1, .n_shape = -1},
    };
    wb_log_set_sink(count_message, NULL);
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++) {
        struct wb_loading_steps h;
        assert_int_equal(wb_loading_steps_init(&h, &plans[i]), WB_ERR_ARGUMENT);
        assert_int_equal(messages, (int)i + 1);
        wb_loading_steps_release(&h);
    }
    wb_log_set_sink(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_loading_has_a_row_at_zero_and_one_per_step),
        cmocka_unit_test(cycles_load_and_unload_and_go_slack),
        cmocka_unit_test(run_can_be_repeated_after_a_reset),
        cmocka_unit_test(curve_ends_where_there_is_no_equilibrium),
        cmocka_unit_test(stop_ends_the_test),
        cmocka_unit_test(invalid_plans_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
