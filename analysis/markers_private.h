/* Shared by markers.c (following) and markers_chain.c (finding). */
#ifndef WB_ANALYSIS_MARKERS_PRIVATE_H
#define WB_ANALYSIS_MARKERS_PRIVATE_H

#include "analysis/markers.h"

/* What a chain is sought among; the members are wb_markers_chain()'s parameters. */
struct wb_markers_search {
    const double (*points)[3];
    int n;
    const struct wb_specimen *specimen;
    double noise;
    int least;
    bool need_ends; /* the first and the last marker must be in the chain */
};

/* As wb_markers_chain(); `cost` receives what the chain costs (less is better). */
int wb_markers_find_chain(const struct wb_markers_search *wanted, int *chosen, double *cost);

/* Cost of two points as markers `i` < `j`: square of the distance's error over its tolerance. */
double wb_markers_link_cost(const struct wb_specimen *specimen, double noise, int i, int j,
                            const double *a, const double *b);

/* Between two points of space, m. */
double wb_markers_distance(const double *a, const double *b);

#endif
