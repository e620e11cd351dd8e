/* What the settings of the stage's firmware allow. */
#include "daq/acquire/stage_check.h"

#include "base/units.h"
#include "tests/check.h"

static struct wb_rig rig;
static struct wb_stage_settings settings;
static struct wb_stage_motion motion;
static char text[WB_INTERLOCK_TEXT];

/* 53 mm down at 1 mm/s, with everything as it should be. */
static int set_up(void **state)
{
    (void)state;
    rig = (struct wb_rig){.time_scale = 1.0};
    rig.stage.axis = 'Y';
    rig.stage.down = 1;
    settings = (struct wb_stage_settings){.steps = 800.0 / WB_MM,
                                          .speed = 10.0 * WB_MM,
                                          .acceleration = 50.0 * WB_MM,
                                          .travel = 64.0 * WB_MM,
                                          .soft_limits = true};
    motion =
        (struct wb_stage_motion){.from = -62.0 * WB_MM, .to = -9.0 * WB_MM, .speed = 1.0 * WB_MM};
    return 0;
}

static void assert_refused(const char *words)
{
    text[0] = '\0';
    assert_false(wb_stage_check(&settings, &rig, &motion, text));
    if (!strstr(text, words))
        fail_msg("'%s' does not contain '%s'", text, words);
}

static void correctly_configured_stage_passes(void **state)
{
    (void)state;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    rig.stage.steps = 800.0 / WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
}

static void speed_above_the_firmwares_is_rejected(void **state)
{
    (void)state;
    motion.speed = 10.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    settings.speed = 30.0 * WB_MM / 60.0;
    motion.speed = 1.0 * WB_MM;
    assert_refused("1 mm/s exceeds the 0.5 mm/s");
    assert_refused("($111=30 mm/min): set $111=60");
}

static void speed_that_takes_too_long_to_brake_is_rejected(void **state)
{
    (void)state;
    settings.acceleration = motion.speed = 5.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    settings.acceleration = 2.0 * WB_MM;
    assert_refused("needs 2.5 s to brake from 5 mm/s ($121=2 mm/s2)");
}

static void inches_are_rejected(void **state)
{
    (void)state;
    settings.inches = true;
    assert_refused("set $13=0");
}

static void steps_that_differ_from_the_rig_file_are_rejected(void **state)
{
    (void)state;
    rig.stage.steps = 400.0 / WB_MM;
    assert_refused("$101=800 steps/mm, but stage.steps_per_mm of the rig file is 400");
}

static void move_beyond_the_soft_limits_is_rejected(void **state)
{
    (void)state;
    motion.to = 0.0;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    motion.to = 0.5 * WB_MM;
    assert_refused("-64 mm to 0 ($131)");
    motion.to = -64.5 * WB_MM;
    assert_refused("-62.000 mm");
    settings.soft_limits = false;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    /* Firmware that counts upwards from its switch. */
    settings.soft_limits = true;
    motion.from = 2.0 * WB_MM;
    motion.to = 55.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
}

static void travel_up_ends_at_the_soft_limit(void **state)
{
    (void)state;
    assert_close(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM), 2.0 * WB_MM, 1e-12);
    rig.stage.down = -1;
    assert_close(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM), 62.0 * WB_MM, 1e-12);
    settings.soft_limits = false;
    assert_true(isinf(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM)));
}

static void unreported_settings_are_not_checked(void **state)
{
    (void)state;
    settings.speed = settings.acceleration = settings.travel = settings.steps = (double)NAN;
    motion.to = 1.0;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    rig.stage.steps = 800.0 / WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
}

#define TEST(name) cmocka_unit_test_setup(name, set_up)

/* In the words of the Tic Control Center. */
static void tic_is_rejected_in_its_own_units(void **state)
{
    (void)state;
    strcpy(rig.stage.protocol, "tic");
    rig.stage.steps = 3200.0 / WB_MM;
    settings.steps = settings.travel = (double)NAN;
    settings.soft_limits = false;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    motion.speed = 12.0 * WB_MM;
    assert_refused("12 mm/s exceeds the 10 mm/s");
    assert_refused("(Max speed=320000000 pulses/10000 s): set Max speed=384000000");
    motion.speed = 16.0 * WB_MM;
    assert_refused("15.625 mm/s with 3200 steps/mm");
    motion.speed = 10.0 * WB_MM;
    settings.acceleration = 5.0 * WB_MM;
    assert_refused("(Max acceleration=1600000 pulses/s/100 s), too long for a safe stop: set Max "
                   "acceleration=3200000");
}

static void controller_fault_is_reported_first(void **state)
{
    (void)state;
    strcpy(settings.fault, "the timeout is off: switch it on");
    motion.speed = 100.0;
    assert_refused("the timeout is off: switch it on");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(correctly_configured_stage_passes),
        TEST(speed_above_the_firmwares_is_rejected),
        TEST(speed_that_takes_too_long_to_brake_is_rejected),
        TEST(inches_are_rejected),
        TEST(steps_that_differ_from_the_rig_file_are_rejected),
        TEST(move_beyond_the_soft_limits_is_rejected),
        TEST(travel_up_ends_at_the_soft_limit),
        TEST(unreported_settings_are_not_checked),
        TEST(tic_is_rejected_in_its_own_units),
        TEST(controller_fault_is_reported_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
