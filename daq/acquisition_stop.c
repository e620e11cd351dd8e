#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/acquisition_private.h"

#define WB_LOG_DOMAIN "acquisition"

/* --- sending --- */

void wb_acquisition_lose_device(struct wb_acquisition_line *line)
{
    struct wb_acquisition *const a = line->owner;
    a->latest.stream[line->role].gone = true;
    a->interlock.lost[line->role] = true;
}

/* False when a write would have to wait: asked before all writes that are not urgent, because
 * waiting for one instrument must not delay the hold byte to another. */
static bool takes_bytes(const struct wb_acquisition_line *line)
{
    int descriptors[2];
    if (wb_stream_descriptors(line->stream, descriptors) == 0)
        return true;
    struct pollfd polled = {.fd = descriptors[0], .events = POLLOUT};
    return poll(&polled, 1, 0) > 0;
}

enum wb_status wb_acquisition_send(struct wb_acquisition_line *line, bool urgent)
{
    struct wb_acquisition *const a = line->owner;
    struct wb_outbox *const outbox = &a->outbox;
    enum wb_status status = WB_OK;
    const int64_t now_ns = wb_acquisition_now_ns();
    size_t begin = 0;
    if (a->latest.stream[line->role].gone)
        status = WB_ERR_IO;
    else if (!urgent && now_ns < line->write_again_ns)
        status = WB_ERR_TIMEOUT;
    else if (!urgent && outbox->n_entries > 0 && !takes_bytes(line)) {
        line->write_again_ns = now_ns + WB_NS_PER_S;
        status = WB_ERR_TIMEOUT;
    }
    for (size_t i = 0; status == WB_OK && i < outbox->n_entries; i++) {
        status = wb_stream_write(line->stream, outbox->bytes + begin, outbox->ends[i] - begin);
        begin = outbox->ends[i];
        if (status == WB_ERR_TIMEOUT)
            line->write_again_ns = now_ns + WB_NS_PER_S;
        /* A datagram that finds no listener is not the end of a network stream. */
        else if (status != WB_OK && line->role != WB_ROLE_MOCAP)
            wb_acquisition_lose_device(line);
    }
    wb_outbox_clear(outbox);
    return status;
}

static enum wb_status send_command(struct wb_acquisition_line *line, enum wb_stage_command command,
                                   double distance, double speed)
{
    struct wb_acquisition *const a = line->owner;
    wb_outbox_clear(&a->outbox);
    const enum wb_status status =
        line->driver->command(line->state, command, distance, speed, &a->outbox);
    if (status != WB_OK) {
        wb_outbox_clear(&a->outbox);
        return status;
    }
    const bool urgent = command == WB_STAGE_COMMAND_HOLD || command == WB_STAGE_COMMAND_SOFT_RESET;
    return wb_acquisition_send(line, urgent);
}

/* --- stopping --- */

void wb_acquisition_hold_now(struct wb_acquisition *a)
{
    if (a->stop.state != WB_STOP_NONE)
        return;
    struct wb_acquisition_line *const stage = a->by_role[WB_ROLE_STAGE];
    enum wb_status status = WB_OK;
    if (stage && a->moving)
        status = send_command(stage, WB_STAGE_COMMAND_HOLD, 0.0, 0.0);
    a->hold_sent = status == WB_OK;
    const int64_t now_ns = wb_acquisition_now_ns();
    if (!stage || !a->moving)
        wb_stop_settle(&a->stop, WB_STOP_STANDING, now_ns);
    else
        wb_stop_begin(&a->stop, now_ns);
    if (stage && a->latest.stream[WB_ROLE_STAGE].gone && a->moving)
        wb_stop_settle(&a->stop, WB_STOP_FAILED, now_ns);
    if (a->interlock.reason != WB_INTERLOCK_INTERRUPT)
        wb_acquisition_push_event(a, a->interlock.t_ns, "limit", a->interlock.text);
    char text[200];
    if (stage && a->moving && status == WB_OK) {
        snprintf(text, sizeof text, "{\"reason\": \"%s\", \"latency_ms\": %.3f}",
                 wb_interlock_reason_name(a->interlock.reason),
                 (double)(now_ns - a->interlock.t_ns) / 1e6);
        wb_acquisition_push_event(a, now_ns, "hold", text);
    } else if (stage && a->moving) {
        wb_acquisition_push_event(a, now_ns, "hold",
                                  "the hold byte could not be sent to the stage");
    }
}

/* Once, when the stop is over: what came of it. */
static void report_stop(struct wb_acquisition *a)
{
    if (!wb_stop_over(&a->stop) || a->reported_stop == a->stop.state)
        return;
    a->reported_stop = a->stop.state;
    if (!a->moving)
        return;
    char text[200];
    if (a->stop.state == WB_STOP_STANDING) {
        snprintf(text, sizeof text, "{\"confirmed_ms\": %.3f, \"soft_reset\": %s}",
                 (double)(a->stop.confirmed_ns - a->stop.hold_ns) / 1e6,
                 a->stop.reset_ns ? "true" : "false");
        a->moving = false;
        wb_acquisition_push_event(a, a->stop.confirmed_ns, "stopped", text);
    } else {
        wb_acquisition_push_event(a, a->stop.confirmed_ns, "stopped",
                                  "not confirmed: the stage may still be moving");
    }
}

void wb_acquisition_follow_stop(struct wb_acquisition *a, int64_t now_ns)
{
    struct wb_acquisition_line *const stage = a->by_role[WB_ROLE_STAGE];
    if (!stage || a->stop.state == WB_STOP_NONE)
        return;
    const bool was_over = wb_stop_over(&a->stop);
    enum wb_status status = WB_OK;
    switch (wb_stop_tick(&a->stop, now_ns)) {
    case WB_STOP_DO_ASK:
        if (a->stop.state == WB_STOP_HOLDING && !a->hold_sent)
            a->hold_sent = send_command(stage, WB_STAGE_COMMAND_HOLD, 0.0, 0.0) == WB_OK;
        status = send_command(stage, WB_STAGE_COMMAND_STATUS, 0.0, 0.0);
        break;
    case WB_STOP_DO_RESET:
        status = send_command(stage, WB_STAGE_COMMAND_SOFT_RESET, 0.0, 0.0);
        wb_warn("the stage did not confirm the hold within %d ms: soft reset",
                (int)(WB_STOP_CONFIRM_NS / WB_NS_PER_MS));
        wb_acquisition_push_event(a, wb_acquisition_now_ns(), "reset",
                                  status == WB_OK ? "hold not confirmed in time: soft reset sent"
                                                  : "the soft reset could not be sent");
        break;
    case WB_STOP_DO_NOTHING:
        break;
    }
    if (!was_over && a->latest.stream[WB_ROLE_STAGE].gone)
        wb_stop_settle(&a->stop, WB_STOP_FAILED, now_ns);
    report_stop(a);
}

void wb_acquisition_stop(struct wb_acquisition *a, enum wb_interlock_reason reason,
                         const char *text)
{
    if (wb_interlock_trip(&a->interlock, reason, wb_acquisition_now_ns(), text))
        wb_acquisition_hold_now(a);
}

void wb_acquisition_clear_stop(struct wb_acquisition *a)
{
    const struct wb_interlock_settings settings = a->interlock.settings;
    bool lost[WB_INTERLOCK_ROLES];
    memcpy(lost, a->interlock.lost, sizeof lost);
    wb_interlock_init(&a->interlock, &settings, wb_acquisition_now_ns());
    memcpy(a->interlock.lost, lost, sizeof lost);
    memset(&a->stop, 0, sizeof a->stop);
    a->reported_stop = WB_STOP_NONE;
}

/* --- the caller's side of stage and interlock --- */

void wb_acquisition_arm(struct wb_acquisition *a, const struct wb_interlock_settings *settings,
                        double start_position)
{
    const enum wb_interlock_reason reason = a->interlock.reason;
    if (reason != WB_INTERLOCK_NONE)
        return;
    wb_interlock_init(&a->interlock, settings, wb_acquisition_now_ns());
    a->interlock.armed = true;
    if (!isfinite(start_position) && a->latest.has_stage)
        start_position = a->latest.stage.position;
    a->interlock.start_position = start_position;
    /* Streams that were not opened send nothing. */
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        if (!a->by_role[role])
            a->interlock.settings.stream_lost_ns[role] = 0;
}

void wb_acquisition_disarm(struct wb_acquisition *a)
{
    a->interlock.armed = false;
}

void wb_acquisition_set_tare(struct wb_acquisition *a, double tare)
{
    a->interlock.tare = tare;
}

const struct wb_interlock *wb_acquisition_interlock(const struct wb_acquisition *a)
{
    return &a->interlock;
}

enum wb_status wb_acquisition_command(struct wb_acquisition *a, enum wb_stage_command command,
                                      double distance, double speed)
{
    struct wb_acquisition_line *const stage = a->by_role[WB_ROLE_STAGE];
    if (!stage)
        return wb_fail(WB_ERR_UNSUPPORTED, "no stage is open");
    if (a->stop.state != WB_STOP_NONE && command != WB_STAGE_COMMAND_STATUS)
        return WB_ERR_ARGUMENT;
    const bool moves = command == WB_STAGE_COMMAND_JOG || command == WB_STAGE_COMMAND_HOME;
    const bool was_moving = a->moving;
    if (command != WB_STAGE_COMMAND_STATUS)
        a->latest.stage_error[0] = '\0';
    /* Set first: a command that may have left in part counts as moving. */
    a->moving = a->moving || moves;
    const enum wb_status status = send_command(stage, command, distance, speed);
    if (status == WB_ERR_BUSY)
        a->moving = was_moving;
    return status;
}

void wb_acquisition_motion_ended(struct wb_acquisition *a)
{
    a->moving = false;
}

bool wb_acquisition_moving(const struct wb_acquisition *a)
{
    return a->moving;
}

const struct wb_stop *wb_acquisition_stop_state(const struct wb_acquisition *a)
{
    return &a->stop;
}
