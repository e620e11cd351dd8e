/* Recordings of the library. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/units.h"
#include "daq/recording/replay.h"
#include "daq/recording/sample_columns.h"
#include "daq/recording/survey.h"
#include "library/call.h"

#define WB_LOG_DOMAIN "library"

enum {
    PROBLEM_SIZE = 256
};

struct meta {
    char *key, *value;
};

struct wirebench_recording {
    struct wb_recording *recording;
    char *path;
    struct wb_memory memory; /* of the texts */
    int n_meta;
    struct meta *meta; /* (n_meta) owned */
    bool is_surveyed;
    struct wb_survey survey;
    char sha256[WB_SHA256_TEXT];
    int n_problems;
    char (*problems)[PROBLEM_SIZE]; /* (n_problems) owned */
    bool is_decoded;
    char why[1024]; /* what was left out; "" */
    struct wirebench_table tables[WB_SAMPLE_COLUMNS_TABLES];
};

static enum wb_status keep_meta(void *context, const char *key, const char *value)
{
    struct wirebench_recording *const recording = context;
    recording->meta =
        wb_memory_resize(recording->meta, (size_t)recording->n_meta + 1, sizeof *recording->meta);
    struct meta *const meta = &recording->meta[recording->n_meta++];
    meta->key = wb_memory_keep(&recording->memory, wb_memory_text(key));
    meta->value = wb_memory_keep(&recording->memory, wb_memory_text(value));
    return WB_OK;
}

static enum wb_status open_recording(struct wirebench_recording *recording, const char *path)
{
    recording->path = wb_memory_keep(&recording->memory, wb_memory_text(path));
    WB_TRY(wb_recording_open(&recording->recording, path));
    const enum wb_status status =
        wb_recording_each_meta(recording->recording, keep_meta, recording);
    /* The readable part of a damaged recording is used; wirebench_recording_describe() reports the
     * damage. */
    return status == WB_ERR_DATA ? WB_OK : status;
}

enum wirebench_status wirebench_recording_open(struct wirebench_recording **out, const char *path)
{
    wb_call_begin();
    if (wb_call_need(out, "out") != WB_OK || wb_call_need(path, "path") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    struct wirebench_recording *const recording = wb_memory_new(1, sizeof *recording);
    const enum wb_status status = open_recording(recording, path);
    if (status == WB_OK)
        *out = recording;
    else
        wirebench_recording_close(recording);
    return wb_call_end(status);
}

void wirebench_recording_close(struct wirebench_recording *recording)
{
    if (!recording)
        return;
    /* Cannot fail, because it was opened for reading. */
    if (wb_recording_close(recording->recording) != WB_OK)
        wb_warn("'%s' was not closed", recording->path);
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++)
        wb_columns_release(&recording->tables[i].columns);
    wb_memory_release(&recording->memory);
    free(recording->meta);
    free(recording->problems);
    free(recording);
}

/* --- contents --- */

static void keep_problems(struct wirebench_recording *recording)
{
    char text[PROBLEM_SIZE];
    for (int at = 0; wb_survey_problem(&recording->survey, &at, text, sizeof text);) {
        recording->problems = wb_memory_resize(
            recording->problems, (size_t)recording->n_problems + 1, sizeof *recording->problems);
        memcpy(recording->problems[recording->n_problems++], text, sizeof text);
    }
}

static enum wb_status survey(struct wirebench_recording *recording)
{
    if (recording->is_surveyed)
        return WB_OK;
    recording->n_problems = 0;
    WB_TRY(wb_survey_run(recording->recording, true, &recording->survey));
    if (wb_recording_hash(recording->recording, recording->sha256) != WB_OK)
        recording->sha256[0] = '\0';
    keep_problems(recording);
    recording->is_surveyed = true;
    return WB_OK;
}

enum wirebench_status wirebench_recording_describe(struct wirebench_recording *recording,
                                                   struct wirebench_recording_info *info)
{
    wb_call_begin();
    enum wb_status status = wb_call_need(recording, "recording");
    if (status == WB_OK)
        status = survey(recording);
    if (status != WB_OK)
        return wb_call_end(status);
    const struct wb_survey *const found = &recording->survey;
    struct wirebench_recording_info mine = {
        .is_virtual = found->is_virtual,
        .is_whole = wb_survey_is_whole(found),
        .n_problems = recording->n_problems,
        .n_streams = found->n_streams,
        .first_ns = found->first_ns,
        .duration = wb_survey_duration(found),
        .chunks = found->chunks,
        .damaged_chunks = found->damaged,
        .events = found->events,
    };
    memcpy(mine.sha256, recording->sha256, sizeof mine.sha256);
    return wb_call_end(wb_call_give(info, &mine, sizeof mine, "wirebench_recording_info"));
}

/* The public roles have the values of the internal ones. */
_Static_assert((int)WB_ROLE_LOAD == (int)WIREBENCH_LOAD, "load");
_Static_assert((int)WB_ROLE_MOCAP == (int)WIREBENCH_MOCAP, "mocap");
_Static_assert((int)WB_ROLE_STAGE == (int)WIREBENCH_STAGE, "stage");

enum wirebench_status wirebench_recording_stream(struct wirebench_recording *recording, int index,
                                                 struct wirebench_stream *stream)
{
    wb_call_begin();
    enum wb_status status = wb_call_need(recording, "recording");
    if (status == WB_OK)
        status = survey(recording);
    if (status != WB_OK)
        return wb_call_end(status);
    if (index < 0 || index >= recording->survey.n_streams)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND, "stream %d: '%s' has %d, counted from 0",
                                   index, recording->path, recording->survey.n_streams));
    const struct wb_survey_stream *const found = &recording->survey.streams[index];
    const struct wb_recording_stream *const declared =
        wb_recording_stream_at(recording->recording, index);
    struct wirebench_stream mine = {
        .id = found->id,
        .role = (enum wirebench_role)found->role,
        .chunks = found->chunks,
        .bytes = found->bytes,
        .samples = found->samples,
        .rate = found->rate,
        .longest_silence = wb_seconds_from_ns(found->longest_silence_ns),
    };
    snprintf(mine.address, sizeof mine.address, "%s", declared->address);
    snprintf(mine.protocol, sizeof mine.protocol, "%s", declared->protocol);
    return wb_call_end(wb_call_give(stream, &mine, sizeof mine, "wirebench_stream"));
}

const char *wirebench_recording_problem(const struct wirebench_recording *recording, int index)
{
    return index >= 0 && index < recording->n_problems ? recording->problems[index] : NULL;
}

const char *wirebench_recording_meta(const struct wirebench_recording *recording, const char *key)
{
    for (int i = 0; i < recording->n_meta; i++) {
        if (strcmp(recording->meta[i].key, key) == 0)
            return recording->meta[i].value;
    }
    return NULL;
}

/* --- samples --- */

static enum wb_status decode(struct wirebench_recording *recording)
{
    if (recording->is_decoded)
        return WB_OK;
    struct wb_rig rig;
    struct wb_replay_counts counts;
    struct wb_columns tables[WB_SAMPLE_COLUMNS_TABLES];
    WB_TRY(wb_replay_rig(recording->recording, &rig));
    /* WB_ERR_DATA: the recording breaks off. */
    const enum wb_status status =
        wb_sample_columns_read(tables, recording->recording, &rig, &counts);
    if (status != WB_OK && status != WB_ERR_DATA)
        return status;
    for (int i = 0; i < WB_SAMPLE_COLUMNS_TABLES; i++)
        recording->tables[i].columns = tables[i];
    if (counts.damaged_chunks > 0)
        snprintf(recording->why, sizeof recording->why, "'%s': %llu damaged chunk%s left out",
                 recording->path, (unsigned long long)counts.damaged_chunks,
                 counts.damaged_chunks == 1 ? " was" : "s were");
    else if (status != WB_OK)
        snprintf(recording->why, sizeof recording->why,
                 "'%s': parts cannot be read and are left out", recording->path);
    else if (!wb_recording_is_complete(recording->recording))
        snprintf(recording->why, sizeof recording->why,
                 "'%s' was not closed properly: its end may be missing", recording->path);
    recording->is_decoded = true;
    return WB_OK;
}

enum wirebench_status wirebench_recording_table(struct wirebench_recording *recording,
                                                const char *name,
                                                const struct wirebench_table **table)
{
    wb_call_begin();
    if (wb_call_need(recording, "recording") != WB_OK || wb_call_need(name, "name") != WB_OK ||
        wb_call_need(table, "table") != WB_OK)
        return wb_call_end(WB_ERR_ARGUMENT);
    const int index = wb_sample_columns_find(name);
    if (index < 0)
        return wb_call_end(wb_fail(WB_ERR_NOT_FOUND,
                                   "no table '%s' in a recording: expected load, mocap, stage, "
                                   "events or clock",
                                   name));
    const enum wb_status status = decode(recording);
    if (status != WB_OK)
        return wb_call_end(status);
    *table = &recording->tables[index];
    return recording->why[0] ? wb_call_end_incomplete("%s", recording->why) : wb_call_end(WB_OK);
}
