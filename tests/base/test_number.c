#include "tests/check.h"

#include <stdlib.h>

#include "base/number.h"
#include "base/random.h"

static void plain_decimals_are_numbers(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double value;
    } cases[] = {
        {"85", 85.0}, {" 0.99 ", 0.99}, {"-1e-3", -1e-3}, {"+.5", 0.5}, {"2.", 2.0}, {"1E6", 1e6},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value = -1.0;
        assert_true(wb_number_parse(cases[i].text, &value));
        assert_true(value == cases[i].value);
    }
}

static void anything_else_is_not_a_number(void **state)
{
    (void)state;
    static const char *const cases[] = {"",      " ",   "85 mm", "nan", "inf",  "0x10", "1,5",
                                        "1e999", "--1", "1 2",   "e5",  "true", "1e",   "."};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double value = 3.0;
        assert_false(wb_number_parse(cases[i], &value));
        assert_true(value == 3.0);
    }
}

static void whole_numbers_stay_in_range(void **state)
{
    (void)state;
    long value = 0;
    assert_true(wb_number_parse_integer("-12", &value));
    assert_int_equal(value, -12);
    assert_false(wb_number_parse_integer("99999999999999999999", &value));
    assert_false(wb_number_parse_integer("1.0", &value));
    assert_false(wb_number_parse_integer("", &value));
}

static void formatting_reads_back_bit_for_bit(void **state)
{
    (void)state;
    srand(1);
    char text[WB_NUMBER_TEXT];
    for (int i = 0; i < 20000; i++) {
        uint64_t bits = 0;
        for (int k = 0; k < 5; k++)
            bits = bits << 15 ^ (uint64_t)rand();
        double value, again;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value))
            continue;
        assert_true(strlen(wb_number_format(value, text)) < WB_NUMBER_TEXT);
        assert_true(wb_number_parse(text, &again));
        assert_memory_equal(&value, &again, sizeof value);
    }
}

static void formatting_is_short_where_it_can_be(void **state)
{
    (void)state;
    char text[WB_NUMBER_TEXT];
    assert_string_equal(wb_number_format(0.1, text), "0.1");
    assert_string_equal(wb_number_format(53.0, text), "53");
    assert_string_equal(wb_number_format((double)NAN, text), "nan");
    assert_string_equal(wb_number_format(-(double)INFINITY, text), "-inf");
}

/* Numbers of all sizes and lengths, also those below DBL_MIN. */
static void formatting_is_that_of_the_fewest_digits(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 50000; i++) {
        char text[WB_NUMBER_TEXT], expected[WB_NUMBER_TEXT];
        double value = ldexp(wb_random_between(1, 2, i, -1.0, 1.0), (int)(i % 2100) - 1070);
        if (i % 2 == 0) {
            snprintf(text, sizeof text, "%.*g", 1 + (int)(i % 17), value);
            value = strtod(text, NULL);
        }
        for (int digits = 6; digits <= 17; digits++) {
            snprintf(expected, sizeof expected, "%.*g", digits, value);
            if (strtod(expected, NULL) == value)
                break;
        }
        if (isfinite(value))
            assert_string_equal(wb_number_format(value, text), expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plain_decimals_are_numbers),
        cmocka_unit_test(anything_else_is_not_a_number),
        cmocka_unit_test(whole_numbers_stay_in_range),
        cmocka_unit_test(formatting_reads_back_bit_for_bit),
        cmocka_unit_test(formatting_is_short_where_it_can_be),
        cmocka_unit_test(formatting_is_that_of_the_fewest_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
