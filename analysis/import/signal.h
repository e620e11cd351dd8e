/* Samples of an instrument over time on its own clock; their noise, and their fast part. */
#ifndef WB_ANALYSIS_IMPORT_SIGNAL_H
#define WB_ANALYSIS_IMPORT_SIGNAL_H

#include <stddef.h>

/* Samples, times ascending. */
struct wb_signal {
    const double *t, *x;
    size_t n;
};

/* First sample at time t or later; n if there is none. */
size_t wb_signal_index(const struct wb_signal *signal, double t);

/* Standard deviation of a sample's noise, from second differences. */
double wb_signal_noise(const struct wb_signal *signal);

/* Difference of each sample from the mean of the values 0.2 s before and 0.2 s after it, into
 * out[n]; 0 near the ends. */
void wb_signal_shake(const struct wb_signal *signal, double *out);

#endif
