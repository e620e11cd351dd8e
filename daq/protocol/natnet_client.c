/* The NatNet client: handshake, keepalive, clock probes, frames.
 *
 * The result depends only on received bytes and their times, not on the bytes sent: the server's
 * reply to an echo contains our own stamp, and its replies to queries arrive in the order of
 * `queries`. Therefore a replay, which sends nothing, gives the same samples and probes.
 */
#include "daq/protocol/driver.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "daq/protocol/natnet.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/protocol/natnet_watch.h"

#define CONNECT_PERIOD_NS (500 * WB_NS_PER_MS)
#define QUERY_PERIOD_NS (1000 * WB_NS_PER_MS)
#define KEEPALIVE_PERIOD_NS (1000 * WB_NS_PER_MS)
#define SILENCE_NS (3000 * WB_NS_PER_MS) /* without datagrams, after which to connect again */
#define BURST_PROBES 8
#define BURST_PERIOD_NS (64 * WB_NS_PER_MS)
#define PROBE_PERIOD_NS (1000 * WB_NS_PER_MS)
#define PROBE_MAX_NS (1000 * WB_NS_PER_MS) /* longest round trip of a useful probe */

/* Replies that are not a unit of length after which the unit is not queried again. */
#define STRAYS_MAX 3

enum query {
    QUERY_UNITS,
    QUERY_FRAME_RATE,
    QUERY_BITSTREAM, /* only for versions newer than the verified layout; see applies() */
    QUERY_TAKE,      /* only if the rig file requests a take */
    N_QUERIES
};
static const char *const queries[N_QUERIES] = {"UnitsToMillimeters", "FrameRate", "Bitstream,4.1",
                                               "StartRecording"};
#define STOP_TAKE "StopRecording"

/* s of the server's clock by which a datagram may arrive out of order. */
#define OVERTAKEN 1.0

/* Consecutive frames without a measured marker before it is reported: a person may block the view.
 */
#define UNMEASURED_FRAMES 100

/* Remarks that are made once per connection. */
enum {
    SAID_EARLY = 1 << 0,
    SAID_NO_LABELLED = 1 << 1,
    SAID_UNMEASURED = 1 << 2,
    SAID_TOO_MANY = 1 << 3,
    SAID_NOT_FINITE = 1 << 4,
    SAID_NOT_LIVE = 1 << 5,
    SAID_UNKNOWN = 1 << 6
};

struct natnet_state {
    struct wb_rig rig;
    /* Depends on received bytes only. */
    bool connected;
    struct wb_natnet_version version;
    struct wb_natnet_server server;
    int n_answers;     /* replies to the applicable queries */
    bool records_take; /* the server agreed to record a take */
    struct wb_natnet_watch watch;
    int n_strays;        /* replies that cannot belong to the first query */
    double units_factor; /* server's length unit in m */
    uint64_t n_frames, n_refused;
    int n_unmeasured; /* consecutive frames whose markers are all flagged as not measured */
    int64_t last_receive_ns;
    unsigned said;
    /* For sending. */
    int64_t next_connect_ns, next_query_ns, next_keepalive_ns, next_probe_ns;
    int64_t receive_seen_ns, receive_noticed_ns;
    int n_connects, n_probes, n_asked;
    struct wb_natnet_frame frame;
};

/* True the first time since the connection. */
static bool first_time(struct natnet_state *state, unsigned what)
{
    const bool first = !(state->said & what);
    state->said |= what;
    return first;
}

/* --- server info --- */

/* NatNet 4.1 is the newest version whose layout was verified. */
static bool is_unverified(const struct natnet_state *state)
{
    return wb_natnet_version_at_least(state->version, 4, 2);
}

/* The vendor's published clients decode 4.2 to 4.4 like 4.1; later layouts are unknown. */
static bool is_unknown(const struct natnet_state *state)
{
    return wb_natnet_version_at_least(state->version, 4, 5);
}

static bool applies(const struct natnet_state *state, enum query query)
{
    /* Only a unicast server streams a requested version. */
    if (query == QUERY_BITSTREAM)
        return is_unverified(state) && !state->server.multicast;
    return query != QUERY_TAKE || state->rig.mocap.record_take;
}

/* The query whose reply is expected next; N_QUERIES: none. */
static enum query next_query(const struct natnet_state *state)
{
    int left = state->n_answers;
    for (int query = 0; query < N_QUERIES; query++)
        if (applies(state, (enum query)query) && left-- == 0)
            return (enum query)query;
    return N_QUERIES;
}

/* Restarts all queries, because the server was restarted or sent new settings. */
static void restart_queries(struct natnet_state *state)
{
    /* Replies to earlier queries may still arrive. */
    state->n_answers = state->n_asked = 0;
    state->n_strays = 0;
    state->records_take = false;
}

/* Compares the server's multicast group with that of the rig file. */
static void check_group(const struct natnet_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_natnet_server *const server = &state->server;
    const char *const address = state->rig.mocap.address;
    const char *const listed = strstr(address, ",group=");
    if (!server->has_connection || strncmp(address, "udp:", 4) != 0)
        return;
    char group[32];
    snprintf(group, sizeof group, "%u.%u.%u.%u:%u", server->group[0], server->group[1],
             server->group[2], server->group[3], server->data_port);
    if (!server->multicast) {
        /* A group of 255.255.255.255 receives broadcasts, which SERVERINFO does not report. */
        if (listed && strncmp(listed, ",group=255.", 11) != 0)
            wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "group",
                             "the server streams unicast and sends nothing to the group in "
                             "mocap.address: remove the group");
        return;
    }
    if (!listed) {
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "group",
            "the server streams to the multicast group %s: add ',group=%s' to mocap.address", group,
            group);
        return;
    }
    const size_t n = strlen(group);
    const char *const value = listed + strlen(",group=");
    if (strncmp(value, group, n) != 0 || (value[n] != '\0' && value[n] != ','))
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "group",
            "the server streams to the multicast group %s, not the one in mocap.address", group);
}

/* Reports the server and its version. */
static void remark_version(const struct natnet_state *state, int64_t t_ns,
                           const struct wb_sink *sink)
{
    const struct wb_natnet_version version = state->version;
    char name[64];
    wb_driver_printable(name, sizeof name, state->server.name, strlen(state->server.name));
    const uint8_t *const app = state->server.app_version;
    wb_driver_remark(sink, WB_LOG_INFO, t_ns, "connected",
                     "the server is '%s' %u.%u.%u.%u, NatNet %u.%u", name, app[0], app[1], app[2],
                     app[3], version.major, version.minor);
    if (is_unverified(state))
        wb_driver_remark(sink, is_unknown(state) ? WB_LOG_WARNING : WB_LOG_INFO, t_ns, "version",
                         "the server uses NatNet %u.%u: layout %s. Its frames are decoded as 4.1 "
                         "and rejected if they do not match%s",
                         version.major, version.minor,
                         is_unknown(state) ? "unknown"
                                           : "as in the vendor's clients, not verified with a "
                                             "captured stream",
                         state->server.multicast ? "; to request 4.1, set the server to unicast "
                                                   "and remove the group from mocap.address"
                                                 : "; 4.1 is requested from the server");
    else if (!wb_natnet_version_at_least(version, 2, 5))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "version",
                         "the server uses NatNet %u.%u; the oldest supported version is 2.5: "
                         "markers may be missing",
                         version.major, version.minor);
}

static void receive_server(struct natnet_state *state, int64_t t_ns,
                           const struct wb_natnet_packet *packet, const struct wb_sink *sink,
                           struct wb_natnet_fault *fault)
{
    struct wb_natnet_server server;
    memset(&server, 0, sizeof server);
    if (wb_natnet_decode_server(packet, &server, fault) != WB_OK)
        return;
    /* Repeated replies to repeated requests are ignored. */
    if (state->connected && memcmp(&server, &state->server, sizeof server) == 0)
        return;
    if (state->connected)
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "server",
                         "the motion-capture server reports new settings");
    state->server = server;
    state->version = (struct wb_natnet_version){server.natnet_version[0], server.natnet_version[1]};
    state->connected = true;
    restart_queries(state);
    state->units_factor = 1.0;
    state->said = 0;
    remark_version(state, t_ns, sink);
    check_group(state, t_ns, sink);
}

/* --- replies --- */

/* Units of length in mm. Plausible frame rates are not among them, so that a reply to another query
 * is not mistaken for a unit. */
static bool is_unit(double mm)
{
    static const double units[] = {1000.0, 1.0, 10.0, 25.4, 304.8, 914.4, 0.001, 1e6};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (fabs(mm - units[i]) <= 1e-5 * units[i])
            return true;
    return false;
}

static void take_units(struct natnet_state *state, double units, int64_t t_ns,
                       const struct wb_sink *sink)
{
    if (!is_unit(units)) {
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "units",
                         "the server reports no known unit of length: metres are assumed");
        return;
    }
    state->units_factor = 1.0;
    if (fabs(units - 1000.0) <= 1e-2)
        return;
    state->units_factor = units * WB_MM;
    wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "units",
                     "the server's unit of length is %g mm: positions are converted to metres",
                     units);
}

static void take_frame_rate(const struct natnet_state *state, float rate, int64_t t_ns,
                            const struct wb_sink *sink)
{
    const double expected = state->rig.mocap.frame_rate;
    wb_driver_remark(sink, WB_LOG_INFO, t_ns, "rate", "the server captures %g frames/s",
                     (double)rate);
    if (expected > 0.0 && !(fabs((double)rate - expected) <= 0.005 * expected))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "rate",
                         "the server captures %g frames/s, but mocap.frame_rate_hz is %g",
                         (double)rate, expected);
}

/* The reply is an integer; 0 means success. */
static void take_bitstream(const struct wb_natnet_response *response, int64_t t_ns,
                           const struct wb_sink *sink)
{
    if (response->is_number && response->integer == 0)
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "version",
                         "the server agrees to stream NatNet 4.1");
    else
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "version",
            "the server refuses to stream NatNet 4.1: the layout of its frames remains "
            "unverified");
}

/* The reply is an integer; 0 means success. */
static void take_take(struct natnet_state *state, const struct wb_natnet_response *response,
                      int64_t t_ns, const struct wb_sink *sink)
{
    state->records_take = response->is_number && response->integer == 0;
    if (state->records_take)
        wb_natnet_watch_promise(&state->watch, t_ns);
    else
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "take",
                         "the server refuses to record a take: set Motive to live mode, or remove "
                         "mocap.record_take from the rig file");
}

/* A reply does not contain its query: replies are assigned in the order of the queries. After new
 * settings of the server, replies to earlier queries may arrive first. */
static void receive_response(struct natnet_state *state, int64_t t_ns,
                             const struct wb_natnet_packet *packet, const struct wb_sink *sink,
                             struct wb_natnet_fault *fault)
{
    struct wb_natnet_response response = {0};
    const bool unknown = packet->message == WB_NATNET_UNRECOGNIZED_REQUEST;
    if (!unknown && wb_natnet_decode_response(packet, &response, fault) != WB_OK)
        return;
    const enum query query = next_query(state);
    if (!state->connected || query == N_QUERIES)
        return;
    if (query == QUERY_UNITS && response.is_number && !is_unit((double)response.real) &&
        state->n_strays < STRAYS_MAX) {
        state->n_strays++;
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "units",
            "the server replied %g, which is not a known unit of length: the query is repeated",
            (double)response.real);
        return;
    }
    state->n_answers++;
    if (query == QUERY_BITSTREAM)
        take_bitstream(&response, t_ns, sink);
    else if (query == QUERY_TAKE)
        take_take(state, &response, t_ns, sink);
    else if (unknown || !response.is_number)
        wb_driver_remark(sink, WB_LOG_INFO, t_ns, "query", "the server does not support '%s'",
                         queries[query]);
    if (query == QUERY_UNITS)
        take_units(state, (double)response.real, t_ns, sink);
    else if (query == QUERY_FRAME_RATE && response.is_number)
        take_frame_rate(state, response.real, t_ns, sink);
}

/* Converts server ticks to seconds, without loss of precision after a long uptime. */
static double seconds_of_ticks(uint64_t ticks, uint64_t frequency)
{
    return (double)(ticks / frequency) + (double)(ticks % frequency) / (double)frequency;
}

static void receive_echo(const struct natnet_state *state, int64_t t_ns,
                         const struct wb_natnet_packet *packet, const struct wb_sink *sink,
                         struct wb_natnet_fault *fault)
{
    uint64_t stamp = 0, ticks = 0;
    if (wb_natnet_decode_echo(packet, &stamp, &ticks, fault) != WB_OK)
        return;
    if (!state->connected || state->server.clock_frequency == 0 || !sink->probe)
        return;
    if (stamp > (uint64_t)INT64_MAX || t_ns < (int64_t)stamp ||
        t_ns - (int64_t)stamp > PROBE_MAX_NS)
        return;
    const struct wb_clock_probe probe = {
        .t_sent_ns = (int64_t)stamp,
        .t_received_ns = t_ns,
        .t_device = seconds_of_ticks(ticks, state->server.clock_frequency),
    };
    sink->probe(sink->context, &probe);
}

/* --- frames --- */

/* Reports frames that contain only occluded or model-filled markers. */
static void remark_unmeasured(struct natnet_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_mocap_frame *const mocap = &state->frame.mocap;
    int n_filled = 0, n_lost = 0;
    for (int i = 0; i < mocap->n_markers; i++) {
        const int params = mocap->markers[i].params;
        n_filled += (params & WB_MARKER_MODEL_FILLED) != 0;
        n_lost += (params & (WB_MARKER_MODEL_FILLED | WB_MARKER_OCCLUDED)) == WB_MARKER_OCCLUDED;
    }
    const bool none = mocap->n_markers > 0 && n_filled + n_lost == mocap->n_markers;
    state->n_unmeasured = none ? state->n_unmeasured + 1 : 0;
    if (state->n_unmeasured < UNMEASURED_FRAMES || !first_time(state, SAID_UNMEASURED))
        return;
    wb_driver_remark(
        sink, WB_LOG_WARNING, t_ns, "markers",
        "for %d frames no marker was measured: of the %d that the server sends, %d are filled in "
        "by its model and %d occluded: %s",
        state->n_unmeasured, mocap->n_markers, n_filled, n_lost,
        n_filled > 0 ? "delete the rigid body or asset with the wire's markers, and stream "
                       "unlabelled markers"
                     : "check the cameras' view of the wire, their exposure and threshold");
}

static void remark_frame(struct natnet_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    const struct wb_natnet_frame *const frame = &state->frame;
    if (frame->n_labelled == 0 && frame->n_others > 0 && first_time(state, SAID_NO_LABELLED))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "markers",
                         "only the legacy list of markers is streamed: enable labelled and "
                         "unlabelled markers in the server's streaming settings");
    if (frame->n_labelled > frame->mocap.n_markers && first_time(state, SAID_TOO_MANY))
        wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "markers",
                         "a frame has %d markers; only the first %d are used: mask reflections",
                         frame->n_labelled, frame->mocap.n_markers);
    if (wb_natnet_version_at_least(state->version, 2, 6) &&
        !(frame->mocap.params & WB_FRAME_LIVE) && first_time(state, SAID_NOT_LIVE))
        wb_driver_remark(
            sink, WB_LOG_INFO, t_ns, "mode",
            "the server does not flag its frames as live: it may be playing back a take");
}

/* Converts positions to metres; markers with an invalid position become occluded. */
static void convert_markers(struct natnet_state *state, int64_t t_ns, const struct wb_sink *sink)
{
    struct wb_mocap_frame *const mocap = &state->frame.mocap;
    for (int i = 0; i < mocap->n_markers; i++) {
        struct wb_marker *const marker = &mocap->markers[i];
        bool finite = true;
        for (int k = 0; k < 3; k++) {
            if (state->units_factor != 1.0)
                marker->position[k] = (float)((double)marker->position[k] * state->units_factor);
            finite = finite && isfinite(marker->position[k]);
        }
        if (state->units_factor != 1.0) {
            marker->size = (float)((double)marker->size * state->units_factor);
            marker->residual = (float)((double)marker->residual * state->units_factor);
        }
        if (finite)
            continue;
        marker->params |= WB_MARKER_OCCLUDED;
        if (first_time(state, SAID_NOT_FINITE))
            wb_driver_remark(sink, WB_LOG_WARNING, t_ns, "markers",
                             "marker %" PRId32
                             " has no finite position: such markers count as occluded",
                             marker->id);
    }
}

static void receive_frame(struct natnet_state *state, int64_t t_ns,
                          const struct wb_natnet_packet *packet, const struct wb_sink *sink,
                          struct wb_natnet_fault *fault)
{
    if (!state->connected) {
        if (first_time(state, SAID_EARLY))
            wb_driver_remark(sink, WB_LOG_INFO, t_ns, "early",
                             "frames received before the server reported its NatNet version are "
                             "not decoded");
        return;
    }
    struct wb_mocap_frame *const mocap = &state->frame.mocap;
    if (wb_natnet_decode_frame(packet, state->version, &state->frame, fault) != WB_OK)
        return;
    mocap->t_ns = t_ns;
    if (state->server.clock_frequency > 0 && mocap->camera_data_received > 0)
        mocap->t_clock =
            seconds_of_ticks(mocap->camera_data_received, state->server.clock_frequency);
    const double scale = state->rig.time_scale > 1.0 ? state->rig.time_scale : 1.0;
    if (wb_natnet_watch_frame(&state->watch, mocap, OVERTAKEN * scale, sink))
        restart_queries(state);
    mocap->segment = state->watch.segment;
    convert_markers(state, t_ns, sink);
    remark_frame(state, t_ns, sink);
    remark_unmeasured(state, t_ns, sink);
    state->n_frames++;
    if (sink->mocap)
        sink->mocap(sink->context, mocap);
}

/* --- operations of the driver --- */

static enum wb_status init(void *opaque, const struct wb_rig *rig)
{
    struct natnet_state *const state = opaque;
    state->rig = *rig;
    state->units_factor = 1.0;
    return WB_OK;
}

static void send_connect(struct natnet_state *state, int64_t now_ns, struct wb_outbox *outbox)
{
    uint8_t buffer[512];
    /* Servers before 4.0 know the short form only, and some later ones reply to it only. */
    const bool extended = state->n_connects % 2 == 0;
    const size_t n = wb_natnet_encode_connect(buffer, sizeof buffer, "wirebench", extended);
    wb_outbox_add(outbox, buffer, n);
    state->n_connects++;
    state->next_connect_ns = now_ns + CONNECT_PERIOD_NS;
}

static void start(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct natnet_state *const state = opaque;
    state->receive_noticed_ns = now_ns;
    state->next_keepalive_ns = now_ns + KEEPALIVE_PERIOD_NS;
    send_connect(state, now_ns, outbox);
}

/* Likely cause of rejected datagrams, and the remedy. */
static const char *likely_cause(const struct natnet_state *state)
{
    if (!is_unverified(state))
        return "Another program may send to this port, or the network damages datagrams: check "
               "host, port and group in mocap.address";
    if (state->server.multicast)
        return "The layout of this version may be another one: set the server to unicast and "
               "remove the group from mocap.address, so that 4.1 can be asked for";
    return "The layout of this version may be another one: set the server's bitstream version to "
           "4.1";
}

static void receive(void *opaque, int64_t t_ns, const uint8_t *bytes, size_t n,
                    const struct wb_sink *sink)
{
    struct natnet_state *const state = opaque;
    struct wb_natnet_packet packet = {0};
    struct wb_natnet_fault fault = {0};
    if (n == 0)
        return; /* datagrams are complete: there is no state to discard */
    state->last_receive_ns = t_ns;
    if (wb_natnet_decode_packet(bytes, n, &packet, &fault) == WB_OK) {
        switch (packet.message) {
        case WB_NATNET_SERVERINFO:
            receive_server(state, t_ns, &packet, sink, &fault);
            break;
        case WB_NATNET_FRAMEOFDATA:
            receive_frame(state, t_ns, &packet, sink, &fault);
            break;
        case WB_NATNET_ECHORESPONSE:
            receive_echo(state, t_ns, &packet, sink, &fault);
            break;
        case WB_NATNET_RESPONSE:
        case WB_NATNET_UNRECOGNIZED_REQUEST:
            receive_response(state, t_ns, &packet, sink, &fault);
            break;
        case WB_NATNET_MESSAGESTRING: {
            char text[256];
            if (wb_natnet_decode_text(&packet, text, sizeof text, &fault) == WB_OK)
                wb_driver_remark(sink, WB_LOG_INFO, t_ns, "message", "the server says: %s", text);
            break;
        }
        case WB_NATNET_DISCONNECTBYTIMEOUT:
            wb_driver_remark(
                sink, WB_LOG_WARNING, t_ns, "disconnected",
                "the server closed the connection because it received nothing from this computer");
            break;
        case WB_NATNET_MODELDEF:
            break;
        default:
            if (first_time(state, SAID_UNKNOWN))
                wb_driver_remark(sink, WB_LOG_INFO, t_ns, "unknown",
                                 "unknown messages of kind %d from the server are ignored",
                                 packet.message);
        }
    }
    if (!fault.reason)
        return;
    state->n_refused++;
    if (wb_driver_is_report_due(state->n_refused))
        wb_driver_remark(
            sink, WB_LOG_WARNING, t_ns, "refused",
            "datagram of %zu bytes (message %d, NatNet %u.%u) rejected at byte %zu: %s; %" PRIu64
            " so far. %s",
            n, packet.message, state->version.major, state->version.minor, fault.offset,
            fault.reason, state->n_refused, likely_cause(state));
}

/* Clock probes: a burst at the beginning, then one per period (of rig time). */
static void send_probe(struct natnet_state *state, int64_t now_ns, struct wb_outbox *outbox)
{
    uint8_t buffer[32];
    if (state->server.clock_frequency == 0 || now_ns < state->next_probe_ns || now_ns < 0)
        return;
    const size_t n = wb_natnet_encode_echo_request(buffer, sizeof buffer, (uint64_t)now_ns);
    if (!wb_outbox_add(outbox, buffer, n))
        return;
    state->n_probes++;
    const int64_t period = wb_driver_period_ns(&state->rig, PROBE_PERIOD_NS);
    const bool burst = state->n_probes < BURST_PROBES && period > BURST_PERIOD_NS;
    state->next_probe_ns = now_ns + (burst ? BURST_PERIOD_NS : period);
}

static void send_query(struct natnet_state *state, int64_t now_ns, struct wb_outbox *outbox)
{
    uint8_t buffer[64];
    const bool waits = state->n_asked > state->n_answers && now_ns < state->next_query_ns;
    const enum query query = next_query(state);
    if (query == N_QUERIES || waits)
        return;
    const size_t n =
        wb_natnet_encode_text(buffer, sizeof buffer, WB_NATNET_REQUEST, queries[query]);
    wb_outbox_add(outbox, buffer, n);
    state->n_asked = state->n_answers + 1;
    state->next_query_ns = now_ns + QUERY_PERIOD_NS;
}

static void tick(void *opaque, int64_t now_ns, struct wb_outbox *outbox)
{
    struct natnet_state *const state = opaque;
    uint8_t buffer[16];
    if (state->last_receive_ns != state->receive_seen_ns) {
        state->receive_seen_ns = state->last_receive_ns;
        state->receive_noticed_ns = now_ns;
    }
    const bool silent = now_ns - state->receive_noticed_ns > SILENCE_NS;
    if ((!state->connected || silent) && now_ns >= state->next_connect_ns)
        send_connect(state, now_ns, outbox);
    if (!state->connected)
        return;
    if (now_ns >= state->next_keepalive_ns) {
        wb_outbox_add(outbox, buffer,
                      wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_KEEPALIVE));
        state->next_keepalive_ns = now_ns + KEEPALIVE_PERIOD_NS;
    }
    send_query(state, now_ns, outbox);
    send_probe(state, now_ns, outbox);
}

static bool ready(const void *opaque)
{
    const struct natnet_state *const state = opaque;
    return state->connected && state->n_frames > 0;
}

static void stop(void *opaque, struct wb_outbox *outbox)
{
    const struct natnet_state *const state = opaque;
    uint8_t buffer[32];
    if (state->records_take)
        wb_outbox_add(outbox, buffer,
                      wb_natnet_encode_text(buffer, sizeof buffer, WB_NATNET_REQUEST, STOP_TAKE));
    if (state->connected)
        wb_outbox_add(outbox, buffer,
                      wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_DISCONNECT));
}

const struct wb_driver wb_natnet_client = {
    .name = "natnet",
    .role = WB_ROLE_MOCAP,
    .state_size = sizeof(struct natnet_state),
    .init = init,
    .start = start,
    .receive = receive,
    .tick = tick,
    .ready = ready,
    .stop = stop,
};
