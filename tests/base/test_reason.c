/* Reasons: texts returned with a result, and the log if no reason is passed. */
#include "tests/messages.h"

#include <string.h>

#include "base/reason.h"

#define WB_LOG_DOMAIN "test"

static enum wb_status fail_with(struct wb_reason *reason, int number)
{
    return wb_fail_to(reason, WB_ERR_DATA, "number %d rejected", number);
}

static void a_failure_goes_to_the_reason_and_not_to_the_log(void **state)
{
    (void)state;
    struct wb_reason reason = {.text = "of before"};
    keep_messages();
    assert_int_equal(fail_with(&reason, 7), WB_ERR_DATA);
    release_messages();
    assert_string_equal(reason.text, "number 7 rejected");
    assert_int_equal(kept.n, 0);
}

static void a_failure_without_a_reason_is_logged(void **state)
{
    (void)state;
    keep_messages();
    assert_int_equal(fail_with(NULL, 8), WB_ERR_DATA);
    release_messages();
    assert_int_equal(kept.n, 1);
    assert_int_equal(kept.level, WB_LOG_ERROR);
    assert_string_equal(kept.domain, "test");
    assert_string_equal(kept.last, "number 8 rejected");
}

static void a_text_can_be_replaced_by_one_that_contains_it(void **state)
{
    (void)state;
    struct wb_reason reason = {0};
    wb_reason_set(&reason, "wire %d", 1);
    assert_string_equal(reason.text, "wire 1");
    wb_reason_set(&reason, "of all: %s", reason.text);
    assert_string_equal(reason.text, "of all: wire 1");
    wb_reason_set(&reason, "none");
    assert_string_equal(reason.text, "none");
}

static enum wb_status lose(struct wb_reason *reason, const char *table)
{
    return wb_fail_also(reason, WB_ERR_DATA, "table %s is lost", table);
}

static void failures_are_appended(void **state)
{
    (void)state;
    struct wb_reason reason = {.text = ""};
    keep_messages();
    assert_int_equal(lose(&reason, "a"), WB_ERR_DATA);
    assert_string_equal(reason.text, "table a is lost");
    assert_int_equal(lose(&reason, "b"), WB_ERR_DATA);
    assert_string_equal(reason.text, "table a is lost; table b is lost");
    assert_int_equal(kept.n, 0);
    assert_int_equal(lose(NULL, "c"), WB_ERR_DATA);
    release_messages();
    assert_int_equal(kept.n, 1);
    assert_string_equal(kept.domain, "test");
    assert_string_equal(kept.last, "table c is lost");
}

/* The last bytes that fit are "..."; a character of two bytes would be cut by them. */
static void a_long_text_is_cut_after_a_complete_character(void **state)
{
    (void)state;
    const size_t most = sizeof(struct wb_reason) - 1;
    struct wb_reason reason = {0};
    char text[2 * sizeof reason];

    memset(text, 'x', sizeof text);
    text[most] = '\0';
    wb_reason_set(&reason, "%s", text);
    assert_string_equal(reason.text, text);
    text[most] = 'x';
    text[most + 1] = '\0';
    wb_reason_set(&reason, "%s", text);
    assert_int_equal(strlen(reason.text), most);
    assert_string_equal(reason.text + most - 4, "x...");

    memcpy(text + most - 4, "\xc3\xa9", 2);
    wb_reason_set(&reason, "%s", text);
    assert_int_equal(strlen(reason.text), most - 1);
    assert_string_equal(reason.text + most - 5, "x...");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failure_goes_to_the_reason_and_not_to_the_log),
        cmocka_unit_test(a_failure_without_a_reason_is_logged),
        cmocka_unit_test(a_text_can_be_replaced_by_one_that_contains_it),
        cmocka_unit_test(failures_are_appended),
        cmocka_unit_test(a_long_text_is_cut_after_a_complete_character),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
