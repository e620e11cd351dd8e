/* The speed of a motion, estimated from the position reports of the stage. */
#include "daq/acquire/speed_watch.h"

#include "base/units.h"
#include "tests/check.h"

static const struct wb_motion_limits commanded = {2.0 * WB_MM, 10.0 * WB_MM};

/* Simulates a motion at `share` of the commanded speed, reported five times a second; every second
 * report arrives `delay` s late. */
static struct wb_speed_watch watch_motion(double from, double to, double share, double delay)
{
    struct wb_speed_watch watch;
    struct wb_motion motion;
    const struct wb_motion_limits actual = {share * commanded.speed, commanded.acceleration};
    wb_speed_watch_begin(&watch, from, to, &commanded);
    wb_motion_plan(&motion, 0.05, from, 0.0, to, &actual);
    for (int i = 0; 0.2 * i < wb_motion_finish(&motion) + 1.0; i++) {
        double x = from, v;
        if (0.2 * i > motion.start)
            wb_motion_at(&motion, 0.2 * i, &x, &v);
        wb_speed_watch_add(&watch, wb_ns_from_seconds(0.2 * i + (i % 2) * delay), x);
    }
    return watch;
}

static void speed_is_measured_between_the_ramps(void **state)
{
    (void)state;
    struct wb_speed_watch watch = watch_motion(0.0, 50.0 * WB_MM, 1.0, 0.0);
    assert_close(wb_speed_watch_speed(&watch), 2.0 * WB_MM, 1e-9);
    assert_false(wb_speed_watch_is_off(&watch));
    watch = watch_motion(50.0 * WB_MM, 0.0, 0.98, 0.0);
    assert_close(wb_speed_watch_speed(&watch), 1.96 * WB_MM, 1e-9);
    assert_true(wb_speed_watch_is_off(&watch));
}

static void late_reports_do_not_change_the_speed(void **state)
{
    (void)state;
    struct wb_speed_watch watch = watch_motion(0.0, 4.0 * WB_MM, 1.0, 0.04);
    assert_true(isfinite(wb_speed_watch_speed(&watch)));
    assert_false(wb_speed_watch_is_off(&watch));
    watch = watch_motion(0.0, 4.0 * WB_MM, 0.5, 0.04);
    assert_true(wb_speed_watch_is_off(&watch));
}

static void short_motion_gives_no_speed(void **state)
{
    (void)state;
    const struct wb_speed_watch watch = watch_motion(0.0, 2.0 * WB_MM, 1.0, 0.0);
    assert_true(isnan(wb_speed_watch_speed(&watch)));
    assert_false(wb_speed_watch_is_off(&watch));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(speed_is_measured_between_the_ramps),
        cmocka_unit_test(late_reports_do_not_change_the_speed),
        cmocka_unit_test(short_motion_gives_no_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
