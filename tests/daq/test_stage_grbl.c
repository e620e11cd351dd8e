#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "tests/check.h"
#include "tests/daq/collect.h"

#define MS WB_NS_PER_MS

static struct collect collect;
static struct wb_outbox outbox;

static void *open_stage(char axis, int down)
{
    struct wb_rig rig = {.time_scale = 1.0};
    rig.stage.axis = axis;
    rig.stage.down = down;
    memset(&collect, 0, sizeof collect);
    wb_outbox_clear(&outbox);
    return collect_open(&wb_stage_grbl, &rig);
}

static void feed(void *driver, int64_t t_ns, const char *text)
{
    const struct wb_sink sink = collect_sink(&collect);
    wb_stage_grbl.receive(driver, t_ns, (const uint8_t *)text, strlen(text), &sink);
}

static enum wb_status command(void *driver, enum wb_stage_command what)
{
    return wb_stage_grbl.command(driver, what, 0.002, 0.001, &outbox); /* 2 mm at 1 mm/s */
}

/* First bytes of a stage: an idle report, and its settings. */
static void introduce(void *driver)
{
    feed(driver, 0, "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
    wb_stage_grbl.tick(driver, 0, &outbox);
    feed(driver, 0,
         "$110=600.000\r\n$111=600.000\r\n$112=600.000\r\n$120=50.000\r\n$121=50.000\r\n"
         "$122=50.000\r\nok\r\n");
    memset(&collect, 0, sizeof collect);
    wb_outbox_clear(&outbox);
}

static void assert_sent(const char *expected)
{
    assert_int_equal(outbox.n_bytes, strlen(expected));
    assert_memory_equal(outbox.bytes, expected, outbox.n_bytes);
    wb_outbox_clear(&outbox);
}

static void ignore_messages(void *context, enum wb_log_level level, const char *domain,
                            const char *message)
{
    (void)level;
    (void)domain;
    (void)message;
    ++*(int *)context;
}

static void settings_are_requested_once_and_delivered(void **state)
{
    (void)state;
    void *const driver = open_stage('Y', -1);
    wb_stage_grbl.start(driver, 0, &outbox);
    assert_sent("?");
    /* On hold, lines are not executed: a request would wait indefinitely. */
    feed(driver, 1, "<Hold:0|MPos:1.000,2.000,3.000|FS:0,0>\r\n");
    wb_stage_grbl.tick(driver, 20 * MS, &outbox);
    assert_int_equal(outbox.n_entries, 0);
    assert_true(wb_stage_grbl.ready(driver));
    feed(driver, 1, "<Idle|MPos:1.000,2.000,3.000|FS:0,0>\r\n");
    assert_false(wb_stage_grbl.ready(driver));
    wb_stage_grbl.tick(driver, 40 * MS, &outbox);
    assert_sent("$$\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    /* A report may come in between. */
    feed(driver, 2,
         "$1=25\r\n$13=1\r\n$20=1\r\n$100=250.000\r\n$101=800.000\r\n$110=500.000\r\n"
         "$111=600.000\r\n<Idle|MPos:1.000,2.000,3.000|FS:0,0>\r\n$121=50.000\r\n"
         "$131=64.000\r\n");
    assert_int_equal(collect.n_settings, 0);
    feed(driver, 3, "ok\r\n");
    assert_int_equal(collect.n_settings, 1);
    const struct wb_stage_settings *const settings = &collect.settings;
    assert_close(settings->steps, 800e3, 1e-6);
    assert_close(settings->speed, 10e-3, 1e-15);
    assert_close(settings->acceleration, 50e-3, 1e-15);
    assert_close(settings->travel, 64e-3, 1e-15);
    assert_true(settings->inches && settings->soft_limits && settings->powers_off);
    assert_int_equal(strncmp(settings->text, "$1=25\n$13=1\n$20=1\n", 18), 0);
    assert_non_null(strstr(settings->text, "\n$131=64.000\n"));
    assert_true(wb_stage_grbl.ready(driver));
    assert_int_equal(collect_count(&collect, "settings"), 2);
    wb_stage_grbl.tick(driver, 60 * MS, &outbox);
    assert_int_equal(outbox.n_entries, 0);
    free(driver);
}

static void stage_without_reported_settings_is_accepted_with_a_remark(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    feed(driver, 1, "<Idle|MPos:1.000,2.000,3.000|FS:0,0>\r\n");
    wb_stage_grbl.tick(driver, 20 * MS, &outbox);
    feed(driver, 2, "error:3\r\n");
    assert_non_null(strstr(collect_text(&collect, "settings"), "does not report its settings"));
    assert_int_equal(collect_count(&collect, "error"), 0);
    assert_int_equal(collect.n_settings, 0);
    assert_true(wb_stage_grbl.ready(driver));
    free(driver);
}

static void reports_become_samples_of_the_tests_axis(void **state)
{
    (void)state;
    void *const driver = open_stage('Y', -1);
    assert_false(wb_stage_grbl.ready(driver));
    feed(driver, 5 * MS, "<Jog|MPos:1.000,-25.");
    assert_int_equal(collect.n_stage, 0);
    feed(driver, 6 * MS, "500,3.000|FS:60,0>\r\n");
    assert_int_equal(collect.n_stage, 1);
    assert_int_equal(collect.stage[0].t_ns, 6 * MS);
    assert_int_equal(collect.stage[0].state, WB_STAGE_JOG);
    assert_close(collect.stage[0].position, -0.0255, 1e-15); /* machine position, sign as sent */
    assert_int_equal(collect.stage[0].alarm, 0);
    assert_true(wb_stage_grbl.ready(driver));
    free(driver);
}

static void downward_jogs_follow_the_rigs_axis_and_sign(void **state)
{
    (void)state;
    void *driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    /* The first of many short ones: 10 ms to brake and 150 ms. */
    assert_sent("$J=G91 G21 X0.160 F60.000\n");
    free(driver);
    driver = open_stage('Z', -1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    assert_sent("$J=G91 G21 Z-0.160 F60.000\n");
    free(driver);
}

static void only_one_line_awaits_its_reply(void **state)
{
    (void)state;
    int n_messages = 0;
    wb_log_set_sink(ignore_messages, &n_messages);
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_HOME), WB_ERR_BUSY);
    wb_outbox_clear(&outbox);
    /* Reports and messages are no replies. */
    feed(driver, 10 * MS, "<Idle|MPos:0.000,0.000,0.000|FS:60,0>\r\n[MSG:hello]\r\n");
    wb_stage_grbl.tick(driver, 20 * MS, &outbox);
    assert_int_equal(outbox.n_entries, 0);
    feed(driver, 30 * MS, "ok\r\n<Jog|MPos:0.000,0.000,0.000|FS:60,0>\r\n");
    wb_stage_grbl.tick(driver, 110 * MS, &outbox);
    /* 0.08 mm of 0.16 are done, as predicted. */
    assert_sent("$J=G91 G21 X0.080 F60.000\n");
    assert_int_equal(n_messages, 0);
    wb_log_set_sink(NULL, NULL);
    free(driver);
}

/* An error ends the jog: blocks in the firmware are cancelled until the stage is idle. */
static void rejected_jog_is_cancelled_until_the_stage_stands(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    wb_outbox_clear(&outbox);
    feed(driver, 10 * MS, "<Jog|MPos:0.010,0.000,0.000|FS:60,0>\r\nerror:15\r\n");
    assert_int_equal(collect_count(&collect, "error"), 1);
    assert_non_null(strstr(collect_text(&collect, "error"), "$J=G91"));
    wb_stage_grbl.tick(driver, 20 * MS, &outbox);
    assert_sent("?\x85");
    feed(driver, 30 * MS, "<Idle|MPos:0.020,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    /* A line that was being transferred has started after the first cancel. */
    feed(driver, 40 * MS, "<Jog|MPos:0.020,0.000,0.000|FS:60,0>\r\n");
    wb_stage_grbl.tick(driver, 120 * MS, &outbox);
    assert_sent("?\x85");
    feed(driver, 130 * MS, "<Idle|MPos:0.030,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    feed(driver, 230 * MS, "<Idle|MPos:0.030,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    free(driver);
}

/* Without reports nothing more is sent, and the stage stops by itself. */
static void stage_without_reports_receives_no_commands(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    int lines = 0;
    for (int64_t t = 20; t < 3000; t += 20) {
        feed(driver, t * MS, "ok\r\n");
        wb_outbox_clear(&outbox);
        wb_stage_grbl.tick(driver, t * MS, &outbox);
        for (size_t i = 0; i < outbox.n_bytes; i++)
            lines += outbox.bytes[i] == '\n';
    }
    /* 0.4 s of 20 ms each. */
    if (!(lines >= 8 && lines <= 20))
        fail_msg("%d lines", lines);
    free(driver);
}

static void real_time_bytes_are_always_accepted(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    wb_outbox_clear(&outbox);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_HOLD), WB_OK);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG_CANCEL), WB_OK);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_STATUS), WB_OK);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_RESUME), WB_OK);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_SOFT_RESET), WB_OK);
    assert_int_equal(outbox.n_entries, 5);
    assert_sent("!\x85?~\x18");
    /* After the reset the jog will not be answered. */
    assert_int_equal(command(driver, WB_STAGE_COMMAND_UNLOCK), WB_OK);
    assert_sent("$X\n");
    free(driver);
}

static void status_is_polled_at_5_hz_and_at_10_hz_after_a_hold(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    wb_stage_grbl.start(driver, 0, &outbox);
    assert_sent("?");
    int n = 0;
    for (int64_t t = 0; t <= 1000; t += 20) {
        wb_stage_grbl.tick(driver, t * MS, &outbox);
        n += (int)outbox.n_entries;
        wb_outbox_clear(&outbox);
    }
    assert_int_equal(n, 5);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_HOLD), WB_OK);
    wb_outbox_clear(&outbox);
    n = 0;
    for (int64_t t = 1000; t < 2000; t += 20) {
        wb_stage_grbl.tick(driver, t * MS, &outbox);
        n += (int)outbox.n_entries;
        wb_outbox_clear(&outbox);
    }
    assert_int_equal(n, 10);
    free(driver);
}

static void alarms_become_samples_at_once(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    feed(driver, 1, "ok\r\n<Jog|MPos:1.000,0.000,0.000|FS:60,0>\r\nALARM:1\r\n");
    assert_int_equal(collect.n_stage, 2);
    assert_int_equal(collect.stage[1].state, WB_STAGE_ALARM);
    assert_int_equal(collect.stage[1].alarm, 1);
    assert_true(isnan(collect.stage[1].position));
    assert_non_null(strstr(collect_text(&collect, "alarm"), "position is lost"));
    /* The alarm number is kept until the state changes. */
    feed(driver, 2, "<Alarm|MPos:1.000,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(collect.stage[2].alarm, 1);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_HOME), WB_OK);
    feed(driver, 3, "ok\r\n<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(collect.stage[3].alarm, 0);
    assert_int_equal(collect_count(&collect, "homed"), 1);
    free(driver);
}

static void reset_during_motion_is_handled(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    feed(driver, 1, "<Jog|MPos:1.000,0.000,0.000|FS:60,0>\r\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_SOFT_RESET), WB_OK);
    feed(driver, 2,
         "ALARM:3\r\n\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n"
         "<Alarm|MPos:1.000,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(collect.stage[1].alarm, 3);
    assert_int_equal(collect.stage[2].state, WB_STAGE_ALARM);
    assert_int_equal(collect_count(&collect, "alarm"), 1);
    assert_int_equal(collect_count(&collect, "message"), 1);
    assert_int_equal(collect_count(&collect, "refused"), 0);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_UNLOCK), WB_OK);
    free(driver);
}

static void unexpected_banner_is_a_reset(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    feed(driver, 1, "\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_int_equal(collect_count(&collect, "firmware"), 1);
    introduce(driver);
    feed(driver, 2, "<Idle|MPos:1.000,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    feed(driver, 3, "\r\nGrbl 1.1h ['$' for help]\r\n");
    assert_int_equal(collect_count(&collect, "reset"), 1);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    free(driver);
}

static void lost_reply_does_not_block_the_stage(void **state)
{
    (void)state;
    int n_messages = 0;
    wb_log_set_sink(ignore_messages, &n_messages);
    void *const driver = open_stage('X', 1);
    introduce(driver);
    wb_stage_grbl.start(driver, 0, &outbox);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_OK);
    wb_stage_grbl.tick(driver, 1900 * MS, &outbox);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    wb_stage_grbl.tick(driver, 2100 * MS, &outbox);
    assert_int_equal(n_messages, 1);
    assert_int_equal(command(driver, WB_STAGE_COMMAND_HOME), WB_OK);
    wb_stage_grbl.tick(driver, 60000 * MS, &outbox); /* homing takes its time */
    assert_int_equal(command(driver, WB_STAGE_COMMAND_JOG), WB_ERR_BUSY);
    wb_log_set_sink(NULL, NULL);
    free(driver);
}

static void impossible_jogs_are_rejected(void **state)
{
    (void)state;
    int n_messages = 0;
    wb_log_set_sink(ignore_messages, &n_messages);
    void *const driver = open_stage('X', 1);
    introduce(driver);
    assert_int_equal(wb_stage_grbl.command(driver, WB_STAGE_COMMAND_JOG, 1e-7, 1e-3, &outbox),
                     WB_ERR_ARGUMENT);
    assert_int_equal(wb_stage_grbl.command(driver, WB_STAGE_COMMAND_JOG, 1e-3, 0.0, &outbox),
                     WB_ERR_ARGUMENT);
    assert_int_equal(n_messages, 2);
    assert_int_equal(outbox.n_entries, 0);
    wb_log_set_sink(NULL, NULL);
    free(driver);
}

static void noise_on_the_line_causes_a_remark_only(void **state)
{
    (void)state;
    char noise[1000];
    memset(noise, 'x', sizeof noise - 1);
    noise[sizeof noise - 1] = '\0';
    void *const driver = open_stage('X', 1);
    feed(driver, 0, noise);
    feed(driver, 0, "\nhuh?\n<Idle|MPos:\xff>\n<Idle|MPos:1.000,0.000,0.000|FS:0,0>\r\n");
    assert_int_equal(collect_count(&collect, "refused"), 3);
    assert_int_equal(collect.n_stage, 1);
    free(driver);
}

static void pressed_switch_is_reported_once(void **state)
{
    (void)state;
    void *const driver = open_stage('X', 1);
    feed(driver, 0,
         "<Idle|MPos:0.000,0.000,0.000|Pn:Y>\n<Idle|MPos:0.000,0.000,0.000|Pn:X>\n"
         "<Idle|MPos:0.000,0.000,0.000|Pn:XY>\n");
    assert_int_equal(collect_count(&collect, "switch"), 1);
    free(driver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_are_requested_once_and_delivered),
        cmocka_unit_test(stage_without_reported_settings_is_accepted_with_a_remark),
        cmocka_unit_test(reports_become_samples_of_the_tests_axis),
        cmocka_unit_test(downward_jogs_follow_the_rigs_axis_and_sign),
        cmocka_unit_test(only_one_line_awaits_its_reply),
        cmocka_unit_test(rejected_jog_is_cancelled_until_the_stage_stands),
        cmocka_unit_test(stage_without_reports_receives_no_commands),
        cmocka_unit_test(real_time_bytes_are_always_accepted),
        cmocka_unit_test(status_is_polled_at_5_hz_and_at_10_hz_after_a_hold),
        cmocka_unit_test(alarms_become_samples_at_once),
        cmocka_unit_test(reset_during_motion_is_handled),
        cmocka_unit_test(unexpected_banner_is_a_reset),
        cmocka_unit_test(lost_reply_does_not_block_the_stage),
        cmocka_unit_test(impossible_jogs_are_rejected),
        cmocka_unit_test(noise_on_the_line_causes_a_remark_only),
        cmocka_unit_test(pressed_switch_is_reported_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
