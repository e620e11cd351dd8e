#include <stdlib.h>

#include "daq/protocol/natnet.h"
#include "daq/protocol/natnet_encode.h"
#include "tests/check.h"
#include "tests/daq/natnet_example.h"

static const struct wb_natnet_version versions[] = {
    {2, 5}, {2, 6}, {2, 7}, {2, 8}, {2, 9}, {2, 10}, {2, 11}, {3, 0}, {3, 1}, {4, 0}, {4, 1},
};
#define N_VERSIONS ((int)(sizeof versions / sizeof versions[0]))

static uint8_t buffer[65536];
static struct wb_natnet_frame sent, got;

/* Decodes `buffer` in a copy of exactly its size, so that ASan detects any overrun. */
static enum wb_status decode(size_t n, struct wb_natnet_version version,
                             struct wb_natnet_fault *fault)
{
    uint8_t *const copy = malloc(n ? n : 1);
    struct wb_natnet_packet packet;
    assert_non_null(copy);
    memcpy(copy, buffer, n);
    enum wb_status status = wb_natnet_decode_packet(copy, n, &packet, fault);
    if (status == WB_OK)
        status = wb_natnet_decode_frame(&packet, version, &got, fault);
    free(copy);
    return status;
}

static size_t encode(struct wb_natnet_version version)
{
    const size_t n = wb_natnet_encode_frame(buffer, sizeof buffer, version, &sent);
    assert_true(n > 0);
    return n;
}

static bool has(struct wb_natnet_version version, int major, int minor)
{
    return wb_natnet_version_at_least(version, major, minor);
}

static void check_markers(struct wb_natnet_version version)
{
    assert_int_equal(got.mocap.frame_number, sent.mocap.frame_number);
    assert_int_equal(got.n_labelled, sent.n_labelled);
    assert_int_equal(got.mocap.n_markers, sent.mocap.n_markers);
    for (int i = 0; i < sent.mocap.n_markers; i++) {
        const struct wb_marker *const a = &sent.mocap.markers[i], *const b = &got.mocap.markers[i];
        assert_int_equal(b->id, a->id);
        assert_memory_equal(b->position, a->position, sizeof a->position);
        assert_true(b->size == a->size);
        assert_int_equal(b->params, has(version, 2, 6) ? a->params : 0);
        assert_true(b->residual == (has(version, 3, 0) ? a->residual : 0.0F));
    }
    assert_int_equal(got.n_others, 2);
    assert_memory_equal(got.others, sent.others, 2 * sizeof sent.others[0]);
}

static void check_sections(struct wb_natnet_version version)
{
    assert_int_equal(got.n_sets, 2);
    assert_string_equal(got.sets[0].name, "wire");
    assert_int_equal(got.sets[1].n_points, 5);
    assert_int_equal(got.sets[1].first_point, 3);
    assert_memory_equal(got.points, sent.points, 8 * sizeof sent.points[0]);
    assert_int_equal(got.n_bodies, 2);
    assert_int_equal(got.n_skeletons, 1);
    assert_int_equal(got.skeletons[0].id, 4);
    assert_int_equal(got.skeletons[0].n_bodies, 2);
    assert_int_equal(got.skeletons[0].first_body, 2);
    assert_int_equal(got.bodies[3].id, 103);
    assert_true(got.bodies[3].position[1] == 3.5F && got.bodies[3].error == 1e-4F);
    assert_int_equal(got.bodies[3].n_markers, has(version, 3, 0) ? 0 : 3);
    assert_int_equal(got.bodies[3].params, has(version, 2, 6));
    assert_int_equal(got.n_assets, has(version, 4, 1));
    if (has(version, 4, 1)) {
        assert_int_equal(got.assets[0].n_markers, 3);
        assert_int_equal(got.bodies[got.assets[0].first_body].id, 104);
    }
    assert_int_equal(got.n_force_plates, has(version, 2, 9));
    assert_int_equal(got.n_devices, has(version, 2, 11) ? 2 : 0);
    if (has(version, 2, 11))
        assert_int_equal(got.devices[0].n_values, 4);
}

static void check_stamps(struct wb_natnet_version version)
{
    assert_int_equal(got.timecode, 11);
    assert_int_equal(got.timecode_sub, 12);
    assert_close(got.mocap.t_device, has(version, 2, 6) ? 1356.125 : (double)775.3009F, 0.0);
    assert_int_equal(got.mocap.params, has(version, 2, 6) ? 4 : 0);
    assert_true(got.mocap.camera_data_received ==
                (has(version, 3, 0) ? sent.mocap.camera_data_received : 0));
    assert_true(got.mocap.transmit == (has(version, 3, 0) ? sent.mocap.transmit : 0));
    assert_int_equal(got.has_precision, has(version, 4, 0));
    assert_int_equal(got.precision_seconds, has(version, 4, 0) ? 1700000000 : 0);
}

static void frames_of_every_version_survive_the_round_trip(void **state)
{
    (void)state;
    for (int i = 0; i < N_VERSIONS; i++) {
        struct wb_natnet_fault fault;
        natnet_example(&sent, 7);
        memset(&got, 0x5a, sizeof got); /* earlier contents must be overwritten */
        assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_OK);
        check_markers(versions[i]);
        check_sections(versions[i]);
        check_stamps(versions[i]);
    }
}

static void empty_frames_count_as_frames(void **state)
{
    (void)state;
    memset(&sent, 0, sizeof sent);
    for (int i = 0; i < N_VERSIONS; i++) {
        struct wb_natnet_fault fault;
        assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_OK);
        assert_int_equal(got.mocap.n_markers, 0);
    }
}

static void version_4_0_is_read_with_and_without_precision_stamp(void **state)
{
    (void)state;
    const struct wb_natnet_version version = {4, 0};
    struct wb_natnet_fault fault;
    natnet_example(&sent, 7);
    const size_t with = encode(version);
    assert_int_equal(decode(with, version, &fault), WB_OK);
    assert_true(got.has_precision);
    sent.has_precision = false;
    assert_int_equal(encode(version), with - 8);
    assert_int_equal(decode(with - 8, version, &fault), WB_OK);
    assert_false(got.has_precision);
    assert_int_equal(got.mocap.params, 4);
}

static void every_truncation_is_rejected(void **state)
{
    (void)state;
    natnet_example(&sent, 7);
    for (int i = 0; i < N_VERSIONS; i++) {
        const size_t n = encode(versions[i]);
        for (size_t cut = 0; cut < n; cut++) {
            struct wb_natnet_fault fault = {0};
            /* First with the header as it was, then with one that agrees with the cut. */
            assert_int_equal(decode(cut, versions[i], &fault), WB_ERR_FORMAT);
            assert_non_null(fault.reason);
            if (cut < WB_NATNET_HEADER)
                continue;
            const uint8_t header[2] = {buffer[2], buffer[3]};
            buffer[2] = (uint8_t)(cut - WB_NATNET_HEADER);
            buffer[3] = (uint8_t)((cut - WB_NATNET_HEADER) >> 8);
            assert_int_equal(decode(cut, versions[i], &fault), WB_ERR_FORMAT);
            assert_true(fault.offset <= cut);
            memcpy(buffer + 2, header, 2);
        }
    }
}

static void bytes_after_the_frame_are_rejected(void **state)
{
    (void)state;
    natnet_example(&sent, 7);
    for (int i = 0; i < N_VERSIONS; i++) {
        struct wb_natnet_fault fault;
        const size_t n = encode(versions[i]);
        memset(buffer + n, 0, 4);
        const size_t n_payload = n + 4 - WB_NATNET_HEADER;
        buffer[2] = (uint8_t)n_payload;
        buffer[3] = (uint8_t)(n_payload >> 8);
        assert_int_equal(decode(n + 4, versions[i], &fault), WB_ERR_FORMAT);
    }
}

static void set_i32(size_t at, uint32_t value)
{
    for (int k = 0; k < 4; k++)
        buffer[at + (size_t)k] = (uint8_t)(value >> (8 * k));
}

static void malicious_counts_are_rejected(void **state)
{
    (void)state;
    static const uint32_t hostile[] = {0xffffffff, 0x80000000, 0x7fffffff, 0x10000000, 70000};
    memset(&sent, 0, sizeof sent);
    for (int i = 0; i < N_VERSIONS; i++) {
        /* In an empty frame the counts follow the frame number, one after the other. */
        const size_t step = has(versions[i], 4, 1) ? 8 : 4;
        const int n_sections = has(versions[i], 4, 1)    ? 8
                               : has(versions[i], 2, 11) ? 7
                               : has(versions[i], 2, 9)  ? 6
                                                         : 5;
        for (int section = 0; section < n_sections; section++)
            for (size_t h = 0; h < sizeof hostile / sizeof hostile[0]; h++) {
                struct wb_natnet_fault fault;
                const size_t n = encode(versions[i]);
                set_i32(8 + (size_t)section * step, hostile[h]);
                assert_int_equal(decode(n, versions[i], &fault), WB_ERR_FORMAT);
                if (step == 4)
                    continue;
                encode(versions[i]);
                set_i32(12 + (size_t)section * step, hostile[h]); /* the size */
                assert_int_equal(decode(n, versions[i], &fault), WB_ERR_FORMAT);
            }
    }
}

static void section_size_must_equal_its_content(void **state)
{
    (void)state;
    const struct wb_natnet_version version = {4, 1};
    struct wb_natnet_fault fault;
    natnet_example(&sent, 7);
    const size_t n = encode(version);
    buffer[12]++; /* size of the marker sets */
    assert_int_equal(decode(n, version, &fault), WB_ERR_FORMAT);
    buffer[12] -= 2;
    assert_int_equal(decode(n, version, &fault), WB_ERR_FORMAT);
    buffer[12]++;
    assert_int_equal(decode(n, version, &fault), WB_OK);
}

/* Makes room for `n_more` bytes at `at` of the datagram; returns its new size. */
static size_t insert(size_t n, size_t at, const void *more, size_t n_more)
{
    memmove(buffer + at + n_more, buffer + at, n - at);
    memcpy(buffer + at, more, n_more);
    n += n_more;
    buffer[2] = (uint8_t)(n - WB_NATNET_HEADER);
    buffer[3] = (uint8_t)((n - WB_NATNET_HEADER) >> 8);
    return n;
}

/* Offset of the first labelled marker. */
static size_t first_marker(size_t n)
{
    uint8_t marker[16];
    const uint32_t id = (uint32_t)sent.mocap.markers[0].id;
    memcpy(marker, &id, 4);
    memcpy(marker + 4, sent.mocap.markers[0].position, 12);
    const uint8_t *const first = memmem(buffer, n, marker, sizeof marker);
    assert_non_null(first);
    return (size_t)(first - buffer);
}

static const struct wb_natnet_version known = {4, 1}, newer = {4, 4};
/* From here to the end of a datagram of 4.1: timecodes, time stamp, three of ticks, the precision
 * stamp, parameters, end mark. */
enum {
    TAIL = 8 + 8 + 24 + 8 + 2 + 4
};

static void newer_versions_of_the_same_layout_are_read(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    natnet_example(&sent, 7);
    assert_int_equal(decode(encode(known), newer, &fault), WB_OK);
    check_markers(known);
    check_sections(known);
    check_stamps(known);
}

static void unknown_section_is_rejected(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    uint8_t section[8 + 12] = {1, 0, 0, 0, 12, 0, 0, 0};
    natnet_example(&sent, 7);
    /* With any contents, before the stamps, where a later version would add a section. */
    for (int fill = 0; fill < 256; fill++) {
        memset(section + 8, fill, 12);
        size_t n = encode(known);
        n = insert(n, n - TAIL, section, sizeof section);
        assert_int_equal(decode(n, newer, &fault), WB_ERR_FORMAT);
        assert_int_equal(decode(n, known, &fault), WB_ERR_FORMAT);
    }
}

static void additional_field_in_a_marker_is_rejected(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    natnet_example(&sent, 7);
    size_t n = encode(known);
    const size_t first = first_marker(n);
    for (size_t i = 7; i > 0; i--)
        n = insert(n, first + i * 26, "\1\2\3\4", 4);
    set_i32(first - 4, 7 * 30); /* its size is right */
    assert_int_equal(decode(n, newer, &fault), WB_ERR_FORMAT);
    assert_string_equal(fault.reason, "a section's size differs from its content");
}

static void bytes_before_the_end_mark_are_rejected(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    natnet_example(&sent, 7);
    size_t n = encode(known);
    n = insert(n, n - 4, "\0\0\0\0", 4);
    assert_int_equal(decode(n, newer, &fault), WB_ERR_FORMAT);
    n = encode(known);
    buffer[n - 1] = 1;
    assert_int_equal(decode(n, newer, &fault), WB_ERR_FORMAT);
}

static void implausible_stamps_are_rejected(void **state)
{
    (void)state;
    static const double odd[] = {2e272, -1.0, 1.1e9, (double)NAN, (double)INFINITY};
    for (int i = 0; i < N_VERSIONS; i++) {
        struct wb_natnet_fault fault;
        for (size_t k = 0; k < sizeof odd / sizeof odd[0]; k++) {
            natnet_example(&sent, 7);
            sent.timestamp = odd[k];
            sent.latency = (float)odd[k];
            assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_ERR_FORMAT);
            assert_string_equal(fault.reason, "the time stamp is not plausible");
        }
        if (!has(versions[i], 3, 0))
            continue;
        natnet_example(&sent, 7);
        sent.mocap.transmit = sent.mocap.camera_data_received - 1;
        assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_ERR_FORMAT);
        sent.mocap.transmit = 0; /* unknown */
        assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_OK);
        sent.mocap.camera_mid_exposure = sent.mocap.camera_data_received + 1;
        assert_int_equal(decode(encode(versions[i]), versions[i], &fault), WB_ERR_FORMAT);
        assert_string_equal(fault.reason, "the frame was sent before it was exposed");
    }
}

static void markers_beyond_the_limit_are_counted(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    const struct wb_natnet_version version = {3, 0};
    natnet_example(&sent, WB_MAX_MARKERS);
    const size_t n = encode(version);
    /* One marker more: repeat the last one and raise the count before the first. */
    const size_t first = first_marker(n), end = first + (size_t)WB_MAX_MARKERS * 26;
    uint8_t last[26];
    memcpy(last, buffer + end - 26, 26);
    set_i32(first - 4, WB_MAX_MARKERS + 1);
    assert_int_equal(insert(n, end, last, 26), n + 26);
    assert_int_equal(decode(n + 26, version, &fault), WB_OK);
    assert_int_equal(got.n_labelled, WB_MAX_MARKERS + 1);
    assert_int_equal(got.mocap.n_markers, WB_MAX_MARKERS);
}

static struct wb_natnet_packet packet_of(size_t n)
{
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    assert_true(n > 0);
    assert_int_equal(wb_natnet_decode_packet(buffer, n, &packet, &fault), WB_OK);
    return packet;
}

static void server_info_survives_the_round_trip(void **state)
{
    (void)state;
    struct wb_natnet_server a = {.name = "Motive", .app_version = {2, 1, 0, 0}}, b;
    struct wb_natnet_fault fault;
    const uint8_t natnet[4] = {3, 0, 0, 0}, group[4] = {239, 255, 42, 99};
    memcpy(a.natnet_version, natnet, 4);
    size_t n = wb_natnet_encode_server(buffer, sizeof buffer, &a);
    assert_int_equal(n, 4 + 264);
    struct wb_natnet_packet packet = packet_of(n);
    memset(&b, 0xff, sizeof b);
    assert_int_equal(wb_natnet_decode_server(&packet, &b, &fault), WB_OK);
    assert_memory_equal(&a, &b, sizeof a);
    a.has_connection = true;
    a.clock_frequency = 3312787;
    a.data_port = 1511;
    a.multicast = true;
    memcpy(a.group, group, 4);
    n = wb_natnet_encode_server(buffer, sizeof buffer, &a);
    assert_int_equal(n, 4 + 279);
    packet = packet_of(n);
    assert_int_equal(wb_natnet_decode_server(&packet, &b, &fault), WB_OK);
    assert_memory_equal(&a, &b, sizeof a);
    packet.n_payload = 263;
    assert_int_equal(wb_natnet_decode_server(&packet, &b, &fault), WB_ERR_FORMAT);
}

static void echoes_carry_the_stamp_verbatim(void **state)
{
    (void)state;
    uint64_t stamp, ticks;
    struct wb_natnet_fault fault;
    const uint64_t sent_stamp = UINT64_C(0x8877665544332211);
    struct wb_natnet_packet packet =
        packet_of(wb_natnet_encode_echo_request(buffer, sizeof buffer, sent_stamp));
    assert_int_equal(packet.message, WB_NATNET_ECHOREQUEST);
    assert_int_equal(wb_natnet_decode_echo(&packet, &stamp, &ticks, &fault), WB_OK);
    assert_true(stamp == sent_stamp && ticks == 0);
    packet = packet_of(wb_natnet_encode_echo_response(buffer, sizeof buffer, sent_stamp, 42));
    assert_int_equal(wb_natnet_decode_echo(&packet, &stamp, &ticks, &fault), WB_OK);
    assert_true(stamp == sent_stamp && ticks == 42);
    packet.n_payload--;
    assert_int_equal(wb_natnet_decode_echo(&packet, &stamp, &ticks, &fault), WB_ERR_FORMAT);
}

static void requests_and_responses_survive_the_round_trip(void **state)
{
    (void)state;
    char text[64];
    struct wb_natnet_fault fault;
    struct wb_natnet_response response;
    struct wb_natnet_packet packet =
        packet_of(wb_natnet_encode_text(buffer, sizeof buffer, WB_NATNET_REQUEST, "FrameRate"));
    assert_int_equal(wb_natnet_decode_text(&packet, text, sizeof text, &fault), WB_OK);
    assert_string_equal(text, "FrameRate");
    assert_int_equal(wb_natnet_decode_text(&packet, text, 6, &fault), WB_OK);
    assert_string_equal(text, "Frame");
    packet = packet_of(wb_natnet_encode_response_real(buffer, sizeof buffer, 120.0F));
    assert_int_equal(wb_natnet_decode_response(&packet, &response, &fault), WB_OK);
    assert_true(response.is_number && response.real == 120.0F);
    packet = packet_of(wb_natnet_encode_integer(buffer, sizeof buffer, WB_NATNET_RESPONSE, -7));
    assert_int_equal(wb_natnet_decode_response(&packet, &response, &fault), WB_OK);
    assert_true(response.is_number && response.integer == -7);
    packet = packet_of(
        wb_natnet_encode_text(buffer, sizeof buffer, WB_NATNET_RESPONSE, "not \033[0m that"));
    assert_int_equal(wb_natnet_decode_response(&packet, &response, &fault), WB_OK);
    assert_false(response.is_number);
    assert_string_equal(response.text, "not ?[0m that");
    packet =
        packet_of(wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_UNRECOGNIZED_REQUEST));
    assert_int_equal(packet.message, 100);
    assert_int_equal(wb_natnet_decode_response(&packet, &response, &fault), WB_ERR_FORMAT);
}

static void client_messages_have_their_documented_sizes(void **state)
{
    (void)state;
    size_t n = wb_natnet_encode_connect(buffer, sizeof buffer, "wirebench", false);
    assert_int_equal(n, 4 + 264);
    assert_int_equal(buffer[0], WB_NATNET_CONNECT);
    assert_string_equal((const char *)buffer + 4, "wirebench");
    n = wb_natnet_encode_connect(buffer, sizeof buffer, "wirebench", true);
    assert_int_equal(n, 4 + 271);
    const uint8_t asked[5] = {0, 4, 1, 0, 0};
    assert_memory_equal(buffer + 4 + 264, asked, 5);
    const uint8_t keepalive[4] = {10, 0, 0, 0}, disconnect[4] = {9, 0, 0, 0};
    assert_int_equal(wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_KEEPALIVE), 4);
    assert_memory_equal(buffer, keepalive, 4);
    assert_int_equal(wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_DISCONNECT), 4);
    assert_memory_equal(buffer, disconnect, 4);
}

static void encoders_never_overrun(void **state)
{
    (void)state;
    natnet_example(&sent, 7);
    const size_t n = encode((struct wb_natnet_version){4, 1});
    for (size_t size = 0; size < n; size++) {
        uint8_t *const tight = malloc(size ? size : 1);
        assert_int_equal(
            wb_natnet_encode_frame(tight, size, (struct wb_natnet_version){4, 1}, &sent), 0);
        assert_int_equal(wb_natnet_encode_empty(tight, size < 3 ? size : 3, WB_NATNET_KEEPALIVE),
                         0);
        free(tight);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_of_every_version_survive_the_round_trip),
        cmocka_unit_test(empty_frames_count_as_frames),
        cmocka_unit_test(version_4_0_is_read_with_and_without_precision_stamp),
        cmocka_unit_test(every_truncation_is_rejected),
        cmocka_unit_test(bytes_after_the_frame_are_rejected),
        cmocka_unit_test(malicious_counts_are_rejected),
        cmocka_unit_test(section_size_must_equal_its_content),
        cmocka_unit_test(newer_versions_of_the_same_layout_are_read),
        cmocka_unit_test(unknown_section_is_rejected),
        cmocka_unit_test(additional_field_in_a_marker_is_rejected),
        cmocka_unit_test(bytes_before_the_end_mark_are_rejected),
        cmocka_unit_test(implausible_stamps_are_rejected),
        cmocka_unit_test(markers_beyond_the_limit_are_counted),
        cmocka_unit_test(server_info_survives_the_round_trip),
        cmocka_unit_test(echoes_carry_the_stamp_verbatim),
        cmocka_unit_test(requests_and_responses_survive_the_round_trip),
        cmocka_unit_test(client_messages_have_their_documented_sizes),
        cmocka_unit_test(encoders_never_overrun),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
