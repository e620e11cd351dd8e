/* A small bench in virtual time, for the tests of acquisition: a load cell, a GRBL stage and a
 * NatNet 3.0 server on streams in memory, with faults that can be switched on. It is crude on
 * purpose (a spring instead of a wire) and keeps the times of what it sent and received. */
#ifndef WB_TESTS_DAQ_FAKE_BENCH_H
#define WB_TESTS_DAQ_FAKE_BENCH_H

#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/timing.h"
#include "base/units.h"
#include "daq/acquire/acquisition.h"
#include "daq/protocol/grbl.h"
#include "daq/protocol/natnet.h"
#include "daq/protocol/natnet_encode.h"
#include "fixtures/virtual/sim_port.h"
#include "fixtures/virtual/virtual_time_private.h"
#include "tests/check.h"
#include "tests/daq/grbl_jog.h"

#define FAKE_LOAD_PERIOD_NS (5 * WB_NS_PER_MS)
#define FAKE_FRAME_PERIOD_NS (8 * WB_NS_PER_MS)
#define FAKE_MARKERS 7
#define FAKE_UTC INT64_C(1780272000) /* 2026-06-01, when virtual time begins */

struct fake_bench {
    struct wb_virtual_actor actor;
    struct wb_sim_port_handler handlers[3];
    struct wb_sim_port *load, *mocap, *stage;

    /* Faults and forces, set by the test. */
    bool load_silent, mocap_silent, stage_silent;
    bool mocap_dead;       /* does not reply at all */
    bool stage_deaf;       /* ignores the hold byte */
    bool stage_wild;       /* also ignores the soft reset, and does not reply afterwards */
    bool stage_refuses;    /* answers jogs with error:15 */
    bool stage_forgets_ok; /* executes the next jog, but its reply is lost */
    bool starts_anew;      /* resets itself into alarm at the next byte */
    bool is_slow;          /* moves at half the commanded speed */
    bool stage_overshoots; /* moves beyond the target */
    bool has_top;          /* answers jogs that end above 0 with error:15 */
    bool has_soft_limits;  /* $20, */
    int soft_travel_mm;    /* and $130: reported only, not enforced */
    bool hides_settings;   /* answers $$ with error:1 */
    int fastest_mm_min;    /* $110 */
    int reports_of_100;    /* status queries that are answered; 0: all */
    int readings_at_once;  /* readings of the load cell per read; 0: one */
    bool overload, other_unit, garbage, raw_counts;
    int load_baud; /* at which the load cell prints text; 0: at any */
    bool raise_alarm;
    int markers;      /* how many are there */
    int force_mg;     /* added to the reading */
    int swing_mg;     /* added and subtracted from one reading to the next */
    int spring_mg_mm; /* per mm of travel beyond slack_mm */
    int slack_mm;
    int breaks_mm;      /* no force beyond this travel; 0: never */
    int markers_follow; /* percent of the stage's travel, downwards, */
    bool markers_level; /* or sideways */
    int force_limit_mg; /* the time of the first reading beyond it is stored */

    /* Times of what it sent and received, ns of virtual time; 0: not yet. What it sends arrives
     * WB_SIM_PORT_DELAY_NS later. */
    int64_t limit_sent_ns, hold_ns, reset_ns, load_last_ns, frame_last_ns;
    int holds;
    int takes; /* number of requests to record a take */

    /* Private. */
    double position_mm, target_mm, feed_mm_s;
    const char *state; /* of the stage */
    int64_t moved_ns, next_load_ns, next_frame_ns;
    int line_baud; /* at which the host has opened the load cell */
    uint32_t noise;
    int32_t frame;
    char line[256];
    size_t n_line;
    char readings[4096]; /* waiting to be sent together */
    size_t n_readings;
    int readings_held, questions;
    int swing_side; /* of the next reading: +1, -1 */
    bool has_client;
    struct wb_natnet_frame data;
};

static inline void fake_say(struct fake_bench *bench, const char *text)
{
    if (!bench->stage_silent)
        wb_sim_port_send(bench->stage, text, strlen(text));
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
    wb_sim_port_send(bench->stage, text, n);
}

static inline void fake_obey_line(struct fake_bench *bench, const char *line)
{
    struct grbl_jog jog;
    if (grbl_jog_parse(line, &jog)) {
        /* Consecutive jogs form one motion, as in GRBL's planner. */
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
            if (!bench->stage_forgets_ok)
                fake_say(bench, "ok\r\n");
            bench->stage_forgets_ok = false;
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
        /* Between two short jogs the stage may stand; the jog is still running. */
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

static inline void fake_stage_bytes(void *context, int64_t now_ns, const void *received, size_t n)
{
    struct fake_bench *const bench = context;
    const char *const bytes = received;
    fake_move(bench, now_ns);
    for (size_t i = 0; i < n; i++) {
        const unsigned char byte = (unsigned char)bytes[i];
        if (bench->starts_anew) {
            bench->starts_anew = false;
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
    if (bench->load_baud != 0 && bench->line_baud != bench->load_baud)
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
        ((bench->force_limit_mg > 0 && fabs(round(mg)) > bench->force_limit_mg) ||
         bench->overload || bench->other_unit))
        bench->limit_sent_ns = wb_time_now_ns();
    memcpy(bench->readings + bench->n_readings, text, strlen(text));
    bench->n_readings += strlen(text);
    if (++bench->readings_held < bench->readings_at_once)
        return;
    bench->load_last_ns = wb_time_now_ns();
    wb_sim_port_send(bench->load, bench->readings, bench->n_readings);
    bench->n_readings = 0;
    bench->readings_held = 0;
}

static inline void fake_send(struct fake_bench *bench, const uint8_t *bytes, size_t n)
{
    if (bench->has_client)
        wb_sim_port_send(bench->mocap, bytes, n);
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

static inline void fake_datagram(void *context, int64_t now_ns, const void *bytes, size_t n)
{
    struct fake_bench *const bench = context;
    uint8_t answer[2048];
    struct wb_natnet_packet packet;
    struct wb_natnet_fault fault;
    (void)now_ns;
    if (bench->mocap_dead || wb_natnet_decode_packet(bytes, n, &packet, &fault) != WB_OK)
        return;
    if (packet.message == WB_NATNET_CONNECT) {
        const struct wb_natnet_server server = {.name = "fake",
                                                .app_version = {2, 0, 0, 0},
                                                .natnet_version = {3, 0, 0, 0},
                                                .has_connection = true,
                                                .clock_frequency = 10000000,
                                                .data_port = 1511};
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

static inline void fake_load_opened(void *context, int64_t now_ns, const char *line)
{
    struct fake_bench *const bench = context;
    (void)now_ns;
    bench->line_baud = line[0] ? atoi(line) : 9600;
}

/* Polls of a load cell are read and forgotten. */
static inline void fake_load_bytes(void *context, int64_t now_ns, const void *bytes, size_t n)
{
    (void)context, (void)now_ns, (void)bytes, (void)n;
}

/* --- spontaneous events --- */

static inline bool fake_alarm_is_due(const struct fake_bench *bench)
{
    return bench->raise_alarm && strcmp(bench->state, "Alarm") != 0;
}

static inline int64_t fake_next_ns(void *context)
{
    const struct fake_bench *const bench = context;
    if (fake_alarm_is_due(bench))
        return 0;
    return bench->next_load_ns < bench->next_frame_ns ? bench->next_load_ns : bench->next_frame_ns;
}

static inline void fake_run(void *context, int64_t now_ns)
{
    struct fake_bench *const bench = context;
    fake_move(bench, now_ns);
    if (fake_alarm_is_due(bench)) {
        bench->state = "Alarm";
        bench->limit_sent_ns = now_ns;
        fake_say(bench, "ALARM:1\r\n");
    }
    if (now_ns >= bench->next_load_ns) {
        bench->next_load_ns += FAKE_LOAD_PERIOD_NS;
        if (!bench->load_silent)
            fake_reading(bench);
    }
    if (now_ns >= bench->next_frame_ns) {
        bench->next_frame_ns += FAKE_FRAME_PERIOD_NS;
        if (!bench->mocap_silent && !bench->mocap_dead)
            fake_frame(bench);
    }
}

/* Virtual time begins with the bench and ends with it. */
static inline struct fake_bench *fake_start(void)
{
    struct fake_bench *const bench = calloc(1, sizeof *bench);
    assert_non_null(bench);
    wb_virtual_time_begin(FAKE_UTC);
    bench->handlers[WB_ROLE_LOAD] =
        (struct wb_sim_port_handler){bench, fake_load_bytes, fake_load_opened};
    bench->handlers[WB_ROLE_MOCAP] = (struct wb_sim_port_handler){bench, fake_datagram, NULL};
    bench->handlers[WB_ROLE_STAGE] = (struct wb_sim_port_handler){bench, fake_stage_bytes, NULL};
    assert_int_equal(wb_sim_port_create(&bench->load, "fake_cell", &bench->handlers[WB_ROLE_LOAD]),
                     WB_OK);
    assert_int_equal(
        wb_sim_port_create(&bench->mocap, "fake_mocap", &bench->handlers[WB_ROLE_MOCAP]), WB_OK);
    assert_int_equal(
        wb_sim_port_create(&bench->stage, "fake_stage", &bench->handlers[WB_ROLE_STAGE]), WB_OK);
    bench->state = "Idle";
    bench->markers = FAKE_MARKERS;
    bench->markers_follow = 100;
    bench->fastest_mm_min = 6000;
    bench->soft_travel_mm = 200;
    bench->force_mg = 150;
    bench->spring_mg_mm = 500;
    bench->noise = 12345;
    bench->moved_ns = bench->next_load_ns = bench->next_frame_ns = wb_time_now_ns();
    bench->actor = (struct wb_virtual_actor){bench, fake_next_ns, fake_run};
    wb_virtual_time_add(&bench->actor);
    return bench;
}

/* Unplugs all cables. */
static inline void fake_unplug(struct fake_bench *bench)
{
    wb_sim_port_unplug(bench->load);
    wb_sim_port_unplug(bench->stage);
    bench->mocap_dead = true;
}

static inline void fake_stop(struct fake_bench *bench)
{
    wb_sim_port_destroy(bench->load);
    wb_sim_port_destroy(bench->mocap);
    wb_sim_port_destroy(bench->stage);
    wb_virtual_time_end();
    free(bench);
}

/* Writes the rig file of this bench, of a real rig or of a virtual one. */
static inline void fake_write_rig(const char *path, bool is_virtual, double stream_lost)
{
    FILE *const file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file,
            "name: bench of a test\n"
            "load_cell:\n"
            "  address: sim:fake_cell\n"
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
            "  address: sim:fake_mocap\n"
            "  protocol: natnet\n"
            "  up: y\n"
            "stage:\n"
            "  address: sim:fake_stage\n"
            "  protocol: grbl\n"
            "  axis: X\n"
            "  down: +1\n"
            "  travel_mm: 60\n"
            "  speed_mm_s: 1\n"
            "limits:\n"
            "  force_mN: 100\n"
            "  travel_mm: 58\n"
            "  stream_lost_s: %g\n"
            "%s",
            stream_lost, is_virtual ? "virtual: true\ntruth:\n  spring_mg_mm: 500\n" : "");
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
