/* A load cell whose cable is unplugged and plugged in again, with a small bench in virtual time:
 * the test continues, the gap is reported, and no halves of lines are joined to a wrong reading. */
#include "base/timing.h"
#include "daq/stream/usb_identity.h"
#include "tests/daq/bend_fixture.h"
#include "tests/trials.h"

/* The cable is unplugged within a line, and plugged in again within another. */
static void plug(struct fake_bench *bench, bool in)
{
    if (!in)
        wb_sim_port_send(bench->load, "1", 1);
    (in ? wb_sim_port_replug : wb_sim_port_unplug)(bench->load);
    if (in)
        wb_sim_port_send(bench->load, "0 g\r\n", 5);
}

static int count_events(const struct fixture *fixture, const char *kind)
{
    int n = 0;
    for (const char *at = fixture->events; (at = strstr(at, kind)); at++)
        n++;
    return n;
}

static void test_continues_with_a_reconnected_cell_and_no_half_lines_join(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    enum {
        TRIALS = 40
    };
    fixture->request.travel = 8.0 * WB_MM;
    fixture->request.cycles = 1000;
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    int64_t change_ns = wb_time_now_ns() + 10 * WB_NS_PER_S; /* on its way down */
    int plugged = 0;
    bool is_in = true;
    while (wb_bend_test_step(test, MS) == WB_SEQUENCE_RUNNING && plugged < TRIALS) {
        const int64_t now_ns = wb_time_now_ns();
        struct wb_bend_test_status status;
        wb_bend_test_status(test, &status);
        const bool gone = status.latest->stream[WB_ROLE_LOAD].gone;
        if (now_ns < change_ns || gone == is_in)
            continue;
        plugged += gone;
        is_in = gone;
        plug(fixture->bench, is_in);
        change_ns = now_ns + (20 + 7 * plugged % 50) * MS;
    }
    wb_bend_test_stop(test);
    assert_false(run(test, NULL));
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    /* Asserted first, because a failure then shows the reason. */
    assert_string_equal(result.text, "stopped by the operator");
    assert_int_equal(plugged, TRIALS);
    /* 7 mm beyond the slack pull by 3.5 g; two halves would make 10 g and more. */
    assert_true(result.peak_tension < 45.0 * WB_MN);
    read_events(fixture);
    assert_true(count_events(fixture, "reconnected: the load cell's port") >= TRIALS - 1);
    assert_true(result.loss[WB_ROLE_LOAD].missing > 0);
    assert_replay_identical(fixture->output, &fixture->log);
    count_trials("A load cell's cable unplugged within a line, and plugged in again", TRIALS,
                 "times in one test: the test continued, each gap was reported, no wrong reading");
}

static void disconnected_cell_ends_the_test(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_bend_test *test;
    struct wb_bend_test_result result;
    fake_write_rig(fixture->rig, true, 0.5);
    assert_int_equal(wb_bend_test_open(&test, &fixture->request), WB_OK);
    bool cut = false;
    while (wb_bend_test_step(test, MS) == WB_SEQUENCE_RUNNING) {
        struct wb_bend_test_status status;
        wb_bend_test_status(test, &status);
        if (cut || !status.has_travel || status.travel < 10.0 * WB_MM)
            continue;
        plug(fixture->bench, false);
        cut = true;
    }
    assert_int_equal(wb_bend_test_close(test, &result), WB_OK);
    assert_true(cut && result.standing);
    assert_non_null(strstr(result.text, "was disconnected"));
    assert_int_equal(result.end, WB_SEQUENCE_LIMIT);
}

static void adapter_is_identified_independent_of_its_port_number(void **state)
{
    (void)state;
    static const struct wb_usb_identity cell = {"/dev/ttyUSB0", true, 0x0403, 0x6001, "A50285BI"};
    static const struct wb_usb_identity plain = {"/dev/ttyUSB0", true, 0x1a86, 0x7523, ""};
    static const struct wb_usb_identity board = {.port = "/dev/ttyS0"};
    const struct wb_usb_identity there[] = {
        {"/dev/ttyUSB0", true, 0x0403, 0x6001, "OTHER"},
        {"/dev/ttyUSB1", true, 0x0403, 0x6001, "A50285BI"},
        {"/dev/ttyUSB2", true, 0x1a86, 0x7523, ""},
        {"/dev/ttyUSB3", true, 0x1a86, 0x7523, ""},
        {.port = "/dev/ttyS0"},
    };
    assert_int_equal(wb_usb_identity_find(&cell, there, 5), 1);
    assert_int_equal(wb_usb_identity_find(&cell, there, 1), -1);
    assert_int_equal(wb_usb_identity_find(&plain, there, 3), 2);
    assert_int_equal(wb_usb_identity_find(&plain, there, 4), -1); /* ambiguous */
    assert_int_equal(wb_usb_identity_find(&board, there, 5), 4);
    assert_int_equal(wb_usb_identity_find(&there[3], there, 5), 3);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(test_continues_with_a_reconnected_cell_and_no_half_lines_join),
        TEST(disconnected_cell_ends_the_test),
        cmocka_unit_test(adapter_is_identified_independent_of_its_port_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
