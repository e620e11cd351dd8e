#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/units.h"
#include "daq/bend_test_private.h"

#define CHECK_TIMEOUT_NS (5 * WB_NS_PER_S)

/* --- connecting --- */

static void complain_silence(struct wb_bend_test *test)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const double waited = test->request.connect_timeout;
    const struct wb_acquisition_stream_state *const load = &latest->stream[WB_ROLE_LOAD];
    const struct wb_acquisition_stream_state *const mocap = &latest->stream[WB_ROLE_MOCAP];
    const struct wb_acquisition_stream_state *const stage = &latest->stream[WB_ROLE_STAGE];
    if (!latest->has_load && load->bytes > 0)
        wb_bend_test_give_up(test, WB_INTERLOCK_STREAM_LOST,
                             "the load cell at %s sent %" PRIu64
                             " bytes, but no reading that can be decoded: "
                             "check load_cell.protocol, its line settings and its unit",
                             test->rig.load_cell.address, load->bytes);
    else if (!latest->has_load)
        wb_bend_test_give_up(
            test, WB_INTERLOCK_STREAM_LOST,
            "the load cell at %s sent nothing within %g s: check power, cable and baud rate",
            test->rig.load_cell.address, waited);
    else if (!latest->has_stage)
        wb_bend_test_give_up(test, WB_INTERLOCK_STREAM_LOST,
                             "the stage at %s gave no status within %g s (%" PRIu64
                             " bytes came): check power, cable and stage.protocol",
                             test->rig.stage.address, waited, stage->bytes);
    else if (mocap->bytes == 0)
        wb_bend_test_give_up(
            test, WB_INTERLOCK_STREAM_LOST,
            "no NatNet answer from %s within %g s: check that the server streams, its address "
            "and the firewall of its computer",
            test->rig.mocap.address, waited);
    else
        wb_bend_test_give_up(
            test, WB_INTERLOCK_STREAM_LOST,
            "the NatNet server at %s answers but sent no frame within %g s: check that it "
            "streams live frames with labelled markers%s",
            test->rig.mocap.address, waited,
            strstr(test->rig.mocap.address, "group=") ? ", and its multicast group" : "");
}

static bool gone(const struct wb_bend_test *test, enum wb_role role)
{
    return wb_acquisition_latest(test->acquisition)->stream[role].gone;
}

/* --- start check --- */

static void refuse(struct wb_bend_test *test, const char *text)
{
    wb_acquisition_event(test->acquisition, "check", "refused: %s", text);
    wb_bend_test_give_up(test, WB_INTERLOCK_STAGE, "start check: %s", text);
}

void wb_bend_test_arm(struct wb_bend_test *test)
{
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &test->rig);
    /* The return ends at the start; beyond it nothing is known to be free. */
    settings.rise = 1.0 * WB_MM;
    if (!test->has_tare)
        settings.force = 0.0;
    wb_acquisition_arm(test->acquisition, &settings, test->start_position);
    wb_acquisition_set_tare(test->acquisition, test->unloaded);
}

void wb_bend_test_step_connect(struct wb_bend_test *test, int64_t now_ns)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const int64_t allowed_ns =
        wb_ns_from_seconds(test->request.connect_timeout) + test->rig.load_cell.settle_ns;
    if (wb_interrupted())
        wb_bend_test_give_up(test, WB_INTERLOCK_INTERRUPT, "stopped by the operator");
    else if (gone(test, WB_ROLE_LOAD))
        wb_bend_test_give_up(test, WB_INTERLOCK_STREAM_LOST, "the load cell's port %s went away",
                             test->rig.load_cell.address);
    else if (gone(test, WB_ROLE_STAGE))
        wb_bend_test_give_up(test, WB_INTERLOCK_STREAM_LOST, "the stage's port %s went away",
                             test->rig.stage.address);
    else if (wb_writer_status(test->writer) != WB_OK)
        wb_bend_test_give_up(test, WB_INTERLOCK_DISK, "the recording cannot be written");
    else if (latest->has_load && latest->has_mocap && latest->has_stage &&
             latest->stream[WB_ROLE_MOCAP].ready && latest->stream[WB_ROLE_LOAD].ready &&
             latest->stream[WB_ROLE_STAGE].ready) {
        test->result.recorded = true;
        /* Before the interlock, whose message would be the poorer one. */
        char text[WB_START_CHECK_TEXT];
        if (!wb_start_check_stage(&latest->stage, test->rig_path, text)) {
            refuse(test, text);
            return;
        }
        wb_bend_test_arm(test);
        wb_bend_test_enter(test, WB_BEND_PHASE_CHECK);
    } else if (now_ns - test->phase_ns > allowed_ns) {
        complain_silence(test);
    }
}

void wb_bend_test_step_check(struct wb_bend_test *test, int64_t now_ns)
{
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(test->acquisition);
    const struct wb_start_check *const check = &test->check;
    const int64_t waited_ns = now_ns - test->phase_ns;
    const bool enough = wb_start_check_enough(check);
    char text[WB_START_CHECK_TEXT];
    if (waited_ns < wb_bend_test_host_ns(test, test->request.check_time) ||
        (!enough && waited_ns < CHECK_TIMEOUT_NS))
        return;
    if (!enough)
        snprintf(text, sizeof text, "only %" PRId64 " readings and %d frames came in %.1f s",
                 check->load.n, check->n_frames, wb_seconds_from_ns(waited_ns));
    if (!enough || !wb_start_check_stage(&latest->stage, test->rig_path, text) ||
        !wb_start_check_markers(check, &test->specimen, text) ||
        !wb_start_check_zero(check, &test->rig, test->rig_path, text)) {
        refuse(test, text);
        return;
    }
    test->start_position = latest->stage.position;
    wb_acquisition_event(test->acquisition, "check",
                         "passed: %d markers seen, zero %.3f mN, noise %.4f mN, travel %g mm free",
                         test->specimen.n_markers, check->load.mean / WB_MN,
                         wb_average_deviation(&check->load) / WB_MN, test->request.travel / WB_MM);
    wb_bend_test_arm(test);
    wb_bend_test_enter(test, WB_BEND_PHASE_TARE);
}
