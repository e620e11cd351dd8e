/* `doctor` on a bench with one fault at a time: it reports the fault and still checks the other
 * items. */
#include "daq/doctor/doctor.h"

#include "base/interrupt_private.h"
#include "base/log.h"
#include "daq/test/check_log.h"
#include "tests/daq/fake_bench.h"
#include "tests/folder.h"

struct fixture {
    struct fake_bench *bench;
    char folder[32], rig_path[64], specimen_path[64];
    struct wb_doctor_request request;
    struct wb_doctor_report report;
};

static void discard(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)context;
    (void)level;
    (void)domain;
    (void)message;
}

static int set_up(void **state)
{
    struct fixture *const fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    assert_true(temporary_folder_make(fixture->folder));
    snprintf(fixture->rig_path, sizeof fixture->rig_path, "%s/rig.yaml", fixture->folder);
    snprintf(fixture->specimen_path, sizeof fixture->specimen_path, "%s/s.yaml", fixture->folder);
    fixture->bench = fake_start();
    fake_write_rig(fixture->rig_path, false, 1.0);
    fake_write_specimen(fixture->specimen_path);
    wb_doctor_default_request(&fixture->request);
    fixture->request.test.rig_path = fixture->rig_path;
    fixture->request.test.specimen_path = fixture->specimen_path;
    fixture->request.test.connect_timeout = 2.0;
    fixture->request.folder = fixture->folder;
    fixture->request.seconds = 0.6;
    wb_interrupt_set(false);
    wb_log_set_sink(discard, NULL);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *const fixture = *state;
    wb_log_set_sink(NULL, NULL);
    wb_interrupt_set(false);
    fake_stop(fixture->bench);
    const int code = temporary_folder_remove(fixture->folder);
    free(fixture);
    return code;
}

static void run_doctor(struct fixture *fixture)
{
    struct wb_doctor *doctor;
    assert_int_equal(wb_doctor_open(&doctor, &fixture->request), WB_OK);
    while (wb_doctor_step(doctor, 20 * WB_NS_PER_MS)) {
    }
    wb_doctor_close(doctor, &fixture->report);
}

/* Whether the text of an item with this name and verdict contains these words. */
static bool has(const struct fixture *fixture, const char *name, enum wb_doctor_verdict verdict,
                const char *words)
{
    for (int i = 0; i < fixture->report.n; i++) {
        const struct wb_doctor_item *const item = &fixture->report.items[i];
        if (strcmp(item->name, name) == 0 && item->verdict == verdict && strstr(item->text, words))
            return true;
    }
    return false;
}

static void expect(const struct fixture *fixture, const char *name, enum wb_doctor_verdict verdict,
                   const char *words)
{
    if (has(fixture, name, verdict, words))
        return;
    for (int i = 0; i < fixture->report.n; i++)
        print_message("%s: %s: %s\n", fixture->report.items[i].name,
                      wb_doctor_verdict_name(fixture->report.items[i].verdict),
                      fixture->report.items[i].text);
    fail_msg("no item '%s' with verdict %s contains '%s'", name, wb_doctor_verdict_name(verdict),
             words);
}

static void expect_ready(const struct fixture *fixture)
{
    for (int i = 0; i < fixture->report.n; i++) {
        const struct wb_doctor_item *const item = &fixture->report.items[i];
        if (item->verdict == WB_DOCTOR_NOT_READY)
            fail_msg("%s: %s", item->name, item->text);
    }
    assert_true(wb_doctor_is_ready(&fixture->report));
}

static void healthy_bench_is_ready_and_not_moved(void **state)
{
    struct fixture *const fixture = *state;
    run_doctor(fixture);
    expect_ready(fixture);
    expect(fixture, "zero", WB_DOCTOR_READY, "mN, noise");
    expect(fixture, "markers", WB_DOCTOR_READY, "all 7");
    expect(fixture, "scale", WB_DOCTOR_READY, "90 mm");
    expect(fixture, "stage", WB_DOCTOR_READY, "0.000 mm");
    expect(fixture, "travel", WB_DOCTOR_READY, "53 mm at 1 mm/s");
    expect(fixture, "clock", WB_DOCTOR_READY, "probes");
    expect(fixture, "last check", WB_DOCTOR_NOTE, "never");
    expect(fixture, "live", WB_DOCTOR_NOTE, "playing back");
    assert_non_null(strstr(fixture->report.picture, "|   1 "));
    assert_string_equal(fixture->bench->state, "Idle");
    assert_close(fixture->bench->position_mm, 0.0, 0.0);
    assert_int_equal(fixture->bench->holds, 0);
}

static void silent_instruments_are_reported_and_the_others_still_checked(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->load_silent = true;
    fixture->bench->mocap_dead = true;
    run_doctor(fixture);
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "no data within");
    expect(fixture, "cameras", WB_DOCTOR_NOT_READY, "no NatNet reply");
    expect(fixture, "stage", WB_DOCTOR_READY, "idle");
    assert_false(wb_doctor_is_ready(&fixture->report));
    assert_string_equal(fixture->report.picture, "");
}

static void reply_without_data_is_distinguished_from_no_reply(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->mocap_silent = true;
    fixture->bench->stage_silent = true;
    run_doctor(fixture);
    expect(fixture, "cameras", WB_DOCTOR_NOT_READY, "replies but sent no frame");
    expect(fixture, "stage", WB_DOCTOR_NOT_READY, "sent no status");
    expect(fixture, "zero", WB_DOCTOR_READY, "mN");
}

static void load_cell_out_of_range_or_undecodable_is_not_ready(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->force_mg = 5000;
    run_doctor(fixture);
    expect(fixture, "zero", WB_DOCTOR_NOT_READY, "unloaded load cell reads");
    fixture->bench->force_mg = 150;
    fixture->bench->garbage = true;
    run_doctor(fixture);
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "no reading that can be decoded");
    expect(fixture, "load cell", WB_DOCTOR_NOTE, "####");
}

static void actual_baud_rate_of_the_load_cell_is_found(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->load_baud = 38400;
    run_doctor(fixture);
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "not text");
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "with 38400,8n1");
    assert_true(has(fixture, "load cell", WB_DOCTOR_NOT_READY, "sim:fake_cell,38400,8n1"));
}

static void stage_in_alarm_or_too_slow_is_not_ready(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->fastest_mm_min = 30;
    run_doctor(fixture);
    expect(fixture, "travel", WB_DOCTOR_NOT_READY, "$110");
    fixture->bench->raise_alarm = true;
    run_doctor(fixture);
    expect(fixture, "stage", WB_DOCTOR_NOT_READY, "in alarm");
    assert_false(has(fixture, "travel", WB_DOCTOR_READY, ""));
}

static void travel_beyond_the_limits_of_the_rig_is_not_ready(void **state)
{
    struct fixture *const fixture = *state;
    fixture->request.test.travel = 59.0 * WB_MM;
    run_doctor(fixture);
    expect(fixture, "travel", WB_DOCTOR_NOT_READY, "--travel-mm");
}

static void missing_marker_is_counted_and_drawn_in_the_picture(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->markers = FAKE_MARKERS - 1;
    run_doctor(fixture);
    expect(fixture, "markers", WB_DOCTOR_NOT_READY, "6 of 7 markers seen");
    expect(fixture, "up axis", WB_DOCTOR_UNKNOWN, "");
    assert_non_null(strstr(fixture->report.picture, "?\n"));
}

/* Takes are recorded by tests, not by `doctor`. */
static void server_is_not_asked_to_record(void **state)
{
    struct fixture *const fixture = *state;
    char command[160];
    snprintf(command, sizeof command, "sed -i 's/^  up: y/  up: y\\n  record_take: true/' '%s'",
             fixture->rig_path);
    assert_int_equal(system(command), 0);
    run_doctor(fixture);
    expect(fixture, "cameras", WB_DOCTOR_READY, "fake");
    assert_int_equal(fixture->bench->takes, 0);
}

static void bench_without_a_specimen_file_is_ready_and_counts_markers(void **state)
{
    struct fixture *const fixture = *state;
    fixture->request.test.specimen_path = NULL;
    run_doctor(fixture);
    expect_ready(fixture);
    expect(fixture, "markers", WB_DOCTOR_UNKNOWN, "7 are seen");
    assert_non_null(strstr(fixture->report.picture, "*"));
}

static void log_check(const struct fixture *fixture, const char *utc, const char *serial,
                      bool passed)
{
    struct wb_check_log_entry entry = {
        .known = 10.0 * WB_G, .read = 10.0 * WB_G, .tolerance = 0.01, .passed = passed};
    snprintf(entry.utc, sizeof entry.utc, "%s", utc);
    snprintf(entry.serial_number, sizeof entry.serial_number, "%s", serial);
    assert_int_equal(wb_check_log_append(fixture->rig_path, &entry), WB_OK);
}

static void verdict_depends_on_the_last_check_of_this_load_cell(void **state)
{
    struct fixture *const fixture = *state;
    char now[WB_TIME_TEXT];
    wb_time_format(wb_time_utc(), now);
    log_check(fixture, "2020-01-01T00:00:00Z", "T-1", true);
    run_doctor(fixture);
    expect(fixture, "last check", WB_DOCTOR_NOTE, "days ago");
    log_check(fixture, now, "T-2", true);
    run_doctor(fixture);
    expect(fixture, "last check", WB_DOCTOR_NOTE, "load_cell.serial_number is T-1");
    log_check(fixture, now, "T-1", true);
    run_doctor(fixture);
    expect(fixture, "last check", WB_DOCTOR_READY, "passed");
    log_check(fixture, now, "T-1", false);
    run_doctor(fixture);
    expect(fixture, "last check", WB_DOCTOR_NOT_READY, "NOT PASSED");
}

static void ports_that_are_missing_or_in_use_are_reported(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_doctor *holder;
    assert_int_equal(wb_doctor_open(&holder, &fixture->request), WB_OK);
    run_doctor(fixture);
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "'sim:fake_cell' is in use");
    expect(fixture, "stage", WB_DOCTOR_NOT_READY, "'sim:fake_stage' is in use");
    wb_doctor_close(holder, NULL);
    fake_unplug(fixture->bench);
    run_doctor(fixture);
    expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "does not exist");
    expect(fixture, "stage", WB_DOCTOR_NOT_READY, "does not exist");
    expect(fixture, "cameras", WB_DOCTOR_NOT_READY, "no NatNet reply");
    expect(fixture, "disk", WB_DOCTOR_READY, "a flush takes");
}

static void missing_folder_for_recordings_is_not_ready(void **state)
{
    struct fixture *const fixture = *state;
    fixture->request.folder = "/nonexistent";
    fixture->request.seconds = 0.1;
    run_doctor(fixture);
    expect(fixture, "disk", WB_DOCTOR_NOT_READY, "--folder");
}

int main(void)
{
#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest facts[] = {
        FACT(healthy_bench_is_ready_and_not_moved),
        FACT(silent_instruments_are_reported_and_the_others_still_checked),
        FACT(reply_without_data_is_distinguished_from_no_reply),
        FACT(load_cell_out_of_range_or_undecodable_is_not_ready),
        FACT(actual_baud_rate_of_the_load_cell_is_found),
        FACT(stage_in_alarm_or_too_slow_is_not_ready),
        FACT(travel_beyond_the_limits_of_the_rig_is_not_ready),
        FACT(missing_marker_is_counted_and_drawn_in_the_picture),
        FACT(server_is_not_asked_to_record),
        FACT(bench_without_a_specimen_file_is_ready_and_counts_markers),
        FACT(verdict_depends_on_the_last_check_of_this_load_cell),
        FACT(ports_that_are_missing_or_in_use_are_reported),
        FACT(missing_folder_for_recordings_is_not_ready),
    };
    return cmocka_run_group_tests(facts, NULL, NULL);
}
