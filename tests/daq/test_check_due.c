/* How old the load cell's last check may be. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/units.h"
#include "daq/test/check_due.h"
#include "tests/own_folder.h"

/* 2026-01-15T10:00:00Z, by `date -d ... +%s`. */
#define THEN INT64_C(1768471200)
#define DAY INT64_C(86400)

static char rig[96], log_path[WB_PATH];
static struct wb_rig_load_cell cell;

static int set_up(void **state)
{
    assert_int_equal(make_folder(state), 0);
    snprintf(rig, sizeof rig, "%s/bench.yaml", folder);
    assert_int_equal(wb_check_log_path(log_path, rig), WB_OK);
    cell = (struct wb_rig_load_cell){.check_due = 30.0 * WB_DAY, .serial_number = "LS270"};
    const struct wb_check_log_entry entry = {.utc = "2026-01-15T10:00:00Z",
                                             .known = 10.0 * WB_G,
                                             .read = 10.0 * WB_G,
                                             .tolerance = 0.01,
                                             .passed = true,
                                             .serial_number = "LS270"};
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    return 0;
}

static enum wb_check_due at(int64_t now_s, char text[WB_CHECK_DUE_TEXT])
{
    return wb_check_due(&cell, rig, now_s, text);
}

static void check_is_valid_until_it_is_due(void **state)
{
    (void)state;
    char text[WB_CHECK_DUE_TEXT];
    assert_int_equal(at(THEN + 30 * DAY, text), WB_CHECK_DUE_HOLDS);
    assert_string_equal(text, "");
    assert_int_equal(at(THEN + 30 * DAY + 1, text), WB_CHECK_DUE_LATE);
    assert_non_null(strstr(text, "30.0 days old"));
    assert_int_equal(at(THEN + 60 * DAY, text), WB_CHECK_DUE_LATE);
}

static void after_twice_the_time_no_test_is_started(void **state)
{
    (void)state;
    char text[WB_CHECK_DUE_TEXT], command[160];
    snprintf(command, sizeof command, "wirebench stage %s check", rig);
    assert_int_equal(at(THEN + 60 * DAY + 1, text), WB_CHECK_DUE_TOO_LATE);
    assert_non_null(strstr(text, command));
    unlink(log_path);
    assert_int_equal(at(THEN, text), WB_CHECK_DUE_TOO_LATE);
    assert_non_null(strstr(text, command));
}

static void rig_without_due_date_needs_no_check(void **state)
{
    (void)state;
    char text[WB_CHECK_DUE_TEXT];
    cell.check_due = 0.0;
    assert_int_equal(at(THEN + 1000 * DAY, text), WB_CHECK_DUE_HOLDS);
}

static void check_of_another_cell_does_not_count(void **state)
{
    (void)state;
    char text[WB_CHECK_DUE_TEXT];
    strcpy(cell.serial_number, "LS271");
    assert_int_equal(at(THEN, text), WB_CHECK_DUE_TOO_LATE);
}

static void check_in_the_future_is_reported(void **state)
{
    (void)state;
    char text[WB_CHECK_DUE_TEXT];
    assert_int_equal(at(THEN - 1800, text), WB_CHECK_DUE_HOLDS);
    assert_int_equal(at(THEN - DAY, text), WB_CHECK_DUE_LATE);
    assert_non_null(strstr(text, "set the clock"));
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, remove_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(check_is_valid_until_it_is_due),      TEST(after_twice_the_time_no_test_is_started),
        TEST(rig_without_due_date_needs_no_check), TEST(check_of_another_cell_does_not_count),
        TEST(check_in_the_future_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
