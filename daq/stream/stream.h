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

/* Bytes returned by one read at most: the largest UDP payload. */
#define WB_STREAM_READ_MAX 65536

/* Opens the address. On failure *out is NULL and one message says what to do, for example which
 * group to join after a permission error. */
WB_MUST_CHECK enum wb_status wb_stream_open(struct wb_stream **out, const char *address);
/* The same, with the message in `why`; NULL: the message is logged. */
WB_MUST_CHECK enum wb_status wb_stream_open_with_reason(struct wb_stream **out, const char *address,
                                                        struct wb_reason *why);
void wb_stream_close(struct wb_stream *stream); /* accepts NULL */

/* The address given to wb_stream_open(); owned by the stream. */
const char *wb_stream_address(const struct wb_stream *stream);

/* Tries to open a disconnected device again (a read or write returned WB_ERR_IO): at the same
 * address or, for a USB adapter, under its new number. Returns false, without a message, while the
 * device is absent, and always for streams that cannot be disconnected. */
bool wb_stream_reopen(struct wb_stream *stream);

/* Writes the descriptors to poll for reading and returns their number: two for UDP with a group,
 * none for a memory stream, otherwise one. */
int wb_stream_descriptors(const struct wb_stream *stream, int descriptors[2]);

/* Reads without blocking: one datagram, or the pending bytes, up to `size`. *n is 0 if nothing is
 * pending. WB_ERR_IO: the device was disconnected. */
WB_MUST_CHECK enum wb_status wb_stream_read(struct wb_stream *stream, void *buffer, size_t size,
                                            size_t *n);

/* Writes all bytes (one datagram on UDP). WB_ERR_TIMEOUT: the port did not accept them within 50
 * ms; the write is not retried. */
WB_MUST_CHECK enum wb_status wb_stream_write(struct wb_stream *stream, const void *bytes, size_t n);

/* Number of datagrams since opening that the kernel dropped because its buffer was full; 0 for
 * streams without this counter. Updated by the first read after the loss. */
uint64_t wb_stream_kernel_drops(const struct wb_stream *stream);

/* A warning for the operator about a setting that could not be applied when the port was opened,
 * with its remedy; "" if there is none. Owned by the stream. */
const char *wb_stream_caution(const struct wb_stream *stream);

/* Memory streams only: appends one block of bytes. Each wb_stream_read() returns one block, like a
 * datagram. */
WB_MUST_CHECK enum wb_status wb_stream_memory_push(struct wb_stream *stream, const void *bytes,
                                                   size_t n);

#endif
