/* The writer's queue: no loss while there is space; otherwise every loss is counted and recorded;
 * it never waits for the disk. */
#include "base/units.h"
#include "daq/recording/writer_private.h"
#include "tests/daq/gate.h"
#include "tests/daq/recording_fixture.h"

/* Settings of a writer that passes the gate and writes every millisecond. */
static struct wb_writer_settings settings_of(struct gate *gate)
{
    struct wb_writer_settings settings;
    wb_writer_default_settings(&settings);
    settings.flush_interval_ns = WB_NS_PER_MS;
    settings.before_write = gate_pass;
    settings.context = gate;
    return settings;
}

static struct wb_writer *start(const char *path, const struct wb_writer_settings *settings)
{
    struct wb_recording *recording = NULL;
    struct wb_writer *writer = NULL;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    bench_fill(recording, 0);
    assert_int_equal(wb_writer_start(&writer, recording, settings), WB_OK);
    return writer;
}

static bool push(struct wb_writer *writer, int stream, int64_t seq)
{
    uint8_t bytes[300];
    size_t n = bench_bytes(stream, seq, bytes);
    return wb_writer_push_chunk(writer, stream, bench_time(stream, seq), bytes, n);
}

static void everything_pushed_is_recorded(void **state)
{
    struct bench *bench = *state;
    struct gate gate = GATE(false);
    const struct wb_writer_settings settings = settings_of(&gate);
    struct wb_writer *writer = start(bench->path, &settings);
    for (int64_t seq = 0; seq < 3000; seq++) {
        for (int stream = 0; stream < 3; stream++)
            assert_true(push(writer, stream, seq));
        if (seq % 500 == 0)
            gate_await(&gate, gate_arrived(&gate) + 1);
    }
    struct wb_writer_counts counts;
    wb_writer_counts(writer, &counts);
    assert_int_equal(counts.chunks, 9000);
    assert_int_equal(counts.dropped_chunks, 0);
    wb_writer_push_event(writer, 7, "end", "done");
    assert_true(wb_writer_push_clock(writer, 1, 8, 2.5, 900));
    wb_writer_push_meta(writer, "ended", "as planned");
    assert_int_equal(wb_writer_status(writer), WB_OK);
    assert_int_equal(wb_writer_finish(writer), WB_OK);

    struct wb_recording *recording = bench_open(bench->path, true, 9000);
    char *value = NULL;
    assert_int_equal(wb_recording_meta(recording, "ended", &value), WB_OK);
    assert_string_equal(value, "as planned");
    free(value);
    assert_int_equal(wb_recording_meta(recording, "dropped_chunks", &value), WB_OK);
    assert_string_equal(value, "0");
    free(value);
    assert_int_equal(wb_recording_close(recording), WB_OK);
    assert_int_equal(bench->messages, 0);
}

static void flushed_chunks_are_on_disk_while_recording_goes_on(void **state)
{
    struct bench *bench = *state;
    struct gate gate = GATE(false);
    const struct wb_writer_settings settings = settings_of(&gate);
    struct wb_writer *writer = start(bench->path, &settings);
    for (int64_t seq = 0; seq < 10; seq++)
        assert_true(push(writer, 0, seq));
    gate_await_rounds(&gate);
    struct bench_tally tally;
    struct wb_recording *reader = NULL;
    assert_int_equal(wb_recording_open(&reader, bench->path), WB_OK);
    assert_int_equal(bench_walk(reader, &tally), WB_OK);
    assert_int_equal(wb_recording_close(reader), WB_OK);
    assert_int_equal(tally.chunks, 10);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
}

struct gaps {
    int64_t next[3], missing[3], chunks;
};

static enum wb_status find_gaps(void *context, const struct wb_chunk *chunk)
{
    struct gaps *gaps = context;
    gaps->missing[chunk->stream] += chunk->seq - gaps->next[chunk->stream];
    gaps->next[chunk->stream] = chunk->seq + 1;
    gaps->chunks++;
    return WB_OK;
}

struct drop_events {
    int n, kept;
    char text[2][1024];
    int64_t t_ns[2];
};

static enum wb_status find_drops(void *context, const struct wb_event *event)
{
    struct drop_events *found = context;
    if (strcmp(event->kind, "keep") == 0)
        found->kept++;
    if (strcmp(event->kind, "drop") != 0)
        return WB_OK;
    if (found->n < 2) {
        snprintf(found->text[found->n], sizeof found->text[0], "%s", event->text);
        found->t_ns[found->n] = event->t_ns;
    }
    found->n++;
    return WB_OK;
}

static void full_queue_drops_counts_and_records_every_chunk_and_no_event(void **state)
{
    struct bench *bench = *state;
    struct gate gate = GATE(true);
    struct wb_writer_settings settings = settings_of(&gate);
    settings.capacity_bytes = 20000;
    struct wb_writer *writer = start(bench->path, &settings);
    /* Otherwise its first round may occur between the pushes and report their losses in two parts.
     */
    gate_await(&gate, 1);
    uint64_t refused[2] = {0};
    int64_t first_refused[2] = {-1, -1};
    /* The disk stalls during this time: a push that waits for it would never return. */
    for (int64_t seq = 0; seq < 400; seq++) {
        for (int stream = 0; stream < 2; stream++) {
            bool taken = push(writer, stream, seq);
            if (!taken && first_refused[stream] < 0)
                first_refused[stream] = bench_time(stream, seq);
            refused[stream] += !taken;
        }
        wb_writer_push_event(writer, bench_time(0, seq), "keep", "is never dropped");
    }
    assert_true(refused[0] > 100 && refused[1] > 100);
    assert_int_equal(wb_writer_drops(writer, 0), refused[0]);
    assert_int_equal(wb_writer_drops(writer, 1), refused[1]);
    assert_int_equal(wb_writer_drops(writer, 2), 0);
    assert_int_equal(wb_writer_drops(writer, -1), refused[0] + refused[1]);
    gate_set(&gate, false);
    struct wb_writer_counts counts;
    gate_await_rounds(&gate);
    /* There is space again: the last chunks end the gaps. */
    assert_true(push(writer, 0, 400));
    assert_true(push(writer, 1, 400));
    wb_writer_counts(writer, &counts);
    assert_int_equal(wb_writer_finish(writer), WB_OK);

    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct gaps gaps = {0};
    assert_int_equal(wb_recording_each_chunk(recording, find_gaps, &gaps), WB_OK);
    assert_int_equal(gaps.chunks, counts.chunks);
    assert_int_equal(gaps.missing[0], refused[0]);
    assert_int_equal(gaps.missing[1], refused[1]);
    assert_int_equal(gaps.next[0], 401);
    struct drop_events drops = {0};
    assert_int_equal(wb_recording_each_event(recording, find_drops, &drops), WB_OK);
    assert_int_equal(drops.kept, 400);
    assert_int_equal(drops.n, 2);
    for (int stream = 0; stream < 2; stream++) {
        char expected[64];
        snprintf(expected, sizeof expected, "%s stream (number %d) lost %llu chunks",
                 stream == 0 ? "load" : "mocap", stream, (unsigned long long)refused[stream]);
        bool found = false;
        for (int i = 0; i < 2; i++)
            found |=
                strstr(drops.text[i], expected) != NULL && drops.t_ns[i] == first_refused[stream];
        if (!found)
            fail_msg("no event says '%s'", expected);
    }
    char *value = NULL;
    assert_int_equal(wb_recording_meta(recording, "dropped_chunks", &value), WB_OK);
    assert_int_equal(atoll(value), (long long)(refused[0] + refused[1]));
    free(value);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

static void queue_of_few_entries_drops_by_number(void **state)
{
    struct bench *bench = *state;
    struct gate gate = GATE(true);
    struct wb_writer_settings settings = settings_of(&gate);
    settings.capacity_entries = 10;
    struct wb_writer *writer = start(bench->path, &settings);
    gate_await(&gate, 1);
    int taken = 0;
    for (int64_t i = 0; i < 15; i++)
        taken += wb_writer_push_clock(writer, 1, i, (double)i, 1);
    assert_int_equal(taken, 10);
    assert_false(push(writer, 0, 0));
    struct wb_writer_counts counts;
    wb_writer_counts(writer, &counts);
    assert_int_equal(counts.dropped_probes, 5);
    assert_int_equal(counts.dropped_chunks, 1);
    gate_set(&gate, false);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
}

static void undeclared_stream_is_rejected(void **state)
{
    struct bench *bench = *state;
    struct wb_writer *writer = start(bench->path, NULL);
    assert_false(wb_writer_push_chunk(writer, 3, 1, "x", 1));
    assert_false(wb_writer_push_chunk(writer, -1, 1, "x", 1));
    assert_int_equal(wb_writer_drops(writer, 99), 0);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    assert_int_equal(wb_writer_finish(NULL), WB_OK);
}

static void long_texts_are_truncated(void **state)
{
    struct bench *bench = *state;
    struct wb_writer *writer = start(bench->path, NULL);
    char text[3000];
    memset(text, 'x', sizeof text - 1);
    text[sizeof text - 1] = '\0';
    wb_writer_push_event(writer, 1, "keep", text);
    assert_int_equal(wb_writer_finish(writer), WB_OK);
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_open(&recording, bench->path), WB_OK);
    struct drop_events events = {0};
    assert_int_equal(wb_recording_each_event(recording, find_drops, &events), WB_OK);
    assert_int_equal(events.kept, 1);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
#define FACT(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
        FACT(everything_pushed_is_recorded),
        FACT(flushed_chunks_are_on_disk_while_recording_goes_on),
        FACT(full_queue_drops_counts_and_records_every_chunk_and_no_event),
        FACT(queue_of_few_entries_drops_by_number),
        FACT(undeclared_stream_is_rejected),
        FACT(long_texts_are_truncated),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
