/* A whole file of another program inside a recording: one stream, its chunks pieces of the file,
 * each compressed by itself with zstd. */
#ifndef WB_DAQ_RECORDING_RECORDING_FOREIGN_H
#define WB_DAQ_RECORDING_RECORDING_FOREIGN_H

#include "daq/recording/recording.h"

/* Addresses of such streams begin with this; the file's name follows. */
#define WB_RECORDING_FOREIGN "file:"

bool wb_recording_foreign_is(const struct wb_recording_stream *stream);

/* Appends the file's bytes to a declared stream. The pieces' times go from first_ns to last_ns, as
 * if the file had been written while it was measured. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_append(struct wb_recording *recording, int stream,
                                                         const void *bytes, size_t n,
                                                         int64_t first_ns, int64_t last_ns);

/* Appends what a chunk holds to `*n` of `capacity` bytes; WB_ERR_FORMAT, without a message, when it
 * is damaged or does not fit. */
WB_MUST_CHECK enum wb_status wb_recording_foreign_unpack(const void *chunk, size_t n_chunk,
                                                         uint8_t *bytes, size_t *n,
                                                         size_t capacity);

#endif
