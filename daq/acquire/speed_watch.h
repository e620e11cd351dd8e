/* Measures the speed of the stage during a motion from its position reports, because a controller
 * does not report that its speed limit or a feed override slows the motion down. Acceleration and
 * deceleration are excluded.
 */
#ifndef WB_DAQ_ACQUIRE_SPEED_WATCH_H
#define WB_DAQ_ACQUIRE_SPEED_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/motion.h"

/* All members are private. */
struct wb_speed_watch {
    double from, to, ramp; /* m: travel at begin and end, travel during acceleration */
    double commanded;      /* m/s */
    int n;                 /* reports used */
    int64_t first_ns, last_ns;
    double first, last; /* m */
};

/* Begins to watch a motion between two travels (m); `top`: its commanded speed and acceleration. */
void wb_speed_watch_begin(struct wb_speed_watch *watch, double from, double to,
                          const struct wb_motion_limits *top);

/* Adds a report that arrived at t_ns. */
void wb_speed_watch_add(struct wb_speed_watch *watch, int64_t t_ns, double travel);

/* Mean speed between the first and the last used report, m/s; NaN if they span less than 1 s. */
double wb_speed_watch_speed(const struct wb_speed_watch *watch);

/* True if the speed differs from the commanded one by more than 1 % plus the error that the varying
 * delay of reports can cause. */
bool wb_speed_watch_is_off(const struct wb_speed_watch *watch);

#endif
