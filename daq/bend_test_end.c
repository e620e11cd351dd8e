#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/units.h"
#include "base/version.h"
#include "daq/bend_test_private.h"

void wb_bend_test_enter(struct wb_bend_test *test, enum wb_bend_phase phase)
{
    test->phase = phase;
    test->phase_ns = wb_acquisition_now_ns();
}

void wb_bend_test_set_end(struct wb_bend_test *test, enum wb_bend_test_end end, const char *format,
                          ...)
{
    if (test->result.end != WB_BEND_TEST_RUNNING)
        return;
    test->result.end = end;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(test->result.text, sizeof test->result.text, format, arguments);
    va_end(arguments);
}

void wb_bend_test_finish(struct wb_bend_test *test)
{
    static const char *const why[] = {"running", "done", "limit", "interrupted", "failed"};
    struct wb_bend_test_result *const result = &test->result;
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    test->duration_ns = wb_acquisition_now_ns() - test->started_ns;
    if (latest->has_stage && isfinite(test->start_position))
        result->travel = wb_bend_test_travel_of(test, latest->stage.position);
    if (isfinite(result->travel))
        result->displaced = result->started && fabs(result->travel) > WB_BEND_POSITION_TOLERANCE;
    else
        result->displaced = result->started;
    wb_acquisition_disarm(test->acquisition);
    if (result->end == WB_BEND_TEST_DONE)
        wb_acquisition_event(test->acquisition, "stop", "done");
    else
        wb_acquisition_event(test->acquisition, "stop", "%s: %s", why[result->end], result->text);
    wb_acquisition_event(test->acquisition, "end", "%s", wb_version_revision());
    wb_bend_test_enter(test, WB_BEND_PHASE_END);
}

void wb_bend_test_give_up(struct wb_bend_test *test, enum wb_interlock_reason reason,
                          const char *format, ...)
{
    char text[WB_INTERLOCK_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (wb_acquisition_moving(test->acquisition))
        wb_acquisition_stop(test->acquisition, reason, text);
    wb_bend_test_set_end(
        test, reason == WB_INTERLOCK_INTERRUPT ? WB_BEND_TEST_INTERRUPTED : WB_BEND_TEST_FAILED,
        "%s", text);
    wb_bend_test_enter(test, WB_BEND_PHASE_STOP);
}

void wb_bend_test_note_trip(struct wb_bend_test *test)
{
    const struct wb_interlock *const interlock = wb_acquisition_interlock(test->acquisition);
    if (interlock->reason == WB_INTERLOCK_NONE || test->phase >= WB_BEND_PHASE_STOP)
        return;
    enum wb_bend_test_end end = WB_BEND_TEST_LIMIT;
    if (interlock->reason == WB_INTERLOCK_INTERRUPT)
        end = WB_BEND_TEST_INTERRUPTED;
    else if (!test->result.started || interlock->reason == WB_INTERLOCK_DISK)
        end = WB_BEND_TEST_FAILED;
    wb_bend_test_set_end(test, end, "%s", interlock->text);
    wb_bend_test_enter(test, WB_BEND_PHASE_STOP);
}

void wb_bend_test_step_stop(struct wb_bend_test *test)
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
    wb_bend_test_finish(test);
}
