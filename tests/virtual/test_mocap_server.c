/* The NatNet server under the real client driver, over real sockets. */
#include "fixtures/virtual/mocap_server_private.h"

#include <arpa/inet.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/random.h"
#include "daq/protocol/drivers.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/stream/stream.h"
#include "fixtures/virtual/sim_mocap_private.h"
#include "tests/virtual/setup.h"

struct scene {
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_mocap_server *server;
    struct wb_live_wire_view view;
    struct wb_natnet_frame frame, received;
    uint64_t k;
    /* The client. */
    int socket;
    struct sockaddr_in address;
    void *state;
    int frames, probes, errors;
    char complaint[256];
    double probe_error; /* s, largest */
    int64_t now_ns;
};

static void keep_frame(void *context, const struct wb_mocap_frame *frame)
{
    struct scene *const scene = context;
    scene->received.mocap = *frame;
    scene->frames++;
}

static void keep_probe(void *context, const struct wb_clock_probe *probe)
{
    struct scene *const scene = context;
    const double host = wb_seconds_from_ns(probe->t_sent_ns);
    const double off = probe->t_device - wb_sim_mocap_clock(&scene->mocap, host);
    scene->probes++;
    scene->probe_error = fmax(scene->probe_error, fabs(off));
}

static void keep_remark(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                        const char *text)
{
    (void)t_ns;
    (void)kind;
    struct scene *const scene = context;
    if (level >= WB_LOG_INFO)
        return;
    scene->errors++;
    snprintf(scene->complaint, sizeof scene->complaint, "%s", text);
}

static void send_outbox(struct scene *scene, struct wb_outbox *outbox)
{
    size_t start = 0;
    for (size_t i = 0; i < outbox->n_entries; i++) {
        assert_true(sendto(scene->socket, outbox->bytes + start, outbox->ends[i] - start, 0,
                           (const struct sockaddr *)&scene->address, sizeof scene->address) > 0);
        start = outbox->ends[i];
    }
    wb_outbox_clear(outbox);
}

static void open_scene(struct scene *scene, struct wb_natnet_version version)
{
    struct wb_outbox outbox;
    memset(scene, 0, sizeof *scene);
    setup_bench(&scene->setup, "type1-L85-1", 4);
    strcpy(scene->setup.rig.mocap.address, "udp:127.0.0.1:1510");
    wb_sim_mocap_init(&scene->mocap, &scene->setup.truth, 'y', 7, version);
    scene->view.n_markers = 7;
    for (int i = 0; i < 7; i++)
        scene->view.x[i] = scene->setup.specimen.markers[i];
    const struct wb_mocap_server_settings settings = {.version = version};
    assert_int_equal(wb_mocap_server_open(&scene->server, &settings, &scene->mocap), WB_OK);
    scene->socket = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    assert_true(scene->socket >= 0);
    scene->address.sin_family = AF_INET;
    scene->address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    scene->address.sin_port = htons((uint16_t)wb_mocap_server_port(scene->server));
    scene->state = calloc(1, wb_natnet_client.state_size);
    assert_non_null(scene->state);
    assert_int_equal(wb_natnet_client.init(scene->state, &scene->setup.rig), WB_OK);
    wb_outbox_clear(&outbox);
    wb_natnet_client.start(scene->state, 0, &outbox);
    send_outbox(scene, &outbox);
}

static void close_scene(struct scene *scene)
{
    wb_mocap_server_close(scene->server);
    close(scene->socket);
    free(scene->state);
}

static void hear(struct scene *scene)
{
    static uint8_t bytes[65536];
    const struct wb_sink sink = {
        .context = scene, .mocap = keep_frame, .probe = keep_probe, .remark = keep_remark};
    for (ssize_t n; (n = recv(scene->socket, bytes, sizeof bytes, 0)) >= 0;)
        wb_natnet_client.receive(scene->state, scene->now_ns, bytes, (size_t)n, &sink);
}

/* One frame period on both sides, with a simulated clock. */
static void turn(struct scene *scene)
{
    struct wb_outbox outbox;
    const double t = wb_sim_mocap_send_time(&scene->mocap, scene->k);
    scene->now_ns = wb_ns_from_seconds(t);
    wb_outbox_clear(&outbox);
    wb_natnet_client.tick(scene->state, scene->now_ns, &outbox);
    send_outbox(scene, &outbox);
    wb_mocap_server_receive(scene->server, t, scene->now_ns);
    wb_sim_mocap_frame(&scene->mocap, scene->k++, &scene->view, &scene->frame);
    wb_mocap_server_send(scene->server, &scene->frame, scene->now_ns);
    hear(scene);
}

static void the_real_client_understands_every_version(void **state)
{
    (void)state;
    static const struct wb_natnet_version versions[] = {{2, 5}, {2, 6}, {2, 7}, {2, 9}, {2, 10},
                                                        {3, 0}, {3, 1}, {4, 0}, {4, 1}};
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        open_scene(scene, versions[i]);
        for (int n = 0; n < 600; n++) {
            turn(scene);
            /* A frame arrives unchanged. */
            if (scene->frames == 0)
                continue;
            const struct wb_mocap_frame *const sent = &scene->frame.mocap;
            const struct wb_mocap_frame *const received = &scene->received.mocap;
            assert_int_equal(received->frame_number, sent->frame_number);
            assert_int_equal(received->n_markers, sent->n_markers);
            for (int m = 0; m < sent->n_markers; m++) {
                assert_int_equal(received->markers[m].id, sent->markers[m].id);
                assert_memory_equal(received->markers[m].position, sent->markers[m].position,
                                    sizeof sent->markers[m].position);
                if (wb_natnet_version_at_least(versions[i], 2, 6))
                    assert_int_equal(received->markers[m].params, sent->markers[m].params);
            }
            if (wb_natnet_version_at_least(versions[i], 2, 7))
                assert_close(received->t_device, sent->t_device, 0.0);
            if (wb_natnet_version_at_least(versions[i], 3, 0))
                assert_true(received->camera_data_received == sent->camera_data_received &&
                            received->transmit == sent->transmit);
        }
        if (scene->frames < 595 || scene->errors > 0)
            fail_msg("NatNet %u.%u: %d of 600 frames, %d warnings: %s", versions[i].major,
                     versions[i].minor, scene->frames, scene->errors, scene->complaint);
        /* Clock probes from version 3.0 on; they return the server's clock. */
        if (wb_natnet_version_at_least(versions[i], 3, 0)) {
            assert_true(scene->probes >= 8);
            assert_close(scene->probe_error, 0.0, 1e-6);
        } else {
            assert_int_equal(scene->probes, 0);
        }
        close_scene(scene);
    }
    free(scene);
}

static void a_silent_client_is_dropped_with_a_message(void **state)
{
    (void)state;
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    open_scene(scene, (struct wb_natnet_version){3, 0});
    turn(scene);
    turn(scene);
    assert_int_equal(wb_mocap_server_clients(scene->server), 1);
    wb_mocap_server_send(scene->server, &scene->frame,
                         scene->now_ns + WB_MOCAP_SERVER_TIMEOUT_NS - WB_NS_PER_MS);
    assert_int_equal(wb_mocap_server_clients(scene->server), 1);
    hear(scene);
    wb_mocap_server_send(scene->server, &scene->frame,
                         scene->now_ns + WB_MOCAP_SERVER_TIMEOUT_NS + WB_NS_PER_MS);
    assert_int_equal(wb_mocap_server_clients(scene->server), 0);
    uint8_t bytes[64];
    assert_int_equal(recv(scene->socket, bytes, sizeof bytes, 0), WB_NATNET_HEADER);
    assert_int_equal(bytes[0], WB_NATNET_DISCONNECTBYTIMEOUT);
    close_scene(scene);
    free(scene);
}

static void a_disconnected_client_gets_no_more_frames(void **state)
{
    (void)state;
    struct wb_outbox outbox;
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    open_scene(scene, (struct wb_natnet_version){3, 0});
    turn(scene);
    turn(scene);
    wb_outbox_clear(&outbox);
    wb_natnet_client.stop(scene->state, &outbox);
    send_outbox(scene, &outbox);
    wb_mocap_server_receive(scene->server, 0.1, scene->now_ns);
    assert_int_equal(wb_mocap_server_clients(scene->server), 0);
    close_scene(scene);
    free(scene);
}

/* Sends a datagram and returns the answer's message number, -1 without one. */
static int ask(struct scene *scene, const uint8_t *bytes, size_t n, uint8_t *answer, size_t size)
{
    assert_true(sendto(scene->socket, bytes, n, 0, (const struct sockaddr *)&scene->address,
                       sizeof scene->address) == (ssize_t)n);
    wb_mocap_server_receive(scene->server, 1.0, 1);
    const ssize_t got = recv(scene->socket, answer, size, 0);
    return got < WB_NATNET_HEADER ? -1 : answer[0];
}

static void requests_are_answered(void **state)
{
    (void)state;
    uint8_t bytes[512], answer[512];
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    open_scene(scene, (struct wb_natnet_version){3, 0});
    wb_mocap_server_receive(scene->server, 0.5, 1);
    assert_true(recv(scene->socket, answer, sizeof answer, 0) > 0);
    assert_int_equal(answer[0], WB_NATNET_SERVERINFO);
    assert_string_equal((const char *)answer + WB_NATNET_HEADER, "virtual rig");

    static const struct {
        const char *request;
        int message;
        float real;
        int32_t integer;
    } cases[] = {
        {"FrameRate", WB_NATNET_RESPONSE, 120.0f, 0},
        {"UnitsToMillimeters", WB_NATNET_RESPONSE, 1000.0f, 0},
        {"CurrentMode", WB_NATNET_RESPONSE, 0.0f, 0},
        {"SetRecordTakeName,wire 1", WB_NATNET_RESPONSE, 0.0f, 0},
        {"TestRequest", WB_NATNET_UNRECOGNIZED_REQUEST, 0.0f, 0},
        {"SubscribeToData,LabeledMarkers", WB_NATNET_UNRECOGNIZED_REQUEST, 0.0f, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const size_t n =
            wb_natnet_encode_text(bytes, sizeof bytes, WB_NATNET_REQUEST, cases[i].request);
        assert_int_equal(ask(scene, bytes, n, answer, sizeof answer), cases[i].message);
        if (cases[i].message != WB_NATNET_RESPONSE)
            continue;
        float real;
        memcpy(&real, answer + WB_NATNET_HEADER, sizeof real);
        assert_close((double)real, (double)cases[i].real, 0.0);
    }
    const uint8_t models[] = {WB_NATNET_REQUEST_MODELDEF, 0, 0, 0};
    assert_int_equal(ask(scene, models, sizeof models, answer, sizeof answer), WB_NATNET_MODELDEF);
    const uint8_t nonsense[] = {77, 0, 0, 0}, broken[] = {2, 0, 200, 0, 'x'};
    assert_int_equal(ask(scene, nonsense, sizeof nonsense, answer, sizeof answer),
                     WB_NATNET_UNRECOGNIZED_REQUEST);
    assert_int_equal(ask(scene, broken, sizeof broken, answer, sizeof answer), -1);
    close_scene(scene);
    free(scene);
}

/* Any datagram causes at most an answer, and frames continue. */
static void random_datagrams_do_no_harm(void **state)
{
    (void)state;
    struct scene *const scene = malloc(sizeof *scene);
    assert_non_null(scene);
    open_scene(scene, (struct wb_natnet_version){3, 0});
    turn(scene);
    turn(scene);
    for (uint64_t i = 0; i < 3000; i++) {
        uint8_t bytes[64], answer[2048];
        const size_t n = wb_random_bits(2, i, 0) % sizeof bytes;
        for (size_t k = 0; k < n; k++)
            bytes[k] = (uint8_t)wb_random_bits(2, i, k + 1);
        if (n >= 4) {
            /* Mostly known messages of the right length, but no disconnect. */
            bytes[0] = (uint8_t)(wb_random_bits(2, i, 100) % 16);
            bytes[0] = bytes[0] == WB_NATNET_DISCONNECT ? 0 : bytes[0];
            bytes[1] = bytes[3] = 0;
            bytes[2] = (uint8_t)(n - 4);
        }
        assert_true(sendto(scene->socket, bytes, n, 0, (const struct sockaddr *)&scene->address,
                           sizeof scene->address) == (ssize_t)n);
        wb_mocap_server_receive(scene->server, 1.0, scene->now_ns);
        while (recv(scene->socket, answer, sizeof answer, 0) >= 0) {
        }
    }
    const int before = scene->frames;
    for (int i = 0; i < 10; i++)
        turn(scene);
    assert_int_equal(scene->frames, before + 10);
    close_scene(scene);
    free(scene);
}

static int refused;

static void count_errors(void *context, enum wb_log_level level, const char *domain,
                         const char *message)
{
    (void)context;
    (void)domain;
    (void)message;
    refused += level == WB_LOG_ERROR;
}

static void several_servers_have_ports_of_their_own(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_mocap_server *servers[4];
    const struct wb_mocap_server_settings settings = {.version = {3, 0}};
    const struct wb_mocap_server_settings wrong = {.version = {4, 5}};
    setup_bench(&setup, "type1-L85-1", 4);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, settings.version);
    for (int i = 0; i < 4; i++)
        assert_int_equal(wb_mocap_server_open(&servers[i], &settings, &mocap), WB_OK);
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            assert_int_not_equal(wb_mocap_server_port(servers[i]),
                                 wb_mocap_server_port(servers[j]));
    /* A requested port is used, or an error is reported. */
    const int port = wb_mocap_server_port(servers[0]);
    const struct wb_mocap_server_settings fixed = {.version = {3, 0}, .port = port};
    struct wb_mocap_server *other;
    wb_log_set_sink(count_errors, NULL);
    assert_int_equal(wb_mocap_server_open(&other, &fixed, &mocap), WB_ERR_BUSY);
    assert_null(other);
    assert_int_equal(refused, 1);
    for (int i = 0; i < 4; i++)
        wb_mocap_server_close(servers[i]);
    assert_int_equal(wb_mocap_server_open(&other, &fixed, &mocap), WB_OK);
    assert_int_equal(wb_mocap_server_port(other), port);
    wb_mocap_server_close(other);
    assert_int_equal(wb_mocap_server_open(&servers[0], &wrong, &mocap), WB_ERR_UNSUPPORTED);
    wb_log_set_sink(NULL, NULL);
    assert_int_equal(refused, 2);
    assert_null(servers[0]);
}

/* The server's address in a rig file works with the real stream. */
static void frames_arrive_through_a_multicast_group(void **state)
{
    (void)state;
    struct setup setup;
    struct wb_sim_mocap mocap;
    struct wb_mocap_server *server;
    struct wb_stream *stream;
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    static struct wb_natnet_frame frame, received;
    static uint8_t bytes[65536];
    const struct wb_mocap_server_settings settings = {.version = {3, 0}, .multicast = true};
    char address[128];
    size_t n = 0;
    setup_bench(&setup, "type1-L85-1", 4);
    wb_sim_mocap_init(&mocap, &setup.truth, 'y', 7, settings.version);
    assert_int_equal(wb_mocap_server_open(&server, &settings, &mocap), WB_OK);
    const int port = wb_mocap_server_port(server);
    snprintf(address, sizeof address,
             "udp:127.0.0.1:%d,group=" WB_MOCAP_SERVER_GROUP ":%d,interface=127.0.0.1", port, port);
    if (wb_stream_open(&stream, address) != WB_OK) {
        wb_mocap_server_close(server);
        skip();
    }
    frame.mocap.frame_number = 77; /* no client has connected */
    wb_mocap_server_send(server, &frame, 0);
    struct pollfd polled[2];
    int descriptors[2];
    const int n_descriptors = wb_stream_descriptors(stream, descriptors);
    for (int i = 0; i < n_descriptors; i++)
        polled[i] = (struct pollfd){.fd = descriptors[i], .events = POLLIN};
    assert_int_equal(poll(polled, (nfds_t)n_descriptors, 60000), 1);
    assert_int_equal(wb_stream_read(stream, bytes, sizeof bytes, &n), WB_OK);
    assert_int_equal(wb_natnet_decode_packet(bytes, n, &packet, &fault), WB_OK);
    assert_int_equal(wb_natnet_decode_frame(&packet, settings.version, &received, &fault), WB_OK);
    assert_int_equal(received.mocap.frame_number, 77);
    wb_stream_close(stream);
    wb_mocap_server_close(server);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_real_client_understands_every_version),
        cmocka_unit_test(a_silent_client_is_dropped_with_a_message),
        cmocka_unit_test(a_disconnected_client_gets_no_more_frames),
        cmocka_unit_test(requests_are_answered),
        cmocka_unit_test(random_datagrams_do_no_harm),
        cmocka_unit_test(several_servers_have_ports_of_their_own),
        cmocka_unit_test(frames_arrive_through_a_multicast_group),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
