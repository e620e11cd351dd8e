/* Measures the speed of the stage in a motion from its own reports, excluding acceleration and
 * braking. A controller does not report that its speed limit or a feed override slows a motion
 * down.
 */
#ifndef WB_DAQ_ACQUIRE_SPEED_WATCH_H
#define WB_DAQ_ACQUIRE_SPEED_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/motion.h"

/* All members are private. */
struct wb_speed_watch {
    double from, to, ramp; /* m, travel at begin and end, and of the acceleration */
    double commanded;      /* m/s */
    int n;                 /* reports used */
    int64_t first_ns, last_ns;
    double first, last; /* m */
};

/* Begins a motion between two travels (m) with the commanded speed and the stage's acceleration. */
void wb_speed_watch_begin(struct wb_speed_watch *watch, double from, double to,
                          const struct wb_motion_limits *top);

/* Adds a report that arrived at t_ns. */
void wb_speed_watch_add(struct wb_speed_watch *watch, int64_t t_ns, double travel);

/* m/s; NaN if the reports span less than a second. */
double wb_speed_watch_speed(const struct wb_speed_watch *watch);

/* True if the speed differs from the commanded one by more than 1 % and the effect of late reports.
 */
bool wb_speed_watch_is_off(const struct wb_speed_watch *watch);

#endif
