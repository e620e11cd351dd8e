/* A test held by its operator: motion of the stage, recorded events, and the ends of a hold. */
#include <math.h>

#include "base/timing.h"
#include "daq/test/bend_hold.h"
#include "tests/daq/bend_fixture.h"

static double held_at; /* mm of travel by which the stage is to be held */
static const char *held_in;

static bool is_on_its_way(const struct wb_bend_test_status *status)
{
    const double travel_mm = status->travel / WB_MM;
    return strcmp(status->phase, held_in) == 0 &&
           (strcmp(held_in, "up") == 0 ? travel_mm < held_at : travel_mm > held_at);
}

/* Runs the test to that place of that phase, and holds it there until the stage stands. */
static void hold_in(struct wb_bend_test *test, const char *phase, double at_mm)
{
    struct wb_bend_test_status status;
    held_in = phase;
    held_at = at_mm;
    assert_true(run(test, is_on_its_way));
    assert_true(wb_bend_test_hold(test));
    wb_bend_test_status(test, &status);
    assert_string_equal(status.phase, "held");
    assert_true(status.held >= 0.0 && status.hold_left > 0.0);
    assert_int_equal(status.end, WB_SEQUENCE_RUNNING);
}

static bool nothing_yet(const struct wb_bend_test_status *status)
{
    (void)status;
    return true;
}

/* Asks again and again, as an operator does who presses the key too early. */
static void resume(struct wb_bend_test *test)
{
    while (!wb_bend_test_resume(test))
        assert_true(run(test, nothing_yet));
}

static void step_for(struct wb_bend_test *test, double seconds)
{
    const int64_t until_ns = wb_time_now_ns() + wb_ns_from_seconds(seconds);
    while (wb_time_now_ns() < until_ns)
        assert_true(run(test, nothing_yet));
}

/* And that was reported, twice. */
static void wait_until_it_stands(struct wb_bend_test *test, struct fixture *fixture)
{
    while (strcmp(fixture->bench->state, "Idle") != 0)
        assert_true(run(test, nothing_yet));
    const int n_reports = fixture->log.n[WB_ROLE_STAGE];
    while (fixture->log.n[WB_ROLE_STAGE] < n_reports + 4)
        assert_true(run(test, nothing_yet));
}

static void hold_and_stand(struct wb_bend_test *test, struct fixture *fixture, const char *phase,
                           double at_mm)
{
    hold_in(test, phase, at_mm);
    wait_until_it_stands(test, fixture);
}

/* Of a wire so soft that the way stays below the force limit. */
static void open_test(struct fixture *fixture, struct wb_bend_test **test)
{
    fixture->bench->spring_mg_mm = 300;
    if (fixture->request.travel > 25.0 * WB_MM)
        fixture->request.travel = 25.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(test, &fixture->request), WB_OK);
}

/* --- going on --- */

static void held_stage_stops_and_then_resumes_its_move(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_test(fixture, &test);
    hold_and_stand(test, fixture, "down", 8.0);
    const double at = fixture->bench->position_mm;
    const int n_readings = fixture->log.n[WB_ROLE_LOAD];
    step_for(test, 0.3);
    assert_close(fixture->bench->position_mm, at, 1e-12);
    assert_true(fixture->log.n[WB_ROLE_LOAD] > n_readings + 10);
    assert_true(wb_bend_test_resume(test));
    hold_and_stand(test, fixture, "up", 18.0);
    assert_true(wb_bend_test_resume(test));
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_int_equal(result.holds, 2);
    assert_true(result.held > 0.3);
    assert_int_equal(fixture->bench->holds, 0);
    assert_close(fixture->bench->position_mm, 0.0, 1e-3);
    assert_close(result.peak_tension, 7.5e-3 * WB_STANDARD_GRAVITY, 0.2e-3 * WB_STANDARD_GRAVITY);
    static const char *const expected[] = {"cycle_start: 1",
                                           "hold_start: {\"cycle\": 1, \"phase\": \"down\"",
                                           "\"how\": \"resumed\"",
                                           "turn: 1",
                                           "hold_start: {\"cycle\": 1, \"phase\": \"up\"",
                                           "hold_end: {",
                                           "cycle_end: 1",
                                           "stop: done",
                                           "end:"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
    assert_null(strstr(fixture->events, "hold: {"));
    assert_string_equal(fixture->errors, "");
    assert_replay_identical(fixture->output, &fixture->log);
}

/* The wire relaxes: its force falls by far more than limits.force_drop_percent. */
static void force_that_falls_during_a_hold_is_not_a_break(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_test(fixture, &test);
    hold_and_stand(test, fixture, "down", 16.0);
    fixture->bench->force_mg = fixture->bench->force_mg - 1500;
    step_for(test, 0.2);
    assert_true(wb_bend_test_resume(test));
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
}

static void break_after_a_hold_stops_the_test_all_the_same(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->bench->breaks_mm = 18;
    open_test(fixture, &test);
    hold_in(test, "down", 8.0);
    resume(test);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_non_null(strstr(result.text, "the force fell"));
}

static bool rests(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "rest") == 0;
}

static void interrupted_rest_begins_again_after_a_hold(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.travel = 8.0 * WB_MM;
    fixture->request.cycles = 2;
    open_test(fixture, &test);
    assert_true(run(test, rests));
    assert_true(wb_bend_test_hold(test));
    resume(test);
    assert_true(run(test, rests));
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.cycles_done, 2);
    assert_int_equal(result.holds, 1);
}

static void time_left_does_not_change_during_a_hold(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_status before, after;
    open_test(fixture, &test);
    hold_and_stand(test, fixture, "up", 18.0);
    wb_bend_test_status(test, &before);
    step_for(test, 0.2);
    wb_bend_test_status(test, &after);
    assert_close(before.time_left, before.travel / WB_MM + 2.0, 1e-9);
    assert_close(after.time_left, before.time_left, 1e-9);
    assert_true(after.held >= before.held + 0.2 && after.hold_left < before.hold_left);
    assert_int_equal(wb_bend_test_close(test, NULL), WB_OK);
}

static void resting_stage_cannot_be_held_or_resumed(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    open_test(fixture, &test);
    assert_false(wb_bend_test_hold(test));
    assert_false(wb_bend_test_resume(test));
    hold_in(test, "down", 8.0);
    assert_false(wb_bend_test_hold(test));
    assert_false(wb_bend_test_resume(test)); /* it still brakes */
    resume(test);
    assert_false(wb_bend_test_resume(test));
    wb_bend_test_stop(test);
    assert_false(wb_bend_test_hold(test));
    assert_int_equal(wb_bend_test_close(test, NULL), WB_OK);
}

/* --- ending --- */

static void stop_during_a_hold_ends_in_order(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_test(fixture, &test);
    hold_and_stand(test, fixture, "down", 8.0);
    wb_bend_test_stop(test);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_true(result.standing && result.displaced && result.held > 0.0);
    assert_int_equal(fixture->bench->holds, 0); /* it stands, and is not to be freed of a hold */
    static const char *const expected[] = {"hold_start: {", "\"how\": \"stopped\"",
                                           "stop: interrupted: stopped by the operator", "end:"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
}

static void stop_while_it_brakes_for_a_hold_stops_the_stage(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_test(fixture, &test);
    hold_in(test, "down", 8.0);
    wb_bend_test_stop(test);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_true(result.standing);
    assert_int_equal(fixture->bench->holds, 1);
}

static void limits_are_checked_during_a_hold(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_test(fixture, &test);
    hold_and_stand(test, fixture, "down", 8.0);
    fixture->bench->force_mg = 100000;
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_true(result.standing);
}

static void stage_that_does_not_stop_after_hold_is_stopped(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    renew(fixture, 1.0);
    open_test(fixture, &test);
    hold_in(test, "down", 8.0);
    fixture->bench->stage_silent = true;
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_non_null(strstr(result.text, "stage sent no valid sample"));
    assert_true(fixture->bench->holds > 0);
}

static void nobody_holds_it_for_ever(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.hold_most = 0.7;
    open_test(fixture, &test);
    hold_in(test, "down", 8.0);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_non_null(strstr(result.text, "--hold-most-s"));
    assert_true(result.standing && result.displaced);
    assert_true(result.held >= 0.7);
    assert_int_equal(fixture->bench->holds, 0);
}

/* --- reading from a recording --- */

static void events_are_read_back(void **state)
{
    (void)state;
    struct wb_event event = {.t_ns = 7,
                             .kind = WB_BEND_HOLD_START,
                             .text = "{\"cycle\": 2, \"phase\": \"up\", \"travel_mm\": 20.5, "
                                     "\"tension_mN\": 41.5}"};
    struct wb_bend_hold_recorded hold;
    assert_int_equal(wb_bend_hold_read(&event, &hold), WB_OK);
    assert_true(hold.from_ns == 7 && hold.to_ns == INT64_MAX && isnan(hold.after));
    assert_int_equal(hold.cycle, 2);
    assert_string_equal(hold.phase, "up");
    assert_close(hold.travel, 20.5 * WB_MM, 1e-12);
    assert_close(hold.before, 41.5 * WB_MN, 1e-12);
    struct wb_event end = {.t_ns = 9,
                           .kind = WB_BEND_HOLD_END,
                           .text = "{\"lasted_s\": 3, \"tension_mN\": 40, \"how\": \"resumed\"}"};
    assert_int_equal(wb_bend_hold_read(&end, &hold), WB_OK);
    assert_true(hold.to_ns == 9);
    assert_close(hold.after, 40.0 * WB_MN, 1e-12);
    static const char *const bad[] = {"",
                                      "{",
                                      "{}",
                                      "[1]",
                                      "{\"cycle\": 0, \"phase\": \"up\"}",
                                      "{\"cycle\": 1}",
                                      "{\"cycle\": 1, \"phase\": 3}"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(event.text, sizeof event.text, "%s", bad[i]);
        assert_int_equal(wb_bend_hold_read(&event, &hold), WB_ERR_DATA);
    }
}

int main(void)
{
#define ON_A_BENCH(fact) cmocka_unit_test_setup_teardown(fact, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        ON_A_BENCH(held_stage_stops_and_then_resumes_its_move),
        ON_A_BENCH(force_that_falls_during_a_hold_is_not_a_break),
        ON_A_BENCH(break_after_a_hold_stops_the_test_all_the_same),
        ON_A_BENCH(interrupted_rest_begins_again_after_a_hold),
        ON_A_BENCH(time_left_does_not_change_during_a_hold),
        ON_A_BENCH(resting_stage_cannot_be_held_or_resumed),
        ON_A_BENCH(stop_during_a_hold_ends_in_order),
        ON_A_BENCH(stop_while_it_brakes_for_a_hold_stops_the_stage),
        ON_A_BENCH(limits_are_checked_during_a_hold),
        ON_A_BENCH(stage_that_does_not_stop_after_hold_is_stopped),
        ON_A_BENCH(nobody_holds_it_for_ever),
        cmocka_unit_test(events_are_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
