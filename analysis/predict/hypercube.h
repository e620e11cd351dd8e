/* Latin hypercube samples (McKay, Beckman and Conover, Technometrics 21:239, 1979): of n points in
 * d dimensions each dimension has exactly one point in each of n equal strata.
 *
 * Strata are in random order, from which what it has in common with the dimensions before it is
 * taken out (Owen, JASA 89:1517, 1994): by chance alone dimensions would be correlated by
 * n^(-1/2), which would count as an effect of one where it is the other's.
 */
#ifndef WB_ANALYSIS_PREDICT_HYPERCUBE_H
#define WB_ANALYSIS_PREDICT_HYPERCUBE_H

#include <stdint.h>

/* Fills points (n x dimensions, fewer than n), each within (0, 1): the same numbers for the same
 * seed. */
void wb_hypercube_fill(uint64_t seed, int n, int dimensions, double *points);

#endif
