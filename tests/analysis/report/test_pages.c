/* Numbers in the cells of a report's tables. */
#include "analysis/report/pages.h"

#include <math.h>

#include "tests/check.h"

#define MINUS "\xe2\x88\x92"
#define DASH "\xe2\x80\x93"

static const struct wb_document_column columns[] = {{"one", .right = true}};

static void start(struct wb_document *document, struct wb_document_table **table)
{
    wb_document_init(document, "Report", "Numbers", "", "", "2026-11-24");
    *table = wb_document_table(document, "", 1, columns);
    assert_non_null(*table);
}

static const char *last_cell(const struct wb_document_table *table)
{
    return table->cells[table->n_rows - 1].text;
}

static void what_rounds_to_zero_has_no_sign(void **state)
{
    (void)state;
    struct wb_document document;
    struct wb_document_table *table;
    static const struct {
        double low, high;
        int decimals;
        const char *number, *range; /* of `low`; of both */
    } cases[] = {
        {-0.004, 0.11, 2, "0.00", "0.00 to 0.11"},
        {-0.006, 0.11, 2, MINUS "0.01", MINUS "0.01 to 0.11"},
        {-12.0, -0.3, 0, MINUS "12", MINUS "12 to 0"},
        {-0.0, 1.0, 1, "0.0", "0.0 to 1.0"},
        {(double)NAN, 1.0, 1, DASH, DASH},
        {1.0, (double)INFINITY, 1, "1.0", DASH},
    };
    start(&document, &table);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        wb_document_row(table, false);
        wb_pages_cell_number(table, cases[i].low, cases[i].decimals);
        assert_string_equal(last_cell(table), cases[i].number);
        wb_document_row(table, false);
        wb_pages_cell_range(table, WB_TONE_PLAIN, cases[i].low, cases[i].high, cases[i].decimals);
        assert_string_equal(last_cell(table), cases[i].range);
    }
    wb_document_release(&document);
}

static void three_digits_mean_something(void **state)
{
    (void)state;
    assert_int_equal(wb_pages_decimals(1234.0), 0);
    assert_int_equal(wb_pages_decimals(123.0), 0);
    assert_int_equal(wb_pages_decimals(12.3), 1);
    assert_int_equal(wb_pages_decimals(0.123), 3);
    assert_int_equal(wb_pages_decimals(1e-9), 6);
    assert_int_equal(wb_pages_decimals(0.0), 0);
    assert_int_equal(wb_pages_decimals(-1.0), 0);
    assert_int_equal(wb_pages_decimals((double)NAN), 0);
}

static void symbols_and_powers_of_ten_are_typeset(void **state)
{
    (void)state;
    static const struct {
        const char *plain, *markup;
    } cases[] = {
        {"sigma_Y 3.5 MPa", "<i>\xcf\x83</i><sub>Y</sub> 3.5 MPa"},
        {"strains 1.13e-04, 2e+05", "strains 1.13\xc2\xb7"
                                    "10<sup>" MINUS "4</sup>, 2\xc2\xb7"
                                    "10<sup>5</sup>"},
        {"C1 7, gamma2 0.1", "<i>C</i><sub>1</sub> 7, <i>\xce\xb3</i><sub>2</sub> 0.1"},
        {"E: eq. 8 with E_eff & K", "<i>E</i>: eq. 8 with <i>E</i><sub>eff</sub> &amp; <i>K</i>"},
        {"+- of N mm2", "\xc2\xb1 of N mm\xc2\xb2"},
        /* What is no symbol stays: words, units, files, versions. */
        {"bend n-type EPDM b.csv 1e3 v1.5e", "bend n-type EPDM b.csv 1e3 v1.5e"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct wb_text text = {0};
        wb_pages_append_symbols(&text, cases[i].plain);
        assert_string_equal(wb_text_string(&text), cases[i].markup);
        wb_text_release(&text);
    }
}

static void a_checksum_is_shown_by_its_first_16_digits(void **state)
{
    (void)state;
    struct wb_document document;
    struct wb_document_table *table;
    start(&document, &table);
    wb_document_row(table, false);
    wb_pages_cell_checksum(table,
                           "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef");
    assert_string_equal(last_cell(table), "0123456789abcdef");
    wb_document_release(&document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rounds_to_zero_has_no_sign),
        cmocka_unit_test(three_digits_mean_something),
        cmocka_unit_test(symbols_and_powers_of_ten_are_typeset),
        cmocka_unit_test(a_checksum_is_shown_by_its_first_16_digits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
