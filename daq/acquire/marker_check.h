/* Checks whether all markers of a specimen are seen. Markers are identified by geometry, because
 * the ids of bare markers change: on the unloaded, nearly straight wire they lie on a line at their
 * arc lengths. A stray reflection is therefore not mistaken for a missing marker.
 */
#ifndef WB_DAQ_ACQUIRE_MARKER_CHECK_H
#define WB_DAQ_ACQUIRE_MARKER_CHECK_H

#include "base/units.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

/* Where the specimen's markers are in a frame: for each an index into frame->markers, -1 when it
 * was not seen. */
struct wb_marker_places {
    int n_seen;
    int index[WB_SPECIMEN_MAX_MARKERS];
};

/* Looks for the specimen's markers among the measured ones of a frame of the unloaded wire. A
 * marker may lie off the line by 0.4 of the smallest spacing: the wire's bow, its sag and the
 * markers' height. With symmetric spacing the two ends cannot be distinguished; the count does not
 * need it. Frames with more than 32 measured markers are searched among the first 32. */
void wb_marker_check_frame(const struct wb_mocap_frame *frame, const struct wb_specimen *specimen,
                           struct wb_marker_places *places);

/* The measured marker of a frame that is nearest to a place (m, server's frame) and less than
 * `reach` (m) away: its index, -1 where there is none. From one frame to the next a marker moves
 * far less than WB_MARKER_CHECK_REACH, and no other one is so near. */
int wb_marker_check_nearest(const struct wb_mocap_frame *frame, const double at[3], double reach);
#define WB_MARKER_CHECK_REACH (5.0 * WB_MM)

#endif
