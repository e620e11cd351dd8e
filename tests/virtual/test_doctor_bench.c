/* `doctor` on the virtual bench, in virtual time: a healthy bench is ready, and each fault that can
 * be detected at rest is reported. Faults that occur only during motion (clock-restart,
 * unit-change, replug-cell, unplug-*, stuck-stage, strand-break) cannot be detected at rest. */
#include <stdlib.h>

#include "base/config.h"
#include "base/file.h"
#include "base/interrupt_private.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/doctor/doctor.h"
#include "daq/stream/stream.h"
#include "fixtures/virtual/bench_private.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/folder.h"
#include "tests/messages.h"

#define SECONDS 3.0

struct fixture {
    char folder[32], paper[WB_PATH], specimen[WB_PATH], rig[64], changed[64];
    struct wb_bench *bench;
    struct wb_doctor_request request;
    struct wb_doctor_report report;
};

static int set_up(void **state)
{
    struct fixture *const fixture = calloc(1, sizeof *fixture);
    if (!fixture || !temporary_folder_make(fixture->folder) ||
        wb_file_find_data(fixture->paper, "fixtures/rigs/paper.yaml") != WB_OK ||
        wb_file_find_data(fixture->specimen, "fixtures/specimens/type1-L85-1.yaml") != WB_OK)
        return 1;
    snprintf(fixture->rig, sizeof fixture->rig, "%s/rig.yaml", fixture->folder);
    snprintf(fixture->changed, sizeof fixture->changed, "%s/changed.yaml", fixture->folder);
    wb_doctor_default_request(&fixture->request);
    fixture->request.test.rig_path = fixture->rig;
    fixture->request.test.specimen_path = fixture->specimen;
    fixture->request.folder = fixture->folder;
    fixture->request.seconds = SECONDS;
    wb_interrupt_set(false);
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    keep_messages();
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *const fixture = *state;
    wb_bench_close(fixture->bench);
    wb_virtual_time_end();
    release_messages();
    const int removed = temporary_folder_remove(fixture->folder);
    free(fixture);
    return removed;
}

/* Opens the bench and writes its rig file. */
static void begin(struct fixture *fixture, const char *faults, uint64_t seed)
{
    const struct wb_bench_settings settings = {
        .rig = fixture->paper, .specimen = fixture->specimen, .seed = seed, .faults = faults};
    assert_int_equal(wb_bench_open(&fixture->bench, &settings), WB_OK);
    assert_int_equal(wb_bench_write_rig(fixture->bench, fixture->rig), WB_OK);
}

static void run_doctor(struct fixture *fixture)
{
    struct wb_doctor *doctor;
    assert_int_equal(wb_doctor_open(&doctor, &fixture->request), WB_OK);
    const int64_t end_ns = wb_time_now_ns() + 60 * WB_NS_PER_S;
    while (wb_doctor_step(doctor, 20 * WB_NS_PER_MS))
        assert_true(wb_time_now_ns() < end_ns);
    wb_doctor_close(doctor, &fixture->report);
}

/* Text of the item that has this name and verdict and contains these words; NULL if there is
 * none. */
static const char *find(const struct fixture *fixture, const char *name,
                        enum wb_doctor_verdict verdict, const char *words)
{
    for (int i = 0; i < fixture->report.n; i++) {
        const struct wb_doctor_item *const item = &fixture->report.items[i];
        if (strcmp(item->name, name) == 0 && item->verdict == verdict && strstr(item->text, words))
            return item->text;
    }
    return NULL;
}

static void print_report(const struct fixture *fixture)
{
    for (int i = 0; i < fixture->report.n; i++)
        print_message("%-10s %-10s %s\n", fixture->report.items[i].name,
                      wb_doctor_verdict_name(fixture->report.items[i].verdict),
                      fixture->report.items[i].text);
}

static const char *expect(const struct fixture *fixture, const char *name,
                          enum wb_doctor_verdict verdict, const char *words)
{
    const char *const text = find(fixture, name, verdict, words);
    if (!text) {
        print_report(fixture);
        fail_msg("no item '%s' with verdict %s contains '%s'", name,
                 wb_doctor_verdict_name(verdict), words);
    }
    return text;
}

/* Expects an item that is NOT READY, and no other one. */
static void expect_only(const struct fixture *fixture, const char *name, const char *words)
{
    (void)expect(fixture, name, WB_DOCTOR_NOT_READY, words);
    for (int i = 0; i < fixture->report.n; i++)
        if (fixture->report.items[i].verdict == WB_DOCTOR_NOT_READY &&
            strcmp(fixture->report.items[i].name, name) != 0) {
            print_report(fixture);
            fail_msg("'%s' is not ready", fixture->report.items[i].name);
        }
}

static void expect_ready(const struct fixture *fixture)
{
    if (wb_doctor_is_ready(&fixture->report))
        return;
    print_report(fixture);
    fail_msg("not ready");
}

/* Writes a copy of the file `from` to fixture->changed, with the first `old` replaced by `new`. */
static void change(struct fixture *fixture, const char *from, const char *old, const char *new)
{
    struct wb_text changed = {0};
    char *text;
    assert_int_equal(wb_config_read_text(&text, from, NULL), WB_OK);
    char *const at = strstr(text, old);
    assert_non_null(at);
    *at = '\0';
    wb_text_append(&changed, "%s%s%s", text, new, at + strlen(old));
    assert_int_equal(wb_file_write_text(fixture->changed, &changed), WB_OK);
    wb_text_release(&changed);
    free(text);
}

static void healthy_bench_is_ready_and_not_moved(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bench_counts counts;
    char stage[WB_DOCTOR_TEXT];
    begin(fixture, NULL, 1);
    run_doctor(fixture);
    expect_ready(fixture);
    assert_true(fixture->report.is_virtual);
    (void)expect(fixture, "markers", WB_DOCTOR_READY, "all 7");
    snprintf(stage, sizeof stage, "%s", expect(fixture, "stage", WB_DOCTOR_READY, ""));
    run_doctor(fixture);
    expect_ready(fixture);
    assert_string_equal(expect(fixture, "stage", WB_DOCTOR_READY, ""), stage);
    wb_bench_count(fixture->bench, &counts);
    assert_close(counts.travel, 0.0, 0.0);

    fixture->request.test.specimen_path = NULL;
    run_doctor(fixture);
    expect_ready(fixture);
    (void)expect(fixture, "markers", WB_DOCTOR_UNKNOWN, "");
    (void)expect(fixture, "clock", WB_DOCTOR_READY, "");
}

static void wrong_unit_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    change(fixture, fixture->rig, "  unit: g", "  unit: kg");
    fixture->request.test.rig_path = fixture->changed;
    run_doctor(fixture);
    (void)expect(fixture, "unit", WB_DOCTOR_NOT_READY, "load_cell.unit: kg");
}

static void missing_marker_is_counted_and_drawn_in_the_picture(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    change(fixture, fixture->specimen, "42.5, 56.7", "42.5, 49.6, 56.7");
    fixture->request.test.specimen_path = fixture->changed;
    run_doctor(fixture);
    (void)expect(fixture, "markers", WB_DOCTOR_NOT_READY, "7 of 8 markers seen");
    /* The picture has a line of its own, `|  ?`, for the missing marker. */
    int drawn = 0;
    for (const char *line = fixture->report.picture; *line; line += strcspn(line, "\n") + 1) {
        const size_t blank = strspn(line + 1, " ");
        drawn += line[0] == '|' && blank > 1 && strncmp(line + 1 + blank, "?\n", 2) == 0;
    }
    assert_int_equal(drawn, 1);
}

static void wrong_wire_length_is_reported_with_both_lengths(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    change(fixture, fixture->specimen,
           "length_mm: 85\nsample: 1\nmarkers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]",
           "length_mm: 88\nsample: 1\nmarkers_mm: [0, 14.7, 29.3, 44, 58.7, 73.3, 88]");
    fixture->request.test.specimen_path = fixture->changed;
    run_doctor(fixture);
    const char *const text = expect(fixture, "scale", WB_DOCTOR_NOT_READY, "markers_mm");
    assert_non_null(strstr(text, "85."));
    assert_non_null(strstr(text, "88.0"));
}

static void travel_beyond_the_rigs_limit_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    fixture->request.test.travel = 59.0 * WB_MM;
    run_doctor(fixture);
    expect_only(fixture, "travel", "--travel-mm");
}

static void missing_folder_is_reported(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    fixture->request.folder = "/dev/shm/no/such/folder";
    run_doctor(fixture);
    expect_only(fixture, "disk", "--folder");
}

static void swapped_ports_are_reported(void **state)
{
    struct fixture *const fixture = *state;
    begin(fixture, NULL, 1);
    change(fixture, fixture->rig, "sim:load_cell", "sim:other");
    change(fixture, fixture->changed, "sim:stage", "sim:load_cell");
    change(fixture, fixture->changed, "sim:other", "sim:stage");
    fixture->request.test.rig_path = fixture->changed;
    run_doctor(fixture);
    (void)expect(fixture, "load cell", WB_DOCTOR_NOT_READY, "swapped");
    (void)expect(fixture, "stage", WB_DOCTOR_NOT_READY, "swapped");
}

static void other_ports_are_checked_if_one_is_in_use(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_stream *other;
    begin(fixture, NULL, 1);
    assert_int_equal(wb_stream_open(&other, "sim:stage"), WB_OK);
    run_doctor(fixture);
    wb_stream_close(other);
    (void)expect(fixture, "stage", WB_DOCTOR_NOT_READY, "in use");
    (void)expect(fixture, "load cell", WB_DOCTOR_READY, "");
    (void)expect(fixture, "markers", WB_DOCTOR_READY, "all 7");
}

/* A fault of the bench, the item that reports it with this verdict, and the only item that is NOT
 * READY (NULL: the bench is ready). */
static const struct {
    const char *faults, *item, *words;
    enum wb_doctor_verdict verdict;
    const char *not_ready;
    uint64_t seed;
} faults[] = {
    {"loss=20", "frames", "% of the frames never came", WB_DOCTOR_NOT_READY, "frames", 1},
    {"garbage=20", "load cell", "cannot be decoded", WB_DOCTOR_NOTE, "load cell", 1},
    {"garbage=20", "cameras", "rejected at byte", WB_DOCTOR_NOTE, "load cell", 1},
    {"duplicates=20", "frames", "arrive twice", WB_DOCTOR_NOTE, NULL, 1},
    {"reorder=20", "frames", "after the next one", WB_DOCTOR_NOTE, NULL, 1},
    {"delay=150", "delay", "later", WB_DOCTOR_NOTE, NULL, 1},
    {"zero-drift=60", "drift", "drifts by", WB_DOCTOR_NOTE, "zero", 1},
    {"clock-drift=5000", "clock", "ppm", WB_DOCTOR_NOTE, NULL, 1},
    {"wrong-up", "up axis", "set mocap.up: z", WB_DOCTOR_NOT_READY, "up axis", 3},
};

static void faults_are_reported(void **state)
{
    struct fixture *const fixture = *state;
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        const char *const not_ready = faults[i].not_ready;
        begin(fixture, faults[i].faults, faults[i].seed);
        run_doctor(fixture);
        (void)expect(fixture, faults[i].item, faults[i].verdict, faults[i].words);
        if (not_ready)
            expect_only(fixture, not_ready, "");
        else
            expect_ready(fixture);
        wb_bench_close(fixture->bench);
        fixture->bench = NULL;
    }
}

static int64_t interrupt_next(void *context)
{
    (void)context;
    return wb_interrupted() ? INT64_MAX : WB_VIRTUAL_TIME_START_NS + 2 * WB_NS_PER_S;
}

static void interrupt_run(void *context, int64_t now_ns)
{
    (void)context, (void)now_ns;
    wb_interrupt_set(true);
}

static void interrupt_ends_the_check_immediately(void **state)
{
    struct fixture *const fixture = *state;
    const struct wb_virtual_actor actor = {NULL, interrupt_next, interrupt_run};
    begin(fixture, NULL, 1);
    fixture->request.seconds = 60.0;
    wb_virtual_time_add(&actor);
    run_doctor(fixture);
    wb_virtual_time_remove(&actor);
    assert_int_equal(wb_time_now_ns(), WB_VIRTUAL_TIME_START_NS + 2 * WB_NS_PER_S);
    wb_interrupt_set(false);
}

#define FACT(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        FACT(healthy_bench_is_ready_and_not_moved),
        FACT(wrong_unit_is_reported),
        FACT(missing_marker_is_counted_and_drawn_in_the_picture),
        FACT(wrong_wire_length_is_reported_with_both_lengths),
        FACT(travel_beyond_the_rigs_limit_is_reported),
        FACT(missing_folder_is_reported),
        FACT(swapped_ports_are_reported),
        FACT(other_ports_are_checked_if_one_is_in_use),
        FACT(faults_are_reported),
        FACT(interrupt_ends_the_check_immediately),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
