/* NatNet datagrams, encoded: what a client sends, and what a server of any version from 2.5 to 4.4
 * sends (for the virtual rig and the tests).
 *
 * Each function writes one whole datagram into `buffer` and returns its size, or 0 when it does not
 * fit `size` (or cannot be sent at all).
 */
#ifndef WB_DAQ_PROTOCOL_NATNET_ENCODE_H
#define WB_DAQ_PROTOCOL_NATNET_ENCODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "daq/protocol/natnet.h"

/* Messages of no payload (KEEPALIVE, DISCONNECT, UNRECOGNIZED_REQUEST, the answer to a request the
 * server does not know), of a text (REQUEST: "FrameRate", "UnitsToMillimeters", ...) and of one
 * number (RESPONSE). */
size_t wb_natnet_encode_empty(uint8_t *buffer, size_t size, enum wb_natnet_message message);
size_t wb_natnet_encode_text(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                             const char *text);
size_t wb_natnet_encode_integer(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                                int32_t value);

/* --- client --- */

/* CONNECT in the 3.x form of 264 bytes, or `extended` in the 4.x form of 271 bytes, which also asks
 * a unicast server for a bitstream of 4.1 at most. */
size_t wb_natnet_encode_connect(uint8_t *buffer, size_t size, const char *name, bool extended);
/* The response repeats the stamp verbatim: pass the client's clock. */
size_t wb_natnet_encode_echo_request(uint8_t *buffer, size_t size, uint64_t stamp);

/* --- server --- */

/* SERVERINFO; the connection fields are sent when `has_connection` is set. */
size_t wb_natnet_encode_server(uint8_t *buffer, size_t size, const struct wb_natnet_server *server);

/* FRAMEOFDATA in the layout of `version`. Fields that the version does not have are left out.
 * Every count must be what its array holds (n_labelled equal to mocap.n_markers, and so on); points
 * of a set, bodies of a group are taken from `first_..` on. Channels of analogs, markers inside
 * bodies (before 3.0) and of assets are sent as zeros in the numbers given. 4.0 sends the precision
 * stamp when has_precision is set, 4.1 always. */
size_t wb_natnet_encode_frame(uint8_t *buffer, size_t size, struct wb_natnet_version version,
                              const struct wb_natnet_frame *frame);

size_t wb_natnet_encode_echo_response(uint8_t *buffer, size_t size, uint64_t stamp, uint64_t ticks);
size_t wb_natnet_encode_response_real(uint8_t *buffer, size_t size, float value);

#endif
