/* Approximate deflection for the status line and the checks of a running test: the rise of the
 * tip's marker relative to the clamp's, tracked from frame to frame. The analysis computes the
 * exact deflection from the recording.
 */
#ifndef WB_DAQ_TEST_TIP_WATCH_H
#define WB_DAQ_TEST_TIP_WATCH_H

#include <stdbool.h>

#include "daq/protocol/average.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* All zero: initial state. */
struct wb_tip_watch {
    bool found;                   /* both ends are being tracked */
    bool settled;                 /* the positions at rest are known */
    int up;                       /* index of the vertical coordinate */
    double at[2][3];              /* m, server's frame, last seen position of each end */
    int64_t seen_ns[2];           /* host time of that position */
    struct wb_average rest[2][3]; /* m, position of each end at rest */
    double deflection;            /* m, smoothed over some frames */
};

/* Adds a frame of the unloaded wire: finds the ends, then averages their positions. */
void wb_tip_watch_rest(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame,
                       const struct wb_specimen *specimen, char up);

/* Adds a frame of the test. */
void wb_tip_watch_follow(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame);

/* m, distance of an end (0, 1) from its position at rest. */
double wb_tip_watch_moved(const struct wb_tip_watch *watch, int end);

/* The clamp's end: it moves more, because the strand restrains the tip. */
int wb_tip_watch_clamp(const struct wb_tip_watch *watch);

#endif
