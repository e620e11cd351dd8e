#include "daq/protocol/line_buffer.h"
#include "daq/protocol/loadcell_line.h"

#include <stdlib.h>

#include "base/units.h"
#include "tests/check.h"

static const struct wb_rig_load_cell plain = {.scale = 1.0, .sign = 1};

/* Decodes from a copy of exactly the line's size, so that ASan sees any overrun. */
static struct wb_line_reading decode_with(const char *line, const struct wb_rig_load_cell *cell)
{
    struct wb_line_reading reading;
    const size_t n = strlen(line);
    char *const copy = malloc(n ? n : 1);
    assert_non_null(copy);
    memcpy(copy, line, n);
    wb_line_decode(copy, n, cell, &reading);
    free(copy);
    return reading;
}

static struct wb_line_reading decode(const char *line)
{
    return decode_with(line, &plain);
}

static void lines_of_known_instruments_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *line;
        double value;
        const char *unit;
        bool unstable;
    } cases[] = {
        {"S S     100.00 g", 100.0, "g", false},    /* Mettler, stable */
        {"S D     100.00 g", 100.0, "g", true},     /* and dynamic */
        {"S D      -0.52 mg\r", -0.52, "mg", true}, /* CR left over */
        {"2345", 2345.0, "", false},                /* Loadstar, thousandths of a pound */
        {"-18.78 lbF", -18.78, "lbF", false},       /* Mark-10 */
        {"4.285 N", 4.285, "N", false},             /* Mark-10 */
        {"4.285", 4.285, "", false},                /* Mark-10 without its unit */
        {"0.1234", 0.1234, "", false},              /* HX711 sketches */
        {"Reading: 0.123 kg", 0.123, "kg", false},
        {"weight = -0.5 g", -0.5, "g", false},
        {"+  12.34 G S", 12.34, "G", false}, /* KERN */
        {"+  12.34 GLS", 12.34, "G", false},
        {"-  12.34 GHU", -12.34, "G", true},
        {"   192.21 g", 192.21, "g", false}, /* Ohaus */
        {"   192.21 g ?", 192.21, "g", true},
        {"ST,+00018.27  g", 18.27, "g", false}, /* A&D */
        {"US,-0183.96  g", -183.96, "g", true},
        {"+  12.34 g  ", 12.34, "g", false}, /* Sartorius */
        {"+  12.34    ", 12.34, "", false},
        {"N     +  12.34 g  ", 12.34, "g", false},
        {"S ? -  12.3 g", -12.3, "g", true}, /* Radwag */
        {"SI - 12.3 g", -12.3, "g", false},
        {"ST,GS,+  4.876kg", 4.876, "kg", false}, /* generic indicators */
        {"US,NT,-  4.876kg", -4.876, "kg", true},
        {"G 00000", 0.0, "", false}, /* tecsis */
        {"12.5E-3 kN", 0.0125, "kN", false},
        {".5 N", 0.5, "N", false},
        {"5. N", 5.0, "N", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct wb_line_reading reading = decode(cases[i].line);
        if (reading.kind != WB_LINE_VALUE)
            fail_msg("'%s' refused: %s", cases[i].line, reading.reason ? reading.reason : "?");
        assert_close(reading.value, cases[i].value, 1e-15);
        assert_string_equal(reading.unit, cases[i].unit);
        assert_int_equal(reading.unstable, cases[i].unstable);
    }
}

static void lines_that_are_not_readings_are_rejected_with_a_reason(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "S I",         "S +",      "S -",        "ES",       "ET",         "EL",
        "*10",         "Err 55",   "Err 3.1",    "A00",      "E01",        "nan",
        "?",           "-",        "+",          "g",        "12.3 g 4 N", "12.3 12.4",
        "12.5\t0.123", "1.2.3",    "--5",        "0x10",     "1e999",      "5 N extra N",
        "HX711 ready", "12.3 E5",  "Ch1: 0.12",  "3:05 4 g", "12 kg/h 3",  "+-3 g",
        "12.3 g kg",   "\x01\x02", "12\x80.3 g",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        const struct wb_line_reading reading = decode(lines[i]);
        if (reading.kind != WB_LINE_REFUSED)
            fail_msg("'%s' was taken as kind %d, value %g", lines[i], (int)reading.kind,
                     reading.value);
        assert_non_null(reading.reason);
    }
    assert_int_equal(decode("").kind, WB_LINE_EMPTY);
    assert_int_equal(decode("  \t \r").kind, WB_LINE_EMPTY);
}

static void commas_are_rejected_unless_the_rig_has_decimal_commas(void **state)
{
    (void)state;
    struct wb_rig_load_cell comma = plain;
    comma.decimal_comma = true;
    assert_int_equal(decode("1,234").kind, WB_LINE_REFUSED);
    assert_int_equal(decode("1,234 g").kind, WB_LINE_REFUSED);
    assert_int_equal(decode("12,5 kg").kind, WB_LINE_REFUSED);
    assert_int_equal(decode_with("1,234 g", &comma).kind, WB_LINE_VALUE);
    assert_close(decode_with("1,234 g", &comma).value, 1.234, 1e-15);
    assert_close(decode_with("ST,GS,+  4,876kg", &comma).value, 4.876, 1e-15);
    assert_int_equal(decode_with("1.234 g", &comma).kind, WB_LINE_REFUSED);
    assert_int_equal(decode_with("1,234,567 g", &comma).kind, WB_LINE_REFUSED);
}

static void overload_has_priority_over_numbers(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "OL,+9999999E+19", "OL",         "ol",           "ST,OL",
        "+9999999E+19 g",  "9999999",    "-99999999 g",  "8388607",
        "-8388608",        "inf",        "-INF",         "+Infinity N",
        "S ^ 12.3 g",      "S v -0.1 g", "+  12.34 G E", "12.34 GLE",
    };
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        if (decode(lines[i]).kind != WB_LINE_OVERLOAD)
            fail_msg("'%s' is not seen as an overload", lines[i]);
    /* Near misses are readings. */
    assert_int_equal(decode("8388606").kind, WB_LINE_VALUE);
    assert_int_equal(decode("999999 g").kind, WB_LINE_VALUE);
    assert_int_equal(decode("99.99999 g").kind, WB_LINE_VALUE);
}

static void tokens_of_the_rig_mark_overload_and_instability(void **state)
{
    (void)state;
    struct wb_rig_load_cell cell = plain;
    strcpy(cell.overload_tokens[0], "HIGH");
    strcpy(cell.overload_tokens[1], "32767");
    strcpy(cell.unstable_tokens[0], "moving");
    assert_int_equal(decode_with("HIGH 12.3 g", &cell).kind, WB_LINE_OVERLOAD);
    assert_int_equal(decode_with("+32767.0", &cell).kind, WB_LINE_OVERLOAD);
    assert_int_equal(decode_with("32766", &cell).kind, WB_LINE_VALUE);
    const struct wb_line_reading reading = decode_with("moving: 12.3 g", &cell);
    assert_int_equal(reading.kind, WB_LINE_VALUE);
    assert_true(reading.unstable);
    assert_false(decode_with("still: 12.3 g", &cell).unstable);
}

static void column_is_selected_by_the_delimiter(void **state)
{
    (void)state;
    struct wb_rig_load_cell cell = plain;
    cell.delimiter = ',';
    cell.column = 3;
    assert_close(decode_with("1200,8388607,0.125 kg", &cell).value, 0.125, 0.0);
    assert_string_equal(decode_with("1200,77,0.125 kg,x", &cell).unit, "kg");
    assert_int_equal(decode_with("1200,77", &cell).kind, WB_LINE_REFUSED);
    assert_int_equal(decode_with("1200,77,", &cell).kind, WB_LINE_REFUSED);
    assert_int_equal(decode_with("1200,77,inf", &cell).kind, WB_LINE_OVERLOAD);
    /* A time stamp may be any number: saturated values count in the value's column only. */
    assert_int_equal(decode_with("9999999,77,0.125", &cell).kind, WB_LINE_VALUE);
    assert_true(decode_with("US,GS,+4.8 g", &cell).kind == WB_LINE_VALUE);
    cell.delimiter = '\t';
    cell.column = 2;
    assert_close(decode_with("12.5\t-0.123", &cell).value, -0.123, 0.0);
}

static void units_are_forces_or_masses_under_gravity(void **state)
{
    (void)state;
    static const struct {
        const char *unit;
        double newtons; /* under 9.81 m/s2 */
    } cases[] = {
        {"g", 9.81e-3},
        {"kg", 9.81},
        {"mg", 9.81e-6},
        {"lb", 0.45359237 * 9.81},
        {"oz", 0.028349523125 * 9.81},
        {"N", 1.0},
        {"mN", 1e-3},
        {"kN", 1e3},
        {"lbF", 4.4482216152605},
        {"ozF", 4.4482216152605 / 16},
        {"gf", 9.80665e-3},
        {"kgf", 9.80665},
        {"ct", 2e-4 * 9.81},
        {"uN", 1e-6},
    };
    double newtons;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_true(wb_line_unit_factor(cases[i].unit, 9.81, &newtons));
        assert_close_relative(newtons, cases[i].newtons, 1e-15);
    }
    assert_false(wb_line_unit_factor("MN", 9.81, &newtons));
    assert_false(wb_line_unit_factor("", 9.81, &newtons));
    assert_false(wb_line_unit_factor("pcs", 9.81, &newtons));
    /* A micro sign, in UTF-8 and in Latin-1. */
    assert_string_equal(decode("12 \xC2\xB5N").unit, "uN");
    assert_string_equal(decode("12 \xB5N").unit, "uN");
}

static void force_is_scaled_shifted_and_signed(void **state)
{
    (void)state;
    double force;
    struct wb_rig_load_cell cell = {.scale = 0.5, .offset = 2.0, .sign = -1};
    const struct wb_line_reading reading = decode("10 g");
    assert_true(wb_line_force(&reading, &cell, 9.80665, &force));
    assert_close(force, -(0.5 * 10.0 + 2.0) * 9.80665e-3, 1e-15);
    /* The rig file's unit is used for lines without a unit or with an unknown one. */
    assert_false(wb_line_unit_contradicts(&reading, &cell));
    strcpy(cell.unit, "mN");
    assert_true(wb_line_force(&reading, &cell, 9.80665, &force));
    assert_close(force, -7.0 * 9.80665e-3, 1e-15);
    assert_true(wb_line_unit_contradicts(&reading, &cell));
    const struct wb_line_reading without = decode("10"), unknown = decode("10 pcs");
    assert_true(wb_line_force(&without, &cell, 9.80665, &force));
    assert_close(force, -7e-3, 1e-15);
    assert_true(wb_line_force(&unknown, &cell, 9.80665, &force));
    assert_close(force, -7e-3, 1e-15);
    assert_false(wb_line_unit_contradicts(&without, &cell));
    assert_false(wb_line_unit_contradicts(&unknown, &cell));
    /* One force by two names. */
    strcpy(cell.unit, "gf");
    assert_false(wb_line_unit_contradicts(&reading, &cell));
    const struct wb_line_reading bare = decode("10");
    assert_false(wb_line_force(&bare, &plain, 9.80665, &force));
}

static void lines_end_as_the_rig_says(void **state)
{
    (void)state;
    static const struct {
        const char *terminator, *bytes;
        int n_ends;
    } cases[] = {
        {"any", "1\r\n2\r3\n", 4}, {"", "1\r\n2\r3\n", 4},    {"cr", "1\r\n2\r3\n", 2},
        {"lf", "1\r\n2\r3\n", 2},  {"crlf", "1\r\n2\r\n", 2}, {"idle", "1\r\n2\r3\n", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_line_buffer buffer = {0};
        int n_ends = 0;
        for (const char *c = cases[i].bytes; *c; c++)
            n_ends += wb_line_buffer_push(&buffer, (uint8_t)*c, cases[i].terminator);
        assert_int_equal(n_ends, cases[i].n_ends);
    }
    struct wb_line_buffer buffer = {0};
    for (int i = 0; i < 300; i++)
        assert_false(wb_line_buffer_push(&buffer, '1', "lf"));
    assert_true(buffer.overlong && buffer.n == sizeof buffer.bytes);
    wb_line_buffer_clear(&buffer);
    assert_true(!buffer.overlong && buffer.n == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_of_known_instruments_are_read),
        cmocka_unit_test(lines_that_are_not_readings_are_rejected_with_a_reason),
        cmocka_unit_test(commas_are_rejected_unless_the_rig_has_decimal_commas),
        cmocka_unit_test(overload_has_priority_over_numbers),
        cmocka_unit_test(tokens_of_the_rig_mark_overload_and_instability),
        cmocka_unit_test(column_is_selected_by_the_delimiter),
        cmocka_unit_test(units_are_forces_or_masses_under_gravity),
        cmocka_unit_test(force_is_scaled_shifted_and_signed),
        cmocka_unit_test(lines_end_as_the_rig_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
