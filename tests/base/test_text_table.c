#include "base/text_table.h"

#include <stdlib.h>

#include "tests/check.h"

static struct wb_text_table table;
static struct wb_reason why;

static enum wb_status parse_bytes(const void *bytes, size_t n,
                                  const struct wb_text_table_form *form)
{
    wb_text_table_release(&table);
    memset(&why, 0, sizeof why);
    return wb_text_table_parse(&table, bytes, n, "t.txt", form, &why);
}

static enum wb_status parse(const char *text)
{
    return parse_bytes(text, strlen(text), NULL);
}

static void assert_why(const char *part)
{
    if (!strstr(why.text, part))
        fail_msg("'%s' does not say '%s'", why.text, part);
}

static double number(size_t row, int column)
{
    double value = (double)NAN;
    assert_true(row < table.n_rows && column < table.n_columns);
    assert_int_equal(wb_text_table_number(&table, row, column, &value), WB_FIELD_NUMBER);
    return value;
}

static enum wb_text_field kind(size_t row, int column)
{
    double value;
    return wb_text_table_number(&table, row, column, &value);
}

static void delimiter_and_decimal_sign_are_found(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        char delimiter, decimal;
    } cases[] = {
        {"Time\tLoad\n0.5\t1.25\n1.5\t2.25\n", '\t', '.'},
        {"Time\tLoad\n0,5\t1,25\n1,5\t2,25\n", '\t', ','},
        {"Time;Load\n0.5;1.25\n1.5;2.25\n", ';', '.'},
        {"Time;Load\r\n0,5;1,25\r\n1,5;2,25\r\n", ';', ','},
        {"Time,Load\n0.5,1.25\n1.5,2.25\n", ',', '.'},
        {"Time, Load\n0.5, 1.25\n1.5, 2.25\n", ',', '.'},
        {"Time|Load\r0.5|1.25\r1.5|2.25\r", '|', '.'},
        {"Time Load\n  0.5   1.25\n  1.5   2.25\n", ' ', '.'},
        {"Time Load\n0,5 1,25\n1,5 2,25\n", ' ', ','},
        {"\"Time\",\"Load\"\n\"0.5\",\"1.25\"\n\"1.5\",\"2.25\"\n", ',', '.'},
        {"\"Time\",\"Load\"\n\"0,5\",\"1,25\"\n\"1,5\",\"2,25\"\n", ',', ','},
        {"Time\tLoad\r\r\n0.5\t1.25\r\r\n1.5\t2.25\r\r\n", '\t', '.'},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (parse(cases[i].text) != WB_OK)
            fail_msg("case %zu: %s", i, why.text);
        assert_int_equal(table.delimiter, cases[i].delimiter);
        assert_int_equal(table.decimal, cases[i].decimal);
        assert_int_equal(table.n_columns, 2);
        assert_int_equal(table.n_rows, 2);
        assert_int_equal(table.header_line, 1);
        assert_int_equal(table.n_lines, 3);
        assert_string_equal(table.columns[0].name, "Time");
        assert_string_equal(table.columns[1].name, "Load");
        assert_close(number(0, 0), 0.5, 0.0);
        assert_close(number(1, 1), 2.25, 0.0);
        assert_int_equal(table.lines[1], 3);
        assert_false(table.cut || table.ends_without_end);
    }
}

/* The same table in every encoding, with a letter whose bytes differ in all of them. */
static void encodings_are_found(void **state)
{
    (void)state;
    static const char text[] = "Zeit (s)\tKraft (\xb5N)\n0.5\t1\n1.5\t2\n"; /* Latin-1 */
    for (int encoding = 0; encoding <= WB_ENCODING_LATIN1; encoding++) {
        for (int mark = 0; mark < 2; mark++) {
            unsigned char bytes[256];
            size_t n = 0;
            if (encoding == WB_ENCODING_LATIN1 && mark)
                continue;
            if (mark && encoding == WB_ENCODING_UTF8) {
                memcpy(bytes, "\xef\xbb\xbf", 3);
                n = 3;
            } else if (mark) {
                memcpy(bytes, encoding == WB_ENCODING_UTF16_LE ? "\xff\xfe" : "\xfe\xff", 2);
                n = 2;
            }
            for (const char *at = text; *at; at++) {
                const unsigned char c = (unsigned char)*at;
                if (encoding == WB_ENCODING_UTF16_BE)
                    bytes[n++] = 0;
                if (encoding == WB_ENCODING_UTF8 && c >= 0x80)
                    bytes[n++] = 0xc2;
                bytes[n++] = c;
                if (encoding == WB_ENCODING_UTF16_LE)
                    bytes[n++] = 0;
            }
            if (parse_bytes(bytes, n, NULL) != WB_OK)
                fail_msg("encoding %d: %s", encoding, why.text);
            assert_int_equal(table.encoding, encoding);
            assert_int_equal(table.byte_order_mark, mark);
            assert_string_equal(table.columns[1].name, "Kraft (\xc2\xb5N)");
            assert_close(number(1, 1), 2.0, 0.0);
        }
    }
}

static void empty_and_partial_rows_are_distinguished(void **state)
{
    (void)state;
    assert_int_equal(parse("Time\tLoad\tWay\n0.0\t\t\n\n\t\t\n0.1\t1\t\n0.2\t\t2\n0.3\t3\n"
                           "0.4\tNaN\t---\n0.5\t5\t6\n"),
                     WB_OK);
    assert_int_equal(table.n_rows, 6);
    assert_int_equal(table.n_empty_lines, 2);
    assert_int_equal(kind(0, 0), WB_FIELD_NUMBER);
    assert_int_equal(kind(0, 1), WB_FIELD_EMPTY);
    assert_int_equal(kind(1, 2), WB_FIELD_EMPTY);
    assert_int_equal(kind(2, 1), WB_FIELD_EMPTY);
    assert_int_equal(kind(3, 2), WB_FIELD_EMPTY);
    assert_int_equal(kind(4, 1), WB_FIELD_EMPTY);
    assert_int_equal(kind(4, 2), WB_FIELD_EMPTY);
    assert_close(number(5, 2), 6.0, 0.0);
    assert_int_equal(table.lines[5], 9);
}

static void a_table_may_have_no_header(void **state)
{
    (void)state;
    assert_int_equal(parse("0\t1\n1\t2\n"), WB_OK);
    assert_int_equal(table.header_line, 0);
    assert_string_equal(table.columns[1].name, "");
    assert_int_equal(table.n_rows, 2);
}

static void lines_above_the_header_are_ignored(void **state)
{
    (void)state;
    assert_int_equal(parse("Test of 2024-05-01\nRate;100\n\nTime;Load\ns;N\n0,1;5\n0,2;6\n"),
                     WB_OK);
    assert_int_equal(table.header_line, 4);
    assert_string_equal(table.columns[0].name, "Time");
    assert_string_equal(table.columns[0].unit, "s");
    assert_string_equal(table.columns[1].unit, "N");
    assert_int_equal(table.n_rows, 2);
    assert_int_equal(table.lines[0], 6);
}

static void columns_of_words_are_allowed(void **state)
{
    (void)state;
    assert_int_equal(parse("Time;State;Load\n0.1;up;5\n0.2;up;6\n"), WB_OK);
    assert_int_equal(table.n_rows, 2);
    assert_int_equal(kind(0, 1), WB_FIELD_TEXT);
    assert_close(number(1, 2), 6.0, 0.0);
    wb_text_table_reject(&table, "t.txt", 1, 1, "expected a number", &why);
    assert_why("t.txt:3: column 2 'State': expected a number, not 'up'");
}

static void a_truncated_end_is_detected(void **state)
{
    (void)state;
    assert_int_equal(parse("a\tb\n0.1\t5\n0.2\t6"), WB_OK);
    assert_true(table.ends_without_end);
    assert_false(table.cut);
    assert_int_equal(parse("a\tb\n0.1\t5\n0.2"), WB_OK);
    assert_true(table.cut);
    assert_int_equal(parse_bytes("\xff\xfe"
                                 "1\0\t\0"
                                 "2\0\n\0"
                                 "3\0\t\0"
                                 "4\0\n",
                                 17, NULL),
                     WB_OK);
    assert_true(table.cut);
}

static void ambiguous_tables_are_rejected_with_line_and_column(void **state)
{
    (void)state;
    static const struct {
        const char *text, *expected;
    } cases[] = {
        {"", "no row of numbers"},
        {"Time\tLoad\n", "no row of numbers"},
        {"a\tb\n0.1\t5\n0.2\t6\t7\n", "t.txt:3: column 3: more fields than the 2 columns"},
        {"a\tb\n0.1\t5\n0.2\t6,5\n", "t.txt:3: column 2: '6,5' has a comma"},
        {"a\tb\n1\t1,234\n2\t2,345\n", "t.txt:2: column 2: the comma in '1,234'"},
        {"a\tb\n1\t1,234.5\n2\t2,345.5\n3\t1.5\n", "t.txt:3: the line mixes numbers and words"},
        {"Time,Load\n0,1,5,2\n0,2,6,3\n", "t.txt:1: 2 column names above rows of 4 fields"},
        {"a\tb\n0.x\t5\n0.2\t6\n0.3\t7\n", "t.txt:2: the line mixes numbers and words"},
        {"a\tb\n0.1\t5\nstop\n0.2\t6\n0.3\t6\n", "t.txt:3: text between rows of numbers"},
        {"a\tb\n0.1\t5\n0.2\t\x01\n", "t.txt:3: character 5 (0x01) is "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (parse(cases[i].text) != WB_ERR_FORMAT)
            fail_msg("case %zu is not rejected", i);
        assert_why(cases[i].expected);
    }
    assert_int_equal(parse_bytes("\xff\xfe\0\0a\0\0\0", 8, NULL), WB_ERR_UNSUPPORTED);
    assert_int_equal(parse_bytes("\xff\xfe\x31\0\x09\0\x00\xd8\x31\0", 10, NULL), WB_ERR_FORMAT);
    assert_why("t.txt:1: character 3 (0xd800) is ");
}

static void a_given_decimal_sign_removes_ambiguity(void **state)
{
    (void)state;
    static const char text[] = "a\tb\n1\t1,234\n2\t2,345\n";
    const struct wb_text_table_form form = {'\0', ','};
    assert_int_equal(parse_bytes(text, strlen(text), &form), WB_OK);
    assert_close(number(1, 1), 2.345, 0.0);
    const struct wb_text_table_form blanks = {' ', '\0'};
    assert_int_equal(parse_bytes("1 2 3\n4 5 6\n", 12, &blanks), WB_OK);
    assert_int_equal(table.n_columns, 3);
}

static int finish(void **state)
{
    (void)state;
    wb_text_table_release(&table);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(delimiter_and_decimal_sign_are_found),
        cmocka_unit_test(encodings_are_found),
        cmocka_unit_test(empty_and_partial_rows_are_distinguished),
        cmocka_unit_test(a_table_may_have_no_header),
        cmocka_unit_test(lines_above_the_header_are_ignored),
        cmocka_unit_test(columns_of_words_are_allowed),
        cmocka_unit_test(a_truncated_end_is_detected),
        cmocka_unit_test(ambiguous_tables_are_rejected_with_line_and_column),
        cmocka_unit_test(a_given_decimal_sign_removes_ambiguity),
    };
    return cmocka_run_group_tests(tests, NULL, finish);
}
