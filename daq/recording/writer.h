/* The writer: a bounded queue and one thread, so that a stalling disk never blocks the poll loop.
 *
 * The loop pushes chunks, events, clock probes and meta values; a push copies them, takes
 * microseconds and never waits for the disk. The thread writes them to the recording in order and
 * flushes every `flush_interval_ns`. If the queue is full, chunks and clock probes are dropped and
 * counted; as soon as there is space, an event of kind "drop" records their number, stream and time
 * range. The writer assigns sequence numbers, also to dropped chunks, so that a drop is visible as
 * a gap. Events and meta values are queued even if the queue is full.
 *
 * Entries stay in memory until they are flushed. If a write or flush fails (disk full, cable
 * unplugged), the thread retries all of them five times a second until it succeeds: nothing is lost
 * while the queue has space. After a failed sync, the data of that sync are written again.
 * wb_writer_state() reports how far the disk lags behind.
 *
 * All functions must be called by one thread; the recording belongs to the writer until it
 * finishes.
 */
#ifndef WB_DAQ_RECORDING_WRITER_H
#define WB_DAQ_RECORDING_WRITER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/recording/recording.h"

struct wb_writer; /* opaque */

/* Largest number of streams in a recording; their ids are 0 to WB_WRITER_STREAMS - 1. */
#define WB_WRITER_STREAMS 16

struct wb_writer_settings {
    size_t capacity_bytes;     /* largest payload in the queue; default 64 MiB */
    size_t capacity_entries;   /* most entries in the queue; default 262144 */
    int64_t flush_interval_ns; /* period of the flushes; default 100 ms */
    int64_t patience_ns; /* longest wait of wb_writer_finish() for a failing disk; default 10 min.
                            Ctrl-C ends the wait */
    void (*before_write)(void *context); /* called by the thread before each batch, so that tests
                                            can stall it; NULL (default): none */
    void *context;
};

struct wb_writer_counts {
    uint64_t chunks, bytes; /* accepted into the queue */
    uint64_t dropped_chunks, dropped_probes;
    uint64_t most_waiting_bytes; /* largest size of the queue so far */
};

/* Flushes the recording and starts the thread. `settings` NULL: the defaults. On success the
 * recording (created, with its streams declared) belongs to the writer; on failure it remains the
 * caller's. */
WB_MUST_CHECK enum wb_status wb_writer_start(struct wb_writer **out, struct wb_recording *recording,
                                             const struct wb_writer_settings *settings);

/* Pushes one read or datagram of a stream. False: it was dropped and counted. */
bool wb_writer_push_chunk(struct wb_writer *writer, int stream, int64_t t_ns, const void *bytes,
                          size_t n);

/* Pushes an event; kind and text are truncated to the sizes of struct wb_event. */
void wb_writer_push_event(struct wb_writer *writer, int64_t t_ns, const char *kind,
                          const char *text);

/* Pushes a meta value; a later value of the same key replaces it. */
void wb_writer_push_meta(struct wb_writer *writer, const char *key, const char *value);

/* Pushes a clock probe: the device's clock was t_device (s) at t_host_ns +- rtt_ns / 2. False: it
 * was dropped and counted. */
bool wb_writer_push_clock(struct wb_writer *writer, int stream, int64_t t_host_ns, double t_device,
                          int64_t rtt_ns);

/* Number of chunks of a stream dropped so far; stream < 0: of all streams. */
uint64_t wb_writer_drops(const struct wb_writer *writer, int stream);

/* State of the disk and the queue. */
struct wb_writer_state {
    enum wb_status failing; /* status of the last attempt to write */
    int64_t lag_ns;         /* age of the oldest entry that is not on the disk; 0: none */
    double fill;            /* used fraction of the queue, 0 to 1 */
};
void wb_writer_state(const struct wb_writer *writer, struct wb_writer_state *state);

/* WB_OK, or the status of the failing disk once three quarters of the queue are used: the caller
 * should then end the test. */
WB_MUST_CHECK enum wb_status wb_writer_status(const struct wb_writer *writer);

/* Must be called in each step of the loop. In virtual time (base/timing.h) the writer has no
 * thread, so that results do not depend on the machine; this function then writes the entries that
 * are due. Otherwise it does nothing. */
void wb_writer_tick(struct wb_writer *writer);

/* Writes all waiting entries, ends the thread, closes the recording and frees the writer. If the
 * disk fails, warns and waits up to patience_ns. WB_OK: the recording contains all accepted
 * entries, even after a temporary failure of the disk. Accepts NULL (WB_OK). */
WB_MUST_CHECK enum wb_status wb_writer_finish(struct wb_writer *writer);

#endif
