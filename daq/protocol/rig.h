/* The bench as its rig file describes it. Every key is in docs/file-formats.md.
 *
 *     name: paper bench
 *     gravity_m_s2: 9.80665            # optional, standard gravity
 *     load_cell:
 *       address: serial:/dev/ttyUSB0,9600,8n1
 *       protocol: generic              # or mt-sics
 *       capacity_g: 20
 *       overload_percent: 150          # of the capacity: what the cell still reads
 *       serial_number: LS270-1234
 *       calibration_date: 2026-01-15
 *       filter_delay_ms: 50
 *       filter_delay_uncertainty_ms: 5
 *       u_gain_percent: 0.3            # optional, standard uncertainty of what it reads
 *       noise_mg: 10                   # optional, expected standard deviation
 *       check_mass_g: 10               # optional, known mass for the check of the cell
 *       check_tolerance_percent: 1     # optional
 *       check_masses_g: [0, 5, 10, 5, 0] # optional, a series up and down in its place
 *       check_due_days: 30             # optional, how long a check holds
 *       tare: unloaded                 # or counterweight: what hangs on the cell at the start
 *       sign: +1                       # +1: tension reads positive
 *       poll_period_ms: 100            # optional, absent: the instrument streams by itself
 *       preset: a-and-d                # optional: the maker's row of
 * daq/protocol/loadcell_preset.c
 *       ...generic line protocol: delimiter, column, unit, scale, offset, terminator,
 *          idle_gap_ms, poll_command, start_command, stop_command, tare_command,
 *          unstable_tokens, overload_tokens, decimal_comma, settle_ms
 *     mocap:
 *       address: udp:192.168.1.10:1510,group=239.255.42.99:1511
 *       protocol: natnet
 *       up: y                          # axis that points up: y or z
 *       marker_noise_mm: 0.1           # optional, expected standard deviation
 *       frame_rate_hz: 120             # optional, expected
 *       record_take: true              # optional: Motive keeps a take of its own
 *     stage:
 *       address: serial:/dev/ttyACM0,115200,8n1
 *       protocol: grbl                 # or tic
 *       axis: X                        # of grbl; a Tic has one
 *       down: +1                       # sign of the axis when the clamp goes down
 *       travel_mm: 60                  # usable travel from the start position
 *       speed_mm_s: 1
 *       steps_per_mm: 800              # optional, what the firmware must be set to; tic: needed
 *     strand:                          # optional, absent: the tip hangs on the cell itself
 *       length_mm: 760
 *       counterweight_g: 2.7
 *       u_counterweight_g: 0.01        # optional, standard uncertainty
 *     limits:                          # optional
 *       force_mN: 280
 *       travel_mm: 58
 *       stream_lost_s: 1
 *       force_drop_percent: 10
 *     virtual: true                    # only written by `wirebench rig`
 *     time_scale: 1
 *     truth: {...}                     # only written by `wirebench rig`; no analysis reads it
 */
#ifndef WB_DAQ_PROTOCOL_RIG_H
#define WB_DAQ_PROTOCOL_RIG_H

#include <stdbool.h>
#include <stdint.h>

#include "base/reason.h"

#define WB_RIG_TEXT 160
#define WB_RIG_TOKENS 8
#define WB_RIG_MASSES 64 /* most of a calibration's series */

/* What the strand carries at the start position, while the tare is taken. */
enum wb_rig_tare {
    WB_RIG_TARE_UNLOADED,     /* nothing: the strand is slack, the tare is the cell's zero */
    WB_RIG_TARE_COUNTERWEIGHT /* the counterweight: tension = reading - tare + counterweight g */
};

struct wb_rig_load_cell {
    char address[WB_RIG_TEXT];
    char protocol[32];
    double capacity; /* N */
    double overload; /* N: the largest force it still reads (capacity x overload_percent) */
    char serial_number[64];
    char calibration_date[32];
    double filter_delay;                /* s */
    double filter_delay_uncertainty;    /* s */
    double gain_uncertainty;            /* 1, standard; 0: not stated */
    double noise;                       /* N, expected standard deviation; 0 unknown */
    double check_mass;                  /* kg, known mass to check the cell with; 0 none */
    double check_tolerance;             /* fraction of the check mass, or of a series' span */
    double check_masses[WB_RIG_MASSES]; /* kg, a series (cell_calibration.h) */
    int n_check_masses;                 /* 0: none */
    double check_due;                   /* s, how long a check holds; 0: not watched */
    enum wb_rig_tare tare;              /* see wb_rig_tare_load() */
    /* Generic line protocol: what the rig file or its preset says. */
    char preset[32];       /* "" none */
    char delimiter;        /* 0: whole line is one value */
    int column;            /* from 1, with a delimiter */
    char unit[16];         /* overrides the line's unit; "" takes the line's */
    double scale, offset;  /* force = sign (scale value + offset) unit: both in the line's unit */
    int sign;              /* +1: tension reads positive */
    char terminator[8];    /* "cr", "lf", "crlf", "idle"; "any" or "": CR or LF */
    int64_t idle_gap_ns;   /* for "idle" */
    char poll_command[32]; /* with C escapes resolved; "" streams by itself */
    int64_t poll_period_ns;
    char start_command[32];
    char stop_command[32]; /* sent before the port is closed */
    char tare_command[32];
    char unstable_tokens[WB_RIG_TOKENS][16];
    char overload_tokens[WB_RIG_TOKENS][16];
    bool decimal_comma;
    int64_t settle_ns; /* ignore bytes for so long after the first that came */
};

struct wb_rig_mocap {
    char address[WB_RIG_TEXT];
    char protocol[32];
    char up;             /* 'y' or 'z' */
    double marker_noise; /* m, expected standard deviation; 0 unknown */
    double frame_rate;   /* 1/s, expected; 0 unknown */
    bool record_take;    /* the server is asked to record a take of its own meanwhile */
};

struct wb_rig_stage {
    char address[WB_RIG_TEXT];
    char protocol[32];
    char axis;     /* 'X', 'Y' or 'Z'; 'X' of a Tic, which has one */
    int down;      /* +1 or -1 */
    double travel; /* m, usable downward travel from where the test starts */
    double speed;  /* m/s */
    double steps;  /* motor steps per m: that the firmware must be set to, 0: not checked; of a Tic
                      microsteps, by which it counts */
};

struct wb_rig_limits {
    double force;       /* N; 0: the cell's overload */
    double travel;      /* m; 0: the stage's travel */
    double stream_lost; /* s */
    double force_drop;  /* share of its peak that the force may fall by on the way down; 0: any */
};

struct wb_rig_strand {
    double length;                    /* m; 0: no strand, the force at the tip is vertical */
    double counterweight;             /* kg */
    double counterweight_uncertainty; /* kg, standard; 0: not stated */
};

struct wb_rig {
    char name[WB_RIG_TEXT];
    double gravity; /* m/s2 */
    struct wb_rig_load_cell load_cell;
    struct wb_rig_mocap mocap;
    struct wb_rig_stage stage;
    struct wb_rig_limits limits;
    struct wb_rig_strand strand;
    bool is_virtual;
    double time_scale; /* 1 on a real bench: the rig's clocks run so many times faster */
};

/* Tension of the strand while the tare is taken, N: 0, or the weight of the counterweight. The
 * tension at any other time is the reading less the tare plus this. */
double wb_rig_tare_load(const struct wb_rig *rig);

/* Largest standard deviation of a resting cell, N: five times its own noise, or 1 % of the capacity
 * where the rig file has none. More is a mass that swings or something that touches the cell. */
double wb_rig_noise_allowed(const struct wb_rig_load_cell *cell);

/* Reads a rig file; errors name file, line and key. */
WB_MUST_CHECK enum wb_status wb_rig_read(const char *path, struct wb_rig *rig);
/* The same from text (a recording's meta); `origin` stands for the file in errors,
 * which go to `why`; NULL: to the log. */
WB_MUST_CHECK enum wb_status wb_rig_parse(const char *text, const char *origin, struct wb_rig *rig,
                                          struct wb_reason *why);

#endif
