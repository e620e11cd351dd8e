/* The acquisition loop with a small bench in virtual time: stored data, reports, and the limits of
 * its waits. */
#include "base/file.h"
#include "base/timing.h"

#include "base/interrupt_private.h"
#include "base/log.h"
#include "base/text.h"
#include "daq/acquire/acquisition_private.h"
#include "daq/stream/stream.h"
#include "daq/test/bend_recording.h"
#include "tests/daq/fake_bench.h"
#include "tests/daq/sample_log.h"
#include "tests/folder.h"

#define MS WB_NS_PER_MS

struct fixture {
    struct fake_bench *bench;
    char folder[64], rig_path[96], output[96];
    struct wb_rig rig;
    struct sample_log log;
    struct wb_acquisition *acquisition;
    struct wb_writer *writer;
    char events[16384];
    int n_clock, n_shown, n_chunks[3];
    int64_t n_bytes[3], next_seq[3];
    double worst_offset_ms; /* of the clock rows from the server's true clock */
};

static void count_warnings(void *context, enum wb_log_level level, const char *domain,
                           const char *message)
{
    struct fixture *const fixture = context;
    (void)domain;
    (void)message;
    fixture->n_shown += level <= WB_LOG_WARNING;
}

static int set_up(void **state)
{
    struct fixture *const fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    assert_true(temporary_folder_make(fixture->folder));
    snprintf(fixture->rig_path, sizeof fixture->rig_path, "%s/rig.yaml", fixture->folder);
    snprintf(fixture->output, sizeof fixture->output, "%s/test.wbr", fixture->folder);
    fixture->bench = fake_start();
    fake_write_rig(fixture->rig_path, false, 0.15);
    assert_int_equal(wb_rig_read(fixture->rig_path, &fixture->rig), WB_OK);
    wb_interrupt_set(false);
    wb_log_set_sink(count_warnings, fixture);
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *const fixture = *state;
    wb_log_set_sink(NULL, NULL);
    wb_interrupt_set(false);
    wb_acquisition_close(fixture->acquisition);
    assert_int_equal(wb_writer_finish(fixture->writer), WB_OK);
    fake_stop(fixture->bench);
    sample_log_release(&fixture->log);
    const int code = temporary_folder_remove(fixture->folder);
    free(fixture);
    return code;
}

static void start(struct fixture *fixture)
{
    struct wb_recording *recording;
    char *rig;
    int id;
    const struct wb_sink sink = sample_log_sink(&fixture->log);
    assert_int_equal(
        wb_acquisition_open(&fixture->acquisition, &fixture->rig, WB_ACQUISITION_ALL, &sink),
        WB_OK);
    assert_int_equal(wb_recording_create(&recording, fixture->output), WB_OK);
    assert_int_equal(wb_file_read(fixture->rig_path, &rig, NULL), WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "rig", rig), WB_OK);
    free(rig);
    static const char *const protocols[] = {"generic", "natnet", "grbl"};
    for (int role = 0; role < 3; role++) {
        assert_int_equal(wb_recording_add_stream(recording, (enum wb_role)role, "test",
                                                 protocols[role], "", &id),
                         WB_OK);
        assert_int_equal(wb_acquisition_stream(fixture->acquisition, (enum wb_role)role), id);
    }
    assert_int_equal(wb_writer_start(&fixture->writer, recording, NULL), WB_OK);
    wb_acquisition_start(fixture->acquisition, fixture->writer);
}

static void run_for(struct fixture *fixture, int64_t duration_ns)
{
    const int64_t end_ns = wb_time_now_ns() + duration_ns;
    while (wb_time_now_ns() < end_ns)
        assert_int_equal(wb_acquisition_step(fixture->acquisition, 10 * MS),
                         WB_ACQUISITION_CONTINUE);
}

static void finish(struct fixture *fixture)
{
    wb_acquisition_close(fixture->acquisition);
    fixture->acquisition = NULL;
    assert_int_equal(wb_writer_finish(fixture->writer), WB_OK);
    fixture->writer = NULL;
}

static enum wb_status take_event(void *context, const struct wb_event *event)
{
    struct fixture *const fixture = context;
    const size_t used = strlen(fixture->events);
    snprintf(fixture->events + used, sizeof fixture->events - used, "%s: %s\n", event->kind,
             event->text);
    return WB_OK;
}

static enum wb_status take_clock(void *context, const struct wb_clock_row *row)
{
    struct fixture *const fixture = context;
    const double truth = (double)row->t_host_ns * 1e-9 + 3600.0;
    fixture->n_clock++;
    fixture->worst_offset_ms =
        fmax(fixture->worst_offset_ms, 1e3 * fabs(row->t_device - truth) - 5e-7 * row->rtt_ns);
    assert_int_equal(row->stream, WB_ROLE_MOCAP);
    assert_true(row->rtt_ns >= 0);
    return WB_OK;
}

static enum wb_status take_chunk(void *context, const struct wb_chunk *chunk)
{
    struct fixture *const fixture = context;
    assert_true(chunk->intact);
    assert_int_equal(chunk->seq, fixture->next_seq[chunk->stream]++);
    fixture->n_chunks[chunk->stream]++;
    fixture->n_bytes[chunk->stream] += (int64_t)chunk->n;
    return WB_OK;
}

static void read_back(struct fixture *fixture)
{
    struct wb_recording *recording;
    assert_int_equal(wb_recording_open(&recording, fixture->output), WB_OK);
    assert_int_equal(wb_recording_each_event(recording, take_event, fixture), WB_OK);
    assert_int_equal(wb_recording_each_clock(recording, take_clock, fixture), WB_OK);
    assert_int_equal(wb_recording_each_chunk(recording, take_chunk, fixture), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void every_byte_is_stored_and_decodes_the_same_again(void **state)
{
    struct fixture *const fixture = *state;
    start(fixture);
    run_for(fixture, 600 * MS);
    struct wb_acquisition_latest latest = *wb_acquisition_latest(fixture->acquisition);
    finish(fixture);
    read_back(fixture);
    for (int role = 0; role < 3; role++) {
        assert_int_equal(fixture->n_bytes[role], latest.stream[role].bytes);
        assert_int_equal(fixture->n_chunks[role], latest.stream[role].chunks);
        assert_int_equal(fixture->log.n[role], latest.stream[role].samples);
    }
    /* 120 lines came, of which the first may be incomplete. */
    assert_int_equal(fixture->log.n[WB_ROLE_LOAD], 119);
    assert_int_equal(fixture->log.n[WB_ROLE_MOCAP], 75);
    assert_int_equal(fixture->log.n[WB_ROLE_STAGE], 3);
    assert_replay_identical(fixture->output, &fixture->log);
}

static void rates_and_latest_values_are_those_of_the_bench(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->markers = 6;
    start(fixture);
    run_for(fixture, 1100 * MS);
    const struct wb_acquisition_latest *const latest = wb_acquisition_latest(fixture->acquisition);
    assert_close_relative(latest->stream[WB_ROLE_LOAD].rate, 200.0, 0.005);
    assert_close_relative(latest->stream[WB_ROLE_MOCAP].rate, 125.0, 0.005);
    assert_int_equal(latest->markers_seen, 6);
    assert_close(latest->load.force, 0.15e-3 * WB_STANDARD_GRAVITY, 0.02e-3 * WB_STANDARD_GRAVITY);
    assert_int_equal(latest->stage.state, WB_STAGE_IDLE);
    for (int role = 0; role < 3; role++)
        assert_true(latest->stream[role].ready && !latest->stream[role].lost);
}

/* Like a process that is suspended between two reads. */
static void stall_at_every_40th(void *context, const struct wb_load_sample *sample)
{
    int *const n = context;
    (void)sample;
    if (++*n % 40 == 0)
        wb_time_sleep(wb_time_now_ns() + 30 * MS);
}

struct stamps {
    int n;
    int64_t t_ns[200]; /* of the load cell's chunks */
};

static enum wb_status take_stamp(void *context, const struct wb_chunk *chunk)
{
    struct stamps *const stamps = context;
    if (chunk->stream != WB_ROLE_LOAD)
        return WB_OK;
    assert_in_range(stamps->n, 0, 199);
    stamps->t_ns[stamps->n++] = chunk->t_ns;
    return WB_OK;
}

/* Bytes that come during a stall are read after it: their stamp may not be that of the wake-up
 * before it. */
static void no_stamp_is_earlier_than_the_arrival_of_its_bytes(void **state)
{
    struct fixture *const fixture = *state;
    struct stamps stamps = {0};
    struct wb_recording *recording;
    int n_samples = 0, n_late = 0;
    int64_t arrived_ns = wb_time_now_ns() + WB_SIM_PORT_DELAY_NS;
    start(fixture);
    wb_acquisition_add_sink(fixture->acquisition,
                            &(struct wb_sink){.context = &n_samples, .load = stall_at_every_40th});
    run_for(fixture, 800 * MS);
    finish(fixture);
    assert_int_equal(wb_recording_open(&recording, fixture->output), WB_OK);
    assert_int_equal(wb_recording_each_chunk(recording, take_stamp, &stamps), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(stamps.n, 160);
    for (int i = 0; i < stamps.n; i++, arrived_ns += FAKE_LOAD_PERIOD_NS) {
        assert_true(stamps.t_ns[i] >= arrived_ns);
        n_late += stamps.t_ns[i] > arrived_ns;
    }
    assert_int_equal(n_late, 3 * 5);
}

static void clock_probes_bracket_the_server_clock(void **state)
{
    struct fixture *const fixture = *state;
    start(fixture);
    run_for(fixture, 800 * MS);
    finish(fixture);
    read_back(fixture);
    assert_true(fixture->n_clock >= 4);
    /* Host time plus an hour, read to 0.1 us, between sending and receiving. */
    assert_true(fixture->worst_offset_ms < 0.01);
}

static void silent_stream_is_lost_and_found_again(void **state)
{
    struct fixture *const fixture = *state;
    start(fixture);
    run_for(fixture, 300 * MS);
    struct wb_interlock_settings settings;
    wb_interlock_default_settings(&settings, &fixture->rig);
    wb_acquisition_arm(fixture->acquisition, &settings, (double)NAN);
    wb_acquisition_disarm(fixture->acquisition);
    fixture->bench->mocap_silent = true;
    run_for(fixture, 250 * MS);
    assert_true(wb_acquisition_latest(fixture->acquisition)->stream[WB_ROLE_MOCAP].lost);
    fixture->bench->mocap_silent = false;
    run_for(fixture, 100 * MS);
    assert_false(wb_acquisition_latest(fixture->acquisition)->stream[WB_ROLE_MOCAP].lost);
    assert_int_equal(wb_acquisition_interlock(fixture->acquisition)->reason, WB_INTERLOCK_NONE);
    finish(fixture);
    read_back(fixture);
    const char *const lost = strstr(fixture->events, "stream_lost: mocap");
    assert_non_null(lost);
    assert_non_null(strstr(lost, "stream_found: mocap"));
}

static void invalid_bytes_flood_neither_recording_nor_terminal(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->garbage = true;
    start(fixture);
    fixture->n_shown = 0;
    run_for(fixture, 500 * MS);
    assert_in_range(fixture->n_shown, 1, 4);
    finish(fixture);
    read_back(fixture);
    int remarks = 0;
    for (const char *at = fixture->events; (at = strstr(at, "refused:")); at++)
        remarks++;
    assert_in_range(remarks, 1, 40);
    assert_int_equal(fixture->n_chunks[WB_ROLE_LOAD], 100);
}

static void step_waits_20_ms_at_most(void **state)
{
    struct fixture *const fixture = *state;
    fixture->bench->load_silent = fixture->bench->mocap_silent = true;
    start(fixture);
    run_for(fixture, 100 * MS);
    for (int i = 0; i < 20; i++) {
        const int64_t before_ns = wb_time_now_ns();
        assert_int_equal(wb_acquisition_step(fixture->acquisition, WB_NS_PER_S),
                         WB_ACQUISITION_CONTINUE);
        assert_in_range(wb_time_now_ns() - before_ns, 1, 20 * MS);
    }
}

static void unplugging_everything_ends_the_loop_without_busy_waiting(void **state)
{
    struct fixture *const fixture = *state;
    struct wb_acquisition *serial;
    assert_int_equal(wb_acquisition_open(&serial, &fixture->rig,
                                         WB_ACQUISITION_LOAD | WB_ACQUISITION_STAGE, NULL),
                     WB_OK);
    wb_acquisition_start(serial, NULL);
    for (int i = 0; i < 10; i++)
        assert_int_equal(wb_acquisition_step(serial, 10 * MS), WB_ACQUISITION_CONTINUE);
    fake_unplug(fixture->bench);
    enum wb_acquisition_end end = WB_ACQUISITION_CONTINUE;
    int steps = 0;
    while (end == WB_ACQUISITION_CONTINUE && steps++ < 20)
        end = wb_acquisition_step(serial, 10 * MS);
    assert_int_equal(end, WB_ACQUISITION_DONE);
    assert_true(wb_acquisition_latest(serial)->stream[WB_ROLE_LOAD].gone);
    wb_acquisition_close(serial);
}

static void after_a_trip_motions_are_rejected_until_it_is_cleared(void **state)
{
    struct fixture *const fixture = *state;
    start(fixture);
    run_for(fixture, 300 * MS);
    struct wb_acquisition *const a = fixture->acquisition;
    assert_int_equal(wb_acquisition_command(a, WB_STAGE_COMMAND_JOG, 0.01, 0.01), WB_OK);
    run_for(fixture, 50 * MS);
    wb_acquisition_stop(a, WB_INTERLOCK_INTERRUPT, "test");
    assert_int_equal(wb_acquisition_command(a, WB_STAGE_COMMAND_JOG, 0.01, 0.01), WB_ERR_ARGUMENT);
    run_for(fixture, 200 * MS);
    assert_int_equal(wb_acquisition_stop_state(a)->state, WB_STOP_STANDING);
    assert_false(wb_acquisition_moving(a));
    wb_acquisition_clear_stop(a);
    assert_int_equal(wb_acquisition_command(a, WB_STAGE_COMMAND_SOFT_RESET, 0.0, 0.0), WB_OK);
    run_for(fixture, 100 * MS);
    assert_int_equal(wb_acquisition_command(a, WB_STAGE_COMMAND_JOG, 1e-3, 0.01), WB_OK);
    run_for(fixture, 50 * MS);
    assert_true(wb_acquisition_moving(a));
    wb_acquisition_stop(a, WB_INTERLOCK_INTERRUPT, "end of the test");
    run_for(fixture, 200 * MS);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(every_byte_is_stored_and_decodes_the_same_again),
        TEST(rates_and_latest_values_are_those_of_the_bench),
        TEST(no_stamp_is_earlier_than_the_arrival_of_its_bytes),
        TEST(clock_probes_bracket_the_server_clock),
        TEST(silent_stream_is_lost_and_found_again),
        TEST(invalid_bytes_flood_neither_recording_nor_terminal),
        TEST(step_waits_20_ms_at_most),
        TEST(unplugging_everything_ends_the_loop_without_busy_waiting),
        TEST(after_a_trip_motions_are_rejected_until_it_is_cleared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
