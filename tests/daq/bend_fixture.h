/* A bend test against the small bench in virtual time, in a folder of its own, for its tests. */
#ifndef WB_TESTS_DAQ_BEND_FIXTURE_H
#define WB_TESTS_DAQ_BEND_FIXTURE_H

#include "base/interrupt_private.h"
#include "base/log.h"
#include "base/timing.h"
#include "daq/test/bend_test.h"
#include "tests/daq/fake_bench.h"
#include "tests/daq/sample_log.h"
#include "tests/folder.h"

#define MS WB_NS_PER_MS

struct fixture {
    struct fake_bench *bench;
    char folder[64], rig[96], specimen[96], output[96];
    struct wb_bend_test_request request;
    struct sample_log log;
    char errors[4096];  /* messages at error level, one a line */
    char events[16384]; /* "kind: text" of the finished recording, one a line */
};

static inline void keep_errors(void *context, enum wb_log_level level, const char *domain,
                               const char *message)
{
    struct fixture *const fixture = context;
    const size_t used = strlen(fixture->errors);
    (void)domain;
    if (level == WB_LOG_ERROR)
        snprintf(fixture->errors + used, sizeof fixture->errors - used, "%s\n", message);
}

static inline int set_up(void **state)
{
    struct fixture *const fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    assert_true(temporary_folder_make(fixture->folder));
    snprintf(fixture->rig, sizeof fixture->rig, "%s/rig.yaml", fixture->folder);
    snprintf(fixture->specimen, sizeof fixture->specimen, "%s/specimen.yaml", fixture->folder);
    snprintf(fixture->output, sizeof fixture->output, "%s/test.wbr", fixture->folder);
    fixture->bench = fake_start();
    fake_write_rig(fixture->rig, true, 60.0);
    fake_write_specimen(fixture->specimen);
    wb_bend_test_default_request(&fixture->request);
    fixture->request.rig_path = fixture->rig;
    fixture->request.specimen_path = fixture->specimen;
    fixture->request.output_path = fixture->output;
    fixture->request.operator_name = "tester";
    fixture->request.travel = 50.0 * WB_MM;
    fixture->request.connect_timeout = 0.4;
    fixture->request.sink = sample_log_sink(&fixture->log);
    wb_interrupt_set(false);
    wb_log_set_sink(keep_errors, fixture);
    *state = fixture;
    return 0;
}

static inline int tear_down(void **state)
{
    struct fixture *const fixture = *state;
    wb_log_set_sink(NULL, NULL);
    wb_interrupt_set(false);
    fake_stop(fixture->bench);
    sample_log_release(&fixture->log);
    const int code = temporary_folder_remove(fixture->folder);
    free(fixture);
    return code;
}

/* Runs until the test ends or `until` says so; false when it ended. */
static inline bool run(struct wb_bend_test *test,
                       bool (*until)(const struct wb_bend_test_status *status))
{
    const int64_t patience_ns = wb_time_now_ns() + 3600 * WB_NS_PER_S;
    struct wb_bend_test_status status;
    while (wb_bend_test_step(test, 20 * MS) == WB_SEQUENCE_RUNNING) {
        wb_bend_test_status(test, &status);
        if (until && until(&status))
            return true;
        assert_true(wb_time_now_ns() < patience_ns);
    }
    return false;
}

/* Replays the finished recording, with the rig file as it is, into a sink. */
static inline void replay(const struct fixture *fixture, const struct wb_sink *sink)
{
    struct wb_recording *recording;
    struct wb_replay_counts counts;
    struct wb_rig rig;
    assert_int_equal(wb_rig_read(fixture->rig, &rig), WB_OK);
    assert_int_equal(wb_recording_open(&recording, fixture->output), WB_OK);
    assert_int_equal(wb_replay_run(recording, &rig, sink, 0.0, &counts), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static inline enum wb_status append_event(void *context, const struct wb_event *event)
{
    struct fixture *const fixture = context;
    const size_t used = strlen(fixture->events);
    snprintf(fixture->events + used, sizeof fixture->events - used, "%s: %s\n", event->kind,
             event->text);
    return WB_OK;
}

/* The finished recording opens; its events are read. */
static inline void read_events(struct fixture *fixture)
{
    struct wb_recording *recording;
    fixture->events[0] = '\0';
    assert_int_equal(wb_recording_open(&recording, fixture->output), WB_OK);
    assert_int_equal(wb_recording_each_event(recording, append_event, fixture), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* The events named come in this order. */
static inline void assert_events(struct fixture *fixture, const char *const *expected, size_t n)
{
    read_events(fixture);
    const char *at = fixture->events;
    for (size_t i = 0; i < n; i++) {
        const char *const found = strstr(at, expected[i]);
        if (!found)
            fail_msg("no event '%s' in its place in:\n%s", expected[i], fixture->events);
        at = found + 1;
    }
}

/* Replaces the used bench by a new one, whose streams may be silent for `stream_lost_s`. */
static inline void renew(struct fixture *fixture, double stream_lost)
{
    fake_stop(fixture->bench);
    sample_log_release(&fixture->log);
    memset(&fixture->log, 0, sizeof fixture->log);
    unlink(fixture->output);
    wb_interrupt_set(false);
    fixture->bench = fake_start();
    fake_write_rig(fixture->rig, true, stream_lost);
}

#endif
