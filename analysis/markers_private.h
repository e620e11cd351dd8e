/* Shared by markers.c (following) and markers_chain.c (finding). */
#ifndef WB_ANALYSIS_MARKERS_PRIVATE_H
#define WB_ANALYSIS_MARKERS_PRIVATE_H

#include "analysis/markers.h"

/* As wb_markers_chain(); `cost` receives what the chain costs (less is better), and with
 * `need_ends` the first and the last marker must be in it. */
int wb_markers_find_chain(const double (*points)[3], int n, const struct wb_specimen *specimen,
                          double noise, int least, bool need_ends, int *chosen, double *cost);

/* Cost of two points as markers `i` < `j`: square of the distance's error over its tolerance. */
double wb_markers_link_cost(const struct wb_specimen *specimen, double noise, int i, int j,
                            const double *a, const double *b);

double wb_markers_distance(const double *a, const double *b);

#endif
