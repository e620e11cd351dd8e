/* Driver of a stage with a Pololu Tic. A motion is one target position. The Tic's watchdog, its
 * command timeout, stops the stage if this program crashes or hangs or the cable is unplugged: the
 * driver resets the timeout regularly, and does not move a Tic whose timeout is off or too long.
 *
 * Replies have no frame. The driver requests only two kinds of reply, with different lengths: first
 * the settings until they are received, then only the status. An incomplete reply is discarded
 * after a pause; thus the result depends only on the received bytes and their times. */
#include "daq/protocol/driver.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "daq/protocol/tic.h"

#define WB_LOG_DOMAIN "stage"

#define POLL_NS (200 * WB_NS_PER_MS)
#define FAST_POLL_NS (100 * WB_NS_PER_MS) /* for FAST_NS after a stop */
#define FAST_NS (1000 * WB_NS_PER_MS)
#define ANSWER_NS (500 * WB_NS_PER_MS) /* timeout of a reply, which takes 25 ms at 9600 baud */
#define GAP_NS (80 * WB_NS_PER_MS)     /* longest pause within a reply */
#define WAKE_NS (100 * WB_NS_PER_MS)   /* between two attempts to energize the Tic */
#define LIVES_PER_TIMEOUT 4            /* timeout resets sent per command timeout */
/* Accepted command timeout: with less, delays of a busy computer would stop the stage. */
#define LEAST_TIMEOUT_MS 100
#define MOST_TIMEOUT_MS 2000

struct tic_state {
    struct wb_rig rig;
    uint8_t bytes[WB_TIC_SETTINGS_BYTES]; /* of the reply being received */
    size_t n;
    int64_t last_ns; /* arrival of the last byte, or time of missing bytes */
    bool skips;      /* bytes are discarded until the next pause */
    /* Received from the Tic. */
    bool has_settings, has_status;
    struct wb_tic_settings settings;
    struct wb_tic_status status; /* last status */
    enum wb_stage_state state;   /* derived from it */
    bool was_reset;
    uint64_t n_refused;
    int idle_reports; /* consecutive idle reports since the last command */
    /* For sending. */
    bool waits; /* a reply is pending */
    int64_t now_ns, asked_ns, next_poll_ns, next_life_ns, fast_until_ns;
    bool wakes; /* the Tic is being energized for a motion */
    int64_t next_wake_ns;
};

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct tic_state *const state = opaque;
    state->rig = *rig;
    if (!(rig->stage.steps > 0.0) || abs(rig->stage.down) != 1)
        return wb_fail(WB_ERR_ARGUMENT,
                       "a Tic needs stage.steps_per_mm and stage.down (+1 or -1) in the rig file");
    return WB_OK;
}

/* --- settings --- */

/* Writes the reason why the Tic's settings do not permit a motion, with the remedy; "": permitted.
 */
static void find_fault(const struct wb_tic_settings *tic, char *text, size_t size)
{
    static const char *const where = "in Tic Control Center, Input and motor settings";
    text[0] = '\0';
    if (tic->control_mode != 0)
        snprintf(text, size,
                 "the Tic's control mode is %d, which ignores the serial port: choose Serial / I2C "
                 "/ USB %s",
                 tic->control_mode, where);
    else if (tic->command_timeout_ms == 0)
        snprintf(text, size,
                 "the Tic's command timeout is off (setting 0x09 is 0), so that the stage would "
                 "continue if this computer fails: set it to 1000 ms %s",
                 where);
    else if (tic->command_timeout_ms < LEAST_TIMEOUT_MS ||
             tic->command_timeout_ms > MOST_TIMEOUT_MS)
        snprintf(text, size,
                 "the Tic's command timeout (setting 0x09) is %d ms: set it to %d to %d ms %s; if "
                 "this computer fails, the stage continues for that time",
                 tic->command_timeout_ms, LEAST_TIMEOUT_MS, MOST_TIMEOUT_MS, where);
    else if (tic->soft_error_response == WB_TIC_GO_TO_POSITION)
        snprintf(text, size,
                 "the Tic's soft error response is Go to position, which would move the stage if "
                 "this computer fails: choose Decelerate to hold in Tic Control Center, Advanced "
                 "settings");
}

static void deliver_settings(struct tic_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_tic_settings *const tic = &state->settings;
    const double steps = state->rig.stage.steps;
    const double speed = state->rig.stage.speed * state->rig.time_scale;
    struct wb_stage_settings settings = {
        .steps = (double)NAN,
        .speed = (double)tic->max_speed * WB_TIC_SPEED_UNIT / steps,
        .acceleration = wb_tic_acceleration(tic, steps),
        .travel = (double)NAN,
        .powers_off = tic->soft_error_response == WB_TIC_RESPONSE_DEENERGIZE,
    };
    find_fault(tic, settings.fault, sizeof settings.fault);
    snprintf(settings.text, sizeof settings.text,
             "control_mode=%d\ncommand_timeout_ms=%d\nstep_mode=%d\ncurrent_limit=%d\n"
             "max_speed=%" PRIu32 "\nmax_deceleration=%" PRIu32 "\nmax_acceleration=%" PRIu32
             "\nsoft_error_response=%d\n",
             tic->control_mode, tic->command_timeout_ms, tic->step_mode, tic->current_limit,
             tic->max_speed, tic->max_deceleration, tic->max_acceleration,
             tic->soft_error_response);
    const double alone =
        speed * (1e-3 * tic->command_timeout_ms + 0.5 * speed / settings.acceleration);
    wb_driver_remark(
        sink, WB_LOG_INFO, t_ns, "settings",
        "Tic: at most %g mm/s, %g mm/s2, command timeout %d ms; if this computer fails at "
        "%g mm/s, the stage continues for at most %.3f mm",
        settings.speed / WB_MM, settings.acceleration / WB_MM, tic->command_timeout_ms,
        state->rig.stage.speed / WB_MM, alone / WB_MM);
    if (settings.fault[0])
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings", "%s", settings.fault);
    if (settings.powers_off)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings",
                         "the Tic switches its motor off if this computer fails, and the clamp may "
                         "sag: set its soft error response to Decelerate to hold");
    if (sink->settings)
        sink->settings(sink->context, &settings);
}

/* --- status --- */

static enum wb_stage_state state_of(const struct wb_tic_status *status)
{
    const bool homes = status->flags & WB_TIC_HOMING;
    if (status->velocity != 0)
        return homes ? WB_STAGE_HOME : WB_STAGE_JOG;
    if (wb_tic_alarm(status->errors) != 0)
        return WB_STAGE_ALARM;
    if (homes)
        return WB_STAGE_HOME;
    const bool obeys = status->operation == WB_TIC_NORMAL;
    if (obeys && status->planning == WB_TIC_TARGET_POSITION && status->target != status->position)
        return WB_STAGE_JOG;
    return WB_STAGE_IDLE;
}

/* Whether a bit of errors or flags is set that was not set before. */
static bool rises(uint16_t before, uint16_t now, uint16_t bits)
{
    return (now & bits) && !(before & bits);
}

static void remark_changes(const struct tic_state *state, int64_t t_ns,
                           const struct wb_tic_status *now, const struct wb_sink *sink)
{
    const struct wb_tic_status *const before = &state->status;
    const uint16_t limits = WB_TIC_FORWARD_LIMIT | WB_TIC_REVERSE_LIMIT;
    const int alarm = wb_tic_alarm(now->errors);
    if (!state->has_status)
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "connected",
                         "the Tic is connected, operation state %d", now->operation);
    else if (now->up_time_ms < before->up_time_ms)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "reset",
                         "the Tic was reset and lost its position: home the stage");
    if (alarm != 0 && (!state->has_status || alarm != wb_tic_alarm(before->errors)))
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "alarm", "%s", wb_tic_alarm_text(alarm));
    /* The first command after a silence clears the error bit of the timeout; the stop is seen from
     * the velocity and the operation state. */
    if (state->has_status && before->velocity != 0 && before->operation == WB_TIC_NORMAL &&
        now->operation == WB_TIC_SOFT_ERROR && alarm == 0)
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "timeout",
                         "the Tic received nothing from this computer for %d ms and stopped the "
                         "stage",
                         state->settings.command_timeout_ms);
    /* No warnings while homing: it activates the limit switch, and the position is uncertain. */
    const bool homes = (before->flags | now->flags) & WB_TIC_HOMING;
    if (rises(before->flags, now->flags, limits))
        wb_driver_remark(sink, homes ? WB_LOG_INFO : WB_LOG_WARNING, t_ns, "switch",
                         "a limit switch is pressed");
    if (!homes && rises(before->flags, now->flags, WB_TIC_POSITION_UNCERTAIN))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "position",
                         "the Tic's position is uncertain: home the stage, or continue from its "
                         "present position");
    if ((before->flags & WB_TIC_HOMING) &&
        !(now->flags & (WB_TIC_HOMING | WB_TIC_POSITION_UNCERTAIN)))
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "homed",
                         "the stage was homed: its position is known");
}

static void take_status(struct tic_state *state, int64_t t_ns, const struct wb_tic_status *status,
                        const struct wb_sink *sink)
{
    remark_changes(state, t_ns, status, sink);
    state->was_reset =
        state->was_reset || (state->has_status && status->up_time_ms < state->status.up_time_ms);
    state->status = *status;
    state->has_status = true;
    state->state = state_of(status);
    state->idle_reports = state->state == WB_STAGE_IDLE ? state->idle_reports + 1 : 0;
    const struct wb_stage_report report = {
        .t_ns = t_ns,
        .state = state->state,
        .position = status->position / state->rig.stage.steps,
        .alarm = state->state == WB_STAGE_ALARM ? wb_tic_alarm(status->errors) : 0,
        .was_reset = state->was_reset};
    if (sink->stage)
        sink->stage(sink->context, &report);
}

static void take_answer(struct tic_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    struct wb_tic_status status;
    bool understood;
    if (state->has_settings) {
        understood = wb_tic_decode_status(state->bytes, &status);
        if (understood)
            take_status(state, t_ns, &status, sink);
    } else {
        understood = wb_tic_decode_settings(state->bytes, &state->settings);
        state->has_settings = understood;
        if (understood)
            deliver_settings(state, t_ns, sink);
    }
    state->skips = !understood;
    state->n_refused += !understood;
    if (!understood && wb_driver_is_report_due(state->n_refused))
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "refused",
            "a reply of the Tic cannot be decoded and is dropped: check the baud rate in "
            "stage.address; %" PRIu64 " so far",
            state->n_refused);
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct tic_state *const state = opaque;
    /* After missing bytes, the rest of a reply may follow: discard bytes until the next pause. */
    if (n == 0 || t_ns - state->last_ns > GAP_NS) {
        state->n = 0;
        state->skips = n == 0;
    }
    for (size_t i = 0; i < n; i++) {
        if (state->skips)
            continue;
        state->bytes[state->n++] = bytes[i];
        if (state->n < (state->has_settings ? WB_TIC_STATUS_BYTES : WB_TIC_SETTINGS_BYTES))
            continue;
        take_answer(state, t_ns, sink);
        state->n = 0;
        state->waits = false;
    }
    state->last_ns = t_ns;
}

/* --- sending --- */

static bool send_byte(struct wb_outbox *outbox, uint8_t byte)
{
    return wb_outbox_add(outbox, &byte, 1);
}

static bool send_long(struct wb_outbox *outbox, uint8_t command, int32_t value)
{
    uint8_t bytes[WB_TIC_LONG_BYTES];
    wb_tic_encode_long(bytes, command, value);
    return wb_outbox_add(outbox, bytes, sizeof bytes);
}

static enum wb_status sent(bool fits)
{
    if (!fits)
        return wb_fail(WB_ERR_MEMORY, "too many commands to the stage are waiting to be sent");
    return WB_OK;
}

static void ask(struct tic_state *state, struct wb_outbox *outbox)
{
    uint8_t bytes[WB_TIC_ASK_BYTES];
    const size_t n = state->has_settings ? wb_tic_ask_status(bytes) : wb_tic_ask_settings(bytes);
    if (!wb_outbox_add(outbox, bytes, n))
        return;
    state->waits = true;
    state->asked_ns = state->now_ns;
    const int64_t period = state->now_ns < state->fast_until_ns ? FAST_POLL_NS : POLL_NS;
    state->next_poll_ns = state->now_ns + wb_driver_period_ns(&state->rig, period);
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct tic_state *const state = opaque;
    state->now_ns = now_ns;
    state->next_life_ns = now_ns;
    ask(state, outbox);
}

/* Wakes the Tic to normal operation. It keeps its position, whatever its old target. */
static void wake(struct tic_state *state, struct wb_outbox *outbox)
{
    if (state->status.operation == WB_TIC_NORMAL) {
        state->wakes = false;
        return;
    }
    if (state->now_ns < state->next_wake_ns)
        return;
    state->next_wake_ns = state->now_ns + WAKE_NS;
    if (send_long(outbox, WB_TIC_SET_TARGET_VELOCITY, 0) && send_byte(outbox, WB_TIC_ENERGIZE))
        (void)send_byte(outbox, WB_TIC_EXIT_SAFE_START);
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct tic_state *const state = opaque;
    state->now_ns = now_ns;
    if (now_ns >= state->next_life_ns && send_byte(outbox, WB_TIC_RESET_COMMAND_TIMEOUT)) {
        const int64_t timeout_ns = state->settings.command_timeout_ms * WB_NS_PER_MS;
        const bool is_short = timeout_ns > 0 && timeout_ns < LIVES_PER_TIMEOUT * POLL_NS;
        state->next_life_ns = now_ns + (is_short ? timeout_ns / LIVES_PER_TIMEOUT : POLL_NS);
    }
    if (state->wakes && state->has_status)
        wake(state, outbox);
    if (state->waits ? now_ns - state->asked_ns > ANSWER_NS : now_ns >= state->next_poll_ns)
        ask(state, outbox);
}

static void poll_soon(struct tic_state *state)
{
    state->next_poll_ns = state->now_ns;
    state->fast_until_ns = state->now_ns + FAST_NS;
    state->idle_reports = 0;
}

/* False while a motion cannot be started yet; the caller tries again. */
static bool can_move(struct tic_state *state)
{
    const bool stands = state->has_status && state->idle_reports >= 2;
    const bool obeys = state->status.operation == WB_TIC_NORMAL;
    state->wakes = stands && !obeys;
    return stands && obeys;
}

static enum wb_status start_jog(struct tic_state *state, double distance, double speed,
                                struct wb_outbox *outbox)
{
    const double steps = state->rig.stage.steps;
    const double way = round(distance * steps), rate = round(speed * steps / WB_TIC_SPEED_UNIT);
    if (!(fabs(way) >= 1.0) || !(rate >= 1.0) || !(rate <= WB_TIC_MOST_SPEED))
        return wb_fail(
            WB_ERR_ARGUMENT,
            "jog by %g mm at %g mm/s: expected at least one step of %g mm and a speed of "
            "at most %g mm/s",
            distance / WB_MM, speed / WB_MM, 1.0 / steps / WB_MM,
            WB_TIC_MOST_SPEED * WB_TIC_SPEED_UNIT / steps / WB_MM);
    if (!can_move(state))
        return WB_ERR_BUSY;
    const double target = state->status.position + way * state->rig.stage.down;
    if (!(fabs(target) <= INT32_MAX))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the Tic counts to %" PRId32
                       " steps, but the target is %.0f: home the stage",
                       INT32_MAX, target);
    state->idle_reports = 0;
    return sent(send_long(outbox, WB_TIC_SET_MAX_SPEED, (int32_t)rate) &&
                send_long(outbox, WB_TIC_SET_TARGET_POSITION, (int32_t)target));
}

static enum wb_status start_homing(struct tic_state *state, struct wb_outbox *outbox)
{
    /* The limit switch is at the upper end. */
    const bool forward = state->rig.stage.down < 0;
    const uint8_t bytes[] = {WB_TIC_GO_HOME, forward};
    if (state->has_settings && !wb_tic_has_limit_switch(&state->settings, forward))
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the Tic has no limit switch to home to: choose Limit switch %s for one of "
                       "its pins in Tic Control Center, Advanced settings",
                       forward ? "forward" : "reverse");
    if (state->state == WB_STAGE_ALARM)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the Tic cannot home (%s): remove the cause, then run 'unlock'",
                       wb_tic_alarm_text(wb_tic_alarm(state->status.errors)));
    if (!can_move(state))
        return WB_ERR_BUSY;
    state->idle_reports = 0;
    return sent(wb_outbox_add(outbox, bytes, sizeof bytes));
}

static enum wb_status command(void *opaque, enum wb_stage_command what, double distance,
                              double speed, struct wb_outbox *outbox)
{
    struct tic_state *const state = opaque;
    switch (what) {
    case WB_STAGE_COMMAND_JOG:
        return start_jog(state, distance, speed, outbox);
    case WB_STAGE_COMMAND_HOLD:
    case WB_STAGE_COMMAND_JOG_CANCEL:
        state->wakes = false;
        poll_soon(state);
        return sent(send_long(outbox, WB_TIC_SET_TARGET_VELOCITY, 0));
    case WB_STAGE_COMMAND_RESUME:
        return WB_OK; /* a stopped Tic is idle: nothing to resume */
    case WB_STAGE_COMMAND_SOFT_RESET:
        state->wakes = false;
        poll_soon(state);
        return sent(send_byte(outbox, WB_TIC_HALT_AND_HOLD));
    case WB_STAGE_COMMAND_HOME:
        return start_homing(state, outbox);
    case WB_STAGE_COMMAND_UNLOCK:
        poll_soon(state);
        state->wakes = true;
        return sent(send_byte(outbox, WB_TIC_CLEAR_DRIVER_ERROR));
    case WB_STAGE_COMMAND_STATUS:
        if (!state->waits)
            ask(state, outbox);
        return WB_OK;
    }
    return wb_fail(WB_ERR_ARGUMENT, "unknown stage command %d", (int)what);
}

static bool ready(const void *opaque)
{
    const struct tic_state *const state = opaque;
    return state->has_settings && state->has_status;
}

/* No `stop`: stopping the motion is the caller's decision; without timeout resets the Tic stops. */
const struct wb_driver wb_stage_tic = {
    .name = "tic",
    .role = WB_ROLE_STAGE,
    .state_size = sizeof(struct tic_state),
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .command = command,
    .ready = ready,
};
