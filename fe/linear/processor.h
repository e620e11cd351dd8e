/* Attributes that compile a loop for several vector instruction sets, one of which is chosen at run
 * time.
 *
 * The body of a loop is an inline function on compiler vector types. Functions with the attributes
 * below call it, each compiled for another instruction set. Vectors wider than the file's own
 * target are passed between inlined functions only.
 */
#ifndef WB_FE_LINEAR_PROCESSOR_H
#define WB_FE_LINEAR_PROCESSOR_H

#include <stdbool.h>

/* Warns about passing wide vectors to functions, which does not happen because they are inlined. */
#pragma GCC diagnostic ignored "-Wpsabi"

#define WB_ALWAYS_INLINE inline __attribute__((always_inline))

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define WB_HAS_X86_VARIANTS
#define WB_AVX2 __attribute__((target("avx2")))
#define WB_AVX512 __attribute__((target("avx2,avx512f,avx512dq,avx512vl")))

static inline bool wb_processor_has_avx2(void)
{
    return __builtin_cpu_supports("avx2");
}

static inline bool wb_processor_has_avx512(void)
{
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}
#endif

#endif
