/* The Tic's bytes: examples of Pololu's guide, and the results of its driver. */
#include "daq/protocol/tic.h"

#include "base/units.h"
#include "daq/acquire/interlock.h"
#include "daq/acquire/stage_alarm.h"
#include "daq/protocol/drivers.h"
#include "tests/daq/collect.h"
#include "tests/daq/tic_example.h"

#define MS WB_NS_PER_MS

static void long_commands_are_those_of_the_guide(void **state)
{
    (void)state;
    /* -200, as the guide's programs send it, and its example of section 9, 1 234 567 890, with the
     * high bits in the order that its text and its programs give: in the printed example they are
     * the wrong way round (0x0A). */
    static const uint8_t minus[] = {0xE0, 0x0E, 0x38, 0x7F, 0x7F, 0x7F};
    static const uint8_t expected[] = {0xE0, 0x05, 0x52, 0x02, 0x16, 0x49};
    static const int32_t values[] = {0, 1, -1, 127, 128, -128, 1234567890, INT32_MAX, INT32_MIN};
    uint8_t bytes[WB_TIC_LONG_BYTES];
    wb_tic_encode_long(bytes, WB_TIC_SET_TARGET_POSITION, 1234567890);
    assert_memory_equal(bytes, expected, sizeof expected);
    wb_tic_encode_long(bytes, WB_TIC_SET_TARGET_POSITION, -200);
    assert_memory_equal(bytes, minus, sizeof minus);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        wb_tic_encode_long(bytes, WB_TIC_SET_TARGET_POSITION, values[i]);
        for (size_t k = 1; k < sizeof bytes; k++)
            assert_true(bytes[k] < 0x80);
        assert_int_equal(wb_tic_decode_long(bytes + 1), values[i]);
    }
}

/* The requests cover the decoded bytes in order, with at most 15 bytes each. */
static void requests_have_the_length_that_is_decoded(void **state)
{
    (void)state;
    uint8_t bytes[WB_TIC_ASK_BYTES];
    for (int kind = 0; kind < 2; kind++) {
        const size_t n = kind ? wb_tic_ask_settings(bytes) : wb_tic_ask_status(bytes);
        size_t sum = 0;
        assert_int_equal(n % 3, 0);
        for (size_t i = 0; i < n; i += 3) {
            assert_int_equal(bytes[i], kind ? 0xA8 : 0xA1);
            assert_true(bytes[i + 1] < 0x80 && bytes[i + 2] >= 1 && bytes[i + 2] <= 15);
            sum += bytes[i + 2];
        }
        assert_int_equal(sum, kind ? WB_TIC_SETTINGS_BYTES : WB_TIC_STATUS_BYTES);
    }
    /* The command timeout is setting 0x09, two bytes. */
    assert_int_equal(bytes[3], 0xA8);
    assert_int_equal(bytes[4], 0x09);
    assert_int_equal(bytes[5], 2);
}

static void replies_are_little_endian(void **state)
{
    (void)state;
    static const uint8_t bytes[WB_TIC_STATUS_BYTES] = {
        10,   0x03, 0x40, 0x00,       /* normal, energized and uncertain, timeout */
        1,    0xD2, 0x02, 0x96, 0x49, /* to 1 234 567 890 */
        0xFF, 0xFF, 0xFF, 0xFF, 0x60, 0x79, 0xFE, 0xFF, /* at -1, -100 000 per 10 000 s */
        0xE8, 0x03, 0x00, 0x00};                        /* for 1000 ms */
    struct wb_tic_status status;
    assert_true(wb_tic_decode_status(bytes, &status));
    assert_int_equal(status.operation, WB_TIC_NORMAL);
    assert_int_equal(status.flags, WB_TIC_ENERGIZED | WB_TIC_POSITION_UNCERTAIN);
    assert_int_equal(status.errors, WB_TIC_ERROR_COMMAND_TIMEOUT);
    assert_int_equal(status.planning, WB_TIC_TARGET_POSITION);
    assert_int_equal(status.target, 1234567890);
    assert_int_equal(status.position, -1);
    assert_int_equal(status.velocity, -100000);
    assert_int_equal(status.up_time_ms, 1000);
    for (int i = 0; i < 3; i++) {
        static const size_t places[] = {0, 3, 4};
        static const uint8_t wrong[] = {3, 2, 3};
        uint8_t damaged[WB_TIC_STATUS_BYTES];
        memcpy(damaged, bytes, sizeof bytes);
        damaged[places[i]] = wrong[i];
        assert_false(wb_tic_decode_status(damaged, &status));
    }
}

static struct wb_rig rig_of(void)
{
    return (struct wb_rig){
        .gravity = 9.81, .time_scale = 1.0, .stage = {.down = 1, .steps = 1e6, .speed = 1e-3}};
}

static void feed(void *driver, int64_t t_ns, const uint8_t *bytes, size_t n,
                 struct collect *collect)
{
    const struct wb_sink sink = collect_sink(collect);
    wb_stage_tic.receive(driver, t_ns, bytes, n, &sink);
}

/* Opens a driver that has received these settings. */
static void *open_told(const struct wb_tic_settings *settings, struct collect *collect)
{
    uint8_t bytes[WB_TIC_SETTINGS_BYTES];
    const struct wb_rig rig = rig_of();
    void *const driver = collect_open(&wb_stage_tic, &rig);
    tic_example_settings(bytes, settings);
    feed(driver, 100 * MS, bytes, sizeof bytes, collect);
    return driver;
}

static void status_becomes_a_report(void **state)
{
    (void)state;
    static const struct {
        struct wb_tic_status status;
        enum wb_stage_state state;
        int alarm;
    } cases[] = {
        {{.operation = 10, .position = 5}, WB_STAGE_IDLE, 0},
        {{.operation = 10, .planning = 1, .target = 5, .position = 5}, WB_STAGE_IDLE, 0},
        {{.operation = 10, .planning = 1, .target = 9, .position = 5}, WB_STAGE_JOG, 0},
        {{.operation = 10, .planning = 2, .velocity = -1, .position = 5}, WB_STAGE_JOG, 0},
        {{.operation = 4, .errors = 0xC0, .planning = 1, .target = 9, .position = 5},
         WB_STAGE_IDLE,
         0},
        {{.operation = 2, .errors = 0x81, .position = 5}, WB_STAGE_IDLE, 0},
        {{.operation = 10, .flags = WB_TIC_HOMING, .position = 5}, WB_STAGE_HOME, 0},
        {{.operation = 4, .errors = 0x88, .position = 5}, WB_STAGE_ALARM, 103},
        {{.operation = 4, .errors = 0x88, .velocity = 2, .position = 5}, WB_STAGE_JOG, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct collect collect = {0};
        uint8_t bytes[WB_TIC_STATUS_BYTES];
        void *const driver = open_told(&tic_example_usual, &collect);
        assert_false(wb_stage_tic.ready(driver));
        tic_example_status(bytes, &cases[i].status);
        feed(driver, 200 * MS, bytes, sizeof bytes, &collect);
        assert_true(wb_stage_tic.ready(driver));
        assert_int_equal(collect.n_stage, 1);
        if (collect.stage[0].state != cases[i].state)
            fail_msg("case %zu: state %d", i, (int)collect.stage[0].state);
        assert_close(collect.stage[0].position, 5e-6, 1e-18);
        assert_int_equal(collect.stage[0].alarm, cases[i].alarm);
        assert_int_equal(collect_count(&collect, "alarm"),
                         wb_tic_alarm(cases[i].status.errors) != 0);
        free(driver);
    }
}

static void alarm_is_described_in_words(void **state)
{
    (void)state;
    char text[128];
    const struct wb_stage_report report = {.state = WB_STAGE_ALARM, .alarm = WB_TIC_ALARM + 2};
    struct wb_interlock interlock;
    const struct wb_interlock_settings settings = {.down = 1};
    wb_stage_alarm_reason(&report, text, sizeof text);
    assert_non_null(strstr(text, "low VIN"));
    wb_interlock_init(&interlock, &settings, 0);
    interlock.armed = true;
    assert_true(wb_interlock_stage(&interlock, &report));
    assert_int_equal(interlock.reason, WB_INTERLOCK_ALARM);
    assert_non_null(strstr(interlock.text, "low VIN"));
}

static void settings_become_limits_in_si(void **state)
{
    (void)state;
    struct collect collect = {0};
    struct wb_tic_settings settings = tic_example_usual;
    settings.max_speed = 100000000;      /* 10 000 steps/s */
    settings.max_acceleration = 4000000; /* 40 000 steps/s2 */
    settings.max_deceleration = 2000000;
    free(open_told(&settings, &collect));
    assert_int_equal(collect.n_settings, 1);
    assert_close_relative(collect.settings.speed, 10e-3, 1e-12);
    assert_close_relative(collect.settings.acceleration, 20e-3, 1e-12);
    assert_true(isnan(collect.settings.travel) && isnan(collect.settings.steps));
    assert_string_equal(collect.settings.fault, "");
    assert_non_null(strstr(collect.settings.text, "command_timeout_ms=1000\n"));
    /* 1 s of 1 mm/s, and braking from it. */
    assert_non_null(strstr(collect_text(&collect, "settings"), " 1.025 mm"));
}

static void tic_without_command_timeout_is_rejected(void **state)
{
    (void)state;
    static const struct {
        int timeout_ms, control_mode, response;
        const char *fault;
    } cases[] = {
        {1000, 0, WB_TIC_BRAKE, ""},
        {100, 0, WB_TIC_HALT, ""},
        {2000, 0, WB_TIC_BRAKE, ""},
        {0, 0, WB_TIC_BRAKE, "setting 0x09 is 0"},
        {99, 0, WB_TIC_BRAKE, "(setting 0x09) is 99 ms: set it to 100 to 2000 ms"},
        {2001, 0, WB_TIC_BRAKE, "is 2001 ms: set it"},
        {1000, 2, WB_TIC_BRAKE, "control mode is 2"},
        {1000, 0, WB_TIC_GO_TO_POSITION, "Decelerate to hold"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct collect collect = {0};
        struct wb_tic_settings settings = tic_example_usual;
        settings.command_timeout_ms = (uint16_t)cases[i].timeout_ms;
        settings.control_mode = (uint8_t)cases[i].control_mode;
        settings.soft_error_response = (uint8_t)cases[i].response;
        free(open_told(&settings, &collect));
        assert_int_equal(collect.n_settings, 1);
        const char *const fault = collect.settings.fault;
        if ((fault[0] == '\0') != (cases[i].fault[0] == '\0') || !strstr(fault, cases[i].fault))
            fail_msg("case %zu: '%s'", i, fault);
    }
}

/* Lost or additional bytes invalidate one reply. */
static void incomplete_reply_is_dropped_after_a_pause(void **state)
{
    (void)state;
    struct collect collect = {0};
    uint8_t bytes[WB_TIC_STATUS_BYTES], noise[WB_TIC_STATUS_BYTES];
    const struct wb_tic_status status = {.operation = 10, .position = 7};
    void *const driver = open_told(&tic_example_usual, &collect);
    tic_example_status(bytes, &status);
    memset(noise, 0xFF, sizeof noise);
    feed(driver, 300 * MS, bytes, 13, &collect);
    feed(driver, 500 * MS, bytes, 10, &collect);
    feed(driver, 520 * MS, bytes + 10, sizeof bytes - 10, &collect);
    assert_int_equal(collect.n_stage, 1);
    assert_close(collect.stage[0].position, 7e-6, 1e-18);
    assert_int_equal(collect.stage[0].t_ns, 520 * MS);
    feed(driver, 700 * MS, noise, sizeof noise, &collect);
    feed(driver, 710 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect.n_stage, 1);
    assert_int_equal(collect_count(&collect, "refused"), 1);
    feed(driver, 900 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect.n_stage, 2);
    free(driver);
}

/* An empty chunk marks missing bytes: halves of two replies are not joined. */
static void reply_with_missing_bytes_is_dropped(void **state)
{
    (void)state;
    struct collect collect = {0};
    uint8_t bytes[WB_TIC_STATUS_BYTES];
    const struct wb_tic_status status = {.operation = 10, .position = 7};
    void *const driver = open_told(&tic_example_usual, &collect);
    tic_example_status(bytes, &status);
    feed(driver, 300 * MS, bytes, 13, &collect);
    feed(driver, 310 * MS, NULL, 0, &collect);
    feed(driver, 320 * MS, bytes + 13, sizeof bytes - 13, &collect);
    feed(driver, 330 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect.n_stage, 0);
    feed(driver, 500 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect.n_stage, 1);
    free(driver);
}

static void reset_and_a_timeout_are_noticed(void **state)
{
    (void)state;
    struct collect collect = {0};
    uint8_t bytes[WB_TIC_STATUS_BYTES];
    struct wb_tic_status status = {.operation = 10, .velocity = 100, .up_time_ms = 5000};
    void *const driver = open_told(&tic_example_usual, &collect);
    tic_example_status(bytes, &status);
    feed(driver, 300 * MS, bytes, sizeof bytes, &collect);
    status.errors = WB_TIC_ERROR_COMMAND_TIMEOUT | WB_TIC_ERROR_SAFE_START;
    status.operation = WB_TIC_SOFT_ERROR;
    tic_example_status(bytes, &status);
    feed(driver, 500 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect_count(&collect, "timeout"), 1);
    assert_false(collect.stage[1].was_reset);
    status.up_time_ms = 20;
    tic_example_status(bytes, &status);
    feed(driver, 700 * MS, bytes, sizeof bytes, &collect);
    assert_int_equal(collect_count(&collect, "reset"), 1);
    assert_true(collect.stage[2].was_reset);
    free(driver);
}

/* Several times within the command timeout, however short, or the stage would stop. */
static void timeout_resets_are_sent_several_times_within_the_timeout(void **state)
{
    (void)state;
    static const int timeouts_ms[] = {100, 300, 1000, 2000};
    for (size_t i = 0; i < sizeof timeouts_ms / sizeof timeouts_ms[0]; i++) {
        struct collect collect = {0};
        struct wb_outbox outbox;
        struct wb_tic_settings settings = tic_example_usual;
        settings.command_timeout_ms = (uint16_t)timeouts_ms[i];
        void *const driver = open_told(&settings, &collect);
        int64_t last = 1000, longest = 0;
        for (int64_t t = 1000; t < 6000; t += 20) {
            wb_outbox_clear(&outbox);
            wb_stage_tic.tick(driver, t * MS, &outbox);
            for (size_t k = 0; k < outbox.n_entries; k++) {
                size_t n;
                if (collect_entry(&outbox, k, &n)[0] != WB_TIC_RESET_COMMAND_TIMEOUT)
                    continue;
                longest = t - last > longest ? t - last : longest;
                last = t;
            }
        }
        if (longest <= 0 || 2 * longest > timeouts_ms[i])
            fail_msg("timeout %d ms: %d ms without a sign of life", timeouts_ms[i], (int)longest);
        free(driver);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_commands_are_those_of_the_guide),
        cmocka_unit_test(requests_have_the_length_that_is_decoded),
        cmocka_unit_test(replies_are_little_endian),
        cmocka_unit_test(status_becomes_a_report),
        cmocka_unit_test(alarm_is_described_in_words),
        cmocka_unit_test(settings_become_limits_in_si),
        cmocka_unit_test(tic_without_command_timeout_is_rejected),
        cmocka_unit_test(incomplete_reply_is_dropped_after_a_pause),
        cmocka_unit_test(reply_with_missing_bytes_is_dropped),
        cmocka_unit_test(reset_and_a_timeout_are_noticed),
        cmocka_unit_test(timeout_resets_are_sent_several_times_within_the_timeout),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
