/* The log of load-cell checks: appended, never rewritten, read back by `record` and `info`. */
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/units.h"
#include "daq/test/check_log.h"
#include "tests/own_folder.h"

static char rig[96], log_path[WB_PATH];

static int set_up(void **state)
{
    assert_int_equal(make_folder(state), 0);
    snprintf(rig, sizeof rig, "%s/bench.yaml", folder);
    assert_int_equal(wb_check_log_path(log_path, rig), WB_OK);
    return 0;
}

static int tear_down(void **state)
{
    wb_log_set_sink(NULL, NULL);
    return remove_folder(state);
}

static struct wb_check_log_entry check(const char *utc, double read_g, const char *serial)
{
    struct wb_check_log_entry entry = {
        .known = 10.0 * WB_G, .read = read_g * WB_G, .tolerance = 1.0 * WB_PERCENT};
    entry.passed = fabs(read_g - 10.0) <= 0.1;
    snprintf(entry.utc, sizeof entry.utc, "%s", utc);
    snprintf(entry.serial_number, sizeof entry.serial_number, "%s", serial);
    return entry;
}

static char *contents(void)
{
    char *text;
    assert_int_equal(wb_file_read(log_path, &text, NULL), WB_OK);
    return text;
}

static void log_is_beside_the_rig_file(void **state)
{
    (void)state;
    static const char *const cases[][2] = {{"a/b.yaml", "a/b.checks.csv"},
                                           {"b.yml", "b.checks.csv"},
                                           {"bench", "bench.checks.csv"},
                                           {".yaml", ".yaml.checks.csv"}};
    char path[WB_PATH], far[WB_PATH];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(wb_check_log_path(path, cases[i][0]), WB_OK);
        assert_string_equal(path, cases[i][1]);
    }
    wb_log_set_sink(discard_message, NULL);
    memset(far, 'a', sizeof far - 1);
    far[sizeof far - 1] = '\0';
    assert_int_equal(wb_check_log_path(path, far), WB_ERR_ARGUMENT);
}

static void checks_are_appended_under_one_heading(void **state)
{
    (void)state;
    struct wb_check_log_entry entry = check("2026-01-15T10:00:00Z", 10.002, "LS270, no. 1");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    entry = check("2026-01-16T10:00:00Z", 10.5, "");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    char *const text = contents();
    assert_string_equal(
        text, "utc,known_mass_g,read_mass_g,deviation_mg,deviation_percent,tolerance_percent,"
              "passed,serial_number\n"
              "2026-01-15T10:00:00Z,10,10.002000,2.000,0.0200,1,yes,LS270, no. 1\n"
              "2026-01-16T10:00:00Z,10,10.500000,500.000,5.0000,1,no,\n");
    free(text);
}

static void last_check_is_read_back(void **state)
{
    (void)state;
    char line[WB_CHECK_LOG_LINE], text[WB_CHECK_LOG_LINE];
    struct wb_check_log_entry entry, read;
    wb_check_log_last(rig, line);
    assert_string_equal(line, "");
    assert_false(wb_check_log_parse(line, &read));
    entry = check("2026-01-15T10:00:00Z", 10.5, "X");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    entry = check("2026-01-16T10:00:00Z", 9.998, "LS270, no. 1\nand more");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    wb_check_log_last(rig, line);
    assert_true(wb_check_log_parse(line, &read));
    assert_string_equal(read.utc, "2026-01-16T10:00:00Z");
    assert_close(read.known, 10e-3, 1e-15);
    assert_close(read.read, 9.998e-3, 1e-12);
    assert_close(read.tolerance, 0.01, 1e-12);
    assert_true(read.passed);
    assert_string_equal(read.serial_number, "LS270, no. 1 and more");
    wb_check_log_describe(&read, text);
    assert_string_equal(text, "2026-01-16T10:00:00Z, 10 g read 9.9980 g (-0.020 %), "
                              "LS270, no. 1 and more, passed");
}

static void truncated_line_is_ignored_and_does_not_affect_the_next(void **state)
{
    (void)state;
    char line[WB_CHECK_LOG_LINE];
    struct wb_check_log_entry entry = check("2026-01-15T10:00:00Z", 10.0, "X");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    FILE *const file = fopen(log_path, "a");
    assert_non_null(file);
    fputs("2026-01-16T10:00:00Z,10,10.000000,0.000,0.0000,1,yes,Y", file);
    fclose(file);
    wb_check_log_last(rig, line);
    assert_non_null(strstr(line, "2026-01-15"));
    entry = check("2026-01-17T10:00:00Z", 10.0, "Z");
    assert_int_equal(wb_check_log_append(rig, &entry), WB_OK);
    wb_check_log_last(rig, line);
    assert_non_null(strstr(line, "2026-01-17"));
    char *const text = contents();
    assert_non_null(strstr(text, ",yes,Y\n2026-01-17"));
    free(text);
}

static void invalid_lines_are_not_checks(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "",
        "utc,known_mass_g,read_mass_g,deviation_mg,deviation_percent,tolerance_percent,passed,s",
        "2026,10,10,0,0,1,yes",
        "2026,10,10,0,0,1,perhaps,X",
        "2026,0,10,0,0,1,yes,X",
        "2026,10,nan,0,0,1,yes,X",
        "2026-01-15T10:00:00Z2026-01-15T10:00:00Z,10,10,0,0,1,yes,X"};
    struct wb_check_log_entry entry;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (wb_check_log_parse(lines[i], &entry))
            fail_msg("taken for a check: %s", lines[i]);
    FILE *const file = fopen(log_path, "w");
    assert_non_null(file);
    for (int i = 0; i < 4000; i++)
        fputc(i % 251, file);
    fputc('\n', file);
    fclose(file);
    char line[WB_CHECK_LOG_LINE];
    wb_check_log_last(rig, line);
    assert_string_equal(line, "");
}

static void many_appends_at_once_lose_nothing(void **state)
{
    (void)state;
    enum {
        WRITERS = 8,
        EACH = 10
    };
    for (int i = 0; i < WRITERS; i++) {
        if (fork() != 0)
            continue;
        int failed = 0;
        for (int k = 0; k < EACH; k++) {
            const struct wb_check_log_entry entry = check("2026-01-15T10:00:00Z", 10.0, "X");
            failed += wb_check_log_append(rig, &entry) != WB_OK;
        }
        _exit(failed);
    }
    int code, lines = 0;
    while (wait(&code) > 0)
        assert_int_equal(code, 0);
    char *const text = contents();
    for (const char *at = text; (at = strchr(at, '\n')); at++)
        lines++;
    assert_int_equal(lines, 1 + WRITERS * EACH);
    assert_null(strstr(text + 1, "utc,known"));
    free(text);
}

static void unwritable_log_is_reported(void **state)
{
    (void)state;
    struct wb_check_log_entry entry = check("2026-01-15T10:00:00Z", 10.0, "X");
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_check_log_append("/no/such/folder/rig.yaml", &entry), WB_ERR_IO);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(log_is_beside_the_rig_file),
        TEST(checks_are_appended_under_one_heading),
        TEST(last_check_is_read_back),
        TEST(truncated_line_is_ignored_and_does_not_affect_the_next),
        TEST(invalid_lines_are_not_checks),
        TEST(many_appends_at_once_lose_nothing),
        TEST(unwritable_log_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
