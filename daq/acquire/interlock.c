#include "daq/acquire/interlock.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "base/units.h"
#include "daq/protocol/tic.h"

/* Period of status queries while the stop is not confirmed: several within the deadline, but not
 * faster than a controller replies. */
#define ASK_PERIOD_NS (60 * WB_NS_PER_MS)

const char *wb_interlock_reason_name(enum wb_interlock_reason reason)
{
    static const char *const names[] = {
        [WB_INTERLOCK_NONE] = "none",         [WB_INTERLOCK_FORCE] = "force",
        [WB_INTERLOCK_OVERLOAD] = "overload", [WB_INTERLOCK_UNIT] = "unit",
        [WB_INTERLOCK_TRAVEL] = "travel",     [WB_INTERLOCK_ALARM] = "alarm",
        [WB_INTERLOCK_STAGE] = "stage",       [WB_INTERLOCK_STREAM_LOST] = "stream_lost",
        [WB_INTERLOCK_DISK] = "disk",         [WB_INTERLOCK_MOTION] = "motion",
        [WB_INTERLOCK_DROP] = "force_drop",   [WB_INTERLOCK_INTERRUPT] = "interrupt",
    };
    return (size_t)reason < sizeof names / sizeof names[0] ? names[reason] : "unknown";
}

static int64_t later(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

void wb_interlock_default_settings(struct wb_interlock_settings *settings, const struct wb_rig *rig)
{
    int64_t silence = wb_ns_from_seconds(rig->limits.stream_lost / rig->time_scale);
    if (rig->time_scale > 1.0)
        silence = later(silence, WB_INTERLOCK_SILENCE_NS);
    *settings = (struct wb_interlock_settings){
        .force = rig->limits.force > 0.0 ? rig->limits.force : rig->load_cell.overload,
        .overload = rig->load_cell.overload,
        .travel = rig->limits.travel > 0.0 ? rig->limits.travel : rig->stage.travel,
        .down = rig->stage.down,
        .stream_lost_ns = {[WB_ROLE_LOAD] = silence,
                           [WB_ROLE_MOCAP] = silence,
                           [WB_ROLE_STAGE] = later(silence, WB_INTERLOCK_STAGE_SILENCE_NS)},
    };
}

void wb_interlock_init(struct wb_interlock *interlock, const struct wb_interlock_settings *settings,
                       int64_t now_ns)
{
    *interlock = (struct wb_interlock){.settings = *settings, .start_position = (double)NAN};
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        interlock->last_ns[role] = now_ns;
}

bool wb_interlock_trip(struct wb_interlock *interlock, enum wb_interlock_reason reason,
                       int64_t t_ns, const char *format, ...)
{
    if (interlock->reason != WB_INTERLOCK_NONE)
        return false;
    interlock->reason = reason;
    interlock->t_ns = t_ns;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(interlock->text, sizeof interlock->text, format, arguments);
    va_end(arguments);
    return true;
}

static void renew(struct wb_interlock *interlock, enum wb_role role, int64_t t_ns)
{
    interlock->last_ns[role] = t_ns;
    interlock->discounted_ns[role] = 0;
    interlock->lost[role] = false;
}

bool wb_interlock_load(struct wb_interlock *interlock, const struct wb_load_sample *sample)
{
    const struct wb_interlock_settings *const limit = &interlock->settings;
    if (sample->valid || sample->overload)
        renew(interlock, WB_ROLE_LOAD, sample->t_ns);
    if (!interlock->armed)
        return false;
    /* Checked before the overload, which may be an artefact of a wrong unit. */
    if (sample->unit_changed)
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_UNIT, sample->t_ns,
            "the load cell changed its unit during the test: restore the previous unit");
    /* While a loaded specimen is released, the unit of the line is accepted. */
    if (sample->unit_contradicts && !limit->overload_allowed)
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_UNIT, sample->t_ns,
            "the unit that the load cell prints is not load_cell.unit of the rig file: "
            "correct one of them");
    if (sample->overload && !limit->overload_allowed)
        return wb_interlock_trip(interlock, WB_INTERLOCK_OVERLOAD, sample->t_ns,
                                 "the load cell reports overload: the load exceeds its range");
    if (!sample->valid)
        return false;
    if (limit->overload > 0.0 && !(fabs(sample->force) <= limit->overload))
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_OVERLOAD, sample->t_ns,
            "the load cell reads %.1f mN, beyond its overload limit of %.1f mN",
            sample->force / WB_MN, limit->overload / WB_MN);
    if (limit->force > 0.0 && !(fabs(sample->force - interlock->tare) <= limit->force))
        return wb_interlock_trip(interlock, WB_INTERLOCK_FORCE, sample->t_ns,
                                 "the tension is %.1f mN, beyond the force limit of %.1f mN",
                                 (sample->force - interlock->tare) / WB_MN, limit->force / WB_MN);
    return false;
}

void wb_interlock_mocap(struct wb_interlock *interlock, int64_t t_ns)
{
    renew(interlock, WB_ROLE_MOCAP, t_ns);
}

bool wb_interlock_stage(struct wb_interlock *interlock, const struct wb_stage_report *report)
{
    const struct wb_interlock_settings *const limit = &interlock->settings;
    renew(interlock, WB_ROLE_STAGE, report->t_ns);
    if (!interlock->armed)
        return false;
    if (report->state == WB_STAGE_ALARM && limit->alarm_allowed)
        return false;
    if (report->state == WB_STAGE_ALARM && report->alarm >= WB_TIC_ALARM)
        return wb_interlock_trip(interlock, WB_INTERLOCK_ALARM, report->t_ns,
                                 "the stage is in alarm: %s", wb_tic_alarm_text(report->alarm));
    if (report->state == WB_STAGE_ALARM && report->alarm != 0)
        return wb_interlock_trip(interlock, WB_INTERLOCK_ALARM, report->t_ns,
                                 "the stage raised ALARM:%d of its firmware", report->alarm);
    if (report->state == WB_STAGE_ALARM)
        return wb_interlock_trip(interlock, WB_INTERLOCK_ALARM, report->t_ns,
                                 "the stage is in alarm");
    if (report->state == WB_STAGE_HOLD || report->state == WB_STAGE_OTHER)
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_STAGE, report->t_ns,
            report->state == WB_STAGE_HOLD
                ? "the stage entered hold without a command"
                : "the stage left normal operation (door, check or sleep mode)");
    const double travel = limit->down * (report->position - interlock->start_position);
    if (!isfinite(travel))
        return false;
    if (limit->travel > 0.0 && travel > limit->travel)
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_TRAVEL, report->t_ns,
            "the stage has travelled %.2f mm, beyond the travel limit of %.2f mm", travel / WB_MM,
            limit->travel / WB_MM);
    if (limit->rise > 0.0 && travel < -limit->rise)
        return wb_interlock_trip(
            interlock, WB_INTERLOCK_TRAVEL, report->t_ns,
            "the stage is %.2f mm above its start, beyond the limit of %.2f mm", -travel / WB_MM,
            limit->rise / WB_MM);
    return false;
}

static bool expired(const struct wb_interlock *interlock, int role, int64_t now_ns)
{
    const int64_t allowed = interlock->settings.stream_lost_ns[role];
    return allowed > 0 && now_ns >= interlock->last_ns[role] + allowed;
}

bool wb_interlock_expires(const struct wb_interlock *interlock, enum wb_role role, int64_t now_ns)
{
    return !interlock->lost[role] && expired(interlock, (int)role, now_ns);
}

void wb_interlock_discount(struct wb_interlock *interlock, int64_t stalled_ns)
{
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        const int64_t left_ns = WB_INTERLOCK_DISCOUNTED_NS - interlock->discounted_ns[role];
        const int64_t discounted_ns = stalled_ns < left_ns ? stalled_ns : left_ns;
        interlock->discounted_ns[role] += discounted_ns;
        interlock->last_ns[role] += discounted_ns;
    }
}

bool wb_interlock_tick(struct wb_interlock *interlock, int64_t now_ns)
{
    static const char *const names[WB_INTERLOCK_ROLES] = {"load cell", "motion capture", "stage"};
    bool tripped = false;
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        const int64_t allowed = interlock->settings.stream_lost_ns[role];
        if (!expired(interlock, role, now_ns))
            continue;
        interlock->lost[role] = true;
        if (interlock->armed &&
            wb_interlock_trip(interlock, WB_INTERLOCK_STREAM_LOST,
                              interlock->last_ns[role] + allowed,
                              "the %s sent no valid sample for %.2f s", names[role],
                              wb_seconds_from_ns(now_ns - interlock->last_ns[role])))
            tripped = true;
    }
    return tripped;
}

int64_t wb_interlock_deadline(const struct wb_interlock *interlock)
{
    int64_t deadline = INT64_MAX;
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        const int64_t allowed = interlock->settings.stream_lost_ns[role];
        if (allowed > 0 && !interlock->lost[role] && interlock->last_ns[role] + allowed < deadline)
            deadline = interlock->last_ns[role] + allowed;
    }
    return deadline;
}

void wb_stop_begin(struct wb_stop *stop, int64_t now_ns)
{
    *stop = (struct wb_stop){.state = WB_STOP_HOLDING, .hold_ns = now_ns, .next_ask_ns = now_ns};
}

void wb_stop_settle(struct wb_stop *stop, enum wb_stop_state state, int64_t now_ns)
{
    stop->state = state;
    stop->confirmed_ns = now_ns;
}

bool wb_stop_over(const struct wb_stop *stop)
{
    return stop->state == WB_STOP_STANDING || stop->state == WB_STOP_FAILED;
}

void wb_stop_report(struct wb_stop *stop, const struct wb_stage_report *report)
{
    if (stop->state != WB_STOP_HOLDING && stop->state != WB_STOP_RESETTING)
        return;
    bool standing = report->state == WB_STAGE_HOLD || report->state == WB_STAGE_ALARM;
    if (report->state == WB_STAGE_IDLE)
        standing = ++stop->idle_reports >= 2;
    else
        stop->idle_reports = 0;
    if (standing)
        wb_stop_settle(stop, WB_STOP_STANDING, report->t_ns);
}

enum wb_stop_action wb_stop_tick(struct wb_stop *stop, int64_t now_ns)
{
    if (stop->state == WB_STOP_HOLDING && now_ns >= stop->hold_ns + WB_STOP_CONFIRM_NS) {
        stop->state = WB_STOP_RESETTING;
        stop->reset_ns = now_ns;
        stop->next_ask_ns = now_ns + ASK_PERIOD_NS;
        stop->idle_reports = 0;
        return WB_STOP_DO_RESET;
    }
    if (stop->state == WB_STOP_RESETTING && now_ns >= stop->reset_ns + WB_STOP_RESET_NS) {
        wb_stop_settle(stop, WB_STOP_FAILED, now_ns);
        return WB_STOP_DO_NOTHING;
    }
    if ((stop->state == WB_STOP_HOLDING || stop->state == WB_STOP_RESETTING) &&
        now_ns >= stop->next_ask_ns) {
        stop->next_ask_ns = now_ns + ASK_PERIOD_NS;
        return WB_STOP_DO_ASK;
    }
    return WB_STOP_DO_NOTHING;
}

int64_t wb_stop_deadline(const struct wb_stop *stop)
{
    int64_t end;
    if (stop->state == WB_STOP_HOLDING)
        end = stop->hold_ns + WB_STOP_CONFIRM_NS;
    else if (stop->state == WB_STOP_RESETTING)
        end = stop->reset_ns + WB_STOP_RESET_NS;
    else
        return INT64_MAX;
    return stop->next_ask_ns < end ? stop->next_ask_ns : end;
}
