/* Comparison of clamp and stage, with synthetic positions of the wire's ends. */
#include "daq/test/clamp_watch.h"

#include <string.h>

#include "base/units.h"
#include "tests/check.h"

static struct wb_tip_watch tip;
static struct wb_clamp_watch watch;
static char text[WB_START_CHECK_TEXT];
static int64_t now_ns;

static int set_up(void **state)
{
    (void)state;
    tip = (struct wb_tip_watch){.found = true, .settled = true, .up = 1};
    watch = (struct wb_clamp_watch){0};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++)
            wb_average_add(&tip.rest[end][k], 0.0);
    return 0;
}

/* Three reports of the stage; clamp and tip where the cameras see them, mm. */
static bool judge(double travel_mm, double clamp_mm, double tip_mm)
{
    bool is_off = false;
    tip.at[1][1] = -clamp_mm * WB_MM;
    tip.at[0][1] = tip_mm * WB_MM;
    for (int i = 0; i < 3; i++) {
        now_ns += 200 * WB_NS_PER_MS;
        tip.seen_ns[0] = tip.seen_ns[1] = now_ns;
        is_off = wb_clamp_watch_add(&watch, &tip, now_ns, travel_mm * WB_MM, 0.5 * WB_MM, text);
    }
    return is_off;
}

static void clamp_that_follows_the_stage_is_accepted(void **state)
{
    (void)state;
    assert_false(judge(3.0, 3.1, 0.1));
    assert_false(judge(50.0, 50.3, 2.0));
    assert_false(judge(50.0, 54.0, 2.0)); /* steps per mm off by 8 % */
    assert_false(judge(0.0, 0.1, 16.0));  /* a wire that stays bent lifts its tip */
    assert_false(judge(-0.5, 0.5, 16.0));
}

static void jammed_clamp_is_reported_in_both_directions(void **state)
{
    (void)state;
    assert_false(judge(5.0, 5.0, 0.1));
    assert_false(judge(8.0, 5.0, 0.1));
    assert_true(judge(9.0, 5.0, 0.1));
    assert_non_null(
        strstr(text, "reports 9.0 mm of travel, but the cameras see the clamp at 5.0 mm"));
    assert_false(judge(50.0, 50.0, 2.0));
    assert_true(judge(20.0, 40.0, 10.0));
}

static void one_report_or_a_hidden_clamp_is_not_judged(void **state)
{
    (void)state;
    assert_false(judge(5.0, 5.0, 0.1));
    for (int i = 0; i < 10; i++) {
        now_ns += 200 * WB_NS_PER_MS;
        tip.seen_ns[1] = now_ns;
        tip.at[1][1] = i % 3 == 0 ? -20.0 * WB_MM : 0.0;
        assert_false(wb_clamp_watch_add(&watch, &tip, now_ns, 20.0 * WB_MM, 0.5 * WB_MM, text));
    }
    tip.at[1][1] = 0.0;
    for (int i = 0; i < 10; i++) {
        now_ns += 400 * WB_NS_PER_MS;
        tip.seen_ns[1] = now_ns - 301 * WB_NS_PER_MS;
        assert_false(wb_clamp_watch_add(&watch, &tip, now_ns, 20.0 * WB_MM, 0.5 * WB_MM, text));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(clamp_that_follows_the_stage_is_accepted, set_up),
        cmocka_unit_test_setup(jammed_clamp_is_reported_in_both_directions, set_up),
        cmocka_unit_test_setup(one_report_or_a_hidden_clamp_is_not_judged, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
