/* Rows of a computed wire: what wb_wire_run_add() completes. */
#include "tests/check.h"

#include "fe/wire_run.h"

static struct wb_wire_model model;

static void make_model(int n_steps)
{
    memset(&model, 0, sizeof model);
    model.length = 0.1;
    model.n_steps = n_steps;
    for (int i = 0; i < n_steps; i++)
        model.step[i].rows = 2;
}

static void make_raise_and_release(void)
{
    make_model(4);
    for (int i = 0; i < 4; i++) {
        model.step[i].kind = i % 2 ? WB_WIRE_STEP_RELEASE : WB_WIRE_STEP_DEFLECTION;
        model.step[i].deflection = 0.05;
        model.step[i].unloads = i % 2;
    }
}

static void add(struct wb_wire_run *run, int step, double vertical, double angle, bool slack)
{
    const struct wb_wire_row row = {
        .step = step,
        .fraction = run->n_rows == 0 ? 0.0 : 0.5,
        .loads = {.follower = {0.0, 7.0, 0.0}},
        .vertical_force = vertical,
        .tension = 2.0 * vertical,
        .tangent = {cos(angle), sin(angle), 0.0},
        .iterations = 3,
    };
    const double shape[3][3] = {{0}, {1.0, 2.0, 3.0}, {0.1, vertical, 0.2}};
    wb_wire_run_add(run, &model, &row, slack, shape);
}

static void positions_are_equally_spaced_over_the_length(void **state)
{
    (void)state;
    struct wb_wire_run run;
    make_raise_and_release();
    assert_int_equal(wb_wire_run_planned_rows(&model), 9);
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
    assert_int_equal(run.capacity, 9 + WB_WIRE_RUN_SPARE);
    assert_int_equal(run.n_rows, 0);
    assert_true(run.converged && !run.stopped);
    assert_close(run.shape_s[0], 0.0, 0.0);
    assert_close(run.shape_s[1], 0.05, 1e-17);
    assert_close(run.shape_s[2], 0.1, 0.0);
    wb_wire_run_release(&run);
    wb_wire_run_release(&run);
}

static void impossible_numbers_of_positions_are_refused(void **state)
{
    (void)state;
    static const int refused[] = {-1, 1, 1001};
    struct wb_wire_run run;
    make_raise_and_release();
    wb_log_set_sink(discard_message, NULL);
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        assert_int_equal(wb_wire_run_init(&run, &model, refused[i]), WB_ERR_ARGUMENT);
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(wb_wire_run_init(&run, &model, 0), WB_OK);
    const struct wb_wire_row row = {0};
    wb_wire_run_add(&run, &model, &row, false, NULL);
    assert_int_equal(run.n_rows, 1);
    wb_wire_run_release(&run);
}

static void loading_after_unloading_is_a_new_cycle(void **state)
{
    (void)state;
    static const struct {
        int step;
        bool slack;
        int cycle;
        enum wb_history_phase phase;
    } rows[] = {
        {0, false, 1, WB_HISTORY_LOAD},   {0, false, 1, WB_HISTORY_LOAD},
        {0, false, 1, WB_HISTORY_LOAD},   {1, false, 1, WB_HISTORY_UNLOAD},
        {1, true, 1, WB_HISTORY_SLACK},   {2, true, 2, WB_HISTORY_SLACK},
        {2, false, 2, WB_HISTORY_LOAD},   {3, false, 2, WB_HISTORY_UNLOAD},
        {3, false, 2, WB_HISTORY_UNLOAD},
    };
    struct wb_wire_run run;
    make_raise_and_release();
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
    for (int i = 0; i < 9; i++) {
        add(&run, rows[i].step, 0.0, 0.0, rows[i].slack);
        assert_int_equal(run.n_rows, i + 1);
        assert_int_equal(run.rows[i].cycle, rows[i].cycle);
        assert_int_equal(run.rows[i].phase, rows[i].phase);
        assert_int_equal(run.rows[i].iterations, 3);
    }
    /* There is room for some more than planned, and then no more. */
    for (int i = 0; i <= WB_WIRE_RUN_SPARE; i++)
        add(&run, 3, 0.0, 0.0, false);
    assert_int_equal(run.n_rows, 9 + WB_WIRE_RUN_SPARE);
    wb_wire_run_release(&run);
}

static void force_of_a_deflection_is_zeroed_at_its_begin(void **state)
{
    (void)state;
    struct wb_wire_run run;
    make_raise_and_release();
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
    add(&run, 0, -0.25, 0.0, false);
    add(&run, 0, 1.0, 0.0, false);
    add(&run, 2, 3.0, 0.0, false);
    assert_close(run.zero_force, -0.25, 0.0);
    assert_close(run.rows[0].force, 0.0, 0.0);
    assert_close(run.rows[1].force, 1.25, 0.0);
    assert_close(run.rows[2].force, 3.25, 0.0);
    assert_close(run.rows[2].tension, 6.0, 0.0);
    assert_close(run.shape[3 * 2 + 2][1], 3.0, 0.0);
    assert_close(run.shape[3 * 1 + 1][2], 3.0, 0.0);
    wb_wire_run_release(&run);
}

static void force_of_loads_is_not_zeroed(void **state)
{
    (void)state;
    struct wb_wire_run run;
    make_model(2);
    model.step[0].loads.force[2] = 5.0;
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
    add(&run, 0, 0.5, 0.0, false);
    add(&run, 0, 1.0, 0.0, false);
    assert_close(run.zero_force, 0.0, 0.0);
    assert_close(run.rows[1].force, 1.0, 0.0);
    wb_wire_run_release(&run);
}

static void force_of_a_follower_is_the_follower(void **state)
{
    (void)state;
    struct wb_wire_run run;
    make_model(2);
    model.step[0].loads.follower[1] = 7.0;
    assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
    add(&run, 0, 5.5, 0.0, false);
    assert_close(run.rows[0].force, 7.0, 0.0);
    assert_close(run.rows[0].vertical_force, 5.5, 0.0);
    wb_wire_run_release(&run);
}

static void angle_goes_on_past_pi_in_both_senses(void **state)
{
    (void)state;
    for (int sense = -1; sense <= 1; sense += 2) {
        struct wb_wire_run run;
        make_model(16);
        assert_int_equal(wb_wire_run_init(&run, &model, 3), WB_OK);
        for (int i = 0; i < 16; i++) {
            add(&run, 0, 0.0, sense * 0.9 * i, false);
            assert_close(run.rows[i].tip_angle, sense * 0.9 * i, 1e-12);
        }
        /* And back again. */
        for (int i = 16; i < 33; i++) {
            add(&run, 0, 0.0, sense * 0.9 * (31 - i), false);
            assert_close(run.rows[i].tip_angle, sense * 0.9 * (31 - i), 1e-12);
        }
        wb_wire_run_release(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_are_equally_spaced_over_the_length),
        cmocka_unit_test(impossible_numbers_of_positions_are_refused),
        cmocka_unit_test(loading_after_unloading_is_a_new_cycle),
        cmocka_unit_test(force_of_a_deflection_is_zeroed_at_its_begin),
        cmocka_unit_test(force_of_loads_is_not_zeroed),
        cmocka_unit_test(force_of_a_follower_is_the_follower),
        cmocka_unit_test(angle_goes_on_past_pi_in_both_senses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
