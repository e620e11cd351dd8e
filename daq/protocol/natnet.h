/* NatNet 2.5 to 4.4, the protocol of the motion-capture server: contents of its datagrams, and
 * bounds-checked decoders as pure functions of (bytes, length).
 *
 * A datagram is `uint16 message, uint16 payload bytes`, then the payload; little-endian, unpadded.
 * The layout of a frame depends on the version that the server announced in SERVERINFO. Decoders do
 * not log: on failure they return WB_ERR_FORMAT with location and reason in a fault, and leave the
 * result unchanged, except wb_natnet_decode_frame(), whose large result is always overwritten. A
 * malicious datagram is decoded in time proportional to its length, without reading beyond it.
 *
 * The vendor's published clients decode 4.2 to 4.4 like 4.1. No captured stream of these versions
 * was available. They and later versions are decoded like 4.1 and, like every frame, accepted only
 * if sections, stamps and end mark match to the last byte; other layouts are rejected.
 */
#ifndef WB_DAQ_PROTOCOL_NATNET_H
#define WB_DAQ_PROTOCOL_NATNET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "daq/protocol/sample.h"

enum wb_natnet_message {
    WB_NATNET_CONNECT = 0,
    WB_NATNET_SERVERINFO = 1,
    WB_NATNET_REQUEST = 2,
    WB_NATNET_RESPONSE = 3,
    WB_NATNET_REQUEST_MODELDEF = 4,
    WB_NATNET_MODELDEF = 5,
    WB_NATNET_REQUEST_FRAMEOFDATA = 6,
    WB_NATNET_FRAMEOFDATA = 7,
    WB_NATNET_MESSAGESTRING = 8,
    WB_NATNET_DISCONNECT = 9,
    WB_NATNET_KEEPALIVE = 10,
    WB_NATNET_DISCONNECTBYTIMEOUT = 11,
    WB_NATNET_ECHOREQUEST = 12,
    WB_NATNET_ECHORESPONSE = 13,
    WB_NATNET_DISCOVERY = 14,
    WB_NATNET_UNRECOGNIZED_REQUEST = 100
};

#define WB_NATNET_COMMAND_PORT 1510
#define WB_NATNET_DATA_PORT 1511
#define WB_NATNET_HEADER 4          /* bytes */
#define WB_NATNET_MAX_PAYLOAD 65503 /* bytes */

struct wb_natnet_version {
    uint8_t major, minor;
};

/* True if `version` is major.minor or later. */
bool wb_natnet_version_at_least(struct wb_natnet_version version, int major, int minor);

/* Reason why a datagram was rejected. */
struct wb_natnet_fault {
    size_t offset;      /* bytes into the datagram */
    const char *reason; /* static text */
};

/* A datagram with decoded header. */
struct wb_natnet_packet {
    int message; /* enum wb_natnet_message, or an unknown number */
    const uint8_t *payload;
    size_t n_payload;
};

/* SERVERINFO: description of the server. */
struct wb_natnet_server {
    char name[256];
    uint8_t app_version[4];
    uint8_t natnet_version[4];
    bool has_connection;      /* the members below were sent (NatNet 3.0 and later) */
    uint64_t clock_frequency; /* ticks per second of echo and camera stamps */
    uint16_t data_port;
    bool multicast;
    uint8_t group[4];
};

/* A named set of points. Its points are solved positions, also of markers that no camera sees, and
 * are not used as measurements. */
struct wb_natnet_set {
    char name[64];           /* truncated */
    int n_points;            /* as sent */
    int first_point, n_kept; /* in `points` */
};

struct wb_natnet_body {
    int32_t id;
    float position[3]; /* m */
    float rotation[4]; /* quaternion x, y, z, w */
    float error;       /* m, mean marker error */
    int16_t params;    /* bit 0: tracked; 0 before 2.6 */
    int n_markers;     /* listed inside the body, before 3.0 */
};

/* A skeleton, or (4.1) a trained markerset asset. */
struct wb_natnet_group {
    int32_t id;
    int n_bodies;           /* as sent */
    int first_body, n_kept; /* in `bodies` */
    int n_markers;          /* assets only */
};

/* A force plate or an analog device. */
struct wb_natnet_analog {
    int32_t id;
    int n_channels;
    int n_values; /* sum over all channels */
};

#define WB_NATNET_MAX_SETS 32
#define WB_NATNET_MAX_POINTS 512
#define WB_NATNET_MAX_BODIES 256
#define WB_NATNET_MAX_GROUPS 16
#define WB_NATNET_MAX_ANALOGS 16

/* A frame of data. `mocap` holds the labelled markers and the stamps; its t_ns and t_clock are set
 * by the client. Members n_ are the numbers sent; an array holds the first elements, up to its
 * length
 * (`mocap.n_markers` is the number stored). */
struct wb_natnet_frame {
    struct wb_mocap_frame mocap;
    int n_labelled;
    int n_sets, n_points; /* n_points: kept */
    struct wb_natnet_set sets[WB_NATNET_MAX_SETS];
    float points[WB_NATNET_MAX_POINTS][3];
    int n_others; /* the legacy list, which repeats labelled markers */
    float others[WB_MAX_MARKERS][3];
    int n_bodies;      /* rigid bodies at top level, at the beginning of `bodies` */
    int n_bodies_kept; /* in `bodies`: rigid bodies, bones, bodies of assets, in this order */
    struct wb_natnet_body bodies[WB_NATNET_MAX_BODIES];
    int n_skeletons, n_assets, n_force_plates, n_devices;
    struct wb_natnet_group skeletons[WB_NATNET_MAX_GROUPS];
    struct wb_natnet_group assets[WB_NATNET_MAX_GROUPS];
    struct wb_natnet_analog force_plates[WB_NATNET_MAX_ANALOGS];
    struct wb_natnet_analog devices[WB_NATNET_MAX_ANALOGS];
    float latency; /* s, before 3.0: a capture time */
    uint32_t timecode, timecode_sub;
    double timestamp;   /* s, from 2.6 on */
    bool has_precision; /* 4.1 and later, at times 4.0 */
    uint32_t precision_seconds, precision_fraction;
};

/* Decodes the header. */
WB_MUST_CHECK enum wb_status wb_natnet_decode_packet(const uint8_t *bytes, size_t length,
                                                     struct wb_natnet_packet *packet,
                                                     struct wb_natnet_fault *fault);

/* Decodes SERVERINFO. */
WB_MUST_CHECK enum wb_status wb_natnet_decode_server(const struct wb_natnet_packet *packet,
                                                     struct wb_natnet_server *server,
                                                     struct wb_natnet_fault *fault);

/* Decodes FRAMEOFDATA of a server of `version` to its last byte. Sets t_device to the server's
 * capture time: the f64 stamp (2.7 on), the f32 stamp (2.6) or the f32 latency (2.5). A frame is
 * rejected if section sizes (4.1 on) differ from the contents, the end mark is not 0, the stamp is
 * not in 0 to 1e9 s, or stamps contradict each other. */
WB_MUST_CHECK enum wb_status wb_natnet_decode_frame(const struct wb_natnet_packet *packet,
                                                    struct wb_natnet_version version,
                                                    struct wb_natnet_frame *frame,
                                                    struct wb_natnet_fault *fault);

/* Decodes ECHOREQUEST (ticks is set to 0) or ECHORESPONSE: the client's stamp, returned unchanged,
 * and the server's clock at receipt in ticks. */
WB_MUST_CHECK enum wb_status wb_natnet_decode_echo(const struct wb_natnet_packet *packet,
                                                   uint64_t *stamp, uint64_t *ticks,
                                                   struct wb_natnet_fault *fault);

/* Decodes the text of REQUEST and MESSAGESTRING, truncated to `size` and always terminated;
 * characters that are not printable become '?'. */
WB_MUST_CHECK enum wb_status wb_natnet_decode_text(const struct wb_natnet_packet *packet,
                                                   char *text, size_t size,
                                                   struct wb_natnet_fault *fault);

/* RESPONSE: four bytes are a number, an int32 or a float32 depending on the request (0 means
 * success); other lengths are a text. */
struct wb_natnet_response {
    bool is_number;
    int32_t integer;
    float real;
    char text[128];
};
WB_MUST_CHECK enum wb_status wb_natnet_decode_response(const struct wb_natnet_packet *packet,
                                                       struct wb_natnet_response *response,
                                                       struct wb_natnet_fault *fault);

#endif
