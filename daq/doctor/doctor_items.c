#include "daq/doctor/doctor_items.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/acquire/silence_check.h"
#include "daq/acquire/stage_check.h"
#include "daq/test/check_log.h"

/* Accepted relative difference from the announced rate. */
#define RATE_SHARE 0.05
/* Accepted drift over one test, fraction of the cell's capacity. */
#define DRIFT_SHARE 0.01
/* Standard errors that a significant drift exceeds. */
#define DRIFT_ERRORS 5.0
/* s of rig time, accepted typical delay of frames. */
#define LATE_FRAMES 10e-3
/* s, accepted uncertainty of the offset of the cameras' clock. */
#define CLOCK_UNCERTAINTY 2e-3
/* Accepted rate error of the cameras' clock; quartz clocks are within 100 ppm. */
#define CLOCK_DRIFT (200.0 * WB_PPM)
/* Largest tilt of a wire that counts as level, for its bow and a clamp adjusted by eye. */
#define LEVEL (10.0 * WB_DEGREE)
#define LEAST_FULL_FRAMES 5
/* Days after which a new check of the load cell is advised. */
#define CHECK_DAYS 31

void wb_doctor_add(struct wb_doctor_report *report, const char *name,
                   enum wb_doctor_verdict verdict, const char *format, ...)
{
    struct wb_doctor_item *const item =
        &report->items[report->n < WB_DOCTOR_ITEMS ? report->n++ : WB_DOCTOR_ITEMS - 1];
    va_list arguments;
    item->name = name;
    item->verdict = verdict;
    va_start(arguments, format);
    vsnprintf(item->text, sizeof item->text, format, arguments);
    va_end(arguments);
}

double wb_doctor_test_duration(const struct wb_bend_test_request *test, const struct wb_rig *rig)
{
    double time = test->check_time + test->tare_time;
    for (int cycle = 1; cycle <= test->cycles; cycle++)
        time += wb_bend_test_cycle_time(test, rig, cycle);
    return time / rig->time_scale;
}

/* Input of the checks, and the report for their findings. */
struct look {
    const struct wb_doctor_seen *seen;
    const struct wb_bend_test_request *test;
    const struct wb_rig *rig;
    const struct wb_acquisition_latest *latest;
    struct wb_doctor_report *report;
};

#define add(look, name, verdict, ...) wb_doctor_add((look)->report, name, verdict, __VA_ARGS__)

/* Adds the result of a check of `record`: `ready` if it passed, otherwise `text`. */
static void add_check(const struct look *look, const char *name, bool passed, const char *ready,
                      const char *text)
{
    add(look, name, passed ? WB_DOCTOR_READY : WB_DOCTOR_NOT_READY, "%s", passed ? ready : text);
}

static const struct wb_acquisition_stream_state *stream(const struct look *look, enum wb_role role)
{
    return &look->latest->stream[role];
}

/* Whether the instrument is open and sends samples; otherwise adds the finding. */
static bool is_sending(const struct look *look, enum wb_role role, const char *name)
{
    char text[WB_SILENCE_TEXT];
    const struct wb_reason *const why = &look->seen->opening[role];
    if (!stream(look, role)->open)
        add(look, name, WB_DOCTOR_NOT_READY, "%s",
            why->text[0] ? why->text : "it cannot be opened: see the previous message");
    else if (stream(look, role)->gone)
        add(look, name, WB_DOCTOR_NOT_READY,
            "its port was disconnected: check its cable and power");
    else if (!wb_silence_check(role, look->latest, look->rig, look->seen->waited, text))
        add(look, name, WB_DOCTOR_NOT_READY, "%s", text);
    else
        return true;
    return false;
}

static void add_latency(const struct look *look, enum wb_role role, const char *name)
{
    const char *const caution = stream(look, role)->caution;
    if (caution && caution[0])
        add(look, name, WB_DOCTOR_NOT_READY, "%s", caution);
}

/* Adds the warnings of a driver, except the kinds in `reported`, which other findings contain. */
static void add_remarks(const struct look *look, enum wb_role role, const char *name,
                        const char *const reported[])
{
    for (int i = 0; i < look->seen->n_remarks[role]; i++) {
        const struct wb_doctor_remark *const remark = &look->seen->remarks[role][i];
        bool is_reported = remark->level > WB_LOG_WARNING;
        for (int k = 0; reported[k]; k++)
            is_reported = is_reported || strcmp(remark->kind, reported[k]) == 0;
        if (!is_reported)
            add(look, name, WB_DOCTOR_NOTE, "%s", remark->text);
    }
}

/* --- load cell --- */

static void judge_drift(const struct look *look)
{
    double error;
    const double slope = wb_doctor_trend_slope(&look->seen->trend, &error);
    const double capacity = look->rig->load_cell.capacity;
    const double duration = wb_doctor_test_duration(look->test, look->rig);
    const double per_minute = slope / look->rig->time_scale * 60.0;
    if (fabs(slope) > DRIFT_ERRORS * error && fabs(slope) * duration > DRIFT_SHARE * capacity)
        add(look, "drift", WB_DOCTOR_NOTE,
            "the zero drifts by %+.2f mN/min, which is %.1f %% of the capacity over a test: let "
            "the cell warm up, shield it from draught, keep the strand from swinging",
            per_minute / WB_MN, fabs(slope) * duration / capacity / WB_PERCENT);
    else
        add(look, "drift", WB_DOCTOR_READY, "%+.1f mN/min, +- %.1f", per_minute / WB_MN,
            DRIFT_ERRORS * error / look->rig->time_scale * 60.0 / WB_MN);
}

static void judge_zero(const struct look *look)
{
    const struct wb_start_check *const check = &look->seen->check;
    const struct wb_doctor_remark *const overload =
        wb_doctor_seen_remark(look->seen, WB_ROLE_LOAD, "overload");
    char text[WB_START_CHECK_TEXT], ready[120];
    if (overload) {
        add(look, "zero", WB_DOCTOR_NOT_READY,
            "%s: check whether the cell is overloaded or unplugged from its indicator, and "
            "load_cell.unit, scale and capacity_g",
            overload->text);
        return;
    }
    snprintf(ready, sizeof ready, "%.2f mN, noise %.3f mN", check->load.mean / WB_MN,
             wb_average_deviation(&check->load) / WB_MN);
    add_check(look, "zero", wb_start_check_zero(check, look->rig, look->test->rig_path, text),
              ready, text);
    if (check->load.n > 1 && look->seen->trend.lowest == look->seen->trend.highest)
        add(look, "zero", WB_DOCTOR_NOTE,
            "all %" PRId64 " readings are identical: check whether the instrument holds its "
            "display or rounds too coarsely",
            check->load.n);
}

static void judge_last_check(const struct look *look)
{
    char line[WB_CHECK_LOG_LINE], text[WB_CHECK_LOG_LINE];
    const char *const path = look->test->rig_path, *const serial =
                                                       look->rig->load_cell.serial_number;
    struct wb_check_log_entry entry;
    wb_check_log_last(path, line);
    if (!line[0] || !wb_check_log_parse(line, &entry)) {
        add(look, "last check", WB_DOCTOR_NOTE,
            "the load cell was never checked with a known mass: run 'wirebench stage %s check'",
            path);
        return;
    }
    wb_check_log_describe(&entry, text);
    const double days = wb_check_log_age(&entry) / 86400.0;
    if (!entry.passed)
        add(look, "last check", WB_DOCTOR_NOT_READY,
            "%s: correct the cell or its scale, then run 'wirebench stage %s check' again", text,
            path);
    else if (serial[0] && strcmp(entry.serial_number, serial) != 0)
        add(look, "last check", WB_DOCTOR_NOTE,
            "%s, but load_cell.serial_number is %s: run 'wirebench stage %s check'", text, serial,
            path);
    else if (days > CHECK_DAYS)
        add(look, "last check", WB_DOCTOR_NOTE, "%s, %.0f days ago: run 'wirebench stage %s check'",
            text, days, path);
    else
        add(look, "last check", WB_DOCTOR_READY, "%s", text);
}

static void judge_load_cell(const struct look *look)
{
    static const char *const reported[] = {"unit", "overload", NULL};
    const struct wb_acquisition_stream_state *const state = stream(look, WB_ROLE_LOAD);
    const char *const path = look->test->rig_path;
    char text[WB_START_CHECK_TEXT], ready[64] = "agrees with load_cell.unit";
    /* With kg read as g, all readings may be out of range: the unit is reported, not their absence.
     */
    const bool contradicts = look->latest->unit_contradicts;
    if (!contradicts && !is_sending(look, WB_ROLE_LOAD, "load cell")) {
        add_remarks(look, WB_ROLE_LOAD, "load cell", reported);
        return;
    }
    const int64_t n = look->seen->check.load.n;
    const double rate = (double)n / fmax(look->seen->listened, 1e-3);
    const double asked = look->rig->load_cell.poll_period_ns > 0
                             ? 1.0 / wb_seconds_from_ns(look->rig->load_cell.poll_period_ns)
                             : 0.0;
    if (contradicts)
        add(look, "load cell", WB_DOCTOR_READY, "it sends readings");
    else if (n < 10)
        add(look, "load cell", WB_DOCTOR_NOT_READY,
            "only %" PRId64
            " readings in %.1f s: set the instrument to send more often, or poll it "
            "(load_cell.poll_period_ms)",
            n, look->seen->listened);
    else if (state->is_losing)
        add(look, "load cell", WB_DOCTOR_NOT_READY,
            "%.2g %% of its lines never came: check its cable and the load of this computer",
            wb_loss_share(&state->loss) / WB_PERCENT);
    else if (asked > 0.0 && rate < (1.0 - 2.0 * RATE_SHARE) * asked)
        add(look, "load cell", WB_DOCTOR_NOTE,
            "%.1f readings/s are received, but %.1f are requested: raise load_cell.poll_period_ms",
            rate, asked);
    else
        add(look, "load cell", WB_DOCTOR_READY, "%.1f readings/s", rate);
    add_latency(look, WB_ROLE_LOAD, "load cell");
    add_remarks(look, WB_ROLE_LOAD, "load cell", reported);
    if (!look->rig->load_cell.unit[0])
        snprintf(ready, sizeof ready, "taken from its lines");
    add_check(look, "unit", wb_start_check_unit(contradicts, look->rig, path, text), ready, text);
    if (n > 0 && !contradicts) {
        judge_zero(look);
        judge_drift(look);
    }
}

/* --- cameras --- */

static void judge_frames(const struct look *look)
{
    const struct wb_acquisition_stream_state *const state = stream(look, WB_ROLE_MOCAP);
    const struct wb_loss_counts *const loss = &state->loss;
    const double rate = (double)look->seen->n_frames / fmax(look->seen->listened, 1e-3);
    const double announced = look->rig->mocap.frame_rate * look->rig->time_scale;
    const double sent = loss->period > 0.0 ? look->rig->time_scale / loss->period : rate;
    const struct wb_doctor_remark *const remark =
        wb_doctor_seen_remark(look->seen, WB_ROLE_MOCAP, "rate");
    if (look->seen->n_frames < 10)
        add(look, "frames", WB_DOCTOR_NOT_READY,
            "only %ld frames in %.1f s: check the network and the camera rate",
            look->seen->n_frames, look->seen->listened);
    else if (state->is_losing)
        add(look, "frames", WB_DOCTOR_NOT_READY,
            "%.2g %% of the frames never came (%" PRIu64 " in %" PRIu64
            " gaps): use a cable instead of WLAN, check the switch and the load of this computer",
            wb_loss_share(loss) / WB_PERCENT, loss->missing, loss->gaps);
    else if (remark && remark->level <= WB_LOG_WARNING)
        add(look, "frames", WB_DOCTOR_NOT_READY,
            "%s: set the cameras' rate, or mocap.frame_rate_hz", remark->text);
    else if (announced > 0.0 && fabs(sent - announced) > RATE_SHARE * announced)
        add(look, "frames", WB_DOCTOR_NOT_READY,
            "%.1f frames/s are sent, but mocap.frame_rate_hz is %g: correct one of them", sent,
            look->rig->mocap.frame_rate);
    else
        add(look, "frames", WB_DOCTOR_READY, "%.1f frames/s, %" PRIu64 " lost", rate,
            loss->missing);
    if (loss->repeated > 0)
        add(look, "frames", WB_DOCTOR_NOTE,
            "%" PRIu64 " of %" PRIu64 " frames arrive twice, which does no harm: the server is "
            "reached through two network interfaces, or a switch returns the group",
            loss->repeated, loss->received + loss->repeated);
    if (loss->overtaken > 0)
        add(look, "frames", WB_DOCTOR_NOTE,
            "%" PRIu64 " of %" PRIu64 " frames arrive after the next one, probably because there "
            "are several routes through the network; the server's time stamps restore the order",
            loss->overtaken, loss->received);
}

static void judge_lateness(const struct look *look)
{
    const struct wb_doctor_seen *const seen = look->seen;
    struct wb_clock_line line;
    const double scale = look->rig->time_scale;
    if (seen->n_stamps < 10 || wb_clock_fit_envelope(&line, seen->stamps, seen->arrivals,
                                                     seen->n_stamps, 1.0 / scale, 2.0) != WB_OK)
        return;
    const double late = line.scatter * scale;
    if (late > LATE_FRAMES)
        add(look, "delay", WB_DOCTOR_NOTE,
            "frames typically arrive %.0f ms later than the fastest one, which delays the checks "
            "of limits by as much: check the network (WLAN, energy saving of the interface) and "
            "the "
            "load of both computers",
            late * 1e3);
    else
        add(look, "delay", WB_DOCTOR_READY,
            "frames typically arrive %.1f ms later than the fastest one", late * 1e3);
}

static void judge_clock(const struct look *look)
{
    const struct wb_doctor_seen *const seen = look->seen;
    struct wb_clock_line line;
    const double scale = look->rig->time_scale;
    if (seen->n_probes == 0 ||
        wb_clock_fit_probes(&line, seen->probes, seen->n_probes, 1.0 / scale) != WB_OK) {
        add(look, "clock", WB_DOCTOR_NOTE,
            "the server does not report its clock (NatNet before 3.0, or no echo): the earliest "
            "arrivals align it, with an unknown constant error");
        return;
    }
    /* Relative to the host's clock, without the time scale of a virtual rig. */
    const double drift = 1.0 / (line.slope * scale) - 1.0;
    const double error = isfinite(line.slope_uncertainty) ? line.slope_uncertainty * scale : 0.0;
    if (line.uncertainty > CLOCK_UNCERTAINTY)
        add(look, "clock", WB_DOCTOR_NOTE,
            "the cameras' clock is known to %.1f ms only, because round trips through the network "
            "are long: use a cable",
            line.uncertainty * 1e3);
    else if (fabs(drift) > CLOCK_DRIFT + 3.0 * error)
        add(look, "clock", WB_DOCTOR_NOTE,
            "the cameras' clock runs %+.0f ppm relative to this computer's, probably because one "
            "of them is being adjusted; the alignment corrects for it",
            drift / WB_PPM);
    else
        add(look, "clock", WB_DOCTOR_READY,
            "offset known to %.2f ms, scatter %.3f ms of %zu probes", line.uncertainty * 1e3,
            line.scatter * 1e3, line.n_points);
}

static void judge_mode(const struct look *look)
{
    const struct wb_doctor_seen *const seen = look->seen;
    const struct wb_doctor_remark *const restart =
        wb_doctor_seen_remark(seen, WB_ROLE_MOCAP, "restart");
    const struct wb_doctor_remark *const mode = wb_doctor_seen_remark(seen, WB_ROLE_MOCAP, "mode");
    if (restart)
        add(look, "live", WB_DOCTOR_NOT_READY,
            "%s: a take is probably played back in a loop; set Motive to live mode", restart->text);
    else if (mode)
        add(look, "live", WB_DOCTOR_NOTE, "%s: set Motive to live mode", mode->text);
    else
        add(look, "live", WB_DOCTOR_READY, "no sign of a take that is played back");
}

/* Angle (rad) between the wire at rest and the plane normal to an axis, from the frames that show
 * all markers; false if there are too few of them. */
static bool find_tilt(const struct look *look, int axis, double *tilt)
{
    const struct wb_start_check *const check = &look->seen->check;
    const int last = look->seen->specimen->n_markers - 1;
    double way[3], length = 0.0;
    if (check->n_full < LEAST_FULL_FRAMES)
        return false;
    for (int k = 0; k < 3; k++) {
        way[k] = check->place[last][k].mean - check->place[0][k].mean;
        length += way[k] * way[k];
    }
    *tilt = asin(fabs(way[axis]) / sqrt(length));
    return true;
}

/* A level wire at rest only excludes axes from being vertical. */
static void judge_up(const struct look *look)
{
    const char up = look->rig->mocap.up, other = up == 'y' ? 'z' : 'y';
    double tilt, other_tilt;
    if (!find_tilt(look, up - 'x', &tilt) || !find_tilt(look, other - 'x', &other_tilt))
        add(look, "up axis", WB_DOCTOR_UNKNOWN, "not all markers are seen");
    else if (tilt > LEVEL && other_tilt <= LEVEL)
        add(look, "up axis", WB_DOCTOR_NOT_READY,
            "the wire rises by %.0f degrees along %c (mocap.up) and is level with respect to %c: "
            "set mocap.up: %c, or Motive's up axis",
            tilt / WB_DEGREE, up, other, other);
    else if (tilt > LEVEL)
        add(look, "up axis", WB_DOCTOR_NOT_READY,
            "the wire rises by %.0f degrees along %c (mocap.up) and by %.0f along %c: clamp it "
            "level, or set Motive's ground plane",
            tilt / WB_DEGREE, up, other_tilt / WB_DEGREE, other);
    else if (other_tilt > LEVEL)
        add(look, "up axis", WB_DOCTOR_READY,
            "%c: the wire is level with respect to it within %.0f degrees", up,
            ceil(tilt / WB_DEGREE));
    else
        add(look, "up axis", WB_DOCTOR_UNKNOWN,
            "a wire along x at rest cannot distinguish %c from %c: record checks the first 2 mm of "
            "travel; to check it here, turn the bench or the ground plane by 30 degrees",
            up, other);
}

static void judge_markers(const struct look *look)
{
    const struct wb_start_check *const check = &look->seen->check;
    const struct wb_specimen *const specimen = look->seen->specimen;
    char text[WB_START_CHECK_TEXT], ready[96];
    if (!specimen) {
        add(look, "markers", WB_DOCTOR_UNKNOWN,
            "%d are seen; give the specimen file to compare them", look->seen->frame_measured);
        return;
    }
    snprintf(ready, sizeof ready, "all %d of the specimen are seen", specimen->n_markers);
    const bool seen = wb_start_check_markers(check, specimen, text);
    add_check(look, "markers", seen, ready, text);
    if (seen && check->n_full < LEAST_FULL_FRAMES)
        add(look, "scale", WB_DOCTOR_NOT_READY,
            "almost no frame shows all markers: improve the cameras' view of the wire");
    else if (seen) {
        snprintf(ready, sizeof ready, "the markers span %g mm, as in the specimen file",
                 specimen->length / WB_MM);
        add_check(look, "scale", wb_start_check_chain(check, specimen, look->rig, text), ready,
                  text);
    }
    judge_up(look);
}

static void judge_cameras(const struct look *look)
{
    static const char *const reported[] = {"rate", "restart", "mode", NULL};
    if (!is_sending(look, WB_ROLE_MOCAP, "cameras")) {
        add_remarks(look, WB_ROLE_MOCAP, "cameras", reported);
        return;
    }
    const struct wb_doctor_remark *const server =
        wb_doctor_seen_remark(look->seen, WB_ROLE_MOCAP, "connected");
    add(look, "cameras", WB_DOCTOR_READY, "%s", server ? server->text : "the server replies");
    add_remarks(look, WB_ROLE_MOCAP, "cameras", reported);
    judge_frames(look);
    judge_lateness(look);
    judge_clock(look);
    judge_mode(look);
    judge_markers(look);
}

/* --- stage --- */

static void judge_settings(const struct look *look)
{
    const struct wb_acquisition_latest *const latest = look->latest;
    struct wb_reason why = {0};
    char text[WB_INTERLOCK_TEXT], ready[160];
    if (wb_bend_test_check_request(look->test, look->rig, &why) != WB_OK) {
        add(look, "travel", WB_DOCTOR_NOT_READY, "%s", why.text);
        return;
    }
    if (!latest->has_settings) {
        add(look, "travel", WB_DOCTOR_UNKNOWN,
            "the stage does not report its settings: its maximum speed and travel are not checked");
        return;
    }
    snprintf(ready, sizeof ready, "%g mm at %g mm/s is possible%s", look->test->travel / WB_MM,
             look->rig->stage.speed / WB_MM,
             strstr(latest->settings.text, "$22=0")   ? "; no homing ($22=0)"
             : strstr(latest->settings.text, "$22=1") ? "; homing is on ($22=1)"
                                                      : "");
    add_check(look, "travel",
              wb_stage_check_test(&latest->settings, look->rig, latest->stage.position,
                                  look->test->travel, text),
              ready, text);
}

static void judge_stage(const struct look *look)
{
    static const char *const reported[] = {"alarm", "locked", "reset", NULL};
    const char *const path = look->test->rig_path;
    char text[WB_START_CHECK_TEXT], ready[96];
    if (!is_sending(look, WB_ROLE_STAGE, "stage")) {
        add_remarks(look, WB_ROLE_STAGE, "stage", reported);
        return;
    }
    snprintf(ready, sizeof ready, "idle at machine position %.3f mm",
             look->latest->stage.position / WB_MM);
    const bool idle = wb_start_check_stage(&look->latest->stage, path, text);
    add_check(look, "stage", idle, ready, text);
    if (idle && look->latest->stage.was_reset)
        add(look, "stage", WB_DOCTOR_NOTE,
            "its controller restarted when the port was opened and lost its position: a test "
            "counts travel from the present position; for the limits of the firmware to apply, run "
            "'wirebench stage %s home' without the specimen",
            path);
    add_latency(look, WB_ROLE_STAGE, "stage");
    add_remarks(look, WB_ROLE_STAGE, "stage", reported);
    if (idle)
        judge_settings(look);
}

void wb_doctor_judge(const struct wb_doctor_seen *seen, const struct wb_bend_test_request *test,
                     struct wb_doctor_report *report)
{
    const struct look look = {
        .seen = seen, .test = test, .rig = seen->rig, .latest = &seen->latest, .report = report};
    judge_load_cell(&look);
    judge_last_check(&look);
    judge_cameras(&look);
    judge_stage(&look);
}
