/* Common part of the tests of recordings: a folder of their own, stored log messages, and a small
 * recording with known contents. */
#ifndef WB_TESTS_DAQ_RECORDING_FIXTURE_H
#define WB_TESTS_DAQ_RECORDING_FIXTURE_H

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/log.h"
#include "daq/recording/recording.h"
#include "tests/check.h"
#include "tests/folder.h"

struct bench {
    char folder[64];
    char path[96];      /* where a recording may be made */
    char message[1024]; /* the last one logged */
    int messages;       /* how many */
};

static inline void bench_log(void *context, enum wb_log_level level, const char *domain,
                             const char *message)
{
    struct bench *bench = context;
    (void)level;
    (void)domain;
    snprintf(bench->message, sizeof bench->message, "%s", message);
    bench->messages++;
}

static inline int bench_set_up(void **state)
{
    struct bench *bench = calloc(1, sizeof *bench);
    if (!temporary_folder_make(bench->folder))
        return -1;
    snprintf(bench->path, sizeof bench->path, "%s/test.wbr", bench->folder);
    wb_log_set_sink(bench_log, bench);
    *state = bench;
    return 0;
}

static inline int bench_tear_down(void **state)
{
    struct bench *bench = *state;
    wb_log_set_sink(NULL, NULL);
    const int code = temporary_folder_remove(bench->folder);
    free(bench);
    return code;
}

/* The bytes of chunk `seq` of a stream: any length from 0 to 299, any content. */
static inline size_t bench_bytes(int stream, int64_t seq, uint8_t bytes[300])
{
    size_t n = (size_t)((seq * 37 + stream * 11) % 300);
    for (size_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)(seq * 31 + stream * 7 + (int64_t)(i * i));
    return n;
}

/* Time of chunk `seq`: the streams' chunks interleave. */
static inline int64_t bench_time(int stream, int64_t seq)
{
    return INT64_C(1000000000000) + seq * 12500000 + stream * 1000;
}

/* Declares the three streams and writes `n` chunks of each, flushed every 50. */
static inline void bench_fill(struct wb_recording *recording, int64_t n)
{
    static const struct {
        enum wb_role role;
        const char *address, *protocol, *settings;
    } streams[] = {
        {WB_ROLE_LOAD, "pty:/dev/pts/1", "generic", "unit: g"},
        {WB_ROLE_MOCAP, "udp:127.0.0.1:1510", "natnet", ""},
        {WB_ROLE_STAGE, "pty:/dev/pts/2", "grbl", "axis: X"},
    };
    for (int i = 0; i < 3; i++) {
        int id = -1;
        assert_int_equal(wb_recording_add_stream(recording, streams[i].role, streams[i].address,
                                                 streams[i].protocol, streams[i].settings, &id),
                         WB_OK);
        assert_int_equal(id, i);
    }
    assert_int_equal(wb_recording_set_meta(recording, "operator", "A. Tester"), WB_OK);
    assert_int_equal(wb_recording_append_event(recording, bench_time(0, 0), "tare", "0.5 mN"),
                     WB_OK);
    for (int64_t seq = 0; seq < n; seq++) {
        for (int stream = 0; stream < 3; stream++) {
            uint8_t bytes[300];
            size_t size = bench_bytes(stream, seq, bytes);
            assert_int_equal(wb_recording_append_chunk(recording, stream, seq,
                                                       bench_time(stream, seq), bytes, size),
                             WB_OK);
        }
        if (seq % 50 == 49)
            assert_int_equal(wb_recording_flush(recording), WB_OK);
    }
    assert_int_equal(wb_recording_append_clock(recording, 1, bench_time(1, 0), 12.5, 870000),
                     WB_OK);
    assert_int_equal(wb_recording_flush(recording), WB_OK);
}

static inline void bench_make(const char *path, int64_t n)
{
    struct wb_recording *recording = NULL;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    bench_fill(recording, n);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

/* Result of a walk. */
struct bench_tally {
    int64_t chunks, damaged, missing, next[3];
    int64_t last_ns;
    bool exact; /* every intact chunk was as written, and in order */
};

static inline enum wb_status bench_count(void *context, const struct wb_chunk *chunk)
{
    struct bench_tally *tally = context;
    uint8_t bytes[300];
    tally->chunks++;
    if (!chunk->intact) {
        tally->damaged++;
        return WB_OK;
    }
    if (chunk->stream < 0 || chunk->stream >= 3 || chunk->seq < tally->next[chunk->stream] ||
        chunk->t_ns != bench_time(chunk->stream, chunk->seq) || chunk->t_ns < tally->last_ns ||
        chunk->n != bench_bytes(chunk->stream, chunk->seq, bytes) ||
        memcmp(bytes, chunk->bytes, chunk->n) != 0) {
        tally->exact = false;
    } else {
        tally->missing += chunk->seq - tally->next[chunk->stream];
        tally->next[chunk->stream] = chunk->seq + 1;
    }
    tally->last_ns = chunk->t_ns;
    return WB_OK;
}

static inline enum wb_status bench_walk(struct wb_recording *recording, struct bench_tally *tally)
{
    *tally = (struct bench_tally){.exact = true};
    return wb_recording_each_chunk(recording, bench_count, tally);
}

static inline void bench_copy(const char *from, const char *to)
{
    char command[512];
    snprintf(command, sizeof command, "cp %s %s", from, to);
    assert_int_equal(system(command), 0);
}

static inline bool bench_exists(const char *folder, const char *name)
{
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return access(path, F_OK) == 0;
}

/* Opens a recording that holds this many chunks, all as they were made. */
static inline struct wb_recording *bench_open(const char *path, bool complete, int64_t n_chunks)
{
    struct wb_recording *recording = NULL;
    struct bench_tally tally;
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_recording_is_complete(recording), complete);
    assert_int_equal(bench_walk(recording, &tally), WB_OK);
    assert_int_equal(tally.chunks, n_chunks);
    assert_int_equal(tally.missing, 0);
    assert_true(tally.exact);
    return recording;
}

#endif
