/* A short recording with bytes as instruments send them and known samples: 80 readings of a load
 * cell with lines torn over chunks, 48 frames of NatNet 3.0, 20 reports of a GRBL stage, in 1 s. */
#ifndef WB_TESTS_DAQ_SMALL_TEST_H
#define WB_TESTS_DAQ_SMALL_TEST_H

#include "base/units.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/recording/recording.h"
#include "tests/check.h"
#include "tests/daq/natnet_example.h"

#define SMALL_READINGS 80
#define SMALL_FRAMES 48
#define SMALL_MARKERS 7
#define SMALL_REPORTS 20
#define SMALL_START_NS (INT64_C(5000) * WB_NS_PER_S)

static const char small_rig[] = "name: small bench\n"
                                "load_cell:\n"
                                "  address: pty:/dev/pts/90\n"
                                "  protocol: generic\n"
                                "  capacity_g: 20\n"
                                "  overload_percent: 150\n"
                                "  unit: g\n"
                                "  filter_delay_ms: 50\n"
                                "  filter_delay_uncertainty_ms: 5\n"
                                "mocap:\n"
                                "  address: udp:127.0.0.1:1510\n"
                                "  protocol: natnet\n"
                                "  up: y\n"
                                "stage:\n"
                                "  address: pty:/dev/pts/91\n"
                                "  protocol: grbl\n"
                                "  axis: X\n"
                                "  down: 1\n"
                                "  travel_mm: 60\n"
                                "  speed_mm_s: 1\n"
                                "strand:\n"
                                "  length_mm: 760\n"
                                "  counterweight_g: 2.7\n"
                                "virtual: true\n";

static const char small_specimen[] = "wire: type1\n"
                                     "length_mm: 85\n"
                                     "sample: 1\n"
                                     "markers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]\n"
                                     "marker_offset_mm: 1.0\n";

/* Reading `i` in g, exact in its text. */
static inline double small_reading_g(int i)
{
    return 0.25 * i - 3.0;
}

/* The load cell's 80 lines, after the tail of a line that began before, as chunks of 17 bytes at 80
 * lines a second: none is a line. */
static inline void small_load(struct wb_recording *recording)
{
    static char lines[SMALL_READINGS * 16];
    size_t n = (size_t)snprintf(lines, sizeof lines, "9.999 g\r\n");
    for (int i = 0; i < SMALL_READINGS; i++)
        n += (size_t)snprintf(lines + n, sizeof lines - n, "%+08.3f g\r\n", small_reading_g(i));
    int64_t seq = 0;
    for (size_t at = 0; at < n; at += 17) {
        size_t part = n - at < 17 ? n - at : 17;
        int64_t t_ns = SMALL_START_NS + WB_NS_PER_S / 80 * (int64_t)(at + part) / 12;
        assert_int_equal(wb_recording_append_chunk(recording, 0, seq++, t_ns, lines + at, part),
                         WB_OK);
    }
}

static inline void small_mocap(struct wb_recording *recording)
{
    static uint8_t bytes[8192];
    static struct wb_natnet_frame frame;
    const struct wb_natnet_version version = {3, 0};
    struct wb_natnet_server server = {.name = "Motive",
                                      .app_version = {2, 1, 0, 0},
                                      .natnet_version = {3, 0, 0, 0},
                                      .has_connection = true,
                                      .clock_frequency = 10000000,
                                      .data_port = 1511};
    int64_t seq = 0;
    size_t n = wb_natnet_encode_server(bytes, sizeof bytes, &server);
    assert_int_equal(wb_recording_append_chunk(recording, 1, seq++, SMALL_START_NS, bytes, n),
                     WB_OK);
    for (int i = 0; i < SMALL_FRAMES; i++) {
        natnet_example(&frame, SMALL_MARKERS);
        frame.mocap.frame_number = 1000 + i;
        frame.timestamp = 50.0 + i / 48.0;
        n = wb_natnet_encode_frame(bytes, sizeof bytes, version, &frame);
        assert_true(n > 0);
        int64_t t_ns = SMALL_START_NS + 1000 + WB_NS_PER_S / 48 * i;
        assert_int_equal(wb_recording_append_chunk(recording, 1, seq++, t_ns, bytes, n), WB_OK);
    }
}

static inline void small_stage(struct wb_recording *recording)
{
    for (int i = 0; i < SMALL_REPORTS; i++) {
        char text[80];
        int n = snprintf(text, sizeof text, "<%s|MPos:%.3f,0.000,0.000|FS:60,0>\r\n",
                         i == 0 ? "Idle" : "Jog", 0.05 * i);
        int64_t t_ns = SMALL_START_NS + 2000 + WB_NS_PER_S / 20 * i;
        assert_int_equal(wb_recording_append_chunk(recording, 2, i, t_ns, text, (size_t)n), WB_OK);
    }
}

/* Writes the recording; without `rig` it lacks rig and specimen. */
static inline void small_make(const char *path, bool rig)
{
    struct wb_recording *recording = NULL;
    int id;
    assert_int_equal(wb_recording_create(&recording, path), WB_OK);
    assert_int_equal(
        wb_recording_add_stream(recording, WB_ROLE_LOAD, "pty:/dev/pts/90", "generic", "", &id),
        WB_OK);
    assert_int_equal(
        wb_recording_add_stream(recording, WB_ROLE_MOCAP, "udp:127.0.0.1:1510", "natnet", "", &id),
        WB_OK);
    assert_int_equal(
        wb_recording_add_stream(recording, WB_ROLE_STAGE, "pty:/dev/pts/91", "grbl", "", &id),
        WB_OK);
    if (rig) {
        assert_int_equal(wb_recording_set_meta(recording, "rig", small_rig), WB_OK);
        assert_int_equal(wb_recording_set_meta(recording, "specimen", small_specimen), WB_OK);
        assert_int_equal(wb_recording_set_meta(recording, "virtual", "true"), WB_OK);
        assert_int_equal(wb_recording_set_meta(recording, "operator", "A. Tester"), WB_OK);
        assert_int_equal(wb_recording_set_meta(recording, "start_utc", "2026-01-15T10:00:00Z"),
                         WB_OK);
    }
    small_load(recording);
    small_mocap(recording);
    small_stage(recording);
    assert_int_equal(wb_recording_append_event(recording, SMALL_START_NS, "cycle_start", "1"),
                     WB_OK);
    assert_int_equal(wb_recording_append_event(recording, SMALL_START_NS + WB_NS_PER_S, "mark",
                                               "a \"quoted\", text"),
                     WB_OK);
    assert_int_equal(wb_recording_append_clock(recording, 1, SMALL_START_NS, 141.75, 870000),
                     WB_OK);
    assert_int_equal(wb_recording_set_meta(recording, "dropped_chunks", "0"), WB_OK);
    assert_int_equal(wb_recording_close(recording), WB_OK);
}

#endif
