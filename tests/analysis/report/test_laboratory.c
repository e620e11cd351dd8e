/* What a laboratory's report says beside its results, and the decision rules. */
#include "tests/analysis/report/report_folder.h"

#include <math.h>

#include "analysis/report/html.h"
#include "analysis/report/laboratory.h"

static int set_up(void **state)
{
    keep_messages();
    return make_folder(state);
}

/* All that the standard wants, in the order of the page; key, then text. */
static const char *const whole[][2] = {
    {"report", "WB-7"},
    {"name", "Test house <A&B>"},
    {"address", "1 Main Street"},
    {"place", "room 12"},
    {"customer", "a maker"},
    {"item", "6 pieces"},
    {"item_state", "as delivered"},
    {"received", "2026-11-02"},
    {"tested_from", "2026-11-20"},
    {"tested_until", "2026-11-21"},
    {"issued", "2026-11-23"},
    {"method", "cantilever"},
    {"deviations", "none"},
    {"environment", "23 degC"},
    {"authorised_by", "N. N."},
};

/* The whole section without one key (NULL: with all), and more lines at its end. */
static void make_section(char text[4096], const char *without, const char *more)
{
    size_t n = 0;
    for (size_t i = 0; i < WB_COUNT(whole); i++) {
        if (!without || strcmp(whole[i][0], without) != 0)
            n += (size_t)snprintf(text + n, 4096 - n, "%s: \"%s\"\n", whole[i][0], whole[i][1]);
    }
    snprintf(text + n, 4096 - n, "%s", more);
}

static enum wb_status read_section(struct wb_laboratory *laboratory, const char *text, bool known)
{
    struct wb_config *config;
    memset(laboratory, 0, sizeof *laboratory);
    assert_int_equal(wb_config_parse(&config, text, "c.yaml", NULL), WB_OK);
    const enum wb_status status = wb_laboratory_read(wb_config_root(config), known, laboratory);
    wb_config_destroy(config);
    return status;
}

/* A page of its own with these fields, before and behind what a kind of report put; to be freed. */
static char *make_page(const struct wb_laboratory *laboratory)
{
    struct wb_document document;
    struct wb_text html = {0};
    wb_document_init(&document, "Report", "Title", "", "foot", "");
    wb_document_paragraph(&document, "what was found");
    wb_document_paragraph(&document, "and more");
    wb_laboratory_put_pages(&document, laboratory);
    assert_int_equal(wb_html_render(&document, &html), WB_OK);
    wb_document_release(&document);
    return html.bytes;
}

static size_t place_of(const char *page, const char *part)
{
    const char *const at = strstr(page, part);
    if (!at)
        fail_msg("the page does not say '%s'", part);
    return (size_t)(at - page);
}

static void all_fields_stand_before_the_results_and_the_end_behind_them(void **state)
{
    (void)state;
    char text[4096];
    struct wb_laboratory laboratory;
    make_section(text, NULL, "");
    assert_int_equal(read_section(&laboratory, text, false), WB_OK);
    assert_int_equal(wb_laboratory_missing(&laboratory), 0);
    char *const page = make_page(&laboratory);
    const size_t found = place_of(page, "what was found");
    assert_true(found < place_of(page, "and more"));
    assert_true(place_of(page, "and more") < place_of(page, "End of report WB-7."));
    assert_true(place_of(page, "relate only to the items tested") < found);
    assert_true(place_of(page, "simple acceptance") < found);
    for (size_t i = 0; i < WB_COUNT(whole); i++) {
        struct wb_text escaped = {0};
        wb_text_append(&escaped, ">");
        wb_text_append_escaped(&escaped, whole[i][1]);
        wb_text_append(&escaped, "</td>");
        assert_true(place_of(page, wb_text_string(&escaped)) < found);
        wb_text_release(&escaped);
    }
    assert_null(strstr(page, "Not a whole report"));
    assert_null(strstr(page, "Amendment"));
    /* The number stands at the top and at the bottom. */
    assert_non_null(strstr(page + place_of(page, "<footer>"), "Report WB-7"));
    assert_true(place_of(page, "Report WB-7") < place_of(page, "</header>"));
    free(page);
}

static void each_missing_field_is_listed_with_its_clause(void **state)
{
    (void)state;
    for (size_t i = 1; i < WB_COUNT(whole); i++) {
        char text[4096], key[80];
        struct wb_laboratory laboratory;
        make_section(text, whole[i][0], "");
        assert_int_equal(read_section(&laboratory, text, false), WB_OK);
        assert_int_equal(wb_laboratory_missing(&laboratory), 1);
        char *const page = make_page(&laboratory);
        snprintf(key, sizeof key, "(<tt>%s</tt>, clause 7.8.", whole[i][0]);
        assert_true(place_of(page, "1 of its fields is missing") < place_of(page, key));
        free(page);
        struct wb_json *const root = wb_json_create();
        const char *name;
        wb_laboratory_put_numbers(root, &laboratory);
        const struct wb_json *const missing =
            wb_json_get(wb_json_get(root, "laboratory"), "missing");
        assert_int_equal(wb_json_length(missing), 1);
        assert_true(wb_json_text(wb_json_item(missing, 0), &name));
        assert_string_equal(name, whole[i][0]);
        wb_json_destroy(root);
    }
}

static void without_the_section_one_line_says_that_it_is_no_such_report(void **state)
{
    (void)state;
    const struct wb_laboratory none = {0};
    assert_int_equal(wb_laboratory_missing(&none), 0);
    char *const page = make_page(&none);
    assert_true(place_of(page, "not a test report in the sense of ISO/IEC 17025") >
                place_of(page, "and more"));
    assert_null(strstr(page, "End of report"));
    assert_null(strstr(page, "clause"));
    free(page);
}

static void an_amendment_names_what_it_replaces(void **state)
{
    (void)state;
    char text[4096];
    struct wb_laboratory laboratory;
    make_section(text, NULL, "amends: {report: WB-3, issued: 2026-11-10, why: a diameter}\n");
    assert_int_equal(read_section(&laboratory, text, false), WB_OK);
    char *const page = make_page(&laboratory);
    assert_true(place_of(page, "replaces report WB-3 of 2026-11-10") <
                place_of(page, "what was found"));
    assert_non_null(strstr(page, "a diameter"));
    free(page);
}

static void what_makes_no_report_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *without, *more, *message;
    } cases[] = {
        {"report", "", "report"},
        {"report", "report: \"\"\n", "report: expected the number"},
        {"issued", "issued: 23.11.2026\n", "issued: expected a date"},
        {"issued", "issued: 2026-11-20\n", "issued: 2026-11-20 lies before tested_until"},
        {"tested_from", "tested_from: 2026-11-01\n",
         "tested_from: 2026-11-01 lies before received"},
        {NULL, "speed: 3\n", "speed"},
        {NULL, "decision_rule: lenient\n", "decision_rule"},
        {NULL, "decision_rule: guarded\n", "'guarded' needs uncertainties"},
        {NULL, "amends: {report: WB-7, issued: 2026-11-10, why: x}\n", "own number"},
        {NULL, "amends: {report: WB-3, issued: 10.11.2026, why: x}\n", "expected a date"},
        {NULL, "amends: {report: WB-3, issued: 2026-11-10, why: \"\"}\n", "why: expected"},
        {NULL, "amends: {report: WB-3, why: x}\n", "issued"},
    };
    for (size_t i = 0; i < WB_COUNT(cases); i++) {
        char text[4096];
        struct wb_laboratory laboratory;
        make_section(text, cases[i].without, cases[i].more);
        assert_true(read_section(&laboratory, text, false) != WB_OK);
        if (!strstr(kept.error, cases[i].message))
            fail_msg("'%s' does not say '%s'", kept.error, cases[i].message);
    }
    char text[4096];
    struct wb_laboratory laboratory;
    make_section(text, NULL, "decision_rule: guarded\n");
    assert_int_equal(read_section(&laboratory, text, true), WB_OK);
    assert_int_equal(laboratory.rule, WB_RULE_GUARDED);
}

static void the_guarded_rule_adds_the_uncertainty_and_the_simple_one_does_not(void **state)
{
    (void)state;
    const double none = (double)NAN;
    assert_true(wb_verdict_keeps(WB_RULE_SIMPLE, 0.9, 0.5, 1.0));
    assert_true(wb_verdict_keeps(WB_RULE_SIMPLE, 0.9, none, 1.0));
    assert_false(wb_verdict_keeps(WB_RULE_SIMPLE, 1.1, 0.0, 1.0));
    assert_false(wb_verdict_keeps(WB_RULE_SIMPLE, none, 0.0, 1.0));
    assert_true(wb_verdict_keeps(WB_RULE_GUARDED, 0.5, 0.25, 0.75));
    assert_false(wb_verdict_keeps(WB_RULE_GUARDED, 0.5, 0.26, 0.75));
    assert_false(wb_verdict_keeps(WB_RULE_GUARDED, 0.5, none, 0.75));
    assert_false(wb_verdict_keeps(WB_RULE_GUARDED, none, 0.1, 0.75));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_fields_stand_before_the_results_and_the_end_behind_them),
        cmocka_unit_test(each_missing_field_is_listed_with_its_clause),
        cmocka_unit_test(without_the_section_one_line_says_that_it_is_no_such_report),
        cmocka_unit_test(an_amendment_names_what_it_replaces),
        cmocka_unit_test(what_makes_no_report_is_refused),
        cmocka_unit_test(the_guarded_rule_adds_the_uncertainty_and_the_simple_one_does_not),
    };
    return cmocka_run_group_tests(tests, set_up, remove_folder);
}
