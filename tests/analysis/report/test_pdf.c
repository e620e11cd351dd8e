/* The pages of a document. */
#include "analysis/report/pdf.h"

#include <stdlib.h>

#include "tests/check.h"

/* The number of pages of a document with a table of `n_rows` rows, and two paragraphs behind it
 * that need so much room. */
static int count_pages(int n_rows, double room)
{
    static const struct wb_document_column columns[] = {{"one"}};
    struct wb_document document;
    struct wb_text pdf = {0};
    wb_document_init(&document, "Report", "Pages", "", "", "2026-11-24");
    struct wb_document_table *const table = wb_document_table(&document, NULL, 1, columns);
    for (int i = 0; i < n_rows; i++) {
        wb_document_row(table, false);
        wb_document_cell(table, WB_TONE_PLAIN, "row");
    }
    wb_document_need_room(&document, room);
    wb_document_paragraph(&document, "first");
    wb_document_need_room(&document, room);
    wb_document_paragraph(&document, "second");
    assert_int_equal(wb_pdf_render(&document, &pdf), WB_OK);
    const char *const count = memmem(pdf.bytes, pdf.length, "/Count ", 7);
    assert_non_null(count);
    const int n = atoi(count + 7);
    wb_text_release(&pdf);
    wb_document_release(&document);
    return n;
}

static void what_needs_room_begins_a_page_where_less_is_left(void **state)
{
    (void)state;
    assert_int_equal(count_pages(1, 100.0), 1);
    assert_int_equal(count_pages(1, 600.0), 1);
    assert_int_equal(count_pages(20, 100.0), 1);
    assert_int_equal(count_pages(20, 600.0), 2);
}

/* A page that is still empty is not left. */
static void more_than_a_page_begins_one_page(void **state)
{
    (void)state;
    assert_int_equal(count_pages(1, 5000.0), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_needs_room_begins_a_page_where_less_is_left),
        cmocka_unit_test(more_than_a_page_begins_one_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
