/* Byte streams: serial ports, pseudo-terminals, UDP, memory, behind one table.
 *
 * Addresses are `scheme:rest`:
 *     serial:/dev/ttyUSB0,9600,8n1[,dtr=off]   a real port through libserialport
 *     pty:/dev/pts/5[,9600,8n1]                a pseudo-terminal through termios
 *     udp:HOST:PORT                            unicast: datagrams to and from HOST:PORT
 *     udp:HOST:PORT,group=ADDR:PORT[,interface=ADDR]   commands to HOST:PORT, data from a
 *                                              multicast group, joined on that interface
 *     memory:                                  bytes pushed in by the caller (replay, tests)
 * After a port's path, in any order: baud rate (default 9600), frame (default 8n1),
 * dtr=on|off|keep, rts=on|off, flow=none|xonxoff|rtscts. The path may be a link such as
 * /dev/serial/by-id/... A group of 255.255.255.255:PORT takes a server's broadcasts; `interface` is
 * an address or a name such as eth0. All streams are non-blocking. A stream is used by one thread.
 */
#ifndef WB_DAQ_STREAM_STREAM_H
#define WB_DAQ_STREAM_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/reason.h"

struct wb_stream; /* opaque */

/* At most this many bytes come from one read: the largest UDP payload. */
#define WB_STREAM_READ_MAX 65536

/* Opens the address. On failure *out is NULL and one message says what to do (for a permission
 * error, which group to join). */
WB_MUST_CHECK enum wb_status wb_stream_open(struct wb_stream **out, const char *address);
/* The same; `why` holds the message. NULL: that is logged. */
WB_MUST_CHECK enum wb_status wb_stream_open_with_reason(struct wb_stream **out, const char *address,
                                                        struct wb_reason *why);
void wb_stream_close(struct wb_stream *stream); /* accepts NULL */

/* The address it was opened with; owned by the stream. */
const char *wb_stream_address(const struct wb_stream *stream);

/* Opens the device of a stream again that went away (a read or write gave WB_ERR_IO): the one at
 * the same address or, of a USB adapter, the same one under another number. False, without a
 * message, while it is not there, and always where it cannot go away. */
bool wb_stream_reopen(struct wb_stream *stream);

/* Descriptors to poll for reading, at most two (UDP with a group has two); returns how many.
 * A memory stream has none. */
int wb_stream_descriptors(const struct wb_stream *stream, int descriptors[2]);

/* Reads what is there: one datagram, or the bytes that wait, up to `size`. *n is 0 when nothing
 * waits. WB_ERR_IO when the device went away. */
WB_MUST_CHECK enum wb_status wb_stream_read(struct wb_stream *stream, void *buffer, size_t size,
                                            size_t *n);

/* Writes all bytes (a datagram on UDP). A port that cannot take them within 50 ms fails with
 * WB_ERR_TIMEOUT; nothing is retried behind the caller's back. */
WB_MUST_CHECK enum wb_status wb_stream_write(struct wb_stream *stream, const void *bytes, size_t n);

/* Datagrams that the kernel threw away because they were not read in time, since opening; 0 for
 * streams that cannot tell. Known after the read that follows the loss. */
uint64_t wb_stream_kernel_drops(const struct wb_stream *stream);

/* What opening it could not set right and the operator should know, with how to mend it; "" when
 * all is well. Owned by the stream. */
const char *wb_stream_caution(const struct wb_stream *stream);

/* Memory streams only: appends one block of bytes. wb_stream_read() reads one block a call, as it
 * does with datagrams. */
WB_MUST_CHECK enum wb_status wb_stream_memory_push(struct wb_stream *stream, const void *bytes,
                                                   size_t n);

#endif
