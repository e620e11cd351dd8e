#include "daq/protocol/natnet_encode.h"

#include <string.h>

/* A cursor over the datagram being written. After an overflow nothing more is written. */
struct writer {
    uint8_t *bytes;
    size_t size, at;
    bool full;
    struct wb_natnet_version version;
};

static void put(struct writer *writer, const void *bytes, size_t n)
{
    if (writer->full || n > writer->size - writer->at) {
        writer->full = true;
        return;
    }
    if (bytes)
        memcpy(writer->bytes + writer->at, bytes, n);
    else
        memset(writer->bytes + writer->at, 0, n);
    writer->at += n;
}

static void put_zeros(struct writer *writer, size_t n)
{
    put(writer, NULL, n);
}

static void put_u16(struct writer *writer, uint16_t value)
{
    const uint8_t b[2] = {(uint8_t)value, (uint8_t)(value >> 8)};
    put(writer, b, sizeof b);
}

static void put_i16(struct writer *writer, int16_t value)
{
    put_u16(writer, (uint16_t)value);
}

static void put_u32(struct writer *writer, uint32_t value)
{
    const uint8_t b[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                          (uint8_t)(value >> 24)};
    put(writer, b, sizeof b);
}

static void put_i32(struct writer *writer, int32_t value)
{
    put_u32(writer, (uint32_t)value);
}

static void put_u64(struct writer *writer, uint64_t value)
{
    put_u32(writer, (uint32_t)value);
    put_u32(writer, (uint32_t)(value >> 32));
}

static void put_f32(struct writer *writer, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(writer, bits);
}

static void put_f64(struct writer *writer, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u64(writer, bits);
}

static void put_f32s(struct writer *writer, const float *values, int n)
{
    for (int i = 0; i < n; i++)
        put_f32(writer, values[i]);
}

static bool at_least(const struct writer *writer, int major, int minor)
{
    return wb_natnet_version_at_least(writer->version, major, minor);
}

/* Begins a datagram; finish() writes the payload's size. */
static struct writer begin(uint8_t *buffer, size_t size, enum wb_natnet_message message)
{
    struct writer writer = {.bytes = buffer, .size = size};
    put_u16(&writer, (uint16_t)message);
    put_u16(&writer, 0);
    return writer;
}

static size_t finish(struct writer *writer)
{
    if (writer->full || writer->at - WB_NATNET_HEADER > WB_NATNET_MAX_PAYLOAD)
        return 0;
    const size_t n_payload = writer->at - WB_NATNET_HEADER;
    writer->bytes[2] = (uint8_t)n_payload;
    writer->bytes[3] = (uint8_t)(n_payload >> 8);
    return writer->at;
}

/* Writes a name in a field of fixed size, padded with zeros. */
static void put_field(struct writer *writer, const char *text, size_t size)
{
    const size_t length = strnlen(text, size - 1);
    put(writer, text, length);
    put_zeros(writer, size - length);
}

size_t wb_natnet_encode_text(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                             const char *text)
{
    struct writer writer = begin(buffer, size, message);
    put(&writer, text, strlen(text) + 1);
    return finish(&writer);
}

size_t wb_natnet_encode_empty(uint8_t *buffer, size_t size, enum wb_natnet_message message)
{
    struct writer writer = begin(buffer, size, message);
    return finish(&writer);
}

/* --- client --- */

size_t wb_natnet_encode_connect(uint8_t *buffer, size_t size, const char *name, bool extended)
{
    static const uint8_t version[4] = {4, 1, 0, 0};
    struct writer writer = begin(buffer, size, WB_NATNET_CONNECT);
    put_field(&writer, name, 256);
    put(&writer, version, sizeof version); /* of the application: the NatNet version is used */
    put(&writer, version, sizeof version);
    if (extended) {
        put_zeros(&writer, 1); /* request all data, without subscriptions */
        put(&writer, version, sizeof version);
        put_zeros(&writer, 2);
    }
    return finish(&writer);
}

size_t wb_natnet_encode_echo_request(uint8_t *buffer, size_t size, uint64_t stamp)
{
    struct writer writer = begin(buffer, size, WB_NATNET_ECHOREQUEST);
    put_u64(&writer, stamp);
    return finish(&writer);
}

/* --- server --- */

size_t wb_natnet_encode_server(uint8_t *buffer, size_t size, const struct wb_natnet_server *server)
{
    struct writer writer = begin(buffer, size, WB_NATNET_SERVERINFO);
    put_field(&writer, server->name, sizeof server->name);
    put(&writer, server->app_version, 4);
    put(&writer, server->natnet_version, 4);
    if (server->has_connection) {
        const uint8_t multicast = server->multicast;
        put_u64(&writer, server->clock_frequency);
        put_u16(&writer, server->data_port);
        put(&writer, &multicast, 1);
        put(&writer, server->group, 4);
    }
    return finish(&writer);
}

/* Writes the count of a section and, from 4.1 on, space for its size; returns the offset of its
 * items.
 */
static size_t open_section(struct writer *writer, int count)
{
    put_i32(writer, count);
    if (at_least(writer, 4, 1))
        put_i32(writer, 0);
    return writer->at;
}

static void close_section(struct writer *writer, size_t start)
{
    if (writer->full || !at_least(writer, 4, 1))
        return;
    struct writer patch = {.bytes = writer->bytes, .size = writer->size, .at = start - 4};
    put_u32(&patch, (uint32_t)(writer->at - start));
}

static void put_sets(struct writer *writer, const struct wb_natnet_frame *frame)
{
    const size_t start = open_section(writer, frame->n_sets);
    for (int i = 0; i < frame->n_sets; i++) {
        const struct wb_natnet_set *const set = &frame->sets[i];
        put(writer, set->name, strlen(set->name) + 1);
        put_i32(writer, set->n_points);
        for (int k = 0; k < set->n_points; k++)
            put_f32s(writer, frame->points[set->first_point + k], 3);
    }
    close_section(writer, start);
}

static void put_body(struct writer *writer, const struct wb_natnet_body *body)
{
    put_i32(writer, body->id);
    put_f32s(writer, body->position, 3);
    put_f32s(writer, body->rotation, 4);
    if (!at_least(writer, 3, 0)) {
        put_i32(writer, body->n_markers);
        put_zeros(writer, (size_t)body->n_markers * (at_least(writer, 2, 0) ? 20 : 12));
    }
    if (at_least(writer, 2, 0))
        put_f32(writer, body->error);
    if (at_least(writer, 2, 6))
        put_i16(writer, body->params);
}

static void put_bodies(struct writer *writer, const struct wb_natnet_frame *frame, int first, int n)
{
    for (int i = 0; i < n; i++)
        put_body(writer, &frame->bodies[first + i]);
}

static void put_groups(struct writer *writer, const struct wb_natnet_frame *frame,
                       const struct wb_natnet_group *groups, int n, bool assets)
{
    const size_t start = open_section(writer, n);
    for (int i = 0; i < n; i++) {
        put_i32(writer, groups[i].id);
        put_i32(writer, groups[i].n_bodies);
        put_bodies(writer, frame, groups[i].first_body, groups[i].n_bodies);
        if (assets) {
            put_i32(writer, groups[i].n_markers);
            put_zeros(writer, (size_t)groups[i].n_markers * 26);
        }
    }
    close_section(writer, start);
}

static void put_labelled(struct writer *writer, const struct wb_mocap_frame *mocap)
{
    const size_t start = open_section(writer, mocap->n_markers);
    for (int i = 0; i < mocap->n_markers; i++) {
        const struct wb_marker *const marker = &mocap->markers[i];
        put_i32(writer, marker->id);
        put_f32s(writer, marker->position, 3);
        put_f32(writer, marker->size);
        if (at_least(writer, 2, 6))
            put_i16(writer, marker->params);
        if (at_least(writer, 3, 0))
            put_f32(writer, marker->residual);
    }
    close_section(writer, start);
}

/* Writes zeros, all in the first channel. */
static void put_analogs(struct writer *writer, const struct wb_natnet_analog *analogs, int n)
{
    const size_t start = open_section(writer, n);
    for (int i = 0; i < n; i++) {
        put_i32(writer, analogs[i].id);
        put_i32(writer, analogs[i].n_channels);
        for (int k = 0; k < analogs[i].n_channels; k++) {
            const int n_values = k == 0 ? analogs[i].n_values : 0;
            put_i32(writer, n_values);
            put_zeros(writer, (size_t)n_values * 4);
        }
    }
    close_section(writer, start);
}

static void put_stamps(struct writer *writer, const struct wb_natnet_frame *frame)
{
    const struct wb_mocap_frame *const mocap = &frame->mocap;
    if (!at_least(writer, 3, 0))
        put_f32(writer, frame->latency);
    put_u32(writer, frame->timecode);
    put_u32(writer, frame->timecode_sub);
    if (at_least(writer, 2, 7))
        put_f64(writer, frame->timestamp);
    else if (at_least(writer, 2, 6))
        put_f32(writer, (float)frame->timestamp);
    if (at_least(writer, 3, 0)) {
        put_u64(writer, mocap->camera_mid_exposure);
        put_u64(writer, mocap->camera_data_received);
        put_u64(writer, mocap->transmit);
    }
    if (at_least(writer, 4, 1) || (at_least(writer, 4, 0) && frame->has_precision)) {
        put_u32(writer, frame->precision_seconds);
        put_u32(writer, frame->precision_fraction);
    }
    if (at_least(writer, 2, 6))
        put_i16(writer, mocap->params);
    put_u32(writer, 0); /* end of data */
}

size_t wb_natnet_encode_frame(uint8_t *buffer, size_t size, struct wb_natnet_version version,
                              const struct wb_natnet_frame *frame)
{
    struct writer writer = begin(buffer, size, WB_NATNET_FRAMEOFDATA);
    writer.version = version;
    put_i32(&writer, frame->mocap.frame_number);
    put_sets(&writer, frame);
    size_t start = open_section(&writer, frame->n_others);
    for (int i = 0; i < frame->n_others; i++)
        put_f32s(&writer, frame->others[i], 3);
    close_section(&writer, start);
    start = open_section(&writer, frame->n_bodies);
    put_bodies(&writer, frame, 0, frame->n_bodies);
    close_section(&writer, start);
    if (at_least(&writer, 2, 1))
        put_groups(&writer, frame, frame->skeletons, frame->n_skeletons, false);
    if (at_least(&writer, 4, 1))
        put_groups(&writer, frame, frame->assets, frame->n_assets, true);
    if (at_least(&writer, 2, 3))
        put_labelled(&writer, &frame->mocap);
    if (at_least(&writer, 2, 9))
        put_analogs(&writer, frame->force_plates, frame->n_force_plates);
    if (at_least(&writer, 2, 11))
        put_analogs(&writer, frame->devices, frame->n_devices);
    put_stamps(&writer, frame);
    return finish(&writer);
}

size_t wb_natnet_encode_echo_response(uint8_t *buffer, size_t size, uint64_t stamp, uint64_t ticks)
{
    struct writer writer = begin(buffer, size, WB_NATNET_ECHORESPONSE);
    put_u64(&writer, stamp);
    put_u64(&writer, ticks);
    return finish(&writer);
}

size_t wb_natnet_encode_integer(uint8_t *buffer, size_t size, enum wb_natnet_message message,
                                int32_t value)
{
    struct writer writer = begin(buffer, size, message);
    put_i32(&writer, value);
    return finish(&writer);
}

size_t wb_natnet_encode_response_real(uint8_t *buffer, size_t size, float value)
{
    struct writer writer = begin(buffer, size, WB_NATNET_RESPONSE);
    put_f32(&writer, value);
    return finish(&writer);
}
