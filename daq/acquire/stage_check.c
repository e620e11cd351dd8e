#include "daq/acquire/stage_check.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/protocol/grbl.h"
#include "daq/protocol/tic.h"

#define S_PER_MIN 60.0
#define ROUNDING 1e-3             /* relative; settings are printed with three decimals */
#define NEAR_LIMIT (0.01 * WB_MM) /* a few steps of the motor */

static int number(const struct wb_rig *rig, int first)
{
    return first + rig->stage.axis - 'X';
}

/* A limit of the firmware under the name and in the unit of its user interface: "$110" in mm/min,
 * "Max speed" in the Tic's units. */
struct limit_name {
    char name[24];
    double unit; /* SI */
    const char *unit_name;
    double most; /* largest possible setting, in its unit */
};

static struct limit_name name_limit(const struct wb_rig *rig, int first)
{
    const bool is_speed = first == WB_GRBL_RATE;
    struct limit_name limit = {.unit = is_speed ? WB_MM / S_PER_MIN : WB_MM,
                               .unit_name = is_speed ? "mm/min" : "mm/s2",
                               .most = HUGE_VAL};
    snprintf(limit.name, sizeof limit.name, "$%d", number(rig, first));
    if (strcmp(rig->stage.protocol, "tic") == 0) {
        snprintf(limit.name, sizeof limit.name, is_speed ? "Max speed" : "Max acceleration");
        limit.unit = (is_speed ? WB_TIC_SPEED_UNIT : WB_TIC_ACCELERATION_UNIT) / rig->stage.steps;
        limit.unit_name = is_speed ? "pulses/10000 s" : "pulses/s/100 s";
        limit.most = is_speed ? WB_TIC_MOST_SPEED : INT32_MAX;
    }
    return limit;
}

/* Soft limits are used only if the stage is within them: firmware compiled to count upwards from
 * its switch has different limits, which it does not report. */
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
                 "the stage's firmware has $%d=%g steps/mm, but stage.steps_per_mm of the rig file "
                 "is %g: every travel would be wrong by their ratio; correct one of them",
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
        const struct limit_name limit = name_limit(rig, WB_GRBL_RATE);
        if (speed > limit.most * limit.unit * (1.0 + ROUNDING)) {
            snprintf(text, WB_INTERLOCK_TEXT,
                     "%g mm/s exceeds the stage controller's maximum of %g mm/s with %g steps/mm: "
                     "choose a lower speed, or a coarser step mode with its stage.steps_per_mm",
                     speed / WB_MM / scale, limit.most * limit.unit / WB_MM / scale,
                     rig->stage.steps * WB_MM);
            return false;
        }
        snprintf(text, WB_INTERLOCK_TEXT,
                 "%g mm/s exceeds the %g mm/s that the stage's firmware allows (%s=%.9g %s): set "
                 "%s=%.0f or choose a lower speed",
                 speed / WB_MM / scale, settings->speed / WB_MM / scale, limit.name,
                 settings->speed / limit.unit, limit.unit_name, limit.name,
                 ceil(speed / limit.unit));
        return false;
    }
    const double braking = speed / settings->acceleration;
    if (braking > WB_STAGE_CHECK_BRAKING * (1.0 + ROUNDING)) {
        const struct limit_name limit = name_limit(rig, WB_GRBL_ACCELERATION);
        snprintf(text, WB_INTERLOCK_TEXT,
                 "the stage needs %.1f s to brake from %g mm/s (%s=%.9g %s), too long for a safe "
                 "stop: set %s=%.0f or choose a lower speed",
                 braking, speed / WB_MM / scale, limit.name, settings->acceleration / limit.unit,
                 limit.unit_name, limit.name, ceil(speed / WB_STAGE_CHECK_BRAKING / limit.unit));
        return false;
    }
    return true;
}

bool wb_stage_check(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                    const struct wb_stage_motion *motion, char text[WB_INTERLOCK_TEXT])
{
    if (settings->fault[0]) {
        snprintf(text, WB_INTERLOCK_TEXT, "%s", settings->fault);
        return false;
    }
    if (!check_units(settings, rig, text) || !check_speed(settings, rig, motion->speed, text))
        return false;
    if (has_limits(settings, motion->from) && !has_limits(settings, motion->to)) {
        snprintf(text, WB_INTERLOCK_TEXT,
                 "a move to machine position %.3f mm exceeds the stage's soft limits, %g mm to 0 "
                 "($%d): choose a shorter travel, or home the stage if its present position is not "
                 "the reported %.3f mm",
                 motion->to / WB_MM, -settings->travel / WB_MM, number(rig, WB_GRBL_TRAVEL),
                 motion->from / WB_MM);
        return false;
    }
    return true;
}

bool wb_stage_check_test(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                         double position, double travel, char text[WB_INTERLOCK_TEXT])
{
    const struct wb_stage_motion motion = {.from = position,
                                           .to = position + rig->stage.down * travel,
                                           .speed = rig->stage.speed * rig->time_scale};
    return wb_stage_check(settings, rig, &motion, text);
}

double wb_stage_check_way_up(const struct wb_stage_settings *settings, const struct wb_rig *rig,
                             double position)
{
    if (!has_limits(settings, position))
        return HUGE_VAL;
    return fmax(rig->stage.down > 0 ? position + settings->travel : -position, 0.0);
}
