/* Rows of a computed wire: the values that wb_wire_run_add() fills in. */
#include "tests/check.h"

#include "fe/trial/wire_run.h"
#include "fe/trial/wire_run_private.h"

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

static void invalid_numbers_of_positions_are_rejected(void **state)
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
        enum wb_phase phase;
    } rows[] = {
        {0, false, 1, WB_PHASE_LOAD},   {0, false, 1, WB_PHASE_LOAD},
        {0, false, 1, WB_PHASE_LOAD},   {1, false, 1, WB_PHASE_UNLOAD},
        {1, true, 1, WB_PHASE_SLACK},   {2, true, 2, WB_PHASE_SLACK},
        {2, false, 2, WB_PHASE_LOAD},   {3, false, 2, WB_PHASE_UNLOAD},
        {3, false, 2, WB_PHASE_UNLOAD},
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
    /* There is room for the spare rows, and no more. */
    for (int i = 0; i <= WB_WIRE_RUN_SPARE; i++)
        add(&run, 3, 0.0, 0.0, false);
    assert_int_equal(run.n_rows, 9 + WB_WIRE_RUN_SPARE);
    wb_wire_run_release(&run);
}

static void force_of_a_deflection_is_zeroed_at_its_start(void **state)
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

static void angle_continues_past_pi_in_both_directions(void **state)
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

static void a_target_lies_between_start_and_step(void **state)
{
    (void)state;
    const struct wb_wire_target start = {
        .tip = {.force = {1.0, 2.0, 3.0}, .moment = {0.0, 0.0, 4.0}, .follower = {0.0, 8.0, 0.0}},
        .tension = 6.0,
        .deflection = 0.01,
    };
    struct wb_wire_step step = {.kind = WB_WIRE_STEP_LOADS, .loads = {.force = {3.0, 0.0, 3.0}}};
    struct wb_wire_target to = wb_wire_run_target(&step, &start, 0.25);
    assert_close(to.tip.force[0], 1.5, 1e-15);
    assert_close(to.tip.force[1], 1.5, 1e-15);
    assert_close(to.tip.force[2], 3.0, 0.0);
    assert_close(to.tip.moment[2], 3.0, 1e-15);
    assert_close(to.tip.follower[1], 6.0, 1e-15);
    assert_close(to.tension, 6.0, 0.0);
    assert_false(to.is_held);

    step.kind = WB_WIRE_STEP_RELEASE;
    assert_close(wb_wire_run_target(&step, &start, 0.25).tension, 4.5, 1e-15);
    assert_close(wb_wire_run_target(&step, &start, 1.0).tension, 0.0, 0.0);

    step.kind = WB_WIRE_STEP_DEFLECTION;
    step.deflection = 0.05;
    to = wb_wire_run_target(&step, &start, 0.25);
    assert_true(to.is_held);
    assert_close(to.deflection, 0.02, 1e-16);
    /* The end is exactly the step's own value. */
    step.deflection = 0.1 + 0.2;
    assert_close(wb_wire_run_target(&step, &start, 1.0).deflection, 0.1 + 0.2, 0.0);
}

/* Arguments of the observer's last call. */
struct observed {
    int step, iterations, rows;
    double fraction, done;
    bool last;
};

static bool note_increment(void *context, const struct wb_wire_run *run, int step, double fraction,
                           int iterations, double done)
{
    struct observed *observed = context;
    (void)run;
    observed->step = step;
    observed->fraction = fraction;
    observed->iterations = iterations;
    observed->done = done;
    return fraction < 0.9;
}

static enum wb_status note_row(void *context, const struct wb_wire_run *run, bool last)
{
    struct observed *observed = context;
    observed->rows = run->n_rows;
    observed->last = last;
    return last ? WB_ERR_IO : WB_OK;
}

static void increments_are_counted_and_reported_as_fractions_of_the_step(void **state)
{
    (void)state;
    struct observed observed = {0};
    struct wb_wire_run run;
    const struct wb_wire_observer observer = {note_increment, note_row, &observed};
    make_model(2);
    assert_int_equal(wb_wire_run_init(&run, &model, 0), WB_OK);
    struct wb_wire_progress at = {.run = &run, .model = &model, .observer = &observer};

    /* Under its weight: no fraction of a step yet. */
    assert_true(wb_wire_run_end_increment(&at, (double[3]){1.0, 0.0, 0.0}, 1.0, 4));
    assert_close(observed.fraction, 0.0, 0.0);
    struct wb_wire_row row = {.fraction = 0.0, .tangent = {1.0, 0.0, 0.0}};
    wb_wire_run_end_row(&at, &row, false);
    assert_int_equal(run.rows[0].iterations, 4);

    at.step = 1;
    at.row = 2;
    assert_true(wb_wire_run_end_increment(&at, (double[3]){0.0, 1.0, 0.0}, 0.5, 3));
    assert_int_equal(observed.step, 1);
    assert_close(observed.fraction, 0.75, 1e-15);
    assert_close(observed.done, 1.5 / 5.0, 1e-15);
    assert_close(run.tip_angle, 0.5 * M_PI, 1e-15);
    assert_false(wb_wire_run_end_increment(&at, (double[3]){0.0, 1.0, 0.0}, 1.0, 2));
    assert_int_equal(run.increments, 3);

    row.fraction = 1.0;
    wb_wire_run_end_row(&at, &row, false);
    assert_int_equal(run.rows[1].step, 1);
    assert_int_equal(run.rows[1].increments, 2);
    assert_int_equal(run.rows[1].iterations, 5);
    assert_int_equal(at.increments + at.iterations, 0);
    assert_true(observed.last && observed.rows == 2);
    assert_int_equal(at.status, WB_ERR_IO);
    wb_wire_run_release(&run);
}

static void forces_are_the_tensions_or_the_loads(void **state)
{
    (void)state;
    /* Turned by 30 degrees about z. */
    const double c = cos(M_PI / 6.0), frame[3][3] = {{c, 0.5, 0.0}, {-0.5, c, 0.0}, {0, 0, 1.0}};
    struct wb_wire_row row = {
        .loads = {.force = {9.0, 1.0, 9.0}, .follower = {2.0, 10.0, 7.0}},
    };
    make_model(2);
    wb_wire_run_set_forces(&row, &model, 5.0, 4.0, frame);
    assert_close(row.tension, 1.0 + 2.0 * 0.5 + 10.0 * c, 1e-14);
    assert_close(row.vertical_force, row.tension, 0.0);
    make_raise_and_release();
    wb_wire_run_set_forces(&row, &model, 5.0, 4.0, frame);
    assert_close(row.tension, 5.0, 0.0);
    assert_close(row.vertical_force, 4.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_are_equally_spaced_over_the_length),
        cmocka_unit_test(invalid_numbers_of_positions_are_rejected),
        cmocka_unit_test(loading_after_unloading_is_a_new_cycle),
        cmocka_unit_test(force_of_a_deflection_is_zeroed_at_its_start),
        cmocka_unit_test(force_of_loads_is_not_zeroed),
        cmocka_unit_test(force_of_a_follower_is_the_follower),
        cmocka_unit_test(angle_continues_past_pi_in_both_directions),
        cmocka_unit_test(a_target_lies_between_start_and_step),
        cmocka_unit_test(increments_are_counted_and_reported_as_fractions_of_the_step),
        cmocka_unit_test(forces_are_the_tensions_or_the_loads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
