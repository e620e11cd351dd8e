/* Bytes compressed with zstd, for files that are stored once and seldom read. */
#ifndef WB_BASE_COMPRESS_H
#define WB_BASE_COMPRESS_H

#include <stddef.h>

#include "base/status.h"

/* Compression levels of zstd. */
enum wb_compress_level {
    WB_COMPRESS_QUICK = 3,  /* 100 MB/s and more */
    WB_COMPRESS_STORED = 19 /* 1 MB/s and less: for what is stored once in a repository */
};

/* Compresses `size` bytes into an allocated buffer (caller frees), with a checksum; the result
 * depends only on the bytes and the zstd release. `name` is for messages. */
WB_MUST_CHECK enum wb_status wb_compress(const void *bytes, size_t size,
                                         enum wb_compress_level level, const char *name,
                                         void **packed, size_t *packed_size);

#endif
