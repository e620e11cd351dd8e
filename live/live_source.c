#include "live/live_source.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

/* Points of the curve per second of rig time, but at most per second of host time, because a
 * virtual rig may run fast. */
#define POINTS_PER_S 20.0
#define MOST_POINTS_PER_S 500.0

void wb_live_source_init(struct wb_live_source *source, struct wb_live_feed *feed,
                         const struct wb_rig *rig, const struct wb_specimen *specimen)
{
    *source = (struct wb_live_source){.feed = feed, .specimen = *specimen, .up = rig->mocap.up};
    source->point_interval_ns =
        wb_ns_from_seconds(1.0 / fmin(POINTS_PER_S * rig->time_scale, MOST_POINTS_PER_S));
}

static void on_load(void *context, const struct wb_load_sample *sample)
{
    struct wb_live_source *const source = context;
    struct wb_bend_test_status status;
    if (!source->test || !sample->valid || sample->t_ns < source->point_ns)
        return;
    wb_bend_test_status(source->test, &status);
    if (status.cycle == 0 || !status.has_deflection || status.end != WB_SEQUENCE_RUNNING ||
        isfinite(status.held))
        return;
    source->point_ns = sample->t_ns + source->point_interval_ns;
    wb_live_feed_add_point(source->feed,
                           &(struct wb_live_frame_point){(float)status.deflection,
                                                         (float)status.tension, status.cycle});
}

static void on_mocap(void *context, const struct wb_mocap_frame *frame)
{
    struct wb_live_source *const source = context;
    wb_live_shape_follow(&source->shape, frame, &source->specimen, source->up);
}

struct wb_sink wb_live_source_sink(struct wb_live_source *source)
{
    return (struct wb_sink){.context = source, .load = on_load, .mocap = on_mocap};
}

static enum wb_live_frame_word find_word(const struct wb_bend_test_status *status)
{
    if (!status->is_standing || status->end == WB_SEQUENCE_FAILED)
        return WB_LIVE_FRAME_FAULTED;
    if (status->end == WB_SEQUENCE_DONE)
        return WB_LIVE_FRAME_DONE;
    if (status->end != WB_SEQUENCE_RUNNING)
        return WB_LIVE_FRAME_STOPPED;
    if (isfinite(status->held))
        return WB_LIVE_FRAME_HELD;
    if (status->cycle > 0)
        return WB_LIVE_FRAME_TESTING;
    return status->is_connected ? WB_LIVE_FRAME_READY : WB_LIVE_FRAME_CONNECTING;
}

static void fill_text(const struct wb_bend_test_status *status, char text[WB_LIVE_FRAME_TEXT])
{
    const bool is_held = isfinite(status->held) && status->end == WB_SEQUENCE_RUNNING;
    if (is_held && !status->hold_stands)
        snprintf(text, WB_LIVE_FRAME_TEXT, "the stage is stopping");
    else if (is_held)
        snprintf(text, WB_LIVE_FRAME_TEXT,
                 "held at %.2f mm for %.0f s: press r to resume, q to end the test (ends "
                 "automatically in %.0f s)",
                 status->travel / WB_MM, status->held, fmax(status->hold_left, 0.0));
    else
        snprintf(text, WB_LIVE_FRAME_TEXT, "%.*s", WB_LIVE_FRAME_TEXT - 1, status->end_text);
}

static void fill_streams(const struct wb_acquisition_latest *latest, struct wb_live_frame *frame)
{
    for (int role = 0; role < WB_INTERLOCK_ROLES; role++) {
        const struct wb_acquisition_stream_state *const stream = &latest->stream[role];
        frame->stream[role] = (struct wb_live_frame_stream){
            .rate = stream->rate,
            .samples = stream->samples,
            .missing = stream->loss.missing,
            .gaps = stream->loss.gaps,
            .drops = stream->drops,
            .is_ready = stream->ready,
            .is_lost = stream->lost,
            .is_gone = stream->gone,
            .is_losing = stream->is_losing,
        };
        frame->bytes += stream->bytes;
    }
    frame->disk_lag = wb_seconds_from_ns(latest->storage.lag_ns);
    frame->disk_fill = latest->storage.fill;
    frame->is_disk_failing = latest->storage.failing != WB_OK;
    frame->is_disk_late = latest->is_storage_late;
}

static void fill_markers(const struct wb_live_source *source, struct wb_live_frame *frame)
{
    frame->n_markers = source->specimen.n_markers;
    frame->are_markers_found = source->shape.is_found;
    if (!source->shape.is_found)
        return;
    frame->seen = wb_live_shape_seen(&source->shape);
    for (int i = 0; i < frame->n_markers; i++)
        wb_live_shape_place(&source->shape, i, frame->marker[i]);
}

void wb_live_source_fill(const struct wb_live_source *source, struct wb_live_frame *frame)
{
    struct wb_bend_test_status status;
    wb_bend_test_status(source->test, &status);
    memset(frame, 0, sizeof *frame);
    frame->word = find_word(&status);
    snprintf(frame->phase, sizeof frame->phase, "%s", status.phase);
    fill_text(&status, frame->text);
    frame->cycle = status.cycle;
    frame->cycles = status.cycles;
    frame->elapsed = status.elapsed;
    frame->time_left = status.time_left;
    frame->force = status.has_tension ? status.tension : (double)NAN;
    frame->peak = status.cycle > 0 ? status.peak_tension : (double)NAN;
    frame->deflection = status.has_deflection ? status.deflection : (double)NAN;
    frame->travel = status.has_travel ? status.travel : (double)NAN;
    fill_streams(status.latest, frame);
    fill_markers(source, frame);
}
