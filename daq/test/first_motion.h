/* Check of the first millimetres of a test: compares the travel reported by the stage with the
 * clamp's motion seen by the cameras, while the specimen is still intact and an error of the setup
 * can be corrected.
 */
#ifndef WB_DAQ_TEST_FIRST_MOTION_H
#define WB_DAQ_TEST_FIRST_MOTION_H

#include <stdbool.h>

#include "base/units.h"
#include "daq/protocol/rig.h"
#include "daq/test/start_check.h"
#include "daq/test/tip_watch.h"

/* Travel after which the motion is judged, m. */
#define WB_FIRST_MOTION (2.0 * WB_MM)

/* Whether the end of the wire that moved more (the clamp) moved down with the stage, along the
 * vertical axis of the rig file: by at least 0.5 times the last reported `travel` (m, down) and at
 * most 1.5 times the sum of `travel` and `ahead` (m, possible travel since that report). If not,
 * `text` holds the cause and the remedy. True if the ends were not found at rest. */
bool wb_first_motion_agrees(const struct wb_tip_watch *watch, double travel, double ahead,
                            const struct wb_rig *rig, char text[WB_START_CHECK_TEXT]);

#endif
