#include "daq/protocol/natnet.h"

#include <math.h>
#include <string.h>

#include "daq/protocol/driver.h"

/* A cursor over the payload. After the first fault all values read are zero, so that a parser only
 * needs to check at the end of each section. */
struct reader {
    const uint8_t *bytes;
    size_t n, at; /* n: end of the readable window */
    const char *reason;
    size_t fault_at;
    struct wb_natnet_version version;
};

static void reject(struct reader *reader, const char *reason)
{
    if (reader->reason)
        return;
    reader->reason = reason;
    reader->fault_at = reader->at;
}

static size_t remaining(const struct reader *reader)
{
    return reader->reason ? 0 : reader->n - reader->at;
}

/* The next n bytes; NULL after a fault. */
static const uint8_t *take(struct reader *reader, size_t n)
{
    if (n > remaining(reader)) {
        reject(reader, "the datagram ends too early");
        return NULL;
    }
    const uint8_t *const bytes = reader->bytes + reader->at;
    reader->at += n;
    return bytes;
}

static void get_bytes(struct reader *reader, void *to, size_t n)
{
    const uint8_t *const bytes = take(reader, n);
    if (bytes)
        memcpy(to, bytes, n);
}

static uint16_t get_u16(struct reader *reader)
{
    const uint8_t *const b = take(reader, 2);
    return b ? (uint16_t)(b[0] | b[1] << 8) : 0;
}

static int16_t get_i16(struct reader *reader)
{
    return (int16_t)get_u16(reader);
}

static uint32_t get_u32(struct reader *reader)
{
    const uint8_t *const b = take(reader, 4);
    return b ? (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24
             : 0;
}

static int32_t get_i32(struct reader *reader)
{
    return (int32_t)get_u32(reader);
}

static uint64_t get_u64(struct reader *reader)
{
    const uint64_t low = get_u32(reader);
    const uint64_t high = get_u32(reader);
    return low | high << 32;
}

static float get_f32(struct reader *reader)
{
    const uint32_t bits = get_u32(reader);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static double get_f64(struct reader *reader)
{
    const uint64_t bits = get_u64(reader);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static void get_f32s(struct reader *reader, float *values, int n)
{
    for (int i = 0; i < n; i++)
        values[i] = get_f32(reader);
}

static bool at_least(const struct reader *reader, int major, int minor)
{
    return wb_natnet_version_at_least(reader->version, major, minor);
}

/* Reads a count of items of at least `minimum` bytes each; a fault if they exceed the window. */
static int get_count(struct reader *reader, size_t minimum)
{
    const int32_t count = get_i32(reader);
    if (!reader->reason && (count < 0 || (size_t)count > remaining(reader) / minimum))
        reject(reader, "a count is larger than the datagram");
    return reader->reason ? 0 : count;
}

bool wb_natnet_version_at_least(struct wb_natnet_version version, int major, int minor)
{
    return version.major > major || (version.major == major && version.minor >= minor);
}

/* --- sections of a frame --- */

/* A section: i32 count, from 4.1 on i32 size in bytes, then the items. While it is open the
 * reader's window ends at its end. */
struct section {
    int count;
    size_t end;   /* 0: without size */
    size_t outer; /* end of the window before */
};

/* Opens a section whose items take at least `minimum` bytes. */
static struct section open_section(struct reader *reader, size_t minimum)
{
    struct section section = {.outer = reader->n};
    if (!at_least(reader, 4, 1)) {
        section.count = get_count(reader, minimum);
        return section;
    }
    const int32_t count = get_i32(reader);
    const int32_t size = get_i32(reader);
    if (!reader->reason && (size < 0 || (size_t)size > remaining(reader)))
        reject(reader, "a section's size is larger than the datagram");
    else if (!reader->reason && (count < 0 || (size_t)count > (size_t)size / minimum))
        reject(reader, "a section's count is larger than its size");
    if (!reader->reason) {
        section.count = count;
        section.end = reader->n = reader->at + (size_t)size;
    }
    return section;
}

/* Closes a section; its size must equal the number of bytes read. */
static void close_section(struct reader *reader, const struct section *section)
{
    reader->n = section->outer;
    if (section->end && reader->at != section->end)
        reject(reader, "a section's size differs from its content");
}

static void get_name(struct reader *reader, char *name, size_t size)
{
    const size_t limit = remaining(reader);
    const uint8_t *const start = reader->bytes + reader->at;
    const uint8_t *const end = limit ? memchr(start, 0, limit) : NULL;
    if (!end) {
        reject(reader, "a name is not terminated");
        return;
    }
    const size_t length = (size_t)(end - start);
    const size_t kept = length < size - 1 ? length : size - 1;
    memcpy(name, start, kept);
    name[kept] = '\0';
    reader->at += length + 1;
}

static void read_sets(struct reader *reader, struct wb_natnet_frame *frame)
{
    const struct section section = open_section(reader, 5);
    frame->n_sets = section.count;
    for (int i = 0; i < section.count && !reader->reason; i++) {
        struct wb_natnet_set set = {.first_point = frame->n_points};
        get_name(reader, set.name, sizeof set.name);
        set.n_points = get_count(reader, 12);
        for (int k = 0; k < set.n_points; k++) {
            float point[3];
            get_f32s(reader, point, 3);
            if (frame->n_points < WB_NATNET_MAX_POINTS && i < WB_NATNET_MAX_SETS) {
                memcpy(frame->points[frame->n_points++], point, sizeof point);
                set.n_kept++;
            }
        }
        if (i < WB_NATNET_MAX_SETS)
            frame->sets[i] = set;
    }
    close_section(reader, &section);
}

static void read_others(struct reader *reader, struct wb_natnet_frame *frame)
{
    const struct section section = open_section(reader, 12);
    frame->n_others = section.count;
    for (int i = 0; i < section.count; i++) {
        float point[3];
        get_f32s(reader, point, 3);
        if (i < WB_MAX_MARKERS)
            memcpy(frame->others[i], point, sizeof point);
    }
    close_section(reader, &section);
}

static size_t body_minimum(const struct reader *reader)
{
    if (at_least(reader, 3, 0))
        return 38;
    return 36 + (at_least(reader, 2, 0) ? 4 : 0) + (at_least(reader, 2, 6) ? 2 : 0);
}

/* Returns whether the body was stored. */
static bool read_body(struct reader *reader, struct wb_natnet_frame *frame)
{
    struct wb_natnet_body body = {.id = get_i32(reader)};
    get_f32s(reader, body.position, 3);
    get_f32s(reader, body.rotation, 4);
    if (!at_least(reader, 3, 0)) {
        const size_t each = at_least(reader, 2, 0) ? 20 : 12; /* position, id, size */
        body.n_markers = get_count(reader, each);
        take(reader, (size_t)body.n_markers * each);
    }
    if (at_least(reader, 2, 0))
        body.error = get_f32(reader);
    if (at_least(reader, 2, 6))
        body.params = get_i16(reader);
    if (reader->reason || frame->n_bodies_kept == WB_NATNET_MAX_BODIES)
        return false;
    frame->bodies[frame->n_bodies_kept++] = body;
    return true;
}

static void read_bodies(struct reader *reader, struct wb_natnet_frame *frame)
{
    const struct section section = open_section(reader, body_minimum(reader));
    frame->n_bodies = section.count;
    for (int i = 0; i < section.count && !reader->reason; i++)
        read_body(reader, frame);
    close_section(reader, &section);
}

/* Reads skeletons, or trained assets, whose groups end with markers. Returns the number sent. */
static int read_groups(struct reader *reader, struct wb_natnet_frame *frame,
                       struct wb_natnet_group *groups, bool assets)
{
    const struct section section = open_section(reader, assets ? 12 : 8);
    for (int i = 0; i < section.count && !reader->reason; i++) {
        struct wb_natnet_group group = {.id = get_i32(reader), .first_body = frame->n_bodies_kept};
        group.n_bodies = get_count(reader, body_minimum(reader));
        for (int k = 0; k < group.n_bodies && !reader->reason; k++)
            group.n_kept += read_body(reader, frame);
        if (assets) {
            /* Skipped: id, position, size, params, residual. */
            group.n_markers = get_count(reader, 26);
            take(reader, (size_t)group.n_markers * 26);
        }
        if (i < WB_NATNET_MAX_GROUPS)
            groups[i] = group;
    }
    close_section(reader, &section);
    return section.count;
}

static size_t labelled_minimum(const struct reader *reader)
{
    return 20 + (at_least(reader, 2, 6) ? 2 : 0) + (at_least(reader, 3, 0) ? 4 : 0);
}

static void read_labelled(struct reader *reader, struct wb_natnet_frame *frame)
{
    struct wb_mocap_frame *const mocap = &frame->mocap;
    const struct section section = open_section(reader, labelled_minimum(reader));
    frame->n_labelled = section.count;
    for (int i = 0; i < section.count && !reader->reason; i++) {
        struct wb_marker marker = {.id = get_i32(reader)};
        get_f32s(reader, marker.position, 3);
        marker.size = get_f32(reader);
        if (at_least(reader, 2, 6))
            marker.params = get_i16(reader);
        if (at_least(reader, 3, 0))
            marker.residual = get_f32(reader);
        if (mocap->n_markers < WB_MAX_MARKERS)
            mocap->markers[mocap->n_markers++] = marker;
    }
    close_section(reader, &section);
}

/* Force plates and devices have the same layout. */
static int read_analogs(struct reader *reader, struct wb_natnet_analog *analogs)
{
    const struct section section = open_section(reader, 8);
    for (int i = 0; i < section.count && !reader->reason; i++) {
        struct wb_natnet_analog analog = {.id = get_i32(reader)};
        analog.n_channels = get_count(reader, 4);
        for (int k = 0; k < analog.n_channels && !reader->reason; k++) {
            const int n = get_count(reader, 4);
            take(reader, (size_t)n * 4);
            analog.n_values += n;
        }
        if (i < WB_NATNET_MAX_ANALOGS)
            analogs[i] = analog;
    }
    close_section(reader, &section);
    return section.count;
}

/* --- the end of a frame --- */

/* s, upper bound of a plausible stamp (30 years). */
#define STAMP_MAX 1e9

/* Rejects implausible stamps of a frame that was decoded with the wrong layout. A frame is exposed,
 * received and sent in this order; 0 means a missing stamp. */
static void check_stamps(struct reader *reader, const struct wb_mocap_frame *mocap)
{
    if (!(mocap->t_device >= 0.0 && mocap->t_device <= STAMP_MAX))
        reject(reader, "the time stamp is not plausible");
    const uint64_t exposed = mocap->camera_mid_exposure, received = mocap->camera_data_received;
    if ((exposed && received && exposed > received) ||
        (received && mocap->transmit && received > mocap->transmit))
        reject(reader, "the frame was sent before it was exposed");
}

static void read_stamps(struct reader *reader, struct wb_natnet_frame *frame)
{
    struct wb_mocap_frame *const mocap = &frame->mocap;
    if (!at_least(reader, 3, 0))
        frame->latency = get_f32(reader);
    frame->timecode = get_u32(reader);
    frame->timecode_sub = get_u32(reader);
    if (at_least(reader, 2, 7))
        frame->timestamp = get_f64(reader);
    else if (at_least(reader, 2, 6))
        frame->timestamp = (double)get_f32(reader);
    mocap->t_device = at_least(reader, 2, 6) ? frame->timestamp : (double)frame->latency;
    if (at_least(reader, 3, 0)) {
        mocap->camera_mid_exposure = get_u64(reader);
        mocap->camera_data_received = get_u64(reader);
        mocap->transmit = get_u64(reader);
    }
    /* Clients disagree whether 4.0 has the precision stamp: the remaining length decides. */
    frame->has_precision =
        at_least(reader, 4, 1) || (at_least(reader, 4, 0) && remaining(reader) == 14);
    if (frame->has_precision) {
        frame->precision_seconds = get_u32(reader);
        frame->precision_fraction = get_u32(reader);
    }
    if (at_least(reader, 2, 6))
        mocap->params = get_i16(reader);
    check_stamps(reader, mocap);
}

static void read_end(struct reader *reader)
{
    if (get_u32(reader) != 0)
        reject(reader, "the end mark is not at the position of this version");
    if (remaining(reader) != 0)
        reject(reader, "there are more bytes after the frame");
}

static void read_frame(struct reader *reader, struct wb_natnet_frame *frame)
{
    frame->mocap.frame_number = get_i32(reader);
    read_sets(reader, frame);
    read_others(reader, frame);
    read_bodies(reader, frame);
    if (at_least(reader, 2, 1))
        frame->n_skeletons = read_groups(reader, frame, frame->skeletons, false);
    if (at_least(reader, 4, 1))
        frame->n_assets = read_groups(reader, frame, frame->assets, true);
    if (at_least(reader, 2, 3))
        read_labelled(reader, frame);
    if (at_least(reader, 2, 9))
        frame->n_force_plates = read_analogs(reader, frame->force_plates);
    if (at_least(reader, 2, 11))
        frame->n_devices = read_analogs(reader, frame->devices);
    read_stamps(reader, frame);
    read_end(reader);
}

/* --- messages --- */

static struct reader reader_of(const struct wb_natnet_packet *packet)
{
    return (struct reader){.bytes = packet->payload, .n = packet->n_payload};
}

static enum wb_status fail(struct wb_natnet_fault *fault, size_t offset, const char *reason)
{
    *fault = (struct wb_natnet_fault){offset, reason};
    return WB_ERR_FORMAT;
}

static enum wb_status finish(const struct reader *reader, struct wb_natnet_fault *fault)
{
    if (!reader->reason)
        return WB_OK;
    return fail(fault, WB_NATNET_HEADER + reader->fault_at, reader->reason);
}

enum wb_status wb_natnet_decode_packet(const uint8_t *bytes, size_t length,
                                       struct wb_natnet_packet *packet,
                                       struct wb_natnet_fault *fault)
{
    struct reader reader = {.bytes = bytes, .n = length};
    const int message = get_u16(&reader);
    const size_t n_payload = get_u16(&reader);
    if (reader.reason || n_payload > remaining(&reader))
        return fail(fault, 0, "the datagram is shorter than its header says");
    *packet = (struct wb_natnet_packet){message, bytes + WB_NATNET_HEADER, n_payload};
    return WB_OK;
}

enum wb_status wb_natnet_decode_server(const struct wb_natnet_packet *packet,
                                       struct wb_natnet_server *server,
                                       struct wb_natnet_fault *fault)
{
    struct reader reader = reader_of(packet);
    struct wb_natnet_server read;
    memset(&read, 0, sizeof read);
    get_bytes(&reader, read.name, sizeof read.name);
    read.name[sizeof read.name - 1] = '\0';
    get_bytes(&reader, read.app_version, 4);
    get_bytes(&reader, read.natnet_version, 4);
    if (remaining(&reader) >= 15) {
        read.has_connection = true;
        read.clock_frequency = get_u64(&reader);
        read.data_port = get_u16(&reader);
        read.multicast = *take(&reader, 1) != 0;
        get_bytes(&reader, read.group, 4);
    }
    const enum wb_status status = finish(&reader, fault);
    if (status == WB_OK)
        *server = read;
    return status;
}

enum wb_status wb_natnet_decode_frame(const struct wb_natnet_packet *packet,
                                      struct wb_natnet_version version,
                                      struct wb_natnet_frame *frame, struct wb_natnet_fault *fault)
{
    struct reader reader = reader_of(packet);
    reader.version = version;
    /* Only counts and scalars are set to zero: clearing the arrays would take longer than decoding.
     */
    memset(&frame->mocap, 0, offsetof(struct wb_mocap_frame, markers));
    frame->mocap.t_clock = (double)NAN;
    frame->n_labelled = frame->n_points = frame->n_bodies_kept = 0;
    frame->n_sets = frame->n_others = frame->n_bodies = 0;
    frame->n_skeletons = frame->n_assets = frame->n_force_plates = frame->n_devices = 0;
    frame->latency = 0.0F;
    frame->timestamp = (double)NAN;
    frame->precision_seconds = frame->precision_fraction = 0;
    read_frame(&reader, frame);
    return finish(&reader, fault);
}

enum wb_status wb_natnet_decode_echo(const struct wb_natnet_packet *packet, uint64_t *stamp,
                                     uint64_t *ticks, struct wb_natnet_fault *fault)
{
    struct reader reader = reader_of(packet);
    const uint64_t read_stamp = get_u64(&reader);
    const uint64_t read_ticks =
        packet->message == WB_NATNET_ECHORESPONSE ? get_u64(&reader) : UINT64_C(0);
    const enum wb_status status = finish(&reader, fault);
    if (status == WB_OK) {
        *stamp = read_stamp;
        *ticks = read_ticks;
    }
    return status;
}

/* Copies the text of a message. */
static void copy_text(const struct wb_natnet_packet *packet, char *text, size_t size)
{
    const char *const from = (const char *)packet->payload;
    wb_driver_printable(text, size, from, strnlen(from, packet->n_payload));
}

enum wb_status wb_natnet_decode_text(const struct wb_natnet_packet *packet, char *text, size_t size,
                                     struct wb_natnet_fault *fault)
{
    if (packet->n_payload == 0 || size == 0)
        return fail(fault, WB_NATNET_HEADER, "the text is empty");
    copy_text(packet, text, size);
    return WB_OK;
}

enum wb_status wb_natnet_decode_response(const struct wb_natnet_packet *packet,
                                         struct wb_natnet_response *response,
                                         struct wb_natnet_fault *fault)
{
    struct wb_natnet_response read = {.is_number = packet->n_payload == 4};
    if (packet->n_payload == 0)
        return fail(fault, WB_NATNET_HEADER, "the response is empty");
    if (read.is_number) {
        struct reader reader = reader_of(packet);
        read.integer = get_i32(&reader);
        memcpy(&read.real, &read.integer, sizeof read.real);
    } else {
        copy_text(packet, read.text, sizeof read.text);
    }
    *response = read;
    return WB_OK;
}
