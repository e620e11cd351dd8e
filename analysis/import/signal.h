/* What an instrument showed over time on a clock of its own, and what is seen in it at once: its
 * noise, and what shakes in it. */
#ifndef WB_ANALYSIS_IMPORT_SIGNAL_H
#define WB_ANALYSIS_IMPORT_SIGNAL_H

#include <stddef.h>

/* Samples, times ascending. */
struct wb_signal {
    const double *t, *x;
    size_t n;
};

/* First sample at time t or later; n where there is none. */
size_t wb_signal_index(const struct wb_signal *signal, double t);

/* Standard deviation of a sample's noise, from second differences. */
double wb_signal_noise(const struct wb_signal *signal);

/* How far each sample is from the middle of those 0.2 s before and after it, into out[n]. */
void wb_signal_shake(const struct wb_signal *signal, double *out);

#endif
