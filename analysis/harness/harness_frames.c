#include "analysis/harness/harness_frames.h"

#include <math.h>

#include "analysis/harness/harness_run.h"

void wb_harness_frames_create(struct wb_harness_frames *frames)
{
    frames->list = wb_memory_take(frames->memory, (size_t)frames->n_wanted, sizeof *frames->list);
}

/* The frames of the step before keep their arrays, which the results point to. */
void wb_harness_frames_begin(struct wb_harness_frames *frames, bool is_motion)
{
    for (int i = 0; i < frames->n_wanted; i++)
        frames->list[i].places = NULL;
    frames->is_motion = is_motion;
    frames->calls = frames->n = 0;
    frames->stride = 1;
}

static struct wb_harness_frame *add(struct wb_harness_frames *frames, double fraction)
{
    struct wb_harness_frame *const frame = &frames->list[frames->n++];
    frame->fraction = fraction;
    if (!frame->places) {
        frame->places =
            wb_memory_take(frames->memory, (size_t)frames->n_places, sizeof *frame->places);
        frame->forces =
            wb_memory_take(frames->memory, (size_t)frames->n_forces, sizeof *frame->forces);
    }
    return frame;
}

/* Drops every second frame; their arrays are used again. */
static void thin(struct wb_harness_frames *frames)
{
    frames->n /= 2;
    frames->stride *= 2;
    for (int i = 0; i < frames->n; i++) {
        const struct wb_harness_frame dropped = frames->list[i];
        frames->list[i] = frames->list[2 * i + 1];
        frames->list[2 * i + 1] = dropped;
    }
}

struct wb_harness_frame *wb_harness_frames_take(struct wb_harness_frames *frames, double fraction)
{
    const double before = frames->n > 0 ? frames->list[frames->n - 1].fraction : 0.0;
    if (frames->n_wanted < 2)
        return NULL;
    if (frames->is_motion) {
        frames->calls++;
        if (frames->calls % frames->stride == 0 && frames->n == frames->n_wanted - 1)
            thin(frames);
        return frames->calls % frames->stride == 0 ? add(frames, frames->calls) : NULL;
    }
    if (frames->n > 0 && fraction == before)
        return &frames->list[frames->n - 1];
    const double part = fraction * frames->n_wanted * (1.0 + 1e-12);
    return fraction < 1.0 && floor(part) > floor(before * frames->n_wanted * (1.0 + 1e-12))
               ? add(frames, fraction)
               : NULL;
}

void wb_harness_frames_end(struct wb_harness_frames *frames, double completed)
{
    if (frames->is_motion) {
        for (int i = 0; i < frames->n; i++)
            frames->list[i].fraction /= frames->calls + 1;
        return;
    }
    while (frames->n > 0 && frames->list[frames->n - 1].fraction >= completed)
        frames->n--;
}
