/* Area and second moment of a full circle of given diameter. */
#ifndef WB_BASE_CIRCLE_H
#define WB_BASE_CIRCLE_H

#include <math.h>

/* pi d^2 / 4. */
static inline double wb_circle_area(double diameter)
{
    return 0.25 * M_PI * diameter * diameter;
}

/* Second moment of area about a diameter, pi d^4 / 64. */
static inline double wb_circle_second_moment(double diameter)
{
    return M_PI * pow(diameter, 4.0) / 64.0;
}

#endif
