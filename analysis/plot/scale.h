/* Scales of axes: a range of values, where its ticks stand and how they read. Pure. */
#ifndef WB_ANALYSIS_PLOT_SCALE_H
#define WB_ANALYSIS_PLOT_SCALE_H

#include <stdbool.h>

#define WB_SCALE_TICKS 24
#define WB_SCALE_TEXT 32

struct wb_scale {
    double low, high; /* of the axis, low < high */
    bool logarithmic;
    int n_ticks;
    double ticks[WB_SCALE_TICKS];               /* within low..high, ascending */
    char labels[WB_SCALE_TICKS][WB_SCALE_TEXT]; /* Pango markup */
};

/* The axis' range for data from `low` to `high`: a zero near the data is taken in, and a little
 * room is left at each end that is not zero. A logarithmic one needs low > 0. Data without extent,
 * or NaN, get a range around them. */
void wb_scale_fit(struct wb_scale *scale, double low, double high, bool logarithmic);

/* Chooses at most `most` (at least 2) ticks at 1, 2, 2.5 or 5 times a power of ten within the
 * range that is set, at powers of ten on a logarithmic scale. */
void wb_scale_place_ticks(struct wb_scale *scale, int most);

/* Where a value stands on the axis, 0 at its low end to 1 at its high end; NaN for what a
 * logarithmic scale cannot show. */
double wb_scale_position(const struct wb_scale *scale, double value);

#endif
