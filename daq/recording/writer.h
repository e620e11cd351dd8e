/* The writer: a bounded queue and one thread, so that a stalling disk never blocks the poll loop.
 *
 * The loop pushes chunks, events, clock probes and meta values; a push copies them, takes
 * microseconds and never waits for the disk. The thread writes them to the recording in order and
 * flushes every `flush_interval_ns`. When the queue is full a chunk or clock probe is dropped and
 * counted; as soon as there is room an event of kind "drop" says how many were lost, of which
 * stream and between which times. Sequence numbers are counted in here and also advance for
 * dropped chunks, so a drop shows as a gap. Events and meta values are never dropped for want of
 * room: they pass the limits.
 *
 * What was pushed stays in memory until it is flushed. When a write or a flush fails (a full disk,
 * a cable), the thread tries all of it again, five times a second, until the disk takes it: nothing
 * is lost as long as the memory lasts. wb_writer_state() tells the loop how far the disk is behind.
 * A sync that failed is not believed to have kept anything: what it was for is written anew.
 *
 * One thread pushes, asks and finishes; the recording belongs to the writer from start to finish.
 */
#ifndef WB_DAQ_RECORDING_WRITER_H
#define WB_DAQ_RECORDING_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/recording/recording.h"

struct wb_writer; /* opaque */

/* Streams of one recording that a writer can count: ids 0 to WB_WRITER_STREAMS - 1. */
#define WB_WRITER_STREAMS 16

struct wb_writer_settings {
    size_t capacity_bytes;     /* payload bytes that may wait; default 64 MiB */
    size_t capacity_entries;   /* entries that may wait; default 262144 */
    int64_t flush_interval_ns; /* a transaction is committed so often; default 100 ms */
    int64_t patience_ns; /* how long finishing waits for a disk that takes nothing; default 10 min.
                            Ctrl-C ends the wait too */
    void (*before_write)(void *context); /* called by the thread before each batch is written, for
                                            tests that stall it; NULL (default) for none */
    void *context;
};

struct wb_writer_counts {
    uint64_t chunks, bytes; /* accepted */
    uint64_t dropped_chunks, dropped_bytes, dropped_probes;
    uint64_t most_waiting_bytes; /* the fullest the queue has been */
};

/* Flushes what the recording has and starts the thread. `settings` may be NULL for the defaults. On
 * success the recording (created, with its streams declared) belongs to the writer; on failure it
 * stays the caller's. */
WB_MUST_CHECK enum wb_status wb_writer_start(struct wb_writer **out, struct wb_recording *recording,
                                             const struct wb_writer_settings *settings);

/* One read or datagram of a stream, as it came. False when it was dropped (and counted). */
bool wb_writer_push_chunk(struct wb_writer *writer, int stream, int64_t t_ns, const void *bytes,
                          size_t n);

/* An event; kind and text are cut to the sizes of struct wb_event. */
void wb_writer_push_event(struct wb_writer *writer, int64_t t_ns, const char *kind,
                          const char *text);

/* A meta value known only after the recording began; a later value of a key replaces it. */
void wb_writer_push_meta(struct wb_writer *writer, const char *key, const char *value);

/* A clock probe: the device read t_device (s) at t_host_ns, give or take rtt_ns / 2. False when it
 * was dropped (and counted). */
bool wb_writer_push_clock(struct wb_writer *writer, int stream, int64_t t_host_ns, double t_device,
                          int64_t rtt_ns);

/* Chunks of one stream dropped so far; of all streams with stream < 0. */
uint64_t wb_writer_drops(const struct wb_writer *writer, int stream);

/* How far the disk is behind. */
struct wb_writer_state {
    enum wb_status failing; /* why the last try failed; WB_OK: it did not */
    int64_t lag_ns; /* age of the oldest that was pushed and is not on the disk; 0: all is */
    double fill;    /* of the memory for what waits, 0 to 1 */
};
void wb_writer_state(const struct wb_writer *writer, struct wb_writer_state *state);

/* WB_OK as long as all that comes can be kept. Else why the disk takes nothing: three quarters of
 * the memory are full, and the test is to be ended. */
WB_MUST_CHECK enum wb_status wb_writer_status(const struct wb_writer *writer);

/* The loop calls it in each step. In virtual time (base/timing.h), in which a thread would make
 * results depend on the machine, it writes what is due; otherwise it does nothing. */
void wb_writer_tick(struct wb_writer *writer);

/* Writes what waits, ends the thread, closes the recording and frees the writer. Where the disk
 * takes nothing, that is told, and it waits. WB_OK when the recording holds all that was accepted,
 * also after a disk that failed for a while. Accepts NULL (WB_OK). */
WB_MUST_CHECK enum wb_status wb_writer_finish(struct wb_writer *writer);

#endif
