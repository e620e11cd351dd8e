#include "daq/protocol/motion.h"

#include <math.h>

double wb_motion_finish(const struct wb_motion *motion)
{
    return motion->start + motion->duration[0] + motion->duration[1] + motion->duration[2];
}

void wb_motion_at(const struct wb_motion *motion, double t, double *position, double *velocity)
{
    if (t >= wb_motion_finish(motion)) {
        *position = motion->end;
        *velocity = 0.0;
        return;
    }
    double left = t - motion->start, way = 0.0, speed = motion->speed[0];
    for (int i = 0; i < WB_MOTION_PHASES && left > 0.0; i++) {
        const double spent = fmin(left, motion->duration[i]);
        way += spent * (motion->speed[i] + 0.5 * motion->acceleration[i] * spent);
        speed = motion->speed[i] + motion->acceleration[i] * spent;
        left -= spent;
    }
    *position = motion->from + motion->direction * way;
    *velocity = motion->direction * speed;
}

void wb_motion_plan(struct wb_motion *motion, double start, double from, double speed, double end,
                    const struct wb_motion_limits *limits)
{
    const double top = limits->speed, acceleration = limits->acceleration;
    const double way = fabs(end - from);
    /* Highest speed that permits braking within the remaining distance. */
    const double reachable = sqrt(acceleration * way + 0.5 * speed * speed);
    const double peak = fmin(fmax(top, speed), reachable);
    const double up = fmax(peak - speed, 0.0) / acceleration, down = peak / acceleration;
    const double cruise = way - 0.5 * up * (speed + peak) - 0.5 * down * peak;
    *motion = (struct wb_motion){
        .start = start,
        .from = from,
        .end = end,
        .direction = end < from ? -1.0 : 1.0,
        .duration = {up, peak > 0.0 ? fmax(cruise, 0.0) / peak : 0.0, down},
        .speed = {speed, peak, peak},
        .acceleration = {acceleration, 0.0, -acceleration},
    };
}

void wb_motion_brake(struct wb_motion *motion, double t, double acceleration)
{
    double position, velocity;
    wb_motion_at(motion, t, &position, &velocity);
    const double direction = motion->direction, speed = fabs(velocity);
    const double way = 0.5 * speed * speed / acceleration;
    const struct wb_motion_limits limits = {speed, acceleration};
    wb_motion_plan(motion, t, position, speed, position + direction * way, &limits);
    motion->direction = direction;
}
