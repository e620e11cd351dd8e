#include "daq/test/first_motion.h"

#include <math.h>
#include <stdio.h>

/* Accepted motion of the markers as a fraction of the stage's travel. */
#define LEAST_SHARE 0.5
#define MOST_SHARE 1.5
#define UPRIGHT 0.7 /* cosine: within 45 degrees of the vertical axis */

bool wb_first_motion_agrees(const struct wb_tip_watch *watch, double travel, double ahead,
                            const struct wb_rig *rig, char text[WB_START_CHECK_TEXT])
{
    const char up = rig->mocap.up;
    const int clamp = wb_tip_watch_clamp(watch);
    double moved[3];
    if (!watch->settled)
        return true;
    for (int k = 0; k < 3; k++)
        moved[k] = watch->at[clamp][k] - watch->rest[clamp][k].mean;
    const double size = wb_tip_watch_moved(watch, clamp), down = -moved[watch->up];
    if (size < LEAST_SHARE * travel)
        snprintf(
            text, WB_START_CHECK_TEXT,
            "the stage reports %.1f mm of travel, but the markers moved by %.2f mm only: check "
            "that the motor turns the spindle, that the clamp is fixed to the stage, the "
            "stage's steps per mm ($100), and that Motive is in live mode",
            travel / WB_MM, size / WB_MM);
    else if (size > MOST_SHARE * (travel + ahead))
        snprintf(text, WB_START_CHECK_TEXT,
                 "the stage reports %.1f mm of travel, but the markers moved by %.2f mm: check the "
                 "stage's steps per mm ($100) and the calibration of the cameras",
                 travel / WB_MM, size / WB_MM);
    else if (fabs(down) < UPRIGHT * size)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the stage moved down, but the markers moved by (%.1f, %.1f, %.1f) mm, not along "
                 "%c: set mocap.up of the rig file to the vertical axis",
                 moved[0] / WB_MM, moved[1] / WB_MM, moved[2] / WB_MM, up);
    else if (down < 0.0)
        snprintf(text, WB_START_CHECK_TEXT,
                 "the markers moved up by %.1f mm while the stage should move down: set stage.down "
                 "of the rig file to %+d, or make the cameras' %c axis point up",
                 -down / WB_MM, -rig->stage.down, up);
    else
        return true;
    return false;
}
