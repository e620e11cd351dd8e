/* Finds the markers of a specimen in a frame. They are identified by geometry, because the ids of
 * single markers change: on the unloaded, nearly straight wire they lie on a line at their arc
 * lengths. A stray reflection is therefore not mistaken for a missing marker.
 */
#ifndef WB_DAQ_ACQUIRE_MARKER_CHECK_H
#define WB_DAQ_ACQUIRE_MARKER_CHECK_H

#include "base/units.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* For each marker of the specimen its index in frame->markers; -1: not seen. */
struct wb_marker_places {
    int n_seen;
    int index[WB_SPECIMEN_MAX_MARKERS];
};

/* Searches for the specimen's markers among the measured markers of a frame of the unloaded wire. A
 * marker may be off the line by 0.4 of the smallest spacing, which allows for bow, sag and the
 * height of the markers. With symmetric spacing the two ends cannot be distinguished. Only the
 * first 32 measured markers of a frame are searched. */
void wb_marker_check_frame(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                           struct wb_marker_places *places);

/* Index of the measured marker of a frame nearest to `at` (m, server's frame) and less than `reach`
 * (m) away; -1: none. Between two frames a marker moves far less than WB_MARKER_CHECK_REACH, and
 * the other markers are farther away. */
int wb_marker_check_nearest(const struct wb_mocap_frame *frame, const double at[3], double reach);
#define WB_MARKER_CHECK_REACH (5.0 * WB_MM)

#endif
