/* The Tic driver on the simulated Tic, in simulated time: bytes take some time in each direction,
 * and the program runs every 20 ms while it is alive. */
#include <stdlib.h>

#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "fixtures/virtual/sim_tic.h"
#include "tests/messages.h"

#define MS WB_NS_PER_MS
#define LINK_NS (25 * MS) /* an answer at 9600 baud */
#define TICK_NS (20 * MS)

/* Bytes in transit in one direction: in order, limited in number. */
struct wire {
    struct {
        int64_t due_ns;
        size_t n;
        uint8_t bytes[512];
    } parcels[64];
    int first, n;
};

struct drive {
    struct wb_sim_tic tic;
    struct wb_rig rig;
    void *driver;
    struct wb_outbox outbox;
    struct wire down, up;
    int64_t now_ns, next_tick_ns, stalled_until;
    bool is_dead;
    struct wb_stage_report last;
    struct wb_stage_settings settings;
    int reports, timeouts, homings, warnings;
};

static void put(struct wire *wire, int64_t due_ns, const void *bytes, size_t n)
{
    assert_true(wire->n < 64 && n <= sizeof wire->parcels[0].bytes);
    const int at = (wire->first + wire->n++) % 64;
    wire->parcels[at].due_ns = due_ns;
    wire->parcels[at].n = n;
    memcpy(wire->parcels[at].bytes, bytes, n);
}

static const uint8_t *take(struct wire *wire, int64_t now_ns, size_t *n)
{
    if (wire->n == 0 || wire->parcels[wire->first].due_ns > now_ns)
        return NULL;
    const uint8_t *const bytes = wire->parcels[wire->first].bytes;
    *n = wire->parcels[wire->first].n;
    wire->first = (wire->first + 1) % 64;
    wire->n--;
    return bytes;
}

static void keep_report(void *context, const struct wb_stage_report *report)
{
    struct drive *const drive = context;
    drive->last = *report;
    drive->reports++;
}

static void keep_settings(void *context, const struct wb_stage_settings *settings)
{
    ((struct drive *)context)->settings = *settings;
}

static void keep_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    struct drive *const drive = context;
    (void)t_ns;
    (void)text;
    drive->timeouts += strcmp(kind, "timeout") == 0;
    drive->homings += strcmp(kind, "homed") == 0;
    drive->warnings += level <= WB_LOG_WARNING;
}

static void send(struct drive *drive)
{
    if (drive->outbox.n_bytes > 0)
        put(&drive->down, drive->now_ns + LINK_NS, drive->outbox.bytes, drive->outbox.n_bytes);
    wb_outbox_clear(&drive->outbox);
}

static double seconds(const struct drive *drive)
{
    return wb_seconds_from_ns(drive->now_ns);
}

static double travel(struct drive *drive)
{
    return wb_sim_tic_travel(&drive->tic, seconds(drive));
}

static void step(struct drive *drive)
{
    const struct wb_sink sink = {
        .context = drive, .stage = keep_report, .settings = keep_settings, .remark = keep_remark};
    const uint8_t *bytes;
    uint8_t said[512];
    size_t n;
    drive->now_ns += MS;
    wb_sim_tic_advance(&drive->tic, seconds(drive));
    while ((bytes = take(&drive->down, drive->now_ns, &n)))
        wb_sim_tic_receive(&drive->tic, seconds(drive), bytes, n);
    n = wb_reply_take(&drive->tic.out, said, sizeof said);
    if (n > 0)
        put(&drive->up, drive->now_ns + LINK_NS, said, n);
    if (drive->is_dead || drive->now_ns < drive->stalled_until)
        return;
    while ((bytes = take(&drive->up, drive->now_ns, &n)))
        wb_stage_tic.receive(drive->driver, drive->now_ns, bytes, n, &sink);
    if (drive->now_ns < drive->next_tick_ns)
        return;
    drive->next_tick_ns = drive->now_ns + TICK_NS;
    wb_stage_tic.tick(drive->driver, drive->now_ns, &drive->outbox);
    send(drive);
}

static void live(struct drive *drive, double duration)
{
    const int64_t end_ns = drive->now_ns + wb_ns_from_seconds(duration);
    while (drive->now_ns < end_ns)
        step(drive);
}

/* Sends a command repeatedly until it is accepted, as wb_sequence does; returns the time taken. */
static double command(struct drive *drive, enum wb_stage_command command_kind, double distance,
                      double speed)
{
    const double began = seconds(drive);
    for (;;) {
        const enum wb_status status =
            wb_stage_tic.command(drive->driver, command_kind, distance, speed, &drive->outbox);
        if (status == WB_OK)
            break;
        assert_int_equal(status, WB_ERR_BUSY);
        assert_true(seconds(drive) - began < 4.0);
        step(drive);
    }
    send(drive);
    return seconds(drive) - began;
}

/* Runs until the stage is reported idle twice; at most `most` seconds. */
static void arrive(struct drive *drive, double most)
{
    const double end = seconds(drive) + most;
    live(drive, 0.5);
    while (drive->last.state != WB_STAGE_IDLE && seconds(drive) < end)
        step(drive);
    assert_int_equal(drive->last.state, WB_STAGE_IDLE);
}

static void switch_on(struct drive *drive, int down)
{
    memset(drive, 0, sizeof *drive);
    drive->rig = (struct wb_rig){.time_scale = 1.0,
                                 .stage = {.down = down, .steps = 3200e3, .speed = 1.0 * WB_MM}};
    const struct wb_sim_stage_settings settings = {
        .down = down, .steps = 3200e3, .clamp.travel = 60.0 * WB_MM};
    wb_sim_tic_init(&drive->tic, &settings);
    drive->driver = calloc(1, wb_stage_tic.state_size);
    assert_non_null(drive->driver);
    assert_int_equal(wb_stage_tic.init(drive->driver, &drive->rig), WB_OK);
}

static void begin(struct drive *drive, int down)
{
    switch_on(drive, down);
    wb_stage_tic.start(drive->driver, 0, &drive->outbox);
    send(drive);
    live(drive, 1.0);
    assert_true(wb_stage_tic.ready(drive->driver));
    assert_int_equal(drive->last.state, WB_STAGE_IDLE);
}

static void a_jog_reaches_its_target(void **state)
{
    (void)state;
    for (int down = -1; down <= 1; down += 2) {
        struct drive drive;
        begin(&drive, down);
        const double from = drive.last.position;
        assert_true(command(&drive, WB_STAGE_COMMAND_JOG, 3.0 * WB_MM, 2.0 * WB_MM) < 1.0);
        live(&drive, 0.8);
        assert_int_equal(drive.last.state, WB_STAGE_JOG);
        assert_close(drive.tic.motion.speed[1], 2.0 * WB_MM, 1e-9);
        arrive(&drive, 3.0);
        assert_close(travel(&drive), 3.0 * WB_MM, 1e-9);
        assert_close((drive.last.position - from) * down, 3.0 * WB_MM, 1e-9);
        command(&drive, WB_STAGE_COMMAND_JOG, -1.0 * WB_MM, 2.0 * WB_MM);
        arrive(&drive, 3.0);
        assert_close(travel(&drive), 2.0 * WB_MM, 1e-9);
        free(drive.driver);
    }
}

/* Nothing moves before a jog, regardless of the target left by an earlier program. */
static void an_old_target_is_ignored(void **state)
{
    (void)state;
    struct drive drive;
    uint8_t bytes[WB_TIC_LONG_BYTES];
    switch_on(&drive, 1);
    wb_tic_encode_long(bytes, WB_TIC_SET_TARGET_POSITION, 100000);
    wb_sim_tic_receive(&drive.tic, 0.0, bytes, sizeof bytes);
    wb_stage_tic.start(drive.driver, 0, &drive.outbox);
    send(&drive);
    live(&drive, 1.0);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    assert_int_equal(
        wb_stage_tic.command(drive.driver, WB_STAGE_COMMAND_JOG, 1e-3, 1e-3, &drive.outbox),
        WB_ERR_BUSY);
    live(&drive, 2.0);
    assert_int_equal(drive.tic.operation, WB_TIC_NORMAL);
    assert_close(travel(&drive), 0.0, 1e-12);
    free(drive.driver);
}

static void a_hold_brakes_and_keeps_the_position(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1);
    command(&drive, WB_STAGE_COMMAND_JOG, 20.0 * WB_MM, 5.0 * WB_MM);
    live(&drive, 2.0);
    const double here = travel(&drive);
    command(&drive, WB_STAGE_COMMAND_HOLD, 0.0, 0.0);
    live(&drive, 1.0);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    /* Distance during transmission plus the braking distance from 5 mm/s at 50 mm/s2. */
    const double most = 5.0 * WB_MM * wb_seconds_from_ns(LINK_NS + 2 * MS) + 0.25 * WB_MM;
    assert_true(travel(&drive) > here && travel(&drive) <= here + most + 1e-6);
    assert_false(drive.tic.uncertain);
    assert_close(drive.last.position - 2.0 * WB_MM, travel(&drive), 1e-9);
    live(&drive, 3.0);
    assert_close(drive.last.position - 2.0 * WB_MM, travel(&drive), 1e-9);
    free(drive.driver);
}

static void the_emergency_stop_halts_at_once(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1);
    command(&drive, WB_STAGE_COMMAND_JOG, 20.0 * WB_MM, 5.0 * WB_MM);
    live(&drive, 2.0);
    const double here = travel(&drive);
    command(&drive, WB_STAGE_COMMAND_SOFT_RESET, 0.0, 0.0);
    live(&drive, 0.5);
    assert_true(travel(&drive) - here <= 5.0 * WB_MM * wb_seconds_from_ns(LINK_NS + 2 * MS));
    assert_true(drive.tic.uncertain);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    free(drive.driver);
}

/* A dead program cannot act: the Tic stops by its own timeout, within the distance that the driver
 * announced. */
static void a_dead_program_stops_the_stage(void **state)
{
    (void)state;
    static const int timeouts_ms[] = {100, 1000, 2000};
    for (size_t i = 0; i < sizeof timeouts_ms / sizeof timeouts_ms[0]; i++) {
        struct drive drive;
        switch_on(&drive, 1);
        drive.tic.memory.command_timeout_ms = (uint16_t)timeouts_ms[i];
        wb_stage_tic.start(drive.driver, 0, &drive.outbox);
        send(&drive);
        live(&drive, 1.0);
        command(&drive, WB_STAGE_COMMAND_JOG, 50.0 * WB_MM, 5.0 * WB_MM);
        live(&drive, 3.0);
        const double here = travel(&drive);
        assert_true(here > 10.0 * WB_MM);
        drive.is_dead = true;
        const double timeout = 1e-3 * timeouts_ms[i];
        live(&drive, timeout + 0.5);
        const double there = travel(&drive);
        const double most =
            5.0 * WB_MM * (timeout + wb_seconds_from_ns(LINK_NS + MS)) + 0.25 * WB_MM;
        assert_true(there > here && there <= here + most + 1e-6);
        assert_false(drive.tic.moving);
        live(&drive, 5.0);
        assert_close(travel(&drive), there, 0.0);
        free(drive.driver);
    }
}

/* A stalled program finds its stage stopped, and gets a warning; a new jog moves it again. */
static void a_stall_beyond_the_timeout_is_reported(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1);
    command(&drive, WB_STAGE_COMMAND_JOG, 50.0 * WB_MM, 5.0 * WB_MM);
    live(&drive, 2.0);
    drive.stalled_until = drive.now_ns + 2000 * MS;
    live(&drive, 4.0);
    assert_int_equal(drive.timeouts, 1);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    const double here = travel(&drive);
    live(&drive, 2.0);
    assert_close(travel(&drive), here, 0.0);
    command(&drive, WB_STAGE_COMMAND_JOG, 1.0 * WB_MM, 5.0 * WB_MM);
    arrive(&drive, 2.0);
    assert_close(travel(&drive), here + 1.0 * WB_MM, 1e-6);
    free(drive.driver);
}

/* While the program is alive no timeout expires, moving or not. */
static void a_living_program_is_never_timed_out(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1);
    command(&drive, WB_STAGE_COMMAND_JOG, 40.0 * WB_MM, 1.0 * WB_MM);
    arrive(&drive, 60.0);
    assert_close(travel(&drive), 40.0 * WB_MM, 1e-9);
    live(&drive, 10.0);
    assert_int_equal(drive.timeouts, 0);
    assert_int_equal(drive.tic.operation, WB_TIC_NORMAL);
    free(drive.driver);
}

static void homing_goes_to_the_switch(void **state)
{
    (void)state;
    for (int down = -1; down <= 1; down += 2) {
        struct drive drive;
        begin(&drive, down);
        drive.tic.clamp.lost = 0.3 * WB_MM; /* steps that the motor lost before */
        command(&drive, WB_STAGE_COMMAND_HOME, 0.0, 0.0);
        live(&drive, 0.3);
        assert_int_equal(drive.last.state, WB_STAGE_HOME);
        arrive(&drive, 5.0);
        assert_close(travel(&drive), -2.0 * WB_MM, 1e-9);
        assert_close(drive.last.position, 0.0, 1e-9);
        assert_int_equal(drive.homings, 1);
        /* Includes that the switch is pressed and that the position was unknown before. */
        assert_int_equal(drive.warnings, 0);
        free(drive.driver);
    }
}

static void without_a_limit_switch_homing_is_rejected(void **state)
{
    (void)state;
    struct drive drive;
    switch_on(&drive, 1);
    drive.tic.memory.pins[4] = 8; /* forward, but up is reverse */
    wb_stage_tic.start(drive.driver, 0, &drive.outbox);
    send(&drive);
    live(&drive, 1.0);
    keep_messages();
    assert_int_equal(
        wb_stage_tic.command(drive.driver, WB_STAGE_COMMAND_HOME, 0.0, 0.0, &drive.outbox),
        WB_ERR_UNSUPPORTED);
    assert_non_null(strstr(kept.last, "Limit switch reverse"));
    release_messages();
    free(drive.driver);
}

static void a_kill_switch_is_an_alarm_until_it_is_released(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1);
    command(&drive, WB_STAGE_COMMAND_JOG, 30.0 * WB_MM, 5.0 * WB_MM);
    live(&drive, 1.0);
    drive.tic.faults = WB_TIC_ERROR_KILL_SWITCH;
    command(&drive, WB_STAGE_COMMAND_HOLD, 0.0, 0.0);
    live(&drive, 2.0);
    assert_int_equal(drive.last.state, WB_STAGE_ALARM);
    assert_int_equal(drive.last.alarm, WB_TIC_ALARM + 3);
    const double here = travel(&drive);
    drive.tic.faults = 0;
    command(&drive, WB_STAGE_COMMAND_UNLOCK, 0.0, 0.0);
    live(&drive, 2.0);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    assert_int_equal(drive.tic.operation, WB_TIC_NORMAL);
    assert_close(travel(&drive), here, 0.0);
    free(drive.driver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jog_reaches_its_target),
        cmocka_unit_test(an_old_target_is_ignored),
        cmocka_unit_test(a_hold_brakes_and_keeps_the_position),
        cmocka_unit_test(the_emergency_stop_halts_at_once),
        cmocka_unit_test(a_dead_program_stops_the_stage),
        cmocka_unit_test(a_stall_beyond_the_timeout_is_reported),
        cmocka_unit_test(a_living_program_is_never_timed_out),
        cmocka_unit_test(homing_goes_to_the_switch),
        cmocka_unit_test(without_a_limit_switch_homing_is_rejected),
        cmocka_unit_test(a_kill_switch_is_an_alarm_until_it_is_released),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
