/* Replay: recorded bytes through the drivers give the samples that live bytes gave. */

#include "base/interrupt_private.h"
#include "base/timing.h"
#include "daq/protocol/drivers.h"
#include "daq/recording/replay.h"
#include "fixtures/virtual/virtual_time.h"
#include "tests/daq/old_recording.h"
#include "tests/daq/recording_fixture.h"
#include "tests/daq/small_test.h"
#include "tests/trials.h"

struct log {
    int n_load, n_mocap, n_stage, n_remarks, n_damage;
    struct wb_load_sample load[SMALL_READINGS + 1];
    struct wb_mocap_frame frames[SMALL_FRAMES + 1];
    struct wb_stage_report reports[SMALL_REPORTS + 1];
    int stop_after; /* interrupts at this reading; 0 never */
};

static void take_load(void *context, const struct wb_load_sample *sample)
{
    struct log *log = context;
    assert_true(log->n_load < SMALL_READINGS);
    log->load[log->n_load++] = *sample;
    if (log->n_load == log->stop_after)
        wb_interrupt_set(true);
}

static void take_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct log *log = context;
    assert_true(log->n_mocap < SMALL_FRAMES);
    log->frames[log->n_mocap++] = *frame;
}

static void take_stage(void *context, const struct wb_stage_report *report)
{
    struct log *log = context;
    assert_true(log->n_stage < SMALL_REPORTS);
    log->reports[log->n_stage++] = *report;
}

static void take_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    struct log *log = context;
    (void)level;
    (void)t_ns;
    (void)text;
    log->n_remarks++;
    log->n_damage += strcmp(kind, "damage") == 0;
}

static struct log *play(const char *path, double rate, int stop_after,
                        struct wb_replay_counts *counts, enum wb_status expected)
{
    struct log *log = calloc(1, sizeof *log);
    assert_non_null(log);
    log->stop_after = stop_after;
    const struct wb_sink sink = {.context = log,
                                 .load = take_load,
                                 .mocap = take_mocap,
                                 .stage = take_stage,
                                 .remark = take_remark};
    struct wb_recording *recording = NULL;
    struct wb_rig rig;
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_OK);
    assert_int_equal(wb_replay_run(recording, &rig, &sink, rate, counts), expected);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    return log;
}

static void replay_gives_every_recorded_sample(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_replay_counts counts;
    struct log *log = play(bench->path, 0.0, 0, &counts, WB_OK);
    assert_int_equal(counts.load_samples, SMALL_READINGS);
    assert_int_equal(counts.mocap_frames, SMALL_FRAMES);
    assert_int_equal(counts.stage_reports, SMALL_REPORTS);
    assert_int_equal(counts.damaged_chunks, 0);
    assert_int_equal(log->n_load, SMALL_READINGS);
    for (int i = 0; i < SMALL_READINGS; i++) {
        assert_true(log->load[i].valid);
        assert_int_equal(log->load[i].index, i);
        assert_close(log->load[i].force, small_reading_g(i) * 1e-3 * 9.80665, 1e-15);
    }
    assert_int_equal(log->n_mocap, SMALL_FRAMES);
    for (int i = 0; i < SMALL_FRAMES; i++) {
        assert_int_equal(log->frames[i].frame_number, 1000 + i);
        assert_int_equal(log->frames[i].n_markers, SMALL_MARKERS);
        assert_int_equal(log->frames[i].t_ns, SMALL_START_NS + 1000 + WB_NS_PER_S / 48 * i);
    }
    assert_int_equal(log->n_stage, SMALL_REPORTS);
    assert_int_equal(log->reports[0].state, WB_STAGE_IDLE);
    assert_int_equal(log->reports[7].state, WB_STAGE_JOG);
    assert_close(log->reports[7].position, 0.35e-3, 1e-12);
    free(log);
}

/* The drivers fed by hand, without streams or replay. */
struct feeding {
    const struct wb_driver *driver[3];
    void *driver_state[3];
    struct wb_sink sink;
};

static enum wb_status feed(void *context, const struct wb_chunk *chunk)
{
    struct feeding *feeding = context;
    feeding->driver[chunk->stream]->receive(feeding->driver_state[chunk->stream], chunk->t_ns,
                                            chunk->bytes, chunk->n, &feeding->sink);
    return WB_OK;
}

static struct log *feed_directly(struct wb_recording *recording, const struct wb_rig *rig)
{
    struct log *log = calloc(1, sizeof *log);
    assert_non_null(log);
    struct feeding feeding = {.driver = {&wb_loadcell_generic, &wb_natnet_client, &wb_stage_grbl},
                              .sink = {.context = log,
                                       .load = take_load,
                                       .mocap = take_mocap,
                                       .stage = take_stage,
                                       .remark = take_remark}};
    /* A live driver has sent its start commands before it receives anything. */
    struct wb_outbox outbox;
    for (int i = 0; i < 3; i++) {
        feeding.driver_state[i] = calloc(1, feeding.driver[i]->state_size);
        assert_int_equal(feeding.driver[i]->init(feeding.driver_state[i], rig), WB_OK);
        wb_outbox_clear(&outbox);
        if (feeding.driver[i]->start)
            feeding.driver[i]->start(feeding.driver_state[i], SMALL_START_NS - 1000, &outbox);
    }
    assert_int_equal(wb_recording_each_chunk(recording, feed, &feeding), WB_OK);
    for (int i = 0; i < 3; i++)
        free(feeding.driver_state[i]);
    return log;
}

/* Member by member: there is padding between them. */
static void compare_frames(const struct wb_mocap_frame *a, const struct wb_mocap_frame *b)
{
    assert_int_equal(a->t_ns, b->t_ns);
    assert_int_equal(a->frame_number, b->frame_number);
    assert_memory_equal(&a->t_device, &b->t_device, sizeof a->t_device);
    assert_int_equal(a->camera_data_received, b->camera_data_received);
    assert_int_equal(a->transmit, b->transmit);
    assert_int_equal(a->params, b->params);
    assert_int_equal(a->n_markers, b->n_markers);
    for (int i = 0; i < a->n_markers; i++) {
        assert_int_equal(a->markers[i].id, b->markers[i].id);
        assert_memory_equal(a->markers[i].position, b->markers[i].position, 12);
        assert_memory_equal(&a->markers[i].size, &b->markers[i].size, sizeof(float));
        assert_memory_equal(&a->markers[i].residual, &b->markers[i].residual, sizeof(float));
        assert_int_equal(a->markers[i].params, b->markers[i].params);
    }
}

static void compare(const struct log *a, const struct log *b)
{
    assert_int_equal(a->n_load, b->n_load);
    for (int i = 0; i < a->n_load; i++) {
        assert_int_equal(a->load[i].t_ns, b->load[i].t_ns);
        assert_int_equal(a->load[i].index, b->load[i].index);
        assert_memory_equal(&a->load[i].force, &b->load[i].force, sizeof(double));
        assert_int_equal(a->load[i].valid, b->load[i].valid);
        assert_int_equal(a->load[i].unstable, b->load[i].unstable);
    }
    assert_int_equal(a->n_mocap, b->n_mocap);
    for (int i = 0; i < a->n_mocap; i++)
        compare_frames(&a->frames[i], &b->frames[i]);
    assert_int_equal(a->n_stage, b->n_stage);
    for (int i = 0; i < a->n_stage; i++) {
        assert_int_equal(a->reports[i].t_ns, b->reports[i].t_ns);
        assert_int_equal(a->reports[i].state, b->reports[i].state);
        assert_int_equal(a->reports[i].alarm, b->reports[i].alarm);
        assert_memory_equal(&a->reports[i].position, &b->reports[i].position, sizeof(double));
    }
}

static void replayed_samples_equal_live_ones_bit_for_bit(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_replay_counts counts;
    struct log *replayed = play(bench->path, 0.0, 0, &counts, WB_OK);
    struct wb_recording *recording = NULL;
    struct wb_rig rig;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_OK);
    struct log *live = feed_directly(recording, &rig);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(live->n_load, SMALL_READINGS);
    compare(live, replayed);
    free(live);
    free(replayed);
}

struct span {
    int64_t first_ns, last_ns;
};

static enum wb_status widen(void *context, const struct wb_chunk *chunk)
{
    struct span *const span = context;
    span->first_ns = span->first_ns == 0 ? chunk->t_ns : span->first_ns;
    span->last_ns = chunk->t_ns;
    return WB_OK;
}

static void rate_sets_the_pace(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_replay_counts counts;
    wb_virtual_time_begin(WB_VIRTUAL_TIME_HOST_DATE);
    free(play(bench->path, 5.0, 0, &counts, WB_OK));
    const int64_t took_ns = wb_time_now_ns() - WB_VIRTUAL_TIME_START_NS;
    wb_virtual_time_end();
    struct span span = {0};
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_recording_each_chunk(recording, widen, &span), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_true(span.last_ns - span.first_ns > WB_NS_PER_S * 9 / 10);
    assert_in_range(5 * took_ns - (span.last_ns - span.first_ns), 0, 10);
    assert_int_equal(counts.load_samples, SMALL_READINGS);
}

static void interrupt_ends_it_with_what_was_played(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    struct wb_replay_counts counts;
    struct log *log = play(bench->path, 0.0, 10, &counts, WB_OK);
    wb_interrupt_set(false);
    assert_in_range(counts.load_samples, 10, 11); /* one chunk may end two lines */
    assert_true(counts.mocap_frames > 0 && counts.mocap_frames < SMALL_FRAMES);
    free(log);
}

static void damaged_chunks_are_counted_remarked_and_left_out(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    old_recording_run(bench->path,
                      "UPDATE chunk SET crc32 = crc32 + 1 WHERE stream = 1 AND seq IN (5, 6)");
    struct wb_replay_counts counts;
    struct log *log = play(bench->path, 0.0, 0, &counts, WB_OK);
    assert_int_equal(counts.damaged_chunks, 2);
    assert_int_equal(log->n_damage, 2);
    assert_int_equal(counts.mocap_frames, SMALL_FRAMES - 2);
    assert_int_equal(counts.load_samples, SMALL_READINGS);
    free(log);
}

/* Every chunk of the load cell ends within a line; each is damaged once, and missing once. */
static void no_halves_of_lines_around_a_gap_make_a_reading(void **state)
{
    struct bench *bench = *state;
    static const char *const changes[] = {
        "UPDATE chunk SET crc32 = crc32 + 1 WHERE stream = 0 AND seq = %d",
        "DELETE FROM chunk WHERE stream = 0 AND seq = %d"};
    int trials = 0;
    for (int missing = 0; missing < 2; missing++) {
        for (int seq = 1; seq < 30; seq++) {
            char change[128];
            struct wb_replay_counts counts;
            unlink(bench->path);
            small_make(bench->path, true);
            snprintf(change, sizeof change, changes[missing], seq);
            old_recording_run(bench->path, change);
            struct log *log = play(bench->path, 0.0, 0, &counts, WB_OK);
            assert_true(log->n_load < SMALL_READINGS && log->n_load > SMALL_READINGS - 5);
            int reading = 0;
            for (int i = 0; i < log->n_load; i++, reading++) {
                while (reading < SMALL_READINGS &&
                       fabs(log->load[i].force -
                            small_reading_g(reading) * 1e-3 * WB_STANDARD_GRAVITY) > 1e-9)
                    reading++;
                assert_true(reading < SMALL_READINGS);
            }
            free(log);
            trials++;
        }
    }
    count_trials("A chunk damaged or missing within a line", (uint64_t)trials,
                 "chunks: no wrong reading");
}

static void unknown_protocol_leaves_out_its_stream_only(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, true);
    old_recording_make(bench->path);
    old_recording_run(bench->path, "UPDATE stream SET protocol = 'semaphore' WHERE id = 1");
    struct wb_replay_counts counts;
    free(play(bench->path, 0.0, 0, &counts, WB_OK));
    assert_non_null(strstr(bench->message, "semaphore"));
    assert_int_equal(counts.mocap_frames, 0);
    assert_int_equal(counts.load_samples, SMALL_READINGS);
    assert_int_equal(counts.stage_reports, SMALL_REPORTS);
}

static void recording_without_its_rig_is_rejected_with_the_reason(void **state)
{
    struct bench *bench = *state;
    small_make(bench->path, false);
    struct wb_recording *recording = NULL;
    struct wb_rig rig;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    assert_int_equal(wb_replay_rig(recording, &rig), WB_ERR_DATA);
    assert_non_null(strstr(bench->message, "no rig file"));
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(replay_gives_every_recorded_sample),
        FACT(replayed_samples_equal_live_ones_bit_for_bit),
        FACT(rate_sets_the_pace),
        FACT(interrupt_ends_it_with_what_was_played),
        FACT(damaged_chunks_are_counted_remarked_and_left_out),
        FACT(no_halves_of_lines_around_a_gap_make_a_reading),
        FACT(unknown_protocol_leaves_out_its_stream_only),
        FACT(recording_without_its_rig_is_rejected_with_the_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
