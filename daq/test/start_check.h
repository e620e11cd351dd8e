/* The start check of a test: the stage must be ready, all markers seen at the expected distances,
 * and the unloaded load cell at zero. Pure functions of collected samples; the reason of a failure
 * is a message for the operator.
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

/* Frames and readings of the unloaded bench. All zero: empty. */
struct wb_start_check {
    int n_frames;
    int seen[WB_SPECIMEN_MAX_MARKERS]; /* frames in which each marker was seen */
    /* m, of frames that show all markers: the position of each marker in the server's frame, and
     * its distance to the next marker. */
    int n_full;
    struct wb_average place[WB_SPECIMEN_MAX_MARKERS][3], link[WB_SPECIMEN_MAX_MARKERS];
    /* Over all received markers, also those of other objects: measured, and occluded or filled in
     * by a model. */
    long n_measured, n_hidden;
    double spread;          /* m, largest extent of a frame's measured markers along an axis */
    struct wb_average load; /* N, readings */
};

/* Counts a frame and the markers it shows. */
void wb_start_check_frame(struct wb_start_check *check, const struct wb_mocap_frame *frame,
                          const struct wb_specimen *specimen);

/* Whether there are enough frames and readings to judge. */
bool wb_start_check_enough(const struct wb_start_check *check);

/* Each check returns true if it passes; otherwise `text` receives the reason and the command to run
 * for the rig file at `rig_path`.
 * stage: idle, with a known position. unit: the load cell's unit does not contradict the rig file.
 * markers: each is seen in at least half of the frames, because cameras lose single ones.
 * zero: within a tenth of the capacity, with noise up to wb_rig_noise_allowed(). If the tare is
 * taken with the counterweight (rig.h), its weight is expected instead of zero, within half of that
 * weight. */
bool wb_start_check_stage(const struct wb_stage_report *report, const char *rig_path,
                          char text[WB_START_CHECK_TEXT]);
bool wb_start_check_unit(bool contradicts, const struct wb_rig *rig, const char *rig_path,
                         char text[WB_START_CHECK_TEXT]);
bool wb_start_check_markers(const struct wb_start_check *check, const struct wb_specimen *specimen,
                            char text[WB_START_CHECK_TEXT]);
/* chain: requires that all markers are seen. Their positions vary between frames (otherwise the
 * take is paused), with noise up to 5 times that of the rig file (0.1 mm if it has none). The
 * distance between neighbours is that of the specimen file within 1.3 mm, three standard deviations
 * for two markers placed with a ruler to 0.3 mm each; the sum of the distances within 1 mm or 1 %.
 * Chords of a bowed wire are shorter than its arc by far less. */
bool wb_start_check_chain(const struct wb_start_check *check, const struct wb_specimen *specimen,
                          const struct wb_rig *rig, char text[WB_START_CHECK_TEXT]);
bool wb_start_check_zero(const struct wb_start_check *check, const struct wb_rig *rig,
                         const char *rig_path, char text[WB_START_CHECK_TEXT]);

#endif
