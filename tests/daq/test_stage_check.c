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
        fail_msg("'%s' does not say '%s'", text, words);
}

static void a_well_set_stage_passes(void **state)
{
    (void)state;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    rig.stage.steps = 800.0 / WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
}

static void a_speed_above_the_firmwares_is_refused(void **state)
{
    (void)state;
    motion.speed = 10.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    settings.speed = 30.0 * WB_MM / 60.0;
    motion.speed = 1.0 * WB_MM;
    assert_refused("0.5 mm/s at most ($111=30 mm/min), and 1 mm/s are wanted: set $111=60");
}

static void a_speed_that_takes_too_long_to_brake_is_refused(void **state)
{
    (void)state;
    settings.acceleration = motion.speed = 5.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    settings.acceleration = 2.0 * WB_MM;
    assert_refused("needs 2.5 s to brake from 5 mm/s ($121=2 mm/s2)");
}

static void inches_are_refused(void **state)
{
    (void)state;
    settings.inches = true;
    assert_refused("set $13=0");
}

static void other_steps_than_the_rig_files_are_refused(void **state)
{
    (void)state;
    rig.stage.steps = 400.0 / WB_MM;
    assert_refused("$101=800 steps/mm, the rig file says stage.steps_per_mm 400");
}

static void a_move_beyond_the_soft_limits_is_refused(void **state)
{
    (void)state;
    motion.to = 0.0;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    motion.to = 0.5 * WB_MM;
    assert_refused("-64 mm to 0 ($131)");
    motion.to = -64.5 * WB_MM;
    assert_refused("the stage stands at -62.000 mm");
    settings.soft_limits = false;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    /* Firmware that counts upwards from its switch. */
    settings.soft_limits = true;
    motion.from = 2.0 * WB_MM;
    motion.to = 55.0 * WB_MM;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
}

static void the_way_up_ends_at_the_soft_limit(void **state)
{
    (void)state;
    assert_close(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM), 2.0 * WB_MM, 1e-12);
    rig.stage.down = -1;
    assert_close(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM), 62.0 * WB_MM, 1e-12);
    settings.soft_limits = false;
    assert_true(isinf(wb_stage_check_way_up(&settings, &rig, -62.0 * WB_MM)));
}

static void what_the_firmware_did_not_tell_is_not_checked(void **state)
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
static void a_tic_is_refused_in_its_own_units(void **state)
{
    (void)state;
    strcpy(rig.stage.protocol, "tic");
    rig.stage.steps = 3200.0 / WB_MM;
    settings.steps = settings.travel = (double)NAN;
    settings.soft_limits = false;
    assert_true(wb_stage_check(&settings, &rig, &motion, text));
    motion.speed = 12.0 * WB_MM;
    assert_refused("(Max speed=320000000 pulses/10000 s), and 12 mm/s are wanted: set Max "
                   "speed=384000000");
    motion.speed = 16.0 * WB_MM;
    assert_refused("makes 15.625 mm/s at most with 3200 steps/mm");
    motion.speed = 10.0 * WB_MM;
    settings.acceleration = 5.0 * WB_MM;
    assert_refused("(Max acceleration=1600000 pulses/s/100 s), too long to stop it safely: set Max "
                   "acceleration=3200000");
}

static void a_fault_of_the_controller_is_refused_first(void **state)
{
    (void)state;
    strcpy(settings.fault, "the timeout is off: switch it on");
    motion.speed = 100.0;
    assert_refused("the timeout is off: switch it on");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_well_set_stage_passes),
        TEST(a_speed_above_the_firmwares_is_refused),
        TEST(a_speed_that_takes_too_long_to_brake_is_refused),
        TEST(inches_are_refused),
        TEST(other_steps_than_the_rig_files_are_refused),
        TEST(a_move_beyond_the_soft_limits_is_refused),
        TEST(the_way_up_ends_at_the_soft_limit),
        TEST(what_the_firmware_did_not_tell_is_not_checked),
        TEST(a_tic_is_refused_in_its_own_units),
        TEST(a_fault_of_the_controller_is_refused_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
