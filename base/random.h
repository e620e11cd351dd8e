/* Counter-based random numbers: a pure function of (seed, stream, index).
 *
 * Numbers do not depend on the order of drawing, so the noise of a device's sample k does not
 * depend on other draws or on delays of the process. The mixer is SplitMix64's finaliser, chained
 * over the three words.
 */
#ifndef WB_BASE_RANDOM_H
#define WB_BASE_RANDOM_H

#include <stdint.h>

/* 64 well-mixed bits. */
uint64_t wb_random_bits(uint64_t seed, uint64_t stream, uint64_t index);

/* Uniform in [0, 1). */
double wb_random_uniform(uint64_t seed, uint64_t stream, uint64_t index);

/* Uniform in [low, high). */
double wb_random_between(uint64_t seed, uint64_t stream, uint64_t index, double low, double high);

/* Normal with mean 0 and standard deviation 1 (Box-Muller; within about 8.5). */
double wb_random_normal(uint64_t seed, uint64_t stream, uint64_t index);

#endif
