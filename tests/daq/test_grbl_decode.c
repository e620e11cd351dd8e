#include <stdlib.h>

#include "daq/protocol/grbl.h"
#include "tests/check.h"
#include "tests/daq/grbl_jog.h"

static struct wb_grbl_line decode(const char *text)
{
    struct wb_grbl_line line;
    const size_t n = strlen(text);
    char *const copy = malloc(n ? n : 1);
    assert_non_null(copy);
    memcpy(copy, text, n);
    wb_grbl_decode(copy, n, &line);
    free(copy);
    return line;
}

static void kinds_of_lines_are_distinguished(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum wb_grbl_kind kind;
        int number;
    } cases[] = {
        {"", WB_GRBL_LINE_EMPTY, 0},
        {"\r", WB_GRBL_LINE_EMPTY, 0},
        {"ok", WB_GRBL_LINE_OK, 0},
        {"ok\r", WB_GRBL_LINE_OK, 0},
        {"error:9", WB_GRBL_LINE_ERROR, 9},
        {"error:15\r", WB_GRBL_LINE_ERROR, 15},
        {"ALARM:1", WB_GRBL_LINE_ALARM, 1},
        {"Grbl 1.1h ['$' for help]", WB_GRBL_LINE_BANNER, 0},
        {"[MSG:'$H'|'$X' to unlock]", WB_GRBL_LINE_MESSAGE, 0},
        {"[GC:G0 G54 G17]", WB_GRBL_LINE_MESSAGE, 0},
        {"<Idle|MPos:0.000,0.000,0.000|FS:0,0>", WB_GRBL_LINE_REPORT, 0},
        {"$110=500.000", WB_GRBL_LINE_SETTING, 110},
        {"$N0=G54", WB_GRBL_LINE_UNKNOWN, 0},
        {"okay", WB_GRBL_LINE_UNKNOWN, 0},
        {"error:", WB_GRBL_LINE_UNKNOWN, 0},
        {"error:12345", WB_GRBL_LINE_UNKNOWN, 0},
        {"ALARM:x", WB_GRBL_LINE_UNKNOWN, 0},
        {"<Idle|MPos:0.000,0.0", WB_GRBL_LINE_UNKNOWN, 0},
        {"<Idle|MPos:0.000,zero,0.0>", WB_GRBL_LINE_UNKNOWN, 0},
        {"<Moving|MPos:0.000,0.000,0.000>", WB_GRBL_LINE_UNKNOWN, 0},
        {"<>", WB_GRBL_LINE_UNKNOWN, 0},
        {"hello", WB_GRBL_LINE_UNKNOWN, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct wb_grbl_line line = decode(cases[i].text);
        if (line.kind != cases[i].kind)
            fail_msg("'%s' is taken as kind %d", cases[i].text, (int)line.kind);
        assert_int_equal(line.number, cases[i].number);
    }
    assert_close(decode("$110=500.5").value, 500.5, 0.0);
    assert_true(isnan(decode("$32=x").value));
}

static void reports_give_state_position_feed_and_switches(void **state)
{
    (void)state;
    const struct wb_grbl_report a =
        decode("<Jog|MPos:-12.345,0.000,5.500|FS:120,0|Pn:XZ|Ov:100,100,100>").report;
    assert_int_equal(a.state, WB_STAGE_JOG);
    assert_true(a.has_machine && !a.has_work && !a.has_offset);
    assert_close(a.machine_mm[0], -12.345, 0.0);
    assert_close(a.machine_mm[2], 5.5, 0.0);
    assert_close(a.feed_mm_min, 120.0, 0.0);
    assert_true(a.limit[0] && !a.limit[1] && a.limit[2]);
    const struct wb_grbl_report b = decode("<Hold:0|WPos:1.000|WCO:2.000,3.000,4.000|F:7>").report;
    assert_int_equal(b.state, WB_STAGE_HOLD);
    assert_string_equal(b.name, "Hold:0");
    assert_true(b.has_work && b.has_offset && !b.has_machine);
    assert_close(b.offset_mm[1], 3.0, 0.0);
    assert_close(b.feed_mm_min, 7.0, 0.0);
}

static void states_of_the_manual_are_known(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum wb_stage_state state;
    } cases[] = {
        {"<Idle>", WB_STAGE_IDLE},   {"<Run>", WB_STAGE_RUN},     {"<Hold:1>", WB_STAGE_HOLD},
        {"<Jog>", WB_STAGE_JOG},     {"<Alarm>", WB_STAGE_ALARM}, {"<Door:3>", WB_STAGE_OTHER},
        {"<Check>", WB_STAGE_OTHER}, {"<Home>", WB_STAGE_HOME},   {"<Sleep>", WB_STAGE_OTHER},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_int_equal(decode(cases[i].text).report.state, cases[i].state);
}

static void work_position_needs_the_cached_offset(void **state)
{
    (void)state;
    struct wb_grbl_offset offset = {0};
    double position = 7.0;
    struct wb_grbl_report report = decode("<Idle|WPos:1.000,2.000,3.000|FS:0,0>").report;
    assert_false(wb_grbl_position(&report, &offset, 0, &position));
    report = decode("<Idle|WPos:1.000,2.000,3.000|FS:0,0|WCO:10.000,20.000,30.000>").report;
    assert_true(wb_grbl_position(&report, &offset, 0, &position));
    assert_close(position, 11.0, 0.0);
    /* The offset stays for the reports that leave it out. */
    report = decode("<Idle|WPos:1.500,2.000,3.000|FS:0,0>").report;
    assert_true(wb_grbl_position(&report, &offset, 2, &position));
    assert_close(position, 33.0, 0.0);
    report = decode("<Idle|MPos:4.000,5.000,6.000|FS:0,0>").report;
    assert_true(wb_grbl_position(&report, &offset, 1, &position));
    assert_close(position, 5.0, 0.0);
    report = decode("<Idle|FS:0,0>").report;
    assert_false(wb_grbl_position(&report, &offset, 1, &position));
}

static void jogs_are_formatted_in_mm_and_mm_per_min(void **state)
{
    (void)state;
    char text[64];
    assert_true(wb_grbl_format_jog(text, sizeof text, 'X', 0.002, 0.002));
    assert_string_equal(text, "$J=G91 G21 X2.000 F120.000\n");
    assert_true(wb_grbl_format_jog(text, sizeof text, 'Z', -0.0000124, 0.001));
    assert_string_equal(text, "$J=G91 G21 Z-0.012 F60.000\n");
    assert_true(wb_grbl_format_jog(text, sizeof text, 'Y', -0.053, 0.0005));
    assert_string_equal(text, "$J=G91 G21 Y-53.000 F30.000\n");
    assert_false(wb_grbl_format_jog(text, sizeof text, 'X', 0.0000004, 0.001));
    assert_false(wb_grbl_format_jog(text, sizeof text, 'X', 0.001, 0.0));
    assert_false(wb_grbl_format_jog(text, sizeof text, 'X', 0.001, -0.001));
    assert_false(wb_grbl_format_jog(text, sizeof text, 'X', (double)NAN, 0.001));
    assert_false(wb_grbl_format_jog(text, 20, 'X', 0.002, 0.002));
}

static void jogs_are_read_back(void **state)
{
    (void)state;
    struct grbl_jog jog = {0};
    assert_true(grbl_jog_parse("$J=G91 G21 X2.000 F120.000\n", &jog));
    assert_true(jog.axis == 0 && jog.relative);
    assert_close(jog.target_mm, 2.0, 0.0);
    assert_close(jog.feed_mm_min, 120.0, 0.0);
    assert_true(grbl_jog_parse("$j=g90g21z-5f60", &jog));
    assert_true(jog.axis == 2 && !jog.relative);
    assert_close(jog.target_mm, -5.0, 0.0);
    static const char *const bad[] = {
        "$J=",        "$J=G91 X2",         "$J=G91 F10",     "$J=X F10",         "$X",
        "$J=G20X1F1", "$J=G91 X1 Y2 F100", "$J=G91 X1 F-10", "$J=G91 X1 F1.2.3",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(grbl_jog_parse(bad[i], &jog));
}

static void reports_survive_the_round_trip(void **state)
{
    (void)state;
    char text[160];
    struct wb_grbl_report report = {.name = "Hold:1",
                                    .has_machine = true,
                                    .has_offset = true,
                                    .machine_mm = {-53.0004, 0.0006, 12.0},
                                    .offset_mm = {1.0, 2.0, 3.0},
                                    .feed_mm_min = 60.0,
                                    .limit = {true, false, false}};
    const size_t n = wb_grbl_format_report(text, sizeof text, &report);
    assert_string_equal(
        text, "<Hold:1|MPos:-53.000,0.001,12.000|FS:60,0|Pn:X|WCO:1.000,2.000,3.000>\r\n");
    assert_int_equal(n, strlen(text));
    text[n - 1] = '\0'; /* the newline is not part of the line */
    const struct wb_grbl_line line = decode(text);
    assert_int_equal(line.kind, WB_GRBL_LINE_REPORT);
    assert_int_equal(line.report.state, WB_STAGE_HOLD);
    assert_close(line.report.machine_mm[0], -53.0, 0.0);
    assert_true(line.report.limit[0] && line.report.has_offset);
    for (size_t size = 0; size <= n; size++)
        assert_int_equal(wb_grbl_format_report(text, size, &report), 0);
}

static void codes_have_a_meaning(void **state)
{
    (void)state;
    assert_non_null(strstr(wb_grbl_error_text(15), "travel"));
    assert_non_null(strstr(wb_grbl_alarm_text(1), "hard limit"));
    for (int i = -1; i < 100; i++)
        assert_true(wb_grbl_error_text(i)[0] && wb_grbl_alarm_text(i)[0]);
    static const bool loses[] = {false, true, false, true, false, false, true, true, true, true};
    for (int i = 0; i < 10; i++)
        assert_int_equal(wb_grbl_alarm_loses_position(i), loses[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kinds_of_lines_are_distinguished),
        cmocka_unit_test(reports_give_state_position_feed_and_switches),
        cmocka_unit_test(states_of_the_manual_are_known),
        cmocka_unit_test(work_position_needs_the_cached_offset),
        cmocka_unit_test(jogs_are_formatted_in_mm_and_mm_per_min),
        cmocka_unit_test(jogs_are_read_back),
        cmocka_unit_test(reports_survive_the_round_trip),
        cmocka_unit_test(codes_have_a_meaning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
