/* NatNet datagrams captured from real servers, against the facts listed beside them. Needs
 * WIREBENCH_REAL_DATA; skipped (exit status 77) without. */
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "daq/protocol/natnet.h"
#include "daq/protocol/natnet_encode.h"
#include "tests/check.h"

#define SKIPPED 77

static struct wb_natnet_frame frame, again;
static char *bytes;
static size_t size;

static struct wb_natnet_packet packet_of(const char *name)
{
    char path[WB_PATH];
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    snprintf(path, sizeof path, "%s/natnet/%s", getenv("WIREBENCH_REAL_DATA"), name);
    free(bytes);
    bytes = NULL;
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    assert_int_equal(wb_natnet_decode_packet((const uint8_t *)bytes, size, &packet, &fault), WB_OK);
    /* The length in the header is that of the whole datagram. */
    assert_int_equal(packet.n_payload + WB_NATNET_HEADER, size);
    return packet;
}

/* Decodes a frame; that it succeeds says that it was consumed to its last byte, which is proved by
 * refusing it one byte shorter. */
static void read_frame(const char *name, uint8_t major, uint8_t minor)
{
    const struct wb_natnet_version version = {major, minor};
    struct wb_natnet_packet packet = packet_of(name);
    struct wb_natnet_fault fault;
    assert_int_equal(packet.message, WB_NATNET_FRAMEOFDATA);
    packet.n_payload--;
    assert_int_equal(wb_natnet_decode_frame(&packet, version, &frame, &fault), WB_ERR_FORMAT);
    packet.n_payload++;
    assert_int_equal(wb_natnet_decode_frame(&packet, version, &frame, &fault), WB_OK);
}

static struct wb_natnet_server read_server(const char *name)
{
    struct wb_natnet_server server;
    struct wb_natnet_fault fault;
    const struct wb_natnet_packet packet = packet_of(name);
    assert_int_equal(packet.message, WB_NATNET_SERVERINFO);
    assert_int_equal(wb_natnet_decode_server(&packet, &server, &fault), WB_OK);
    return server;
}

static void motive_1_5_streams_natnet_2_5(void **state)
{
    (void)state;
    const struct wb_natnet_server server = read_server("frame-motive-1.5.0-000.bin");
    assert_string_equal(server.name, "NatNetLib");
    assert_int_equal(server.natnet_version[0], 2);
    assert_int_equal(server.natnet_version[1], 5);
    assert_memory_equal(server.app_version, server.natnet_version, 4);
    assert_false(server.has_connection);
    static const double t[2] = {775.3009, 775.3092};
    for (int i = 0; i < 2; i++) {
        read_frame(i ? "frame-motive-1.5.0-002.bin" : "frame-motive-1.5.0-001.bin", 2, 5);
        assert_int_equal(frame.mocap.frame_number, 92881 + i);
        assert_int_equal(frame.n_labelled, 3);
        for (int k = 0; k < 3; k++)
            assert_close((double)frame.mocap.markers[k].size, 0.024, 1e-3);
        /* The field called latency is a capture time. */
        assert_close(frame.mocap.t_device, t[i], 1e-4);
        assert_true((float)frame.mocap.t_device == frame.latency);
        assert_int_equal(frame.mocap.params, 0);
    }
}

static void motive_1_7_streams_natnet_2_7(void **state)
{
    (void)state;
    const struct wb_natnet_server server = read_server("frame-motive-1.7.2-000.bin");
    assert_int_equal(server.natnet_version[0], 2);
    assert_int_equal(server.natnet_version[1], 7);
    static const double t[2] = {3426.77500, 3426.78333};
    for (int i = 0; i < 2; i++) {
        read_frame(i ? "frame-motive-1.7.2-002.bin" : "frame-motive-1.7.2-001.bin", 2, 7);
        assert_int_equal(frame.mocap.frame_number, 411213 + i);
        assert_close(frame.mocap.t_device, t[i], 6e-6);
        assert_true(frame.n_labelled > 0);
        for (int k = 0; k < frame.n_labelled; k++)
            assert_int_equal(frame.mocap.markers[k].params, WB_MARKER_POINT_CLOUD_SOLVED);
    }
}

static void natnet_3_0_frame_has_its_listed_values(void **state)
{
    (void)state;
    read_frame("mocapframe_packet_v3.bin", 3, 0);
    assert_int_equal(frame.mocap.frame_number, 162734);
    assert_int_equal(frame.n_sets, 0);
    assert_int_equal(frame.n_others, 5);
    assert_int_equal(frame.n_bodies, 1);
    assert_int_equal(frame.n_labelled, 6);
    assert_close(frame.mocap.t_device, 1356.11667, 5e-6);
    int solved = 0, unlabelled = 0;
    for (int i = 0; i < 6; i++) {
        const struct wb_marker *const marker = &frame.mocap.markers[i];
        if (marker->id == 50007) {
            unlabelled++;
            assert_int_equal(marker->params, 18);
        } else {
            assert_in_range(marker->id, 131073, 131077);
            assert_int_equal(marker->params, 10);
            solved++;
        }
    }
    assert_int_equal(solved, 5);
    assert_int_equal(unlabelled, 1);
    const float *const first = frame.mocap.markers[0].position;
    assert_close((double)first[0], 0.127216, 5e-7);
    assert_close((double)first[1], 1.505028, 5e-7);
    assert_close((double)first[2], -0.885828, 5e-7);
}

/* Reason for not adding the legacy list to the labelled one. */
static void legacy_list_repeats_the_labelled_markers_bit_for_bit(void **state)
{
    (void)state;
    read_frame("mocapframe_packet_v3.bin", 3, 0);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(frame.mocap.markers[i].id, 131073 + i);
        assert_memory_equal(frame.others[i], frame.mocap.markers[i].position,
                            sizeof frame.others[i]);
    }
}

static void natnet_2_10_frame_with_a_skeleton_has_its_listed_values(void **state)
{
    (void)state;
    read_frame("mocapframe_packet_v2.bin", 2, 10);
    assert_int_equal(frame.mocap.frame_number, 109238);
    assert_int_equal(frame.n_sets, 3);
    assert_string_equal(frame.sets[0].name, "RigidBody 1");
    assert_int_equal(frame.sets[0].n_points, 3);
    assert_string_equal(frame.sets[1].name, "Karlie");
    assert_int_equal(frame.sets[1].n_points, 37);
    assert_string_equal(frame.sets[2].name, "all");
    assert_int_equal(frame.sets[2].n_points, 40);
    assert_int_equal(frame.n_others, 4);
    assert_int_equal(frame.n_skeletons, 1);
    assert_int_equal(frame.skeletons[0].id, 4);
    assert_int_equal(frame.skeletons[0].n_bodies, 21);
    assert_int_equal(frame.n_labelled, 44);
    assert_close(frame.mocap.t_device, 910.31667, 5e-6);
    assert_int_equal(frame.n_force_plates, 0);
}

static void server_info_gives_name_and_version(void **state)
{
    (void)state;
    const struct wb_natnet_server v2 = read_server("serverinfo_packet_v2.bin");
    assert_string_equal(v2.name, "Motive");
    assert_int_equal(v2.natnet_version[0], 2);
    assert_int_equal(v2.natnet_version[1], 10);
    assert_false(v2.has_connection);
    const struct wb_natnet_server v3 = read_server("serverinfo_packet_v3.bin");
    const uint8_t motive[4] = {2, 1, 0, 0}, natnet[4] = {3, 0, 0, 0};
    const uint8_t group[4] = {239, 255, 42, 99};
    assert_string_equal(v3.name, "Motive");
    assert_memory_equal(v3.app_version, motive, 4);
    assert_memory_equal(v3.natnet_version, natnet, 4);
    assert_true(v3.has_connection && v3.multicast);
    assert_true(v3.clock_frequency == 0x328c93);
    assert_int_equal(v3.data_port, 1511);
    assert_memory_equal(v3.group, group, 4);
}

static void echo_response_repeats_the_stamp_of_the_request(void **state)
{
    (void)state;
    struct wb_natnet_fault fault;
    uint64_t asked, answered, ticks;
    struct wb_natnet_packet packet = packet_of("echorequest_packet_v3.bin");
    assert_int_equal(packet.message, WB_NATNET_ECHOREQUEST);
    assert_int_equal(wb_natnet_decode_echo(&packet, &asked, &ticks, &fault), WB_OK);
    packet = packet_of("echoresponse_packet_v3.bin");
    assert_int_equal(packet.message, WB_NATNET_ECHORESPONSE);
    assert_int_equal(wb_natnet_decode_echo(&packet, &answered, &ticks, &fault), WB_OK);
    assert_true(asked == answered);
    assert_true(ticks == UINT64_C(0x149cde48504));
}

static void other_messages_are_reported_by_their_number(void **state)
{
    (void)state;
    assert_int_equal(packet_of("connect_packet_v3.bin").message, WB_NATNET_CONNECT);
    assert_int_equal(packet_of("connect_packet_v3.bin").n_payload, 264);
    assert_int_equal(packet_of("discovery_packet_v3.bin").message, WB_NATNET_DISCOVERY);
    assert_int_equal(packet_of("modeldef_packet_v3.bin").message, WB_NATNET_MODELDEF);
}

/* Frames without nested markers (which are decoded to their number only) encode to the same
 * bytes. */
static void real_3_0_frame_is_encoded_as_the_server_did(void **state)
{
    (void)state;
    static uint8_t encoded[4096];
    const struct wb_natnet_version version = {3, 0};
    read_frame("mocapframe_packet_v3.bin", 3, 0);
    again = frame;
    const size_t n = wb_natnet_encode_frame(encoded, sizeof encoded, version, &again);
    assert_int_equal(n, size);
    assert_memory_equal(encoded, bytes, n);
}

/* A frame decoded as another version than its own is rejected, not misread. */
static void frames_are_rejected_under_a_wrong_version(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        struct wb_natnet_version wrong;
    } cases[] = {
        {"frame-motive-1.5.0-001.bin", {2, 7}}, {"frame-motive-1.7.2-001.bin", {2, 5}},
        {"frame-motive-1.7.2-001.bin", {3, 0}}, {"mocapframe_packet_v3.bin", {2, 10}},
        {"mocapframe_packet_v3.bin", {4, 1}},   {"mocapframe_packet_v2.bin", {2, 11}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct wb_natnet_fault fault;
        const struct wb_natnet_packet packet = packet_of(cases[i].name);
        assert_int_equal(wb_natnet_decode_frame(&packet, cases[i].wrong, &frame, &fault),
                         WB_ERR_FORMAT);
    }
}

int main(void)
{
    if (!getenv("WIREBENCH_REAL_DATA")) {
        printf("skipped: WIREBENCH_REAL_DATA is not set\n");
        return SKIPPED;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(motive_1_5_streams_natnet_2_5),
        cmocka_unit_test(motive_1_7_streams_natnet_2_7),
        cmocka_unit_test(natnet_3_0_frame_has_its_listed_values),
        cmocka_unit_test(legacy_list_repeats_the_labelled_markers_bit_for_bit),
        cmocka_unit_test(natnet_2_10_frame_with_a_skeleton_has_its_listed_values),
        cmocka_unit_test(server_info_gives_name_and_version),
        cmocka_unit_test(echo_response_repeats_the_stamp_of_the_request),
        cmocka_unit_test(other_messages_are_reported_by_their_number),
        cmocka_unit_test(real_3_0_frame_is_encoded_as_the_server_did),
        cmocka_unit_test(frames_are_rejected_under_a_wrong_version),
    };
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    free(bytes);
    return failed;
}
