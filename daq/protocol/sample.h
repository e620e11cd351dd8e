/* What instruments say, decoded: samples with the host's arrival time beside the device's own. */
#ifndef WB_DAQ_PROTOCOL_SAMPLE_H
#define WB_DAQ_PROTOCOL_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/log.h"

/* One reading of a load cell. `force` is as the instrument sent it, times sign and scale of the
 * rig file: not tared, no drift or delay removed. */
struct wb_load_sample {
    int64_t t_ns;          /* host monotonic, arrival of the read that completed the line */
    uint64_t index;        /* counts decoded readings of this stream from 0 */
    double force;          /* N, tension positive; NaN when not valid */
    bool valid;            /* false: overload, underload or an error line */
    bool unstable;         /* the instrument called it unstable; still valid */
    bool overload;         /* over or under range: an interlock, never a number */
    bool unit_changed;     /* the unit on the line differs from the first one seen: an alarm */
    bool unit_contradicts; /* the unit on the line is not the rig file's: the line's is used, and no
                              test begins */
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
    float position[3]; /* m, in the server's frame, the bits as received */
    float size;        /* m */
    float residual;    /* m per ray; 0 before NatNet 3.0 */
    int16_t params;    /* WB_MARKER_ bits */
};

#define WB_MAX_MARKERS 256

/* One frame of motion capture: the labelled markers only (the legacy list repeats them). */
struct wb_mocap_frame {
    int64_t t_ns; /* host monotonic, arrival of the datagram */
    int32_t frame_number;
    double t_device;              /* s, the server's own capture stamp; NaN when it has none */
    double t_clock;               /* s, camera_data_received on the clock that the probes read;
                                     NaN when unknown (before NatNet 3.0) */
    uint64_t camera_mid_exposure; /* server ticks, 0 when unknown (NatNet >= 3.0) */
    uint64_t camera_data_received;
    uint64_t transmit;
    int16_t params; /* bit 0 recording, 1 models changed, 2 live, 3 bitstream changed */
    int segment;    /* from 0: the next one begins when the server was restarted, or what it tracks
                       was changed */
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
    double position; /* m, machine position of the test's axis as commanded; NaN when not sent */
    int alarm;       /* last ALARM number, 0 none */
    bool was_reset;  /* the firmware started anew since its port was opened, and not at our word */
};

/* What the firmware of a stage is set to, for the test's axis. A number that it did not tell is
 * NaN.
 */
struct wb_stage_settings {
    double steps;        /* motor steps per m */
    double speed;        /* m/s, largest; a faster command is slowed down without a word */
    double acceleration; /* m/s2 */
    double travel;       /* m: positions are -travel to 0 where soft_limits */
    bool soft_limits;
    bool inches;     /* positions are reported in inches */
    bool powers_off; /* the motor is switched off when a motion has ended */
    char fault[320]; /* why no motion may begin, and how to mend it; "": it may */
    char text[1280]; /* all of it as the firmware prints it, one setting a line */
};

/* One probe of a device's clock (Cristian): the device read `t_device` between the two host
 * times. */
struct wb_clock_probe {
    int64_t t_sent_ns, t_received_ns; /* host monotonic */
    double t_device;                  /* s, device clock */
};

/* Where decoders deliver. Members may be NULL. Everything passed is valid during the call only. */
struct wb_sink {
    void *context;
    void (*load)(void *context, const struct wb_load_sample *sample);
    void (*mocap)(void *context, const struct wb_mocap_frame *frame);
    void (*stage)(void *context, const struct wb_stage_report *report);
    void (*settings)(void *context, const struct wb_stage_settings *settings);
    void (*probe)(void *context, const struct wb_clock_probe *probe);
    /* A remark for the recording's events and the operator: server connected, line rejected,
     * alarm, version not known, ... `kind` is one lower-case word. */
    void (*remark)(void *context, enum wb_log_level level, int64_t t_ns, const char *kind,
                   const char *text);
};

#endif
