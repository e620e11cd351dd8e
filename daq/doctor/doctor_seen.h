/* Data collected from the instruments while `doctor` listens. Filled from samples, without ports or
 * clocks. */
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

/* The last or most severe remark of a driver of one kind. */
struct wb_doctor_remark {
    enum wb_log_level level;
    char kind[24], text[400];
};

/* Sums for a linear regression of force (N) on time (s). */
struct wb_doctor_trend {
    int64_t first_ns;
    double n, t, f, tt, tf;
    double lowest, highest; /* N */
};

struct wb_doctor_seen {
    const struct wb_rig *rig;                     /* borrowed */
    const struct wb_specimen *specimen;           /* borrowed; NULL: none */
    struct wb_reason opening[WB_INTERLOCK_ROLES]; /* why it could not be opened; "": open */
    struct wb_acquisition_latest latest;          /* at the end */
    double waited;                                /* s, timeout for the first replies */
    double listened;                              /* s of listening after that */
    const enum wb_role *source; /* borrowed from the acquisition; set before the first sample */
    bool listening;             /* false: samples are ignored */
    struct wb_start_check check;
    struct wb_doctor_trend trend;
    struct wb_mocap_frame frame; /* the latest frame with the largest number of measured markers */
    int frame_measured;
    long n_frames;
    size_t n_stamps;
    double stamps[WB_DOCTOR_FRAMES];    /* s, device time of frames, ascending */
    int64_t arrivals[WB_DOCTOR_FRAMES]; /* host time of these frames */
    size_t n_probes;
    struct wb_clock_probe probes[WB_DOCTOR_PROBES];
    int n_remarks[WB_INTERLOCK_ROLES];
    struct wb_doctor_remark remarks[WB_INTERLOCK_ROLES][WB_DOCTOR_REMARKS];
};

/* A sink that collects in `seen`. `seen->source` must be the origin of remarks (`source` of
 * wb_acquisition_latest). */
struct wb_sink wb_doctor_seen_sink(struct wb_doctor_seen *seen);

/* Mean slope of force over host time, N/s; *error receives an upper bound of its standard error. */
double wb_doctor_trend_slope(const struct wb_doctor_trend *trend, double *error);

/* The remark of this kind; NULL: none. */
const struct wb_doctor_remark *wb_doctor_seen_remark(const struct wb_doctor_seen *seen,
                                                     enum wb_role role, const char *kind);

#endif
