/* Test for two batches among numbers of specimens: the split into a lower and an upper group of at
 * least two each that separates them best, compared with the best split of samples from one normal
 * population.
 *
 * Engelman and Hartigan (1969), Percentage points of a test for clusters, JASA 64:1647: the largest
 * ratio of the sum of squares between groups to that within. Its limit is found by simulation with
 * a fixed seed. */
#ifndef WB_ANALYSIS_DATASET_BATCHES_H
#define WB_ANALYSIS_DATASET_BATCHES_H

#include <stdbool.h>

enum {
    WB_BATCHES_LEAST = 5 /* least number of values for the test */
};

struct wb_batches {
    bool are_two;
    double border; /* between the groups; numbers of the upper one are larger */
    double apart;  /* difference of the groups' means */
    double ratio, limit;
};

/* Tests n numbers; `level`, above 0, is the probability of finding two batches in one population.
 * Fewer than WB_BATCHES_LEAST numbers count as one batch. */
struct wb_batches wb_batches_find(const double *numbers, int n, double level);

#endif
