#include "daq/recording/writer.h"
#include "daq/recording/writer_private.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/interrupt.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "writer"

/* Time before a failed write is tried again. */
#define RETRY_NS (200 * WB_NS_PER_MS)

enum entry_kind {
    ENTRY_CHUNK,
    ENTRY_EVENT,
    ENTRY_CLOCK,
    ENTRY_META
};

struct entry {
    struct entry *next;
    enum entry_kind kind;
    int stream;
    int64_t seq, t_ns;
    double t_device;
    int64_t rtt_ns;
    int64_t pushed_ns;
    size_t n;       /* bytes that count against the capacity */
    size_t n_first; /* event, meta: length of the kind or key with its NUL; the text follows */
    uint8_t bytes[];
};

/* Losses of a stream since the last "drop" event. */
struct loss {
    uint64_t chunks, bytes, probes;
    int64_t first_ns, last_ns;
};

struct wb_writer {
    struct wb_recording *recording;
    struct wb_writer_settings settings;
    bool is_synchronous; /* no thread, in virtual time: wb_writer_tick() writes */
    int64_t tried_ns;    /* if synchronous: time of the last write */
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* Protected by the lock. */
    struct entry *first, *last;            /* pushed, not yet taken by the thread */
    size_t waiting_bytes, waiting_entries; /* not yet on the disk */
    int64_t oldest_ns;                     /* when the oldest of these was pushed; 0: none */
    bool finishing;
    int interrupts;         /* number of interrupts when finishing began */
    enum wb_status failing; /* of the last attempt to write */
    enum wb_status status;  /* final status */
    struct loss losses[WB_WRITER_STREAMS];
    uint64_t dropped[WB_WRITER_STREAMS];
    struct wb_writer_counts counts;
    /* Used by the writing thread only: taken, not yet on the disk. */
    struct entry *taken, *last_taken;
    /* Used by the pushing thread only. */
    int64_t next_seq[WB_WRITER_STREAMS];
};

void wb_writer_default_settings(struct wb_writer_settings *settings)
{
    *settings = (struct wb_writer_settings){
        .capacity_bytes = (size_t)64 << 20,
        .capacity_entries = 262144,
        .flush_interval_ns = 100 * WB_NS_PER_MS,
        .patience_ns = 600 * WB_NS_PER_S,
    };
}

/* --- the thread --- */

static const char *role_of(const struct wb_recording *recording, int id)
{
    for (int i = 0; i < wb_recording_n_streams(recording); i++) {
        const struct wb_recording_stream *stream = wb_recording_stream_at(recording, i);
        if (stream->id == id)
            return wb_role_name(stream->role);
    }
    return "unknown";
}

static enum wb_status write_entry(struct wb_recording *recording, const struct entry *entry)
{
    const char *first = (const char *)entry->bytes;
    switch (entry->kind) {
    case ENTRY_CHUNK:
        return wb_recording_append_chunk(recording, entry->stream, entry->seq, entry->t_ns,
                                         entry->bytes, entry->n);
    case ENTRY_EVENT:
        return wb_recording_append_event(recording, entry->t_ns, first, first + entry->n_first);
    case ENTRY_CLOCK:
        return wb_recording_append_clock(recording, entry->stream, entry->t_ns, entry->t_device,
                                         entry->rtt_ns);
    case ENTRY_META:
        return wb_recording_set_meta(recording, first, first + entry->n_first);
    }
    return WB_OK;
}

/* Counts a dropped chunk; requires the lock. */
static void count_dropped(struct wb_writer *writer, const struct entry *entry)
{
    writer->dropped[entry->stream]++;
    writer->counts.dropped_chunks++;
}

/* Makes an entry of two texts, the second truncated to `most`; NULL: out of memory. */
static struct entry *make_texts(enum entry_kind kind, int64_t t_ns, const char *first,
                                const char *second, size_t most)
{
    const size_t n_first = strlen(first), n_second = strnlen(second, most);
    struct entry *const entry = malloc(sizeof *entry + n_first + n_second + 2);
    if (!entry)
        return NULL;
    *entry = (struct entry){
        .kind = kind, .t_ns = t_ns, .n = n_first + n_second + 2, .n_first = n_first + 1};
    memcpy(entry->bytes, first, n_first);
    entry->bytes[n_first] = '\0';
    memcpy(entry->bytes + n_first + 1, second, n_second);
    entry->bytes[n_first + 1 + n_second] = '\0';
    return entry;
}

/* Adds an entry to the waiting counts; requires the lock. */
static void count_waiting(struct wb_writer *writer, struct entry *entry)
{
    entry->pushed_ns = wb_time_now_ns();
    if (writer->oldest_ns == 0)
        writer->oldest_ns = entry->pushed_ns;
    writer->waiting_entries++;
    writer->waiting_bytes += entry->n;
    if (writer->counts.most_waiting_bytes < writer->waiting_bytes)
        writer->counts.most_waiting_bytes = writer->waiting_bytes;
}

/* Appends a list of entries to those that the thread writes. */
static void take(struct wb_writer *writer, struct entry *first, struct entry *last)
{
    if (writer->last_taken)
        writer->last_taken->next = first;
    else
        writer->taken = first;
    writer->last_taken = last;
}

/* Adds a "drop" event for the losses of a stream; requires the lock. */
static void take_loss(struct wb_writer *writer, int stream)
{
    struct loss *const loss = &writer->losses[stream];
    char text[280];
    snprintf(text, sizeof text,
             "the %s stream (number %d) lost %llu chunks of %llu bytes and %llu clock probes from "
             "%.3f s to %.3f s of the host's clock, because the disk was too slow or failed",
             role_of(writer->recording, stream), stream, (unsigned long long)loss->chunks,
             (unsigned long long)loss->bytes, (unsigned long long)loss->probes,
             wb_seconds_from_ns(loss->first_ns), wb_seconds_from_ns(loss->last_ns));
    struct entry *const entry = make_texts(ENTRY_EVENT, loss->first_ns, "drop", text, SIZE_MAX);
    if (!entry)
        return; /* retried in the next round */
    wb_warn("%s", text);
    *loss = (struct loss){0};
    count_waiting(writer, entry);
    take(writer, entry, entry);
}

/* Takes all waiting entries. */
static void take_waiting(struct wb_writer *writer)
{
    pthread_mutex_lock(&writer->lock);
    if (writer->first)
        take(writer, writer->first, writer->last);
    writer->first = writer->last = NULL;
    /* While the disk fails, the losses may still grow. */
    for (int i = 0; i < WB_WRITER_STREAMS && writer->failing == WB_OK; i++) {
        if (writer->losses[i].chunks || writer->losses[i].probes)
            take_loss(writer, i);
    }
    pthread_mutex_unlock(&writer->lock);
}

/* Frees the taken entries, which are on the disk or given up. */
static void release_taken(struct wb_writer *writer, bool is_written)
{
    struct entry *entry = writer->taken;
    writer->taken = writer->last_taken = NULL;
    pthread_mutex_lock(&writer->lock);
    for (struct entry *next; entry; entry = next) {
        next = entry->next;
        writer->waiting_bytes -= entry->n;
        writer->waiting_entries--;
        if (!is_written && entry->kind == ENTRY_CHUNK)
            count_dropped(writer, entry);
        free(entry);
    }
    writer->oldest_ns = writer->first ? writer->first->pushed_ns : 0;
    pthread_mutex_unlock(&writer->lock);
}

/* Writes all waiting entries in one transaction. After a failure they are kept for the next call.
 */
static enum wb_status write_waiting(struct wb_writer *writer)
{
    take_waiting(writer);
    if (writer->settings.before_write)
        writer->settings.before_write(writer->settings.context);
    enum wb_status status = WB_OK;
    for (const struct entry *entry = writer->taken; entry && status == WB_OK; entry = entry->next)
        status = write_entry(writer->recording, entry);
    if (status == WB_OK)
        status = wb_recording_flush(writer->recording);
    if (status == WB_OK)
        release_taken(writer, true);
    pthread_mutex_lock(&writer->lock);
    writer->failing = status;
    pthread_mutex_unlock(&writer->lock);
    return status;
}

/* Whether the queue is full enough to write early; false while the disk fails. Requires the lock.
 */
static bool is_urgent(const struct wb_writer *writer)
{
    return writer->failing == WB_OK &&
           (writer->waiting_bytes >= writer->settings.capacity_bytes / 4 ||
            writer->waiting_entries >= writer->settings.capacity_entries / 4);
}

/* Waits until the next flush is due, the queue fills up or the writer finishes. True: finishing. */
static bool wait_for_work(struct wb_writer *writer, int64_t due_ns)
{
    struct timespec due = {.tv_sec = (time_t)(due_ns / WB_NS_PER_S),
                           .tv_nsec = (long)(due_ns % WB_NS_PER_S)};
    pthread_mutex_lock(&writer->lock);
    while (!writer->finishing && wb_time_now_ns() < due_ns && !is_urgent(writer))
        pthread_cond_timedwait(&writer->wake, &writer->lock, &due);
    bool finishing = writer->finishing;
    pthread_mutex_unlock(&writer->lock);
    return finishing;
}

/* At the end, waits for a failing disk: data in memory would be lost with the process. */
static enum wb_status write_rest(struct wb_writer *writer)
{
    enum wb_status status = write_waiting(writer);
    const int64_t until_ns = wb_time_now_ns() + writer->settings.patience_ns;
    const double kilobytes = (double)writer->waiting_bytes * 1e-3;
    if (status != WB_OK && writer->settings.patience_ns > 0)
        wb_warn("nothing can be written to the disk; %.1f kB of the recording are in memory only: "
                "make room on the disk within %.0f s, or press Ctrl-C to discard them",
                kilobytes, wb_seconds_from_ns(writer->settings.patience_ns));
    while (status != WB_OK && wb_time_now_ns() < until_ns &&
           wb_interrupt_count() == writer->interrupts) {
        wb_time_sleep(wb_time_now_ns() + RETRY_NS);
        status = write_waiting(writer);
    }
    if (status != WB_OK)
        wb_error("the last %.1f kB of the recording are lost; all earlier data are on the disk",
                 kilobytes);
    return status;
}

/* Writes the remaining entries and closes the recording. */
static void end(struct wb_writer *writer)
{
    enum wb_status status = write_rest(writer);
    if (status != WB_OK) {
        release_taken(writer, false);
    } else {
        char text[24];
        snprintf(text, sizeof text, "%llu", (unsigned long long)wb_writer_drops(writer, -1));
        status = wb_recording_set_meta(writer->recording, "dropped_chunks", text);
    }
    const enum wb_status closed = wb_recording_close(writer->recording);
    writer->status = status != WB_OK ? status : closed;
}

static void *run(void *argument)
{
    struct wb_writer *writer = argument;
    bool finishing = false;
    enum wb_status status = WB_OK;
    while (!finishing) {
        const int64_t interval_ns = status != WB_OK ? RETRY_NS : writer->settings.flush_interval_ns;
        finishing = wait_for_work(writer, wb_time_now_ns() + interval_ns);
        if (!finishing)
            status = write_waiting(writer);
    }
    /* Closing is done in this thread, which blocks SIGXFSZ: a file size limit must not end the
     * process before the stage is stopped. */
    end(writer);
    return NULL;
}

void wb_writer_tick(struct wb_writer *writer)
{
    if (!writer->is_synchronous)
        return;
    const int64_t now_ns = wb_time_now_ns();
    const int64_t interval_ns =
        writer->failing != WB_OK ? RETRY_NS : writer->settings.flush_interval_ns;
    if (now_ns - writer->tried_ns < interval_ns && !is_urgent(writer))
        return;
    writer->tried_ns = now_ns;
    (void)write_waiting(writer); /* a failure is stored in the state and retried */
}

/* --- starting and finishing --- */

static enum wb_status start_thread(struct wb_writer *writer)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(&writer->wake, &attributes);
    pthread_condattr_destroy(&attributes);
    pthread_mutex_init(&writer->lock, NULL);
    /* All signals are blocked in this thread: Ctrl-C must wake the poll loop, and SIGXFSZ is turned
     * into an error code. */
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    const int error =
        writer->is_synchronous ? 0 : pthread_create(&writer->thread, NULL, run, writer);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (error == 0)
        return WB_OK;
    pthread_mutex_destroy(&writer->lock);
    pthread_cond_destroy(&writer->wake);
    return wb_fail(WB_ERR_MEMORY, "the writer's thread cannot be started: %s", strerror(error));
}

enum wb_status wb_writer_start(struct wb_writer **out, struct wb_recording *recording,
                               const struct wb_writer_settings *settings)
{
    *out = NULL;
    if (wb_recording_n_streams(recording) > WB_WRITER_STREAMS)
        return wb_fail(WB_ERR_ARGUMENT, "a recording can have at most %d streams",
                       WB_WRITER_STREAMS);
    /* The thread retries only its own entries, not rows that were appended before. */
    WB_TRY(wb_recording_flush(recording));
    struct wb_writer *writer = calloc(1, sizeof *writer);
    if (!writer)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the writer");
    wb_writer_default_settings(&writer->settings);
    if (settings)
        writer->settings = *settings;
    writer->recording = recording;
    writer->is_synchronous = wb_time_is_virtual();
    writer->tried_ns = wb_time_now_ns();
    enum wb_status status = start_thread(writer);
    if (status != WB_OK) {
        free(writer);
        return status;
    }
    *out = writer;
    return WB_OK;
}

enum wb_status wb_writer_finish(struct wb_writer *writer)
{
    if (!writer)
        return WB_OK;
    pthread_mutex_lock(&writer->lock);
    writer->finishing = true;
    writer->interrupts = wb_interrupt_count();
    pthread_cond_signal(&writer->wake);
    pthread_mutex_unlock(&writer->lock);
    if (writer->is_synchronous)
        end(writer);
    else
        pthread_join(writer->thread, NULL);
    enum wb_status status = writer->status;
    pthread_mutex_destroy(&writer->lock);
    pthread_cond_destroy(&writer->wake);
    free(writer);
    return status;
}

/* --- pushing --- */

static bool has_room(const struct wb_writer *writer, size_t n)
{
    return writer->waiting_entries < writer->settings.capacity_entries &&
           writer->waiting_bytes + n <= writer->settings.capacity_bytes;
}

/* Appends an entry and wakes the thread if the queue is long; requires the lock. */
static void append(struct wb_writer *writer, struct entry *entry)
{
    if (writer->last)
        writer->last->next = entry;
    else
        writer->first = entry;
    writer->last = entry;
    count_waiting(writer, entry);
    if (is_urgent(writer))
        pthread_cond_signal(&writer->wake);
}

static void count_loss(struct wb_writer *writer, const struct entry *entry)
{
    struct loss *loss = &writer->losses[entry->stream];
    if (loss->chunks == 0 && loss->probes == 0)
        loss->first_ns = entry->t_ns;
    loss->last_ns = entry->t_ns;
    if (entry->kind == ENTRY_CLOCK) {
        loss->probes++;
        writer->counts.dropped_probes++;
        return;
    }
    loss->chunks++;
    loss->bytes += entry->n;
    count_dropped(writer, entry);
}

static bool known_stream(const struct wb_writer *writer, int stream)
{
    if (stream >= 0 && stream < wb_recording_n_streams(writer->recording))
        return true;
    wb_error("stream %d is not declared; its data are not recorded", stream);
    return false;
}

/* Queues a copy of the entry with its bytes, or counts the loss if the queue is full or memory runs
 * out. */
static bool offer(struct wb_writer *writer, const struct entry *like, const void *bytes)
{
    struct entry *const entry = malloc(sizeof *entry + like->n);
    if (entry) {
        *entry = *like;
        memcpy(entry->bytes, bytes, like->n);
    }
    pthread_mutex_lock(&writer->lock);
    const bool taken = entry && has_room(writer, like->n);
    if (taken && like->kind == ENTRY_CHUNK) {
        writer->counts.chunks++;
        writer->counts.bytes += like->n;
    }
    if (taken)
        append(writer, entry);
    else
        count_loss(writer, like);
    pthread_mutex_unlock(&writer->lock);
    if (!taken)
        free(entry);
    return taken;
}

bool wb_writer_push_chunk(struct wb_writer *writer, int stream, int64_t t_ns, const void *bytes,
                          size_t n)
{
    if (!known_stream(writer, stream))
        return false;
    const struct entry like = {.kind = ENTRY_CHUNK,
                               .stream = stream,
                               .seq = writer->next_seq[stream]++,
                               .t_ns = t_ns,
                               .n = n};
    return offer(writer, &like, n ? bytes : "");
}

bool wb_writer_push_clock(struct wb_writer *writer, int stream, int64_t t_host_ns, double t_device,
                          int64_t rtt_ns)
{
    const struct entry like = {.kind = ENTRY_CLOCK,
                               .stream = stream,
                               .t_ns = t_host_ns,
                               .t_device = t_device,
                               .rtt_ns = rtt_ns};
    return known_stream(writer, stream) && offer(writer, &like, "");
}

/* Queues events and meta values even if the queue is full: they are few and important. */
static void push_texts(struct wb_writer *writer, enum entry_kind kind, int64_t t_ns,
                       const char *first, const char *second, size_t most)
{
    struct entry *const entry = make_texts(kind, t_ns, first, second, most);
    if (!entry) {
        wb_error("out of memory: '%s' is not recorded: %s", first, second);
        return;
    }
    pthread_mutex_lock(&writer->lock);
    append(writer, entry);
    pthread_mutex_unlock(&writer->lock);
}

void wb_writer_push_event(struct wb_writer *writer, int64_t t_ns, const char *kind,
                          const char *text)
{
    char word[sizeof((struct wb_event *)0)->kind];
    snprintf(word, sizeof word, "%s", kind);
    push_texts(writer, ENTRY_EVENT, t_ns, word, text, sizeof((struct wb_event *)0)->text - 1);
}

void wb_writer_push_meta(struct wb_writer *writer, const char *key, const char *value)
{
    push_texts(writer, ENTRY_META, 0, key, value, SIZE_MAX);
}

/* --- queries --- */

/* The lock is not part of the state that const protects. */
static pthread_mutex_t *lock_of(const struct wb_writer *writer)
{
    return (pthread_mutex_t *)&writer->lock;
}

uint64_t wb_writer_drops(const struct wb_writer *writer, int stream)
{
    if (stream >= WB_WRITER_STREAMS)
        return 0;
    pthread_mutex_lock(lock_of(writer));
    uint64_t drops = stream < 0 ? writer->counts.dropped_chunks : writer->dropped[stream];
    pthread_mutex_unlock(lock_of(writer));
    return drops;
}

void wb_writer_state(const struct wb_writer *writer, struct wb_writer_state *state)
{
    pthread_mutex_lock(lock_of(writer));
    const struct wb_writer_settings *const settings = &writer->settings;
    *state = (struct wb_writer_state){
        .failing = writer->failing,
        .lag_ns = writer->oldest_ns > 0 ? wb_time_now_ns() - writer->oldest_ns : 0,
        .fill = fmax((double)writer->waiting_bytes / (double)settings->capacity_bytes,
                     (double)writer->waiting_entries / (double)settings->capacity_entries),
    };
    pthread_mutex_unlock(lock_of(writer));
}

enum wb_status wb_writer_status(const struct wb_writer *writer)
{
    struct wb_writer_state state;
    wb_writer_state(writer, &state);
    return state.fill >= 0.75 ? state.failing : WB_OK;
}

void wb_writer_counts(const struct wb_writer *writer, struct wb_writer_counts *counts)
{
    pthread_mutex_lock(lock_of(writer));
    *counts = writer->counts;
    pthread_mutex_unlock(lock_of(writer));
}
