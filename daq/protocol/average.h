/* Running mean and standard deviation (Welford's algorithm), for zeros, tares and checks. */
#ifndef WB_DAQ_PROTOCOL_AVERAGE_H
#define WB_DAQ_PROTOCOL_AVERAGE_H

#include <math.h>
#include <stdint.h>

/* All zero: empty. */
struct wb_average {
    int64_t n;
    double mean;
    double squares; /* sum of squared deviations from the mean */
};

static inline void wb_average_add(struct wb_average *average, double value)
{
    average->n++;
    const double off = value - average->mean;
    average->mean += off / (double)average->n;
    average->squares += off * (value - average->mean);
}

/* Standard deviation of a single value; 0 with fewer than two values. */
static inline double wb_average_deviation(const struct wb_average *average)
{
    return average->n > 1 ? sqrt(average->squares / (double)(average->n - 1)) : 0.0;
}

#endif
