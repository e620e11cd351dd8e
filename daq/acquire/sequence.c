#include "daq/acquire/sequence.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/stage_check.h"

/* A command waits while an earlier one is unanswered; the driver itself gives up after 2 s. */
#define SEND_NS (4 * WB_NS_PER_S)

/* s, assumed time of acceleration if the stage does not report its acceleration. */
#define RAMP_S 0.5

double wb_sequence_travel(const struct wb_sequence *sequence, double position)
{
    return sequence->rig.stage.down * (position - sequence->start_position);
}

void wb_sequence_enter(struct wb_sequence *sequence, int phase)
{
    sequence->phase = phase;
    sequence->phase_ns = wb_time_now_ns();
    sequence->listened_ns = wb_acquisition_listened_ns(sequence->acquisition);
    sequence->reports_seen = wb_acquisition_latest(sequence->acquisition)->stage_reports;
    sequence->idle_reports = 0;
}

int64_t wb_sequence_lasts_ns(const struct wb_sequence *sequence)
{
    return wb_acquisition_listened_ns(sequence->acquisition) - sequence->listened_ns;
}

void wb_sequence_set_end(struct wb_sequence *sequence, enum wb_sequence_end end, const char *format,
                         ...)
{
    if (sequence->end != WB_SEQUENCE_RUNNING)
        return;
    sequence->end = end;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(sequence->text, sizeof sequence->text, format, arguments);
    va_end(arguments);
}

void wb_sequence_give_up(struct wb_sequence *sequence, enum wb_interlock_reason reason,
                         const char *format, ...)
{
    char text[WB_INTERLOCK_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (wb_acquisition_moving(sequence->acquisition))
        wb_acquisition_stop(sequence->acquisition, reason, text);
    wb_sequence_set_end(
        sequence, reason == WB_INTERLOCK_INTERRUPT ? WB_SEQUENCE_INTERRUPTED : WB_SEQUENCE_FAILED,
        "%s", text);
    wb_sequence_enter(sequence, WB_SEQUENCE_STOP);
}

/* Checks a jog against the firmware's settings; if it is not possible, ends the sequence. */
static bool jog_is_possible(struct wb_sequence *sequence)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(sequence->acquisition);
    char text[WB_INTERLOCK_TEXT];
    if (sequence->command != WB_STAGE_COMMAND_JOG || !latest->has_settings)
        return true;
    const double from = latest->stage.position;
    const struct wb_stage_motion motion = {.from = from,
                                           .to =
                                               from + sequence->rig.stage.down * sequence->distance,
                                           .speed = sequence->speed};
    if (wb_stage_check(&latest->settings, &sequence->rig, &motion, text))
        return true;
    sequence->unsent = false;
    wb_sequence_give_up(sequence, WB_INTERLOCK_STAGE, "%s", text);
    return false;
}

static void begin_watch(struct wb_sequence *sequence)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(sequence->acquisition);
    const double reported = latest->has_settings ? latest->settings.acceleration : 0.0;
    const struct wb_motion_limits top = {sequence->speed,
                                         reported > 0.0 ? reported : sequence->speed / RAMP_S};
    const double from = wb_sequence_travel(sequence, latest->stage.position);
    if (sequence->command == WB_STAGE_COMMAND_JOG)
        wb_speed_watch_begin(&sequence->watch, from, from + sequence->distance, &top);
    sequence->reports_watched = latest->stage_reports;
}

static void follow_watch(struct wb_sequence *sequence)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(sequence->acquisition);
    if (latest->stage_reports == sequence->reports_watched || sequence->unsent)
        return;
    sequence->reports_watched = latest->stage_reports;
    wb_speed_watch_add(&sequence->watch, latest->stage.t_ns,
                       wb_sequence_travel(sequence, latest->stage.position));
}

bool wb_sequence_note_speed(struct wb_sequence *sequence, char *text, size_t size)
{
    const double scale = sequence->rig.time_scale * WB_MM;
    const double speed = wb_speed_watch_speed(&sequence->watch) / scale;
    if (!isfinite(speed))
        return false;
    wb_acquisition_event(sequence->acquisition, "speed",
                         "{\"commanded_mm_s\": %.6g, \"actual_mm_s\": %.6g}",
                         sequence->speed / scale, speed);
    snprintf(text, size, "at %.3g mm/s instead of %.3g mm/s", speed, sequence->speed / scale);
    return wb_speed_watch_is_off(&sequence->watch);
}

/* Sends the command of this phase, or keeps it for the next step if the stage is busy. */
static void try_to_send(struct wb_sequence *sequence)
{
    if (!jog_is_possible(sequence))
        return;
    const enum wb_status status = wb_acquisition_command(sequence->acquisition, sequence->command,
                                                         sequence->distance, sequence->speed);
    sequence->unsent = status == WB_ERR_BUSY;
    if (status == WB_OK) {
        wb_sequence_enter(sequence, sequence->phase);
        begin_watch(sequence);
        sequence->allowed_ns =
            5 * WB_NS_PER_S + wb_ns_from_seconds(1.5 * fabs(sequence->distance) / sequence->speed);
    } else if (!sequence->unsent) {
        wb_sequence_give_up(sequence, WB_INTERLOCK_STAGE,
                            "the command could not be sent to the stage at %s: check its cable and "
                            "power%s",
                            sequence->rig.stage.address, sequence->remedy);
    } else if (wb_sequence_lasts_ns(sequence) > SEND_NS) {
        sequence->unsent = false;
        wb_sequence_give_up(sequence, WB_INTERLOCK_STAGE,
                            "the stage at %s does not answer an earlier command: check its cable%s",
                            sequence->rig.stage.address, sequence->remedy);
    }
}

void wb_sequence_send(struct wb_sequence *sequence, enum wb_stage_command command, double distance,
                      double speed, int phase)
{
    sequence->command = command;
    sequence->distance = distance;
    sequence->speed = speed * sequence->rig.time_scale;
    wb_sequence_enter(sequence, phase);
    try_to_send(sequence);
}

void wb_sequence_jog_to(struct wb_sequence *sequence, double target, double speed, int phase)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(sequence->acquisition);
    sequence->target = target;
    wb_sequence_send(sequence, WB_STAGE_COMMAND_JOG,
                     target - wb_sequence_travel(sequence, latest->stage.position), speed, phase);
}

/* Ends the sequence if the interlock has tripped; the hold byte has been sent already. */
static void note_trip(struct wb_sequence *sequence, bool started)
{
    const struct wb_interlock *const interlock = wb_acquisition_interlock(sequence->acquisition);
    if (interlock->reason == WB_INTERLOCK_NONE || sequence->phase >= WB_SEQUENCE_STOP)
        return;
    enum wb_sequence_end end = WB_SEQUENCE_LIMIT;
    if (interlock->reason == WB_INTERLOCK_INTERRUPT)
        end = WB_SEQUENCE_INTERRUPTED;
    else if (!started || interlock->reason == WB_INTERLOCK_DISK)
        end = WB_SEQUENCE_FAILED;
    wb_sequence_set_end(sequence, end, "%s", interlock->text);
    wb_sequence_enter(sequence, WB_SEQUENCE_STOP);
}

bool wb_sequence_wait(struct wb_sequence *sequence, int64_t timeout_ns, bool started)
{
    if (wb_acquisition_step(sequence->acquisition, timeout_ns) == WB_ACQUISITION_FAILED &&
        sequence->phase < WB_SEQUENCE_STOP)
        wb_sequence_give_up(sequence, WB_INTERLOCK_STREAM_LOST,
                            "waiting for the instruments failed: see the previous message");
    follow_watch(sequence);
    note_trip(sequence, started);
    /* While the interlock is armed, the acquisition handles Ctrl-C; before, the stage stands. */
    if (wb_interrupted() && sequence->phase < WB_SEQUENCE_STOP)
        wb_sequence_give_up(sequence, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
    if (!sequence->unsent || sequence->phase >= WB_SEQUENCE_STOP)
        return true;
    try_to_send(sequence);
    return false;
}
