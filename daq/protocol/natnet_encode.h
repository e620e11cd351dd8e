/* Encoding of NatNet datagrams: those of a client, and those of a server of any version from 2.5 to
 * 4.4 (for the virtual rig and the tests).
 *
 * Each function writes a complete datagram to `buffer` and returns its size; 0 if it does not fit
 * `size` or its contents are invalid.
 */
#ifndef WB_DAQ_PROTOCOL_NATNET_ENCODE_H
#define WB_DAQ_PROTOCOL_NATNET_ENCODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/natnet.h"

/* Messages without payload (KEEPALIVE, DISCONNECT, UNRECOGNIZED_REQUEST as the reply to an unknown
 * request), with a text (REQUEST: "FrameRate", "UnitsToMillimeters", ...), and with one number
 * (RESPONSE). */
size_t wb_natnet_encode_empty(uint8_t *buffer, size_t size, enum wb_natnet_message message);
size_t wb_natnet_encode_text(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                             const char *text);
size_t wb_natnet_encode_integer(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                                int32_t value);

/* --- client --- */

/* CONNECT in the 3.x form of 264 bytes, or with `extended` in the 4.x form of 271 bytes, which also
 * requests a bitstream of at most 4.1 from a unicast server. */
size_t wb_natnet_encode_connect(uint8_t *buffer, size_t size, const char *name, bool extended);
/* ECHOREQUEST; the response repeats the stamp, which should be the client's clock. */
size_t wb_natnet_encode_echo_request(uint8_t *buffer, size_t size, uint64_t stamp);

/* --- server --- */

/* SERVERINFO; the connection fields are included if `has_connection` is set. */
size_t wb_natnet_encode_server(uint8_t *buffer, size_t size, const struct wb_natnet_server *server);

/* FRAMEOFDATA in the layout of `version`; fields that the version lacks are omitted. Every count
 * must equal the number in its array (n_labelled equal to mocap.n_markers, and so on); points of a
 * set and bodies of a group begin at `first_...`. Channels of analogs, markers inside bodies
 * (before 3.0) and of assets are sent as zeros in the given numbers. 4.0 includes the precision
 * stamp if has_precision is set, 4.1 always. */
size_t wb_natnet_encode_frame(uint8_t *buffer, size_t size, struct wb_natnet_version version,
                              const struct wb_natnet_frame *frame);

size_t wb_natnet_encode_echo_response(uint8_t *buffer, size_t size, uint64_t stamp, uint64_t ticks);
size_t wb_natnet_encode_response_real(uint8_t *buffer, size_t size, float value);

#endif
