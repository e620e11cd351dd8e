/* Stores all samples of a sink as bytes, field by field, so that two decodings can be compared bit
 * for bit (struct padding is undefined). */
#ifndef WB_TESTS_DAQ_SAMPLE_LOG_H
#define WB_TESTS_DAQ_SAMPLE_LOG_H

#include <stdlib.h>

#include "base/text.h"
#include "daq/protocol/driver.h"
#include "daq/protocol/rig.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"
#include "tests/check.h"

struct sample_log {
    struct wb_text bytes[3]; /* by role */
    int n[3];
};

#define SAMPLE_LOG_FIELD(field) wb_text_append_bytes(bytes, &(field), sizeof(field))

/* Counts a sample; returns where its fields go. */
static inline struct wb_text *sample_log_count(struct sample_log *log, enum wb_role role)
{
    log->n[role]++;
    return &log->bytes[role];
}

static inline void sample_log_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_text *const bytes = sample_log_count(context, WB_ROLE_LOAD);
    SAMPLE_LOG_FIELD(sample->t_ns);
    SAMPLE_LOG_FIELD(sample->index);
    SAMPLE_LOG_FIELD(sample->force);
    SAMPLE_LOG_FIELD(sample->valid);
    SAMPLE_LOG_FIELD(sample->unstable);
    SAMPLE_LOG_FIELD(sample->overload);
    SAMPLE_LOG_FIELD(sample->unit_changed);
}

static inline void sample_log_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_text *const bytes = sample_log_count(context, WB_ROLE_MOCAP);
    SAMPLE_LOG_FIELD(frame->t_ns);
    SAMPLE_LOG_FIELD(frame->frame_number);
    SAMPLE_LOG_FIELD(frame->t_device);
    SAMPLE_LOG_FIELD(frame->t_clock);
    SAMPLE_LOG_FIELD(frame->camera_mid_exposure);
    SAMPLE_LOG_FIELD(frame->camera_data_received);
    SAMPLE_LOG_FIELD(frame->transmit);
    SAMPLE_LOG_FIELD(frame->params);
    SAMPLE_LOG_FIELD(frame->n_markers);
    for (int i = 0; i < frame->n_markers; i++) {
        const struct wb_marker *const marker = &frame->markers[i];
        SAMPLE_LOG_FIELD(marker->id);
        SAMPLE_LOG_FIELD(marker->position);
        SAMPLE_LOG_FIELD(marker->size);
        SAMPLE_LOG_FIELD(marker->residual);
        SAMPLE_LOG_FIELD(marker->params);
    }
}

static inline void sample_log_stage(void *context, const struct wb_stage_report *report)
{
    struct wb_text *const bytes = sample_log_count(context, WB_ROLE_STAGE);
    SAMPLE_LOG_FIELD(report->t_ns);
    SAMPLE_LOG_FIELD(report->state);
    SAMPLE_LOG_FIELD(report->position);
    SAMPLE_LOG_FIELD(report->alarm);
}

static inline struct wb_sink sample_log_sink(struct sample_log *log)
{
    memset(log, 0, sizeof *log);
    return (struct wb_sink){.context = log,
                            .load = sample_log_load,
                            .mocap = sample_log_mocap,
                            .stage = sample_log_stage};
}

static inline void sample_log_release(struct sample_log *log)
{
    for (int role = 0; role < 3; role++)
        wb_text_release(&log->bytes[role]);
}

/* Replays a recording with the rig stored in it, and compares the samples with the live ones. */
static inline void assert_replay_identical(const char *path, const struct sample_log *live)
{
    struct wb_recording *recording;
    struct wb_replay_counts counts;
    struct sample_log again;
    struct wb_rig rig;
    char *text;
    const struct wb_sink sink = sample_log_sink(&again);
    assert_int_equal(wb_recording_open(&recording, path), WB_OK);
    assert_int_equal(wb_recording_meta(recording, "rig", &text), WB_OK);
    assert_int_equal(wb_rig_parse(text, path, &rig, NULL), WB_OK);
    free(text);
    assert_int_equal(wb_replay_run(recording, &rig, &sink, 0.0, &counts), WB_OK);
    assert_int_equal(counts.damaged_chunks, 0);
    for (int role = 0; role < 3; role++) {
        assert_int_equal(again.n[role], live->n[role]);
        assert_int_equal(again.bytes[role].length, live->bytes[role].length);
        assert_memory_equal(wb_text_string(&again.bytes[role]), wb_text_string(&live->bytes[role]),
                            again.bytes[role].length);
    }
    assert_int_equal(wb_recording_close(recording), WB_OK);
    sample_log_release(&again);
}

#endif
