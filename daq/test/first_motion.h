/* The first millimetres of a test: the stage says how far it has gone, and the cameras how far the
 * clamp has. Where the two part, the specimen is still whole, and what is wrong can be mended;
 * after the test it cannot.
 */
#ifndef WB_DAQ_TEST_FIRST_MOTION_H
#define WB_DAQ_TEST_FIRST_MOTION_H

#include <stdbool.h>

#include "base/units.h"
#include "daq/protocol/rig.h"
#include "daq/test/start_check.h"
#include "daq/test/tip_watch.h"

/* How far the stage goes before it is judged, m. */
#define WB_FIRST_MOTION (2.0 * WB_MM)

/* Whether the end of the wire that moved more went down with the stage: by at least half of the
 * `travel` (m, down) that it reported last and no more than one and a half of that and `ahead` (m),
 * what it may have gone since, along the vertical axis of the rig file. Otherwise `text` says what
 * is wrong and how to mend it. True where the ends were not found at rest. */
bool wb_first_motion_agrees(const struct wb_tip_watch *watch, double travel, double ahead,
                            const struct wb_rig *rig, char text[WB_START_CHECK_TEXT]);

#endif
