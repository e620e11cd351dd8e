#include <inttypes.h>
#include <math.h>

#include "base/units.h"
#include "daq/bend_test_private.h"

#define LEAST_READINGS 10 /* of a tare */
/* An earlier line that is not answered keeps a motion waiting; the driver stops waiting after 2 s.
 */
#define SEND_NS (4 * WB_NS_PER_S)

void wb_bend_test_try_to_move(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const double speed = test->rig.stage.speed * test->rig.time_scale;
    const double distance = test->target - wb_bend_test_travel_of(test, latest->stage.position);
    const enum wb_status status =
        wb_acquisition_command(test->acquisition, WB_STAGE_COMMAND_JOG, distance, speed);
    test->unsent = status == WB_ERR_BUSY;
    if (status == WB_OK) {
        wb_bend_test_enter(test, test->phase);
        test->stands_since = 0;
        test->reports_seen = latest->stage_reports;
        test->deadline_ns =
            test->phase_ns + wb_ns_from_seconds(1.5 * fabs(distance) / speed) + 5 * WB_NS_PER_S;
    } else if (!test->unsent) {
        wb_bend_test_give_up(
            test, WB_INTERLOCK_STAGE,
            "the motion could not be sent to the stage at %s: check its cable and power",
            test->rig.stage.address);
    } else if (wb_acquisition_now_ns() - test->phase_ns > SEND_NS) {
        test->unsent = false;
        wb_bend_test_give_up(test, WB_INTERLOCK_STAGE,
                             "the stage at %s does not answer an earlier command: check its cable",
                             test->rig.stage.address);
    }
}

/* Starts a motion to `target` (m travel from the start). */
static void move_to(struct wb_bend_test *test, double target, enum wb_bend_phase phase)
{
    test->target = target;
    wb_bend_test_enter(test, phase);
    wb_bend_test_try_to_move(test);
}

/* True when the motion under way has ended at its target; stops the test when it cannot. */
static bool arrived(struct wb_bend_test *test, int64_t now_ns)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    if (latest->stage_reports == test->reports_seen) {
        if (now_ns > test->deadline_ns)
            wb_bend_test_give_up(test, WB_INTERLOCK_STAGE,
                                 "the stage did not arrive at %.2f mm in time",
                                 test->target / WB_MM);
        return false;
    }
    test->reports_seen = latest->stage_reports;
    const double travel = wb_bend_test_travel_of(test, latest->stage.position);
    if (isfinite(travel))
        test->turn_travel = fmax(test->turn_travel, travel);
    if (latest->stage.state != WB_STAGE_IDLE) {
        test->stands_since = 0;
        if (now_ns > test->deadline_ns)
            wb_bend_test_give_up(test, WB_INTERLOCK_STAGE,
                                 "the stage is at %.2f mm and did not arrive at %.2f mm in time",
                                 travel / WB_MM, test->target / WB_MM);
        return false;
    }
    if (fabs(travel - test->target) <= WB_BEND_POSITION_TOLERANCE) {
        wb_acquisition_motion_ended(test->acquisition);
        return true;
    }
    /* The first idle reports may be older than the command. */
    test->stands_since++;
    const bool refused = latest->stage_error[0] && test->stands_since >= 2;
    if (!refused && (test->stands_since < 5 || now_ns - test->phase_ns <= WB_NS_PER_S))
        return false;
    /* It stands: no hold is needed, which would only have to be released again. */
    wb_acquisition_motion_ended(test->acquisition);
    wb_bend_test_give_up(test, WB_INTERLOCK_STAGE,
                         "the stage stands at %.2f mm instead of %.2f mm%s%s", travel / WB_MM,
                         test->target / WB_MM, refused ? ": " : "",
                         refused ? latest->stage_error : "");
    return false;
}

static void begin_cycle(struct wb_bend_test *test)
{
    test->cycle++;
    test->turn_travel = 0.0;
    test->result.started = true;
    wb_acquisition_event(test->acquisition, "cycle_start", "%d", test->cycle);
    move_to(test, test->request.travel, WB_BEND_PHASE_DOWN);
}

void wb_bend_test_step_tare(struct wb_bend_test *test, int64_t now_ns)
{
    if (now_ns - test->phase_ns < wb_bend_test_host_ns(test, test->request.tare_time) ||
        test->zero.n < LEAST_READINGS)
        return;
    test->tare = test->zero.mean;
    test->unloaded = test->tare - wb_rig_tare_load(&test->rig);
    test->has_tare = true;
    wb_acquisition_event(test->acquisition, "tare",
                         "{\"force_N\": %.17g, \"samples\": %" PRId64 ", \"sd_N\": %.17g}",
                         test->tare, test->zero.n, wb_average_deviation(&test->zero));
    wb_bend_test_arm(test);
    begin_cycle(test);
}

void wb_bend_test_step_down(struct wb_bend_test *test, int64_t now_ns)
{
    if (!arrived(test, now_ns))
        return;
    wb_acquisition_event(test->acquisition, "turn", "%d", test->cycle);
    move_to(test, 0.0, WB_BEND_PHASE_UP);
}

void wb_bend_test_step_up(struct wb_bend_test *test, int64_t now_ns)
{
    if (arrived(test, now_ns))
        wb_bend_test_enter(test, WB_BEND_PHASE_REST);
}

void wb_bend_test_step_rest(struct wb_bend_test *test, int64_t now_ns)
{
    if (now_ns - test->phase_ns < wb_bend_test_host_ns(test, test->request.rest_time))
        return;
    wb_acquisition_event(test->acquisition, "cycle_end", "%d", test->cycle);
    test->result.cycles_done = test->cycle;
    if (test->cycle < test->request.cycles) {
        begin_cycle(test);
        return;
    }
    wb_bend_test_set_end(test, WB_BEND_TEST_DONE, "%d of %d cycles", test->cycle,
                         test->request.cycles);
    test->result.standing = true;
    wb_bend_test_finish(test);
}
