/* Linear interpolation between two numbers. */
#ifndef WB_BASE_INTERPOLATE_H
#define WB_BASE_INTERPOLATE_H

/* Exactly `from` at a fraction of 0 and exactly `to` at 1. */
static inline double wb_interpolate(double from, double to, double fraction)
{
    return fraction == 1.0 ? to : from + fraction * (to - from);
}

#endif
