/* The bending test with a small bench in virtual time: the whole sequence, and every kind of stop
 * with the time of the hold byte. */
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "base/interrupt_private.h"
#include "base/timing.h"
#include "daq/recording/writer_private.h"
#include "daq/test/bend_recording_private.h"
#include "tests/daq/bend_fixture.h"
#include "tests/messages.h"

static bool well_down(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "down") == 0 && status->has_travel && status->travel > 5.0 * WB_MM;
}

static bool takes_tare(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "tare") == 0;
}

/* Asserts that the hold byte was sent in the step that read the data of `shown_ns`. */
static void assert_held_at(const struct fixture *fixture, int64_t shown_ns)
{
    assert_int_equal(fixture->bench->hold_ns, shown_ns);
}

static void open_and_get_down(struct fixture *fixture, struct wb_bend_test **test)
{
    assert_int_equal(wb_bend_test_open(test, &fixture->request), WB_OK);
    assert_true(run(*test, well_down));
}

/* --- the whole test --- */

static void complete_test_goes_down_and_back_and_records_it(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.cycles = 2;
    fixture->request.travel = 8.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_true(run(test, takes_tare));
    wb_bend_test_mark(test, "look here");
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_int_equal(result.cycles_done, 2);
    assert_true(result.standing && !result.displaced && result.recorded && result.is_virtual);
    assert_int_equal(result.drops, 0);
    assert_close(result.tare, 0.15e-3 * WB_STANDARD_GRAVITY, 0.01e-3 * WB_STANDARD_GRAVITY);
    assert_close(result.peak_tension, 4e-3 * WB_STANDARD_GRAVITY, 0.05e-3 * WB_STANDARD_GRAVITY);
    assert_close(fixture->bench->position_mm, 0.0, 1e-9);
    assert_int_equal(fixture->bench->holds, 0);
    static const char *const expected[] = {
        "start:",         "check: passed", "mark: look here", "tare: {\"force_N\":",
        "cycle_start: 1", "turn: 1",       "cycle_end: 1",    "cycle_start: 2",
        "turn: 2",        "cycle_end: 2",  "stop: done",      "end:"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
    assert_null(strstr(fixture->events, "stream_lost"));
    assert_string_equal(fixture->errors, "");
    assert_true(fixture->log.n[WB_ROLE_LOAD] > 100);
    assert_true(fixture->log.n[WB_ROLE_MOCAP] > 50);
    assert_replay_identical(fixture->output, &fixture->log);
}

static bool is_coming_up(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "up") == 0 && status->travel < 10.0 * WB_MM;
}

/* The stage of the fixture's rig moves at 1 mm/s; it stays at the turn for 2 s, and 2 s of rest end
 * a cycle. */
static void time_left_follows_from_the_remaining_travel_and_ends_at_zero(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_status status;
    struct wb_bend_test_result result;
    fixture->request.cycles = 2;
    fixture->request.travel = 12.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    wb_bend_test_status(test, &status);
    assert_true(isnan(status.time_left));
    assert_true(!status.is_connected && status.end == WB_SEQUENCE_RUNNING);
    assert_true(run(test, well_down));
    wb_bend_test_status(test, &status);
    assert_true(status.is_connected);
    assert_close(status.time_left, 48.0 - status.travel / WB_MM + 8.0, 1e-9);
    assert_true(run(test, is_coming_up));
    wb_bend_test_status(test, &status);
    assert_close(status.time_left, 24.0 + status.travel / WB_MM + 6.0, 1e-9);
    const double peak = status.peak_tension;
    assert_true(peak > 0.0);
    wb_bend_test_stop(test);
    wb_bend_test_status(test, &status);
    assert_close(status.time_left, 0.0, 0.0);
    assert_int_equal(status.end, WB_SEQUENCE_INTERRUPTED);
    assert_string_equal(status.end_text, "stopped by the operator");
    assert_false(run(test, NULL));
    wb_bend_test_status(test, &status);
    assert_true(status.is_standing);
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_true(result.peak_tension >= peak);
}

static bool dwells(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "dwell") == 0;
}

static bool comes_up(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "up") == 0;
}

static bool rests(const struct wb_bend_test_status *status)
{
    return strcmp(status->phase, "rest") == 0;
}

static double seconds(void)
{
    return wb_seconds_from_ns(wb_time_now_ns());
}

/* Both cycles stay at the turn for the dwell; the second moves at a quarter of the speed. */
static void cycles_have_their_dwell_and_their_speeds_in_turn(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_status status;
    static const double speeds[] = {2.0, 0.5};
    fixture->request.cycles = 2;
    fixture->request.travel = 12.0 * WB_MM;
    fixture->request.dwell_time = 5.0;
    snprintf(fixture->request.speeds, sizeof fixture->request.speeds, "2,0.5");
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    for (int cycle = 1; cycle <= 2; cycle++) {
        const double way = 12.0 / speeds[cycle - 1];
        assert_close(wb_bend_test_cycle_time(&fixture->request, &(struct wb_rig){0}, cycle),
                     2.0 * way + 5.0 + 2.0, 1e-12);
        assert_true(run(test, dwells));
        wb_bend_test_status(test, &status);
        assert_close(status.travel, 12.0 * WB_MM, 0.02 * WB_MM);
        const double arrived = seconds();
        assert_close(status.time_left, 5.0 + way + 2.0 + (cycle == 1 ? 2.0 * 24.0 + 7.0 : 0.0),
                     0.05);
        assert_true(run(test, comes_up));
        assert_close(seconds() - arrived, 5.0, 0.05);
        assert_true(run(test, rests));
        assert_close(seconds() - arrived, 5.0 + way, 0.5);
    }
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, NULL), WB_OK);
}

/* A hold at the turn is followed by the whole dwell. */
static void hold_during_the_dwell_is_followed_by_the_dwell(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.travel = 8.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_true(run(test, dwells));
    assert_true(wb_bend_test_hold(test));
    while (!wb_bend_test_resume(test))
        assert_int_equal(wb_bend_test_step(test, 20 * MS), WB_SEQUENCE_RUNNING);
    const double resumed = seconds();
    assert_true(run(test, comes_up));
    assert_close(seconds() - resumed, 2.0, 0.05);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_int_equal(result.holds, 1);
}

static void speeds_that_are_no_list_are_rejected(void **state)
{
    struct fixture *const fixture = *state;
    static const char *const wrong[] = {"fast", "1,", "1;2", "0", "-1", "200", "1,1,1,1,1,1,1,1,1"};
    struct wb_bend_test *test;
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        snprintf(fixture->request.speeds, sizeof fixture->request.speeds, "%s", wrong[i]);
        keep_messages();
        assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_ERR_ARGUMENT);
        assert_non_null(strstr(kept.last, "--speeds"));
        assert_non_null(strstr(kept.last, wrong[i]));
    }
}

static void meta_values_describe_the_test(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    fixture->request.travel = 2.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, NULL), WB_OK);
    struct wb_recording *recording;
    assert_int_equal(wb_recording_open(&recording, fixture->output), WB_OK);
    static const struct {
        const char *key, *has;
    } metas[] = {{"schema", "2"},
                 {"tool_version", "."},
                 {"tool_revision", ""},
                 {"start_utc", "T"},
                 {"host", ""},
                 {"operator", "tester"},
                 {"notes", ""},
                 {"rig", "spring_mg_mm: 500"},
                 {"specimen", "length_mm: 90"},
                 {"wire", "diameter"},
                 {"g", "9.80665"},
                 {"cycles", "1"},
                 {"travel_mm", "2"},
                 {"dwell_s", "2"},
                 {"speeds_mm_s", ""},
                 {"monotonic_start_ns", ""},
                 {"virtual", "true"},
                 {"stage_settings", "$110=6000.000\n$120="},
                 {"truth", "truth:\n  spring_mg_mm: 500\n"}};
    for (size_t i = 0; i < sizeof metas / sizeof metas[0]; i++) {
        char *value = NULL;
        if (wb_recording_meta(recording, metas[i].key, &value) != WB_OK)
            fail_msg("no meta value '%s'", metas[i].key);
        if (!strstr(value, metas[i].has))
            fail_msg("meta '%s' is '%s', without '%s'", metas[i].key, value, metas[i].has);
        free(value);
    }
    assert_int_equal(wb_recording_n_streams(recording), 3);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void part_of_a_yaml_text_ends_at_the_next_key(void **state)
{
    (void)state;
    static const char yaml[] = "a: 1\ntruth:\n  b: 2\n\n  c: 3\n# note\nd: 4\n";
    char *part = wb_bend_recording_yaml_part(yaml, "truth");
    assert_string_equal(part, "truth:\n  b: 2\n\n  c: 3\n# note\n");
    free(part);
    part = wb_bend_recording_yaml_part(yaml, "d");
    assert_string_equal(part, "d: 4\n");
    free(part);
    part = wb_bend_recording_yaml_part(yaml, "b");
    assert_string_equal(part, "");
    free(part);
}

/* --- limits, each with the moment of the hold byte --- */

/* The first reading whose tension is beyond a limit. */
struct first_beyond {
    double tare, limit; /* N */
    int64_t t_ns;       /* when it was read; 0: none */
};

static void find_first_beyond(void *context, const struct wb_load_sample *sample)
{
    struct first_beyond *const first = context;
    if (first->t_ns == 0 && sample->valid && sample->force - first->tare > first->limit)
        first->t_ns = sample->t_ns;
}

/* The first reading that is passed on after the hold byte left. */
static struct {
    const struct fake_bench *bench;
    int64_t t_ns;
} first_held;

static void log_and_watch_the_hold(void *context, const struct wb_load_sample *sample)
{
    if (first_held.t_ns == 0 && first_held.bench->holds > 0)
        first_held.t_ns = sample->t_ns;
    sample_log_load(context, sample);
}

static void force_limit_holds_at_the_reading_beyond_it_and_the_specimen_stays(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    first_held.bench = fixture->bench;
    first_held.t_ns = 0;
    fixture->request.sink.load = log_and_watch_the_hold;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_true(result.standing && result.displaced && !result.soft_reset);
    assert_non_null(strstr(result.text, "force limit of 100.0 mN"));
    assert_close(result.hold_latency, 0.0, 0.0);
    /* It is queried in the same step. */
    assert_close(result.confirm_latency, wb_seconds_from_ns(WB_SIM_PORT_DELAY_NS), 1e-12);
    assert_string_equal(fixture->bench->state, "Hold:0");
    assert_close(fixture->bench->position_mm, 100e-3 / WB_STANDARD_GRAVITY / 500e-6, 0.05);
    assert_close(result.travel / WB_MM, fixture->bench->position_mm, 0.001);
    struct first_beyond first = {.tare = result.tare, .limit = 100.0 * WB_MN};
    replay(fixture, &(struct wb_sink){.context = &first, .load = find_first_beyond});
    assert_held_at(fixture, first.t_ns);
    assert_int_equal(first_held.t_ns, first.t_ns);
    static const char *const expected[] = {"cycle_start: 1", "limit: the tension is",    "hold: {",
                                           "stopped: {",     "stop: limit: the tension", "end:"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
    assert_replay_identical(fixture->output, &fixture->log);
}

static void overload_unit_change_and_alarm_hold_at_their_arrival(void **state)
{
    struct fixture *const fixture = *state;
    memset(&fixture->request.sink, 0, sizeof fixture->request.sink);
    for (int i = 0; i < 3; i++) {
        struct wb_bend_test *test;
        struct wb_bend_test_result result;
        struct fake_bench *const bench = fixture->bench;
        open_and_get_down(fixture, &test);
        bool *const faults[] = {&bench->overload, &bench->other_unit, &bench->raise_alarm};
        static const char *const words[] = {"overload", "unit", "ALARM:1"};
        *faults[i] = true;
        assert_false(run(test, NULL));
        assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
        assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
        if (!strstr(result.text, words[i]))
            fail_msg("'%s' does not contain '%s'", result.text, words[i]);
        assert_true(result.standing);
        assert_true(bench->limit_sent_ns != 0);
        assert_held_at(fixture, bench->limit_sent_ns + WB_SIM_PORT_DELAY_NS);
        renew(fixture, 60.0);
    }
}

static void silent_streams_hold_at_their_expiry(void **state)
{
    struct fixture *const fixture = *state;
    memset(&fixture->request.sink, 0, sizeof fixture->request.sink);
    for (int i = 0; i < 2; i++) {
        struct wb_bend_test *test;
        struct wb_bend_test_result result;
        renew(fixture, 0.25);
        struct fake_bench *const bench = fixture->bench;
        open_and_get_down(fixture, &test);
        *(i ? &bench->mocap_silent : &bench->load_silent) = true;
        assert_false(run(test, NULL));
        assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
        assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
        if (!strstr(result.text, i ? "motion capture" : "load cell"))
            fail_msg("silence %d ended as '%s'", i, result.text);
        const int64_t last_ns = i ? bench->frame_last_ns : bench->load_last_ns;
        assert_held_at(fixture, last_ns + WB_SIM_PORT_DELAY_NS + 250 * MS);
        read_events(fixture);
        assert_non_null(strstr(fixture->events, i ? "stream_lost: mocap" : "stream_lost: load"));
    }
}

static void own_stall_does_not_count_as_silence(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->bench->spring_mg_mm = 10;
    fake_write_rig(fixture->rig, true, 0.25);
    open_and_get_down(fixture, &test);
    /* Longer than the stage, which is asked for its reports, may be silent. */
    wb_time_sleep(wb_time_now_ns() + 1200 * MS);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    if (result.end != WB_SEQUENCE_DONE)
        fail_msg("ended early: %s", result.text);
    /* The stage moved unwatched, which is recorded. */
    read_events(fixture);
    if (!strstr(fixture->events, "stall: the recorder was stalled for 1.2 s"))
        fail_msg("no stall in: %s", fixture->events);
}

struct staller {
    struct fake_bench *bench;
    bool stalled;
};

/* Once, during a motion: data that arrive meanwhile remain unread. */
static void stall_once(void *context, const struct wb_load_sample *sample)
{
    struct staller *const staller = context;
    (void)sample;
    if (staller->stalled || staller->bench->position_mm < 5.0)
        return;
    staller->stalled = true;
    wb_time_sleep(wb_time_now_ns() + 800 * MS);
}

static void stall_within_a_step_does_not_count_as_silence(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    struct staller staller = {.bench = fixture->bench};
    fixture->bench->spring_mg_mm = 10;
    /* 250 ms, and 600 ms for the stage. */
    fake_write_rig(fixture->rig, true, 0.25);
    fixture->request.sink = (struct wb_sink){.context = &staller, .load = stall_once};
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_true(staller.stalled);
    if (result.end != WB_SEQUENCE_DONE)
        fail_msg("ended early: %s", result.text);
    read_events(fixture);
    assert_null(strstr(fixture->events, "stream_lost"));
}

static void stage_beyond_its_target_is_held_at_the_travel_limit(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->bench->spring_mg_mm = 10;
    fixture->bench->stage_overshoots = true;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_non_null(strstr(result.text, "travel limit of 58.00 mm"));
    assert_true(result.standing);
    /* It is queried five times a second. */
    assert_close(fixture->bench->position_mm, 58.1, 0.101);
}

static void stage_that_ignores_hold_is_reset_after_500_ms(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_and_get_down(fixture, &test);
    bench->stage_deaf = bench->stage_overshoots = true; /* otherwise it would stop by itself */
    bench->overload = true;
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_true(result.soft_reset && result.standing);
    assert_held_at(fixture, bench->limit_sent_ns + WB_SIM_PORT_DELAY_NS);
    assert_int_equal(bench->reset_ns, bench->hold_ns + 500 * MS);
    assert_string_equal(bench->state, "Alarm");
    static const char *const expected[] = {"limit:", "hold:", "reset:", "stopped:", "stop: limit"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
}

static void stage_that_ignores_all_commands_counts_as_moving(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_and_get_down(fixture, &test);
    fixture->bench->stage_deaf = fixture->bench->stage_wild = true;
    fixture->bench->stage_overshoots = true;
    fixture->bench->overload = true;
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_false(result.standing);
    read_events(fixture);
    assert_non_null(strstr(fixture->events, "not confirmed"));
}

/* Ctrl-C, at a moment within a wait. */
static int64_t pressed_ns;

static int64_t next_press(void *context)
{
    (void)context;
    return wb_interrupted() ? INT64_MAX : pressed_ns;
}

static void press(void *context, int64_t now_ns)
{
    (void)context, (void)now_ns;
    wb_interrupt_set(true);
}

static void ctrl_c_stops_the_stage_and_closes_the_recording(void **state)
{
    static const struct wb_virtual_actor finger = {NULL, next_press, press};
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_and_get_down(fixture, &test);
    pressed_ns = wb_time_now_ns() + 1234567;
    wb_virtual_time_add(&finger);
    assert_false(run(test, NULL));
    wb_virtual_time_remove(&finger);
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    wb_interrupt_set(false); /* it would stop the replay below as well */
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_true(result.standing && result.displaced);
    assert_held_at(fixture, pressed_ns);
    static const char *const expected[] = {"cycle_start: 1", "hold: {\"reason\": \"interrupt\"",
                                           "stopped:", "stop: interrupted", "end:"};
    assert_events(fixture, expected, sizeof expected / sizeof expected[0]);
    assert_null(strstr(fixture->events, "limit:"));
    assert_replay_identical(fixture->output, &fixture->log);
}

static void closing_in_mid_test_stops_the_stage_first(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_and_get_down(fixture, &test);
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_int_equal(fixture->bench->holds, 1);
    assert_true(result.standing);
}

static void ctrl_c_before_any_motion_sends_no_hold(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_true(run(test, takes_tare));
    wb_interrupt_set(true);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_true(result.standing && !result.displaced && !result.started);
    assert_int_equal(fixture->bench->holds, 0);
    assert_string_equal(fixture->bench->state, "Idle");
}

static void unplugged_bench_ends_the_test_and_keeps_the_recording(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    open_and_get_down(fixture, &test);
    fake_unplug(fixture->bench);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_non_null(strstr(result.text, "was disconnected"));
    assert_false(result.standing);
    assert_replay_identical(fixture->output, &fixture->log);
}

/* Files may grow to this size from now on; 0: to any again. */
static void limit_files(rlim_t size)
{
    struct rlimit limit;
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = size ? size : limit.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static bool storage_is_late(const struct wb_bend_test_status *status)
{
    return status->latest->is_storage_late;
}

/* The test is not ended by a disk that is full temporarily. */
static void full_disk_is_reported_and_data_are_kept_until_there_is_space(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.cycles = 3;
    fixture->request.travel = 8.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_true(run(test, well_down));
    limit_files(8 * 1024);
    assert_true(run(test, storage_is_late));
    limit_files(0);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_int_equal(result.drops, 0);
    assert_int_equal(fixture->bench->holds, 0);
    read_events(fixture);
    assert_non_null(strstr(fixture->events, "storage: nothing can be written to the disk"));
    assert_replay_identical(fixture->output, &fixture->log);
}

static void full_disk_stops_the_stage_before_memory_is_full(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    struct wb_writer_settings writer;
    wb_writer_default_settings(&writer);
    writer.capacity_bytes = 20000;
    writer.patience_ns = 0;
    fixture->request.writer = &writer;
    fixture->request.cycles = 50;
    fixture->request.travel = 8.0 * WB_MM;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_true(run(test, well_down));
    limit_files(8 * 1024);
    assert_false(run(test, NULL));
    assert_int_not_equal(wb_bend_test_close(test, &result), WB_OK);
    limit_files(0);
    assert_non_null(strstr(result.text, "the disk"));
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    assert_true(result.started && result.standing);
    assert_true(fixture->bench->holds <= 1); /* none where it stood at a turn */
    read_events(fixture);
    assert_non_null(strstr(fixture->events, "cycle_start: 1"));
}

static void first_motion_that_contradicts_the_cameras_ends_the_test(void **state)
{
    struct fixture *const fixture = *state;
    static const struct {
        int follow;
        bool level;
        const char *word;
    } faults[] = {{0, false, "live mode"},
                  {100, true, "set mocap.up"},
                  {-100, false, "set stage.down of the rig file to -1"}};
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        struct fake_bench *const bench = fixture->bench;
        struct wb_bend_test *test;
        struct wb_bend_test_result result;
        unlink(fixture->output);
        bench->spring_mg_mm = 10;
        bench->markers_follow = faults[i].follow;
        bench->markers_level = faults[i].level;
        assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
        assert_false(run(test, NULL));
        assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
        if (result.end != WB_SEQUENCE_FAILED || !strstr(result.text, faults[i].word))
            fail_msg("fault %zu: ended with '%s'", i, result.text);
        assert_true(result.standing);
        /* The whole test goes farther. */
        assert_close(bench->position_mm, 2.3, 0.4);
        read_events(fixture);
        assert_null(strstr(fixture->events, "first_motion"));
        renew(fixture, 60.0);
    }
}

static void stage_that_rejects_a_motion_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->bench->stage_refuses = true;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    assert_non_null(strstr(result.text, "error:15"));
    assert_int_equal(fixture->bench->holds, 0); /* it stands, and is not left on hold */
}

static void lost_reply_of_the_stage_only_delays_the_next_motion(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fixture->request.travel = 8.0 * WB_MM;
    fixture->bench->stage_forgets_ok = true;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    if (result.end != WB_SEQUENCE_DONE)
        fail_msg("ended early: %s", result.text);
    assert_false(fixture->bench->stage_forgets_ok);
    assert_string_equal(fixture->errors, "");
    assert_close(fixture->bench->position_mm, 0.0, 1e-9);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(complete_test_goes_down_and_back_and_records_it),
        TEST(time_left_follows_from_the_remaining_travel_and_ends_at_zero),
        TEST(cycles_have_their_dwell_and_their_speeds_in_turn),
        TEST(hold_during_the_dwell_is_followed_by_the_dwell),
        TEST(speeds_that_are_no_list_are_rejected),
        TEST(meta_values_describe_the_test),
        TEST(part_of_a_yaml_text_ends_at_the_next_key),
        TEST(force_limit_holds_at_the_reading_beyond_it_and_the_specimen_stays),
        TEST(overload_unit_change_and_alarm_hold_at_their_arrival),
        TEST(silent_streams_hold_at_their_expiry),
        TEST(own_stall_does_not_count_as_silence),
        TEST(stall_within_a_step_does_not_count_as_silence),
        TEST(stage_beyond_its_target_is_held_at_the_travel_limit),
        TEST(stage_that_ignores_hold_is_reset_after_500_ms),
        TEST(stage_that_ignores_all_commands_counts_as_moving),
        TEST(ctrl_c_stops_the_stage_and_closes_the_recording),
        TEST(closing_in_mid_test_stops_the_stage_first),
        TEST(ctrl_c_before_any_motion_sends_no_hold),
        TEST(unplugged_bench_ends_the_test_and_keeps_the_recording),
        TEST(full_disk_is_reported_and_data_are_kept_until_there_is_space),
        TEST(full_disk_stops_the_stage_before_memory_is_full),
        TEST(first_motion_that_contradicts_the_cameras_ends_the_test),
        TEST(stage_that_rejects_a_motion_is_reported),
        TEST(lost_reply_of_the_stage_only_delays_the_next_motion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
