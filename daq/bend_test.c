#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/units.h"
#include "base/version.h"
#include "daq/bend_recording.h"
#include "daq/bend_test_private.h"

#define WB_LOG_DOMAIN "record"

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

int64_t wb_bend_test_host_ns(const struct wb_bend_test *test, double rig_seconds)
{
    return wb_ns_from_seconds(rig_seconds / test->rig.time_scale);
}

double wb_bend_test_travel_of(const struct wb_bend_test *test, double position)
{
    return test->rig.stage.down * (position - test->start_position);
}

/* --- the samples it sees --- */

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_bend_test *const test = context;
    if (sample->valid && test->phase == WB_BEND_PHASE_CHECK)
        wb_average_add(&test->check.load, sample->force);
    if (sample->valid && test->phase == WB_BEND_PHASE_TARE)
        wb_average_add(&test->zero, sample->force);
    if (sample->valid && test->result.started && test->phase < WB_BEND_PHASE_STOP)
        test->result.peak_tension = fmax(test->result.peak_tension, sample->force - test->unloaded);
    if (test->request.sink.load)
        test->request.sink.load(test->request.sink.context, sample);
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_bend_test *const test = context;
    if (test->phase == WB_BEND_PHASE_CHECK)
        wb_start_check_frame(&test->check, frame, &test->specimen);
    if (test->phase == WB_BEND_PHASE_TARE)
        wb_tip_watch_rest(&test->tip, frame, &test->specimen, test->rig.mocap.up);
    else if (test->phase > WB_BEND_PHASE_TARE)
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
    test->phase_ns = test->started_ns;
    test->result.is_virtual = test->rig.is_virtual;
    *out = test;
    return WB_OK;
}

/* --- the loop --- */

enum wb_bend_test_end wb_bend_test_step(struct wb_bend_test *test, int64_t timeout_ns)
{
    if (test->phase == WB_BEND_PHASE_END)
        return test->result.end;
    if (wb_acquisition_step(test->acquisition, timeout_ns) == WB_ACQUISITION_FAILED &&
        test->phase < WB_BEND_PHASE_STOP)
        wb_bend_test_give_up(test, WB_INTERLOCK_STREAM_LOST,
                             "the instruments cannot be waited for");
    wb_bend_test_note_trip(test);
    if (test->unsent && test->phase < WB_BEND_PHASE_STOP) {
        wb_bend_test_try_to_move(test);
        return WB_BEND_TEST_RUNNING;
    }
    const int64_t now_ns = wb_acquisition_now_ns();
    switch (test->phase) {
    case WB_BEND_PHASE_CONNECT:
        wb_bend_test_step_connect(test, now_ns);
        break;
    case WB_BEND_PHASE_CHECK:
        wb_bend_test_step_check(test, now_ns);
        break;
    case WB_BEND_PHASE_TARE:
        wb_bend_test_step_tare(test, now_ns);
        break;
    case WB_BEND_PHASE_DOWN:
        wb_bend_test_step_down(test, now_ns);
        break;
    case WB_BEND_PHASE_UP:
        wb_bend_test_step_up(test, now_ns);
        break;
    case WB_BEND_PHASE_REST:
        wb_bend_test_step_rest(test, now_ns);
        break;
    case WB_BEND_PHASE_STOP:
        wb_bend_test_step_stop(test);
        break;
    case WB_BEND_PHASE_END:
        break;
    }
    return test->phase == WB_BEND_PHASE_END ? test->result.end : WB_BEND_TEST_RUNNING;
}

void wb_bend_test_mark(struct wb_bend_test *test, const char *text)
{
    if (test->phase != WB_BEND_PHASE_END)
        wb_acquisition_event(test->acquisition, "mark", "%s", text);
}

void wb_bend_test_stop(struct wb_bend_test *test)
{
    if (test->phase < WB_BEND_PHASE_STOP)
        wb_bend_test_give_up(test, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
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
        status->travel = wb_bend_test_travel_of(test, latest->stage.position);
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
    if (test->phase == WB_BEND_PHASE_END)
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
