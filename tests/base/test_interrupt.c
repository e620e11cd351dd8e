#include <signal.h>

#include "base/interrupt_private.h"
#include "tests/check.h"

static void interrupts_set_the_flag(void **state)
{
    (void)state;
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    wb_interrupt_install();
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        wb_interrupt_set(false);
        raise(signals[i]);
        assert_true(wb_interrupted());
    }
    wb_interrupt_set(false);
}

static void guarded_quit_interrupts_and_the_rest_is_ignored(void **state)
{
    (void)state;
    static const int ignored[] = {SIGPIPE, SIGTSTP, SIGTTIN, SIGTTOU};
    wb_interrupt_install();
    wb_interrupt_guard();
    wb_interrupt_set(false);
    for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++)
        raise(ignored[i]);
    assert_false(wb_interrupted());
    raise(SIGQUIT);
    assert_true(wb_interrupted());
    wb_interrupt_set(false);
}

/* As set by `nohup`. */
static void ignored_hangup_stays_ignored(void **state)
{
    (void)state;
    signal(SIGHUP, SIG_IGN);
    wb_interrupt_install();
    wb_interrupt_set(false);
    raise(SIGHUP);
    assert_false(wb_interrupted());
    signal(SIGHUP, SIG_DFL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ignored_hangup_stays_ignored),
        cmocka_unit_test(interrupts_set_the_flag),
        cmocka_unit_test(guarded_quit_interrupts_and_the_rest_is_ignored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
