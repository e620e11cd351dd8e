/* Common declarations of all kernels.
 *
 * A kernel is one source, swept_..._kernel.c, which meson.build compiles for float and double and
 * for each instruction set. Each of these versions is an object of the kernel's struct, whose name
 * is the struct's followed by precision and instructions:
 *
 *     const struct wb_swept_hex_kernel wb_swept_hex_kernel_float_avx2;
 */
#ifndef WB_FE_SWEPT_SWEPT_KERNEL_H
#define WB_FE_SWEPT_SWEPT_KERNEL_H

#include <stdbool.h>
#include <stddef.h>

#include "fe/swept/swept.h"

/* Declares the versions of a kernel, and lists them as [enum wb_swept_instructions][is double]. */
#ifdef WB_SWEPT_VECTOR_KERNELS
#define WB_SWEPT_KERNEL_DECLARE(kernel)                                                            \
    extern const struct kernel kernel##_float_baseline, kernel##_double_baseline;                  \
    extern const struct kernel kernel##_float_avx2, kernel##_double_avx2;                          \
    extern const struct kernel kernel##_float_avx512, kernel##_double_avx512
#define WB_SWEPT_KERNEL_VERSIONS(kernel)                                                           \
    {                                                                                              \
        [WB_SWEPT_BASELINE] = {&kernel##_float_baseline, &kernel##_double_baseline},               \
        [WB_SWEPT_AVX2] = {&kernel##_float_avx2, &kernel##_double_avx2},                           \
        [WB_SWEPT_AVX512] = {&kernel##_float_avx512, &kernel##_double_avx512},                     \
    }
#else
#define WB_SWEPT_KERNEL_DECLARE(kernel)                                                            \
    extern const struct kernel kernel##_float_baseline, kernel##_double_baseline
#define WB_SWEPT_KERNEL_VERSIONS(kernel)                                                           \
    {                                                                                              \
        [WB_SWEPT_BASELINE] = {&kernel##_float_baseline, &kernel##_double_baseline},               \
    }
#endif

/* Size of a value in the kernel's type: double or float. */
static inline size_t wb_swept_kernel_real_size(bool is_double)
{
    return is_double ? sizeof(double) : sizeof(float);
}

static inline void wb_swept_kernel_put(bool is_double, void *numbers, ptrdiff_t at, double value)
{
    if (is_double)
        ((double *)numbers)[at] = value;
    else
        ((float *)numbers)[at] = (float)value;
}

static inline double wb_swept_kernel_get(bool is_double, const void *numbers, ptrdiff_t at)
{
    return is_double ? ((const double *)numbers)[at] : (double)((const float *)numbers)[at];
}

/* A copy of `count` values in a kernel's type, in memory as from wb_swept_take(). */
void *wb_swept_kernel_convert(struct wb_memory *memory, bool is_double, const double *numbers,
                              size_t count);

#endif
