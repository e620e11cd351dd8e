/* Checks a motion against the settings of the stage's firmware. GRBL itself reports few of these
 * problems: it silently limits the speed of a jog and silently reports inches. A controller that
 * would continue to move after a crash of this computer is rejected. Only decisions; the reason of
 * a failure is a message for the operator. */
#ifndef WB_DAQ_ACQUIRE_STAGE_CHECK_H
#define WB_DAQ_ACQUIRE_STAGE_CHECK_H

#include <stdbool.h>

#include "daq/acquire/interlock.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/sample.h"

/* Longest braking time, s: at a higher speed the short jogs of daq/protocol/jog_feed.h would not
 * fit into the firmware's buffer. */
#define WB_STAGE_CHECK_BRAKING 1.0

struct wb_stage_motion {
    double from, to; /* m, machine positions; NaN: unknown */
    double speed;    /* m/s of host time */
};

/* True if the motion is possible; otherwise `text` receives the reason. Settings that the firmware
 * did not report are not checked. */
bool wb_stage_check(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                    const struct wb_stage_motion *motion, char text[WB_INTERLOCK_TEXT]);

/* The same for a test: `travel` (m) down from a machine position at the rig's speed. */
bool wb_stage_check_test(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                         double position, double travel, char text[WB_INTERLOCK_TEXT]);

/* m, travel up from a machine position to the soft limit; infinite without soft limits. */
double wb_stage_check_way_up(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                             double position);

#endif
