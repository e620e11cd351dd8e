/* Single jobs of the stage with a small bench in virtual time: jog, home, unlock, release, and the
 * check of the load cell with a mass. */
#include "base/interrupt_private.h"
#include "base/log.h"
#include "base/timing.h"
#include "daq/acquire/mass_check.h"
#include "daq/acquire/stage_job.h"
#include "daq/protocol/cell_calibration.h"
#include "tests/daq/fake_bench.h"

#define MS WB_NS_PER_MS

struct fixture {
    struct fake_bench *bench;
    char path[64];
    struct wb_rig rig;
    double zero; /* N, zero of the cell given to a release */
};

static void keep_quiet(void *context, enum wb_log_level level, const char *domain,
                       const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static int set_up(void **state)
{
    struct fixture *const fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    snprintf(fixture->path, sizeof fixture->path, "/tmp/wb-stage-XXXXXX");
    const int file = mkstemp(fixture->path);
    assert_true(file >= 0);
    close(file);
    fixture->bench = fake_start();
    fake_write_rig(fixture->path, true, 60.0);
    assert_int_equal(wb_rig_read(fixture->path, &fixture->rig), WB_OK);
    fixture->zero = 0.15e-3 * WB_STANDARD_GRAVITY;
    wb_interrupt_set(false);
    wb_log_set_sink(keep_quiet, NULL);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *const fixture = *state;
    wb_log_set_sink(NULL, NULL);
    wb_interrupt_set(false);
    fake_stop(fixture->bench);
    unlink(fixture->path);
    free(fixture);
    return 0;
}

static struct wb_stage_job_result run(struct fixture *fixture, enum wb_stage_job_kind kind,
                                      double distance_mm)
{
    const struct wb_stage_job_request request = {.kind = kind,
                                                 .distance = distance_mm * WB_MM,
                                                 .zero = fixture->zero,
                                                 .connect_timeout = 6.0};
    struct wb_stage_job *job;
    struct wb_stage_job_result result;
    assert_int_equal(wb_stage_job_open(&job, &fixture->rig, &request), WB_OK);
    const int64_t patience_ns = wb_time_now_ns() + 3600 * WB_NS_PER_S;
    while (wb_stage_job_step(job, 10 * MS) == WB_SEQUENCE_RUNNING)
        assert_true(wb_time_now_ns() < patience_ns);
    wb_stage_job_close(job, &result);
    return result;
}

static void jog_moves_by_the_distance_down_and_up(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 3.5);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_close(fixture->bench->position_mm, 3.5, 1e-6);
    assert_close(result.moved, 3.5e-3, 1e-6);
    result = run(fixture, WB_STAGE_JOB_JOG, -1.25);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    assert_close(fixture->bench->position_mm, 2.25, 1e-6);
    assert_int_equal(fixture->bench->holds, 0);
}

static void slow_jog_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->is_slow = true;
    fixture->bench->spring_mg_mm = 10;
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 8.0);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    if (!strstr(result.text, "moved by 8.000 mm at 0.5 mm/s instead of 1 mm/s"))
        fail_msg("'%s' does not tell its speed", result.text);
}

static void jog_stops_at_the_reading_beyond_the_force_limit(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->force_limit_mg = (int)(100e-3 / WB_STANDARD_GRAVITY * 1e6); /* not tared */
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 40.0);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_true(result.standing);
    assert_non_null(strstr(result.text, "force limit"));
    assert_true(bench->limit_sent_ns != 0);
    assert_int_equal(bench->hold_ns, bench->limit_sent_ns + WB_SIM_PORT_DELAY_NS);
    assert_close(bench->position_mm, (bench->force_limit_mg - bench->force_mg) / 500.0, 0.03);
}

static void jog_beyond_the_travel_is_rejected(void **state)
{
    struct fixture *const fixture = *state;
    const struct wb_stage_job_request request = {.kind = WB_STAGE_JOB_JOG, .distance = 0.061};
    struct wb_stage_job *job = NULL;
    assert_int_equal(wb_stage_job_open(&job, &fixture->rig, &request), WB_ERR_ARGUMENT);
    assert_null(job);
}

static void jog_of_a_locked_stage_is_rejected_with_the_remedy(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->state = "Alarm";
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 1.0);
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    assert_non_null(strstr(result.text, "locked: it was not homed since"));
    assert_non_null(strstr(result.text, "'unlock'"));
}

/* An Arduino that is reset by an edge on DTR: home, close, open, and the position is lost. */
static void stage_reset_by_opening_its_port_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->starts_anew = true;
    assert_int_equal(run(fixture, WB_STAGE_JOB_HOME, 0.0).end, WB_SEQUENCE_DONE);
    fixture->bench->starts_anew = true;
    struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 1.0);
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    assert_non_null(strstr(result.text, "restarted when the port was opened"));
    assert_non_null(strstr(result.text, "dtr=on or dtr=off"));
    assert_non_null(strstr(result.text, "run 'home'"));
    /* Our own reset does not count. */
    assert_int_equal(run(fixture, WB_STAGE_JOB_UNLOCK, 0.0).end, WB_SEQUENCE_DONE);
    fixture->bench->state = "Alarm";
    result = run(fixture, WB_STAGE_JOB_JOG, 1.0);
    assert_null(strstr(result.text, "anew"));
}

static void jog_without_a_reading_is_rejected(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->load_silent = true;
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_JOG, 1.0);
    assert_int_equal(result.end, WB_SEQUENCE_FAILED);
    assert_non_null(strstr(result.text, "--without-load-cell"));
    assert_close(fixture->bench->position_mm, 0.0, 0.0);
}

static void ctrl_c_stops_a_jog(void **state)
{
    struct fixture *const fixture = *state;
    const struct wb_stage_job_request request = {.kind = WB_STAGE_JOB_JOG, .distance = 0.02};
    struct wb_stage_job *job;
    struct wb_stage_job_result result;
    assert_int_equal(wb_stage_job_open(&job, &fixture->rig, &request), WB_OK);
    while (wb_stage_job_step(job, 10 * MS) == WB_SEQUENCE_RUNNING)
        if (fixture->bench->position_mm > 2.0)
            wb_interrupt_set(true);
    wb_stage_job_close(job, &result);
    assert_int_equal(result.end, WB_SEQUENCE_INTERRUPTED);
    assert_int_equal(fixture->bench->holds, 1);
    assert_close(fixture->bench->position_mm, 2.0, 0.03);
}

static void home_waits_for_the_end_of_homing(void **state)
{
    struct fixture *const fixture = *state;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 2.0).end, WB_SEQUENCE_DONE);
    fixture->bench->state = "Alarm";
    assert_int_equal(run(fixture, WB_STAGE_JOB_HOME, 0.0).end, WB_SEQUENCE_DONE);
    assert_close(fixture->bench->position_mm, 0.0, 0.0);
}

static void unlock_brings_the_stage_to_idle_from_anything(void **state)
{
    struct fixture *const fixture = *state;
    static const char *const states[] = {"Hold:0", "Alarm", "Idle", "Door:0", "Sleep", "Jog"};
    for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
        fixture->bench->target_mm = 50.0; /* of another program's jog, speed unknown */
        fixture->bench->state = states[i];
        assert_int_equal(run(fixture, WB_STAGE_JOB_UNLOCK, 0.0).end, WB_SEQUENCE_DONE);
        assert_string_equal(fixture->bench->state, "Idle");
    }
    assert_close(fixture->bench->position_mm, 0.0, 0.0);
}

static void release_goes_up_until_the_strand_is_slack(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->slack_mm = 12;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    bench->state = "Hold:0";
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_DONE);
    /* The strand is slack above 12 mm; detected over 0.75 mm, in steps of 1 mm. */
    assert_true(bench->position_mm < 11.25);
    assert_true(bench->position_mm > 9.0);
    assert_close(result.force, 0.15e-3 * WB_STANDARD_GRAVITY, 0.02e-3 * WB_STANDARD_GRAVITY);
    assert_true(result.change < -0.05);
}

static void release_waits_after_a_lost_reply(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->slack_mm = 12;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    bench->stage_forgets_ok = true;
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    if (result.end != WB_SEQUENCE_DONE)
        fail_msg("not released: %s", result.text);
    assert_false(bench->stage_forgets_ok);
    assert_true(bench->position_mm < 11.25);
}

/* Effects of a busy computer: few reports, many readings at a time. */
static void release_is_independent_of_the_division_into_reads(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->slack_mm = 12;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    bench->reports_of_100 = 40;
    bench->readings_at_once = 40;
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    if (result.end != WB_SEQUENCE_DONE)
        fail_msg("not released: %s", result.text);
    assert_true(bench->position_mm < 11.25);
    assert_true(bench->position_mm > 9.0);
    assert_int_equal(bench->holds, 0);
}

static void
release_that_meets_the_end_of_the_machine_says_so_and_leaves_the_stage_usable(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 100;
    bench->has_top = true;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 5.6).end, WB_SEQUENCE_DONE);
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_non_null(strstr(result.text, "to the end of the machine"));
    assert_true(result.standing);
    assert_true(bench->position_mm < 0.25);
    assert_int_equal(bench->holds, 0);
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 2.0).end, WB_SEQUENCE_DONE);
}

/* By default it moves at most by the travel of a test, here 12 mm, and gives the remedy. */
static void release_ends_after_the_longest_travel_of_a_test(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 100;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 40.0).end, WB_SEQUENCE_DONE);
    fixture->rig.limits.travel = 12.0 * WB_MM;
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_non_null(strstr(result.text, "moved up by 12.00 mm"));
    assert_non_null(strstr(result.text, "check the strand"));
    assert_close(bench->position_mm, 28.0, 1e-3);
}

/* With reported soft limits the release stops before them and no command is rejected. */
static void release_ends_at_the_soft_limit(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->position_mm = -20.0;
    bench->spring_mg_mm = 100;
    bench->slack_mm = -60;
    bench->has_soft_limits = true;
    bench->soft_travel_mm = 27;
    bench->state = "Hold:0"; /* no replies: its settings arrive later */
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_non_null(strstr(result.text, "moved up by 7.00 mm to the end of the machine"));
    assert_close(bench->position_mm, -27.0, 1e-3);
    const struct wb_stage_job_result jog = run(fixture, WB_STAGE_JOB_JOG, -0.5);
    assert_int_equal(jog.end, WB_SEQUENCE_FAILED);
    assert_non_null(strstr(jog.text, "soft limits, -27 mm to 0"));
    assert_close(bench->position_mm, -27.0, 1e-3);
}

/* A reading that is level far from zero will not change with more travel. */
static void release_ends_soon_when_the_reading_does_not_change(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 0;
    bench->force_mg = 8000;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_non_null(strstr(result.text, "the reading stays at 78.4"));
    assert_close(bench->position_mm, 24.0, 1e-3);
}

/* The clamp jams while the wire is bent: 3.7 g, 36.7 mN on a cell of 20 g. The message must not
 * call the specimen free. */
static void release_of_a_jammed_clamp_does_not_say_free(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 0;
    bench->force_mg = 3740;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    if (!strstr(result.text, "stays at 36.") ||
        !strstr(result.text, "the clamp does not follow the stage"))
        fail_msg("'%s' does not contain the reason", result.text);
    assert_null(strstr(result.text, "free"));
    fixture->zero = (double)NAN;
    result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_non_null(strstr(result.text, "the strand before you touch the specimen"));
}

static void release_may_begin_beyond_the_limits(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 100;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    bench->slack_mm = 10;
    bench->spring_mg_mm = 1400; /* 28 g, 275 mN: beyond the limit of 100 mN, near the 30 g */
    bench->state = "Alarm";
    assert_int_equal(run(fixture, WB_STAGE_JOB_RELEASE, 0.0).end, WB_SEQUENCE_DONE);
    assert_int_equal(bench->holds, 0);
}

static void release_stops_when_moving_up_increases_the_load(void **state)
{
    struct fixture *const fixture = *state;
    struct fake_bench *const bench = fixture->bench;
    bench->spring_mg_mm = 50;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 30.0).end, WB_SEQUENCE_DONE);
    bench->force_mg = 20000;
    bench->spring_mg_mm = -600; /* 2 g now, increasing upwards */
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 0.0);
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
    assert_true(bench->position_mm > 10.0);
}

static void release_reports_when_no_slack_was_found(void **state)
{
    struct fixture *const fixture = *state;
    assert_int_equal(run(fixture, WB_STAGE_JOB_JOG, 15.0).end, WB_SEQUENCE_DONE);
    const struct wb_stage_job_result result = run(fixture, WB_STAGE_JOB_RELEASE, 6.0);
    assert_int_equal(result.end, WB_SEQUENCE_STILL_LOADED);
    assert_close(fixture->bench->position_mm, 9.0, 1e-3);
}

/* --- the load cell's check --- */

/* Runs the program; `hung_mg` are the true masses when it prompts for masses_g. */
static void check(struct fixture *fixture, const double *masses, const int *hung_mg, int n,
                  struct wb_cell_point *points)
{
    struct wb_mass_check *check;
    enum wb_mass_check_phase phase;
    const int empty_mg = fixture->bench->force_mg;
    assert_int_equal(wb_mass_check_open(&check, &fixture->rig, 0.3, masses, n), WB_OK);
    while ((phase = wb_mass_check_step(check, 10 * MS)) < WB_MASS_CHECK_DONE) {
        if (phase != WB_MASS_CHECK_WAITING)
            continue;
        fixture->bench->force_mg = empty_mg + hung_mg[wb_mass_check_index(check)];
        wb_mass_check_confirm(check);
    }
    assert_int_equal(phase, WB_MASS_CHECK_DONE);
    memcpy(points, wb_mass_check_points(check), (size_t)n * sizeof *points);
    wb_mass_check_close(check);
}

static struct wb_cell_deviation check_10_g(struct fixture *fixture, int hung_mg)
{
    struct wb_cell_point points[2];
    check(fixture, (double[]){0.0, 10.0 * WB_G}, (int[]){0, hung_mg}, 2, points);
    return wb_cell_calibration_deviation(&points[0], &points[1], fixture->rig.gravity);
}

static void good_cell_reads_the_mass(void **state)
{
    const struct wb_cell_deviation result = check_10_g(*state, 10000);
    assert_close(result.mass, 10e-3, 6e-6);
    assert_close(result.deviation, result.mass - 10e-3, 1e-15);
    assert_true(result.uncertainty > 0.0 && result.uncertainty < 3e-6);
}

static void cell_error_of_2_percent_is_detected(void **state)
{
    assert_close(check_10_g(*state, 10200).relative, 0.02, 1e-3);
}

static void masses_of_a_series_are_requested_in_turn(void **state)
{
    struct fixture *const fixture = *state;
    static const double masses[] = {0.0, 5e-3, 10e-3, 0.0};
    static const int hung_mg[] = {0, 5000, 10000, 30};
    struct wb_cell_point points[4];
    check(fixture, masses, hung_mg, 4, points);
    for (int i = 0; i < 4; i++) {
        const double read = (points[i].reading - points[0].reading) / fixture->rig.gravity;
        assert_close(points[i].mass, masses[i], 1e-15);
        assert_close(read, 1e-6 * hung_mg[i], 6e-6);
        assert_true(points[i].n >= 10 && points[i].uncertainty > 0.0);
    }
}

/* The mass swings for 2.5 s, longer than the least waiting time: reading begins when it is at rest.
 */
static void swinging_mass_is_waited_for(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_mass_check *check;
    enum wb_mass_check_phase phase;
    int64_t hung_ns = 0, read_ns = 0;
    assert_int_equal(
        wb_mass_check_open(&check, &fixture->rig, 0.3, (double[]){0.0, 10.0 * WB_G}, 2), WB_OK);
    while ((phase = wb_mass_check_step(check, 5 * MS)) < WB_MASS_CHECK_DONE) {
        const int64_t now_ns = wb_time_now_ns();
        if (phase == WB_MASS_CHECK_WAITING) {
            hung_ns = now_ns;
            fixture->bench->force_mg += 10000;
            fixture->bench->swing_mg = 400;
            wb_mass_check_confirm(check);
        } else if (hung_ns != 0 && now_ns - hung_ns > 2500 * MS) {
            fixture->bench->swing_mg = 0;
        }
        if (phase == WB_MASS_CHECK_READING && hung_ns != 0 && read_ns == 0)
            read_ns = now_ns - hung_ns;
    }
    assert_int_equal(phase, WB_MASS_CHECK_DONE);
    assert_true(read_ns >= 2500 * MS);
    const struct wb_cell_point *const points = wb_mass_check_points(check);
    assert_close((points[1].reading - points[0].reading) / fixture->rig.gravity, 10e-3, 6e-6);
    wb_mass_check_close(check);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(jog_moves_by_the_distance_down_and_up),
        TEST(slow_jog_is_reported),
        TEST(jog_stops_at_the_reading_beyond_the_force_limit),
        TEST(jog_beyond_the_travel_is_rejected),
        TEST(jog_of_a_locked_stage_is_rejected_with_the_remedy),
        TEST(stage_reset_by_opening_its_port_is_reported),
        TEST(jog_without_a_reading_is_rejected),
        TEST(ctrl_c_stops_a_jog),
        TEST(home_waits_for_the_end_of_homing),
        TEST(unlock_brings_the_stage_to_idle_from_anything),
        TEST(release_goes_up_until_the_strand_is_slack),
        TEST(release_waits_after_a_lost_reply),
        TEST(release_is_independent_of_the_division_into_reads),
        TEST(release_that_meets_the_end_of_the_machine_says_so_and_leaves_the_stage_usable),
        TEST(release_ends_after_the_longest_travel_of_a_test),
        TEST(release_ends_at_the_soft_limit),
        TEST(release_ends_soon_when_the_reading_does_not_change),
        TEST(release_of_a_jammed_clamp_does_not_say_free),
        TEST(release_may_begin_beyond_the_limits),
        TEST(release_stops_when_moving_up_increases_the_load),
        TEST(release_reports_when_no_slack_was_found),
        TEST(good_cell_reads_the_mass),
        TEST(cell_error_of_2_percent_is_detected),
        TEST(masses_of_a_series_are_requested_in_turn),
        TEST(swinging_mass_is_waited_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
