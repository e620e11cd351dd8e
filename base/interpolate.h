/* Linear interpolation between two numbers. */
#ifndef WB_BASE_INTERPOLATE_H
#define WB_BASE_INTERPOLATE_H

/* Exact at fractions 0 (`from`) and 1 (`to`). */
static inline double wb_interpolate(double from, double to, double fraction)
{
    return fraction == 1.0 ? to : from + fraction * (to - from);
}

#endif
