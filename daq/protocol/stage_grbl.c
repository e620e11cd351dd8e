/* Driver of a GRBL stage: one line at a time, whose reply is awaited; reports, alarms and the
 * banner arrive at any time and are recognised by their form. */
#include "daq/protocol/driver.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "daq/protocol/grbl.h"
#include "daq/protocol/jog_feed.h"
#include "daq/protocol/line_buffer.h"

#define WB_LOG_DOMAIN "stage"

#define POLL_PERIOD_NS (200 * WB_NS_PER_MS)      /* GRBL recommends at most 5 reports/s, */
#define FAST_POLL_PERIOD_NS (100 * WB_NS_PER_MS) /* and permits 10 reports/s temporarily */
#define FAST_POLL_NS (1000 * WB_NS_PER_MS)
#define LIST_SETTINGS "$$"
#define S_PER_MIN 60.0
#define JOG_LINE "$J="
/* Timeout of a jog's reply: short, because the planner has space for every line that is sent. */
#define JOG_REPLY_NS (500 * WB_NS_PER_MS)
/* Assumed if the stage does not report its settings: GRBL's default acceleration (m/s2), and the
 * rounding of positions to steps (m). */
#define DEFAULT_ACCELERATION (10.0 * WB_MM)
#define DEFAULT_ROUNDING (0.05 * WB_MM)
#define PRINTED (0.002 * WB_MM) /* m, rounding of reported positions to three decimals of mm */
#define PROBE_NS (2500 * WB_NS_PER_MS)
#define REPLY_NS (2000 * WB_NS_PER_MS) /* timeout of a reply, except to homing */

struct grbl_state {
    struct wb_rig rig;
    int axis;                   /* 0 to 2 */
    struct wb_line_buffer line; /* the line being received */
    bool amid;                  /* the beginning of that line is missing */
    /* Received from the firmware. */
    bool answered;
    bool position_lost, limit_pressed;
    bool resets;    /* a reset has just been sent */
    bool was_reset; /* it restarted by itself, or because its port was opened */
    int alarm;      /* last ALARM number; 0: none */
    enum wb_stage_state state;
    struct wb_grbl_offset offset;
    uint64_t n_unknown;
    /* The reply to `$$`, which is sent when the stage is idle or in alarm: in other states it would
     * be ignored or rejected. */
    bool asked_settings, tried_settings, is_listing;
    struct wb_stage_settings settings;
    /* The current jog, executed as short ones. */
    struct wb_jog_feed feed;
    double position;   /* m, down, of the last report */
    bool is_settling;  /* after a stop: no jog until the stage was reported idle twice */
    bool is_cancelled; /* the stop was our jog cancel */
    int idle_reports;  /* consecutive idle reports while settling */
    /* The line whose reply is pending. */
    char pending[96];
    bool waits;
    /* For sending. */
    int64_t started_ns;
    bool is_probed; /* a line end was sent, to which firmware that reads only whole lines replies */
    int64_t now_ns, sent_ns, next_poll_ns, fast_until_ns;
};

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct grbl_state *const state = opaque;
    state->rig = *rig;
    if (rig->stage.axis < 'X' || rig->stage.axis > 'Z' || abs(rig->stage.down) != 1)
        return wb_fail(WB_ERR_ARGUMENT, "the stage's axis must be X, Y or Z and down +1 or -1");
    state->axis = rig->stage.axis - 'X';
    return WB_OK;
}

/* --- settings --- */

static void note_setting(struct grbl_state *state, const struct wb_grbl_line *line)
{
    struct wb_stage_settings *const settings = &state->settings;
    if (!state->is_listing) {
        memset(settings, 0, sizeof *settings);
        settings->steps = settings->speed = (double)NAN;
        settings->acceleration = settings->travel = (double)NAN;
    }
    state->is_listing = true;
    const size_t used = strlen(settings->text);
    if (used + strlen(line->text) + 1 < sizeof settings->text)
        snprintf(settings->text + used, sizeof settings->text - used, "%s\n", line->text);
    switch (line->number) {
    case WB_GRBL_IDLE_DELAY:
        settings->powers_off = line->value < WB_GRBL_ALWAYS_ON;
        break;
    case WB_GRBL_INCHES:
        settings->inches = line->value > 0.0;
        break;
    case WB_GRBL_SOFT_LIMITS:
        settings->soft_limits = line->value > 0.0;
        break;
    default:
        if (line->number == WB_GRBL_STEPS + state->axis)
            settings->steps = line->value / WB_MM;
        else if (line->number == WB_GRBL_RATE + state->axis)
            settings->speed = line->value * WB_MM / S_PER_MIN;
        else if (line->number == WB_GRBL_ACCELERATION + state->axis)
            settings->acceleration = line->value * WB_MM;
        else if (line->number == WB_GRBL_TRAVEL + state->axis)
            settings->travel = line->value * WB_MM;
    }
}

static double acceleration_of(const struct wb_stage_settings *settings)
{
    return settings->acceleration > 0.0 ? settings->acceleration : DEFAULT_ACCELERATION;
}

/* The `ok` after the list of settings. */
static void end_settings(struct grbl_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_stage_settings *const settings = &state->settings;
    state->is_listing = false;
    state->tried_settings = true;
    const double speed = state->rig.stage.speed, scale = state->rig.time_scale;
    const struct wb_motion_limits top = {speed * scale, acceleration_of(settings)};
    wb_driver_remark(
        sink, WB_LOG_INFO, t_ns, "settings",
        "axis %c: %g steps/mm, at most %g mm/s, %g mm/s2, travel %g mm, soft limits "
        "%s; if this computer fails at %g mm/s, the stage continues for at most %.3f mm",
        state->rig.stage.axis, settings->steps * WB_MM, settings->speed / WB_MM,
        settings->acceleration / WB_MM, settings->travel / WB_MM,
        settings->soft_limits ? "on" : "off", speed / WB_MM, wb_jog_feed_ahead(&top) / WB_MM);
    if (settings->powers_off)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings",
                         "the stage switches its motors off after a motion, and the clamp may sag: "
                         "set $1=255 in its firmware");
    if (sink->settings)
        sink->settings(sink->context, settings);
}

/* The settings are not available: the stage can be moved, but motions are not checked. */
static void miss_settings(struct grbl_state *state, int64_t t_ns, const char *why,
                          const struct wb_sink *sink)
{
    state->tried_settings = true;
    wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings",
                     "the stage does not report its settings ($$): %s; its maximum speed and its "
                     "travel are not checked",
                     why);
}

static void poll_soon(struct grbl_state *state)
{
    state->next_poll_ns = state->now_ns;
    state->fast_until_ns = state->now_ns + FAST_POLL_NS;
}

/* --- jogs --- */

static bool waits_for_jog(const struct grbl_state *state)
{
    return state->waits && strncmp(state->pending, JOG_LINE, strlen(JOG_LINE)) == 0;
}

/* Ends the sequence of short jogs. A line that is still being transferred may start a motion after
 * the stage has stopped. */
static void end_feed(struct grbl_state *state)
{
    state->is_settling = state->is_settling || state->feed.active || waits_for_jog(state);
    state->feed.active = false;
    state->idle_reports = 0;
}

static void cancel_feed(struct grbl_state *state)
{
    state->is_cancelled = true;
    state->is_settling = true;
    end_feed(state);
    poll_soon(state);
}

static void follow_feed(struct grbl_state *state, int64_t t_ns, const struct wb_grbl_report *report)
{
    const bool is_idle = report->state == WB_STAGE_IDLE;
    const double speed = report->has_feed ? report->feed_mm_min * WB_MM / S_PER_MIN : (double)NAN;
    wb_jog_feed_report(&state->feed, t_ns, state->position, speed, is_idle, state->waits);
    state->idle_reports = is_idle ? state->idle_reports + 1 : 0;
    if (state->idle_reports >= 2 || report->state == WB_STAGE_HOLD ||
        report->state == WB_STAGE_ALARM)
        state->is_settling = state->is_cancelled = false;
}

/* --- receiving --- */

static void deliver(const struct grbl_state *state, int64_t t_ns, double position,
                    const struct wb_sink *sink)
{
    if (!sink->stage)
        return;
    const struct wb_stage_report report = {.t_ns = t_ns,
                                           .state = state->state,
                                           .position = position,
                                           .alarm = state->alarm,
                                           .was_reset = state->was_reset};
    sink->stage(sink->context, &report);
}

static void receive_report(struct grbl_state *state, int64_t t_ns,
                           const struct wb_grbl_report *report, const struct wb_sink *sink)
{
    double position_mm = (double)NAN;
    wb_grbl_position(report, &state->offset, state->axis, &position_mm);
    if (!state->answered)
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "connected", "the stage is connected, state %s",
                         report->name);
    state->answered = true;
    if (report->state == WB_STAGE_ALARM && state->state != WB_STAGE_ALARM && state->alarm == 0)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "locked",
                         "the stage is locked (state Alarm): run 'home' or 'unlock'");
    if (report->limit[state->axis] && !state->limit_pressed)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "switch",
                         "the limit switch of axis %c is pressed", state->rig.stage.axis);
    state->limit_pressed = report->limit[state->axis];
    /* $X or $H ended the alarm. */
    if (report->state != WB_STAGE_ALARM)
        state->alarm = 0;
    state->state = report->state;
    state->position = position_mm * WB_MM * state->rig.stage.down;
    follow_feed(state, t_ns, report);
    deliver(state, t_ns, position_mm * WB_MM, sink);
}

/* The pending line will not be answered. */
static void discard_pending(struct grbl_state *state)
{
    state->waits = false;
    state->feed.active = false;
    state->is_listing = false;
    state->asked_settings = state->tried_settings;
}

static void receive_alarm(struct grbl_state *state, int64_t t_ns, int number,
                          const struct wb_sink *sink)
{
    state->alarm = number > 0 ? number : 99;
    state->state = WB_STAGE_ALARM;
    discard_pending(state);
    state->position_lost = state->position_lost || wb_grbl_alarm_loses_position(number);
    wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "alarm", "ALARM:%d, %s", number,
                     wb_grbl_alarm_text(number));
    deliver(state, t_ns, (double)NAN, sink);
}

/* The firmware restarted: pending lines are lost. */
static void receive_banner(struct grbl_state *state, int64_t t_ns, const struct wb_grbl_line *line,
                           const struct wb_sink *sink)
{
    if (state->answered && state->state != WB_STAGE_ALARM)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "reset", "the stage was reset: %s",
                         line->text);
    else
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "firmware", "%s", line->text);
    state->was_reset = state->was_reset || !state->resets;
    state->resets = false;
    discard_pending(state);
    state->offset.known = false;
}

static void receive_reply(struct grbl_state *state, int64_t t_ns, const struct wb_grbl_line *line,
                          const struct wb_sink *sink)
{
    const bool asked = state->waits && strcmp(state->pending, LIST_SETTINGS) == 0;
    state->answered = true;
    if (line->kind == WB_GRBL_LINE_ERROR && asked)
        miss_settings(state, t_ns, wb_grbl_error_text(line->number), sink);
    else if (line->kind == WB_GRBL_LINE_ERROR)
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "error", "error:%d, %s%s%s", line->number,
                         wb_grbl_error_text(line->number), state->waits ? ": " : "",
                         state->waits ? state->pending : "");
    else if (state->waits && strcmp(state->pending, "$H") == 0 && state->position_lost) {
        state->position_lost = false;
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "homed",
                         "the stage was homed: its position is known");
    }
    if (line->kind == WB_GRBL_LINE_OK && waits_for_jog(state))
        wb_jog_feed_accepted(&state->feed, t_ns);
    else if (waits_for_jog(state))
        cancel_feed(state);
    if (line->kind == WB_GRBL_LINE_OK && state->is_listing)
        end_settings(state, t_ns, sink);
    else if (line->kind == WB_GRBL_LINE_OK && asked)
        miss_settings(state, t_ns, "its list is empty", sink);
    state->waits = false;
}

static void receive_line(struct grbl_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    struct wb_grbl_line line;
    wb_grbl_decode(state->line.bytes, state->line.n, &line);
    switch (line.kind) {
    case WB_GRBL_LINE_OK:
    case WB_GRBL_LINE_ERROR:
        receive_reply(state, t_ns, &line, sink);
        break;
    case WB_GRBL_LINE_ALARM:
        receive_alarm(state, t_ns, line.number, sink);
        break;
    case WB_GRBL_LINE_BANNER:
        receive_banner(state, t_ns, &line, sink);
        break;
    case WB_GRBL_LINE_REPORT:
        receive_report(state, t_ns, &line.report, sink);
        break;
    case WB_GRBL_LINE_MESSAGE:
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "message", "%s", line.text);
        break;
    case WB_GRBL_LINE_SETTING:
        note_setting(state, &line);
        break;
    case WB_GRBL_LINE_EMPTY:
        break;
    case WB_GRBL_LINE_UNKNOWN:
        state->n_unknown++;
        if (wb_driver_is_report_due(state->n_unknown))
            wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "refused",
                             "a line of the stage cannot be decoded: '%s'; %" PRIu64 " so far",
                             line.text, state->n_unknown);
    }
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct grbl_state *const state = opaque;
    if (n == 0) {
        wb_line_buffer_clear(&state->line);
        state->amid = true;
    }
    for (size_t i = 0; i < n; i++) {
        if (!wb_line_buffer_push(&state->line, bytes[i], "lf"))
            continue;
        if (state->line.overlong)
            wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "refused",
                             "a line of more than %d bytes from the stage is dropped: check the "
                             "baud rate",
                             (int)sizeof state->line.bytes);
        else if (!state->amid)
            receive_line(state, t_ns, sink);
        state->amid = false;
        wb_line_buffer_clear(&state->line);
    }
}

/* --- sending --- */

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct grbl_state *const state = opaque;
    const uint8_t poll = WB_GRBL_STATUS;
    state->now_ns = state->started_ns = now_ns;
    wb_outbox_add(outbox, &poll, 1);
    state->next_poll_ns = now_ns + POLL_PERIOD_NS;
}

static enum wb_status send_byte(struct wb_outbox *outbox, uint8_t byte)
{
    if (!wb_outbox_add(outbox, &byte, 1))
        return wb_fail(WB_ERR_MEMORY, "too many commands to the stage are waiting to be sent");
    return WB_OK;
}

/* Sends a line (with its newline) and awaits its reply. While an earlier reply is pending, returns
 * WB_ERR_BUSY without a message; the caller tries again. */
static enum wb_status send_line(struct grbl_state *state, const char *text,
                                struct wb_outbox *outbox)
{
    const size_t length = strcspn(text, "\n");
    if (state->waits)
        return WB_ERR_BUSY;
    if (length >= sizeof state->pending || !wb_outbox_add_text(outbox, text))
        return wb_fail(WB_ERR_MEMORY, "too many commands to the stage are waiting to be sent");
    memcpy(state->pending, text, length);
    state->pending[length] = '\0';
    state->waits = true;
    state->sent_ns = state->now_ns;
    return WB_OK;
}

/* Sends the next short jog if the firmware has space for it. */
static enum wb_status send_block(struct grbl_state *state, struct wb_outbox *outbox)
{
    char line[96];
    const double block = state->waits ? 0.0 : wb_jog_feed_next(&state->feed, state->now_ns);
    if (block == 0.0 ||
        !wb_grbl_format_jog(line, sizeof line, state->rig.stage.axis, block * state->rig.stage.down,
                            state->feed.jog.top.speed))
        return WB_OK;
    WB_TRY(send_line(state, line, outbox));
    wb_jog_feed_sent(&state->feed, block);
    return WB_OK;
}

static enum wb_status start_jog(struct grbl_state *state, double distance, double speed,
                                struct wb_outbox *outbox)
{
    char line[96];
    if (!wb_grbl_format_jog(line, sizeof line, state->rig.stage.axis, distance, speed))
        return wb_fail(WB_ERR_ARGUMENT,
                       "jog by %g mm at %g mm/s: expected at least 0.001 mm and a positive speed",
                       distance / WB_MM, speed / WB_MM);
    /* Busy: the caller tries again. */
    if (!state->tried_settings || state->waits || state->feed.active || state->is_settling ||
        state->state != WB_STAGE_IDLE || !isfinite(state->position))
        return WB_ERR_BUSY;
    const struct wb_jog jog = {.distance = distance,
                               .top = {speed, acceleration_of(&state->settings)},
                               .rounding = state->settings.steps > 0.0
                                               ? 1.0 / state->settings.steps + PRINTED
                                               : DEFAULT_ROUNDING,
                               .start = state->position};
    wb_jog_feed_begin(&state->feed, &jog);
    return send_block(state, outbox);
}

static bool can_list_settings(const struct grbl_state *state)
{
    return state->state == WB_STAGE_IDLE || state->state == WB_STAGE_ALARM;
}

static bool must_request_settings(const struct grbl_state *state)
{
    return can_list_settings(state) && !state->asked_settings && !state->waits;
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct grbl_state *const state = opaque;
    const uint8_t poll = WB_GRBL_STATUS;
    state->now_ns = now_ns;
    /* A lost reply must not block the stage permanently. */
    const int64_t allowed_ns = waits_for_jog(state) ? JOG_REPLY_NS : REPLY_NS;
    if (state->waits && now_ns - state->sent_ns > allowed_ns && strcmp(state->pending, "$H") != 0) {
        wb_warn("the stage did not reply to '%s' within %d ms: check its cable", state->pending,
                (int)(allowed_ns / WB_NS_PER_MS));
        state->waits = false;
        wb_jog_feed_lose(&state->feed);
        state->tried_settings = state->tried_settings || state->asked_settings;
    }
    if (must_request_settings(state) && send_line(state, LIST_SETTINGS "\n", outbox) == WB_OK)
        state->asked_settings = true;
    if (!state->answered && !state->is_probed && now_ns - state->started_ns > PROBE_NS) {
        (void)wb_outbox_add_text(outbox, "\n");
        state->is_probed = true;
    }
    /* If the block cannot be sent now, the next tick tries again. */
    (void)send_block(state, outbox);
    if (now_ns < state->next_poll_ns || !wb_outbox_add(outbox, &poll, 1))
        return;
    /* Repeated, because a line that was being transferred may have started after the first cancel.
     */
    if (state->is_cancelled && state->state == WB_STAGE_JOG)
        (void)send_byte(outbox, WB_GRBL_JOG_CANCEL);
    const int64_t period = now_ns < state->fast_until_ns ? FAST_POLL_PERIOD_NS : POLL_PERIOD_NS;
    state->next_poll_ns = now_ns + wb_driver_period_ns(&state->rig, period);
}

static enum wb_status command(void *opaque, enum wb_stage_command what, double distance,
                              double speed, struct wb_outbox *outbox)
{
    struct grbl_state *const state = opaque;
    switch (what) {
    case WB_STAGE_COMMAND_JOG:
        return start_jog(state, distance, speed, outbox);
    case WB_STAGE_COMMAND_HOLD:
        end_feed(state);
        poll_soon(state);
        return send_byte(outbox, WB_GRBL_HOLD);
    case WB_STAGE_COMMAND_RESUME:
        return send_byte(outbox, WB_GRBL_RESUME);
    case WB_STAGE_COMMAND_JOG_CANCEL:
        cancel_feed(state);
        return send_byte(outbox, WB_GRBL_JOG_CANCEL);
    case WB_STAGE_COMMAND_SOFT_RESET:
        state->resets = true;
        /* After a reset the firmware does not answer earlier lines. */
        discard_pending(state);
        poll_soon(state);
        return send_byte(outbox, WB_GRBL_SOFT_RESET);
    case WB_STAGE_COMMAND_HOME:
        return send_line(state, "$H\n", outbox);
    case WB_STAGE_COMMAND_UNLOCK:
        return send_line(state, "$X\n", outbox);
    case WB_STAGE_COMMAND_STATUS:
        return send_byte(outbox, WB_GRBL_STATUS);
    }
    return wb_fail(WB_ERR_ARGUMENT, "unknown stage command %d", (int)what);
}

static bool ready(const void *opaque)
{
    const struct grbl_state *const state = opaque;
    return state->answered && state->state != WB_STAGE_UNKNOWN &&
           (state->tried_settings || !can_list_settings(state));
}

/* No `stop`: nothing is streamed, and stopping the motion is the caller's decision. */
const struct wb_driver wb_stage_grbl = {
    .name = "grbl",
    .role = WB_ROLE_STAGE,
    .state_size = sizeof(struct grbl_state),
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .command = command,
    .ready = ready,
};
