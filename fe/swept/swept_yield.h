/* For kernels: the octave table of a hardening law (fe/material/hardening.h), read for a vector of
 * points. */
#ifndef WB_FE_SWEPT_SWEPT_YIELD_H
#define WB_FE_SWEPT_SWEPT_YIELD_H

#include "fe/material/hardening.h"
#include "fe/swept/swept_simd.h"

enum {
    OCTAVES = WB_HARDENING_TABLE_OCTAVES
};

/* Term `row` of the table for each lane's octave. Exponents are biased by 31 and a multiple of 32,
 * so their last five bits count the octaves from 2^-31. */
INLINE vec look_up(const real *row, vec_bits exponent)
{
#if BYTES == 64 && !REAL_IS_DOUBLE
    return (vec)_mm512_permutex2var_ps(_mm512_load_ps(row), (__m512i)exponent,
                                       _mm512_load_ps(row + 16));
#elif BYTES == 64
    const __m512i place = (__m512i)exponent;
    const __m512d low = _mm512_permutex2var_pd(_mm512_load_pd(row), place, _mm512_load_pd(row + 8));
    const __m512d high =
        _mm512_permutex2var_pd(_mm512_load_pd(row + 16), place, _mm512_load_pd(row + 24));
    const __mmask8 is_high = _mm512_test_epi64_mask(place, _mm512_set1_epi64(16));
    return (vec)_mm512_mask_blend_pd(is_high, low, high);
#elif BYTES == 32 && !REAL_IS_DOUBLE
    return (vec)_mm256_i32gather_ps(row, (__m256i)(exponent & (OCTAVES - 1)), sizeof *row);
#elif BYTES == 32
    return (vec)_mm256_i64gather_pd(row, (__m256i)(exponent & (OCTAVES - 1)), sizeof *row);
#else
    vec out;
    for (int i = 0; i < LANES; i++)
        out[i] = row[exponent[i] & (OCTAVES - 1)];
    return out;
#endif
}

/* The ratio p / x for 2^-31 <= x < 2, from a table with this many terms. */
INLINE vec yielded_part(const real *table, int terms, vec x)
{
    const vec_bits exponent = (vec_bits)x >> MANTISSA;
    const vec_bits rest = ((vec_bits)x & (((bits)1 << MANTISSA) - 1)) | ONE_BITS;
    const vec t = (vec)rest - (real)1.5;
    vec r = look_up(table + (terms - 1) * OCTAVES, exponent);
#pragma GCC unroll 8
    for (int i = terms - 2; i >= 0; i--)
        r = r * t + look_up(table + i * OCTAVES, exponent);
    return r;
}

#endif
