/* Detects changes of the motion-capture server from its frames: a restart, a change of its models,
 * the recording of its own take. After a restart or a change of models a new segment begins,
 * because the ids of markers and, after a restart, the clock change.
 *
 * Depends on frames and their times only, so that a replay gives the same result.
 */
#ifndef WB_DAQ_PROTOCOL_NATNET_WATCH_H
#define WB_DAQ_PROTOCOL_NATNET_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"

/* Bits of a frame's params, from NatNet 2.6 on. */
enum {
    WB_FRAME_RECORDING = 1 << 0,
    WB_FRAME_MODELS_CHANGED = 1 << 1,
    WB_FRAME_LIVE = 1 << 2,
    WB_FRAME_BITSTREAM_CHANGED = 1 << 3
};

/* All zero: initial state. */
struct wb_natnet_watch {
    bool has_frame;
    double newest;  /* s, latest t_device since the server's start; NaN without stamps */
    int16_t params; /* of the last frame */
    int segment;
    uint64_t n_restarts, n_changes;
    bool waits_for_take; /* the server agreed to record, but has not begun */
    int64_t promised_ns;
};

/* Adds a frame. Returns whether the server was restarted: earlier queries must be repeated. `back`
 * (s of the server's clock): a frame may be out of order by this much; a larger step back is a
 * restart. */
bool wb_natnet_watch_frame(struct wb_natnet_watch *watch, const struct wb_mocap_frame *frame,
                           double back, const struct wb_sink *sink);

/* The server agreed at t_ns to record a take; a warning is given if its frames do not confirm it.
 */
void wb_natnet_watch_promise(struct wb_natnet_watch *watch, int64_t t_ns);

#endif
