/* The bending test recorded from the virtual rig and replayed: identical samples. */
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/log.h"
#include "base/units.h"
#include "daq/test/bend_test.h"
#include "fixtures/virtual/bench.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/daq/sample_log.h"
#include "tests/folder.h"

struct fixture {
    char folder[32], rig[64], output[64], paper[WB_PATH], specimen[WB_PATH];
    struct wb_bench *bench;
};

static void keep_quiet(void *context, enum wb_log_level level, const char *domain,
                       const char *message)
{
    (void)context;
    (void)domain;
    if (level == WB_LOG_ERROR)
        print_message("%s\n", message);
}

static void start_rig(struct fixture *fixture, const char *specimen, int major, int minor)
{
    char name[128];
    memset(fixture, 0, sizeof *fixture);
    assert_true(temporary_folder_make(fixture->folder));
    snprintf(fixture->rig, sizeof fixture->rig, "%s/rig.yaml", fixture->folder);
    snprintf(fixture->output, sizeof fixture->output, "%s/test.wbr", fixture->folder);
    snprintf(name, sizeof name, "fixtures/specimens/%s", specimen);
    assert_int_equal(wb_file_find_data(fixture->specimen, name), WB_OK);
    assert_int_equal(wb_file_find_data(fixture->paper, "fixtures/rigs/paper.yaml"), WB_OK);
    const struct wb_bench_settings settings = {
        .rig = fixture->paper,
        .specimen = fixture->specimen,
        .seed = 7,
        .natnet = {(uint8_t)major, (uint8_t)minor},
    };
    wb_log_set_sink(keep_quiet, NULL);
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    assert_int_equal(wb_bench_open(&fixture->bench, &settings), WB_OK);
    assert_int_equal(wb_bench_write_rig(fixture->bench, fixture->rig), WB_OK);
}

static void stop_rig(struct fixture *fixture)
{
    wb_bench_close(fixture->bench);
    wb_virtual_time_end();
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(temporary_folder_remove(fixture->folder), 0);
}

static void record(struct fixture *fixture, double travel_mm, struct sample_log *log,
                   struct wb_bend_test_result *result)
{
    struct wb_bend_test_request request;
    struct wb_bend_test *test;
    wb_bend_test_default_request(&request);
    request.rig_path = fixture->rig;
    request.specimen_path = fixture->specimen;
    request.output_path = fixture->output;
    request.travel = travel_mm * WB_MM;
    request.sink = sample_log_sink(log);
    assert_int_equal(wb_bend_test_open(&test, &request), WB_OK);
    while (wb_bend_test_step(test, 20 * WB_NS_PER_MS) == WB_SEQUENCE_RUNNING) {
    }
    assert_int_equal(wb_bend_test_close(test, result), WB_OK);
    if (result->end != WB_SEQUENCE_DONE)
        fail_msg("the test ended early: %s", result->text);
}

static void assert_recorded_like_replayed(int major, int minor, const char *specimen,
                                          double travel_mm)
{
    struct fixture fixture;
    struct sample_log log;
    struct wb_bend_test_result result;
    start_rig(&fixture, specimen, major, minor);
    record(&fixture, travel_mm, &log, &result);
    assert_true(result.is_virtual);
    assert_int_equal(result.drops, 0);
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++)
        assert_int_equal(result.loss[role].missing, 0);
    assert_true(log.n[WB_ROLE_LOAD] > 100 && log.n[WB_ROLE_MOCAP] > 100);
    assert_true(log.n[WB_ROLE_STAGE] > 0);
    assert_replay_identical(fixture.output, &log);
    print_message("           %d readings, %d frames, %d reports identical\n", log.n[WB_ROLE_LOAD],
                  log.n[WB_ROLE_MOCAP], log.n[WB_ROLE_STAGE]);
    sample_log_release(&log);
    stop_rig(&fixture);
}

static void replayed_samples_are_the_recorded_ones_natnet_2_7(void **state)
{
    (void)state;
    assert_recorded_like_replayed(2, 7, "type1-L85-1.yaml", 5.0);
}

static void replayed_samples_are_the_recorded_ones_natnet_3_0(void **state)
{
    (void)state;
    assert_recorded_like_replayed(3, 0, "type3-L100-1.yaml", 15.0);
}

static void replayed_samples_are_the_recorded_ones_natnet_4_1(void **state)
{
    (void)state;
    assert_recorded_like_replayed(4, 1, "type2-L85-2.yaml", 5.0);
}

static void truth_is_stored_and_marked_as_virtual(void **state)
{
    (void)state;
    struct fixture fixture;
    struct sample_log log;
    struct wb_bend_test_result result;
    struct wb_recording *recording;
    char *value;
    start_rig(&fixture, "type1-L85-1.yaml", 3, 0);
    record(&fixture, 2.0, &log, &result);
    assert_int_equal(wb_recording_open(&recording, fixture.output), WB_OK);
    assert_int_equal(wb_recording_meta(recording, "virtual", &value), WB_OK);
    assert_string_equal(value, "true");
    free(value);
    assert_int_equal(wb_recording_meta(recording, "truth", &value), WB_OK);
    assert_non_null(strstr(value, "source: virtual rig"));
    assert_non_null(strstr(value, "seed: 7"));
    assert_non_null(strstr(value, "cell_drift"));
    free(value);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    sample_log_release(&log);
    stop_rig(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(replayed_samples_are_the_recorded_ones_natnet_2_7),
        cmocka_unit_test(replayed_samples_are_the_recorded_ones_natnet_3_0),
        cmocka_unit_test(replayed_samples_are_the_recorded_ones_natnet_4_1),
        cmocka_unit_test(truth_is_stored_and_marked_as_virtual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
