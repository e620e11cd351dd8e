/* A file of another program stored in a recording: one stream, whose chunks are pieces of the file,
 * each compressed separately with zstd. */
#ifndef WB_DAQ_RECORDING_RECORDING_FOREIGN_H
#define WB_DAQ_RECORDING_RECORDING_FOREIGN_H

#include "daq/recording/recording.h"

/* Prefix of the address of such a stream; the file name follows. */
#define WB_RECORDING_FOREIGN "file:"

bool wb_recording_foreign_is(const struct wb_recording_stream *stream);

/* Appends the bytes of a file to a declared stream. The times of the pieces run from first_ns to
 * last_ns, as if the file had been written during the measurement. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_append(struct wb_recording *recording, int stream,
                                                         const void *bytes, size_t n,
                                                         int64_t first_ns, int64_t last_ns);

/* Decompresses a chunk to bytes + *n and adds its size to *n. WB_ERR_FORMAT, without a message, if
 * the chunk is damaged or *n would exceed `capacity`. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_unpack(const void *chunk, size_t n_chunk,
                                                         uint8_t *bytes, size_t *n,
                                                         size_t capacity);

#endif
