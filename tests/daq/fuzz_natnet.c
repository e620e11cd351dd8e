/* Any datagram of any version is decoded or rejected, without access outside its bytes and the
 * arrays of the frame; the client accepts any sequence of them. Input: major, minor, then the
 * datagram. */
#include "tests/daq/fuzz_driver.h"

#include "daq/protocol/natnet_encode.h"
#include "tests/daq/natnet_example.h"

static struct wb_natnet_frame frame;

static void check_group(const struct wb_natnet_group *groups, int n)
{
    for (int i = 0; i < n && i < WB_NATNET_MAX_GROUPS; i++) {
        FUZZ_REQUIRE(groups[i].n_bodies >= groups[i].n_kept && groups[i].n_kept >= 0);
        FUZZ_REQUIRE(groups[i].first_body + groups[i].n_kept <= frame.n_bodies_kept);
    }
}

static void check_frame(size_t n)
{
    FUZZ_REQUIRE(frame.mocap.n_markers >= 0 && frame.mocap.n_markers <= WB_MAX_MARKERS);
    FUZZ_REQUIRE(frame.mocap.n_markers <= frame.n_labelled);
    FUZZ_REQUIRE((size_t)frame.n_labelled * 20 <= n);
    FUZZ_REQUIRE(frame.n_points >= 0 && frame.n_points <= WB_NATNET_MAX_POINTS);
    FUZZ_REQUIRE(frame.n_bodies_kept >= 0 && frame.n_bodies_kept <= WB_NATNET_MAX_BODIES);
    for (int i = 0; i < frame.n_sets && i < WB_NATNET_MAX_SETS; i++) {
        const struct wb_natnet_set *const set = &frame.sets[i];
        FUZZ_REQUIRE(memchr(set->name, 0, sizeof set->name) != NULL);
        FUZZ_REQUIRE(set->n_kept >= 0 && set->first_point + set->n_kept <= frame.n_points);
    }
    check_group(frame.skeletons, frame.n_skeletons);
    check_group(frame.assets, frame.n_assets);
    FUZZ_REQUIRE(frame.mocap.t_device >= 0.0 && frame.mocap.t_device <= 1e9);
}

static void check_decoders(const struct wb_natnet_packet *packet, struct wb_natnet_version version)
{
    struct wb_natnet_fault fault = {0};
    struct wb_natnet_server server;
    struct wb_natnet_response response;
    uint64_t stamp, ticks;
    char text[16];
    if (wb_natnet_decode_frame(packet, version, &frame, &fault) == WB_OK)
        check_frame(packet->n_payload);
    else
        FUZZ_REQUIRE(fault.reason && fault.offset <= WB_NATNET_HEADER + packet->n_payload);
    if (wb_natnet_decode_server(packet, &server, &fault) == WB_OK)
        FUZZ_REQUIRE(memchr(server.name, 0, sizeof server.name) != NULL);
    if (wb_natnet_decode_response(packet, &response, &fault) == WB_OK && !response.is_number)
        FUZZ_REQUIRE(memchr(response.text, 0, sizeof response.text) != NULL);
    if (wb_natnet_decode_text(packet, text, sizeof text, &fault) == WB_OK)
        FUZZ_REQUIRE(strlen(text) < sizeof text);
    if (wb_natnet_decode_echo(packet, &stamp, &ticks, &fault) != WB_OK)
        FUZZ_REQUIRE(fault.reason != NULL);
}

static void take_mocap(void *context, const struct wb_mocap_frame *mocap)
{
    (void)context;
    FUZZ_REQUIRE(mocap->n_markers <= WB_MAX_MARKERS);
}

static void run_client(const uint8_t *bytes, size_t n, struct wb_natnet_version version)
{
    static uint8_t info[512];
    static void *state;
    const struct wb_rig rig = {.mocap = {.address = "udp:10.0.0.2:1510", .frame_rate = 120.0},
                               .time_scale = 1.0};
    const struct wb_sink sink = {.mocap = take_mocap, .remark = fuzz_remark};
    const struct wb_natnet_server server = {
        .name = "Motive",
        .natnet_version = {version.major, version.minor},
        .has_connection = true,
        .clock_frequency = version.minor, /* also 0 */
    };
    struct wb_outbox outbox = {0};
    if (!state)
        state = malloc(wb_natnet_client.state_size);
    FUZZ_REQUIRE(state != NULL);
    memset(state, 0, wb_natnet_client.state_size);
    FUZZ_REQUIRE(wb_natnet_client.init(state, &rig) == WB_OK);
    wb_natnet_client.start(state, 0, &outbox);
    wb_natnet_client.receive(state, 1, bytes, n, &sink);
    const size_t n_info = wb_natnet_encode_server(info, sizeof info, &server);
    wb_natnet_client.receive(state, 2, info, n_info, &sink);
    for (int i = 0; i < 2; i++) {
        wb_natnet_client.receive(state, 3 + i, bytes, n, &sink);
        wb_natnet_client.tick(state, 3 + i, &outbox);
    }
    wb_natnet_client.stop(state, &outbox);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    if (n < 2)
        return 0;
    const struct wb_natnet_version version = {bytes[0], bytes[1]};
    if (wb_natnet_decode_packet(bytes + 2, n - 2, &packet, &fault) == WB_OK)
        check_decoders(&packet, version);
    run_client(bytes + 2, n - 2, version);
    return 0;
}

#ifndef WB_LIBFUZZER

#define N_SEEDS 17

/* A seed with the version before it. */
static uint8_t *put_version(uint8_t *seed, uint8_t major, uint8_t minor)
{
    seed[0] = major;
    seed[1] = minor;
    return seed + 2;
}

int main(int argc, char **argv)
{
    static const struct wb_natnet_version versions[] = {
        {2, 5}, {2, 6}, {2, 7}, {2, 9}, {2, 10}, {2, 11}, {3, 0}, {4, 0}, {4, 1}, {4, 4},
    };
    static uint8_t seeds[N_SEEDS][4096];
    const uint8_t *pointers[N_SEEDS];
    size_t sizes[N_SEEDS], n = 0;
    const size_t room = sizeof seeds[0] - 2;
    static struct wb_natnet_frame example;
    struct wb_natnet_server server = {.name = "Motive", .natnet_version = {3, 0}};
    natnet_example(&example, 7);
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++, n++) {
        const struct wb_natnet_version known = {
            versions[i].major,
            versions[i].major == 4 && versions[i].minor == 4 ? (uint8_t)1 : versions[i].minor};
        uint8_t *const seed = put_version(seeds[n], versions[i].major, versions[i].minor);
        sizes[n] = 2 + wb_natnet_encode_frame(seed, room, known, &example);
    }
    sizes[n] = 2 + wb_natnet_encode_server(put_version(seeds[n], 3, 0), room, &server);
    server.has_connection = true;
    n++;
    sizes[n] = 2 + wb_natnet_encode_server(put_version(seeds[n], 3, 0), room, &server);
    n++;
    sizes[n] = 2 + wb_natnet_encode_echo_response(put_version(seeds[n], 3, 0), room, 1, 2);
    n++;
    sizes[n] = 2 + wb_natnet_encode_response_real(put_version(seeds[n], 3, 0), room, 120.0F);
    n++;
    sizes[n] =
        2 + wb_natnet_encode_text(put_version(seeds[n], 3, 0), room, WB_NATNET_RESPONSE, "no");
    n++;
    sizes[n] = 2 + wb_natnet_encode_text(put_version(seeds[n], 3, 0), room, WB_NATNET_MESSAGESTRING,
                                         "hello");
    n++;
    sizes[n] = 2 + wb_natnet_encode_empty(put_version(seeds[n], 3, 0), room,
                                          WB_NATNET_UNRECOGNIZED_REQUEST);
    n++;
    FUZZ_REQUIRE(n == N_SEEDS);
    for (size_t i = 0; i < n; i++)
        pointers[i] = seeds[i];
    return fuzz_main(argc, argv, pointers, sizes, n, 150000);
}

#endif
