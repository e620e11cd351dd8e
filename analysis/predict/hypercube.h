/* Latin hypercube samples (McKay, Beckman and Conover, Technometrics 21:239, 1979): of n points in
 * d dimensions each dimension has exactly one point in each of n equal strata.
 *
 * Strata are in random order, without their correlation with the preceding dimensions (Owen, JASA
 * 89:1517, 1994). Random order alone would correlate dimensions by n^(-1/2), and an effect of one
 * input would be attributed to another.
 */
#ifndef WB_ANALYSIS_PREDICT_HYPERCUBE_H
#define WB_ANALYSIS_PREDICT_HYPERCUBE_H

#include <stdint.h>

/* Fills points (n x dimensions, with dimensions < n), each within (0, 1): the same numbers for the
 * same seed. */
void wb_hypercube_fill(uint64_t seed, int n, int dimensions, double *points);

#endif
