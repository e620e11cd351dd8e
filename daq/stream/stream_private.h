/* What only tests ask of daq/stream/stream.h. */
#ifndef WB_DAQ_STREAM_STREAM_PRIVATE_H
#define WB_DAQ_STREAM_STREAM_PRIVATE_H

#include "daq/stream/stream.h"

/* Memory streams only: takes what was written with wb_stream_write() so far, up to `size`. */
size_t wb_stream_memory_take_written(struct wb_stream *stream, void *buffer, size_t size);

#endif
