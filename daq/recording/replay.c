#include "daq/recording/replay.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/interrupt.h"
#include "base/memory.h"
#include "base/timing.h"
#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "daq/recording/foreign.h"
#include "daq/recording/recording_foreign.h"
#include "daq/stream/stream.h"

#define WB_LOG_DOMAIN "replay"

/* A file of another program, assembled from its pieces. */
struct file {
    struct wb_foreign foreign;
    uint8_t *bytes; /* (foreign.size) owned */
    size_t n;
    bool lost; /* a piece is missing: the file cannot be read */
};

/* A recorded stream with the driver that decodes it, or with the file it contains; both NULL: the
 * stream is skipped. */
struct channel {
    int id;
    const struct wb_driver *driver;
    void *state;
    struct wb_stream *stream;
    int64_t next_seq; /* expected number of the next chunk; -1: a chunk is missing */
    struct file *file;
};

struct replay {
    const struct wb_rig *rig;
    const struct wb_sink *sink;
    struct wb_sink counting; /* counts samples and passes them to the sink */
    struct wb_replay_counts *counts;
    struct channel *channels;
    int n_channels;
    double rate;
    int64_t first_ns, started_ns; /* time of the first chunk, and when it was replayed */
    bool interrupted;
    uint8_t *buffer;
};

/* --- counting samples --- */

static void pass_load(void *context, const struct wb_load_sample *sample)
{
    struct replay *replay = context;
    replay->counts->load_samples++;
    if (replay->sink->load)
        replay->sink->load(replay->sink->context, sample);
}

static void pass_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct replay *replay = context;
    replay->counts->mocap_frames++;
    if (replay->sink->mocap)
        replay->sink->mocap(replay->sink->context, frame);
}

static void pass_stage(void *context, const struct wb_stage_report *report)
{
    struct replay *replay = context;
    replay->counts->stage_reports++;
    if (replay->sink->stage)
        replay->sink->stage(replay->sink->context, report);
}

static void pass_probe(void *context, const struct wb_clock_probe *probe)
{
    struct replay *replay = context;
    if (replay->sink->probe)
        replay->sink->probe(replay->sink->context, probe);
}

static void pass_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    struct replay *replay = context;
    if (replay->sink->remark)
        replay->sink->remark(replay->sink->context, level, t_ns, kind, text);
}

/* --- channels --- */

static void open_file(struct channel *channel, const char *settings)
{
    channel->file = wb_memory_new(1, sizeof *channel->file);
    struct wb_reason why = {.text = ""};
    if (wb_foreign_parse(&channel->file->foreign, settings, &why) != WB_OK) {
        wb_warn("stream %d is skipped: %s", channel->id, why.text);
        channel->file->lost = true;
    }
}

static enum wb_status open_channel(struct channel *channel,
                                   const struct wb_recording_stream *recorded, const char *settings,
                                   const struct wb_rig *rig)
{
    channel->id = recorded->id;
    if (wb_recording_foreign_is(recorded)) {
        open_file(channel, settings);
        return WB_OK;
    }
    const struct wb_driver *driver = wb_drivers_find(recorded->role, recorded->protocol);
    if (!driver) {
        wb_warn("stream %d (%s) is skipped: unknown protocol '%s'", recorded->id,
                wb_role_name(recorded->role), recorded->protocol);
        return WB_OK;
    }
    WB_TRY(wb_stream_open(&channel->stream, "memory:"));
    channel->state = wb_memory_new(1, driver->state_size);
    WB_TRY(driver->init(channel->state, rig));
    channel->driver = driver;
    return WB_OK;
}

static enum wb_status open_channels(struct replay *replay, struct wb_recording *recording,
                                    const struct wb_rig *rig)
{
    int n = wb_recording_n_streams(recording);
    replay->channels = wb_memory_new((size_t)n, sizeof *replay->channels);
    replay->buffer = wb_memory_new(WB_STREAM_READ_MAX, 1);
    replay->n_channels = n;
    for (int i = 0; i < n; i++)
        WB_TRY(open_channel(&replay->channels[i], wb_recording_stream_at(recording, i),
                            wb_recording_stream_settings(recording, i), rig));
    return WB_OK;
}

static void close_channels(struct replay *replay)
{
    for (int i = 0; i < replay->n_channels; i++) {
        free(replay->channels[i].state);
        wb_stream_close(replay->channels[i].stream);
        if (replay->channels[i].file)
            free(replay->channels[i].file->bytes);
        free(replay->channels[i].file);
    }
    free(replay->channels);
    free(replay->buffer);
}

static struct channel *find_channel(struct replay *replay, int id)
{
    for (int i = 0; i < replay->n_channels; i++) {
        if (replay->channels[i].id == id)
            return &replay->channels[i];
    }
    return NULL;
}

/* --- playing --- */

/* Sleeps until the chunk is due; false if interrupted. A gap caused by a damaged time stamp is
 * waited for like any other; Ctrl-C ends it. */
static bool wait_until_due(struct replay *replay, int64_t t_ns)
{
    if (wb_interrupted())
        return false;
    if (!(replay->rate > 0.0))
        return true;
    if (replay->started_ns == 0) {
        replay->first_ns = t_ns;
        replay->started_ns = wb_time_now_ns();
    }
    /* Chunks are ordered by time: the difference is not negative. */
    double wait_s = (double)((uint64_t)t_ns - (uint64_t)replay->first_ns) * 1e-9 / replay->rate;
    int64_t due_ns = replay->started_ns + wb_ns_from_seconds(wait_s < 1e9 ? wait_s : 1e9);
    while (wb_time_now_ns() < due_ns && !wb_interrupted())
        wb_time_sleep(due_ns);
    return !wb_interrupted();
}

static void remark_damage(struct replay *replay, const struct wb_chunk *chunk)
{
    replay->counts->damaged_chunks++;
    wb_driver_remark(replay->sink, WB_LOG_WARNING, chunk->t_ns, "damage",
                     "chunk %lld of stream %d is damaged and skipped", (long long)chunk->seq,
                     chunk->stream);
}

static void lose_file(struct replay *replay, struct file *file, int64_t t_ns, const char *reason)
{
    char text[1200];
    if (!file->lost) {
        snprintf(text, sizeof text, "the file '%s' cannot be read: %s", file->foreign.name, reason);
        wb_warn("%s", text);
        pass_remark(replay, WB_LOG_WARNING, t_ns, "damage", text);
    }
    file->lost = true;
}

/* Reports files whose last piece is missing. */
static void lose_unfinished(struct replay *replay)
{
    for (int i = 0; i < replay->n_channels; i++) {
        struct file *const file = replay->channels[i].file;
        if (file && !file->lost) {
            replay->counts->damaged_chunks++;
            lose_file(replay, file, 0, "some of its pieces are missing");
        }
    }
}

/* Adds a piece; after the last one the file is decoded. */
static enum wb_status play_piece(struct replay *replay, struct file *file,
                                 const struct wb_chunk *chunk)
{
    char sha256[WB_SHA256_TEXT];
    struct wb_reason why = {.text = ""};
    if (file->lost)
        return WB_OK;
    if (!file->bytes) /* allocated with the first piece, not for a file without pieces */
        file->bytes = malloc(file->foreign.size + 1);
    if (!file->bytes)
        return wb_fail(WB_ERR_MEMORY, "out of memory for the file '%s'", file->foreign.name);
    if (wb_recording_foreign_unpack(chunk->bytes, chunk->n, file->bytes, &file->n,
                                    file->foreign.size) != WB_OK) {
        replay->counts->damaged_chunks++;
        lose_file(replay, file, chunk->t_ns, "a piece of it is damaged");
        return WB_OK;
    }
    if (file->n < file->foreign.size)
        return WB_OK;
    wb_hash_bytes(file->bytes, file->n, sha256);
    if (strcmp(sha256, file->foreign.sha256) != 0) {
        replay->counts->damaged_chunks++;
        lose_file(replay, file, chunk->t_ns, "its SHA-256 differs from that of the imported file");
        return WB_OK;
    }
    const enum wb_status status =
        wb_foreign_play(&file->foreign, file->bytes, replay->rig, &replay->counting, &why);
    if (status != WB_OK)
        lose_file(replay, file, chunk->t_ns, why.text);
    free(file->bytes);
    file->bytes = NULL;
    file->lost = true; /* complete: ignore further pieces */
    return WB_OK;
}

static enum wb_status play_chunk(void *context, const struct wb_chunk *chunk)
{
    struct replay *replay = context;
    /* The time of a damaged chunk is not reliable: do not wait for it. */
    if (chunk->intact && !wait_until_due(replay, chunk->t_ns)) {
        replay->interrupted = true;
        return WB_ERR_TIMEOUT; /* ends the walk; wb_replay_run() turns it into WB_OK */
    }
    replay->counts->chunks++;
    replay->counts->bytes += chunk->n;
    struct channel *channel = find_channel(replay, chunk->stream);
    if (!chunk->intact) {
        remark_damage(replay, chunk);
        if (channel && channel->file)
            lose_file(replay, channel->file, chunk->t_ns, "a piece of it is damaged");
        return WB_OK;
    }
    if (channel && channel->file)
        return play_piece(replay, channel->file, chunk);
    if (!channel || !channel->driver)
        return WB_OK;
    /* After a gap, drivers must discard an incomplete line: it would be joined to the next one. */
    if (chunk->n == 0 || chunk->seq != channel->next_seq)
        channel->driver->receive(channel->state, chunk->t_ns, NULL, 0, &replay->counting);
    channel->next_seq = chunk->seq + 1;
    if (chunk->n == 0)
        return WB_OK;
    WB_TRY(wb_stream_memory_push(channel->stream, chunk->bytes, chunk->n));
    for (;;) {
        size_t n = 0;
        WB_TRY(wb_stream_read(channel->stream, replay->buffer, WB_STREAM_READ_MAX, &n));
        if (n == 0)
            return WB_OK;
        channel->driver->receive(channel->state, chunk->t_ns, replay->buffer, n, &replay->counting);
    }
}

enum wb_status wb_replay_run(struct wb_recording *recording, const struct wb_rig *rig,
                             const struct wb_sink *sink, double rate,
                             struct wb_replay_counts *counts)
{
    struct wb_replay_counts counted = {0};
    struct replay replay = {.rig = rig, .sink = sink, .rate = rate, .counts = &counted};
    replay.counting = (struct wb_sink){.context = &replay,
                                       .load = pass_load,
                                       .mocap = pass_mocap,
                                       .stage = pass_stage,
                                       .probe = pass_probe,
                                       .remark = pass_remark};
    enum wb_status status = open_channels(&replay, recording, rig);
    if (status == WB_OK)
        status = wb_recording_each_chunk(recording, play_chunk, &replay);
    if (replay.interrupted)
        status = WB_OK;
    else
        lose_unfinished(&replay);
    close_channels(&replay);
    *counts = counted;
    return status;
}

enum wb_status wb_replay_rig(struct wb_recording *recording, struct wb_rig *rig)
{
    char *text = NULL;
    enum wb_status status = wb_recording_meta(recording, "rig", &text);
    if (status == WB_ERR_NOT_FOUND)
        return wb_fail(WB_ERR_DATA,
                       "the recording contains no rig file: without it the bytes cannot "
                       "be decoded");
    WB_TRY(status);
    status = wb_rig_parse(text, "the recording's rig", rig, NULL);
    free(text);
    return status;
}
