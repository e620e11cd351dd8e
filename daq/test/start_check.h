/* The start check of a test: the stage is ready, all markers are seen, and the unloaded load cell
 * reads zero. Pure functions on gathered samples; the reason of a refusal is written for the
 * operator.
 */
#ifndef WB_DAQ_TEST_START_CHECK_H
#define WB_DAQ_TEST_START_CHECK_H

#include <stdbool.h>
#include <stddef.h>

#include "daq/acquire/interlock.h"
#include "daq/protocol/average.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"
#include "daq/protocol/specimen.h"

#define WB_START_CHECK_TEXT WB_INTERLOCK_TEXT

/* Frames and readings of the unloaded bench. All zero is empty. */
struct wb_start_check {
    int n_frames;
    int seen[WB_SPECIMEN_MAX_MARKERS]; /* frames in which each marker was seen */
    /* m, of frames that show all of them: the places of each marker in the server's frame, and its
     * distance to the next one. */
    int n_full;
    struct wb_average place[WB_SPECIMEN_MAX_MARKERS][3], link[WB_SPECIMEN_MAX_MARKERS];
    /* Of all markers that came, ours or not: measured, and hidden or filled in by a model. */
    long n_measured, n_hidden;
    double spread;          /* m, the largest extent of a frame's measured places along an axis */
    struct wb_average load; /* N */
};

/* Counts a frame and the markers it shows. */
void wb_start_check_frame(struct wb_start_check *check, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen);

/* Enough was gathered to judge. */
bool wb_start_check_enough(const struct wb_start_check *check);

/* Each returns true when all is well, or writes the reason of the refusal, with the command that
 * mends it for the rig file at `rig_path`.
 * A marker counts as seen when it is there in half of the frames: cameras lose one now and then. A
 * zero is within a tenth of the capacity, with noise up to wb_rig_noise_allowed(). If the tare is
 * taken with the counterweight (rig.h), its weight is expected instead of zero, within half of that
 * weight. The load cell's unit may not contradict the rig file's. */
bool wb_start_check_stage(const struct wb_stage_report *report, const char *rig_path,
                          char text[WB_START_CHECK_TEXT]);
bool wb_start_check_unit(bool contradicts, const struct wb_rig *rig, const char *rig_path,
                         char text[WB_START_CHECK_TEXT]);
bool wb_start_check_markers(const struct wb_start_check *check, const struct wb_specimen *specimen,
                            char text[WB_START_CHECK_TEXT]);
/* Of markers that are all seen: the cameras measure (no place is the same in each frame), with
 * noise up to 5 times the rig's own (0.1 mm where it says none), and the distances from marker to
 * marker are those of the specimen file: each within 1.3 mm, three standard deviations of two
 * markers that were put down by a ruler to 0.3 mm each, all together within 1 mm or 1.5 % of the
 * length. The chord of a bowed wire is shorter than its arc by far less. */
bool wb_start_check_chain(const struct wb_start_check *check, const struct wb_specimen *specimen,
                          const struct wb_rig *rig, char text[WB_START_CHECK_TEXT]);
bool wb_start_check_zero(const struct wb_start_check *check, const struct wb_rig *rig,
                         const char *rig_path, char text[WB_START_CHECK_TEXT]);

#endif
