#include "daq/test/bend_hold.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/json.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "record"

/* Consecutive idle reports that prove a standstill; the first one may be older than the command. */
#define STANDING_REPORTS 2

void wb_bend_hold_begin(struct wb_bend_hold *hold, struct wb_sequence *run, int held,
                        const char *name, int cycle, double tension)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(run->acquisition);
    hold->n++;
    hold->is_on = true;
    hold->stands = false;
    hold->phase = run->phase;
    hold->at_ns = wb_time_now_ns();
    wb_acquisition_event(run->acquisition, WB_BEND_HOLD_START,
                         "{\"cycle\": %d, \"phase\": \"%s\", \"travel_mm\": %.6g, "
                         "\"tension_mN\": %.6g}",
                         cycle, name, wb_sequence_travel(run, latest->stage.position) / WB_MM,
                         tension / WB_MN);
    /* A feed hold would lock a stage that happens to stand between two short jogs. */
    wb_sequence_send(run, WB_STAGE_COMMAND_JOG_CANCEL, 0.0, run->rig.stage.speed, held);
}

double wb_bend_hold_lasts(const struct wb_bend_hold *hold)
{
    return hold->is_on ? wb_seconds_from_ns(wb_time_now_ns() - hold->at_ns) : (double)NAN;
}

static void wait_for_standstill(struct wb_bend_hold *hold, struct wb_sequence *run)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(run->acquisition);
    if (latest->stage_reports != run->reports_seen) {
        run->reports_seen = latest->stage_reports;
        run->idle_reports = latest->stage.state == WB_STAGE_IDLE ? run->idle_reports + 1 : 0;
    }
    hold->stands = run->idle_reports >= STANDING_REPORTS;
    if (hold->stands) {
        wb_acquisition_motion_ended(run->acquisition);
        wb_info("held at %.2f mm: press r to resume, q to end the test",
                wb_sequence_travel(run, latest->stage.position) / WB_MM);
    } else if (wb_sequence_lasts_ns(run) > run->allowed_ns) {
        wb_sequence_give_up(run, WB_INTERLOCK_STAGE,
                            "the stage did not stop in time after the test was put on hold");
    }
}

void wb_bend_hold_step(struct wb_bend_hold *hold, struct wb_sequence *run, double most)
{
    if (!hold->stands)
        wait_for_standstill(hold, run);
    else if (wb_bend_hold_lasts(hold) > most)
        wb_sequence_give_up(run, WB_INTERLOCK_INTERRUPT,
                            "held for longer than %g s without being resumed (--hold-most-s)",
                            most);
}

void wb_bend_hold_end(struct wb_bend_hold *hold, struct wb_sequence *run, const char *how,
                      double tension)
{
    const double lasted = wb_bend_hold_lasts(hold);
    if (!hold->is_on)
        return;
    hold->is_on = false;
    hold->total += lasted;
    wb_acquisition_event(run->acquisition, WB_BEND_HOLD_END,
                         "{\"lasted_s\": %.4g, \"tension_mN\": %.6g, \"how\": \"%s\"}", lasted,
                         tension / WB_MN, how);
}

/* --- reading from a recording --- */

static double number_of(const struct wb_json *json, const char *key, double unit)
{
    double value;
    return wb_json_get_number(json, key, &value) ? value * unit : (double)NAN;
}

enum wb_status wb_bend_hold_read(const struct wb_event *event, struct wb_bend_hold_recorded *hold)
{
    struct wb_json *json;
    struct wb_reason why;
    const char *phase = NULL;
    int64_t cycle = 0;
    if (wb_json_parse_with_reason(&json, event->text, event->kind, &why) != WB_OK)
        return WB_ERR_DATA;
    if (strcmp(event->kind, WB_BEND_HOLD_END) == 0) {
        hold->to_ns = event->t_ns;
        hold->after = number_of(json, "tension_mN", WB_MN);
        wb_json_destroy(json);
        return WB_OK;
    }
    const bool is_ours = wb_json_get_integer(json, "cycle", &cycle) && cycle > 0 &&
                         cycle < INT32_MAX && wb_json_get_text(json, "phase", &phase);
    if (is_ours) {
        *hold = (struct wb_bend_hold_recorded){.from_ns = event->t_ns,
                                               .to_ns = INT64_MAX,
                                               .cycle = (int)cycle,
                                               .travel = number_of(json, "travel_mm", WB_MM),
                                               .before = number_of(json, "tension_mN", WB_MN),
                                               .after = (double)NAN};
        snprintf(hold->phase, sizeof hold->phase, "%s", phase);
    }
    wb_json_destroy(json);
    return is_ours ? WB_OK : WB_ERR_DATA;
}
