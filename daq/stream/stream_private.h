/* Functions of daq/stream/stream.h that only tests call. */
#ifndef WB_DAQ_STREAM_STREAM_PRIVATE_H
#define WB_DAQ_STREAM_STREAM_PRIVATE_H

#include "daq/stream/stream.h"

/* Memory streams only: removes and returns bytes written with wb_stream_write(), at most `size`;
 * returns their number. */
size_t wb_stream_memory_take_written(struct wb_stream *stream, void *buffer, size_t size);

#endif
