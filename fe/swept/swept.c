#include "fe/swept/swept.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/swept/swept_kernel.h"

#define WB_LOG_DOMAIN "swept"

struct wb_swept_layout wb_swept_layout(int n_nodes, int n_stations)
{
    const int blocks = n_stations / WB_SWEPT_LANES + 1;
    return (struct wb_swept_layout){n_nodes, n_stations, blocks * WB_SWEPT_LANES};
}

size_t wb_swept_size(const struct wb_swept_layout *layout)
{
    return 3 * (size_t)layout->n_nodes * (size_t)layout->stride;
}

struct wb_swept_range wb_swept_range_within(struct wb_swept_range range, int n)
{
    const int end = range.end == 0 || range.end > n ? n : range.end;
    return (struct wb_swept_range){range.first < end ? range.first : end, end};
}

static bool is_supported(enum wb_swept_instructions instructions)
{
    switch (instructions) {
    case WB_SWEPT_BASELINE:
        return true;
#ifdef WB_SWEPT_VECTOR_KERNELS
    case WB_SWEPT_AVX2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case WB_SWEPT_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl") && is_supported(WB_SWEPT_AVX2);
#endif
    default:
        return false;
    }
}

static enum wb_swept_instructions best_supported(void)
{
    enum wb_swept_instructions best = WB_SWEPT_AVX512;

    while (!is_supported(best))
        best--;
    return best;
}

enum wb_status wb_swept_choose_instructions(enum wb_swept_instructions *chosen,
                                            enum wb_swept_instructions wanted)
{
    const enum wb_swept_instructions set = wanted == WB_SWEPT_BEST ? best_supported() : wanted;
    if (!is_supported(set))
        return wb_fail(
            WB_ERR_UNSUPPORTED,
            "the requested vector instructions are not supported by this processor or this "
            "build");
    *chosen = set;
    return WB_OK;
}

const char *wb_swept_instructions_name(enum wb_swept_instructions instructions)
{
    static const char *const names[] = {
        [WB_SWEPT_BASELINE] = "baseline", [WB_SWEPT_AVX2] = "avx2", [WB_SWEPT_AVX512] = "avx512"};

    return names[instructions == WB_SWEPT_BEST ? best_supported() : instructions];
}

void *wb_swept_allocate(size_t count, size_t size)
{
    const bool fits = size > 0 && count <= SIZE_MAX / 2 / size;
    const size_t bytes =
        (count * size + WB_SWEPT_ALIGNMENT) / WB_SWEPT_ALIGNMENT * WB_SWEPT_ALIGNMENT;
    return memset(wb_memory_need(fits ? aligned_alloc(WB_SWEPT_ALIGNMENT, bytes) : NULL), 0, bytes);
}

void *wb_swept_take(struct wb_memory *memory, size_t count, size_t size)
{
    return wb_memory_keep(memory, wb_swept_allocate(count, size));
}

void *wb_swept_kernel_convert(struct wb_memory *memory, bool is_double, const double *numbers,
                              size_t count)
{
    void *const out = wb_swept_take(memory, count, wb_swept_kernel_real_size(is_double));
    for (size_t i = 0; i < count; i++)
        wb_swept_kernel_put(is_double, out, (ptrdiff_t)i, numbers[i]);
    return out;
}
