#include "base/units.h"
#include "daq/protocol/drivers.h"
#include "daq/protocol/natnet_encode.h"
#include "tests/check.h"
#include "tests/daq/collect.h"
#include "tests/daq/natnet_example.h"

#define MS WB_NS_PER_MS
#define S WB_NS_PER_S

static uint8_t buffer[65536];
static struct wb_natnet_frame frame;
static struct collect collect;

static struct wb_rig rig_of(const char *address)
{
    struct wb_rig rig = {.gravity = 9.81, .time_scale = 1.0};
    strcpy(rig.mocap.address, address);
    return rig;
}

static void receive(void *driver, int64_t t_ns, size_t n)
{
    const struct wb_sink sink = collect_sink(&collect);
    assert_true(n > 0);
    wb_natnet_client.receive(driver, t_ns, buffer, n, &sink);
}

static size_t server_info(int major, int minor, bool multicast)
{
    struct wb_natnet_server server = {.name = "Motive", .app_version = {2, 1, 0, 0}};
    const uint8_t group[4] = {239, 255, 42, 99};
    server.natnet_version[0] = (uint8_t)major;
    server.natnet_version[1] = (uint8_t)minor;
    server.has_connection = major >= 3;
    server.clock_frequency = 10000000;
    server.data_port = 1511;
    server.multicast = multicast;
    memcpy(server.group, group, 4);
    return wb_natnet_encode_server(buffer, sizeof buffer, &server);
}

static size_t frame_of(int major, int minor)
{
    const struct wb_natnet_version version = {(uint8_t)major, (uint8_t)minor};
    return wb_natnet_encode_frame(buffer, sizeof buffer, version, &frame);
}

/* Most tests have a client with fresh state, an empty collection and a frame of seven markers. */
static int set_up(void **state)
{
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    memset(&collect, 0, sizeof collect);
    natnet_example(&frame, 7);
    *state = collect_open(&wb_natnet_client, &rig);
    return 0;
}

static int tear_down(void **state)
{
    free(*state);
    return 0;
}

#define DRIVER_TEST(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

static size_t answer_of(float number)
{
    return wb_natnet_encode_response_real(buffer, sizeof buffer, number);
}

static int message_of(const struct wb_outbox *outbox, size_t i)
{
    size_t n;
    return collect_entry(outbox, i, &n)[0];
}

static void connects_until_the_server_answers(void **state)
{
    void *const driver = *state;
    struct wb_outbox outbox = {0};
    wb_natnet_client.start(driver, 0, &outbox);
    for (int64_t t = 0; t < 2000; t += 20)
        wb_natnet_client.tick(driver, t * MS, &outbox);
    assert_int_equal(outbox.n_entries, 4); /* every 500 ms */
    size_t sizes[2];
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(message_of(&outbox, i), WB_NATNET_CONNECT);
        collect_entry(&outbox, i, &sizes[i % 2]);
    }
    assert_int_equal(sizes[0], 275);
    assert_int_equal(sizes[1], 268);
    receive(driver, 2000 * MS, server_info(3, 0, false));
    wb_outbox_clear(&outbox);
    wb_natnet_client.tick(driver, 2500 * MS, &outbox);
    for (size_t i = 0; i < outbox.n_entries; i++)
        assert_int_not_equal(message_of(&outbox, i), WB_NATNET_CONNECT);
    assert_non_null(strstr(collect_text(&collect, "connected"), "'Motive' 2.1.0.0, NatNet 3.0"));
}

static void frames_become_samples_with_their_stamps(void **state)
{
    void *const driver = *state;
    frame.mocap.markers[3].params |= WB_MARKER_OCCLUDED;
    receive(driver, 1, frame_of(3, 0)); /* before the version is known */
    assert_int_equal(collect.n_mocap, 0);
    assert_int_equal(collect_count(&collect, "early"), 1);
    receive(driver, 2, server_info(3, 0, false));
    assert_false(wb_natnet_client.ready(driver));
    receive(driver, 5 * S, frame_of(3, 0));
    assert_true(wb_natnet_client.ready(driver));
    assert_int_equal(collect.n_mocap, 1);
    assert_int_equal(collect.mocap.t_ns, 5 * S);
    assert_int_equal(collect.mocap.n_markers, 7);
    assert_memory_equal(collect.mocap.markers[6].position, frame.mocap.markers[6].position, 12);
    assert_int_equal(collect.mocap.markers[3].params & WB_MARKER_OCCLUDED, 1);
    assert_close(collect.mocap.t_device, 1356.125, 0.0);
    /* 1417339207940 ticks of 10 MHz */
    assert_close(collect.mocap.t_clock, 141733.9207940, 1e-9);
}

static void every_version_from_2_5_to_4_1_is_decoded_by_its_announcement(void **state)
{
    (void)state;
    static const int versions[][2] = {{2, 5},  {2, 6}, {2, 7}, {2, 9}, {2, 10},
                                      {2, 11}, {3, 0}, {3, 1}, {4, 0}, {4, 1}};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    natnet_example(&frame, 7);
    for (size_t i = 0; i < sizeof versions / sizeof versions[0]; i++) {
        const int major = versions[i][0], minor = versions[i][1];
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(major, minor, false));
        receive(driver, 1, frame_of(major, minor));
        assert_int_equal(collect.n_mocap, 1);
        assert_int_equal(collect.mocap.n_markers, 7);
        assert_int_equal(collect_count(&collect, "version"), 0);
        /* Before 2.6 there is no stamp but the f32 called latency. */
        const double expected = minor == 5 ? (double)775.3009F : 1356.125;
        assert_close(collect.mocap.t_device, expected, 0.0);
        assert_int_equal(isnan(collect.mocap.t_clock) != 0, major < 3);
        free(driver);
    }
}

static void unknown_versions_cause_a_warning(void **state)
{
    (void)state;
    static const struct {
        int minor;
        enum wb_log_level level;
        const char *words;
    } cases[] = {{2, WB_LOG_INFO, "NatNet 4.2: layout as in the vendor's"},
                 {4, WB_LOG_INFO, "NatNet 4.4: layout as in the vendor's"},
                 {5, WB_LOG_WARNING, "NatNet 4.5: layout unknown"}};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    natnet_example(&frame, 7);
    memset(&collect, 0, sizeof collect);
    void *driver;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memset(&collect, 0, sizeof collect);
        driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(4, cases[i].minor, false));
        receive(driver, 1, frame_of(4, cases[i].minor));
        receive(driver, 2, frame_of(4, 1));
        assert_int_equal(collect.n_mocap, 2);
        assert_int_equal(collect.mocap.n_markers, 7);
        assert_int_equal(collect_count(&collect, "version"), 1);
        assert_non_null(strstr(collect_text(&collect, "version"), cases[i].words));
        assert_int_equal(collect.remarks[1].level, cases[i].level);
        free(driver);
    }
    memset(&collect, 0, sizeof collect);
    driver = collect_open(&wb_natnet_client, &rig);
    receive(driver, 0, server_info(2, 2, false));
    assert_int_equal(collect_count(&collect, "version"), 1);
    free(driver);
}

/* The query sent by the client in a tick; "": none. */
static const char *asked_in(void *driver, int64_t t_ns)
{
    static char text[64];
    struct wb_outbox outbox = {0};
    text[0] = '\0';
    wb_natnet_client.tick(driver, t_ns, &outbox);
    for (size_t k = 0; k < outbox.n_entries; k++) {
        size_t n;
        const uint8_t *const entry = collect_entry(&outbox, k, &n);
        if (entry[0] == WB_NATNET_REQUEST)
            snprintf(text, sizeof text, "%s", (const char *)entry + 4);
    }
    return text;
}

static void newer_unicast_server_receives_a_request_for_4_1(void **state)
{
    (void)state;
    static const struct {
        int minor;
        bool multicast, asked;
    } cases[] = {{1, false, false}, {2, false, true}, {4, false, true}, {4, true, false}};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(4, cases[i].minor, cases[i].multicast));
        assert_string_equal(asked_in(driver, 1 * S), "UnitsToMillimeters");
        receive(driver, 1 * S, answer_of(1000.0F));
        assert_string_equal(asked_in(driver, 2 * S), "FrameRate");
        receive(driver, 2 * S, answer_of(120.0F));
        assert_string_equal(asked_in(driver, 4 * S), cases[i].asked ? "Bitstream,4.1" : "");
        const int n_before = collect_count(&collect, "version");
        receive(driver, 5 * S,
                wb_natnet_encode_integer(buffer, sizeof buffer, WB_NATNET_RESPONSE, 0));
        assert_int_equal(collect_count(&collect, "version"), n_before + cases[i].asked);
        assert_string_equal(asked_in(driver, 8 * S), "");
        free(driver);
    }
    /* A refusal is reported. */
    void *const driver = collect_open(&wb_natnet_client, &rig);
    memset(&collect, 0, sizeof collect);
    receive(driver, 0, server_info(4, 4, false));
    receive(driver, 1, answer_of(1000.0F));
    receive(driver, 2, answer_of(120.0F));
    receive(driver, 3,
            wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_UNRECOGNIZED_REQUEST));
    assert_int_equal(collect_count(&collect, "version"), 2);
    assert_int_equal(collect.remarks[collect.n_remarks - 1].level, WB_LOG_WARNING);
    free(driver);
}

/* Replies with units and frame rate, so that only the query of the take remains. */
static void answer_first_queries(void *driver, int64_t t_ns)
{
    asked_in(driver, t_ns);
    receive(driver, t_ns, answer_of(1000.0F));
    asked_in(driver, t_ns);
    receive(driver, t_ns, answer_of(120.0F));
}

static size_t yes(void)
{
    return wb_natnet_encode_integer(buffer, sizeof buffer, WB_NATNET_RESPONSE, 0);
}

/* Text of the first shutdown message; "": not a request. */
static const char *goodbye(void *driver)
{
    static char text[64];
    struct wb_outbox outbox = {0};
    size_t n;
    wb_natnet_client.stop(driver, &outbox);
    const uint8_t *const first = collect_entry(&outbox, 0, &n);
    text[0] = '\0';
    if (first[0] == WB_NATNET_REQUEST && n <= sizeof text)
        memcpy(text, first + 4, n - 4);
    return text;
}

static void take_is_recorded_only_on_request_of_the_rig(void **state)
{
    (void)state;
    for (int wanted = 0; wanted < 2; wanted++) {
        struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
        rig.mocap.record_take = wanted;
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(3, 0, false));
        answer_first_queries(driver, 1 * S);
        assert_string_equal(asked_in(driver, 3 * S), wanted ? "StartRecording" : "");
        receive(driver, 3 * S, yes());
        assert_string_equal(goodbye(driver), wanted ? "StopRecording" : "");
        free(driver);
    }
}

static void refused_or_missing_take_is_reported(void **state)
{
    (void)state;
    for (int refuses = 0; refuses < 2; refuses++) {
        struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
        rig.mocap.record_take = true;
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        natnet_example(&frame, 7);
        frame.mocap.params = 4;
        receive(driver, 0, server_info(3, 0, false));
        answer_first_queries(driver, 1 * S);
        asked_in(driver, 3 * S);
        receive(driver, 3 * S,
                refuses
                    ? wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_UNRECOGNIZED_REQUEST)
                    : yes());
        assert_int_equal(collect_count(&collect, "take"), refuses);
        for (int i = 0; i < 10; i++)
            receive(driver, (4 + i) * S, frame_of(3, 0));
        assert_int_equal(collect_count(&collect, "take"), 1);
        assert_string_equal(goodbye(driver), refuses ? "" : "StopRecording");
        free(driver);
    }
}

static void begin_and_end_of_a_take_are_reported(void **state)
{
    void *const driver = *state;
    static const int16_t params[] = {4, 5, 5, 5, 4, 4, 5};
    receive(driver, 0, server_info(3, 0, false));
    for (int i = 0; i < 7; i++) {
        frame.mocap.params = params[i];
        receive(driver, (1 + i) * S, frame_of(3, 0));
    }
    assert_int_equal(collect_count(&collect, "take"), 3);
}

/* A new segment, and all queries again; a datagram out of order is not a restart. */
static void restarted_server_begins_a_segment_and_queries_are_repeated(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(3, 0, false));
    answer_first_queries(driver, 1 * S);
    assert_string_equal(asked_in(driver, 3 * S), "");
    const double stamps[] = {1000.0, 1000.5, 1000.2, 999.6, 1001.0};
    for (int i = 0; i < 5; i++) {
        frame.timestamp = stamps[i];
        receive(driver, (4 + i) * S, frame_of(3, 0));
        assert_int_equal(collect.mocap.segment, 0);
    }
    assert_string_equal(asked_in(driver, 9 * S), "");
    frame.timestamp = 2.0;
    receive(driver, 10 * S, frame_of(3, 0));
    assert_int_equal(collect.mocap.segment, 1);
    assert_int_equal(collect_count(&collect, "restart"), 1);
    assert_non_null(strstr(collect_text(&collect, "restart"), "went back by 999.000 s"));
    assert_string_equal(asked_in(driver, 11 * S), "UnitsToMillimeters");
    frame.timestamp = 3.0;
    receive(driver, 12 * S, frame_of(3, 0));
    assert_int_equal(collect.mocap.segment, 1);
    assert_int_equal(collect_count(&collect, "restart"), 1);
}

/* Counted from the newest frame, so that a clock that is set back in small steps is detected. */
static void step_back_of_the_clock_counts_from_the_newest_frame(void **state)
{
    void *const driver = *state;
    static const double stamps[] = {1000.0, 999.4, 998.9};
    static const int segments[] = {0, 0, 1};
    receive(driver, 0, server_info(3, 0, false));
    for (int i = 0; i < 3; i++) {
        frame.timestamp = stamps[i];
        receive(driver, (1 + i) * S, frame_of(3, 0));
        assert_int_equal(collect.mocap.segment, segments[i]);
    }
}

static void changed_models_begin_a_segment(void **state)
{
    void *const driver = *state;
    static const int16_t params[] = {6, 4, 6, 6, 4, 12, 4};
    static const int segments[] = {0, 0, 1, 1, 1, 2, 2};
    receive(driver, 0, server_info(3, 0, false));
    for (int i = 0; i < 7; i++) {
        frame.mocap.params = params[i];
        receive(driver, (1 + i) * S, frame_of(3, 0));
        assert_int_equal(collect.mocap.segment, segments[i]);
    }
    assert_int_equal(collect_count(&collect, "models"), 2);
}

static void rejected_datagrams_are_reported_with_the_likely_cause(void **state)
{
    (void)state;
    static const struct {
        int major, minor;
        bool multicast;
        const char *cause;
    } cases[] = {{3, 0, false, "check host, port and group in mocap.address"},
                 {4, 3, false, "set the server's bitstream version to 4.1"},
                 {4, 3, true, "remove the group from mocap.address"}};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(cases[i].major, cases[i].minor, cases[i].multicast));
        natnet_example(&frame, 7);
        frame.timestamp = 2e272;
        receive(driver, 1, frame_of(cases[i].major, cases[i].minor == 3 ? 1 : cases[i].minor));
        assert_int_equal(collect.n_mocap, 0);
        assert_non_null(strstr(collect_text(&collect, "refused"), cases[i].cause));
        free(driver);
    }
    natnet_example(&frame, 7);
}

static void markers_that_are_never_measured_are_reported_once(void **state)
{
    (void)state;
    static const struct {
        int params;
        const char *said;
    } cases[] = {{WB_MARKER_OCCLUDED, "view of the wire"},
                 {WB_MARKER_MODEL_FILLED | WB_MARKER_OCCLUDED, "delete the rigid body"}};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(3, 0, false));
        natnet_example(&frame, 7);
        for (int i = 0; i < 7; i++)
            frame.mocap.markers[i].params = (int16_t)cases[k].params;
        for (int i = 0; i < 99; i++)
            receive(driver, i, frame_of(3, 0));
        frame.mocap.markers[4].params = 0; /* one marker is seen in a frame: the count restarts */
        receive(driver, 100, frame_of(3, 0));
        frame.mocap.markers[4].params = (int16_t)cases[k].params;
        for (int i = 0; i < 99; i++)
            receive(driver, 101 + i, frame_of(3, 0));
        assert_int_equal(collect_count(&collect, "markers"), 0);
        for (int i = 0; i < 300; i++)
            receive(driver, 201 + i, frame_of(3, 0));
        assert_int_equal(collect_count(&collect, "markers"), 1);
        assert_non_null(strstr(collect_text(&collect, "markers"), cases[k].said));
        free(driver);
    }
    natnet_example(&frame, 7);
}

static void group_of_the_server_is_compared_with_the_rig(void **state)
{
    (void)state;
    static const struct {
        const char *address, *expected; /* "" for no remark */
        bool multicast;
    } cases[] = {
        {"udp:10.0.0.2:1510", "add ',group=239.255.42.99:1511'", true},
        {"udp:10.0.0.2:1510", "", false},
        {"udp:10.0.0.2:1510,group=239.255.42.99:1511", "", true},
        {"udp:10.0.0.2:1510,group=239.255.42.99:1511,interface=10.0.0.1", "", true},
        {"udp:10.0.0.2:1510,group=239.255.42.99:15110", "not the one", true},
        {"udp:10.0.0.2:1510,group=224.0.0.1:1001", "not the one", true},
        {"udp:10.0.0.2:1510,group=239.255.42.99:1511", "unicast", false},
        {"udp:10.0.0.2:1510,group=255.255.255.255:1511", "", false},
        {"memory:", "", true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct wb_rig rig = rig_of(cases[i].address);
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(3, 0, cases[i].multicast));
        const char *const text = collect_text(&collect, "group");
        if (cases[i].expected[0])
            assert_non_null(strstr(text, cases[i].expected));
        else
            assert_string_equal(text, "");
        free(driver);
    }
}

static void clock_is_probed_in_a_burst_and_then_every_second(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(3, 0, false));
    int n_echoes = 0, n_keepalives = 0;
    int64_t times[64];
    for (int64_t t = 0; t < 5500; t++) {
        struct wb_outbox outbox = {0};
        wb_natnet_client.tick(driver, t * MS, &outbox);
        for (size_t i = 0; i < outbox.n_entries; i++) {
            n_keepalives += message_of(&outbox, i) == WB_NATNET_KEEPALIVE;
            if (message_of(&outbox, i) == WB_NATNET_ECHOREQUEST)
                times[n_echoes++] = t;
        }
    }
    assert_int_equal(n_echoes, 8 + 5);
    for (int i = 1; i < 8; i++)
        assert_int_equal(times[i] - times[i - 1], 64);
    for (int i = 8; i < n_echoes; i++)
        assert_int_equal(times[i] - times[i - 1], 1000);
    assert_int_equal(n_keepalives, 6);
}

static void servers_without_echo_are_not_probed(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(2, 7, false));
    for (int64_t t = 0; t < 3000; t += 20) {
        struct wb_outbox outbox = {0};
        wb_natnet_client.tick(driver, t * MS, &outbox);
        for (size_t i = 0; i < outbox.n_entries; i++)
            assert_int_not_equal(message_of(&outbox, i), WB_NATNET_ECHOREQUEST);
    }
}

static void echo_responses_become_probes_by_their_own_stamp(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(3, 0, false));
    /* 10 days of uptime and one tick */
    const uint64_t ticks = UINT64_C(10) * 86400 * 10000000 + 1;
    receive(driver, 7 * S + MS,
            wb_natnet_encode_echo_response(buffer, sizeof buffer, (uint64_t)(7 * S), ticks));
    assert_int_equal(collect.n_probes, 1);
    assert_int_equal(collect.probes[0].t_sent_ns, 7 * S);
    assert_int_equal(collect.probes[0].t_received_ns, 7 * S + MS);
    assert_close(collect.probes[0].t_device, 864000.0000001, 1e-9);
    /* Responses from the future, too late, or to another client's request are ignored. */
    static const uint64_t foreign[] = {8000000000, 1, UINT64_MAX};
    for (int i = 0; i < 3; i++)
        receive(driver, 7 * S + MS,
                wb_natnet_encode_echo_response(buffer, sizeof buffer, foreign[i], ticks));
    assert_int_equal(collect.n_probes, 1);
}

static void queries_are_sent_one_after_the_other(void **state)
{
    (void)state;
    struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    rig.mocap.frame_rate = 100.0;
    memset(&collect, 0, sizeof collect);
    natnet_example(&frame, 7);
    void *const driver = collect_open(&wb_natnet_client, &rig);
    receive(driver, 0, server_info(3, 0, false));
    static const char *const expected[] = {"UnitsToMillimeters", "UnitsToMillimeters", "FrameRate"};
    for (int i = 0; i < 3; i++) {
        struct wb_outbox outbox = {0};
        bool found = false;
        wb_natnet_client.tick(driver, (10 + i * 1500) * MS, &outbox);
        for (size_t k = 0; k < outbox.n_entries; k++) {
            size_t n;
            const uint8_t *const entry = collect_entry(&outbox, k, &n);
            if (entry[0] != WB_NATNET_REQUEST)
                continue;
            assert_string_equal((const char *)entry + 4, expected[i]);
            found = true;
        }
        assert_true(found);
        /* The first query was lost and is repeated; the second is answered. */
        if (i == 1)
            receive(driver, 1600 * MS, answer_of(1000.0F));
    }
    receive(driver, 4 * S, answer_of(120.0F));
    assert_int_equal(collect_count(&collect, "rate"), 2); /* the rate, and that it differs */
    assert_int_equal(collect_count(&collect, "units"), 0);
    free(driver);
}

static void other_units_than_metres_are_converted(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(3, 0, false));
    receive(driver, 1, answer_of(1.0F)); /* mm */
    assert_int_equal(collect_count(&collect, "units"), 1);
    receive(driver, 2, frame_of(3, 0));
    assert_close((double)collect.mocap.markers[2].position[0],
                 1e-3 * (double)frame.mocap.markers[2].position[0], 1e-9);
}

static double first_position(void *driver, int64_t t_ns)
{
    receive(driver, t_ns, frame_of(3, 0));
    return (double)collect.mocap.markers[2].position[0];
}

static void earlier_reply_is_not_mistaken_for_the_unit(void **state)
{
    void *const driver = *state;
    struct wb_outbox outbox = {0};
    const double expected = (double)frame.mocap.markers[2].position[0];
    receive(driver, 0, server_info(3, 0, false));
    wb_natnet_client.tick(driver, 1 * MS, &outbox);
    receive(driver, 2 * MS, answer_of(1000.0F));
    wb_natnet_client.tick(driver, 3 * MS, &outbox);
    /* FrameRate was queried; the server restarts before its reply. */
    receive(driver, 4 * MS, server_info(4, 1, false));
    receive(driver, 4 * MS, server_info(3, 0, false));
    receive(driver, 5 * MS, answer_of(120.0F));
    assert_close(first_position(driver, 6 * MS), expected, 0.0);
    /* The unit is queried at once, and its reply is used. */
    wb_outbox_clear(&outbox);
    wb_natnet_client.tick(driver, 7 * MS, &outbox);
    bool asked = false;
    for (size_t k = 0; k < outbox.n_entries; k++) {
        size_t n;
        const uint8_t *const entry = collect_entry(&outbox, k, &n);
        asked = asked || (entry[0] == WB_NATNET_REQUEST &&
                          strcmp((const char *)entry + 4, "UnitsToMillimeters") == 0);
    }
    assert_true(asked);
    receive(driver, 8 * MS, answer_of(10.0F));
    assert_close(first_position(driver, 9 * MS), 1e-2 * expected, 1e-7);
}

static void unknown_unit_is_reported_and_metres_are_assumed(void **state)
{
    (void)state;
    static const float odd[] = {0.0F, -1.0F, 120.0F, 999.0F, NAN, INFINITY};
    const struct wb_rig rig = rig_of("udp:10.0.0.2:1510");
    natnet_example(&frame, 7);
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++) {
        memset(&collect, 0, sizeof collect);
        void *const driver = collect_open(&wb_natnet_client, &rig);
        receive(driver, 0, server_info(3, 0, false));
        for (int k = 0; k < 4; k++)
            receive(driver, 1, answer_of(odd[i]));
        assert_int_equal(collect_count(&collect, "units"), 4);
        assert_close(first_position(driver, 2), (double)frame.mocap.markers[2].position[0], 0.0);
        /* Next, the frame rate is queried. */
        receive(driver, 3, answer_of(120.0F));
        assert_int_equal(collect_count(&collect, "rate"), 1);
        free(driver);
    }
}

static void server_without_queries_is_accepted(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(2, 7, false));
    for (int i = 1; i <= 3; i++)
        receive(driver, i,
                wb_natnet_encode_empty(buffer, sizeof buffer, WB_NATNET_UNRECOGNIZED_REQUEST));
    receive(driver, 4, frame_of(2, 7));
    assert_int_equal(collect.n_mocap, 1);
    assert_memory_equal(collect.mocap.markers[6].position, frame.mocap.markers[6].position, 12);
    assert_int_equal(collect_count(&collect, "query"), 2);
}

static void damaged_datagrams_cause_remarks(void **state)
{
    void *const driver = *state;
    receive(driver, 0, server_info(3, 0, false));
    for (int i = 0; i < 200; i++)
        receive(driver, 1, frame_of(3, 0) - 1);
    receive(driver, 1, 1);
    assert_int_equal(collect.n_mocap, 0);
    assert_int_equal(collect_count(&collect, "refused"), 8); /* 1 2 3 10 20 30 100 200 */
    receive(driver, 2, frame_of(3, 0));
    assert_int_equal(collect.n_mocap, 1);
}

static void markers_without_position_count_as_occluded(void **state)
{
    void *const driver = *state;
    frame.mocap.markers[2].position[1] = NAN;
    receive(driver, 0, server_info(3, 0, false));
    receive(driver, 1, frame_of(3, 0));
    for (int i = 0; i < 7; i++)
        assert_int_equal(collect.mocap.markers[i].params & WB_MARKER_OCCLUDED, i == 2);
}

static void missing_labelled_markers_are_reported_once(void **state)
{
    void *const driver = *state;
    natnet_example(&frame, 0);
    receive(driver, 0, server_info(3, 0, false));
    receive(driver, 1, frame_of(3, 0));
    receive(driver, 2, frame_of(3, 0));
    assert_int_equal(collect.n_mocap, 2);
    assert_int_equal(collect.mocap.n_markers, 0); /* the legacy list is not used instead */
    assert_int_equal(collect_count(&collect, "markers"), 1);
}

static void silent_server_is_reconnected(void **state)
{
    void *const driver = *state;
    struct wb_outbox outbox = {0};
    wb_natnet_client.start(driver, 0, &outbox);
    receive(driver, 10 * MS, server_info(3, 0, false));
    int n_connects = 0;
    for (int64_t t = 20; t < 4500; t += 20) {
        wb_outbox_clear(&outbox);
        wb_natnet_client.tick(driver, t * MS, &outbox);
        for (size_t i = 0; i < outbox.n_entries; i++)
            n_connects += message_of(&outbox, i) == WB_NATNET_CONNECT;
    }
    assert_true(n_connects >= 2);
    /* The same server again changes nothing; another version does. */
    receive(driver, 4500 * MS, server_info(3, 0, false));
    assert_int_equal(collect_count(&collect, "server"), 0);
    receive(driver, 4501 * MS, server_info(4, 1, false));
    assert_int_equal(collect_count(&collect, "server"), 1);
    receive(driver, 4502 * MS, frame_of(4, 1));
    assert_int_equal(collect.n_mocap, 1);
    wb_outbox_clear(&outbox);
    wb_natnet_client.stop(driver, &outbox);
    assert_int_equal(message_of(&outbox, 0), WB_NATNET_DISCONNECT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRIVER_TEST(connects_until_the_server_answers),
        DRIVER_TEST(frames_become_samples_with_their_stamps),
        cmocka_unit_test(every_version_from_2_5_to_4_1_is_decoded_by_its_announcement),
        cmocka_unit_test(unknown_versions_cause_a_warning),
        cmocka_unit_test(newer_unicast_server_receives_a_request_for_4_1),
        cmocka_unit_test(rejected_datagrams_are_reported_with_the_likely_cause),
        cmocka_unit_test(markers_that_are_never_measured_are_reported_once),
        cmocka_unit_test(group_of_the_server_is_compared_with_the_rig),
        DRIVER_TEST(clock_is_probed_in_a_burst_and_then_every_second),
        DRIVER_TEST(servers_without_echo_are_not_probed),
        DRIVER_TEST(echo_responses_become_probes_by_their_own_stamp),
        cmocka_unit_test(queries_are_sent_one_after_the_other),
        DRIVER_TEST(other_units_than_metres_are_converted),
        DRIVER_TEST(earlier_reply_is_not_mistaken_for_the_unit),
        cmocka_unit_test(unknown_unit_is_reported_and_metres_are_assumed),
        DRIVER_TEST(server_without_queries_is_accepted),
        DRIVER_TEST(damaged_datagrams_cause_remarks),
        DRIVER_TEST(markers_without_position_count_as_occluded),
        DRIVER_TEST(missing_labelled_markers_are_reported_once),
        DRIVER_TEST(silent_server_is_reconnected),
        DRIVER_TEST(begin_and_end_of_a_take_are_reported),
        DRIVER_TEST(restarted_server_begins_a_segment_and_queries_are_repeated),
        DRIVER_TEST(step_back_of_the_clock_counts_from_the_newest_frame),
        DRIVER_TEST(changed_models_begin_a_segment),
        cmocka_unit_test(take_is_recorded_only_on_request_of_the_rig),
        cmocka_unit_test(refused_or_missing_take_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
