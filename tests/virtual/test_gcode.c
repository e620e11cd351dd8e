#include "fixtures/virtual/gcode.h"

#include "tests/check.h"

static int parse(const char *line, bool jog, struct wb_gcode_words *words)
{
    *words = (struct wb_gcode_words){.jog = jog};
    return wb_gcode_parse(line, words);
}

static void blanks_and_comments_are_removed(void **state)
{
    (void)state;
    char line[16];
    static const char raw[] = " g1 (fast; or not) x2\t; to the end";
    assert_true(wb_gcode_clean(raw, strlen(raw), line, sizeof line));
    assert_string_equal(line, "G1X2");
    assert_true(wb_gcode_clean("", 0, line, sizeof line));
    assert_string_equal(line, "");
    assert_true(wb_gcode_clean("123456789012345", 15, line, sizeof line));
    assert_false(wb_gcode_clean("1234567890123456", 16, line, sizeof line));
}

static void words_and_modes_are_read(void **state)
{
    (void)state;
    struct wb_gcode_words words;
    assert_int_equal(parse("G91G20G1X-2.5F120", false, &words), 0);
    assert_true(words.relative && words.inches && !words.rapid && !words.dwell);
    assert_true(wb_gcode_has(&words, 'X') && wb_gcode_has(&words, 'F'));
    assert_false(wb_gcode_has(&words, 'Y'));
    assert_close(wb_gcode_value(&words, 'X'), -2.5, 0.0);
    assert_close(wb_gcode_value(&words, 'F'), 120.0, 0.0);
    assert_int_equal(parse("G4P0.01", false, &words), 0);
    assert_true(words.dwell);
    assert_int_equal(parse("G53G0X-1", false, &words), 0);
    assert_true(words.machine && words.rapid);
}

static void other_modes_are_unchanged(void **state)
{
    (void)state;
    struct wb_gcode_words words = {.relative = true, .inches = true, .rapid = true};
    assert_int_equal(wb_gcode_parse("X1", &words), 0);
    assert_true(words.relative && words.inches && words.rapid);
}

static void errors_have_the_numbers_of_grbl(void **state)
{
    (void)state;
    static const struct {
        const char *line;
        bool jog;
        int error;
    } cases[] = {
        {"1X2", false, 1},       {"X", false, 2},         {"XF100", false, 2},
        {"X1.2.3", false, 2},    {"X--1", false, 2},      {"X1e5", false, 1},
        {"X99999999", false, 2}, {"G2X1", false, 20},     {"G5.1", false, 20},
        {"M6", false, 20},       {"Q1", false, 20},       {"X1X2", false, 25},
        {"G0X1F1", true, 16},    {"G91G21X1F1", true, 0}, {"M3", true, 16},
        {"X1S5F1", true, 16},    {"G53X1F1", true, 0},    {"M30", false, 0},
        {"G17G54G94", false, 0}, {"", false, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_gcode_words words;
        const int error = parse(cases[i].line, cases[i].jog, &words);
        if (error != cases[i].error)
            fail_msg("'%s': error %d, expected %d", cases[i].line, error, cases[i].error);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blanks_and_comments_are_removed),
        cmocka_unit_test(words_and_modes_are_read),
        cmocka_unit_test(other_modes_are_unchanged),
        cmocka_unit_test(errors_have_the_numbers_of_grbl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
