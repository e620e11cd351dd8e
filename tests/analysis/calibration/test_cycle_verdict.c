/* One judgement of a calibration on whole cycles: exit code, warnings and finding are read from it.
 */
#include <math.h>

#include "analysis/calibration/cycle/cycle_verdict.h"
#include "tests/check.h"

/* A made-up calibration of two specimens that nothing restricts. */
struct made {
    struct wb_cycle_calibration calibration;
    struct wb_cycle_member members[2];
    struct wb_cycle_remarks remarks;
    struct wb_cycle_calibrate_settings settings;
};

static struct made *make(void)
{
    static struct made made;
    memset(&made, 0, sizeof made);
    struct wb_cycle_calibration *const c = &made.calibration;
    c->n_members = 2;
    c->members = made.members;
    c->has_unloading = c->is_followed = true;
    c->rigidity.deviation = 0.03;
    for (int i = 0; i < 2; i++)
        made.members[i].answers[c->chosen].fit.is_converged = true;
    c->unloading = (struct wb_cycle_stiffness){.n = 1, .curvature = {1.0}};
    for (int k = 0; k < WB_CYCLE_NUMBERS; k++)
        c->budget[k] = (struct wb_budget){.combined = 0.01, .factor = 2.0};
    return &made;
}

static struct wb_cycle_verdict judge(const struct made *made)
{
    return wb_cycle_verdict(&made->calibration, &made->remarks, &made->settings);
}

static void complete_calibration_has_no_restriction(void **state)
{
    (void)state;
    const struct wb_cycle_verdict v = judge(make());
    assert_int_equal(v.first, WB_CYCLE_RESTRICTIONS);
    assert_true(wb_cycle_verdict_is_complete(&v));
}

static void each_restriction_is_found(void **state)
{
    (void)state;
    struct made *made = make();
    made->calibration.is_stopped = true;
    made->calibration.is_followed = false; /* nothing is decided of the laws then */
    struct wb_cycle_verdict v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_STOPPED);
    assert_false(v.has[WB_CYCLE_NO_LAW_FITS] || wb_cycle_verdict_is_complete(&v));

    made = make();
    made->members[1].answers[0].fit.is_converged = false;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_NOT_CONVERGED);
    assert_false(wb_cycle_verdict_is_complete(&v));

    made = make();
    made->calibration.is_followed = false;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_NO_LAW_FITS);
    assert_false(wb_cycle_verdict_is_complete(&v));

    made = make();
    made->calibration.has_unloading = made->calibration.is_followed = false;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_LOADING_ONLY);
    assert_true(wb_cycle_verdict_is_complete(&v));

    made = make();
    made->calibration.rigidity.deviation = (double)NAN;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_SCATTER_UNKNOWN);
    assert_true(wb_cycle_verdict_is_complete(&v));
}

static void only_doubts_are_counted_of_the_remarks(void **state)
{
    (void)state;
    struct made *const made = make();
    made->remarks.n = 3;
    made->remarks.items[0].severity = WB_CHECK_NOTE;
    made->remarks.items[1].severity = WB_CHECK_DOUBT;
    made->remarks.items[2].severity = WB_CHECK_DOUBT;
    const struct wb_cycle_verdict v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_DOUBTFUL);
    assert_int_equal(v.n_doubts, 2);
    assert_true(wb_cycle_verdict_is_complete(&v));
}

/* 1 % with a factor of 2 is known within exp(0.02) - 1. */
static void uncertainty_is_judged_against_at_most(void **state)
{
    (void)state;
    struct made *made = make();
    made->settings.at_most = 0.021;
    struct wb_cycle_verdict v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_RESTRICTIONS);
    made->settings.at_most = 0.020;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_UNCERTAIN);
    assert_close(v.known, expm1(0.02), 1e-12);
    assert_close(v.at_most, 0.020, 0.0);
    assert_true(v.worst[0] != '\0');
    assert_false(wb_cycle_verdict_is_complete(&v));

    /* Doubts come first in words, but do not hide it from the exit code. */
    made->remarks.n = 1;
    made->remarks.items[0].severity = WB_CHECK_DOUBT;
    v = judge(made);
    assert_int_equal(v.first, WB_CYCLE_DOUBTFUL);
    assert_true(v.has[WB_CYCLE_UNCERTAIN]);
    assert_false(wb_cycle_verdict_is_complete(&v));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(complete_calibration_has_no_restriction),
        cmocka_unit_test(each_restriction_is_found),
        cmocka_unit_test(only_doubts_are_counted_of_the_remarks),
        cmocka_unit_test(uncertainty_is_judged_against_at_most),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
