#include "daq/recording/recording_foreign.h"

#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#define WB_LOG_DOMAIN "recording"

/* Bytes of a piece before compression; there are at least two pieces, with the times of both ends.
 */
#define PIECE (1 << 20)
/* Compression level of zstd: fast, because the files are large and the user waits. */
#define LEVEL 1

bool wb_recording_foreign_is(const struct wb_recording_stream *stream)
{
    return strncmp(stream->address, WB_RECORDING_FOREIGN, strlen(WB_RECORDING_FOREIGN)) == 0;
}

static enum wb_status append_pieces(struct wb_recording *recording, int stream,
                                    const uint8_t *bytes, size_t n, const int64_t ends_ns[2],
                                    ZSTD_CCtx *context, void *packed, size_t bound)
{
    const size_t most = n / 2 + 1 < PIECE ? n / 2 + 1 : PIECE;
    const size_t n_pieces = n > 0 ? (n - 1) / most + 1 : 1;
    const double step = ((double)ends_ns[1] - (double)ends_ns[0]) / (double)n_pieces;
    for (size_t i = 0; i < n_pieces; i++) {
        const size_t from = i * most, length = n - from < most ? n - from : most;
        const int64_t t_ns =
            i + 1 == n_pieces ? ends_ns[1] : ends_ns[0] + (int64_t)(step * (double)i);
        const size_t size = ZSTD_compressCCtx(context, packed, bound, bytes + from, length, LEVEL);
        if (ZSTD_isError(size))
            return wb_fail(WB_ERR_MEMORY, "a file cannot be compressed: %s",
                           ZSTD_getErrorName(size));
        WB_TRY(wb_recording_append_chunk(recording, stream, (int64_t)i, t_ns, packed, size));
    }
    return WB_OK;
}

enum wb_status wb_recording_foreign_append(struct wb_recording *recording, int stream,
                                           const void *bytes, size_t n, int64_t first_ns,
                                           int64_t last_ns)
{
    const size_t bound = ZSTD_compressBound(PIECE);
    const int64_t ends_ns[2] = {first_ns, last_ns};
    ZSTD_CCtx *const context = ZSTD_createCCtx();
    void *const packed = malloc(bound);
    enum wb_status status = WB_ERR_MEMORY;
    if (context && packed)
        status = append_pieces(recording, stream, bytes, n, ends_ns, context, packed, bound);
    else
        status = wb_fail(WB_ERR_MEMORY, "out of memory to compress a file");
    free(packed);
    ZSTD_freeCCtx(context);
    return status;
}

enum wb_status wb_recording_foreign_unpack(const void *chunk, size_t n_chunk, uint8_t *bytes,
                                           size_t *n, size_t capacity)
{
    const size_t size = ZSTD_decompress(bytes + *n, capacity - *n, chunk, n_chunk);
    if (ZSTD_isError(size))
        return WB_ERR_FORMAT;
    *n += size;
    return WB_OK;
}
