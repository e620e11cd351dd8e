/* Tracks the specimen's markers from frame to frame for live views, with positions relative to the
 * clamp. Approximate: the analysis identifies the markers exactly from the recording
 * (analysis/align/markers.h).
 */
#ifndef WB_LIVE_LIVE_SHAPE_H
#define WB_LIVE_LIVE_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* All zero: initial state. */
struct wb_live_shape {
    bool is_found;       /* all markers were seen in one frame, and are tracked since then */
    bool is_clamp_known; /* the clamp's end was found: it moves down relative to the other */
    int n, clamp, up;    /* markers; index of the clamp's; index of the vertical coordinate */
    int frames_looked;
    double at[WB_SPECIMEN_MAX_MARKERS][3]; /* m, server's frame, last seen position of each */
    double rest[2];                        /* m, initial heights of both ends */
    double along[3];                       /* horizontal direction from first to last marker */
    uint32_t seen;                         /* bit i: measured in the last frame */
};

/* Adds a frame. `up` as in the rig file: 'y' or 'z'. */
void wb_live_shape_follow(struct wb_live_shape *shape, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen, char up);

/* Position of marker i (counted from the clamp as in the specimen file) relative to the clamp's
 * marker, m: along the wire at rest, and up. */
void wb_live_shape_place(const struct wb_live_shape *shape, int i, float place[2]);

/* Bit i: marker i, counted from the clamp, was measured in the last frame. */
uint32_t wb_live_shape_seen(const struct wb_live_shape *shape);

#endif
