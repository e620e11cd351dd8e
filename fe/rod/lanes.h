/* Vectors of four doubles, one for each of four fibres, as compiler vector types; they also compile
 * for targets without vector instructions. Comparisons return masks with all bits of a lane set or
 * clear. Names are short because only fe/rod/fibres.c and the files it includes use them.
 */
#ifndef WB_FE_ROD_LANES_H
#define WB_FE_ROD_LANES_H

#include <stdbool.h>

#include "fe/linear/processor.h"

enum {
    LANES = 4
};

typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(8), may_alias));
typedef long long masks
    __attribute__((vector_size(LANES * sizeof(long long)), aligned(8), may_alias));

static const long long sign_bit = (long long)0x8000000000000000ULL;

static WB_ALWAYS_INLINE lanes load(const double *p)
{
    return *(const lanes *)p;
}

static WB_ALWAYS_INLINE void store(double *p, lanes v)
{
    *(lanes *)p = v;
}

static WB_ALWAYS_INLINE lanes select_lanes(masks mask, lanes yes, lanes no)
{
    return (lanes)((mask & (masks)yes) | (~mask & (masks)no));
}

static WB_ALWAYS_INLINE lanes absolute(lanes v)
{
    return (lanes)((masks)v & ~sign_bit);
}

static WB_ALWAYS_INLINE lanes with_sign(lanes size, lanes sign)
{
    return (lanes)(((masks)size & ~sign_bit) | ((masks)sign & sign_bit));
}

static WB_ALWAYS_INLINE double smallest_of(lanes v)
{
    const double a = v[0] < v[1] ? v[0] : v[1], b = v[2] < v[3] ? v[2] : v[3];
    return a < b ? a : b;
}

static WB_ALWAYS_INLINE double largest_of(lanes v)
{
    const double a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
    return a > b ? a : b;
}

static WB_ALWAYS_INLINE bool any(masks mask)
{
    long long all = 0;
    for (int i = 0; i < LANES; i++)
        all |= mask[i];
    return all != 0;
}

static WB_ALWAYS_INLINE lanes all_lanes(double value)
{
    return value - (lanes){0};
}

/* 1 - exp(-x) for x >= 0, relative error about 1e-16. The exponential is 2^-k times that of the
 * remainder of x after k ln 2, at most ln 2 / 2 in magnitude. exp(remainder) - 1 is a Taylor
 * polynomial whose terms are added in pairs to shorten the dependency chain. */
static WB_ALWAYS_INLINE lanes one_less_exponential(lanes x)
{
    const double per_ln2 = 1.4426950408889634074, to_integer = 6755399441055744.0; /* 1.5 * 2^52 */
    const double ln2_high = 6.93147180369123816490e-01, ln2_low = 1.90821492927058770002e-10;
    const lanes most = all_lanes(700.0), one = all_lanes(1.0);
    const lanes size = select_lanes(x < most, x, most);
    const lanes shifted = to_integer - size * per_ln2;
    const lanes k = to_integer - shifted;
    const lanes r = -((size - k * ln2_high) - k * ln2_low);
    const lanes r2 = r * r, r4 = r2 * r2;
    const lanes first = (1.0 / 2 + r * (1.0 / 6)) + (1.0 / 24 + r * (1.0 / 120)) * r2;
    const lanes second = (1.0 / 720 + r * (1.0 / 5040)) + (1.0 / 40320 + r * (1.0 / 362880)) * r2;
    const lanes third =
        (1.0 / 3628800 + r * (1.0 / 39916800)) + (1.0 / 479001600 + r * (1.0 / 6227020800)) * r2;
    const lanes less_one = r + r2 * (first + (second + third * r4) * r4);
    /* The lowest bits of `shifted` hold -k: add it to the exponent of 1. */
    const lanes power = (lanes)(((masks)shifted << 52) + (masks)one);
    return (1.0 - power) - power * less_one;
}

#endif
