/* Compares the clamp's position with the stage's reports during the whole travel. If the clamp
 * jams, a coupling slips or the motor loses steps, the stage still counts steps; only the cameras
 * see the difference. first_motion.h judges the first millimetres more strictly.
 */
#ifndef WB_DAQ_TEST_CLAMP_WATCH_H
#define WB_DAQ_TEST_CLAMP_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/test/start_check.h"
#include "daq/test/tip_watch.h"

/* All zero: initial state. */
struct wb_clamp_watch {
    bool has_end; /* `end` is known */
    int end;      /* end of the wire at the clamp, chosen at the first report: later the tip of a
                     bent wire may have moved more */
    int n_off;    /* consecutive reports that the cameras contradict */
};

/* Adds a report of the stage that arrived at t_ns: `travel` (m, down from the start), by which the
 * cameras may lag by `ahead` (m). Returns true, with a message in `text`, if the clamp's position
 * has differed at three consecutive reports by more than 2 mm plus 15 % of the travel plus `ahead`.
 * A clamp that the cameras have not seen for 0.3 s is not judged. The first call must come after
 * some millimetres of travel. */
bool wb_clamp_watch_add(struct wb_clamp_watch *watch, const struct wb_tip_watch *tip, int64_t t_ns,
                        double travel, double ahead, char text[WB_START_CHECK_TEXT]);

#endif
