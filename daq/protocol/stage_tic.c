/* A stage on a Pololu Tic. A way is one target; the Tic's own watchdog, its command timeout, brings
 * the stage to rest when this program dies, hangs or loses its cable: it is told that we live as
 * long as we do, and a Tic whose timeout is off or long is not moved.
 *
 * Answers have no frame. What is asked is chosen so that there are two kinds, of different length:
 * first the settings, until they have come, then nothing but the status. Bytes that stop amid an
 * answer are dropped once nothing more came for a while; so what is decoded depends on the received
 * bytes and their times only. */
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
#define FAST_POLL_NS (100 * WB_NS_PER_MS) /* for a while after a stop */
#define FAST_NS (1000 * WB_NS_PER_MS)
#define ANSWER_NS (500 * WB_NS_PER_MS) /* it takes 25 ms at 9600 baud; then it is asked again */
#define GAP_NS (80 * WB_NS_PER_MS)     /* within an answer */
#define WAKE_NS (100 * WB_NS_PER_MS)   /* between two attempts to start the Tic up */
#define LIVES_PER_TIMEOUT 4            /* signs of life within the command timeout */
#define LEAST_TIMEOUT_MS 100           /* or a busy computer would stop the stage by itself */
#define MOST_TIMEOUT_MS 2000

struct tic_state {
    struct wb_rig rig;
    uint8_t bytes[WB_TIC_SETTINGS_BYTES]; /* of the answer that is coming in */
    size_t n;
    int64_t last_ns; /* arrival of the last byte, or of word that some are missing */
    bool skips;      /* what comes is not understood: up to the next gap */
    /* What the Tic told. */
    bool has_settings, has_status;
    struct wb_tic_settings settings;
    struct wb_tic_status status; /* the last one */
    enum wb_stage_state state;   /* and what it means */
    bool was_reset;
    uint64_t n_refused;
    int idle_reports; /* in a row since the last command */
    /* For sending. */
    bool waits; /* for an answer */
    int64_t now_ns, asked_ns, next_poll_ns, next_life_ns, fast_until_ns;
    bool wakes; /* the Tic shall start up, because a motion is wanted */
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

/* Why the stage must not be moved as the Tic is set, with how to mend it; "" when it may. */
static void find_fault(const struct wb_tic_settings *tic, char *text, size_t size)
{
    static const char *const where = "in Tic Control Center, Input and motor settings";
    text[0] = '\0';
    if (tic->control_mode != 0)
        snprintf(
            text, size,
            "the Tic's control mode is %d, and it does not obey its serial port: choose Serial "
            "/ I2C / USB %s",
            tic->control_mode, where);
    else if (tic->command_timeout_ms == 0)
        snprintf(text, size,
                 "the Tic's command timeout is off (setting 0x09 is 0), so that the stage would go "
                 "on when this computer dies: enable it with 1000 ms %s",
                 where);
    else if (tic->command_timeout_ms < LEAST_TIMEOUT_MS ||
             tic->command_timeout_ms > MOST_TIMEOUT_MS)
        snprintf(text, size,
                 "the Tic's command timeout (setting 0x09) is %d ms: set it to %d to %d ms %s; the "
                 "stage continues that long when this computer fails",
                 tic->command_timeout_ms, LEAST_TIMEOUT_MS, MOST_TIMEOUT_MS, where);
    else if (tic->soft_error_response == WB_TIC_GO_TO_POSITION)
        snprintf(text, size,
                 "the Tic goes to a position of its own when this computer dies (soft error "
                 "response): choose Decelerate to hold in Tic Control Center, Advanced settings");
}

static void tell_settings(struct tic_state *state, int64_t t_ns, const struct wb_sink *sink)
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
        "%g mm/s, the stage moves at most %.3f mm further",
        settings.speed / WB_MM, settings.acceleration / WB_MM, tic->command_timeout_ms,
        state->rig.stage.speed / WB_MM, alone / WB_MM);
    if (settings.fault[0])
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings", "%s", settings.fault);
    if (settings.powers_off)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "settings",
                         "the Tic switches its motor off when this computer falls silent, and the "
                         "clamp may sag: set its soft error response to Decelerate to hold");
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

/* True when a bit of errors or flags is set that was not before. */
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
                         "the Tic answers, operation state %d", now->operation);
    else if (now->up_time_ms < before->up_time_ms)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "reset",
                         "the Tic was reset: its position is not known, home the stage");
    if (alarm != 0 && (!state->has_status || alarm != wb_tic_alarm(before->errors)))
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "alarm", "%s", wb_tic_alarm_text(alarm));
    /* Our first word after a silence clears the timeout's own bit, but not that it was obeyed. */
    if (state->has_status && before->velocity != 0 && before->operation == WB_TIC_NORMAL &&
        now->operation == WB_TIC_SOFT_ERROR && alarm == 0)
        wb_driver_remark(sink, WB_LOG_ERROR, t_ns, "timeout",
                         "the Tic heard nothing from this computer for %d ms and stopped the stage",
                         state->settings.command_timeout_ms);
    /* Homing presses its switch and knows no position before: nothing to warn of. */
    const bool homes = (before->flags | now->flags) & WB_TIC_HOMING;
    if (rises(before->flags, now->flags, limits))
        wb_driver_remark(sink, homes ? WB_LOG_INFO : WB_LOG_WARNING, t_ns, "switch",
                         "a limit switch is pressed");
    if (!homes && rises(before->flags, now->flags, WB_TIC_POSITION_UNCERTAIN))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "position",
                         "the Tic is not certain of its position: home the stage, or continue from "
                         "its present place");
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
            tell_settings(state, t_ns, sink);
    }
    state->skips = !understood;
    state->n_refused += !understood;
    if (!understood && wb_driver_is_report_due(state->n_refused))
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "refused",
            "an answer of the Tic is not understood and dropped: check the baud rate in "
            "stage.address; %" PRIu64 " so far",
            state->n_refused);
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct tic_state *const state = opaque;
    /* Where bytes are missing, the rest of an answer may follow: up to the next silence. */
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
        return wb_fail(WB_ERR_MEMORY, "the stage takes no more commands: too many wait to be sent");
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
    const double scale = state->rig.time_scale > 1.0 ? state->rig.time_scale : 1.0;
    const int64_t period = state->now_ns < state->fast_until_ns ? FAST_POLL_NS : POLL_NS;
    state->next_poll_ns = state->now_ns + (int64_t)((double)period / scale);
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct tic_state *const state = opaque;
    state->now_ns = now_ns;
    state->next_life_ns = now_ns;
    ask(state, outbox);
}

/* What brings a Tic that rests into its normal operation; it still stands then, whatever its target
 * was before. */
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

/* False while a motion cannot begin yet; the caller tries again. */
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
        return wb_fail(WB_ERR_ARGUMENT,
                       "cannot jog by %g mm at %g mm/s: at least one step of %g mm and a speed of "
                       "at most %g mm/s are needed",
                       distance / WB_MM, speed / WB_MM, 1.0 / steps / WB_MM,
                       WB_TIC_MOST_SPEED * WB_TIC_SPEED_UNIT / steps / WB_MM);
    if (!can_move(state))
        return WB_ERR_BUSY;
    const double target = state->status.position + way * state->rig.stage.down;
    if (!(fabs(target) <= INT32_MAX))
        return wb_fail(WB_ERR_ARGUMENT,
                       "the Tic counts to %" PRId32 " steps, and a way to %.0f is wanted: home the "
                       "stage",
                       INT32_MAX, target);
    state->idle_reports = 0;
    return sent(send_long(outbox, WB_TIC_SET_MAX_SPEED, (int32_t)rate) &&
                send_long(outbox, WB_TIC_SET_TARGET_POSITION, (int32_t)target));
}

static enum wb_status start_homing(struct tic_state *state, struct wb_outbox *outbox)
{
    /* The switch is above. */
    const bool forward = state->rig.stage.down < 0;
    const uint8_t bytes[] = {WB_TIC_GO_HOME, forward};
    if (state->has_settings && !wb_tic_has_limit_switch(&state->settings, forward))
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the Tic has no limit switch to home to: choose Limit switch %s for one of "
                       "its pins in Tic Control Center, Advanced settings",
                       forward ? "forward" : "reverse");
    if (state->state == WB_STAGE_ALARM)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the Tic cannot home (%s): mend the cause, then run 'unlock'",
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
        return WB_OK; /* a stage that was stopped is idle, and needs no word to go on */
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

/* No `stop`: whether the stage may go on is the caller's decision, and without our signs of life it
 * does not. */
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
