/* Declarations for the tests of markers.c. */
#ifndef WB_ANALYSIS_ALIGN_MARKERS_PRIVATE_H
#define WB_ANALYSIS_ALIGN_MARKERS_PRIVATE_H

#include "analysis/align/markers.h"

/* The best chain through one frame's points: `chosen` (n_markers) receives indices into `points` or
 * -1. Returns the number of markers in it, or 0 if there is no chain of at least `least`. */
int wb_markers_chain(const double (*points)[3], int n, const struct wb_specimen *specimen,
                     double noise, int least, int *chosen);

#endif
