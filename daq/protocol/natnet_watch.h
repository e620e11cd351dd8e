/* What the frames of a motion-capture server tell about the server itself: that it was restarted,
 * that its models were changed, that it records a take of its own. After a restart or a change of
 * models a new segment begins: numbers of markers, and after a restart the clock, are other ones.
 *
 * Pure: frames and their times in, remarks and a segment's number out; so a replay finds the same.
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

/* All zero before the first frame. */
struct wb_natnet_watch {
    bool has_frame;
    double newest;  /* s: latest t_device of this run of the server; NaN without stamps */
    int16_t params; /* of the last frame */
    int segment;
    uint64_t n_restarts, n_changes;
    bool waits_for_take; /* the server said that it would record, and does not yet */
    int64_t promised_ns;
};

enum wb_natnet_news {
    WB_NATNET_SAME,
    WB_NATNET_NEW_MODELS,
    WB_NATNET_RESTARTED /* what it was asked before is forgotten */
};

/* The next frame. `back` (s of the server's clock): how far a frame that was overtaken on its way
 * may lie behind; more is a restart. */
enum wb_natnet_news wb_natnet_watch_frame(struct wb_natnet_watch *watch,
                                          const struct wb_mocap_frame *frame, double back,
                                          const struct wb_sink *sink);

/* The server agreed at t_ns to record a take; it is told when no frame bears that out. */
void wb_natnet_watch_promise(struct wb_natnet_watch *watch, int64_t t_ns);

#endif
