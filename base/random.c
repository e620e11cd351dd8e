#include "base/random.h"

#include <math.h>

static uint64_t mix(uint64_t z)
{
    z += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

uint64_t wb_random_bits(uint64_t seed, uint64_t stream, uint64_t index)
{
    return mix(mix(mix(seed) ^ stream) ^ index);
}

static double unit(uint64_t bits)
{
    return (double)(bits >> 11) * 0x1p-53;
}

double wb_random_uniform(uint64_t seed, uint64_t stream, uint64_t index)
{
    return unit(wb_random_bits(seed, stream, index));
}

double wb_random_between(uint64_t seed, uint64_t stream, uint64_t index, double low, double high)
{
    return low + (high - low) * wb_random_uniform(seed, stream, index);
}

double wb_random_normal(uint64_t seed, uint64_t stream, uint64_t index)
{
    const uint64_t bits = wb_random_bits(seed, stream, index);
    /* unit() is below 1, so the logarithm is finite. */
    const double radius = sqrt(-2.0 * log(1.0 - unit(bits)));
    return radius * cos(2.0 * M_PI * unit(mix(bits)));
}
