/* An approximate deflection for the status line of a running test: the rise of the tip's marker
 * above the clamp's, followed from frame to frame. The analysis later computes the exact one from
 * the recording.
 */
#ifndef WB_DAQ_TEST_TIP_WATCH_H
#define WB_DAQ_TEST_TIP_WATCH_H

#include <stdbool.h>

#include "daq/protocol/average.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* All zero is not started. */
struct wb_tip_watch {
    bool found;                   /* both ends are being followed */
    bool settled;                 /* the heights at rest are known */
    int up;                       /* index of the vertical coordinate */
    double at[2][3];              /* m, server's frame: where the two ends were seen last, */
    int64_t seen_ns[2];           /* and when */
    struct wb_average rest[2][3]; /* m: where they rest */
    double deflection;            /* m, smoothed over some frames */
};

/* A frame of the unloaded wire: finds the ends, then averages their heights. */
void wb_tip_watch_rest(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame,
                       const struct wb_specimen *specimen, char up);

/* A frame of the test. */
void wb_tip_watch_follow(struct wb_tip_watch *watch, const struct wb_mocap_frame *frame);

/* m: how far an end (0, 1) is from where it rested. */
double wb_tip_watch_moved(const struct wb_tip_watch *watch, int end);

/* The clamp's end: the one that moved more, since the strand holds the other. */
int wb_tip_watch_clamp(const struct wb_tip_watch *watch);

#endif
