/* Vector operations for kernels that the compiler's vector types lack.
 *
 * For kernels only (swept_..._kernel.c): names are short. meson.build defines REAL_IS_DOUBLE (0 or
 * 1) and INSTRUCTIONS (the name of the instruction set that it compiles for); vectors have the
 * largest width of that set. Without these definitions the header is for float and the baseline.
 */
#ifndef WB_FE_SWEPT_SWEPT_SIMD_H
#define WB_FE_SWEPT_SWEPT_SIMD_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "fe/swept/swept.h"

#ifndef REAL_IS_DOUBLE
#define REAL_IS_DOUBLE 0
#endif
#ifndef INSTRUCTIONS
#define INSTRUCTIONS baseline
#endif

#define INLINE static inline __attribute__((always_inline))

/* The name of a kernel's version: wb_swept_hex_kernel and so on, then precision, then instructions
 * (swept_kernel.h). */
#define KERNEL_VERSION(kernel) JOIN(kernel, PRECISION, INSTRUCTIONS)
#define JOIN(kernel, precision, instructions) JOIN_EXPANDED(kernel, precision, instructions)
#define JOIN_EXPANDED(kernel, precision, instructions) kernel##_##precision##_##instructions

#if REAL_IS_DOUBLE
typedef double real;
#define PRECISION double
typedef long long bits;
#define MANTISSA 52
#define ONE_BITS 0x3FF0000000000000LL
#define BELOW_TWO 0x1.fffffffffffffp0
#else
typedef float real;
#define PRECISION float
typedef int bits;
#define MANTISSA 23
#define ONE_BITS 0x3F800000
#define BELOW_TWO 0x1.fffffep0f
#endif

#if defined(__AVX512F__)
#define BYTES 64
#elif defined(__AVX2__)
#define BYTES 32
#else
#define BYTES 16
#endif

enum {
    LANES = BYTES / (int)sizeof(real),
    PART_LANES = BYTES / (int)sizeof(double),
    PARTS = LANES / PART_LANES /* vectors of double in one of real */
};

typedef real vec __attribute__((vector_size(BYTES), may_alias));
typedef bits vec_bits __attribute__((vector_size(BYTES), may_alias));
typedef double part __attribute__((vector_size(BYTES), may_alias));
typedef double part_anywhere __attribute__((vector_size(BYTES), may_alias, aligned(8)));

/* Values in double precision, before conversion to real. */
struct wide {
    part of[PARTS];
};

#if defined(__SSE2__)
/* The registers of these vectors, and the processor's operations on them: OF_REAL(max) is
 * _mm256_max_ps for 8 floats. */
#if BYTES == 64
typedef __m512 register_float;
typedef __m512d register_double;
#define OF_FLOAT(operation) _mm512_##operation##_ps
#define OF_DOUBLE(operation) _mm512_##operation##_pd
#elif BYTES == 32
typedef __m256 register_float;
typedef __m256d register_double;
#define OF_FLOAT(operation) _mm256_##operation##_ps
#define OF_DOUBLE(operation) _mm256_##operation##_pd
#else
typedef __m128 register_float;
typedef __m128d register_double;
#define OF_FLOAT(operation) _mm_##operation##_ps
#define OF_DOUBLE(operation) _mm_##operation##_pd
#endif
#if REAL_IS_DOUBLE
typedef register_double packed;
#define OF_REAL(operation) OF_DOUBLE(operation)
#else
typedef register_float packed;
#define OF_REAL(operation) OF_FLOAT(operation)
#endif
#endif

INLINE vec splat(real x)
{
    return x - (vec){0};
}

INLINE vec load(const real *at)
{
    return *(const vec *)at;
}

INLINE void store(real *at, vec v)
{
    *(vec *)at = v;
}

/* From any address. */
INLINE struct wide load_wide(const double *at)
{
    struct wide out;
    for (int i = 0; i < PARTS; i++)
        out.of[i] = *(const part_anywhere *)(at + i * PART_LANES);
    return out;
}

INLINE struct wide add(struct wide a, struct wide b)
{
    for (int i = 0; i < PARTS; i++)
        a.of[i] += b.of[i];
    return a;
}

INLINE struct wide subtract(struct wide a, struct wide b)
{
    for (int i = 0; i < PARTS; i++)
        a.of[i] -= b.of[i];
    return a;
}

/* 1 / sqrt(x) for x > 0, with an error of about round-off. */
INLINE vec inverse_root(vec x)
{
#if BYTES == 64 && !REAL_IS_DOUBLE
    const vec y = (vec)_mm512_rsqrt14_ps((__m512)x);
    return y * (splat(1.5f) - splat(0.5f) * x * y * y);
#elif defined(__SSE2__)
    return (real)1 / (vec)OF_REAL(sqrt)((packed)x);
#else
    vec out;
    for (int i = 0; i < LANES; i++)
        out[i] = (real)1 / (real)sqrt((double)x[i]);
    return out;
#endif
}

INLINE part part_root(part x)
{
#if defined(__SSE2__)
    return (part)OF_DOUBLE(sqrt)((register_double)x);
#else
    for (int i = 0; i < PART_LANES; i++)
        x[i] = sqrt(x[i]);
    return x;
#endif
}

/* Result type of comparisons, and selection by it. A comparison with NaN is false. */
#if BYTES == 64 && !REAL_IS_DOUBLE
typedef __mmask16 mask;
#elif BYTES == 64
typedef __mmask8 mask;
#elif defined(__SSE2__)
typedef packed mask;
#else
typedef vec_bits mask;
#endif

INLINE mask above(vec a, vec b)
{
#if BYTES == 64 && !REAL_IS_DOUBLE
    return _mm512_cmp_ps_mask((packed)a, (packed)b, _CMP_GT_OQ);
#elif BYTES == 64
    return _mm512_cmp_pd_mask((packed)a, (packed)b, _CMP_GT_OQ);
#elif BYTES == 32
    return OF_REAL(cmp)((packed)a, (packed)b, _CMP_GT_OQ);
#elif defined(__SSE2__)
    return OF_REAL(cmpgt)((packed)a, (packed)b);
#else
    return a > b;
#endif
}

INLINE bool any(mask m)
{
#if BYTES == 64
    return m != 0;
#elif defined(__SSE2__)
    return OF_REAL(movemask)(m) != 0;
#else
    bits sum = 0;
    for (int i = 0; i < LANES; i++)
        sum |= m[i];
    return sum != 0;
#endif
}

INLINE vec choose(mask m, vec a, vec b)
{
#if BYTES == 64
    return (vec)OF_REAL(mask_blend)(m, (packed)b, (packed)a);
#elif BYTES == 32
    return (vec)OF_REAL(blendv)((packed)b, (packed)a, m);
#elif defined(__SSE2__)
    return (vec)OF_REAL(or)(OF_REAL(and)(m, (packed)a), OF_REAL(andnot)(m, (packed)b));
#else
    return (vec)((m & (vec_bits)a) | (~m & (vec_bits)b));
#endif
}

INLINE vec maximum(vec a, vec b)
{
#if defined(__SSE2__)
    return (vec)OF_REAL(max)((packed)a, (packed)b);
#else
    return choose(above(a, b), a, b);
#endif
}

INLINE vec minimum(vec a, vec b)
{
#if defined(__SSE2__)
    return (vec)OF_REAL(min)((packed)a, (packed)b);
#else
    return choose(above(b, a), a, b);
#endif
}

INLINE vec narrow(struct wide a)
{
#if REAL_IS_DOUBLE
    return a.of[0];
#elif BYTES == 64
    const __m256 low = _mm512_cvtpd_ps((__m512d)a.of[0]);
    const __m256 high = _mm512_cvtpd_ps((__m512d)a.of[1]);
    return (vec)_mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
#elif BYTES == 32
    const __m128 low = _mm256_cvtpd_ps((__m256d)a.of[0]);
    const __m128 high = _mm256_cvtpd_ps((__m256d)a.of[1]);
    return (vec)_mm256_set_m128(high, low);
#elif defined(__SSE2__)
    return (vec)_mm_movelh_ps(_mm_cvtpd_ps((__m128d)a.of[0]), _mm_cvtpd_ps((__m128d)a.of[1]));
#else
    vec out;
    for (int i = 0; i < LANES; i++)
        out[i] = (real)a.of[i / PART_LANES][i % PART_LANES];
    return out;
#endif
}

INLINE vec size_of(vec a)
{
    return maximum(a, -a);
}

INLINE vec dot(const vec a[3], const vec b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Mask of the first `n` lanes, which are elements. */
INLINE mask first_lanes(int n)
{
    vec lane;
    for (int i = 0; i < LANES; i++)
        lane[i] = (real)i;
    return above(splat((real)n - (real)0.5), lane);
}

/* Lanes in a range of stations; lane 0 is station `j`. */
INLINE struct wb_swept_range lanes_counted(const struct wb_swept_range *range, int j)
{
    const int first = range->first - j, end = range->end - j;
    return (struct wb_swept_range){first > 0 ? first : 0, end < LANES ? end : LANES};
}

/* v in lanes whose station, from `j` on, is in the range, otherwise 0. */
INLINE vec only_counted(const struct wb_swept_range *range, int j, vec v)
{
    vec lane;
    for (int i = 0; i < LANES; i++)
        lane[i] = (real)i;
    const vec begin = splat((real)(range->first - j) - (real)0.5);
    const vec end = splat((real)(range->end - j) - (real)0.5);
    return choose(above(lane, begin), choose(above(end, lane), v, (vec){0}), (vec){0});
}

/* The last lane of `before`, followed by v without its last lane. */
INLINE vec shift_in(vec before, vec v)
{
#if BYTES == 64 && !REAL_IS_DOUBLE
    return __builtin_shufflevector(before, v, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27,
                                   28, 29, 30);
#elif BYTES == 64 || (BYTES == 32 && !REAL_IS_DOUBLE)
    return __builtin_shufflevector(before, v, 7, 8, 9, 10, 11, 12, 13, 14);
#elif BYTES == 32 || (BYTES == 16 && !REAL_IS_DOUBLE)
    return __builtin_shufflevector(before, v, 3, 4, 5, 6);
#else
    return __builtin_shufflevector(before, v, 1, 2);
#endif
}

#endif
