/* What was seen and heard of a bench while it was listened to. Filled from samples, without ports
 * or clocks. */
#ifndef WB_DAQ_DOCTOR_DOCTOR_SEEN_H
#define WB_DAQ_DOCTOR_DOCTOR_SEEN_H

#include <stdbool.h>
#include <stdint.h>

#include "daq/acquire/acquisition.h"
#include "daq/protocol/clock.h"
#include "daq/protocol/specimen.h"
#include "daq/test/start_check.h"

#define WB_DOCTOR_FRAMES 4096
#define WB_DOCTOR_PROBES 256
#define WB_DOCTOR_REMARKS 8

/* What a driver remarked, the last one of its kind. */
struct wb_doctor_remark {
    enum wb_log_level level;
    char kind[24], text[400];
};

/* Sums of a straight line through force over time. */
struct wb_doctor_trend {
    int64_t first_ns;
    double n, t, f, tt, tf;
    double lowest, highest; /* N */
};

struct wb_doctor_seen {
    const struct wb_rig *rig;                     /* borrowed */
    const struct wb_specimen *specimen;           /* borrowed; NULL: none */
    struct wb_reason opening[WB_INTERLOCK_ROLES]; /* why it is not open; "" it is */
    struct wb_acquisition_latest latest;          /* at the end */
    double waited;                                /* s for the instruments to answer */
    double listened;                              /* s after that */
    const enum wb_role *source; /* borrowed from the acquisition; set before the first sample */
    bool listening;             /* samples count from here on */
    struct wb_start_check check;
    struct wb_doctor_trend trend;
    struct wb_mocap_frame frame; /* the latest of those with most measured markers */
    int frame_measured;
    long n_frames;
    size_t n_stamps;
    double stamps[WB_DOCTOR_FRAMES]; /* s, ascending, with their arrivals */
    int64_t arrivals[WB_DOCTOR_FRAMES];
    size_t n_probes;
    struct wb_clock_probe probes[WB_DOCTOR_PROBES];
    int n_remarks[WB_INTERLOCK_ROLES];
    struct wb_doctor_remark remarks[WB_INTERLOCK_ROLES][WB_DOCTOR_REMARKS];
};

/* A sink that notes in `seen`. `source` says whose remark it is (wb_acquisition_latest). */
struct wb_sink wb_doctor_seen_sink(struct wb_doctor_seen *seen);

/* Mean slope of force over the host's time, N/s, with its standard error. */
double wb_doctor_trend_slope(const struct wb_doctor_trend *trend, double *error);

/* The last remark of this kind; NULL: none. */
const struct wb_doctor_remark *wb_doctor_seen_remark(const struct wb_doctor_seen *seen,
                                                     enum wb_role role, const char *kind);

#endif
