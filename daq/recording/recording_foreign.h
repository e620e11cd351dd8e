/* A file of another program stored in a recording: one stream, whose chunks are pieces of the file,
 * each compressed separately with zstd. */
#ifndef WB_DAQ_RECORDING_RECORDING_FOREIGN_H
#define WB_DAQ_RECORDING_RECORDING_FOREIGN_H

#include "daq/recording/recording.h"

/* Beginning of the address of such a stream; the file name follows. */
#define WB_RECORDING_FOREIGN "file:"

bool wb_recording_foreign_is(const struct wb_recording_stream *stream);

/* Appends the bytes of the file to a declared stream. The pieces get times from first_ns to
 * last_ns, as if the file had been written during the measurement. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_append(struct wb_recording *recording, int stream,
                                                         const void *bytes, size_t n,
                                                         int64_t first_ns, int64_t last_ns);

/* Decompresses a chunk to `bytes` + `*n` and advances *n, up to `capacity`; WB_ERR_FORMAT, without
 * a message, if the chunk is damaged or does not fit. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_unpack(const void *chunk, size_t n_chunk,
                                                         uint8_t *bytes, size_t *n,
                                                         size_t capacity);

#endif
