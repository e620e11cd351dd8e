#include "base/compress.h"

#include <stdlib.h>
#include <zstd.h>

#include "base/memory.h"

#define WB_LOG_DOMAIN "compress"

enum wb_status wb_compress(const void *bytes, size_t size, enum wb_compress_level level,
                           const char *name, void **packed, size_t *packed_size)
{
    const size_t bound = ZSTD_compressBound(size);
    void *const buffer = wb_memory_resize(NULL, bound, 1);
    ZSTD_CCtx *const context = wb_memory_need(ZSTD_createCCtx());
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, (int)level);
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    const size_t n = ZSTD_compress2(context, buffer, bound, bytes, size);
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(n)) {
        free(buffer);
        return wb_fail(WB_ERR_IO, "'%s' cannot be compressed: %s", name, ZSTD_getErrorName(n));
    }
    *packed = buffer;
    *packed_size = n;
    return WB_OK;
}
