#include "daq/protocol/motion.h"

#include "tests/check.h"

static void long_motion_is_a_trapezoid(void **state)
{
    (void)state;
    struct wb_motion motion;
    double x, v;
    wb_motion_plan(&motion, 10.0, -0.06, 0.0, -0.007, &(struct wb_motion_limits){1e-3, 0.05});
    /* 53 mm at 1 mm/s and two ramps of 20 ms, each of which costs 10 ms. */
    assert_close(wb_motion_finish(&motion), 10.0 + 53.0 + 0.02, 1e-9);
    wb_motion_at(&motion, 10.0, &x, &v);
    assert_close(x, -0.06, 0.0);
    assert_close(v, 0.0, 0.0);
    wb_motion_at(&motion, 10.01, &x, &v);
    assert_close(x, -0.06 + 0.5 * 0.05 * 1e-4, 1e-12);
    assert_close(v, 0.5e-3, 1e-12);
    wb_motion_at(&motion, 20.0, &x, &v);
    assert_close(x, -0.06 + 1e-3 * (10.0 - 0.01), 1e-12);
    assert_close(v, 1e-3, 1e-12);
    wb_motion_at(&motion, 1e3, &x, &v);
    assert_close(x, -0.007, 0.0);
    assert_close(v, 0.0, 0.0);
}

static void short_motion_is_a_triangle(void **state)
{
    (void)state;
    struct wb_motion motion;
    double x, v;
    wb_motion_plan(&motion, 0.0, 0.01, 0.0, 0.0099, &(struct wb_motion_limits){1.0, 0.1});
    const double half = sqrt(1e-4 / 0.1);
    assert_close(wb_motion_finish(&motion), 2.0 * half, 1e-12);
    wb_motion_at(&motion, half, &x, &v);
    assert_close(x, 0.00995, 1e-12);
    assert_close(v, -0.1 * half, 1e-12);
}

static void position_and_speed_are_continuous(void **state)
{
    (void)state;
    struct wb_motion motion;
    double x, v, before, speed;
    wb_motion_plan(&motion, 0.0, 0.0, 0.004, 0.02, &(struct wb_motion_limits){0.01, 0.05});
    wb_motion_at(&motion, 0.0, &before, &speed);
    assert_close(speed, 0.004, 1e-15);
    const double dt = 1e-4;
    for (double t = dt; t < wb_motion_finish(&motion) + 0.1; t += dt) {
        wb_motion_at(&motion, t, &x, &v);
        assert_close(x - before, 0.5 * (v + speed) * dt, 1e-9);
        assert_true(fabs(v - speed) <= 0.05 * dt * 1.0001);
        before = x;
        speed = v;
    }
    assert_close(before, 0.02, 0.0);
}

static void braking_distance_follows_from_the_speed(void **state)
{
    (void)state;
    struct wb_motion motion;
    double x, v, at, speed;
    wb_motion_plan(&motion, 0.0, 0.0, 0.0, -0.05, &(struct wb_motion_limits){0.01, 0.05});
    wb_motion_at(&motion, 1.0, &at, &speed);
    wb_motion_brake(&motion, 1.0, 0.05);
    assert_close(wb_motion_finish(&motion), 1.0 + 0.2, 1e-9);
    wb_motion_at(&motion, 1.1, &x, &v);
    assert_close(v, -0.005, 1e-9);
    wb_motion_at(&motion, 2.0, &x, &v);
    assert_close(x, at - 0.5 * 0.01 * 0.2, 1e-9);
    assert_close(v, 0.0, 0.0);
}

static void braking_at_rest_has_no_effect(void **state)
{
    (void)state;
    struct wb_motion motion;
    double x, v;
    wb_motion_plan(&motion, 0.0, 0.0, 0.0, 0.05, &(struct wb_motion_limits){0.01, 0.05});
    wb_motion_brake(&motion, 0.0, 0.05);
    wb_motion_at(&motion, 1.0, &x, &v);
    assert_close(x, 0.0, 0.0);
    assert_close(wb_motion_finish(&motion), 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_motion_is_a_trapezoid),
        cmocka_unit_test(short_motion_is_a_triangle),
        cmocka_unit_test(position_and_speed_are_continuous),
        cmocka_unit_test(braking_distance_follows_from_the_speed),
        cmocka_unit_test(braking_at_rest_has_no_effect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
