/* The specimen's markers from frame to frame, in the clamp's frame, for live views. The analysis
 * identifies markers anew and exactly from the recording (analysis/align/markers.h); this is
 * enough to see the wire bend and a marker go missing.
 */
#ifndef WB_LIVE_LIVE_SHAPE_H
#define WB_LIVE_LIVE_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* All zero is not started. */
struct wb_live_shape {
    bool is_found;       /* all markers were seen at once, and are followed since */
    bool is_clamp_known; /* which end is the clamp: it sinks against the other one */
    int n, clamp, up;    /* markers; index of the clamp's; index of the vertical coordinate */
    int frames_looked;
    double at[WB_SPECIMEN_MAX_MARKERS][3]; /* m, server's frame: where each was seen last */
    double rest[2];                        /* m: heights of the two ends at first */
    double along[3];                       /* horizontal direction from the first to the last */
    uint32_t seen;                         /* bit i: measured in the last frame */
};

/* Takes a frame. `up` as in the rig file: 'y' or 'z'. */
void wb_live_shape_follow(struct wb_live_shape *shape, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen, char up);

/* Place of marker i, counted from the clamp as in the specimen's file, m: along the wire at rest
 * and up, from the clamp's marker. */
void wb_live_shape_place(const struct wb_live_shape *shape, int i, float place[2]);

/* Bit i: marker i, counted from the clamp, was measured in the last frame. */
uint32_t wb_live_shape_seen(const struct wb_live_shape *shape);

#endif
