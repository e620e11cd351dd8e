#include "daq/test/bend_test.h"

#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"
#include "base/version.h"
#include "daq/acquire/silence_check.h"
#include "daq/acquire/stage_check.h"
#include "daq/test/bend_hold.h"
#include "daq/test/bend_recording.h"
#include "daq/test/check_due.h"
#include "daq/test/clamp_watch.h"
#include "daq/test/first_force.h"
#include "daq/test/first_motion.h"
#include "daq/test/force_drop.h"
#include "daq/test/start_check.h"
#include "daq/test/tip_watch.h"

#define WB_LOG_DOMAIN "record"

#define LEAST_READINGS 10 /* of the load cell for a tare */
#define MOST_CHECKS 3     /* start checks before a missing marker ends the test: it may be hidden */
#define CHECK_TIMEOUT_NS (5 * WB_NS_PER_S) /* for the readings and frames of a start check */

enum phase {
    PHASE_CONNECT,
    PHASE_CHECK,
    PHASE_TARE,
    PHASE_DOWN,
    PHASE_DWELL,
    PHASE_UP,
    PHASE_REST,
    PHASE_HELD
};

struct wb_bend_test {
    struct wb_rig rig;                   /* of the rig file; run.rig has the speed of the cycle */
    struct wb_bend_test_request request; /* paths and sink are valid during open only */
    char output_path[WB_PATH], rig_path[WB_PATH];
    struct wb_sequence run;
    struct wb_specimen specimen;
    struct wb_writer *writer;
    int64_t started_ns;
    int cycle;         /* from 1 */
    double later_time; /* s of rig time of the cycles after this one */
    struct wb_start_check check;
    int n_checks;
    struct wb_average zero; /* N, readings of the tare */
    struct wb_tip_watch tip;
    bool motion_agrees; /* the cameras confirmed the first millimetres of travel */
    struct wb_clamp_watch clamp;
    uint64_t reports_followed;
    struct wb_first_force first_force;
    enum wb_first_force_verdict force_verdict;
    bool force_reported;
    struct wb_force_drop force_drop;      /* of the loading of this cycle */
    char force_text[WB_START_CHECK_TEXT]; /* reason of WB_FIRST_FORCE_WRONG */
    bool has_tare;
    struct wb_bend_hold hold;
    struct wb_bend_test_result result;
};

/* Speeds of a stage, m/s. */
static const double slowest = 1e-3 * WB_MM, fastest = 100.0 * WB_MM;

static const struct wb_setting rows[] = {
    {WB_ROW_INTEGER(wb_bend_test_request, cycles, "cycles", 1, 10000, 1),
     WB_ROW_OPTION("cycles", "N", "Number of loading cycles")},
    {WB_ROW_QUANTITY(wb_bend_test_request, travel, "travel_mm", "mm", WB_MM, 0.1, 5000.0, 53.0),
     WB_ROW_OPTION("travel-mm", "D", "Downward travel from the start position")},
    {WB_ROW_QUANTITY(wb_bend_test_request, dwell_time, "dwell_s", "s", 1.0, 0.0, 36000.0, 2.0),
     WB_ROW_OPTION("dwell-s", "S",
                   "Dwell at the turning point, to which calibrate fits the relaxation; 60 for a "
                   "wire whose jacket carries much")},
    {WB_ROW_TEXT(wb_bend_test_request, speeds, "speeds_mm_s"),
     WB_ROW_OPTION("speeds", "V[,V...]", "Speeds of the cycles in turn"),
     .otherwise = "the rig file's", .unit = "mm/s"},
    {WB_ROW_QUANTITY(wb_bend_test_request, hold_most, "hold_most_s", "s", 1.0, 1.0, 86400.0, 600.0),
     WB_ROW_OPTION("hold-most-s", "S", "End a test that is held (key h) for longer")},
};

const struct wb_setting_table wb_bend_test_table = {WB_SETTING_ROWS(rows)};

void wb_bend_test_default_request(struct wb_bend_test_request *request)
{
    memset(request, 0, sizeof *request);
    wb_setting_fill(&wb_bend_test_table, request);
    request->connect_timeout = 6.0;
    request->check_time = 1.0;
    request->tare_time = 2.0;
    request->rest_time = 2.0;
}

/* Converts s of rig time to host time: a virtual rig may run faster. */
static int64_t host_ns(const struct wb_bend_test *test, double rig_seconds)
{
    return wb_ns_from_seconds(rig_seconds / test->run.rig.time_scale);
}

/* --- speeds --- */

/* Parses the speeds, m/s; false if one is not a number in the stage's range. */
static bool read_speeds(const char *text, double speeds[WB_BEND_TEST_MOST_SPEEDS], int *n)
{
    *n = 0;
    for (bool is_more = *text != '\0'; is_more;) {
        char *end;
        const double speed = strtod(text, &end) * WB_MM;
        if (end == text || !(speed >= slowest && speed <= fastest) ||
            *n == WB_BEND_TEST_MOST_SPEEDS || (*end != ',' && *end != '\0'))
            return false;
        speeds[(*n)++] = speed;
        is_more = *end == ',';
        text = end + 1;
    }
    return true;
}

/* Speed of a cycle (counted from 1), m/s; the speeds of the request have been checked. */
static double speed_of(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                       int cycle)
{
    double speeds[WB_BEND_TEST_MOST_SPEEDS];
    int n;
    return read_speeds(request->speeds, speeds, &n) && n > 0 ? speeds[(cycle - 1) % n]
                                                             : rig->stage.speed;
}

double wb_bend_test_cycle_time(const struct wb_bend_test_request *request, const struct wb_rig *rig,
                               int cycle)
{
    return 2.0 * request->travel / speed_of(request, rig, cycle) + request->dwell_time +
           request->rest_time;
}

/* --- ending the test --- */

/* Records the last events. The stage has stopped, or it no longer replies. */
static void finish(struct wb_bend_test *test)
{
    static const char *const why[] = {"running",     "done",         "limit",
                                      "interrupted", "still loaded", "failed"};
    struct wb_bend_test_result *const result = &test->result;
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    result->duration = wb_seconds_from_ns(wb_time_now_ns() - test->started_ns);
    if (latest->has_stage && isfinite(test->run.start_position))
        result->travel = wb_sequence_travel(&test->run, latest->stage.position);
    if (isfinite(result->travel))
        result->displaced = result->started && fabs(result->travel) > WB_SEQUENCE_TOLERANCE;
    else
        result->displaced = result->started;
    wb_acquisition_disarm(test->run.acquisition);
    if (test->run.end == WB_SEQUENCE_DONE)
        wb_acquisition_event(test->run.acquisition, "stop", "done");
    else
        wb_acquisition_event(test->run.acquisition, "stop", "%s: %s", why[test->run.end],
                             test->run.text);
    wb_acquisition_event(test->run.acquisition, "end", "%s", wb_version_revision());
    wb_sequence_enter(&test->run, WB_SEQUENCE_OVER);
}

static double tension_now(const struct wb_bend_test *test)
{
    return wb_acquisition_latest(test->run.acquisition)->load.force - test->result.unloaded;
}

static void step_stop(struct wb_bend_test *test)
{
    const struct wb_stop *const stop = wb_acquisition_stop_state(test->run.acquisition);
    wb_bend_hold_end(&test->hold, &test->run, "stopped", tension_now(test));
    test->result.standing = true;
    if (stop->state != WB_STOP_NONE) {
        if (!wb_stop_over(stop))
            return;
        test->result.standing = stop->state == WB_STOP_STANDING;
        test->result.soft_reset = stop->reset_ns != 0;
        if (stop->hold_ns != 0) {
            const struct wb_interlock *const interlock =
                wb_acquisition_interlock(test->run.acquisition);
            test->result.hold_latency = wb_seconds_from_ns(stop->hold_ns - interlock->t_ns);
            if (test->result.standing)
                test->result.confirm_latency =
                    wb_seconds_from_ns(stop->confirmed_ns - stop->hold_ns);
        }
    }
    finish(test);
}

/* --- connecting --- */

static void give_up_on_silence(struct wb_bend_test *test)
{
    static const enum wb_role order[] = {WB_ROLE_LOAD, WB_ROLE_STAGE, WB_ROLE_MOCAP};
    char text[WB_SILENCE_TEXT];
    for (size_t i = 0; i < WB_COUNT(order); i++) {
        if (wb_silence_check(order[i], wb_acquisition_latest(test->run.acquisition), &test->run.rig,
                             test->request.connect_timeout, text))
            continue;
        wb_sequence_give_up(&test->run, WB_INTERLOCK_STREAM_LOST, "%s", text);
        return;
    }
    wb_sequence_give_up(&test->run, WB_INTERLOCK_STREAM_LOST,
                        "the instruments reply, but not all of them are ready after %g s",
                        test->request.connect_timeout);
}

static bool is_disconnected(const struct wb_bend_test *test, enum wb_role role)
{
    return wb_acquisition_latest(test->run.acquisition)->stream[role].gone;
}

/* --- start check --- */

static void fail_start_check(struct wb_bend_test *test, const char *text)
{
    wb_acquisition_event(test->run.acquisition, "check", "refused: %s", text);
    wb_sequence_give_up(&test->run, WB_INTERLOCK_STAGE, "start check: %s", text);
}

/* Arms the interlock with the start position and, once it is known, the tare. */
static void arm(struct wb_bend_test *test)
{
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &test->run.rig);
    /* The return ends at the start position; the space above it may not be free. */
    settings.rise = 1.0 * WB_MM;
    if (!test->has_tare)
        settings.force = 0.0;
    wb_acquisition_arm(test->run.acquisition, &settings, test->run.start_position);
    wb_acquisition_set_tare(test->run.acquisition, test->result.unloaded);
}

static void step_connect(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    const int64_t allowed_ns =
        wb_ns_from_seconds(test->request.connect_timeout) + test->run.rig.load_cell.settle_ns;
    char text[WB_START_CHECK_TEXT];
    if (is_disconnected(test, WB_ROLE_LOAD))
        wb_sequence_give_up(&test->run, WB_INTERLOCK_STREAM_LOST,
                            "the load cell's port %s was disconnected: check its cable and power",
                            test->run.rig.load_cell.address);
    else if (is_disconnected(test, WB_ROLE_STAGE))
        wb_sequence_give_up(&test->run, WB_INTERLOCK_STREAM_LOST,
                            "the stage's port %s was disconnected: check its cable and power",
                            test->run.rig.stage.address);
    else if (latest->storage.failing != WB_OK)
        wb_sequence_give_up(&test->run, WB_INTERLOCK_DISK,
                            "the recording cannot be written: see the previous message");
    else if (!wb_start_check_unit(latest->unit_contradicts, &test->run.rig, test->rig_path, text)) {
        /* Checked before the first valid reading: with kg read as g, all may be out of range. */
        test->result.recorded = true;
        fail_start_check(test, text);
    } else if (latest->has_load && latest->has_mocap && latest->has_stage &&
               latest->stream[WB_ROLE_MOCAP].ready && latest->stream[WB_ROLE_LOAD].ready &&
               latest->stream[WB_ROLE_STAGE].ready) {
        test->result.recorded = true;
        /* Checked before the interlock is armed: this message is more specific. */
        if (!wb_start_check_stage(&latest->stage, test->rig_path, text)) {
            fail_start_check(test, text);
            return;
        }
        arm(test);
        wb_sequence_enter(&test->run, PHASE_CHECK);
    } else if (wb_sequence_lasts_ns(&test->run) > allowed_ns) {
        give_up_on_silence(test);
    }
}

/* Whether the settings of the stage's firmware allow the whole test. */
static bool check_settings(const struct wb_bend_test *test, char text[WB_START_CHECK_TEXT])
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    struct wb_rig fastest_cycle = test->rig;
    for (int cycle = 1; cycle <= test->request.cycles && cycle <= WB_BEND_TEST_MOST_SPEEDS; cycle++)
        fastest_cycle.stage.speed = fmax(cycle == 1 ? 0.0 : fastest_cycle.stage.speed,
                                         speed_of(&test->request, &test->rig, cycle));
    return !latest->has_settings ||
           wb_stage_check_test(&latest->settings, &fastest_cycle, latest->stage.position,
                               test->request.travel, text);
}

static void step_check(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    const struct wb_start_check *const check = &test->check;
    const int64_t waited_ns = wb_sequence_lasts_ns(&test->run);
    const bool enough = wb_start_check_enough(check);
    char text[WB_START_CHECK_TEXT];
    if (waited_ns < host_ns(test, test->request.check_time) ||
        (!enough && waited_ns < CHECK_TIMEOUT_NS))
        return;
    if (!enough)
        snprintf(text, sizeof text,
                 "only %" PRId64
                 " readings of the load cell and %d frames of the cameras arrived in %.1f "
                 "s: at least 10 of each are needed",
                 check->load.n, check->n_frames, wb_seconds_from_ns(waited_ns));
    if (enough && !wb_start_check_markers(check, &test->specimen, text) &&
        ++test->n_checks < MOST_CHECKS) {
        test->check = (struct wb_start_check){0};
        wb_sequence_enter(&test->run, PHASE_CHECK);
        return;
    }
    if (!enough || !wb_start_check_stage(&latest->stage, test->rig_path, text) ||
        !check_settings(test, text) || !wb_start_check_markers(check, &test->specimen, text) ||
        !wb_start_check_chain(check, &test->specimen, &test->run.rig, text) ||
        !wb_start_check_zero(check, &test->run.rig, test->rig_path, text)) {
        fail_start_check(test, text);
        return;
    }
    /* During a test a failing disk is tolerated for a while; a test is not started on one. */
    if (latest->storage.failing != WB_OK) {
        fail_start_check(test, "nothing can be written to the disk: see the previous message");
        return;
    }
    test->run.start_position = latest->stage.position;
    wb_acquisition_event(test->run.acquisition, "check",
                         "passed: %d markers seen, zero %.3f mN, noise %.4f mN, travel %g mm free",
                         test->specimen.n_markers, check->load.mean / WB_MN,
                         wb_average_deviation(&check->load) / WB_MN, test->request.travel / WB_MM);
    arm(test);
    wb_sequence_enter(&test->run, PHASE_TARE);
}

/* --- tare and cycles --- */

/* True once the current motion has ended at its target; ends the test if the motion fails. */
static bool arrived(struct wb_bend_test *test)
{
    char text[80];
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    if (latest->stage_reports == test->run.reports_seen) {
        if (wb_sequence_lasts_ns(&test->run) > test->run.allowed_ns)
            wb_sequence_give_up(
                &test->run, WB_INTERLOCK_STAGE,
                "the stage did not reach %.2f mm in time: check that nothing blocks it",
                test->run.target / WB_MM);
        return false;
    }
    test->run.reports_seen = latest->stage_reports;
    const double travel = wb_sequence_travel(&test->run, latest->stage.position);
    if (latest->stage.state != WB_STAGE_IDLE) {
        test->run.idle_reports = 0;
        if (wb_sequence_lasts_ns(&test->run) > test->run.allowed_ns)
            wb_sequence_give_up(&test->run, WB_INTERLOCK_STAGE,
                                "the stage is at %.2f mm and did not reach %.2f mm in time: "
                                "check that nothing blocks it",
                                travel / WB_MM, test->run.target / WB_MM);
        return false;
    }
    if (fabs(travel - test->run.target) <= WB_SEQUENCE_TOLERANCE) {
        wb_acquisition_motion_ended(test->run.acquisition);
        if (wb_sequence_note_speed(&test->run, text, sizeof text))
            wb_warn("the stage moved %s: check its feed override and whether it stalls", text);
        return true;
    }
    /* The first idle reports may be older than the command. */
    test->run.idle_reports++;
    const bool refused = latest->stage_error[0] && test->run.idle_reports >= 2;
    if (!refused && (test->run.idle_reports < 5 || wb_sequence_lasts_ns(&test->run) <= WB_NS_PER_S))
        return false;
    /* The stage has stopped already; a feed hold would have to be released again. */
    wb_acquisition_motion_ended(test->run.acquisition);
    wb_sequence_give_up(&test->run, WB_INTERLOCK_STAGE,
                        "the stage stopped at %.2f mm instead of %.2f mm%s%s", travel / WB_MM,
                        test->run.target / WB_MM, refused ? ": " : "",
                        refused ? latest->stage_error : "");
    return false;
}

/* The force drop is judged against the peak of this loading only. */
static void restart_drop_watch(struct wb_bend_test *test)
{
    test->force_drop = (struct wb_force_drop){.noise = test->first_force.noise,
                                              .share = test->run.rig.limits.force_drop};
}

static double later_time(const struct wb_bend_test *test)
{
    double time = 0.0;
    for (int cycle = (test->cycle > 0 ? test->cycle : 1) + 1; cycle <= test->request.cycles;
         cycle++)
        time += wb_bend_test_cycle_time(&test->request, &test->rig, cycle);
    return time;
}

static void begin_cycle(struct wb_bend_test *test)
{
    test->cycle++;
    test->later_time = later_time(test);
    test->run.rig.stage.speed = speed_of(&test->request, &test->rig, test->cycle);
    test->result.started = true;
    restart_drop_watch(test);
    wb_acquisition_event(test->run.acquisition, "cycle_start", "%d", test->cycle);
    wb_sequence_jog_to(&test->run, test->request.travel, test->run.rig.stage.speed, PHASE_DOWN);
}

static void step_tare(struct wb_bend_test *test)
{
    if (wb_sequence_lasts_ns(&test->run) < host_ns(test, test->request.tare_time) ||
        test->zero.n < LEAST_READINGS)
        return;
    test->result.tare = test->zero.mean;
    test->result.unloaded = test->result.tare - wb_rig_tare_load(&test->run.rig);
    test->has_tare = true;
    wb_acquisition_event(test->run.acquisition, "tare",
                         "{\"force_N\": %.17g, \"samples\": %" PRId64 ", \"sd_N\": %.17g}",
                         test->result.tare, test->zero.n, wb_average_deviation(&test->zero));
    test->run.rig.stage.speed = speed_of(&test->request, &test->rig, 1);
    arm(test);
    wb_first_force_begin(&test->first_force, wb_average_deviation(&test->zero), &test->run.rig);
    begin_cycle(test);
}

/* m that the stage may travel between its last report and a frame: half a second at its speed. */
static double position_uncertainty(const struct wb_bend_test *test)
{
    const struct wb_rig *const rig = &test->run.rig;
    return 0.5 * rig->stage.speed * fmax(rig->time_scale, 1.0);
}

static void check_motion(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    const double travel = wb_sequence_travel(&test->run, latest->stage.position);
    const double ahead = position_uncertainty(test);
    char text[WB_START_CHECK_TEXT];
    if (test->motion_agrees || !(travel >= WB_FIRST_MOTION))
        return;
    test->motion_agrees = wb_first_motion_agrees(&test->tip, travel, ahead, &test->run.rig, text);
    if (test->motion_agrees)
        wb_acquisition_event(test->run.acquisition, "first_motion",
                             "the markers moved with the stage, at %.2f mm of travel",
                             travel / WB_MM);
    else if (travel >= WB_FIRST_MOTION + ahead)
        wb_sequence_give_up(&test->run, WB_INTERLOCK_MOTION, "%s", text);
}

/* Compares clamp and stage at each report, once the first motion has agreed. */
static void check_clamp(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    char text[WB_START_CHECK_TEXT];
    if (!test->motion_agrees || latest->stage_reports == test->reports_followed)
        return;
    test->reports_followed = latest->stage_reports;
    if (wb_clamp_watch_add(&test->clamp, &test->tip, latest->stage.t_ns,
                           wb_sequence_travel(&test->run, latest->stage.position),
                           position_uncertainty(test), text))
        wb_sequence_give_up(&test->run, WB_INTERLOCK_MOTION, "%s", text);
}

/* Reports the verdict that on_load() has found. */
static void check_force(struct wb_bend_test *test)
{
    const enum wb_first_force_verdict verdict = test->force_verdict;
    if (test->force_reported || verdict == WB_FIRST_FORCE_OPEN)
        return;
    test->force_reported = true;
    if (verdict == WB_FIRST_FORCE_WRONG)
        wb_sequence_give_up(&test->run, WB_INTERLOCK_MOTION, "%s", test->force_text);
    else
        wb_acquisition_event(test->run.acquisition, "first_force",
                             "the force rises by %.4g mN per mm of deflection, taut at %.2f mm",
                             wb_first_force_slope(&test->first_force) / (WB_MN / WB_MM),
                             test->first_force.taut / WB_MM);
}

static void begin_unloading(struct wb_bend_test *test)
{
    wb_acquisition_event(test->run.acquisition, "turn", "%d", test->cycle);
    wb_sequence_jog_to(&test->run, 0.0, test->run.rig.stage.speed, PHASE_UP);
}

static void step_down(struct wb_bend_test *test)
{
    check_motion(test);
    if (test->run.phase == PHASE_DOWN)
        check_force(test);
    if (test->run.phase == PHASE_DOWN)
        check_clamp(test);
    if (test->run.phase == PHASE_DOWN && arrived(test))
        wb_sequence_enter(&test->run, PHASE_DWELL);
}

/* While the load cell is disconnected, the dwell restarts, as the rest does. */
static void step_dwell(struct wb_bend_test *test)
{
    if (is_disconnected(test, WB_ROLE_LOAD))
        wb_sequence_enter(&test->run, PHASE_DWELL);
    if (wb_sequence_lasts_ns(&test->run) >= host_ns(test, test->request.dwell_time))
        begin_unloading(test);
}

static void step_up(struct wb_bend_test *test)
{
    check_clamp(test);
    if (test->run.phase == PHASE_UP && arrived(test))
        wb_sequence_enter(&test->run, PHASE_REST);
}

static void step_rest(struct wb_bend_test *test)
{
    /* While the load cell is disconnected, the rest restarts (the interlock ends the test if the
     * cell stays silent). Thus the rest is recorded in full, and readings that were delayed in the
     * port are read before the next loading, where a force of the unloading would look like a
     * break. */
    if (is_disconnected(test, WB_ROLE_LOAD))
        wb_sequence_enter(&test->run, PHASE_REST);
    if (wb_sequence_lasts_ns(&test->run) < host_ns(test, test->request.rest_time))
        return;
    wb_acquisition_event(test->run.acquisition, "cycle_end", "%d", test->cycle);
    test->result.cycles_done = test->cycle;
    if (test->cycle < test->request.cycles) {
        begin_cycle(test);
        return;
    }
    wb_sequence_set_end(&test->run, WB_SEQUENCE_DONE, "%d of %d cycles", test->cycle,
                        test->request.cycles);
    test->result.standing = true;
    finish(test);
}

/* --- hold and resume --- */

static void step_held(struct wb_bend_test *test)
{
    wb_bend_hold_step(&test->hold, &test->run, test->request.hold_most);
}

static const struct {
    const char *name;
    void (*step)(struct wb_bend_test *test);
} phases[] = {
    [PHASE_CONNECT] = {"connecting", step_connect},
    [PHASE_CHECK] = {"check", step_check},
    [PHASE_TARE] = {"tare", step_tare},
    [PHASE_DOWN] = {"down", step_down},
    [PHASE_DWELL] = {"dwell", step_dwell},
    [PHASE_UP] = {"up", step_up},
    [PHASE_REST] = {"rest", step_rest},
    [PHASE_HELD] = {"held", step_held},
    [WB_SEQUENCE_STOP] = {"stopping", step_stop},
    [WB_SEQUENCE_OVER] = {"end", NULL},
};

bool wb_bend_test_hold(struct wb_bend_test *test)
{
    const int phase = test->run.phase;
    if (phase != PHASE_DOWN && phase != PHASE_DWELL && phase != PHASE_UP && phase != PHASE_REST)
        return false;
    wb_bend_hold_begin(&test->hold, &test->run, PHASE_HELD, phases[phase].name, test->cycle,
                       tension_now(test));
    return true;
}

/* The wire has relaxed during the hold: checks that use its force restart. */
static void resume_loading(struct wb_bend_test *test)
{
    restart_drop_watch(test);
    if (test->force_verdict == WB_FIRST_FORCE_OPEN)
        wb_first_force_begin(&test->first_force, wb_average_deviation(&test->zero), &test->run.rig);
}

bool wb_bend_test_resume(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    const int phase = test->hold.phase;
    if (test->run.phase != PHASE_HELD || !test->hold.stands)
        return false;
    wb_bend_hold_end(&test->hold, &test->run, "resumed", tension_now(test));
    const double left = test->run.target - wb_sequence_travel(&test->run, latest->stage.position);
    const bool is_there = fabs(left) <= WB_SEQUENCE_TOLERANCE;
    if (phase == PHASE_DOWN)
        resume_loading(test);
    if (phase == PHASE_REST || (phase == PHASE_UP && is_there))
        wb_sequence_enter(&test->run, PHASE_REST);
    else if (is_there)
        wb_sequence_enter(&test->run, PHASE_DWELL);
    else
        wb_sequence_jog_to(&test->run, test->run.target, test->run.rig.stage.speed, phase);
    return true;
}

/* --- samples --- */

/* Stops the stage at once, at the reading that shows a break or slip. */
static void watch_drop(struct wb_bend_test *test, const struct wb_load_sample *sample)
{
    char text[WB_START_CHECK_TEXT];
    if (wb_force_drop_add(&test->force_drop, sample->force - test->result.unloaded, text))
        wb_acquisition_stop(test->run.acquisition, WB_INTERLOCK_DROP, text);
}

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_bend_test *const test = context;
    if (sample->valid && test->run.phase == PHASE_CHECK)
        wb_average_add(&test->check.load, sample->force);
    if (sample->valid && test->run.phase == PHASE_TARE)
        wb_average_add(&test->zero, sample->force);
    if (sample->valid && test->result.started && test->run.phase < WB_SEQUENCE_STOP)
        test->result.peak_tension =
            fmax(test->result.peak_tension, sample->force - test->result.unloaded);
    if (sample->valid && test->run.phase == PHASE_DOWN)
        watch_drop(test, sample);
    if (sample->valid && test->run.phase == PHASE_DOWN && test->tip.settled &&
        test->force_verdict == WB_FIRST_FORCE_OPEN)
        test->force_verdict = wb_first_force_add(&test->first_force, test->tip.deflection,
                                                 sample->force - test->zero.mean,
                                                 &test->request.stiffness, test->force_text);
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_bend_test *const test = context;
    if (test->run.phase == PHASE_CHECK)
        wb_start_check_frame(&test->check, frame, &test->specimen);
    if (test->run.phase == PHASE_TARE)
        wb_tip_watch_rest(&test->tip, frame, &test->specimen, test->run.rig.mocap.up);
    else if (test->run.phase > PHASE_TARE)
        wb_tip_watch_follow(&test->tip, frame);
}

/* --- opening --- */

enum wb_status wb_bend_test_check_request(const struct wb_bend_test_request *request,
                                          const struct wb_rig *rig, struct wb_reason *why)
{
    const double travel = request->travel;
    const double limit = rig->limits.travel > 0.0 ? rig->limits.travel : rig->stage.travel;
    if (request->cycles < 1)
        return wb_fail_to(why, WB_ERR_ARGUMENT, "cycles: expected at least 1, not %d (--cycles)",
                          request->cycles);
    double speeds[WB_BEND_TEST_MOST_SPEEDS];
    int n;
    if (!read_speeds(request->speeds, speeds, &n))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "speeds: expected up to %d numbers from %g to %g mm/s, separated by "
                          "commas, not '%s' (--speeds)",
                          WB_BEND_TEST_MOST_SPEEDS, slowest / WB_MM, fastest / WB_MM,
                          request->speeds);
    if (!(travel > 0.0) || !(travel <= limit))
        return wb_fail_to(why, WB_ERR_ARGUMENT,
                          "travel: expected more than 0 and at most the %g mm that the rig file "
                          "allows (stage.travel_mm, limits.travel_mm), not %g mm (--travel-mm)",
                          limit / WB_MM, travel / WB_MM);
    return WB_OK;
}

enum wb_status wb_bend_test_rig(const struct wb_bend_test_request *request, struct wb_rig *rig)
{
    if (request->rig_text)
        return wb_rig_parse(request->rig_text, request->rig_path, rig, NULL);
    return wb_rig_read(request->rig_path, rig);
}

enum wb_status wb_bend_test_specimen(const struct wb_bend_test_request *request,
                                     struct wb_specimen *specimen)
{
    if (request->specimen_text)
        return wb_specimen_parse(request->specimen_text, request->specimen_path, specimen, NULL);
    return wb_specimen_read(request->specimen_path, specimen);
}

/* Warns, or fails, if the last check of the load cell is too old. */
static enum wb_status check_cell(const struct wb_rig *rig, const char *rig_path)
{
    char text[WB_CHECK_DUE_TEXT];
    switch (wb_check_due(&rig->load_cell, rig_path, wb_time_utc(), text)) {
    case WB_CHECK_DUE_TOO_LATE:
        return wb_fail(WB_ERR_ARGUMENT, "%s", text);
    case WB_CHECK_DUE_LATE:
        wb_warn("%s", text);
        return WB_OK;
    default:
        return WB_OK;
    }
}

static enum wb_status start(struct wb_bend_test *test, const struct wb_bend_test_request *request)
{
    WB_TRY(wb_bend_test_rig(request, &test->run.rig));
    test->rig = test->run.rig;
    WB_TRY(wb_bend_test_specimen(request, &test->specimen));
    WB_TRY(wb_bend_test_check_request(&test->request, &test->run.rig, NULL));
    if (!request->rig_text)
        WB_TRY(check_cell(&test->run.rig, request->rig_path));
    if (wb_file_exists(request->output_path))
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists: recordings are never overwritten; choose another name",
                       request->output_path);
    const struct wb_sink sink = {.context = test, .load = on_load, .mocap = on_mocap};
    WB_TRY(wb_acquisition_open(&test->run.acquisition, &test->run.rig, WB_ACQUISITION_ALL, &sink));
    wb_acquisition_add_sink(test->run.acquisition, &request->sink);
    test->started_ns = wb_time_now_ns();
    const struct wb_bend_recording description = {
        .path = request->output_path,
        .rig_path = request->rig_path,
        .rig_text = request->rig_text,
        .specimen_path = request->specimen_path,
        .specimen_text = request->specimen_text,
        .rig = &test->run.rig,
        .specimen = &test->specimen,
        .operator_name = request->operator_name,
        .notes = request->notes,
        .cycles = request->cycles,
        .travel = request->travel,
        .dwell = request->dwell_time,
        .speeds = request->speeds,
        .monotonic_start_ns = test->started_ns,
    };
    struct wb_recording *recording;
    WB_TRY(wb_bend_recording_create(&recording, &description));
    const enum wb_status status = wb_writer_start(&test->writer, recording, request->writer);
    if (status != WB_OK) {
        if (wb_recording_close(recording) != WB_OK)
            wb_debug("the unused recording could not be closed cleanly");
        unlink(request->output_path);
        return status;
    }
    snprintf(test->output_path, sizeof test->output_path, "%s", request->output_path);
    snprintf(test->rig_path, sizeof test->rig_path, "%s", request->rig_path);
    wb_acquisition_start(test->run.acquisition, test->writer);
    wb_acquisition_event(test->run.acquisition, "start", "%s", wb_version_revision());
    return WB_OK;
}

enum wb_status wb_bend_test_open(struct wb_bend_test **out,
                                 const struct wb_bend_test_request *request)
{
    struct wb_bend_test *const test = calloc(1, sizeof *test);
    if (!test)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the test");
    test->request = *request;
    test->result.hold_latency = test->result.confirm_latency = (double)NAN;
    test->run.start_position = (double)NAN;
    test->run.remedy = "";
    const enum wb_status status = start(test, request);
    if (status != WB_OK) {
        wb_acquisition_close(test->run.acquisition);
        free(test);
        return status;
    }
    test->later_time = later_time(test);
    wb_sequence_enter(&test->run, PHASE_CONNECT);
    test->result.is_virtual = test->run.rig.is_virtual;
    *out = test;
    return WB_OK;
}

/* --- the loop --- */

enum wb_sequence_end wb_bend_test_step(struct wb_bend_test *test, int64_t timeout_ns)
{
    if (test->run.phase == WB_SEQUENCE_OVER)
        return test->run.end;
    if (!wb_sequence_wait(&test->run, timeout_ns, test->result.started))
        return WB_SEQUENCE_RUNNING;
    phases[test->run.phase].step(test);
    return test->run.phase == WB_SEQUENCE_OVER ? test->run.end : WB_SEQUENCE_RUNNING;
}

void wb_bend_test_mark(struct wb_bend_test *test, const char *text)
{
    if (test->run.phase != WB_SEQUENCE_OVER)
        wb_acquisition_event(test->run.acquisition, "mark", "%s", text);
}

void wb_bend_test_stop(struct wb_bend_test *test)
{
    if (test->run.phase < WB_SEQUENCE_STOP)
        wb_sequence_give_up(&test->run, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
}

/* s of host time left for this cycle and those after it. The acceleration of the stage, some tenths
 * of a second at each end, is neglected. */
static double time_left(const struct wb_bend_test *test, double travel)
{
    const struct wb_bend_test_request *const request = &test->request;
    const double way = request->travel / test->run.rig.stage.speed;
    const double dwell = request->dwell_time;
    const double here = travel / test->run.rig.stage.speed;
    const bool is_held = test->run.phase == PHASE_HELD;
    const int phase = is_held ? test->hold.phase : test->run.phase;
    const double spent = is_held ? 0.0
                                 : wb_seconds_from_ns(wb_sequence_lasts_ns(&test->run)) *
                                       test->run.rig.time_scale; /* in this phase */
    double left = test->later_time;
    if (test->run.end != WB_SEQUENCE_RUNNING || test->run.phase == WB_SEQUENCE_OVER)
        return 0.0;
    if (phase == PHASE_UP)
        left += fmax(here, 0.0) + request->rest_time;
    else if (phase == PHASE_REST)
        left += fmax(request->rest_time - spent, 0.0);
    else if (phase == PHASE_DWELL)
        left += fmax(dwell - spent, 0.0) + way + request->rest_time;
    else
        left += fmax(way - here, 0.0) + dwell + way + request->rest_time;
    if (phase == PHASE_TARE)
        left += fmax(request->tare_time - spent, 0.0);
    return left / test->run.rig.time_scale;
}

void wb_bend_test_status(const struct wb_bend_test *test, struct wb_bend_test_status *status)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    memset(status, 0, sizeof *status);
    status->phase = phases[test->run.phase].name;
    status->cycle = test->cycle;
    status->cycles = test->request.cycles;
    status->has_tension = latest->has_load;
    status->tension = latest->load.force - test->result.unloaded;
    status->has_travel =
        latest->has_stage && isfinite(test->run.start_position) && isfinite(latest->stage.position);
    if (status->has_travel)
        status->travel = wb_sequence_travel(&test->run, latest->stage.position);
    status->has_deflection = test->tip.settled;
    status->deflection = test->tip.deflection;
    status->elapsed = wb_seconds_from_ns(wb_time_now_ns() - test->started_ns);
    status->gravity = test->run.rig.gravity;
    status->markers_expected = test->specimen.n_markers;
    status->is_virtual = test->run.rig.is_virtual;
    status->is_connected = test->result.recorded;
    status->is_standing = test->run.phase != WB_SEQUENCE_OVER || test->result.standing;
    status->end = test->run.end;
    status->end_text = test->run.text;
    status->peak_tension = test->result.peak_tension;
    status->time_left = status->has_travel ? time_left(test, status->travel) : (double)NAN;
    status->held = wb_bend_hold_lasts(&test->hold);
    status->hold_left = test->request.hold_most - status->held;
    status->hold_stands = test->hold.is_on && test->hold.stands;
    status->latest = latest;
}

/* --- closing --- */

static void stop_first(struct wb_bend_test *test)
{
    if (test->run.phase == WB_SEQUENCE_OVER)
        return;
    wb_bend_test_stop(test);
    while (wb_bend_test_step(test, 10 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
    }
}

enum wb_status wb_bend_test_close(struct wb_bend_test *test, struct wb_bend_test_result *result)
{
    if (!test)
        return WB_OK;
    stop_first(test);
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->run.acquisition);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        test->result.samples[role] = latest->stream[role].samples;
        test->result.bytes += latest->stream[role].bytes;
        test->result.drops += latest->stream[role].drops;
        test->result.loss[role] = latest->stream[role].loss;
        test->result.is_losing[role] = latest->stream[role].is_losing;
    }
    wb_acquisition_close(test->run.acquisition);
    const enum wb_status status = wb_writer_finish(test->writer);
    if (!test->result.recorded)
        unlink(test->output_path);
    test->result.holds = test->hold.n;
    test->result.held = test->hold.total;
    test->result.end = test->run.end;
    memcpy(test->result.text, test->run.text, sizeof test->result.text);
    if (result)
        *result = test->result;
    free(test);
    return status;
}
