/* The speed of the stage in a motion, from its own reports: between the first and the last that are
 * clear of speeding up and braking. A controller that is set too slow, or whose feed somebody has
 * overridden, says nothing. */
#ifndef WB_DAQ_ACQUIRE_SPEED_WATCH_H
#define WB_DAQ_ACQUIRE_SPEED_WATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/protocol/motion.h"

/* All of it is private. */
struct wb_speed_watch {
    double from, to, ramp; /* m, of travel */
    double commanded;      /* m/s */
    int n;                 /* reports that count */
    int64_t first_ns, last_ns;
    double first, last; /* m */
};

/* A motion between two travels begins, with the commanded speed and the stage's acceleration. */
void wb_speed_watch_begin(struct wb_speed_watch *watch, double from, double to,
                          const struct wb_motion_limits *top);

/* A report that arrived at t_ns. */
void wb_speed_watch_add(struct wb_speed_watch *watch, int64_t t_ns, double travel);

/* m/s; NaN when too short a time was seen to tell. */
double wb_speed_watch_speed(const struct wb_speed_watch *watch);

/* It differs from the commanded speed by more than 1 % and what late reports may feign. */
bool wb_speed_watch_is_off(const struct wb_speed_watch *watch);

#endif
