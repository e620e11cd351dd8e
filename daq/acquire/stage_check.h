/* Whether the stage can do a motion as its firmware is set, and may: a controller that would go on
 * when this computer dies is not moved. GRBL says nothing of most of it: it
 * slows a jog down to its largest speed, and reports inches, without a word. Pure decisions; the
 * reason of a refusal is written for the operator. */
#ifndef WB_DAQ_ACQUIRE_STAGE_CHECK_H
#define WB_DAQ_ACQUIRE_STAGE_CHECK_H

#include <stdbool.h>

#include "daq/acquire/interlock.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

/* Braking may take so long, s: from a higher speed the short jogs that lead the stage
 * (daq/protocol/jog_feed.h) would not fit into the firmware's buffer. */
#define WB_STAGE_CHECK_BRAKING 1.0

struct wb_stage_motion {
    double from, to; /* m, machine positions; NaN: not known */
    double speed;    /* m/s of the host's time */
};

/* True when all is well, or writes the reason. What the firmware did not tell is not checked. */
bool wb_stage_check(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                    const struct wb_stage_motion *motion, char text[WB_INTERLOCK_TEXT]);

/* The same for a test: down by `travel` (m) from a machine position at the rig's speed, and back.
 */
bool wb_stage_check_test(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                         double position, double travel, char text[WB_INTERLOCK_TEXT]);

/* m: how far the stage may go up from a machine position before its soft limit; infinite where it
 * has none. */
double wb_stage_check_way_up(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                             double position);

#endif
