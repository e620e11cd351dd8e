/* Decoded samples of the instruments, with the host's arrival time and the device's own time. */
#ifndef WB_DAQ_PROTOCOL_SAMPLE_H
#define WB_DAQ_PROTOCOL_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"

/* A reading of a load cell. `force` is the value sent by the instrument with sign and scale of the
 * rig file applied; tare, drift and delay are not corrected. */
struct wb_load_sample {
    int64_t t_ns;          /* host monotonic, arrival of the read that completed the line */
    uint64_t index;        /* counts decoded readings of this stream from 0 */
    double force;          /* N, tension positive; NaN: not valid */
    bool valid;            /* false: overload, underload or an error line */
    bool unstable;         /* marked as unstable by the instrument; still valid */
    bool overload;         /* over or under range: trips the interlock */
    bool unit_changed;     /* the line's unit differs from the first one: trips the interlock */
    bool unit_contradicts; /* the line's unit is not that of the rig file: the line's is used, and
                              no test is started */
};

/* Marker parameter bits of NatNet (2.6 and later). */
enum {
    WB_MARKER_OCCLUDED = 1 << 0,
    WB_MARKER_POINT_CLOUD_SOLVED = 1 << 1,
    WB_MARKER_MODEL_FILLED = 1 << 2,
    WB_MARKER_HAS_MODEL = 1 << 3,
    WB_MARKER_UNLABELED = 1 << 4,
    WB_MARKER_ACTIVE = 1 << 5
};

struct wb_marker {
    int32_t id;
    float position[3]; /* m, in the server's frame, as received */
    float size;        /* m */
    float residual;    /* m per ray; 0 before NatNet 3.0 */
    int16_t params;    /* WB_MARKER_ bits */
};

#define WB_MAX_MARKERS 256

/* One frame of motion capture: the labelled markers only (the legacy list repeats them). */
struct wb_mocap_frame {
    int64_t t_ns; /* host monotonic, arrival of the datagram */
    int32_t frame_number;
    double t_device;              /* s, capture stamp of the server; NaN: none */
    double t_clock;               /* s, camera_data_received on the clock of the probes; NaN:
                                     unknown (before NatNet 3.0) */
    uint64_t camera_mid_exposure; /* server ticks; 0: unknown (before NatNet 3.0) */
    uint64_t camera_data_received;
    uint64_t transmit;
    int16_t params; /* bit 0 recording, 1 models changed, 2 live, 3 bitstream changed */
    int segment;    /* from 0; a new one begins when the server is restarted or its models change */
    int n_markers;
    struct wb_marker markers[WB_MAX_MARKERS];
};

enum wb_stage_state {
    WB_STAGE_UNKNOWN,
    WB_STAGE_IDLE,
    WB_STAGE_RUN,
    WB_STAGE_JOG,
    WB_STAGE_HOLD,
    WB_STAGE_HOME,
    WB_STAGE_ALARM,
    WB_STAGE_OTHER /* door, check, sleep */
};

/* One status report of a stage. */
struct wb_stage_report {
    int64_t t_ns;
    enum wb_stage_state state;
    double position; /* m, machine position of the test's axis as commanded; NaN: not sent */
    int alarm;       /* last ALARM number; 0: none */
    bool was_reset;  /* the firmware has restarted since its port was opened, not by our command */
};

/* Settings of a stage's firmware for the test's axis. A number that it did not report is NaN. */
struct wb_stage_settings {
    double steps;        /* motor steps per m */
    double speed;        /* m/s, maximum; the firmware silently limits faster commands */
    double acceleration; /* m/s2 */
    double travel;       /* m; with soft_limits, positions are -travel to 0 */
    bool soft_limits;
    bool inches;     /* positions are reported in inches */
    bool powers_off; /* the motor is switched off after a motion */
    char fault[320]; /* why no motion may be started, and the remedy; "": allowed */
    char text[1280]; /* all settings as printed by the firmware, one per line */
};

/* A probe of a device's clock (Cristian's method): the device's clock was `t_device` between the
 * two host times. */
struct wb_clock_probe {
    int64_t t_sent_ns, t_received_ns; /* host monotonic */
    double t_device;                  /* s, device clock */
};

/* Receiver of decoded samples. Members may be NULL. Arguments are valid during the call only. */
struct wb_sink {
    void *context;
    void (*load)(void *context, const struct wb_load_sample *sample);
    void (*mocap)(void *context, const struct wb_mocap_frame *frame);
    void (*stage)(void *context, const struct wb_stage_report *report);
    void (*settings)(void *context, const struct wb_stage_settings *settings);
    void (*probe)(void *context, const struct wb_clock_probe *probe);
    /* A remark for the recording's events and the operator: server connected, line rejected, alarm,
     * unknown version, ... `kind` is one lower-case word. */
    void (*remark)(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                   const char *text);
};

#endif
