#include "daq/bend_test.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/interrupt.h"
#include "base/units.h"
#include "base/version.h"
#include "daq/bend_recording.h"
#include "daq/start_check.h"
#include "daq/tip_watch.h"

#define WB_LOG_DOMAIN "record"

#define LEAST_READINGS 10 /* of a tare */
/* An earlier line that is not answered keeps a motion waiting; the driver stops waiting after 2 s.
 */
#define SEND_NS (4 * WB_NS_PER_S)

#define CHECK_TIMEOUT_NS (5 * WB_NS_PER_S)

/* The stage is where it should be within this, m. */
#define POSITION_TOLERANCE (0.05 * WB_MM)

enum phase {
    PHASE_CONNECT,
    PHASE_CHECK,
    PHASE_TARE,
    PHASE_DOWN,
    PHASE_UP,
    PHASE_REST,
    PHASE_STOP,
    PHASE_END
};

struct wb_bend_test {
    struct wb_bend_test_request request; /* its paths are not kept beyond open */
    char output_path[WB_PATH], rig_path[WB_PATH];
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_acquisition *acquisition;
    struct wb_writer *writer;
    enum phase phase;
    int64_t started_ns;
    int64_t heard_ns;      /* begin of the phase, on the clock that stands while nobody listens */
    int64_t allowed_ns;    /* for the motion, on that clock */
    int cycle;             /* from 1 */
    double start_position; /* m, machine */
    double target;         /* m travel of the motion under way */
    bool unsent;           /* the stage has not taken its command yet */
    double turn_travel;    /* largest reached in this cycle */
    uint64_t reports_seen; /* stage reports looked at */
    uint64_t stands_since; /* reports in a row that show it standing elsewhere */
    struct wb_start_check check;
    struct wb_average zero; /* N, of the tare */
    struct wb_tip_watch tip;
    bool has_tare;
    double tare;     /* N, mean reading of the tare */
    double unloaded; /* N, reading without tension: the tare less what hung on the cell then */
    int64_t duration_ns;
    double hold_latency, confirm_latency; /* s; NaN without a hold */
    struct wb_bend_test_result result;
};

static const char *const phase_names[] = {"connecting", "check", "tare",     "down",
                                          "up",         "rest",  "stopping", "end"};

static const struct wb_setting rows[] = {
    {.name = "cycles",
     .type = WB_SETTING_INTEGER,
     .offset = offsetof(struct wb_bend_test_request, cycles),
     .least = 1,
     .largest = 10000,
     .fallback = 1,
     .option = "cycles",
     .argument = "N",
     .help = "Times down and back"},
    {.name = "travel_mm",
     .unit = "mm",
     .type = WB_SETTING_NUMBER,
     .offset = offsetof(struct wb_bend_test_request, travel),
     .scale = WB_MM,
     .least = 0.1,
     .largest = 5000.0,
     .fallback = 53.0,
     .option = "travel-mm",
     .argument = "D",
     .help = "How far down from the start position"},
};

const struct wb_setting_table wb_bend_test_table = {.rows = rows, .n = WB_COUNT(rows)};

void wb_bend_test_default_request(struct wb_bend_test_request *request)
{
    memset(request, 0, sizeof *request);
    wb_setting_fill(&wb_bend_test_table, request);
    request->connect_timeout = 6.0;
    request->check_time = 1.0;
    request->tare_time = 2.0;
    request->rest_time = 2.0;
}

/* Rig time in s as host time: a virtual rig may run faster. */
static int64_t host_ns(const struct wb_bend_test *test, double rig_seconds)
{
    return wb_ns_from_seconds(rig_seconds / test->rig.time_scale);
}

/* m down from the start position, of a machine position. */
static double travel_of(const struct wb_bend_test *test, double position)
{
    return test->rig.stage.down * (position - test->start_position);
}

/* --- every way out --- */

static void set_end(struct wb_bend_test *test, enum wb_bend_test_end end, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void give_up(struct wb_bend_test *test, enum wb_interlock_reason reason, const char *format,
                    ...) __attribute__((format(printf, 3, 4)));

static void enter(struct wb_bend_test *test, enum phase phase)
{
    test->phase = phase;
    test->heard_ns = wb_acquisition_heard_ns(test->acquisition);
}

/* How long the phase lasts, without the time in which this process was kept from listening: an
 * instrument is not blamed for that. */
static int64_t lasts_ns(const struct wb_bend_test *test)
{
    return wb_acquisition_heard_ns(test->acquisition) - test->heard_ns;
}

/* How it ended; the first end stays. */
static void set_end(struct wb_bend_test *test, enum wb_bend_test_end end, const char *format, ...)
{
    if (test->result.end != WB_BEND_TEST_RUNNING)
        return;
    test->result.end = end;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(test->result.text, sizeof test->result.text, format, arguments);
    va_end(arguments);
}

/* The last events. Nothing moves any more, or nobody listens. */
static void finish(struct wb_bend_test *test)
{
    static const char *const why[] = {"running", "done", "limit", "interrupted", "failed"};
    struct wb_bend_test_result *const result = &test->result;
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    test->duration_ns = wb_acquisition_now_ns() - test->started_ns;
    if (latest->has_stage && isfinite(test->start_position))
        result->travel = travel_of(test, latest->stage.position);
    if (isfinite(result->travel))
        result->displaced = result->started && fabs(result->travel) > POSITION_TOLERANCE;
    else
        result->displaced = result->started;
    wb_acquisition_disarm(test->acquisition);
    if (result->end == WB_BEND_TEST_DONE)
        wb_acquisition_event(test->acquisition, "stop", "done");
    else
        wb_acquisition_event(test->acquisition, "stop", "%s: %s", why[result->end], result->text);
    wb_acquisition_event(test->acquisition, "end", "%s", wb_version_revision());
    enter(test, PHASE_END);
}

/* Ends the test: stops the stage if it may be moving, else ends right away. */
static void give_up(struct wb_bend_test *test, enum wb_interlock_reason reason, const char *format,
                    ...)
{
    char text[WB_INTERLOCK_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (wb_acquisition_moving(test->acquisition))
        wb_acquisition_stop(test->acquisition, reason, text);
    set_end(test, reason == WB_INTERLOCK_INTERRUPT ? WB_BEND_TEST_INTERRUPTED : WB_BEND_TEST_FAILED,
            "%s", text);
    enter(test, PHASE_STOP);
}

/* The interlock tripped by itself; the hold byte has already left. */
static void note_trip(struct wb_bend_test *test)
{
    const struct wb_interlock *const interlock = wb_acquisition_interlock(test->acquisition);
    if (interlock->reason == WB_INTERLOCK_NONE || test->phase >= PHASE_STOP)
        return;
    enum wb_bend_test_end end = WB_BEND_TEST_LIMIT;
    if (interlock->reason == WB_INTERLOCK_INTERRUPT)
        end = WB_BEND_TEST_INTERRUPTED;
    else if (!test->result.started || interlock->reason == WB_INTERLOCK_DISK)
        end = WB_BEND_TEST_FAILED;
    set_end(test, end, "%s", interlock->text);
    enter(test, PHASE_STOP);
}

static void step_stop(struct wb_bend_test *test)
{
    const struct wb_stop *const stop = wb_acquisition_stop_state(test->acquisition);
    test->result.standing = true;
    if (stop->state != WB_STOP_NONE) {
        if (!wb_stop_over(stop))
            return;
        test->result.standing = stop->state == WB_STOP_STANDING;
        test->result.soft_reset = stop->reset_ns != 0;
        if (stop->hold_ns != 0) {
            const struct wb_interlock *const interlock =
                wb_acquisition_interlock(test->acquisition);
            test->hold_latency = wb_seconds_from_ns(stop->hold_ns - interlock->t_ns);
            if (test->result.standing)
                test->confirm_latency = wb_seconds_from_ns(stop->confirmed_ns - stop->hold_ns);
        }
    }
    finish(test);
}

/* --- connecting --- */

static void complain_silence(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const double waited = test->request.connect_timeout;
    const struct wb_acquisition_stream_state *const load = &latest->stream[WB_ROLE_LOAD];
    const struct wb_acquisition_stream_state *const mocap = &latest->stream[WB_ROLE_MOCAP];
    const struct wb_acquisition_stream_state *const stage = &latest->stream[WB_ROLE_STAGE];
    if (!latest->has_load && load->bytes > 0)
        give_up(test, WB_INTERLOCK_STREAM_LOST,
                "the load cell at %s sent %" PRIu64 " bytes, but no reading that can be decoded: "
                "check load_cell.protocol, its line settings and its unit",
                test->rig.load_cell.address, load->bytes);
    else if (!latest->has_load)
        give_up(test, WB_INTERLOCK_STREAM_LOST,
                "the load cell at %s sent nothing within %g s: check power, cable and baud rate",
                test->rig.load_cell.address, waited);
    else if (!latest->has_stage)
        give_up(test, WB_INTERLOCK_STREAM_LOST,
                "the stage at %s gave no status within %g s (%" PRIu64
                " bytes came): check power, cable and stage.protocol",
                test->rig.stage.address, waited, stage->bytes);
    else if (mocap->bytes == 0)
        give_up(test, WB_INTERLOCK_STREAM_LOST,
                "no NatNet answer from %s within %g s: check that the server streams, its address "
                "and the firewall of its computer",
                test->rig.mocap.address, waited);
    else
        give_up(test, WB_INTERLOCK_STREAM_LOST,
                "the NatNet server at %s answers but sent no frame within %g s: check that it "
                "streams live frames with labelled markers%s",
                test->rig.mocap.address, waited,
                strstr(test->rig.mocap.address, "group=") ? ", and its multicast group" : "");
}

static bool gone(const struct wb_bend_test *test, enum wb_role role)
{
    return wb_acquisition_latest(test->acquisition)->stream[role].gone;
}

/* --- start check --- */

static void refuse(struct wb_bend_test *test, const char *text)
{
    wb_acquisition_event(test->acquisition, "check", "refused: %s", text);
    give_up(test, WB_INTERLOCK_STAGE, "start check: %s", text);
}

/* Arms the interlock with what is known so far: start position, tare. */
static void arm(struct wb_bend_test *test)
{
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &test->rig);
    /* The return ends at the start; beyond it nothing is known to be free. */
    settings.rise = 1.0 * WB_MM;
    if (!test->has_tare)
        settings.force = 0.0;
    wb_acquisition_arm(test->acquisition, &settings, test->start_position);
    wb_acquisition_set_tare(test->acquisition, test->unloaded);
}

static void step_connect(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const int64_t allowed_ns =
        wb_ns_from_seconds(test->request.connect_timeout) + test->rig.load_cell.settle_ns;
    if (wb_interrupted())
        give_up(test, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
    else if (gone(test, WB_ROLE_LOAD))
        give_up(test, WB_INTERLOCK_STREAM_LOST, "the load cell's port %s went away",
                test->rig.load_cell.address);
    else if (gone(test, WB_ROLE_STAGE))
        give_up(test, WB_INTERLOCK_STREAM_LOST, "the stage's port %s went away",
                test->rig.stage.address);
    else if (wb_writer_status(test->writer) != WB_OK)
        give_up(test, WB_INTERLOCK_DISK, "the recording cannot be written");
    else if (latest->has_load && latest->has_mocap && latest->has_stage &&
             latest->stream[WB_ROLE_MOCAP].ready && latest->stream[WB_ROLE_LOAD].ready &&
             latest->stream[WB_ROLE_STAGE].ready) {
        test->result.recorded = true;
        /* Before the interlock, whose message would be the poorer one. */
        char text[WB_START_CHECK_TEXT];
        if (!wb_start_check_stage(&latest->stage, test->rig_path, text)) {
            refuse(test, text);
            return;
        }
        arm(test);
        enter(test, PHASE_CHECK);
    } else if (lasts_ns(test) > allowed_ns) {
        complain_silence(test);
    }
}

static void step_check(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const struct wb_start_check *const check = &test->check;
    const int64_t waited_ns = lasts_ns(test);
    const bool enough = wb_start_check_enough(check);
    char text[WB_START_CHECK_TEXT];
    if (waited_ns < host_ns(test, test->request.check_time) ||
        (!enough && waited_ns < CHECK_TIMEOUT_NS))
        return;
    if (!enough)
        snprintf(text, sizeof text, "only %" PRId64 " readings and %d frames came in %.1f s",
                 check->load.n, check->n_frames, wb_seconds_from_ns(waited_ns));
    if (!enough || !wb_start_check_stage(&latest->stage, test->rig_path, text) ||
        !wb_start_check_markers(check, &test->specimen, text) ||
        !wb_start_check_zero(check, &test->rig, test->rig_path, text)) {
        refuse(test, text);
        return;
    }
    test->start_position = latest->stage.position;
    wb_acquisition_event(test->acquisition, "check",
                         "passed: %d markers seen, zero %.3f mN, noise %.4f mN, travel %g mm free",
                         test->specimen.n_markers, check->load.mean / WB_MN,
                         wb_average_deviation(&check->load) / WB_MN, test->request.travel / WB_MM);
    arm(test);
    enter(test, PHASE_TARE);
}

/* --- tare and cycles --- */

/* Offers the motion under way to the stage; it counts from when it is taken. */
static void try_to_move(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const double speed = test->rig.stage.speed * test->rig.time_scale;
    const double distance = test->target - travel_of(test, latest->stage.position);
    const enum wb_status status =
        wb_acquisition_command(test->acquisition, WB_STAGE_COMMAND_JOG, distance, speed);
    test->unsent = status == WB_ERR_BUSY;
    if (status == WB_OK) {
        enter(test, test->phase);
        test->stands_since = 0;
        test->reports_seen = latest->stage_reports;
        test->allowed_ns = wb_ns_from_seconds(1.5 * fabs(distance) / speed) + 5 * WB_NS_PER_S;
    } else if (!test->unsent) {
        give_up(test, WB_INTERLOCK_STAGE,
                "the motion could not be sent to the stage at %s: check its cable and power",
                test->rig.stage.address);
    } else if (lasts_ns(test) > SEND_NS) {
        test->unsent = false;
        give_up(test, WB_INTERLOCK_STAGE,
                "the stage at %s does not answer an earlier command: check its cable",
                test->rig.stage.address);
    }
}

/* Starts a motion to `target` (m travel from the start). */
static void move_to(struct wb_bend_test *test, double target, enum phase phase)
{
    test->target = target;
    enter(test, phase);
    try_to_move(test);
}

/* True when the motion under way has ended at its target; stops the test when it cannot. */
static bool arrived(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    if (latest->stage_reports == test->reports_seen) {
        if (lasts_ns(test) > test->allowed_ns)
            give_up(test, WB_INTERLOCK_STAGE, "the stage did not arrive at %.2f mm in time",
                    test->target / WB_MM);
        return false;
    }
    test->reports_seen = latest->stage_reports;
    const double travel = travel_of(test, latest->stage.position);
    if (isfinite(travel))
        test->turn_travel = fmax(test->turn_travel, travel);
    if (latest->stage.state != WB_STAGE_IDLE) {
        test->stands_since = 0;
        if (lasts_ns(test) > test->allowed_ns)
            give_up(test, WB_INTERLOCK_STAGE,
                    "the stage is at %.2f mm and did not arrive at %.2f mm in time", travel / WB_MM,
                    test->target / WB_MM);
        return false;
    }
    if (fabs(travel - test->target) <= POSITION_TOLERANCE) {
        wb_acquisition_motion_ended(test->acquisition);
        return true;
    }
    /* The first idle reports may be older than the command. */
    test->stands_since++;
    const bool refused = latest->stage_error[0] && test->stands_since >= 2;
    if (!refused && (test->stands_since < 5 || lasts_ns(test) <= WB_NS_PER_S))
        return false;
    /* It stands: no hold is needed, which would only have to be released again. */
    wb_acquisition_motion_ended(test->acquisition);
    give_up(test, WB_INTERLOCK_STAGE, "the stage stands at %.2f mm instead of %.2f mm%s%s",
            travel / WB_MM, test->target / WB_MM, refused ? ": " : "",
            refused ? latest->stage_error : "");
    return false;
}

static void begin_cycle(struct wb_bend_test *test)
{
    test->cycle++;
    test->turn_travel = 0.0;
    test->result.started = true;
    wb_acquisition_event(test->acquisition, "cycle_start", "%d", test->cycle);
    move_to(test, test->request.travel, PHASE_DOWN);
}

static void step_tare(struct wb_bend_test *test)
{
    if (lasts_ns(test) < host_ns(test, test->request.tare_time) || test->zero.n < LEAST_READINGS)
        return;
    test->tare = test->zero.mean;
    test->unloaded = test->tare - wb_rig_tare_load(&test->rig);
    test->has_tare = true;
    wb_acquisition_event(test->acquisition, "tare",
                         "{\"force_N\": %.17g, \"samples\": %" PRId64 ", \"sd_N\": %.17g}",
                         test->tare, test->zero.n, wb_average_deviation(&test->zero));
    arm(test);
    begin_cycle(test);
}

static void step_down(struct wb_bend_test *test)
{
    if (!arrived(test))
        return;
    wb_acquisition_event(test->acquisition, "turn", "%d", test->cycle);
    move_to(test, 0.0, PHASE_UP);
}

static void step_up(struct wb_bend_test *test)
{
    if (arrived(test))
        enter(test, PHASE_REST);
}

static void step_rest(struct wb_bend_test *test)
{
    if (lasts_ns(test) < host_ns(test, test->request.rest_time))
        return;
    wb_acquisition_event(test->acquisition, "cycle_end", "%d", test->cycle);
    test->result.cycles_done = test->cycle;
    if (test->cycle < test->request.cycles) {
        begin_cycle(test);
        return;
    }
    set_end(test, WB_BEND_TEST_DONE, "%d of %d cycles", test->cycle, test->request.cycles);
    test->result.standing = true;
    finish(test);
}

/* --- the samples it sees --- */

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_bend_test *const test = context;
    if (sample->valid && test->phase == PHASE_CHECK)
        wb_average_add(&test->check.load, sample->force);
    if (sample->valid && test->phase == PHASE_TARE)
        wb_average_add(&test->zero, sample->force);
    if (sample->valid && test->result.started && test->phase < PHASE_STOP)
        test->result.peak_tension = fmax(test->result.peak_tension, sample->force - test->unloaded);
    if (test->request.sink.load)
        test->request.sink.load(test->request.sink.context, sample);
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_bend_test *const test = context;
    if (test->phase == PHASE_CHECK)
        wb_start_check_frame(&test->check, frame, &test->specimen);
    if (test->phase == PHASE_TARE)
        wb_tip_watch_rest(&test->tip, frame, &test->specimen, test->rig.mocap.up);
    else if (test->phase > PHASE_TARE)
        wb_tip_watch_follow(&test->tip, frame);
    if (test->request.sink.mocap)
        test->request.sink.mocap(test->request.sink.context, frame);
}

static void on_stage(void *context, const struct wb_stage_report *report)
{
    struct wb_bend_test *const test = context;
    if (test->request.sink.stage)
        test->request.sink.stage(test->request.sink.context, report);
}

static void on_probe(void *context, const struct wb_clock_probe *probe)
{
    struct wb_bend_test *const test = context;
    if (test->request.sink.probe)
        test->request.sink.probe(test->request.sink.context, probe);
}

static void on_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                      const char *text)
{
    struct wb_bend_test *const test = context;
    if (test->request.sink.remark)
        test->request.sink.remark(test->request.sink.context, level, t_ns, kind, text);
}

/* --- opening --- */

static enum wb_status check_request(const struct wb_bend_test *test)
{
    const struct wb_rig *const rig = &test->rig;
    const double travel = test->request.travel;
    const double limit = rig->limits.travel > 0.0 ? rig->limits.travel : rig->stage.travel;
    if (test->request.cycles < 1)
        return wb_fail(WB_ERR_ARGUMENT, "a test has at least one cycle, not %d",
                       test->request.cycles);
    if (!(travel > 0.0) || !(travel <= limit))
        return wb_fail(WB_ERR_ARGUMENT,
                       "a travel of %g mm is not free: the rig file allows up to %g mm "
                       "(stage.travel_mm, limits.travel_mm); choose less with --travel-mm",
                       travel / WB_MM, limit / WB_MM);
    return WB_OK;
}

static enum wb_status start(struct wb_bend_test *test, const struct wb_bend_test_request *request)
{
    WB_TRY(wb_rig_read(request->rig_path, &test->rig));
    WB_TRY(wb_specimen_read(request->specimen_path, &test->specimen));
    WB_TRY(check_request(test));
    if (wb_file_exists(request->output_path))
        return wb_fail(WB_ERR_EXISTS,
                       "'%s' exists: a recording is never overwritten, choose another name",
                       request->output_path);
    const struct wb_sink sink = {test, on_load, on_mocap, on_stage, on_probe, on_remark};
    WB_TRY(wb_acquisition_open(&test->acquisition, &test->rig, WB_ACQUISITION_ALL, &sink));
    test->started_ns = wb_acquisition_now_ns();
    const struct wb_bend_recording description = {
        .path = request->output_path,
        .rig_path = request->rig_path,
        .specimen_path = request->specimen_path,
        .rig = &test->rig,
        .specimen = &test->specimen,
        .operator_name = request->operator_name,
        .notes = request->notes,
        .cycles = request->cycles,
        .travel = request->travel,
        .monotonic_start_ns = test->started_ns,
    };
    struct wb_recording *recording;
    WB_TRY(wb_bend_recording_create(&recording, &description));
    const enum wb_status status = wb_writer_start(&test->writer, recording, NULL);
    if (status != WB_OK) {
        if (wb_recording_close(recording) != WB_OK)
            wb_debug("the unused recording did not close cleanly");
        unlink(request->output_path);
        return status;
    }
    snprintf(test->output_path, sizeof test->output_path, "%s", request->output_path);
    snprintf(test->rig_path, sizeof test->rig_path, "%s", request->rig_path);
    wb_acquisition_start(test->acquisition, test->writer);
    wb_acquisition_event(test->acquisition, "start", "%s", wb_version_revision());
    return WB_OK;
}

enum wb_status wb_bend_test_open(struct wb_bend_test **out,
                                 const struct wb_bend_test_request *request)
{
    struct wb_bend_test *const test = calloc(1, sizeof *test);
    if (!test)
        return wb_fail(WB_ERR_MEMORY, "no memory for the test");
    test->request = *request;
    test->hold_latency = test->confirm_latency = (double)NAN;
    test->start_position = (double)NAN;
    const enum wb_status status = start(test, request);
    test->request.rig_path = test->request.specimen_path = test->request.output_path = NULL;
    test->request.operator_name = test->request.notes = NULL;
    if (status != WB_OK) {
        wb_acquisition_close(test->acquisition);
        free(test);
        return status;
    }
    enter(test, PHASE_CONNECT);
    test->result.is_virtual = test->rig.is_virtual;
    *out = test;
    return WB_OK;
}

/* --- the loop --- */

enum wb_bend_test_end wb_bend_test_step(struct wb_bend_test *test, int64_t timeout_ns)
{
    if (test->phase == PHASE_END)
        return test->result.end;
    if (wb_acquisition_step(test->acquisition, timeout_ns) == WB_ACQUISITION_FAILED &&
        test->phase < PHASE_STOP)
        give_up(test, WB_INTERLOCK_STREAM_LOST, "the instruments cannot be waited for");
    note_trip(test);
    if (test->unsent && test->phase < PHASE_STOP) {
        try_to_move(test);
        return WB_BEND_TEST_RUNNING;
    }
    switch (test->phase) {
    case PHASE_CONNECT:
        step_connect(test);
        break;
    case PHASE_CHECK:
        step_check(test);
        break;
    case PHASE_TARE:
        step_tare(test);
        break;
    case PHASE_DOWN:
        step_down(test);
        break;
    case PHASE_UP:
        step_up(test);
        break;
    case PHASE_REST:
        step_rest(test);
        break;
    case PHASE_STOP:
        step_stop(test);
        break;
    case PHASE_END:
        break;
    }
    return test->phase == PHASE_END ? test->result.end : WB_BEND_TEST_RUNNING;
}

void wb_bend_test_mark(struct wb_bend_test *test, const char *text)
{
    if (test->phase != PHASE_END)
        wb_acquisition_event(test->acquisition, "mark", "%s", text);
}

void wb_bend_test_stop(struct wb_bend_test *test)
{
    if (test->phase < PHASE_STOP)
        give_up(test, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
}

void wb_bend_test_status(const struct wb_bend_test *test, struct wb_bend_test_status *status)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    memset(status, 0, sizeof *status);
    status->phase = phase_names[test->phase];
    status->cycle = test->cycle;
    status->cycles = test->request.cycles;
    status->has_tension = latest->has_load;
    status->tension = latest->load.force - test->unloaded;
    status->has_travel =
        latest->has_stage && isfinite(test->start_position) && isfinite(latest->stage.position);
    if (status->has_travel)
        status->travel = travel_of(test, latest->stage.position);
    status->has_deflection = test->tip.settled;
    status->deflection = test->tip.deflection;
    status->elapsed = wb_seconds_from_ns(wb_acquisition_now_ns() - test->started_ns);
    status->gravity = test->rig.gravity;
    status->markers_expected = test->specimen.n_markers;
    status->is_virtual = test->rig.is_virtual;
    status->latest = latest;
}

/* --- closing --- */

static void stop_first(struct wb_bend_test *test)
{
    if (test->phase == PHASE_END)
        return;
    wb_bend_test_stop(test);
    while (wb_bend_test_step(test, 10 * WB_NS_PER_MS) == WB_BEND_TEST_RUNNING) {
    }
}

enum wb_status wb_bend_test_close(struct wb_bend_test *test, struct wb_bend_test_result *result)
{
    if (!test)
        return WB_OK;
    stop_first(test);
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        test->result.samples[role] = latest->stream[role].samples;
        test->result.bytes += latest->stream[role].bytes;
        test->result.drops += latest->stream[role].drops;
    }
    wb_acquisition_close(test->acquisition);
    const enum wb_status status = wb_writer_finish(test->writer);
    if (!test->result.recorded)
        unlink(test->output_path);
    test->result.tare = test->tare;
    test->result.duration = wb_seconds_from_ns(test->duration_ns);
    test->result.hold_latency = test->hold_latency;
    test->result.confirm_latency = test->confirm_latency;
    if (result)
        *result = test->result;
    free(test);
    return status;
}
