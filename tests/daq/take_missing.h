/* Missing positions of a take, for tests. */
#ifndef WB_TESTS_DAQ_TAKE_MISSING_H
#define WB_TESTS_DAQ_TAKE_MISSING_H

#include "daq/take/take.h"

/* Fraction of the marker positions that are missing, over all frames and measured markers. For a
 * take without markers, the same of its rigid bodies. */
static inline double take_missing(const struct wb_take *take)
{
    size_t n[2] = {0}, seen[2] = {0};
    for (size_t i = 0; i < take->n_points; i++) {
        const bool measured = wb_take_is_measured(take->points[i].kind);
        if (!measured && take->points[i].kind != WB_TAKE_BODY)
            continue;
        n[measured]++;
        seen[measured] += take->points[i].n_seen;
    }
    const bool which = n[true] > 0;
    const double all = (double)n[which] * (double)take->n_frames;
    return all > 0.0 ? 1.0 - (double)seen[which] / all : 0.0;
}

#endif
