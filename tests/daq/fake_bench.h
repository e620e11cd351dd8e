/* A small bench in a thread of its own, for the tests of acquisition: a load cell and a GRBL stage
 * on pseudo-terminals and a NatNet 3.0 server on loopback UDP, with faults that can be switched on.
 * It is crude on purpose (a spring instead of a wire) and keeps the times of what it saw. */
#ifndef WB_TESTS_DAQ_FAKE_BENCH_H
#define WB_TESTS_DAQ_FAKE_BENCH_H

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "daq/protocol/grbl.h"
#include "daq/protocol/natnet.h"
#include "daq/protocol/natnet_encode.h"
#include "tests/check.h"
#include "tests/daq/grbl_jog.h"

#ifndef FAKE_LOAD_PERIOD_NS
#define FAKE_LOAD_PERIOD_NS (5 * WB_NS_PER_MS)
#define FAKE_FRAME_PERIOD_NS (8 * WB_NS_PER_MS)
#endif
#define FAKE_MARKERS 7

struct fake_bench {
    pthread_t thread;
    int load, stage, udp;      /* our ends */
    int load_keep, stage_keep; /* the other ends, kept open so that nobody opening is no hang-up */
    char load_path[64], stage_path[64];
    int port;

    /* Faults and forces, set by the test. */
    atomic_bool quit, load_silent, mocap_silent, stage_silent;
    atomic_bool mocap_dead;       /* answers nothing at all */
    atomic_bool stage_deaf;       /* ignores the hold byte */
    atomic_bool stage_wild;       /* ignores the soft reset too, and answers nothing then */
    atomic_bool stage_refuses;    /* answers jogs with error:15 */
    atomic_bool stage_forgets_ok; /* obeys the next jog, but its answer is lost */
    atomic_bool starts_anew;      /* resets itself into alarm at the next byte */
    atomic_bool is_slow;          /* moves at half the speed it is told */
    atomic_bool stage_overshoots; /* moves beyond the target */
    atomic_bool has_top;          /* answers jogs that end above 0 with error:15 */
    atomic_bool has_soft_limits;  /* $20, */
    atomic_int soft_travel_mm;    /* and $130: told only, not enforced */
    atomic_bool hides_settings;   /* answers $$ with error:1 */
    atomic_int fastest_mm_min;    /* $110 */
    atomic_int reports_of_100;    /* how many questions for the state are answered; 0: all */
    atomic_int
        readings_at_once; /* the load cell's arrive so many in one piece; 0: each by itself */
    atomic_bool overload, other_unit, garbage, raw_counts;
    atomic_uint load_speed; /* a speed_t at which the load cell prints text; 0: at any */
    atomic_bool raise_alarm;
    atomic_bool
        load_unplugged;      /* the load cell's cable comes out amid a line; in again when false */
    atomic_int markers;      /* how many are there */
    atomic_int force_mg;     /* added to the reading */
    atomic_int swing_mg;     /* added and taken off from one reading to the next */
    atomic_int spring_mg_mm; /* per mm of travel beyond slack_mm */
    atomic_int slack_mm;
    atomic_int breaks_mm;      /* no force from this travel on; 0: never */
    atomic_int markers_follow; /* percent of the stage's way, downwards, */
    atomic_bool markers_level; /* or sideways */
    atomic_int force_limit_mg; /* the first reading beyond it is timed */

    /* What it saw, ns of the monotonic clock; 0 not yet. Of what it sends, from before it goes:
     * this thread may stand still as soon as it is gone, and nobody can have read it earlier. */
    atomic_llong limit_sent_ns, hold_ns, reset_ns, load_last_ns, frame_last_ns, report_last_ns;
    atomic_int holds;
    atomic_int takes;          /* times it was asked to record a take of its own */
    atomic_llong worst_gap_ns; /* longest that this thread itself was kept from running */

    /* The thread's own. */
    char load_link[96]; /* ""; or where a link leads to the load cell's terminal of the day */
    double position_mm, target_mm, feed_mm_s;
    const char *state; /* of the stage */
    int64_t moved_ns, next_load_ns, next_frame_ns;
    uint32_t noise;
    int32_t frame;
    char line[256];
    size_t n_line;
    char readings[4096]; /* that wait to be written together */
    size_t n_readings;
    int readings_held, questions;
    int swing_side; /* of the next reading: +1, -1 */
    struct sockaddr_in client;
    bool has_client;
    struct wb_natnet_frame data;
};

static inline void fake_write(int descriptor, const void *bytes, size_t n)
{
    ssize_t written = write(descriptor, bytes, n);
    (void)written; /* nobody reads: the bytes are lost, as on a wire */
}

static inline void fake_say(struct fake_bench *bench, const char *text)
{
    if (!bench->stage_silent)
        fake_write(bench->stage, text, strlen(text));
}

static inline double fake_noise(struct fake_bench *bench)
{
    bench->noise = bench->noise * 1664525u + 1013904223u;
    return (double)(bench->noise >> 8) / (1 << 24) - 0.5;
}

/* --- stage --- */

static inline bool fake_moves(const struct fake_bench *bench)
{
    return strcmp(bench->state, "Jog") == 0;
}

static inline void fake_move(struct fake_bench *bench, int64_t now_ns)
{
    const double step = bench->feed_mm_s * wb_seconds_from_ns(now_ns - bench->moved_ns);
    bench->moved_ns = now_ns;
    if (!fake_moves(bench))
        return;
    const double left = bench->target_mm - bench->position_mm;
    if (fabs(left) > step || (bench->stage_overshoots && left >= 0.0)) {
        bench->position_mm += left >= 0.0 ? step : -step;
        if (bench->stage_overshoots)
            bench->target_mm = bench->position_mm + 1.0;
        return;
    }
    bench->position_mm = bench->target_mm;
    bench->state = "Idle";
}

static inline void fake_report(struct fake_bench *bench)
{
    char text[128];
    struct wb_grbl_report report = {.has_machine = true, .machine_mm = {bench->position_mm}};
    snprintf(report.name, sizeof report.name, "%s", bench->state);
    const size_t n = wb_grbl_format_report(text, sizeof text, &report);
    if (bench->stage_silent || (bench->stage_wild && bench->reset_ns != 0))
        return;
    const int share = bench->reports_of_100;
    if (share > 0 && ++bench->questions * share % 100 >= share)
        return;
    bench->report_last_ns = wb_time_now_ns();
    fake_write(bench->stage, text, n);
}

static inline void fake_obey_line(struct fake_bench *bench, const char *line)
{
    struct grbl_jog jog;
    if (grbl_jog_parse(line, &jog)) {
        /* Jogs in a row are one way, as GRBL's planner joins them. */
        const double from = fake_moves(bench) ? bench->target_mm : bench->position_mm;
        const double target = jog.relative ? from + jog.target_mm : jog.target_mm;
        if (bench->stage_refuses || (bench->has_top && target < 0.0)) {
            fake_say(bench, "error:15\r\n");
        } else if (strcmp(bench->state, "Idle") != 0 && !fake_moves(bench)) {
            fake_say(bench, "error:9\r\n");
        } else {
            bench->target_mm = target;
            bench->feed_mm_s = jog.feed_mm_min / 60.0 * (bench->is_slow ? 0.5 : 1.0);
            bench->state = "Jog";
            if (!atomic_exchange(&bench->stage_forgets_ok, false))
                fake_say(bench, "ok\r\n");
        }
    } else if (strcmp(line, "$X") == 0 || strcmp(line, "$H") == 0) {
        bench->state = "Idle";
        if (line[1] == 'H')
            bench->position_mm = 0.0;
        fake_say(bench, "ok\r\n");
    } else if (strcmp(line, "$$") == 0 && !bench->hides_settings) {
        char text[160];
        snprintf(text, sizeof text,
                 "$1=255\r\n$13=0\r\n$20=%d\r\n$100=800.000\r\n$110=%d.000\r\n"
                 "$120=100000.000\r\n$130=%d.000\r\nok\r\n",
                 bench->has_soft_limits, bench->fastest_mm_min, bench->soft_travel_mm);
        fake_say(bench, text);
    } else {
        fake_say(bench, "error:1\r\n");
    }
}

static inline void fake_hold(struct fake_bench *bench)
{
    if (bench->holds++ == 0)
        bench->hold_ns = wb_time_now_ns();
    if (bench->stage_deaf) {
        /* Where short jogs came late it stood for a moment: it shall run on all the same. */
        if (bench->stage_overshoots && strcmp(bench->state, "Idle") == 0) {
            bench->target_mm = bench->position_mm + 1.0;
            bench->state = "Jog";
        }
        return;
    }
    if (fake_moves(bench) || strcmp(bench->state, "Idle") == 0)
        bench->state = "Hold:0";
}

static inline void fake_reset(struct fake_bench *bench)
{
    bench->reset_ns = wb_time_now_ns();
    if (bench->stage_wild)
        return;
    const bool moved = fake_moves(bench);
    if (moved)
        fake_say(bench, "ALARM:3\r\n");
    fake_say(bench, "\r\nGrbl 1.1h ['$' for help]\r\n");
    if (strcmp(bench->state, "Alarm") != 0)
        bench->state = moved ? "Alarm" : "Idle";
    bench->n_line = 0;
}

static inline void fake_stage_bytes(struct fake_bench *bench, const char *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const unsigned char byte = (unsigned char)bytes[i];
        if (atomic_exchange(&bench->starts_anew, false)) {
            bench->state = "Alarm";
            fake_say(bench, "\r\nGrbl 1.1h ['$' for help]\r\n[MSG:'$H'|'$X' to unlock]\r\n");
        }
        if (byte == '?') {
            fake_report(bench);
        } else if (byte == '!') {
            fake_hold(bench);
        } else if (byte == 0x18) {
            fake_reset(bench);
        } else if (byte == 0x85) {
            if (fake_moves(bench))
                bench->state = "Idle";
        } else if (byte == '\n') {
            bench->line[bench->n_line] = '\0';
            fake_obey_line(bench, bench->line);
            bench->n_line = 0;
        } else if (bench->n_line + 1 < sizeof bench->line) {
            bench->line[bench->n_line++] = (char)byte;
        }
    }
}

/* --- load cell and cameras --- */

static inline void fake_reading(struct fake_bench *bench)
{
    char text[64];
    const bool broken = bench->breaks_mm > 0 && bench->position_mm > bench->breaks_mm;
    const double stretch = broken ? 0.0 : fmax(bench->position_mm - bench->slack_mm, 0.0);
    bench->swing_side = bench->swing_side > 0 ? -1 : 1;
    const double mg = bench->force_mg + bench->spring_mg_mm * stretch +
                      bench->swing_side * bench->swing_mg + 20.0 * fake_noise(bench);
    struct termios line;
    if (bench->load_speed != 0 && tcgetattr(bench->load, &line) == 0 &&
        cfgetospeed(&line) != bench->load_speed)
        snprintf(text, sizeof text, "\x81\xfe\x90\xe3\xbf\x88");
    else if (bench->garbage)
        snprintf(text, sizeof text, "####\r\n");
    else if (bench->overload)
        snprintf(text, sizeof text, "OL\r\n");
    else if (bench->raw_counts)
        snprintf(text, sizeof text, "%.0f\r\n", 84213.0 + 0.4 * mg);
    else
        snprintf(text, sizeof text, "%.3f %s\r\n", mg / 1e3, bench->other_unit ? "kg" : "g");
    if (bench->limit_sent_ns == 0 &&
        ((bench->force_limit_mg > 0 && fabs(mg) > bench->force_limit_mg) || bench->overload ||
         bench->other_unit))
        bench->limit_sent_ns = wb_time_now_ns();
    memcpy(bench->readings + bench->n_readings, text, strlen(text));
    bench->n_readings += strlen(text);
    if (++bench->readings_held < bench->readings_at_once)
        return;
    bench->load_last_ns = wb_time_now_ns();
    fake_write(bench->load, bench->readings, bench->n_readings);
    bench->n_readings = 0;
    bench->readings_held = 0;
}

static inline void fake_send(struct fake_bench *bench, const uint8_t *bytes, size_t n)
{
    if (bench->has_client && n > 0)
        (void)!sendto(bench->udp, bytes, n, 0, (struct sockaddr *)&bench->client,
                      sizeof bench->client);
}

static inline uint64_t fake_ticks(void)
{
    return (uint64_t)(wb_time_now_ns() / 100 + 36000000000LL);
}

static inline void fake_frame(struct fake_bench *bench)
{
    static uint8_t buffer[4096];
    struct wb_mocap_frame *const mocap = &bench->data.mocap;
    bench->frame++;
    mocap->frame_number = bench->frame;
    bench->data.timestamp = bench->frame / 125.0;
    mocap->camera_data_received = fake_ticks();
    mocap->transmit = mocap->camera_data_received + 5000;
    mocap->n_markers = bench->markers;
    bench->data.n_labelled = mocap->n_markers;
    for (int m = 0; m < mocap->n_markers; m++) {
        struct wb_marker *const marker = &mocap->markers[m];
        marker->id = 50000 + m;
        /* The eighth and later ones are strays. */
        marker->position[0] = (float)(m < FAKE_MARKERS ? 0.3 + 0.015 * m : 0.9 + 0.1 * m);
        /* The strand holds the tip. */
        const double part = fmax(0.0, 1.0 - m / (FAKE_MARKERS - 1.0));
        const double moved = 1e-5 * bench->markers_follow * bench->position_mm * part;
        const bool level = bench->markers_level;
        marker->position[1] = (float)(1.2 - (level ? 0.0 : moved) + 1e-4 * fake_noise(bench));
        marker->position[2] = (float)(0.05 - (level ? moved : 0.0));
        marker->size = 0.003F;
        marker->params = WB_MARKER_POINT_CLOUD_SOLVED | WB_MARKER_UNLABELED;
    }
    bench->frame_last_ns = wb_time_now_ns();
    fake_send(bench, buffer,
              wb_natnet_encode_frame(buffer, sizeof buffer, (struct wb_natnet_version){3, 0},
                                     &bench->data));
}

static inline void fake_datagram(struct fake_bench *bench)
{
    uint8_t bytes[2048], answer[2048];
    socklen_t size = sizeof bench->client;
    const ssize_t n =
        recvfrom(bench->udp, bytes, sizeof bytes, 0, (struct sockaddr *)&bench->client, &size);
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    if (n <= 0 || bench->mocap_dead ||
        wb_natnet_decode_packet(bytes, (size_t)n, &packet, &fault) != WB_OK)
        return;
    if (packet.message == WB_NATNET_CONNECT) {
        const struct wb_natnet_server server = {.name = "fake",
                                                .app_version = {2, 0, 0, 0},
                                                .natnet_version = {3, 0, 0, 0},
                                                .has_connection = true,
                                                .clock_frequency = 10000000,
                                                .data_port = (uint16_t)bench->port};
        bench->has_client = true;
        fake_send(bench, answer, wb_natnet_encode_server(answer, sizeof answer, &server));
    } else if (packet.message == WB_NATNET_REQUEST) {
        char text[64];
        if (wb_natnet_decode_text(&packet, text, sizeof text, &fault) != WB_OK)
            return;
        bench->takes += strcmp(text, "StartRecording") == 0;
        const float value = strcmp(text, "FrameRate") == 0 ? 125.0F : 1000.0F;
        fake_send(bench, answer, wb_natnet_encode_response_real(answer, sizeof answer, value));
    } else if (packet.message == WB_NATNET_ECHOREQUEST) {
        uint64_t stamp, ticks;
        if (wb_natnet_decode_echo(&packet, &stamp, &ticks, &fault) == WB_OK)
            fake_send(bench, answer,
                      wb_natnet_encode_echo_response(answer, sizeof answer, stamp, fake_ticks()));
    }
}

/* --- the thread --- */

static inline void fake_open_terminal(int *ours, int *theirs, char path[64]);

/* Under another number each time, because the old terminal is still open at its other side. */
static inline void fake_replug(struct fake_bench *bench)
{
    if (bench->load_unplugged && bench->load >= 0) {
        fake_write(bench->load, "1", 1);
        close(bench->load);
        close(bench->load_keep);
        bench->load = bench->load_keep = -1;
        unlink(bench->load_link);
    } else if (!bench->load_unplugged && bench->load < 0) {
        fake_open_terminal(&bench->load, &bench->load_keep, bench->load_path);
        fake_write(bench->load, "0 g\r\n", 5); /* the end of a line */
        assert_int_equal(symlink(bench->load_path, bench->load_link), 0);
    }
}

static inline void *fake_run(void *context)
{
    struct fake_bench *const bench = context;
    int64_t before_ns = wb_time_now_ns();
    while (!bench->quit) {
        struct pollfd polled[2] = {{.fd = bench->stage, .events = POLLIN},
                                   {.fd = bench->udp, .events = POLLIN}};
        const struct timespec wait = {
            .tv_nsec = FAKE_FRAME_PERIOD_NS < 4 * WB_NS_PER_MS ? 100000 : WB_NS_PER_MS};
        ppoll(polled, 2, &wait, NULL);
        const int64_t now_ns = wb_time_now_ns();
        if (now_ns - before_ns > bench->worst_gap_ns)
            bench->worst_gap_ns = now_ns - before_ns;
        before_ns = now_ns;
        fake_move(bench, now_ns);
        fake_replug(bench);
        char bytes[512];
        ssize_t n;
        while ((n = read(bench->stage, bytes, sizeof bytes)) > 0)
            fake_stage_bytes(bench, bytes, (size_t)n);
        /* Polls of a load cell are read and forgotten. */
        while (read(bench->load, bytes, sizeof bytes) > 0) {
        }
        if (polled[1].revents & POLLIN)
            fake_datagram(bench);
        if (bench->raise_alarm && strcmp(bench->state, "Alarm") != 0) {
            bench->state = "Alarm";
            bench->limit_sent_ns = wb_time_now_ns();
            fake_say(bench, "ALARM:1\r\n");
        }
        if (now_ns >= bench->next_load_ns) {
            bench->next_load_ns += FAKE_LOAD_PERIOD_NS;
            if (!bench->load_silent && bench->load >= 0)
                fake_reading(bench);
        }
        if (now_ns >= bench->next_frame_ns) {
            bench->next_frame_ns += FAKE_FRAME_PERIOD_NS;
            if (!bench->mocap_silent && !bench->mocap_dead)
                fake_frame(bench);
        }
    }
    return NULL;
}

static inline void fake_open_terminal(int *ours, int *theirs, char path[64])
{
    *ours = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    assert_true(*ours >= 0);
    assert_int_equal(grantpt(*ours), 0);
    assert_int_equal(unlockpt(*ours), 0);
    assert_int_equal(ptsname_r(*ours, path, 64), 0);
    *theirs = open(path, O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(*theirs >= 0);
    struct termios raw;
    tcgetattr(*theirs, &raw);
    cfmakeraw(&raw);
    tcsetattr(*theirs, TCSANOW, &raw);
}

static inline struct fake_bench *fake_start(void)
{
    struct fake_bench *const bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    fake_open_terminal(&bench->load, &bench->load_keep, bench->load_path);
    fake_open_terminal(&bench->stage, &bench->stage_keep, bench->stage_path);
    bench->udp = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
    socklen_t size = sizeof address;
    assert_int_equal(bind(bench->udp, (struct sockaddr *)&address, size), 0);
    assert_int_equal(getsockname(bench->udp, (struct sockaddr *)&address, &size), 0);
    bench->port = ntohs(address.sin_port);
    bench->state = "Idle";
    bench->markers = FAKE_MARKERS;
    bench->markers_follow = 100;
    bench->fastest_mm_min = 6000;
    bench->soft_travel_mm = 200;
    bench->force_mg = 150;
    bench->spring_mg_mm = 500;
    bench->noise = 12345;
    const int64_t now_ns = wb_time_now_ns();
    bench->moved_ns = bench->next_load_ns = bench->next_frame_ns = now_ns;
    assert_int_equal(pthread_create(&bench->thread, NULL, fake_run, bench), 0);
    return bench;
}

/* --- measuring latencies on a machine that others use too --- */

#define FAKE_ATTEMPTS 3
/* What is excused by a machine that keeps even this thread from running ends here. */
#define FAKE_PATIENCE_MAX_NS (100 * WB_NS_PER_MS)

/* The measurements of one test; all zero to begin with. */
struct fake_latency {
    int attempts, stalled_attempts;
    bool is_late, stalled; /* in this attempt: later than is excused; the machine stood still */
};

/* How late may be: 20 ms, and more, to a bound, when this thread was kept from running as well, for
 * which no program of ours is to blame. */
static inline int64_t fake_patience_ns(const struct fake_bench *bench)
{
    const int64_t stalled_ns = bench->worst_gap_ns - 5 * WB_NS_PER_MS;
    const int64_t patience_ns = WB_STOP_HOLD_NS + (stalled_ns > 0 ? 3 * stalled_ns : 0);
    return patience_ns < FAKE_PATIENCE_MAX_NS ? patience_ns : FAKE_PATIENCE_MAX_NS;
}

/* Something was seen `latency_ns` after it was due, which should be within 20 ms. */
static inline void fake_note_latency(struct fake_latency *latency, const struct fake_bench *bench,
                                     const char *what, int64_t latency_ns)
{
    const int64_t patience_ns = fake_patience_ns(bench);
    print_message("           %s %.2f ms late (machine stood still for %.1f ms)\n", what,
                  (double)latency_ns / 1e6, (double)bench->worst_gap_ns / 1e6);
    assert_true(latency_ns >= 0);
    latency->is_late = latency->is_late || latency_ns > patience_ns;
    latency->stalled = latency->stalled || patience_ns == FAKE_PATIENCE_MAX_NS;
}

/* Ends an attempt: true when all of it was in time. False: measure again. After the third a test
 * fails, or is skipped when the machine stood still for too long each time. */
static inline bool fake_in_time(struct fake_latency *latency)
{
    if (!latency->is_late)
        return true;
    latency->attempts++;
    latency->stalled_attempts += latency->stalled;
    latency->is_late = latency->stalled = false;
    if (latency->attempts < FAKE_ATTEMPTS)
        return false;
    if (latency->stalled_attempts == latency->attempts) {
        print_message("           SKIPPED: this machine stands still for too long to measure 20 "
                      "ms\n");
        skip();
    }
    fail_msg("late in each of %d attempts", latency->attempts);
    return false;
}

/* Ends the thread and closes everything: what an unplugged cable looks like. */
static inline void fake_unplug(struct fake_bench *bench)
{
    if (bench->quit)
        return;
    bench->quit = true;
    pthread_join(bench->thread, NULL);
    close(bench->load);
    close(bench->stage);
    close(bench->load_keep);
    close(bench->stage_keep);
    close(bench->udp);
}

static inline void fake_stop(struct fake_bench *bench)
{
    fake_unplug(bench);
    free(bench);
}

/* Writes the rig file of this bench; `time_scale` above 1 makes it a virtual rig. */
static inline void fake_write_rig(const struct fake_bench *bench, const char *path,
                                  double time_scale, double stream_lost)
{
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "name: bench of a test\n"
            "load_cell:\n"
            "  address: pty:%s\n"
            "  protocol: generic\n"
            "  capacity_g: 20\n"
            "  overload_percent: 150\n"
            "  serial_number: T-1\n"
            "  calibration_date: 2026-01-15\n"
            "  overload_tokens: [OL]\n"
            "  filter_delay_ms: 50\n"
            "  filter_delay_uncertainty_ms: 5\n"
            "  noise_mg: 10\n"
            "  check_mass_g: 10\n"
            "mocap:\n"
            "  address: udp:127.0.0.1:%d\n"
            "  protocol: natnet\n"
            "  up: y\n"
            "stage:\n"
            "  address: pty:%s\n"
            "  protocol: grbl\n"
            "  axis: X\n"
            "  down: +1\n"
            "  travel_mm: 60\n"
            "  speed_mm_s: 1\n"
            "limits:\n"
            "  force_mN: 100\n"
            "  travel_mm: 58\n"
            "  stream_lost_s: %g\n",
            bench->load_path, bench->port, bench->stage_path, stream_lost);
    if (time_scale != 1.0)
        fprintf(file, "virtual: true\ntime_scale: %g\ntruth:\n  spring_mg_mm: 500\n", time_scale);
    fclose(file);
}

static inline void fake_write_specimen(const char *path)
{
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "wire: type1\nlength_mm: 90\nsample: 1\n"
                  "markers_mm: [0, 15, 30, 45, 60, 75, 90]\nmarker_offset_mm: 1\n");
    fclose(file);
}

#endif
