#include "daq/stage_check.h"

#include <math.h>
#include <stdio.h>

#include "base/units.h"
#include "daq/grbl.h"

#define S_PER_MIN 60.0
#define ROUNDING 1e-3             /* of a setting: printed with three decimals */
#define NEAR_LIMIT (0.01 * WB_MM) /* a few steps of the motor */

static int number(const struct wb_rig *rig, int first)
{
    return first + rig->stage.axis - 'X';
}

/* Soft limits count only where the stage stands within them: firmware built to count upwards from
 * its switch has others, which it does not tell. */
static bool has_limits(const struct wb_stage_settings *settings, double position)
{
    return settings->soft_limits && position <= NEAR_LIMIT &&
           position >= -settings->travel - NEAR_LIMIT;
}

static bool check_units(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                        char text[WB_INTERLOCK_TEXT])
{
    if (settings->inches) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "the stage reports its position in inches ($13=1): set $13=0 in its firmware");
        return false;
    }
    const double expected = rig->stage.steps;
    if (expected > 0.0 && fabs(settings->steps - expected) > ROUNDING * expected) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "the stage is set to $%d=%g steps/mm, the rig file says stage.steps_per_mm %g: "
                 "every way would be wrong by their ratio; set one of the two right",
                 number(rig, WB_GRBL_STEPS), settings->steps * WB_MM, expected * WB_MM);
        return false;
    }
    return true;
}

static bool check_speed(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                        double speed, char text[WB_INTERLOCK_TEXT])
{
    const double scale = rig->time_scale;
    if (speed > settings->speed * (1.0 + ROUNDING)) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "the stage's firmware allows %g mm/s at most ($%d=%g mm/min), and %g mm/s are "
                 "wanted: set $%d=%.0f or choose a lower speed",
                 settings->speed / WB_MM / scale, number(rig, WB_GRBL_RATE),
                 settings->speed * S_PER_MIN / WB_MM, speed / WB_MM / scale,
                 number(rig, WB_GRBL_RATE), ceil(speed * S_PER_MIN / WB_MM));
        return false;
    }
    const double braking = speed / settings->acceleration;
    if (braking > WB_STAGE_CHECK_BRAKING * (1.0 + ROUNDING)) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "the stage needs %.1f s to brake from %g mm/s ($%d=%g mm/s2), too long to stop "
                 "it safely: set $%d=%.0f or choose a lower speed",
                 braking, speed / WB_MM / scale, number(rig, WB_GRBL_ACCELERATION),
                 settings->acceleration / WB_MM, number(rig, WB_GRBL_ACCELERATION),
                 ceil(speed / WB_STAGE_CHECK_BRAKING / WB_MM));
        return false;
    }
    return true;
}

bool wb_stage_check(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                    const struct wb_stage_motion *motion, char text[WB_INTERLOCK_TEXT])
{
    if (!check_units(settings, rig, text) || !check_speed(settings, rig, motion->speed, text))
        return false;
    if (has_limits(settings, motion->from) && !has_limits(settings, motion->to)) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "a move to the machine position %.3f mm goes beyond the stage's soft limits, %g "
                 "mm to 0 ($%d): the stage stands at %.3f mm; choose a shorter way, or home the "
                 "stage if it does not stand there",
                 motion->to / WB_MM, -settings->travel / WB_MM, number(rig, WB_GRBL_TRAVEL),
                 motion->from / WB_MM);
        return false;
    }
    return true;
}

double wb_stage_check_way_up(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                             double position)
{
    if (!has_limits(settings, position))
        return HUGE_VAL;
    return fmax(rig->stage.down > 0 ? position + settings->travel : -position, 0.0);
}
