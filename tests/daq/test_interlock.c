/* Decisions of the interlock, and the stop sequence, without ports and clocks. */
#include "base/units.h"
#include "daq/acquire/interlock.h"
#include "tests/check.h"

#define S WB_NS_PER_S
#define MS WB_NS_PER_MS

static struct wb_interlock armed(void)
{
    struct wb_interlock interlock;
    const struct wb_interlock_settings settings = {
        .force = 0.1,
        .overload = 0.2,
        .travel = 0.05,
        .rise = 0.001,
        .down = 1,
        .stream_lost_ns = {S, S, 2 * S},
    };
    wb_interlock_init(&interlock, &settings, 10 * S);
    interlock.armed = true;
    interlock.start_position = 0.3;
    return interlock;
}

static struct wb_load_sample reading(double force, int64_t t_ns)
{
    return (struct wb_load_sample){.t_ns = t_ns, .force = force, .valid = true};
}

static void force_beyond_the_limit_trips_once(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_load_sample sample = reading(0.1, 11 * S);
    assert_false(wb_interlock_load(&interlock, &sample));
    sample = reading(0.1001, 12 * S);
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_FORCE);
    assert_int_equal(interlock.t_ns, 12 * S);
    sample = reading(0.5, 13 * S);
    assert_false(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_FORCE);
    assert_int_equal(interlock.t_ns, 12 * S);
}

static void force_limit_applies_to_the_tared_reading_of_either_sign(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    interlock.tare = 0.05;
    struct wb_load_sample sample = reading(0.149, 11 * S);
    assert_false(wb_interlock_load(&interlock, &sample));
    sample = reading(-0.051, 11 * S);
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_FORCE);
}

static void overload_limit_applies_to_the_reading_including_tare(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    interlock.settings.force = 0.0;
    interlock.tare = 0.15;
    struct wb_load_sample sample = reading(0.2001, 11 * S);
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_OVERLOAD);
}

static void overload_reported_by_the_cell_trips_without_a_force_value(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    const struct wb_load_sample sample = {.t_ns = 11 * S, .force = (double)NAN, .overload = true};
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_OVERLOAD);
    interlock = armed();
    interlock.settings.overload_allowed = true;
    assert_false(wb_interlock_load(&interlock, &sample));
}

static void reading_that_is_not_a_number_trips(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    const struct wb_load_sample sample = reading((double)NAN, 11 * S);
    assert_true(wb_interlock_load(&interlock, &sample));
}

static void unit_change_trips(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_load_sample sample = reading(0.01, 11 * S);
    sample.unit_changed = true;
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_UNIT);
}

static void contradicting_unit_trips_except_during_release(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_load_sample sample = reading(0.01, 11 * S);
    sample.unit_contradicts = true;
    interlock.settings.overload_allowed = true;
    assert_false(wb_interlock_load(&interlock, &sample));
    interlock.settings.overload_allowed = false;
    assert_true(wb_interlock_load(&interlock, &sample));
    assert_int_equal(interlock.reason, WB_INTERLOCK_UNIT);
}

static void travel_is_measured_downwards_from_the_start(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_stage_report report = {.t_ns = 11 * S, .state = WB_STAGE_JOG, .position = 0.3499};
    assert_false(wb_interlock_stage(&interlock, &report));
    report.position = 0.3501;
    assert_true(wb_interlock_stage(&interlock, &report));
    assert_int_equal(interlock.reason, WB_INTERLOCK_TRAVEL);

    interlock = armed();
    interlock.settings.down = -1;
    report.position = 0.2499;
    assert_true(wb_interlock_stage(&interlock, &report));
    interlock = armed();
    interlock.settings.down = -1;
    report.position = 0.3011;
    assert_true(wb_interlock_stage(&interlock, &report)); /* too far above the start */
    interlock = armed();
    report.position = (double)NAN;
    assert_false(wb_interlock_stage(&interlock, &report));
}

static void alarm_and_unrequested_hold_trip(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_stage_report report = {
        .t_ns = 11 * S, .state = WB_STAGE_ALARM, .position = 0.3, .alarm = 1};
    assert_true(wb_interlock_stage(&interlock, &report));
    assert_int_equal(interlock.reason, WB_INTERLOCK_ALARM);
    assert_non_null(strstr(interlock.text, "ALARM:1"));
    interlock = armed();
    report.state = WB_STAGE_HOLD;
    assert_true(wb_interlock_stage(&interlock, &report));
    assert_int_equal(interlock.reason, WB_INTERLOCK_STAGE);
}

static void silence_trips_at_its_limit_and_not_before(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    struct wb_load_sample sample = reading(0.0, 12 * S);
    struct wb_stage_report report = {.t_ns = 12 * S, .state = WB_STAGE_JOG, .position = 0.3};
    (void)wb_interlock_load(&interlock, &sample);
    (void)wb_interlock_stage(&interlock, &report);
    (void)wb_interlock_mocap(&interlock, 12 * S + 100 * MS);
    assert_int_equal(wb_interlock_deadline(&interlock), 13 * S);
    assert_false(wb_interlock_tick(&interlock, 13 * S - 1));
    assert_true(wb_interlock_tick(&interlock, 13 * S + 3 * MS));
    assert_int_equal(interlock.reason, WB_INTERLOCK_STREAM_LOST);
    assert_int_equal(interlock.t_ns, 13 * S);
    assert_true(interlock.lost[WB_ROLE_LOAD]);
    assert_false(interlock.lost[WB_ROLE_MOCAP]);
}

static void stalls_up_to_5_s_do_not_count_as_silence(void **state)
{
    (void)state;
    struct wb_interlock interlock;
    const struct wb_interlock_settings settings = {.stream_lost_ns = {S, 0, S}};
    wb_interlock_init(&interlock, &settings, 10 * S);
    assert_false(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 11 * S - 1));
    assert_true(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 11 * S));
    assert_false(wb_interlock_expires(&interlock, WB_ROLE_MOCAP, 100 * S));
    wb_interlock_discount(&interlock, 2 * S);
    assert_false(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 13 * S - 1));
    assert_int_equal(wb_interlock_deadline(&interlock), 13 * S);
    /* At most 5 s of stalls are excluded between two samples. */
    wb_interlock_discount(&interlock, 20 * S);
    assert_int_equal(wb_interlock_deadline(&interlock), 16 * S);
    wb_interlock_discount(&interlock, 20 * S);
    assert_int_equal(wb_interlock_deadline(&interlock), 16 * S);
    wb_interlock_tick(&interlock, 16 * S);
    assert_true(interlock.lost[WB_ROLE_LOAD] && interlock.lost[WB_ROLE_STAGE]);
    assert_false(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 17 * S));
    /* After a sample, stalls are excluded again. */
    const struct wb_load_sample sample = {.t_ns = 20 * S, .valid = true};
    wb_interlock_load(&interlock, &sample);
    wb_interlock_discount(&interlock, S);
    assert_true(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 22 * S));
    assert_false(wb_interlock_expires(&interlock, WB_ROLE_LOAD, 22 * S - 1));
}

static void invalid_readings_do_not_end_a_silence(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    interlock.settings.stream_lost_ns[WB_ROLE_MOCAP] = 0;
    interlock.settings.stream_lost_ns[WB_ROLE_STAGE] = 0;
    const struct wb_load_sample sample = {.t_ns = 10 * S + 900 * MS, .force = (double)NAN};
    assert_false(wb_interlock_load(&interlock, &sample));
    assert_true(wb_interlock_tick(&interlock, 11 * S));
}

static void unarmed_interlock_detects_silence_but_does_not_trip(void **state)
{
    (void)state;
    struct wb_interlock interlock = armed();
    interlock.armed = false;
    const struct wb_load_sample sample = reading(99.0, 11 * S);
    assert_false(wb_interlock_load(&interlock, &sample));
    assert_false(wb_interlock_tick(&interlock, 20 * S));
    assert_true(interlock.lost[WB_ROLE_MOCAP]);
    assert_int_equal(interlock.reason, WB_INTERLOCK_NONE);
    (void)wb_interlock_mocap(&interlock, 21 * S);
    assert_false(interlock.lost[WB_ROLE_MOCAP]);
}

static void defaults_come_from_the_rig(void **state)
{
    (void)state;
    struct wb_rig rig;
    memset(&rig, 0, sizeof rig);
    rig.time_scale = 20.0;
    rig.load_cell.overload = 0.29;
    rig.stage.travel = 0.06;
    rig.stage.down = -1;
    rig.limits.stream_lost = 8.0;
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &rig);
    assert_close(settings.force, 0.29, 0.0);
    assert_close(settings.overload, 0.29, 0.0);
    assert_close(settings.travel, 0.06, 0.0);
    assert_int_equal(settings.down, -1);
    assert_int_equal(settings.stream_lost_ns[WB_ROLE_LOAD], 400 * MS);
    assert_int_equal(settings.stream_lost_ns[WB_ROLE_STAGE], 600 * MS);
    rig.limits.stream_lost = 1.0; /* scaled: 50 ms, as short as scheduling delays */
    wb_interlock_default_settings(&settings, &rig);
    assert_int_equal(settings.stream_lost_ns[WB_ROLE_MOCAP], 250 * MS);
    rig.time_scale = 1.0;
    rig.limits.stream_lost = 0.1; /* not scaled: no minimum */
    wb_interlock_default_settings(&settings, &rig);
    assert_int_equal(settings.stream_lost_ns[WB_ROLE_MOCAP], 100 * MS);
    rig.limits.force = 0.2;
    rig.limits.travel = 0.05;
    wb_interlock_default_settings(&settings, &rig);
    assert_close(settings.force, 0.2, 0.0);
    assert_close(settings.overload, 0.29, 0.0);
    assert_close(settings.travel, 0.05, 0.0);
}

/* --- stop sequence --- */

static void report_state(struct wb_stop *stop, enum wb_stage_state state, int64_t t_ns)
{
    const struct wb_stage_report report = {.t_ns = t_ns, .state = state};
    wb_stop_report(stop, &report);
}

static void hold_is_confirmed_by_its_report(void **state)
{
    (void)state;
    struct wb_stop stop;
    wb_stop_begin(&stop, S);
    assert_int_equal(wb_stop_tick(&stop, S), WB_STOP_DO_ASK);
    assert_int_equal(wb_stop_tick(&stop, S + MS), WB_STOP_DO_NOTHING);
    report_state(&stop, WB_STAGE_JOG, S + 20 * MS);
    assert_false(wb_stop_over(&stop));
    report_state(&stop, WB_STAGE_HOLD, S + 80 * MS);
    assert_int_equal(stop.state, WB_STOP_STANDING);
    assert_int_equal(stop.confirmed_ns, S + 80 * MS);
    assert_int_equal(wb_stop_deadline(&stop), INT64_MAX);
}

static void one_idle_report_may_be_older_than_the_hold(void **state)
{
    (void)state;
    struct wb_stop stop;
    wb_stop_begin(&stop, S);
    report_state(&stop, WB_STAGE_IDLE, S + MS);
    assert_false(wb_stop_over(&stop));
    report_state(&stop, WB_STAGE_JOG, S + 2 * MS);
    report_state(&stop, WB_STAGE_IDLE, S + 60 * MS);
    assert_false(wb_stop_over(&stop));
    report_state(&stop, WB_STAGE_IDLE, S + 120 * MS);
    assert_int_equal(stop.state, WB_STOP_STANDING);
}

static void unconfirmed_hold_is_followed_by_a_soft_reset(void **state)
{
    (void)state;
    struct wb_stop stop;
    wb_stop_begin(&stop, S);
    int asked = 0;
    int64_t t_ns = S;
    for (; t_ns < S + 500 * MS; t_ns += 10 * MS)
        asked += wb_stop_tick(&stop, t_ns) == WB_STOP_DO_ASK;
    assert_in_range(asked, 5, 12);
    assert_int_equal(stop.state, WB_STOP_HOLDING);
    assert_int_equal(wb_stop_tick(&stop, t_ns), WB_STOP_DO_RESET);
    assert_int_equal(stop.reset_ns, S + 500 * MS);
    report_state(&stop, WB_STAGE_ALARM, S + 600 * MS);
    assert_int_equal(stop.state, WB_STOP_STANDING);
    assert_true(stop.reset_ns != 0);
}

static void reset_that_is_not_confirmed_is_a_failure(void **state)
{
    (void)state;
    struct wb_stop stop;
    wb_stop_begin(&stop, S);
    int64_t t_ns = S;
    for (; !wb_stop_over(&stop) && t_ns < 10 * S; t_ns += 10 * MS)
        (void)wb_stop_tick(&stop, t_ns);
    assert_int_equal(stop.state, WB_STOP_FAILED);
    assert_true(t_ns <= S + WB_STOP_CONFIRM_NS + WB_STOP_RESET_NS + 20 * MS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stalls_up_to_5_s_do_not_count_as_silence),
        cmocka_unit_test(force_beyond_the_limit_trips_once),
        cmocka_unit_test(force_limit_applies_to_the_tared_reading_of_either_sign),
        cmocka_unit_test(overload_limit_applies_to_the_reading_including_tare),
        cmocka_unit_test(overload_reported_by_the_cell_trips_without_a_force_value),
        cmocka_unit_test(reading_that_is_not_a_number_trips),
        cmocka_unit_test(unit_change_trips),
        cmocka_unit_test(contradicting_unit_trips_except_during_release),
        cmocka_unit_test(travel_is_measured_downwards_from_the_start),
        cmocka_unit_test(alarm_and_unrequested_hold_trip),
        cmocka_unit_test(silence_trips_at_its_limit_and_not_before),
        cmocka_unit_test(invalid_readings_do_not_end_a_silence),
        cmocka_unit_test(unarmed_interlock_detects_silence_but_does_not_trip),
        cmocka_unit_test(defaults_come_from_the_rig),
        cmocka_unit_test(hold_is_confirmed_by_its_report),
        cmocka_unit_test(one_idle_report_may_be_older_than_the_hold),
        cmocka_unit_test(unconfirmed_hold_is_followed_by_a_soft_reset),
        cmocka_unit_test(reset_that_is_not_confirmed_is_a_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
