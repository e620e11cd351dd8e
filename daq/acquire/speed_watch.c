#include "daq/acquire/speed_watch.h"

#include <math.h>
#include <string.h>

#include "base/units.h"

#define LEAST_S 1.0    /* shortest time over which the speed is measured */
#define TOLERANCE 0.01 /* of the speed, relative */
#define LATE_S 0.05    /* variation of the delay of reports */

void wb_speed_watch_begin(struct wb_speed_watch *watch, double from, double to,
                          const struct wb_motion_limits *top)
{
    memset(watch, 0, sizeof *watch);
    watch->from = from;
    watch->to = to;
    watch->commanded = top->speed;
    watch->ramp = 0.5 * top->speed * top->speed / top->acceleration;
}

void wb_speed_watch_add(struct wb_speed_watch *watch, int64_t t_ns, double travel)
{
    const double low = fmin(watch->from, watch->to) + watch->ramp;
    const double high = fmax(watch->from, watch->to) - watch->ramp;
    /* The end points are excluded: the stage may stand there. */
    if (!(travel >= low && travel <= high) || travel == watch->from || travel == watch->to)
        return;
    if (watch->n++ == 0) {
        watch->first_ns = t_ns;
        watch->first = travel;
    }
    watch->last_ns = t_ns;
    watch->last = travel;
}

static double lasted(const struct wb_speed_watch *watch)
{
    return wb_seconds_from_ns(watch->last_ns - watch->first_ns);
}

double wb_speed_watch_speed(const struct wb_speed_watch *watch)
{
    if (watch->n < 2 || lasted(watch) < LEAST_S)
        return (double)NAN;
    return fabs(watch->last - watch->first) / lasted(watch);
}

bool wb_speed_watch_is_off(const struct wb_speed_watch *watch)
{
    const double speed = wb_speed_watch_speed(watch);
    return fabs(speed / watch->commanded - 1.0) > TOLERANCE + LATE_S / lasted(watch);
}
