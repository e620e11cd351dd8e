/* The simulated GRBL stage, tested against GRBL's documented answers. */
#include "fixtures/virtual/sim_stage.h"

#include "base/random.h"
#include "base/units.h"
#include "tests/check.h"

struct scene {
    struct wb_sim_stage stage;
    double t;
    char said[4096];
};

static const struct wb_sim_stage_settings plain = {
    .axis = 'X', .down = 1, .clamp.travel = 60.0 * WB_MM, .time_scale = 1.0};

static void open_scene(struct scene *scene, const struct wb_sim_stage_settings *settings)
{
    memset(scene, 0, sizeof *scene);
    wb_sim_stage_init(&scene->stage, settings);
}

static const char *listen(struct scene *scene)
{
    scene->said[wb_reply_take(&scene->stage.out, scene->said, sizeof scene->said - 1)] = '\0';
    return scene->said;
}

/* Sends text and returns the immediate reply. */
static const char *send(struct scene *scene, const char *text)
{
    wb_sim_stage_receive(&scene->stage, scene->t, text, strlen(text));
    return listen(scene);
}

static void wait(struct scene *scene, double seconds)
{
    scene->t += seconds;
    wb_sim_stage_advance(&scene->stage, scene->t);
}

static double travel(struct scene *scene)
{
    return wb_sim_stage_travel(&scene->stage, scene->t);
}

static void assert_state(struct scene *scene, const char *state)
{
    char expected[32];
    snprintf(expected, sizeof expected, "<%s|MPos:", state);
    const char *const report = send(scene, "?");
    if (strncmp(report, expected, strlen(expected)) != 0)
        fail_msg("report '%s', expected state %s", report, state);
}

/* Most tests use a default stage after power-up. */
static int set_up(void **state)
{
    static struct scene scene;
    open_scene(&scene, &plain);
    *state = &scene;
    return 0;
}

#define SCENE_TEST(test) cmocka_unit_test_setup(test, set_up)

static void settings_and_queries_are_answered(void **state)
{
    struct scene *const scene = *state;
    wb_sim_stage_greet(&scene->stage);
    assert_string_equal(listen(scene), "\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_string_equal(send(scene, "\n"), "ok\r\n");
    assert_non_null(strstr(send(scene, "$I\n"), "virtual rig"));
    assert_non_null(strstr(send(scene, "$$\n"), "$130=64.000\r\n"));
    assert_non_null(strstr(send(scene, "$#\n"), "[G54:0.000,0.000,0.000]\r\n"));
    assert_non_null(strstr(send(scene, "$G\n"), "G21 G90"));
    assert_string_equal(send(scene, "$120=100\n"), "ok\r\n");
    assert_non_null(strstr(send(scene, "$$\n"), "$120=100.000\r\n"));
    assert_string_equal(send(scene, "$120=-1\n"), "error:4\r\n");
    assert_string_equal(send(scene, "$999=1\n"), "error:3\r\n");
    assert_string_equal(send(scene, "$QQ\n"), "error:3\r\n");
    assert_string_equal(send(scene, "hello\n"), "error:2\r\n");
    assert_string_equal(send(scene, "G4 P0.01 (sync)\n"), "");
    wait(scene, 0.02);
    assert_string_equal(listen(scene), "ok\r\n");
}

static void a_jog_moves_the_clamp_at_the_feed(void **state)
{
    struct scene *const scene = *state;
    assert_close(travel(scene), 0.0, 1e-9);
    assert_string_equal(send(scene, "$J=G91 G21 X53.000 F60.000\n"), "ok\r\n");
    wait(scene, 10.0);
    assert_state(scene, "Jog");
    assert_close(travel(scene), (10.0 - 0.01) * WB_MM, 2e-6);
    wait(scene, 42.9);
    assert_state(scene, "Jog");
    wait(scene, 0.2);
    assert_state(scene, "Idle");
    assert_close(travel(scene), 53.0 * WB_MM, 1e-9);
    assert_string_equal(send(scene, "$J=G91 G21 X-53.000 F6000.000\n"), "ok\r\n");
    /* Limited to the axis's 10 mm/s. */
    wait(scene, 5.0);
    assert_state(scene, "Jog");
    wait(scene, 1.0);
    assert_close(travel(scene), 0.0, 1e-9);
}

static void down_can_be_the_negative_direction(void **state)
{
    (void)state;
    struct scene scene;
    struct wb_sim_stage_settings settings = plain;
    settings.down = -1;
    settings.axis = 'Z';
    open_scene(&scene, &settings);
    assert_string_equal(send(&scene, "$J=G91 G21 Z-20 F600\n"), "ok\r\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), 20.0 * WB_MM, 1e-9);
    assert_string_equal(send(&scene, "$J=G91 G21 Z30 F600\n"), "error:15\r\n");
}

static void jogs_beyond_the_travel_are_rejected(void **state)
{
    struct scene *const scene = *state;
    assert_string_equal(send(scene, "$J=G91 G21 X62.1 F600\n"), "error:15\r\n");
    assert_string_equal(send(scene, "$J=G91 G21 X-2.1 F600\n"), "error:15\r\n");
    assert_string_equal(send(scene, "$J=G91 G21 X62.0 F600\n"), "ok\r\n");
    wait(scene, 20.0);
    assert_close(travel(scene), 62.0 * WB_MM, 1e-9);
    assert_string_equal(send(scene, "$J=G91 X1\n"), "error:22\r\n");
    assert_string_equal(send(scene, "$J=G91 F10\n"), "error:26\r\n");
    assert_string_equal(send(scene, "$J=G0 X1 F10\n"), "error:16\r\n");
}

static void consecutive_jogs_do_not_stop_in_between(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X2 F60\n");
    wait(scene, 1.5);
    assert_string_equal(send(scene, "$J=G91 G21 X2 F60\n"), "ok\r\n");
    wait(scene, 0.5);
    const double at_two = travel(scene);
    wait(scene, 0.1);
    assert_close(travel(scene) - at_two, 0.1 * WB_MM, 2e-6);
    wait(scene, 3.0);
    assert_state(scene, "Idle");
    assert_close(travel(scene), 4.0 * WB_MM, 1e-9);
}

/* 14 blocks wait behind the one being executed; the next line is read when a slot becomes free. */
static void lines_wait_while_the_planner_is_full(void **state)
{
    struct scene *const scene = *state;
    for (int i = 0; i < 15; i++)
        assert_string_equal(send(scene, "$J=G91 G21 X0.1 F60\n"), "ok\r\n");
    assert_string_equal(send(scene, "$J=G91 G21 X0.1 F60\n"), "");
    wait(scene, 0.09);
    assert_string_equal(listen(scene), "");
    /* 0.1 mm and the start, which takes 10 ms. */
    wait(scene, 0.021);
    assert_string_equal(listen(scene), "ok\r\n");
    wait(scene, 2.0);
    assert_close(travel(scene), 1.6 * WB_MM, 1e-9);
    assert_state(scene, "Idle");
}

/* The planner stops at the end of its last block; a block that arrives while the steps of braking
 * are already passed to the motor is joined after them. */
static void a_late_block_is_joined_after_the_steps_already_sent(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X1 F600\n"); /* at most 7.1 mm/s; 0.14 s of acceleration and braking */
    wait(scene, 0.2);
    const double at = travel(scene);
    send(scene, "$J=G91 G21 X9 F600\n");
    wait(scene, 0.049);
    const double speed = (travel(scene) - at) / 0.049;
    assert_true(speed < 4.2 * WB_MM);
    wait(scene, 0.2);
    const double then = travel(scene);
    wait(scene, 0.01);
    assert_true(travel(scene) - then > 9.0 * 0.01 * WB_MM);
    wait(scene, 2.0);
    assert_close(travel(scene), 10.0 * WB_MM, 1e-9);
}

static void the_next_line_starts_after_a_cancelled_jog(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X30 F600\n");
    wait(scene, 1.1);
    const double at = travel(scene);
    assert_string_equal(send(scene, "\x85$J=G91 G21 X0.5 F600\n"), "");
    wait(scene, 1.0);
    assert_string_equal(listen(scene), "ok\r\n");
    assert_close(travel(scene), at + 1.5 * WB_MM, 3e-6);
}

static void a_clock_that_runs_fast_makes_the_stage_fast(void **state)
{
    (void)state;
    struct scene scene;
    struct wb_sim_stage_settings settings = plain;
    settings.clock_error = 0.02;
    open_scene(&scene, &settings);
    send(&scene, "$J=G91 G21 X50 F60\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), (10.2 - 0.01) * WB_MM, 2e-6);
    assert_non_null(strstr(send(&scene, "?"), "FS:60,0"));
}

static void opposite_jogs_wait_for_each_other(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X5 F600\n");
    assert_string_equal(send(scene, "$J=G91 G21 X-4 F600\n"), "ok\r\n");
    double highest = 0.0;
    for (int i = 0; i < 400; i++) {
        wait(scene, 0.01);
        highest = fmax(highest, travel(scene));
    }
    assert_close(highest, 5.0 * WB_MM, 20e-6);
    assert_close(travel(scene), 1.0 * WB_MM, 1e-9);
}

static void a_hold_cancels_a_jog_and_ends_idle(void **state)
{
    (void)state;
    static const char *const bytes[] = {"!", "\x85"};
    for (int i = 0; i < 2; i++) {
        struct scene scene;
        open_scene(&scene, &plain);
        send(&scene, "$J=G91 G21 X30 F600\n");
        send(&scene, "$J=G91 G21 X-5 F600\n");
        wait(&scene, 1.2);
        const double at = travel(&scene);
        send(&scene, bytes[i]);
        assert_state(&scene, "Jog");
        wait(&scene, 0.5);
        assert_state(&scene, "Idle");
        /* It stopped within 0.2 s from 10 mm/s, 1 mm, and dropped the rest. */
        assert_close(travel(&scene), at + 1.0 * WB_MM, 3e-6);
        wait(&scene, 5.0);
        assert_close(travel(&scene), at + 1.0 * WB_MM, 3e-6);
    }
}

static void a_hold_at_rest_blocks_lines_until_resumed(void **state)
{
    struct scene *const scene = *state;
    send(scene, "!");
    assert_state(scene, "Hold:0");
    assert_string_equal(send(scene, "$J=G91 G21 X1 F60\n"), "");
    wait(scene, 3.0);
    assert_close(travel(scene), 0.0, 1e-9);
    /* The line waited in the buffer. */
    assert_string_equal(send(scene, "~"), "ok\r\n");
    assert_state(scene, "Jog");
    wait(scene, 2.0);
    assert_close(travel(scene), 1.0 * WB_MM, 1e-9);
}

static void a_program_move_holds_and_resumes(void **state)
{
    struct scene *const scene = *state;
    assert_string_equal(send(scene, "G91 G1 X10 F600\n"), "ok\r\n");
    wait(scene, 0.5);
    send(scene, "!");
    assert_state(scene, "Hold:1");
    wait(scene, 0.5);
    assert_state(scene, "Hold:0");
    send(scene, "~");
    assert_state(scene, "Run");
    wait(scene, 2.0);
    assert_state(scene, "Idle");
    assert_close(travel(scene), 10.0 * WB_MM, 1e-9);
}

static void a_reset_in_motion_alarms_and_locks(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X30 F600\n");
    wait(scene, 1.0);
    const double at = travel(scene);
    assert_string_equal(send(scene, "\x18"), "ALARM:3\r\n\r\nGrbl 1.1h ['$' for help]\r\n"
                                             "[MSG:'$H'|'$X' to unlock]\r\n");
    assert_state(scene, "Alarm");
    wait(scene, 1.0);
    assert_close(travel(scene), at, 1e-9);
    assert_string_equal(send(scene, "$J=G91 G21 X1 F60\n"), "error:8\r\n");
    assert_string_equal(send(scene, "G91 G1 X1 F60\n"), "error:9\r\n");
    assert_string_equal(send(scene, "$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
    assert_state(scene, "Idle");
}

static void a_reset_at_rest_only_sends_the_banner(void **state)
{
    struct scene *const scene = *state;
    assert_string_equal(send(scene, "\x18"), "\r\nGrbl 1.1h ['$' for help]\r\n");
    send(scene, "!");
    assert_string_equal(send(scene, "\x18"), "\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_state(scene, "Idle");
}

static void a_program_move_beyond_the_travel_alarms_until_reset(void **state)
{
    struct scene *const scene = *state;
    assert_string_equal(send(scene, "G91 G1 X100 F600\n"),
                        "ALARM:2\r\n[MSG:Reset to continue]\r\n");
    assert_string_equal(send(scene, "$X\n"), "error:3\r\n");
    send(scene, "\x18");
    assert_string_equal(send(scene, "$X\n"), "[MSG:Caution: Unlocked]\r\nok\r\n");
}

static void homing_brings_the_clamp_to_the_start(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X20 F600\n");
    wait(scene, 3.0);
    assert_string_equal(send(scene, "$H\n"), "");
    assert_state(scene, "Home");
    wait(scene, 2.0);
    assert_string_equal(send(scene, "$J=G91 G21 X1 F60\n"), "");
    wait(scene, 10.0);
    assert_string_equal(listen(scene), "ok\r\nok\r\n");
    wait(scene, 2.0);
    assert_close(travel(scene), 1.0 * WB_MM, 1e-9);
    assert_string_equal(send(scene, "$22=0\n"), "ok\r\n");
    assert_string_equal(send(scene, "$H\n"), "error:5\r\n");
}

static void a_reset_while_homing_is_alarm_six(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$H\n");
    wait(scene, 0.1);
    assert_int_equal(strncmp(send(scene, "\x18"), "ALARM:6\r\n", 9), 0);
}

static void lost_steps_remain_until_homed(void **state)
{
    (void)state;
    struct scene scene;
    struct wb_sim_stage_settings settings = plain;
    settings.clamp.lost_steps = 0.8 * WB_MM;
    settings.clamp.lost_at = 20.0 * WB_MM;
    open_scene(&scene, &settings);
    send(&scene, "$J=G91 G21 X30 F600\n");
    double before = 0.0;
    for (int i = 0; i < 400; i++) {
        wait(&scene, 0.01);
        assert_true(travel(&scene) >= before - 1e-9);
        before = travel(&scene);
    }
    assert_close(travel(&scene), 29.2 * WB_MM, 2e-6);
    send(&scene, "$J=G91 G21 X-30 F600\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), -0.8 * WB_MM, 2e-6);
    send(&scene, "$H\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), 0.0, 2e-6);
}

static void end_stops_stall_the_motor(void **state)
{
    struct scene *const scene = *state;
    assert_string_equal(send(scene, "$20=0\n"), "ok\r\n");
    assert_string_equal(send(scene, "$J=G91 G21 X70 F600\n"), "ok\r\n");
    for (int i = 0; i < 100; i++) {
        wait(scene, 0.1);
        travel(scene);
    }
    assert_close(travel(scene), 62.5 * WB_MM, 2e-6);
    /* It was commanded to 70 mm: 70 mm back is 7.5 mm too far, into the other stop. */
    send(scene, "$J=G91 G21 X-70 F600\n");
    for (int i = 0; i < 100; i++) {
        wait(scene, 0.1);
        travel(scene);
    }
    assert_close(travel(scene), -2.5 * WB_MM, 2e-6);
    assert_string_equal(send(scene, "$H\n"), "");
    wait(scene, 20.0);
    assert_string_equal(listen(scene), "ok\r\n");
    assert_close(travel(scene), 0.0, 2e-6);
}

/* Random bytes at random times: it stays within its stops and keeps answering. */
static void random_bytes_are_harmless(void **state)
{
    (void)state;
    static const char alphabet[] = "?!~\x18\x85\n\r$JGXYFMH=0129.-+ (;)\xff\x91$X\n$H\n";
    struct scene scene;
    open_scene(&scene, &plain);
    for (uint64_t i = 0; i < 40000; i++) {
        char bytes[8];
        for (uint64_t k = 0; k < sizeof bytes; k++) {
            const uint64_t pick = wb_random_bits(1, i, k);
            bytes[k] =
                pick % 7 == 0 ? (char)(pick >> 8) : alphabet[(pick >> 8) % (sizeof alphabet - 1)];
        }
        wb_sim_stage_receive(&scene.stage, scene.t, bytes, sizeof bytes);
        listen(&scene);
        wait(&scene, 0.02);
        const double at = travel(&scene);
        assert_true(at >= -2.6 * WB_MM && at <= 62.6 * WB_MM);
    }
    send(&scene, "\x18");
    wait(&scene, 1.0);
    assert_non_null(strstr(send(&scene, "\n$I\n"), "virtual rig"));
}

static void some_reports_include_the_work_offset(void **state)
{
    struct scene *const scene = *state;
    int offsets = 0;
    for (int i = 0; i < 100; i++)
        offsets += strstr(send(scene, "?"), "|WCO:") != NULL;
    assert_int_equal(offsets, 10);
    assert_string_equal(send(scene, "$10=0\n"), "ok\r\n");
    assert_non_null(strstr(send(scene, "?"), "WPos:"));
}

static void a_reset_empties_the_receive_buffer(void **state)
{
    struct scene *const scene = *state;
    send(scene, "$J=G91 G21 X1");
    send(scene, "\x18");
    assert_string_equal(send(scene, "\n"), "ok\r\n");
}

static void endless_lines_are_rejected(void **state)
{
    (void)state;
    struct scene scene;
    char flood[1000];
    open_scene(&scene, &plain);
    memset(flood, 'X', sizeof flood);
    wb_sim_stage_receive(&scene.stage, 0.0, flood, 100);
    assert_string_equal(send(&scene, "\n"), "error:11\r\n");
    wb_sim_stage_receive(&scene.stage, 0.0, flood, sizeof flood);
    assert_non_null(strstr(listen(&scene), "error:11\r\n"));
    assert_string_equal(send(&scene, "$I\n") + strlen(scene.said) - 4, "ok\r\n");
}

static void with_a_time_scale_feeds_are_in_host_time(void **state)
{
    (void)state;
    struct scene scene;
    struct wb_sim_stage_settings settings = plain;
    settings.time_scale = 10.0;
    open_scene(&scene, &settings);
    /* 10 mm/s in host time is 1 mm/s in bench time. */
    send(&scene, "$J=G91 G21 X53 F600\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), (10.0 - 0.01) * WB_MM, 2e-6);
    assert_non_null(strstr(send(&scene, "?"), "FS:600,0"));
}

static void a_jammed_clamp_stays_until_homed(void **state)
{
    (void)state;
    static struct scene scene;
    struct wb_sim_stage_settings settings = plain;
    settings.clamp.stuck_at = 7.0 * WB_MM;
    open_scene(&scene, &settings);
    send(&scene, "$J=G91 X20 F600\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), 7.0 * WB_MM, 1e-12);
    assert_non_null(strstr(send(&scene, "?"), "-42.000")); /* it reports 20 mm */
    send(&scene, "$J=G91 X-20 F600\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), 7.0 * WB_MM, 1e-12);
    send(&scene, "$H\n");
    wait(&scene, 60.0);
    send(&scene, "$J=G91 X5 F600\n");
    wait(&scene, 10.0);
    assert_close(travel(&scene), 5.0 * WB_MM, 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        SCENE_TEST(settings_and_queries_are_answered),
        SCENE_TEST(a_jog_moves_the_clamp_at_the_feed),
        cmocka_unit_test(down_can_be_the_negative_direction),
        SCENE_TEST(jogs_beyond_the_travel_are_rejected),
        SCENE_TEST(consecutive_jogs_do_not_stop_in_between),
        SCENE_TEST(lines_wait_while_the_planner_is_full),
        SCENE_TEST(a_late_block_is_joined_after_the_steps_already_sent),
        SCENE_TEST(the_next_line_starts_after_a_cancelled_jog),
        cmocka_unit_test(a_clock_that_runs_fast_makes_the_stage_fast),
        SCENE_TEST(opposite_jogs_wait_for_each_other),
        cmocka_unit_test(a_hold_cancels_a_jog_and_ends_idle),
        SCENE_TEST(a_hold_at_rest_blocks_lines_until_resumed),
        SCENE_TEST(a_program_move_holds_and_resumes),
        SCENE_TEST(a_reset_in_motion_alarms_and_locks),
        SCENE_TEST(a_reset_at_rest_only_sends_the_banner),
        SCENE_TEST(a_program_move_beyond_the_travel_alarms_until_reset),
        SCENE_TEST(homing_brings_the_clamp_to_the_start),
        SCENE_TEST(a_reset_while_homing_is_alarm_six),
        cmocka_unit_test(lost_steps_remain_until_homed),
        SCENE_TEST(end_stops_stall_the_motor),
        cmocka_unit_test(random_bytes_are_harmless),
        SCENE_TEST(some_reports_include_the_work_offset),
        SCENE_TEST(a_reset_empties_the_receive_buffer),
        cmocka_unit_test(endless_lines_are_rejected),
        cmocka_unit_test(a_jammed_clamp_stays_until_homed),
        cmocka_unit_test(with_a_time_scale_feeds_are_in_host_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
