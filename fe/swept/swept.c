#include "fe/swept/swept.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

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

enum wb_status wb_swept_allocate(void **out, size_t count, size_t size)
{
    *out = NULL;
    if (size == 0 || count > SIZE_MAX / 2 / size)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu values", count);
    const size_t bytes =
        (count * size + WB_SWEPT_ALIGNMENT) / WB_SWEPT_ALIGNMENT * WB_SWEPT_ALIGNMENT;
    void *memory = aligned_alloc(WB_SWEPT_ALIGNMENT, bytes);
    if (!memory)
        return wb_fail(WB_ERR_MEMORY, "out of memory for %zu values", count);
    memset(memory, 0, bytes);
    *out = memory;
    return WB_OK;
}
