/* Whether numbers of specimens are of two batches: the split into a lower and an upper group, of at
 * least two each, that tells most, against what the same search finds in one normal population.
 *
 * Engelman and Hartigan (1969), Percentage points of a test for clusters, JASA 64:1647: the largest
 * ratio of the square between groups to that within. Its limit is found by drawing normal samples,
 * always the same ones.
 */
#ifndef WB_ANALYSIS_DATASET_BATCHES_H
#define WB_ANALYSIS_DATASET_BATCHES_H

#include <stdbool.h>

enum {
    WB_BATCHES_LEAST = 5 /* numbers: fewer tell nothing */
};

struct wb_batches {
    bool are_two;
    double border; /* between the groups; numbers of the upper one are larger */
    double apart;  /* difference of the groups' means */
    double ratio, limit;
};

/* Of n numbers; `level`, above 0, is how often one population is called two. Fewer than
 * WB_BATCHES_LEAST are one batch. */
struct wb_batches wb_batches_find(const double *numbers, int n, double level);

#endif
