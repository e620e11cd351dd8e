#include "base/compress.h"

#include <stdlib.h>
#include <zstd.h>

#define WB_LOG_DOMAIN "compress"

enum wb_status wb_compress(const void *bytes, size_t size, enum wb_compress_level level,
                           const char *name, void **packed, size_t *packed_size,
                           struct wb_reason *why)
{
    const size_t bound = ZSTD_compressBound(size);
    void *const buffer = malloc(bound > 0 ? bound : 1);
    ZSTD_CCtx *const context = ZSTD_createCCtx();
    enum wb_status status = WB_OK;
    if (!buffer || !context) {
        status = wb_fail_to(why, WB_ERR_MEMORY, "out of memory compressing '%s'", name);
    } else {
        ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, (int)level);
        ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
        const size_t n = ZSTD_compress2(context, buffer, bound, bytes, size);
        if (ZSTD_isError(n))
            status = wb_fail_to(why, WB_ERR_IO, "'%s' cannot be compressed: %s", name,
                                ZSTD_getErrorName(n));
        *packed_size = n;
    }
    ZSTD_freeCCtx(context);
    if (status == WB_OK)
        *packed = buffer;
    else
        free(buffer);
    return status;
}
