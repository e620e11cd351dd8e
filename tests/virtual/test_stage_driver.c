/* The stage driver on the simulated stage, in simulated time: the short jogs that move it. Bytes
 * take some time in each direction, and the test decides when the program runs. */
#include <stdlib.h>

#include "base/log.h"
#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "daq/protocol/jog_feed.h"
#include "fixtures/virtual/sim_stage.h"
#include "tests/check.h"
#include "tests/trials.h"

#define MS WB_NS_PER_MS
#define LINK_NS (3 * MS) /* each way: 115200 baud and USB */
#define TICK_NS (20 * MS)
#define POST 64

/* Bytes in transit. */
struct post {
    struct {
        int64_t due_ns;
        size_t n;
        char bytes[512];
    } letters[POST];
    int first, n;
};

struct drive {
    struct wb_sim_stage stage;
    struct wb_rig rig;
    void *driver;
    struct wb_outbox outbox;
    struct post to_stage, to_driver;
    int64_t now_ns, next_tick_ns;
    int64_t tick_ns;       /* between two turns of the program */
    int64_t stalled_until; /* the program does not run before this time */
    bool is_dead;
    int lose_line, lose_ok; /* this jog, or `ok`, counted from now on, is lost; 0: none */
    int lines;
    double most_ahead; /* m: largest distance queued ahead of the stage */
    double speed, acceleration;
    struct wb_stage_report last;
    int reports, errors;
};

static void post(struct post *post, int64_t due_ns, const void *bytes, size_t n)
{
    assert_true(post->n < POST && n <= sizeof post->letters[0].bytes);
    const int at = (post->first + post->n++) % POST;
    post->letters[at].due_ns = due_ns;
    post->letters[at].n = n;
    memcpy(post->letters[at].bytes, bytes, n);
}

/* The next line that has arrived; NULL: none. */
static const char *arrived(struct post *post, int64_t now_ns, size_t *n)
{
    if (post->n == 0 || post->letters[post->first].due_ns > now_ns)
        return NULL;
    const char *const bytes = post->letters[post->first].bytes;
    *n = post->letters[post->first].n;
    post->first = (post->first + 1) % POST;
    post->n--;
    return bytes;
}

static void keep_report(void *context, const struct wb_stage_report *report)
{
    struct drive *const drive = context;
    drive->last = *report;
    drive->reports++;
}

static void keep_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    (void)t_ns;
    (void)kind;
    (void)text;
    ((struct drive *)context)->errors += level == WB_LOG_ERROR;
}

static void send(struct drive *drive)
{
    size_t begin = 0;
    for (size_t i = 0; i < drive->outbox.n_entries; i++) {
        const char *const bytes = (const char *)drive->outbox.bytes + begin;
        const size_t n = drive->outbox.ends[i] - begin;
        const bool is_jog = n > 3 && strncmp(bytes, "$J=", 3) == 0;
        drive->lines += is_jog;
        if (!is_jog || drive->lose_line == 0 || --drive->lose_line > 0)
            post(&drive->to_stage, drive->now_ns + LINK_NS, bytes, n);
        begin = drive->outbox.ends[i];
    }
    wb_outbox_clear(&drive->outbox);
}

static double travel(struct drive *drive)
{
    return wb_sim_stage_travel(&drive->stage, wb_seconds_from_ns(drive->now_ns));
}

/* One millisecond. */
static void step(struct drive *drive)
{
    const struct wb_sink sink = {.context = drive, .stage = keep_report, .remark = keep_remark};
    struct wb_sim_stage *const stage = &drive->stage;
    const char *bytes;
    char said[512];
    size_t n;
    drive->now_ns += MS;
    const double t = wb_seconds_from_ns(drive->now_ns);
    wb_sim_stage_advance(stage, t);
    while ((bytes = arrived(&drive->to_stage, drive->now_ns, &n)))
        wb_sim_stage_receive(stage, t, bytes, n);
    n = wb_reply_take(&stage->out, said, sizeof said);
    const bool is_ok = n == 4 && memcmp(said, "ok\r\n", 4) == 0;
    if (n > 0 && (!is_ok || drive->lose_ok == 0 || --drive->lose_ok > 0))
        post(&drive->to_driver, drive->now_ns + LINK_NS, said, n);
    if (stage->n_blocks > 0 && stage->state == WB_SIM_STAGE_JOG) {
        const double before =
            fabs(stage->blocks[stage->n_blocks - 1].target - (-62.0 * WB_MM + travel(drive)));
        drive->most_ahead = fmax(drive->most_ahead, before);
    }
    if (drive->is_dead || drive->now_ns < drive->stalled_until)
        return;
    while ((bytes = arrived(&drive->to_driver, drive->now_ns, &n)))
        wb_stage_grbl.receive(drive->driver, drive->now_ns, (const uint8_t *)bytes, n, &sink);
    if (drive->now_ns < drive->next_tick_ns)
        return;
    drive->next_tick_ns = drive->now_ns + drive->tick_ns;
    wb_stage_grbl.tick(drive->driver, drive->now_ns, &drive->outbox);
    send(drive);
}

static void live(struct drive *drive, double seconds)
{
    const int64_t end_ns = drive->now_ns + wb_ns_from_seconds(seconds);
    while (drive->now_ns < end_ns)
        step(drive);
}

static void command(struct drive *drive, enum wb_stage_command command_kind, double distance)
{
    assert_int_equal(
        wb_stage_grbl.command(drive->driver, command_kind, distance, drive->speed, &drive->outbox),
        WB_OK);
    send(drive);
}

static void begin(struct drive *drive, double speed, double acceleration, double clock_error)
{
    const struct wb_sim_stage_settings settings = {.axis = 'X',
                                                   .down = 1,
                                                   .clamp.travel = 60.0 * WB_MM,
                                                   .time_scale = 1.0,
                                                   .clock_error = clock_error};
    char text[32];
    memset(drive, 0, sizeof *drive);
    drive->speed = speed;
    drive->acceleration = acceleration;
    drive->tick_ns = TICK_NS;
    drive->rig.stage.axis = 'X';
    drive->rig.stage.down = 1;
    drive->rig.time_scale = 1.0;
    wb_sim_stage_init(&drive->stage, &settings);
    snprintf(text, sizeof text, "$120=%.3f\n$110=3000\n", acceleration / WB_MM);
    wb_sim_stage_receive(&drive->stage, 0.0, text, strlen(text));
    wb_reply_take(&drive->stage.out, text, sizeof text);
    drive->driver = calloc(1, wb_stage_grbl.state_size);
    assert_non_null(drive->driver);
    assert_int_equal(wb_stage_grbl.init(drive->driver, &drive->rig), WB_OK);
    wb_stage_grbl.start(drive->driver, 0, &drive->outbox);
    send(drive);
    live(drive, 0.3);
    assert_true(wb_stage_grbl.ready(drive->driver));
}

static void end(struct drive *drive)
{
    free(drive->driver);
}

static double ahead(const struct drive *drive)
{
    return wb_jog_feed_ahead(&(struct wb_motion_limits){drive->speed, drive->acceleration});
}

/* Seconds until the stage reaches a travel. */
static double arrive(struct drive *drive, double target, double patience)
{
    const int64_t begin_ns = drive->now_ns;
    while (fabs(travel(drive) - target) > 1e-6 || drive->stage.state != WB_SIM_STAGE_IDLE) {
        step(drive);
        if (wb_seconds_from_ns(drive->now_ns - begin_ns) > patience)
            fail_msg("at %.3f mm instead of %.3f mm after %.1f s", travel(drive) / WB_MM,
                     target / WB_MM, patience);
    }
    return wb_seconds_from_ns(drive->now_ns - begin_ns);
}

static const struct {
    double speed, acceleration, way; /* mm/s, mm/s2, mm */
} moves[] = {{1.0, 50.0, 53.0},  {1.0, 10.0, 20.0}, {1.0, 1.0, 20.0}, {10.0, 50.0, 53.0},
             {10.0, 10.0, 53.0}, {0.05, 50.0, 2.0}, {0.01, 10.0, 0.2}};

/* In the stage's own time, over the complete stroke, and in each half second of it. */
static void the_speed_is_held_within_1_percent(void **state)
{
    (void)state;
    static const double errors[] = {-0.02, 0.0, 0.02};
    for (size_t i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        for (int k = 0; k < 3; k++) {
            struct drive drive;
            const double v = moves[i].speed * WB_MM, a = moves[i].acceleration * WB_MM;
            const double way = moves[i].way * WB_MM, clock = 1.0 + errors[k];
            begin(&drive, v, a, errors[k]);
            command(&drive, WB_STAGE_COMMAND_JOG, way);
            const double ideal = way / v + v / a;
            double slowest = HUGE_VAL, before = 0.0;
            const int64_t begin_ns = drive.now_ns;
            while (travel(&drive) < way - 1e-6) {
                live(&drive, 0.5);
                const double at = travel(&drive);
                const double left = way - at;
                if (before > v * v / a && left > v * v / a + 1e-6)
                    slowest = fmin(slowest, (at - before) / 0.5 / v / clock);
                before = at;
                assert_true(wb_seconds_from_ns(drive.now_ns - begin_ns) < 1.2 * ideal + 3.0);
            }
            /* The motor's step size is a part of the 1 %. */
            const double step_share = 1.25e-6 / (0.5 * v);
            if (!(slowest > 0.99 - step_share))
                fail_msg("%g mm/s, %g mm/s2, clock %+g: %.3f of the speed in half a second",
                         moves[i].speed, moves[i].acceleration, errors[k], slowest);
            end(&drive);
            begin(&drive, v, a, errors[k]);
            command(&drive, WB_STAGE_COMMAND_JOG, way);
            const double took = arrive(&drive, way, 1.2 * ideal + 3.0) * clock;
            if (!(fabs(took - ideal) < 0.01 * ideal + 0.02))
                fail_msg("%g mm/s, %g mm/s2, clock %+g: %.3f s instead of %.3f s", moves[i].speed,
                         moves[i].acceleration, errors[k], took, ideal);
            /* A clock that is slow by 2 % is late by at most 8 ms until the next report. */
            const double bound = ahead(&drive) + 0.01 * v + 3e-6;
            if (!(drive.most_ahead <= bound))
                fail_msg("%g mm/s, %g mm/s2: %.4f mm ahead, not within %.4f mm", moves[i].speed,
                         moves[i].acceleration, drive.most_ahead / WB_MM, bound / WB_MM);
            assert_int_equal(drive.errors, 0);
            end(&drive);
        }
    }
}

/* If the program is killed at any time, the stage stops within the braking distance plus 0.15 s. */
static void the_stage_stops_after_the_program_dies(void **state)
{
    (void)state;
    uint64_t n = 0;
    for (size_t i = 0; i < 5; i++) {
        for (int after_ms = 5; after_ms < 1500; after_ms += 37) {
            struct drive drive;
            const double v = moves[i].speed * WB_MM, a = moves[i].acceleration * WB_MM;
            begin(&drive, v, a, 0.0);
            command(&drive, WB_STAGE_COMMAND_JOG, 50.0 * WB_MM);
            live(&drive, 1e-3 * after_ms);
            const double at = travel(&drive);
            drive.is_dead = true;
            live(&drive, 0.2 + 2.0 * v / a);
            const double stood = travel(&drive);
            live(&drive, 3.0);
            assert_close(travel(&drive), stood, 1e-9);
            assert_int_equal(drive.stage.state, WB_SIM_STAGE_IDLE);
            if (!(stood - at <= ahead(&drive) + 3e-6))
                fail_msg("%g mm/s, %g mm/s2, killed after %d ms: %.3f mm further, not %.3f mm",
                         moves[i].speed, moves[i].acceleration, after_ms, (stood - at) / WB_MM,
                         ahead(&drive) / WB_MM);
            end(&drive);
            n++;
        }
    }
    count_trials("A recorder is killed while the stage moves", n,
                 "moments at five speeds and accelerations: the stage stands within the way to "
                 "brake and 0.15 s");
}

static void a_program_late_by_40_ms_still_holds_the_speed(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 1.0 * WB_MM, 50.0 * WB_MM, 0.0);
    drive.tick_ns = 60 * MS;
    command(&drive, WB_STAGE_COMMAND_JOG, 20.0 * WB_MM);
    const double took = arrive(&drive, 20.0 * WB_MM, 30.0);
    assert_true(took < 1.01 * 20.02);
    end(&drive);
}

static void a_stall_stops_the_stage_and_it_resumes(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 10.0 * WB_MM, 50.0 * WB_MM, 0.0);
    command(&drive, WB_STAGE_COMMAND_JOG, 50.0 * WB_MM);
    live(&drive, 1.0);
    drive.stalled_until = drive.now_ns + 1000 * MS;
    live(&drive, 0.9);
    const double at = travel(&drive);
    assert_true(at < 12.5 * WB_MM);
    live(&drive, 0.1);
    assert_close(travel(&drive), at, 0.0);
    arrive(&drive, 50.0 * WB_MM, 10.0);
    assert_true(drive.most_ahead <= ahead(&drive) + 3e-6);
    end(&drive);
}

static void ignore(void *context, enum wb_log_level level, const char *domain, const char *message)
{
    (void)level;
    (void)domain;
    (void)message;
    ++*(int *)context;
}

/* The position at which the stage stops shows whether the line or its answer was lost. */
static void lost_lines_and_answers_are_recovered(void **state)
{
    (void)state;
    int n_messages = 0;
    wb_log_set_sink(ignore, &n_messages);
    for (int nth = 1; nth <= 12; nth++) {
        for (int command_kind = 0; command_kind < 2; command_kind++) {
            struct drive drive;
            begin(&drive, 1.0 * WB_MM, 50.0 * WB_MM, 0.0);
            *(command_kind ? &drive.lose_line : &drive.lose_ok) = nth;
            command(&drive, WB_STAGE_COMMAND_JOG, 0.6 * WB_MM);
            arrive(&drive, 0.6 * WB_MM, 5.0);
            live(&drive, 2.0);
            assert_close(travel(&drive), 0.6 * WB_MM, 1e-6);
            assert_true(drive.most_ahead <= ahead(&drive) + 3e-6);
            end(&drive);
        }
    }
    assert_true(n_messages > 10);
    wb_log_set_sink(NULL, NULL);
}

/* A cancel between two short jogs: the next line starts, and is also cancelled. */
static void a_cancelled_jog_ends_at_rest(void **state)
{
    (void)state;
    for (int after_ms = 0; after_ms < 100; after_ms += 3) {
        struct drive drive;
        begin(&drive, 10.0 * WB_MM, 50.0 * WB_MM, 0.0);
        command(&drive, WB_STAGE_COMMAND_JOG, 50.0 * WB_MM);
        live(&drive, 1.0 + 1e-3 * after_ms);
        const double at = travel(&drive);
        command(&drive, WB_STAGE_COMMAND_JOG_CANCEL, 0.0);
        live(&drive, 1.0);
        const double stood = travel(&drive);
        assert_true(stood - at < 2.5 * WB_MM);
        live(&drive, 1.0);
        assert_close(travel(&drive), stood, 0.0);
        command(&drive, WB_STAGE_COMMAND_JOG, -stood);
        arrive(&drive, 0.0, 5.0);
        end(&drive);
    }
}

static void the_stage_holds_resets_and_homes(void **state)
{
    (void)state;
    struct drive drive;
    begin(&drive, 10.0 * WB_MM, 50.0 * WB_MM, 0.0);
    assert_close(drive.last.position, -62.0 * WB_MM, 1e-9);
    command(&drive, WB_STAGE_COMMAND_JOG, 20.0 * WB_MM);
    live(&drive, 1.0);
    assert_int_equal(drive.last.state, WB_STAGE_JOG);
    command(&drive, WB_STAGE_COMMAND_HOLD, 0.0);
    live(&drive, 0.5);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    const double held = drive.last.position;
    assert_true(held > -53.0 * WB_MM && held < -50.0 * WB_MM);
    assert_int_equal(drive.errors, 0);

    command(&drive, WB_STAGE_COMMAND_JOG, 20.0 * WB_MM);
    live(&drive, 1.0);
    command(&drive, WB_STAGE_COMMAND_SOFT_RESET, 0.0);
    live(&drive, 0.5);
    assert_int_equal(drive.last.state, WB_STAGE_ALARM);
    assert_int_equal(drive.last.alarm, 3);
    assert_int_equal(drive.errors, 1);

    command(&drive, WB_STAGE_COMMAND_HOME, 0.0);
    live(&drive, 15.0);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    assert_int_equal(drive.last.alarm, 0);
    assert_close(drive.last.position, -62.0 * WB_MM, 1e-9);
    /* For a target beyond its travel of 62 mm it stops before the end. */
    command(&drive, WB_STAGE_COMMAND_JOG, 100.0 * WB_MM);
    live(&drive, 10.0);
    assert_int_equal(drive.errors, 2);
    assert_int_equal(drive.last.state, WB_STAGE_IDLE);
    assert_true(drive.last.position > -4.0 * WB_MM && drive.last.position <= 0.0);
    end(&drive);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_speed_is_held_within_1_percent),
        cmocka_unit_test(the_stage_stops_after_the_program_dies),
        cmocka_unit_test(a_program_late_by_40_ms_still_holds_the_speed),
        cmocka_unit_test(a_stall_stops_the_stage_and_it_resumes),
        cmocka_unit_test(lost_lines_and_answers_are_recovered),
        cmocka_unit_test(a_cancelled_jog_ends_at_rest),
        cmocka_unit_test(the_stage_holds_resets_and_homes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
