/* Synthetic recordings with a known truth: a wire of given stiffness, bow and residual deflection
 * on a strand, seen by cameras and a load cell with their own clocks, filter, noise and faults. The
 * bytes come from the drivers' encoders and pass through replay and alignment. Without a beam
 * solver: loading and unloading are straight lines of force over deflection.
 */
#ifndef WB_TESTS_ANALYSIS_SYNTHETIC_H
#define WB_TESTS_ANALYSIS_SYNTHETIC_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/units.h"
#include "daq/protocol/natnet_encode.h"
#include "daq/recording/recording.h"

#define SYN_MARKERS 7
#define SYN_LENGTH 0.085
#define SYN_STRAND 0.76
#define SYN_GRAVITY 9.80665
#define SYN_COUNTERWEIGHT 2.7e-3
#define SYN_REST (-0.5e-3)
#define SYN_SLACK 1e-3
#define SYN_OFFSET 1e-3 /* of the markers */
#define SYN_SPEED 1e-3
#define SYN_FILTER 0.05
#define SYN_HOST_ZERO_NS INT64_C(5000000000000)
#define SYN_TARE_S 2.0
#define SYN_DWELL_S 2.0 /* at the end of each cycle */
#define SYN_TABLE 4000

struct syn {
    /* The specimen. */
    double bow, stiffness, unloading; /* m, N/m, N/m */
    /* The test. */
    int cycles;
    double travel; /* m */
    double dwell;  /* s, at the turn */
    bool no_events, no_tare;
    bool loaded_tare; /* the counterweight is on the strand during the tare */
    /* Faults and noise. */
    double marker_noise, force_noise; /* m, N */
    double drift;                     /* N/s */
    double lost, lost_at;             /* m, m of travel */
    int hidden_marker;                /* occluded from hidden_from to hidden_until (bench s) */
    double hidden_from, hidden_until;
    bool model_filled; /* the hidden marker is sent with a flag, at a wrong place */
    bool stray, ids_change;
    double gap_from, gap_until;   /* load cell sends nothing */
    double busy_from, busy_until; /* the host reads nothing, then all pending data at once */
    double corrupt;               /* part of the chunks with wrong bytes */
    double vanish;                /* part of the frames and lines that are lost */
    bool overtaken;               /* each tenth frame is sent after the next one, and twice */
    uint64_t vanished_frames, vanished_lines; /* numbers of lost ones */
    double restart_at;                        /* s: the server's clock restarts; 0: never */
    double sign;                              /* of the load cell; 0 means 1 */
    /* The bench. */
    double time_scale; /* 0 means 1 */
    double skew;       /* relative slowness of the cameras' clock */
    int version_major, version_minor;
    double plane_angle; /* rad */
    bool z_up, no_motion;
    bool only_down;   /* the clamp goes down and stays there */
    double late;      /* s: additional delay of the force, besides its filter */
    uint64_t another; /* another realisation of all noise; 0: the first */
    bool polled;      /* the load cell is polled for each reading */
    /* Wrong values in the recording. */
    double scale;         /* of readings, in the rig file; 0: none, which is correct */
    const char *specimen; /* NULL: the correct one */
    const char *check;    /* of the load cell, a line of its log; NULL: none */

    /* Work. */
    uint64_t seed;
    double table_a[SYN_TABLE], table_y[SYN_TABLE], table_x[SYN_TABLE], table_g[SYN_TABLE];
    double largest_y; /* m, reached so far */
    double server_zero;
};

struct syn_state {
    double travel, y, tension, vertical, a;
};

static const double syn_s[SYN_MARKERS] = {0.0, 0.0142, 0.0283, 0.0425, 0.0567, 0.0708, 0.085};

static inline double syn_uniform(struct syn *syn)
{
    syn->seed = syn->seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return ((double)(syn->seed >> 11) + 0.5) * 0x1p-53;
}

static inline double syn_normal(struct syn *syn)
{
    const double radius = sqrt(-2.0 * log(syn_uniform(syn)));
    return radius * cos(2.0 * M_PI * syn_uniform(syn));
}

/* Angle of the axis: shape under a tip force with amplitude `a`, and the bow at zero. */
static inline double syn_angle(const struct syn *syn, double a, double u)
{
    const double bent = u - 0.5 * u * u, b = 2.0 * syn->bow / SYN_LENGTH;
    return a * bent + b * (u - 1.5 * bent);
}

static inline void syn_point(const struct syn *syn, double a, double s, double *x, double *y)
{
    enum {
        N = 60
    };
    *x = *y = 0.0;
    for (int i = 0; i < N; i++) {
        const double angle = syn_angle(syn, a, s * (i + 0.5) / N / SYN_LENGTH);
        *x += cos(angle) * s / N;
        *y += sin(angle) * s / N;
    }
}

static inline double syn_lean(double x)
{
    const double sine = (SYN_LENGTH - x) / SYN_STRAND;
    return SYN_STRAND * (1.0 - sqrt(1.0 - sine * sine));
}

static inline void syn_prepare(struct syn *syn)
{
    for (int i = 0; i < SYN_TABLE; i++) {
        syn->table_a[i] = -0.2 + 3.0 * i / SYN_TABLE;
        syn_point(syn, syn->table_a[i], SYN_LENGTH, &syn->table_x[i], &syn->table_y[i]);
        syn->table_g[i] = syn->table_y[i] - syn_lean(syn->table_x[i]);
    }
    syn->largest_y = SYN_REST;
    syn->seed = 77 + syn->another * UINT64_C(0x9e3779b97f4a7c15);
    syn->server_zero = 7200.0;
    if (syn->time_scale == 0.0)
        syn->time_scale = 1.0;
    if (syn->sign == 0.0)
        syn->sign = 1.0;
}

/* Linear interpolation in an ascending column. */
static inline double syn_look_up(const double *from, const double *to, double value)
{
    int low = 0, high = SYN_TABLE - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (from[middle] <= value)
            low = middle;
        else
            high = middle;
    }
    const double part = (value - from[low]) / (from[high] - from[low]);
    return to[low] + part * (to[high] - to[low]);
}

static inline double syn_cycle_time(const struct syn *syn)
{
    return 2.0 * syn->travel / SYN_SPEED + syn->dwell + SYN_DWELL_S;
}

/* Commanded travel at bench time t; the first cycle starts at 0. */
static inline double syn_commanded(const struct syn *syn, double t)
{
    if (t < 0.0 || syn->no_motion || t >= syn->cycles * syn_cycle_time(syn))
        return 0.0;
    const double down = syn->travel / SYN_SPEED, in = fmod(t, syn_cycle_time(syn));
    if (syn->only_down)
        return fmin(SYN_SPEED * in, syn->travel);
    if (in < down + syn->dwell)
        return fmin(SYN_SPEED * in, syn->travel);
    return fmax(0.0, syn->travel - SYN_SPEED * (in - down - syn->dwell));
}

/* Weights that the strand carries at zero deflection (the wire's own is negligible here). */
static inline double syn_carried(void)
{
    return SYN_COUNTERWEIGHT * SYN_GRAVITY;
}

/* The state at bench time t; times must ascend, since the wire remembers its largest deflection. */
static inline struct syn_state syn_move(struct syn *syn, double t)
{
    struct syn_state state = {.travel = syn_commanded(syn, t)};
    /* Steps lost on the way down are not recovered. */
    const double down = syn->travel / SYN_SPEED;
    if (syn->lost > 0.0 && (state.travel > syn->lost_at || t > down))
        state.travel -= syn->lost;
    const double taut = syn_look_up(syn->table_g, syn->table_y,
                                    state.travel + SYN_REST - syn_lean(SYN_LENGTH) - SYN_SLACK);
    syn->largest_y = fmax(syn->largest_y, taut);
    const double top = syn_carried() + syn->stiffness * (syn->largest_y - syn->bow);
    const double set = fmax(SYN_REST, syn->largest_y - top / syn->unloading);
    if (syn->largest_y <= SYN_REST || taut < set) {
        state.y = syn->largest_y <= SYN_REST ? SYN_REST : set;
    } else {
        state.y = taut;
        state.vertical = top - syn->unloading * (syn->largest_y - taut);
    }
    state.a = syn_look_up(syn->table_y, syn->table_a, state.y);
    const double sine =
        (SYN_LENGTH - syn_look_up(syn->table_y, syn->table_x, state.y)) / SYN_STRAND;
    state.tension = state.vertical / sqrt(1.0 - sine * sine);
    return state;
}

/* --- bytes --- */

static inline int64_t syn_host(const struct syn *syn, double t)
{
    return SYN_HOST_ZERO_NS + (int64_t)llround(t / syn->time_scale * 1e9);
}

static inline double syn_server(const struct syn *syn, double t)
{
    const double since = syn->restart_at > 0.0 && t > syn->restart_at ? -5000.0 : 0.0;
    return syn->server_zero + since + (t + 100.0) * (1.0 - syn->skew);
}

static inline void syn_chunk(struct syn *syn, struct wb_recording *recording, int stream,
                             int64_t *seq, int64_t t_ns, const void *bytes, size_t n)
{
    static uint8_t copy[8192];
    memcpy(copy, bytes, n);
    if (syn->corrupt > 0.0 && syn_uniform(syn) < syn->corrupt) {
        for (int i = 0; i < 3; i++)
            copy[(size_t)(syn_uniform(syn) * (double)n)] = (uint8_t)(256.0 * syn_uniform(syn));
    }
    const bool waits =
        t_ns > syn_host(syn, syn->busy_from) && t_ns < syn_host(syn, syn->busy_until);
    const int64_t taken_ns = waits ? syn_host(syn, syn->busy_until) : t_ns;
    if (wb_recording_append_chunk(recording, stream, (*seq)++, taken_ns, copy, n) != WB_OK)
        abort();
}

/* Whether a frame or line is lost; uses no random number if none can be. */
static inline bool syn_vanishes(struct syn *syn, uint64_t *count)
{
    const bool gone = syn->vanish > 0.0 && syn_uniform(syn) < syn->vanish;
    *count += gone;
    return gone;
}

static inline void syn_to_lab(const struct syn *syn, double x, double y, double travel,
                              float position[3], double noise[3])
{
    const double c = cos(syn->plane_angle), s = sin(syn->plane_angle);
    const double height = 0.95 + y - travel;
    const double lab[3] = {0.19 + x * c, height, -0.25 - x * s};
    for (int k = 0; k < 3; k++) {
        /* Z up: y becomes z and z becomes -y, still right-handed. */
        const double value = !syn->z_up ? lab[k] : k == 0 ? lab[0] : k == 1 ? -lab[2] : lab[1];
        position[k] = (float)(value + noise[k]);
    }
}

static inline void syn_frame(struct syn *syn, struct wb_natnet_frame *frame, int number, double t,
                             const struct syn_state *state)
{
    memset(frame, 0, sizeof *frame);
    frame->mocap.frame_number = number;
    frame->timestamp = frame->mocap.t_device = syn_server(syn, t);
    frame->mocap.camera_data_received = (uint64_t)(syn_server(syn, t) * 1e7);
    frame->mocap.transmit = frame->mocap.camera_data_received + 8000;
    frame->mocap.params = 4;
    int n = 0;
    for (int i = 0; i < SYN_MARKERS; i++) {
        /* Order and ids are arbitrary. */
        const int marker = (5 * i + number / 50) % SYN_MARKERS;
        double x, y, noise[3];
        for (int k = 0; k < 3; k++)
            noise[k] = syn->marker_noise * syn_normal(syn);
        syn_point(syn, state->a, syn_s[marker], &x, &y);
        const double angle = syn_angle(syn, state->a, syn_s[marker] / SYN_LENGTH);
        struct wb_marker *const out = &frame->mocap.markers[n];
        out->params = WB_MARKER_POINT_CLOUD_SOLVED | WB_MARKER_UNLABELED;
        if (marker == syn->hidden_marker && t >= syn->hidden_from && t < syn->hidden_until) {
            if (!syn->model_filled)
                continue;
            out->params = WB_MARKER_MODEL_FILLED | WB_MARKER_HAS_MODEL;
            y += 3e-3;
        }
        out->id = syn->ids_change ? 1000 * (1 + number / 70) + marker : 50000 + marker;
        out->size = 0.003F;
        syn_to_lab(syn, x - SYN_OFFSET * sin(angle), y + SYN_OFFSET * cos(angle), state->travel,
                   out->position, noise);
        n++;
    }
    if (syn->stray && number % 3 != 0) {
        double noise[3] = {0.0};
        frame->mocap.markers[n].id = 900;
        frame->mocap.markers[n].params = WB_MARKER_UNLABELED;
        syn_to_lab(syn, 0.05, 0.006, 0.004, frame->mocap.markers[n].position, noise);
        n++;
    }
    frame->mocap.n_markers = frame->n_labelled = n;
}

static inline void syn_write_mocap(struct syn *syn, struct wb_recording *recording, int stream,
                                   double begin, double end)
{
    static struct wb_natnet_frame frame;
    static uint8_t bytes[8192];
    const struct wb_natnet_version version = {(uint8_t)syn->version_major,
                                              (uint8_t)syn->version_minor};
    struct wb_natnet_server server = {
        .name = "synthetic",
        .natnet_version = {version.major, version.minor, 0, 0},
        .has_connection = syn->version_major >= 3,
        .clock_frequency = 10000000,
        .data_port = 1511,
    };
    int64_t seq = 0;
    size_t size = wb_natnet_encode_server(bytes, sizeof bytes, &server);
    syn_chunk(syn, recording, stream, &seq, syn_host(syn, begin - 0.1), bytes, size);
    const int n = (int)((end - begin) * 120.0);
    for (int i = 0; i < n; i++) {
        const double t = begin + i / 120.0;
        const struct syn_state state = syn_move(syn, t);
        const double u = syn_uniform(syn);
        syn_frame(syn, &frame, i, t, &state);
        size = wb_natnet_encode_frame(bytes, sizeof bytes, version, &frame);
        /* Frames at either end may still be on their way: daq/protocol/loss.h. */
        const bool at_end = i <= 16 || i >= n - 17;
        uint64_t at_ends = 0;
        const bool gone = i > 0 && i < n - 1 &&
                          syn_vanishes(syn, at_end ? &at_ends : &syn->vanished_frames) && !at_end;
        const int64_t late_ns = syn->overtaken && i % 10 == 9 ? 12000000 : 0;
        for (int k = 0; k < (late_ns > 0 ? 2 : 1) && !gone; k++)
            syn_chunk(syn, recording, stream, &seq,
                      syn_host(syn, t) + late_ns + (int64_t)(1e6 * (0.3 + 2.0 * u * u * u)), bytes,
                      size);
        if (syn->version_major >= 3 && i % 60 == 0) {
            const int64_t sent = syn_host(syn, t + 1e-3);
            const int64_t there = (int64_t)(1e5 * (1.0 + syn_uniform(syn)));
            const double at = t + 1e-3 + 1e-9 * (double)there * syn->time_scale;
            size = wb_natnet_encode_echo_response(bytes, sizeof bytes, (uint64_t)sent,
                                                  (uint64_t)(syn_server(syn, at) * 1e7));
            syn_chunk(syn, recording, stream, &seq, sent + 2 * there, bytes, size);
        }
    }
}

static inline void syn_write_load(struct syn *syn, struct wb_recording *recording, int stream,
                                  double begin, double end)
{
    int64_t seq = 0, read_ns = INT64_MIN;
    double filtered = 0.0, last = 0.0;
    syn->largest_y = SYN_REST;
    const int n = (int)((end - begin) * 80.0), sub = 8;
    for (int i = 0; i < n; i++) {
        char line[48];
        const double t = begin + i / 80.0;
        for (int k = 1; k <= sub; k++) {
            const double tension = syn_move(syn, t - syn->late - (sub - k) / (80.0 * sub)).tension;
            /* First-order filter, the input linear between samples. */
            const double decay = exp(-1.0 / (80.0 * sub) / SYN_FILTER);
            filtered = decay * filtered + (1.0 - decay) * 0.5 * (last + tension);
            last = tension;
        }
        const double force = 3e-3 + filtered + syn->drift * t + syn->force_noise * syn_normal(syn);
        const int length =
            snprintf(line, sizeof line, "%+.4f g\r\n", syn->sign * force / SYN_GRAVITY / WB_G);
        const double u = syn_uniform(syn);
        if (t >= syn->gap_from && t < syn->gap_until)
            continue;
        if (i > 0 && i < n - 1 && syn_vanishes(syn, &syn->vanished_lines))
            continue;
        /* Arrivals are in order. */
        const int64_t arrival_ns = syn_host(syn, t) + (int64_t)(2e6 * u * u);
        read_ns = arrival_ns > read_ns ? arrival_ns : read_ns;
        syn_chunk(syn, recording, stream, &seq, read_ns, line, (size_t)length);
    }
}

static inline void syn_write_stage(struct syn *syn, struct wb_recording *recording, int stream,
                                   double begin, double end)
{
    int64_t seq = 0;
    const char *const banner = "\r\nGrbl 1.1h ['$' for help]\r\n";
    syn_chunk(syn, recording, stream, &seq, syn_host(syn, begin), banner, strlen(banner));
    const int n = (int)((end - begin) * 5.0);
    for (int i = 1; i < n; i++) {
        char line[96];
        const double t = begin + i / 5.0;
        const int length =
            snprintf(line, sizeof line, "<Run|MPos:%.3f,0.000,0.000|FS:60,0>\r\n",
                     -60.0 + syn_commanded(syn, t - 0.012 * syn->time_scale) / WB_MM);
        syn_chunk(syn, recording, stream, &seq, syn_host(syn, t), line, (size_t)length);
    }
}

static inline void syn_event(const struct syn *syn, struct wb_recording *recording, double t,
                             const char *kind, const char *text)
{
    if (wb_recording_append_event(recording, syn_host(syn, t), kind, text) != WB_OK)
        abort();
}

static inline void syn_write_events(const struct syn *syn, struct wb_recording *recording)
{
    char text[160];
    snprintf(text, sizeof text, "{\"force_N\": %.9g, \"samples\": 160, \"sd_N\": %.9g}",
             (syn->scale != 0.0 ? syn->scale : 1.0) *
                 (syn->sign * 3e-3 + (syn->loaded_tare ? SYN_COUNTERWEIGHT * SYN_GRAVITY : 0.0)),
             syn->force_noise);
    if (!syn->no_tare)
        syn_event(syn, recording, -0.01, "tare", text);
    for (int cycle = 0; cycle < syn->cycles && !syn->no_events; cycle++) {
        const double start = cycle * syn_cycle_time(syn);
        snprintf(text, sizeof text, "%d", cycle + 1);
        syn_event(syn, recording, start, "cycle_start", text);
        syn_event(syn, recording, start + syn->travel / SYN_SPEED + syn->dwell, "turn", text);
        syn_event(syn, recording, start + 2.0 * syn->travel / SYN_SPEED + syn->dwell, "cycle_end",
                  text);
    }
    syn_event(syn, recording, syn->cycles * syn_cycle_time(syn), "stop", "done");
}

static const char syn_wire[] = "name: synthetic\n"
                               "conductor_diameter_mm: 0.7\n"
                               "outer_diameter_mm: 1.1\n"
                               "density_g_cm3: 0.01\n";
static const char syn_specimen[] = "wire: synthetic\n"
                                   "length_mm: 85\n"
                                   "sample: 2\n"
                                   "markers_mm: [0, 14.2, 28.3, 42.5, 56.7, 70.8, 85]\n"
                                   "marker_offset_mm: 1.0\n"
                                   "marker_offset_uncertainty_mm: 0.05\n";

/* The rig file of the bench, with this scale of readings (0: none). */
static inline void syn_rig(const struct syn *syn, double scale, char rig[2048])
{
    char scaled[48] = "";
    if (scale != 0.0)
        snprintf(scaled, sizeof scaled, "  scale: %g\n", scale);
    snprintf(rig, 2048,
             "name: synthetic bench\n"
             "load_cell:\n"
             "  address: memory:load\n"
             "  protocol: generic\n"
             "  capacity_g: 20\n"
             "  overload_percent: 150\n"
             "  filter_delay_ms: %g\n"
             "  filter_delay_uncertainty_ms: 5\n"
             "  noise_mg: 10\n"
             "  tare: %s\n"
             "%s%s"
             "mocap:\n"
             "  address: memory:mocap\n"
             "  protocol: natnet\n"
             "  up: %c\n"
             "  marker_noise_mm: 0.1\n"
             "stage:\n"
             "  address: memory:stage\n"
             "  protocol: grbl\n"
             "  axis: X\n"
             "  down: +1\n"
             "  travel_mm: 60\n"
             "  speed_mm_s: 1\n"
             "strand:\n"
             "  length_mm: 760\n"
             "  counterweight_g: 2.7\n"
             "virtual: true\n"
             "time_scale: %g\n",
             SYN_FILTER * 1e3, syn->loaded_tare ? "counterweight" : "unloaded",
             syn->polled ? "  poll_command: \"W\\r\"\n  poll_period_ms: 12.5\n" : "", scaled,
             syn->z_up ? 'z' : 'y', syn->time_scale);
}

static inline void syn_write_meta(const struct syn *syn, struct wb_recording *recording)
{
    char rig[2048];
    syn_rig(syn, syn->scale, rig);
    if (wb_recording_set_meta(recording, "rig", rig) != WB_OK ||
        wb_recording_set_meta(recording, "specimen",
                              syn->specimen ? syn->specimen : syn_specimen) != WB_OK ||
        wb_recording_set_meta(recording, "wire", syn_wire) != WB_OK ||
        wb_recording_set_meta(recording, "g", "9.80665") != WB_OK ||
        wb_recording_set_meta(recording, "virtual", "true") != WB_OK ||
        wb_recording_set_meta(recording, "start_utc", "2026-01-01T00:00:00Z") != WB_OK ||
        (syn->check && wb_recording_set_meta(recording, "load_cell_check", syn->check) != WB_OK))
        abort();
}

/* Writes the recording to `path`, which must not exist. */
static inline void syn_record(struct syn *syn, const char *path)
{
    struct wb_recording *recording;
    int load, mocap, stage;
    syn_prepare(syn);
    if (wb_recording_create(&recording, path) != WB_OK ||
        wb_recording_add_stream(recording, WB_ROLE_LOAD, "memory:load", "generic", "", &load) !=
            WB_OK ||
        wb_recording_add_stream(recording, WB_ROLE_MOCAP, "memory:mocap", "natnet", "", &mocap) !=
            WB_OK ||
        wb_recording_add_stream(recording, WB_ROLE_STAGE, "memory:stage", "grbl", "", &stage) !=
            WB_OK)
        abort();
    const double begin = -SYN_TARE_S - 0.5, end = syn->cycles * syn_cycle_time(syn);
    syn_write_meta(syn, recording);
    syn_write_events(syn, recording);
    syn_write_mocap(syn, recording, mocap, begin, end);
    syn_write_load(syn, recording, load, begin, end);
    syn_write_stage(syn, recording, stage, begin, end);
    if (wb_recording_close(recording) != WB_OK)
        abort();
}

/* A bench without faults: bow 3 mm upwards, 1.8 N/m, a residual deflection after unloading. */
static inline void syn_default(struct syn *syn)
{
    memset(syn, 0, sizeof *syn);
    syn->bow = 3e-3;
    syn->stiffness = 1.8;
    syn->unloading = 3.0;
    syn->cycles = 1;
    syn->travel = 20e-3;
    syn->marker_noise = 0.1e-3;
    syn->force_noise = 98e-6;
    syn->hidden_marker = -1;
    syn->gap_from = syn->gap_until = -1e9;
    syn->busy_from = syn->busy_until = -1e3;
    syn->version_major = 3;
    syn->plane_angle = 2.1;
    syn->skew = 50e-6;
}

#endif
