#include "tests/messages.h"

#include "base/status.h"

#define WB_LOG_DOMAIN "test"

static enum wb_status fail_with(int number)
{
    return wb_fail(WB_ERR_DATA, "number %d rejected", number);
}

static enum wb_status call_refuse(int *after)
{
    WB_TRY(fail_with(7));
    *after = 1;
    return WB_OK;
}

static void a_failure_logs_one_message_and_is_returned(void **state)
{
    (void)state;
    keep_messages();
    int after = 0;
    assert_int_equal(call_refuse(&after), WB_ERR_DATA);
    release_messages();
    assert_int_equal(after, 0);
    assert_int_equal(kept.n, 1);
    assert_int_equal(kept.level, WB_LOG_ERROR);
    assert_string_equal(kept.domain, "test");
    assert_string_equal(kept.last, "number 7 rejected");
}

static void every_status_has_its_own_text(void **state)
{
    (void)state;
    for (int a = WB_OK; a >= WB_ERR_CONVERGENCE; a--) {
        assert_string_not_equal(wb_status_text(a), "unknown status");
        for (int b = a - 1; b >= WB_ERR_CONVERGENCE; b--)
            assert_string_not_equal(wb_status_text(a), wb_status_text(b));
    }
    assert_string_equal(wb_status_text(-99), "unknown status");
}

static void messages_above_the_threshold_are_dropped(void **state)
{
    (void)state;
    keep_messages();
    wb_debug("not delivered at the usual threshold");
    assert_int_equal(kept.n, 0);
    wb_log_set_threshold(WB_LOG_ERROR);
    wb_warn("not delivered either");
    assert_int_equal(kept.n, 0);
    wb_error("delivered");
    assert_int_equal(kept.n, 1);
    wb_log_set_threshold(WB_LOG_INFO);
    release_messages();
}

static void severe_messages_are_downgraded(void **state)
{
    (void)state;
    keep_messages();
    assert_int_equal(wb_log_set_gravest(WB_LOG_DEBUG), WB_LOG_ERROR);
    wb_error("tried in vain");
    assert_int_equal(kept.n, 0);
    wb_log_set_threshold(WB_LOG_DEBUG);
    wb_error("tried in vain again");
    wb_log_set_threshold(WB_LOG_INFO);
    assert_int_equal(kept.n, 1);
    assert_int_equal(kept.level, WB_LOG_DEBUG);
    assert_string_equal(kept.last, "tried in vain again");
    assert_int_equal(wb_log_set_gravest(WB_LOG_ERROR), WB_LOG_DEBUG);
    wb_error("after");
    release_messages();
    assert_int_equal(kept.n, 2);
    assert_int_equal(kept.level, WB_LOG_ERROR);
    assert_string_equal(kept.last, "after");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failure_logs_one_message_and_is_returned),
        cmocka_unit_test(every_status_has_its_own_text),
        cmocka_unit_test(messages_above_the_threshold_are_dropped),
        cmocka_unit_test(severe_messages_are_downgraded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
