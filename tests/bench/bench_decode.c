/* Speed of decoding the instruments' bytes, compared with a baseline on the same bytes: for NatNet
 * copying and summing them, for load-cell lines sscanf("%lf %15s"). */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "daq/protocol/drivers.h"
#include "daq/protocol/natnet_encode.h"
#include "tests/daq/natnet_example.h"

#define FRAME_GOAL 1e5 /* frames/s: hours of recording at 120 frames/s in seconds */
#define LINE_GOAL 1e6  /* lines/s */

static volatile uint64_t sink_value; /* keeps the compiler from leaving the work out */

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --- NatNet --- */

static uint8_t packet_bytes[4096];
static size_t packet_size;
static struct wb_natnet_version packet_version;

static void decode_frame(void)
{
    static struct wb_natnet_frame frame;
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    if (wb_natnet_decode_packet(packet_bytes, packet_size, &packet, &fault) != WB_OK ||
        wb_natnet_decode_frame(&packet, packet_version, &frame, &fault) != WB_OK) {
        fprintf(stderr, "the frame is refused: %s\n", fault.reason);
        exit(1);
    }
    sink_value += (uint64_t)frame.mocap.n_markers;
}

static void copy_and_sum(void)
{
    static uint8_t copy[sizeof packet_bytes];
    uint64_t sum = 0;
    memcpy(copy, packet_bytes, packet_size);
    for (size_t i = 0; i < packet_size; i++)
        sum += copy[i];
    sink_value += sum;
}

/* --- load-cell lines --- */

static const char line[] = "ST,GS,+  12.345 g\r\n";
static const char bare_line[] = "12.345 g\r\n";
static void *cell_state;

static void count_load(void *context, const struct wb_load_sample *sample)
{
    (void)context;
    sink_value += sample->index + (uint64_t)sample->valid;
}

static void decode_line(void)
{
    const struct wb_sink sink = {.load = count_load};
    wb_loadcell_generic.receive(cell_state, 1, (const uint8_t *)line, sizeof line - 1, &sink);
}

static void decode_bare_line(void)
{
    const struct wb_sink sink = {.load = count_load};
    wb_loadcell_generic.receive(cell_state, 1, (const uint8_t *)bare_line, sizeof bare_line - 1,
                                &sink);
}

static void scan_bare_line(void)
{
    double value;
    char unit[16];
    if (sscanf(bare_line, "%lf %15s", &value, unit) == 2)
        sink_value += (uint64_t)value;
}

/* Calls a second, the best of five runs of at least 0.1 s. */
static double rate_of(void (*work)(void))
{
    double best = 0.0;
    for (int run = 0; run < 5; run++) {
        uint64_t n = 0;
        const double begin = now_s();
        double elapsed;
        do {
            for (int i = 0; i < 1000; i++)
                work();
            n += 1000;
            elapsed = now_s() - begin;
        } while (elapsed < 0.1);
        const double rate = (double)n / elapsed;
        if (rate > best)
            best = rate;
    }
    return best;
}

static void bench_frames(uint8_t major, uint8_t minor, bool full)
{
    static struct wb_natnet_frame example;
    natnet_example(&example, 7);
    if (!full) {
        /* What a bench streams: seven bare markers, in both lists. */
        example.n_sets = example.n_bodies = example.n_skeletons = example.n_assets = 0;
        example.n_force_plates = example.n_devices = 0;
        example.n_others = 7;
    }
    packet_version = (struct wb_natnet_version){major, minor};
    packet_size =
        wb_natnet_encode_frame(packet_bytes, sizeof packet_bytes, packet_version, &example);
    const double rate = rate_of(decode_frame), baseline = rate_of(copy_and_sum);
    printf("natnet %u.%u %s, 7 markers, %zu bytes: %.3g frames/s (goal %.0e), %.0f MB/s; "
           "%.2f times the rate of copying and summing the bytes (%.3g/s)\n",
           major, minor, full ? "all sections" : "bare", packet_size, rate, FRAME_GOAL,
           1e-6 * rate * (double)packet_size, rate / baseline, baseline);
}

static void bench_lines(void)
{
    struct wb_rig rig = {.gravity = 9.80665, .time_scale = 1.0};
    rig.load_cell.scale = 1.0;
    rig.load_cell.sign = 1;
    cell_state = calloc(1, wb_loadcell_generic.state_size);
    if (!cell_state || wb_loadcell_generic.init(cell_state, &rig) != WB_OK)
        exit(1);
    const double full = rate_of(decode_line), bare = rate_of(decode_bare_line);
    const double baseline = rate_of(scan_bare_line);
    printf("load cell 'ST,GS,+  12.345 g': %.3g lines/s (goal %.0e)\n", full, LINE_GOAL);
    printf("load cell '12.345 g': %.3g lines/s; %.2f times the rate of sscanf (%.3g/s)\n", bare,
           bare / baseline, baseline);
    free(cell_state);
}

int main(void)
{
    bench_frames(3, 0, false);
    bench_frames(4, 1, false);
    bench_frames(3, 0, true);
    bench_frames(4, 1, true);
    bench_lines();
    return 0;
}
