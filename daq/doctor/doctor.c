#include "daq/doctor/doctor.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/disk_check.h"
#include "daq/acquire/listening.h"
#include "daq/doctor/doctor_items.h"
#include "daq/doctor/doctor_seen.h"
#include "daq/doctor/marker_picture.h"

#define WB_LOG_DOMAIN "doctor"

/* Time at each baud rate that is tried. */
#define LISTENING_NS (1200 * WB_NS_PER_MS)

enum phase {
    PHASE_CONNECT,
    PHASE_LISTEN,
    PHASE_DONE
};

struct wb_doctor {
    struct wb_doctor_request request;
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_acquisition *acquisition;
    struct wb_doctor_seen seen;
    enum phase phase;
    int64_t phase_ns;
};

static const struct wb_setting rows[] = {
    {WB_ROW_QUANTITY(wb_doctor_request, seconds, "seconds", "s", 1.0, 0.5, 600.0, 4.0),
     WB_ROW_OPTION("seconds", "T", "How long data of the instruments are received")},
};

const struct wb_setting_table wb_doctor_table = {WB_SETTING_ROWS(rows)};

void wb_doctor_default_request(struct wb_doctor_request *request)
{
    memset(request, 0, sizeof *request);
    wb_bend_test_default_request(&request->test);
    wb_setting_fill(&wb_doctor_table, request);
}

const char *wb_doctor_verdict_name(enum wb_doctor_verdict verdict)
{
    static const char *const names[] = {[WB_DOCTOR_READY] = "ready",
                                        [WB_DOCTOR_NOTE] = "note",
                                        [WB_DOCTOR_UNKNOWN] = "not known",
                                        [WB_DOCTOR_NOT_READY] = "NOT READY"};
    return names[verdict];
}

bool wb_doctor_is_ready(const struct wb_doctor_report *report)
{
    for (int i = 0; i < report->n; i++)
        if (report->items[i].verdict == WB_DOCTOR_NOT_READY)
            return false;
    return true;
}

static void enter(struct wb_doctor *doctor, enum phase phase)
{
    doctor->phase = phase;
    doctor->phase_ns = wb_time_now_ns();
}

static enum wb_status start(struct wb_doctor *doctor)
{
    struct wb_doctor_seen *const seen = &doctor->seen;
    const struct wb_bend_test_request *const test = &doctor->request.test;
    WB_TRY(wb_rig_read(test->rig_path, &doctor->rig));
    if (test->specimen_path)
        WB_TRY(wb_specimen_read(test->specimen_path, &doctor->specimen));
    /* Motive records a take only during a test. */
    doctor->rig.mocap.record_take = false;
    seen->rig = &doctor->rig;
    seen->specimen = test->specimen_path ? &doctor->specimen : NULL;
    seen->waited = test->connect_timeout;
    const struct wb_sink sink = wb_doctor_seen_sink(seen);
    WB_TRY(wb_acquisition_open_each(&doctor->acquisition, &doctor->rig, WB_ACQUISITION_ALL, &sink,
                                    seen->opening));
    seen->source = &wb_acquisition_latest(doctor->acquisition)->source;
    wb_acquisition_start(doctor->acquisition, NULL);
    enter(doctor, PHASE_CONNECT);
    return WB_OK;
}

enum wb_status wb_doctor_open(struct wb_doctor **out, const struct wb_doctor_request *request)
{
    struct wb_doctor *const doctor = calloc(1, sizeof *doctor);
    if (!doctor)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the check of the bench");
    doctor->request = *request;
    const enum wb_status status = start(doctor);
    if (status != WB_OK) {
        wb_acquisition_close(doctor->acquisition);
        free(doctor);
        return status;
    }
    *out = doctor;
    return WB_OK;
}

/* Whether all instruments that were opened are ready and have sent samples. */
static bool are_ready(const struct wb_acquisition_latest *latest)
{
    const struct wb_acquisition_stream_state *const stream = latest->stream;
    const bool has[WB_INTERLOCK_ROLES] = {[WB_ROLE_LOAD] = latest->has_load,
                                          [WB_ROLE_MOCAP] = latest->has_mocap,
                                          [WB_ROLE_STAGE] = latest->has_stage};
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        if (stream[role].open && !stream[role].gone && !(stream[role].ready && has[role]))
            return false;
    return true;
}

bool wb_doctor_step(struct wb_doctor *doctor, int64_t timeout_ns)
{
    if (doctor->phase == PHASE_DONE)
        return false;
    const bool ended =
        wb_acquisition_step(doctor->acquisition, timeout_ns) != WB_ACQUISITION_CONTINUE;
    const int64_t lasted_ns = wb_time_now_ns() - doctor->phase_ns;
    const int64_t allowed_ns =
        wb_ns_from_seconds(doctor->request.test.connect_timeout) + doctor->rig.load_cell.settle_ns;
    if (ended || wb_interrupted()) {
        enter(doctor, PHASE_DONE);
    } else if (doctor->phase == PHASE_CONNECT &&
               (are_ready(wb_acquisition_latest(doctor->acquisition)) || lasted_ns > allowed_ns)) {
        doctor->seen.listening = true;
        enter(doctor, PHASE_LISTEN);
    } else if (doctor->phase == PHASE_LISTEN) {
        doctor->seen.listened = wb_seconds_from_ns(lasted_ns);
        if (doctor->seen.listened >= doctor->request.seconds)
            enter(doctor, PHASE_DONE);
    }
    return doctor->phase != PHASE_DONE;
}

/* Finds the baud rate of a load cell whose bytes cannot be read as text. */
static void find_rate(const struct wb_doctor *doctor, struct wb_doctor_report *report)
{
    const struct wb_acquisition_stream_state *const load =
        &doctor->seen.latest.stream[WB_ROLE_LOAD];
    const char *const address = doctor->rig.load_cell.address;
    const struct wb_listening_settings settings = {.patience_ns = LISTENING_NS};
    struct wb_listening heard;
    struct wb_reason why = {0};
    if (!load->open || doctor->seen.latest.has_load || doctor->seen.latest.unit_contradicts ||
        wb_diagnosis_kind(&load->heard) != WB_DIAGNOSIS_NOISE)
        return;
    if (wb_listening_run(address, &settings, &heard, &why) != WB_OK ||
        heard.found != WB_LISTENING_LOAD_CELL)
        return;
    wb_doctor_add(report, "load cell", WB_DOCTOR_NOT_READY,
                  "readings are received with %s ('%s'): set load_cell.address: %.*s,%s",
                  heard.line, heard.sample, (int)strcspn(address, ","), address, heard.line);
}

static void judge_disk(const struct wb_doctor *doctor, struct wb_doctor_report *report)
{
    const char *const folder = doctor->request.folder ? doctor->request.folder : ".";
    struct wb_disk_check check;
    struct wb_reason why = {0};
    char text[WB_DISK_CHECK_TEXT];
    double bytes = 0.0;
    if (wb_disk_check_measure(&check, folder, &why) != WB_OK) {
        wb_doctor_add(report, "disk", WB_DOCTOR_NOT_READY, "%s", why.text);
        return;
    }
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        bytes += (double)doctor->seen.latest.stream[role].bytes;
    const bool good = wb_disk_check_judge(
        &check, folder, doctor->seen.listened > 0.0 ? bytes / doctor->seen.listened : 0.0,
        wb_doctor_test_duration(&doctor->request.test, &doctor->rig), text);
    wb_doctor_add(report, "disk", good ? WB_DOCTOR_READY : WB_DOCTOR_NOT_READY, "%s", text);
}

void wb_doctor_close(struct wb_doctor *doctor, struct wb_doctor_report *report)
{
    struct wb_doctor_seen *const seen = &doctor->seen;
    if (report) {
        memset(report, 0, sizeof *report);
        /* The copy has pointers into the acquisition, which is therefore closed after judging. */
        seen->latest = *wb_acquisition_latest(doctor->acquisition);
        report->is_virtual = doctor->rig.is_virtual;
        wb_doctor_judge(seen, &doctor->request.test, report);
        if (seen->n_frames > 0)
            wb_marker_picture(&seen->frame, seen->specimen, doctor->rig.mocap.up, report->picture,
                              sizeof report->picture);
    }
    wb_acquisition_close(doctor->acquisition);
    if (report) {
        find_rate(doctor, report);
        judge_disk(doctor, report);
    }
    free(doctor);
}
