#include "daq/writer.h"
#include "daq/writer_private.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/progress.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "writer"

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
    size_t n;       /* bytes that count for the capacity */
    size_t n_first; /* event, meta: length of the kind or key with its NUL; the text follows */
    uint8_t bytes[];
};

/* What one stream lost since the last "drop" event. */
struct loss {
    uint64_t chunks, bytes, probes;
    int64_t first_ns, last_ns;
};

struct wb_writer {
    struct wb_recording *recording;
    struct wb_writer_settings settings;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    /* Under the lock. */
    struct entry *first, *last;
    size_t waiting_bytes, waiting_entries;
    bool finishing;
    enum wb_status status;
    struct loss losses[WB_WRITER_STREAMS];
    uint64_t dropped[WB_WRITER_STREAMS];
    struct wb_writer_counts counts;
    /* Of the pushing thread. */
    int64_t next_seq[WB_WRITER_STREAMS];
};

void wb_writer_default_settings(struct wb_writer_settings *settings)
{
    *settings = (struct wb_writer_settings){
        .capacity_bytes = (size_t)64 << 20,
        .capacity_entries = 262144,
        .flush_interval_ns = 100 * WB_NS_PER_MS,
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

static enum wb_status write_loss(struct wb_recording *recording, int stream,
                                 const struct loss *loss)
{
    char text[240];
    snprintf(text, sizeof text,
             "the %s stream (number %d) lost %llu chunks of %llu bytes and %llu clock probes from "
             "%.3f s to %.3f s of the host's clock: the disk was too slow",
             role_of(recording, stream), stream, (unsigned long long)loss->chunks,
             (unsigned long long)loss->bytes, (unsigned long long)loss->probes,
             wb_seconds_from_ns(loss->first_ns), wb_seconds_from_ns(loss->last_ns));
    wb_warn("%s", text);
    return wb_recording_append_event(recording, loss->first_ns, "drop", text);
}

static void latch(struct wb_writer *writer, enum wb_status status)
{
    pthread_mutex_lock(&writer->lock);
    if (writer->status == WB_OK)
        writer->status = status;
    pthread_mutex_unlock(&writer->lock);
}

/* Of a chunk, under the lock. */
static void count_dropped(struct wb_writer *writer, const struct entry *entry)
{
    writer->dropped[entry->stream]++;
    writer->counts.dropped_chunks++;
    writer->counts.dropped_bytes += entry->n;
}

/* Counts an entry that could not be written, or was not even tried after an error. */
static void count_unwritten(struct wb_writer *writer, const struct entry *entry)
{
    if (entry->kind != ENTRY_CHUNK)
        return;
    pthread_mutex_lock(&writer->lock);
    count_dropped(writer, entry);
    pthread_mutex_unlock(&writer->lock);
}

/* Gives the room of one entry back. */
static void release_entry(struct wb_writer *writer, struct entry *entry)
{
    pthread_mutex_lock(&writer->lock);
    writer->waiting_bytes -= entry->n;
    writer->waiting_entries--;
    pthread_mutex_unlock(&writer->lock);
    free(entry);
}

/* Writes a list of entries and what was lost while they waited. */
static enum wb_status write_batch(struct wb_writer *writer, struct entry *entry)
{
    enum wb_status status = wb_writer_status(writer);
    while (entry) {
        struct entry *next = entry->next;
        if (status == WB_OK)
            status = write_entry(writer->recording, entry);
        if (status != WB_OK)
            count_unwritten(writer, entry);
        release_entry(writer, entry);
        entry = next;
    }
    return status;
}

static enum wb_status write_losses(struct wb_writer *writer)
{
    struct loss losses[WB_WRITER_STREAMS];
    pthread_mutex_lock(&writer->lock);
    memcpy(losses, writer->losses, sizeof losses);
    memset(writer->losses, 0, sizeof writer->losses);
    pthread_mutex_unlock(&writer->lock);
    enum wb_status status = wb_writer_status(writer);
    for (int i = 0; i < WB_WRITER_STREAMS && status == WB_OK; i++) {
        if (losses[i].chunks || losses[i].probes)
            status = write_loss(writer->recording, i, &losses[i]);
    }
    return status;
}

/* One round: everything that waits now, in one transaction. */
static void write_waiting(struct wb_writer *writer)
{
    pthread_mutex_lock(&writer->lock);
    struct entry *batch = writer->first;
    writer->first = writer->last = NULL;
    pthread_mutex_unlock(&writer->lock);
    if (writer->settings.before_write)
        writer->settings.before_write(writer->settings.context);
    enum wb_status status = write_batch(writer, batch);
    if (status == WB_OK)
        status = write_losses(writer);
    if (status == WB_OK)
        status = wb_recording_flush(writer->recording);
    if (status != WB_OK)
        latch(writer, status);
}

/* Waits for the next flush, or earlier when the queue fills or ends. True when finishing. */
static bool wait_for_work(struct wb_writer *writer, int64_t due_ns)
{
    struct timespec due = {.tv_sec = (time_t)(due_ns / WB_NS_PER_S),
                           .tv_nsec = (long)(due_ns % WB_NS_PER_S)};
    pthread_mutex_lock(&writer->lock);
    while (!writer->finishing && wb_progress_now_ns() < due_ns &&
           writer->waiting_bytes < writer->settings.capacity_bytes / 4 &&
           writer->waiting_entries < writer->settings.capacity_entries / 4)
        pthread_cond_timedwait(&writer->wake, &writer->lock, &due);
    bool finishing = writer->finishing;
    pthread_mutex_unlock(&writer->lock);
    return finishing;
}

static void *run(void *argument)
{
    struct wb_writer *writer = argument;
    bool finishing = false;
    while (!finishing) {
        int64_t due_ns = wb_progress_now_ns() + writer->settings.flush_interval_ns;
        finishing = wait_for_work(writer, due_ns);
        write_waiting(writer);
    }
    /* A full disk must not end the process before the stage is stopped: the signal is blocked in
     * this thread, so closing belongs here too. */
    if (wb_writer_status(writer) == WB_OK) {
        char text[24];
        snprintf(text, sizeof text, "%llu", (unsigned long long)wb_writer_drops(writer, -1));
        enum wb_status status = wb_recording_set_meta(writer->recording, "dropped_chunks", text);
        if (status != WB_OK)
            latch(writer, status);
    }
    enum wb_status status = wb_recording_close(writer->recording);
    if (status != WB_OK)
        latch(writer, status);
    return NULL;
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
    /* Ctrl-C wakes the poll loop, not this thread; "file too large" becomes an error code. */
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int error = pthread_create(&writer->thread, NULL, run, writer);
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
        return wb_fail(WB_ERR_ARGUMENT, "a recording takes at most %d streams", WB_WRITER_STREAMS);
    struct wb_writer *writer = calloc(1, sizeof *writer);
    if (!writer)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the writer");
    wb_writer_default_settings(&writer->settings);
    if (settings)
        writer->settings = *settings;
    writer->recording = recording;
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
    pthread_cond_signal(&writer->wake);
    pthread_mutex_unlock(&writer->lock);
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
    return writer->status == WB_OK && writer->waiting_entries < writer->settings.capacity_entries &&
           writer->waiting_bytes + n <= writer->settings.capacity_bytes;
}

/* Appends under the lock; the thread is woken when the queue gets long. */
static void append(struct wb_writer *writer, struct entry *entry)
{
    if (writer->last)
        writer->last->next = entry;
    else
        writer->first = entry;
    writer->last = entry;
    writer->waiting_entries++;
    writer->waiting_bytes += entry->n;
    if (writer->counts.most_waiting_bytes < writer->waiting_bytes)
        writer->counts.most_waiting_bytes = writer->waiting_bytes;
    if (writer->waiting_bytes >= writer->settings.capacity_bytes / 4 ||
        writer->waiting_entries >= writer->settings.capacity_entries / 4)
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
    wb_error("stream %d was not declared; its bytes are not recorded", stream);
    return false;
}

/* Takes the entry, or frees it and counts what is lost of its stream. `entry` is NULL when there
 * was no memory for it; `like` says what it would have been. */
static bool offer(struct wb_writer *writer, struct entry *entry, const struct entry *like)
{
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
    struct entry *entry = malloc(sizeof *entry + n);
    if (entry)
        *entry = like;
    if (entry && n)
        memcpy(entry->bytes, bytes, n);
    return offer(writer, entry, &like);
}

bool wb_writer_push_clock(struct wb_writer *writer, int stream, int64_t t_host_ns, double t_device,
                          int64_t rtt_ns)
{
    if (!known_stream(writer, stream))
        return false;
    const struct entry like = {.kind = ENTRY_CLOCK,
                               .stream = stream,
                               .t_ns = t_host_ns,
                               .t_device = t_device,
                               .rtt_ns = rtt_ns};
    struct entry *entry = malloc(sizeof *entry);
    if (entry)
        *entry = like;
    return offer(writer, entry, &like);
}

/* Two texts in one entry, the second cut to `most`, beyond the limits: there are few of them and
 * each one matters. */
static void push_texts(struct wb_writer *writer, enum entry_kind kind, int64_t t_ns,
                       const char *first, const char *second, size_t most)
{
    const size_t n_first = strlen(first), n_second = strnlen(second, most);
    struct entry *entry = malloc(sizeof *entry + n_first + n_second + 2);
    if (!entry) {
        wb_error("out of memory: '%s' is not recorded: %s", first, second);
        return;
    }
    *entry = (struct entry){
        .kind = kind, .t_ns = t_ns, .n = n_first + n_second + 2, .n_first = n_first + 1};
    memcpy(entry->bytes, first, n_first);
    entry->bytes[n_first] = '\0';
    memcpy(entry->bytes + n_first + 1, second, n_second);
    entry->bytes[n_first + 1 + n_second] = '\0';
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

/* --- asking --- */

/* The lock is no part of what const promises. */
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

enum wb_status wb_writer_status(const struct wb_writer *writer)
{
    pthread_mutex_lock(lock_of(writer));
    enum wb_status status = writer->status;
    pthread_mutex_unlock(lock_of(writer));
    return status;
}

void wb_writer_counts(const struct wb_writer *writer, struct wb_writer_counts *counts)
{
    pthread_mutex_lock(lock_of(writer));
    *counts = writer->counts;
    pthread_mutex_unlock(lock_of(writer));
}
