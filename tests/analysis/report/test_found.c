/* The first page of every report and the glossary at its end. */
#include "analysis/report/found.h"

#include <math.h>
#include <string.h>

#include "analysis/report/glossary.h"
#include "tests/check.h"

static void start(struct wb_document *document)
{
    wb_document_init(document, "Report", "Title", "", "", "2026-11-24");
}

static int count_tones(const struct wb_document *document, enum wb_document_tone tone)
{
    int n = 0;
    for (int i = 0; i < document->n; i++)
        n += document->blocks[i].tone == tone;
    return n;
}

/* The index of the block that has the text; -1: none. */
static int find(const struct wb_document *document, const char *text)
{
    for (int i = 0; i < document->n; i++) {
        if (strstr(document->blocks[i].text, text))
            return i;
    }
    return -1;
}

static void parts_are_ordered_whatever_the_order_of_the_sentences(void **state)
{
    (void)state;
    struct wb_document document;
    struct wb_found found = {0};
    start(&document);
    wb_found_say(&found, WB_FOUND_NEXT, "Do %d.", 6);
    wb_found_say(&found, WB_FOUND_UNCHECKED, "Item 5.");
    wb_found_say(&found, WB_FOUND_PASSED, "Item 4.");
    wb_found_say(&found, WB_FOUND_FAILED, "Item 3.");
    wb_found_say(&found, WB_FOUND_RESULT, "Item 2.");
    wb_found_say(&found, WB_FOUND_ORIGIN, "Item 1.");
    wb_found_put(&found, &document);
    assert_int_equal(find(&document, "What was found"), 0);
    for (int i = 1; i < 5; i++) {
        char one[16], other[16];
        snprintf(one, sizeof one, "Item %d.", i);
        snprintf(other, sizeof other, "Item %d.", i + 1);
        assert_true(find(&document, one) >= 0);
        assert_true(find(&document, one) < find(&document, other));
    }
    assert_true(find(&document, "Item 5.") < find(&document, "What to do next"));
    assert_true(find(&document, "What to do next") < find(&document, "Do 6."));
    wb_document_release(&document);
}

/* A failed check, a doubtful result or missing data leave nothing green. */
static void green_is_only_a_page_without_any_failure(void **state)
{
    (void)state;
    static const enum wb_found_part parts[] = {WB_FOUND_UNCHECKED, WB_FOUND_FAILED,
                                               WB_FOUND_DOUBTFUL, WB_FOUND_INCOMPLETE};
    for (int i = 0; i < 4; i++) {
        struct wb_document document;
        struct wb_found found = {0};
        start(&document);
        wb_found_say(&found, WB_FOUND_PASSED, "One.");
        wb_found_say(&found, parts[i], "Other.");
        wb_found_put(&found, &document);
        assert_int_equal(count_tones(&document, WB_TONE_GOOD), i == 0);
        assert_int_equal(count_tones(&document, WB_TONE_WARNING), i > 0);
        wb_document_release(&document);
    }
}

static void values_on_a_limit_stand_in_one_sentence_kept_and_one_exceeded(void **state)
{
    (void)state;
    static const struct wb_verdict verdicts[] = {
        {"RMS", "rms_max", "A & B", 0.132, 0.065, false},
        {"RMS", "rms_max", "C", 0.0157, 0.065, true},
        {"RMS", "rms_max", "D", (double)NAN, 0.065, false},
        {"Cost", "cost_max", NULL, 0.001, 0.02, true},
    };
    struct wb_document document;
    struct wb_found found = {0};
    start(&document);
    wb_found_add_verdicts(&found, verdicts, 4);
    wb_found_put(&found, &document);
    assert_true(find(&document, "RMS, limit 6.5 %: A &amp; B (13.2 %), D (not known).") >= 0);
    assert_true(find(&document, "RMS, limit 6.5 %: C (1.57 %).") >= 0);
    assert_true(find(&document, "Cost, limit 2 %: 0.1 %.") >= 0);
    assert_int_equal(count_tones(&document, WB_TONE_WARNING), 1);
    wb_document_release(&document);
}

static const char *last_text(const struct wb_document *document, int row, int column)
{
    const struct wb_document_table *const table = document->blocks[document->n - 1].table;
    return table->cells[row * table->n_columns + column].text;
}

/* Words and symbols of paragraphs, headings of columns and cells count, those of commands do not.
 */
static void the_glossary_has_the_terms_that_occur_and_no_others(void **state)
{
    static const struct wb_document_column columns[] = {{"<i>EI</i> (N mm\xc2\xb2)"}};
    (void)state;
    struct wb_document document;
    start(&document);
    wb_document_code(&document, "--secant");
    wb_document_paragraph(&document, "A residual Deflection was found.");
    wb_glossary_put(&document);
    const struct wb_document_table *const table = document.blocks[document.n - 1].table;
    assert_non_null(table);
    assert_int_equal(table->n_rows, 2);
    assert_string_equal(last_text(&document, 0, 0), "Deflection");
    assert_string_equal(last_text(&document, 1, 0), "Residual deflection");
    wb_document_release(&document);

    start(&document);
    wb_document_paragraph(&document, "Nothing of that.");
    const int n = document.n;
    wb_glossary_put(&document);
    assert_int_equal(document.n, n);
    wb_document_table(&document, NULL, 1, columns);
    wb_glossary_put(&document);
    assert_string_equal(last_text(&document, 0, 0), "Flexural rigidity");
    wb_document_release(&document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_ordered_whatever_the_order_of_the_sentences),
        cmocka_unit_test(green_is_only_a_page_without_any_failure),
        cmocka_unit_test(values_on_a_limit_stand_in_one_sentence_kept_and_one_exceeded),
        cmocka_unit_test(the_glossary_has_the_terms_that_occur_and_no_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
