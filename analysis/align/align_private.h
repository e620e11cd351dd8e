/* State that the parts of the alignment share: one recording on its way to a dataset.
 *
 * In order: align_recording.c decodes the recording and puts everything on the bench's clock,
 * align_given.c reports how given files differ from the recorded ones, align_rows.c makes rows in
 * the clamp's frame, compares the stage and cuts cycles, align_holds.c finds the times in which the
 * operator held the test, align_force.c turns readings into tension and force, align_natural.c
 * finds the natural shape, and align.c, which calls them all, fills the dataset. align_report.c,
 * which all call, writes corrections and warnings into dataset.json.
 */
#ifndef WB_ANALYSIS_ALIGN_ALIGN_PRIVATE_H
#define WB_ANALYSIS_ALIGN_ALIGN_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analysis/align/align.h"
#include "analysis/align/frame.h"
#include "analysis/align/markers.h"
#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/file.h"
#include "base/json.h"
#include "base/status.h"
#include "daq/protocol/clock.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"
#include "daq/recording/recording.h"
#include "daq/recording/replay.h"
#include "daq/test/bend_hold.h"
#include "fe/model/wire.h"

/* One reading of the load cell. */
struct wb_align_reading {
    int64_t t_ns; /* arrival */
    double t;     /* s, bench time, filter delay removed */
    double force; /* N, as read; NaN when not valid */
};

/* One position report of the stage. */
struct wb_align_report_point {
    int64_t t_ns;
    double t;      /* s, bench time of arrival */
    double travel; /* m, commanded, downwards from the first report */
};

/* A growing array; each declaration names the type of its items. */
struct wb_align_list {
    void *items; /* owned */
    size_t n, capacity;
};

/* Adds a copy of an item. */
void wb_align_list_add(struct wb_align_list *list, const void *item, size_t size);

/* One row of the dataset under construction. */
struct wb_align_row {
    double t;      /* s, bench time */
    double travel; /* m, measured at the clamp's marker, downwards from the start */
    double x[WB_SPECIMEN_MAX_MARKERS]; /* m, on the axis, clamp's frame; NaN: not seen */
    double y[WB_SPECIMEN_MAX_MARKERS];
    double tip_x, tip_y, tip_angle; /* m, m, rad */
    double lean_cosine;             /* of the strand against the vertical; 1 without a strand */
    double reading;                 /* N, less the tare */
    double commanded;               /* m; NaN unknown */
    double tension, vertical, force;
    int cycle;
    enum wb_phase phase;
};

/* Zero of the load cell over a stretch without load. */
struct wb_align_zero {
    double t;                /* s, its middle */
    double value, deviation; /* N: mean reading less tare, standard error */
};
#define WB_ALIGN_MAX_ZEROS 64
#define WB_ALIGN_MAX_SEGMENTS 64
#define WB_ALIGN_MAX_HOLDS 64

struct wb_align {
    struct wb_align_settings settings;
    struct wb_reason *why;  /* receives why a step failed; NULL: it is logged */
    struct wb_reason *lost; /* receives what the reader could not read; NULL: it is logged */
    struct wb_dataset *dataset;
    struct wb_json *corrections, *checks, *warnings; /* in the dataset's document */
    char name[128];                                  /* of the recording, without folder */
    char sha256[65];

    /* From the recording's meta data. */
    struct wb_rig rig;
    struct wb_specimen specimen;
    struct wb_wire wire;
    double gravity;      /* m/s2 */
    double checked_gain; /* standard uncertainty of the gain by its last check; 0: unknown */
    bool is_virtual;

    /* Decoded. */
    struct wb_align_list readings; /* struct wb_align_reading */
    struct wb_align_list reports;  /* struct wb_align_report_point */
    struct wb_align_list probes;   /* struct wb_clock_probe */
    struct wb_point_cloud cloud;
    struct wb_replay_counts counts;
    uint64_t n_invalid;      /* readings that were not numbers */
    bool is_losing_readings; /* the load cell lost 2 % of its lines or more */

    /* Events. */
    bool has_tare, has_start;
    double tare, tare_deviation; /* N, N (of one reading; NaN unknown) */
    long tare_samples;
    int64_t tare_ns, start_ns;
    int n_cycle_starts;
    bool is_cut_short;     /* aborted, or parts are damaged */
    char stop_reason[384]; /* text of the event `stop` */
    unsigned n_lost, n_drops;
    int n_holds;     /* by the operator */
    bool skips_hold; /* its start was beyond the capacity */
    struct wb_bend_hold_recorded holds[WB_ALIGN_MAX_HOLDS];

    /* Times. */
    int64_t zero_ns;                               /* host time of bench time 0 */
    double *frame_t;                               /* (cloud.n_frames) s, bench time; owned */
    const char *method;                            /* of the camera's clock */
    double camera_uncertainty;                     /* s, bench time; NaN unknown */
    double filter_delay, filter_delay_uncertainty; /* s, bench time */
    bool camera_times_given, load_times_given; /* by files: used as given, without a fitted line */
    double import_uncertainty; /* s, of the lag between two files; NaN: not imported, or unknown */
    double load_scatter;       /* s, bench time: lateness of arrivals that was removed */

    struct wb_marker_tracks tracks;
    struct wb_bench_frame frame;

    size_t n_rows;
    struct wb_align_row *rows; /* owned */
    size_t n_dropped_rows;     /* bins that had frames but no row */
    size_t n_held_rows;        /* bins of holds, of which no row is made */
    int n_cycles;

    /* Force. */
    double reading_noise; /* N, standard deviation of a reading */
    double largest;       /* N, largest tension seen (98th percentile) */
    double taut_level;    /* m: tip_y - lean - travel while the strand is taut; NaN unknown */
    size_t n_zeros;
    struct wb_align_zero zeros[WB_ALIGN_MAX_ZEROS];
    bool slack_seen;  /* a zero-load stretch was seen after the tare, so the tare is a true zero */
    double taut_t;    /* s: where the first loading became taut */
    double settled_t; /* s: from here on the filter has settled */
    double carried;   /* N: weights that the strand carries at zero deflection */
    double zero_force, zero_force_deviation; /* N: vertical force at zero deflection */
    double stiffness, stiffness_deviation;   /* N/m: initial slope of the loading curve */
    double speed; /* m/s of bench time: typical deflection rate of the loadings */
};

/* The steps of the alignment, in their order; the context of the first is the recording's path.
 * Each puts its failure into align->why. */
WB_MUST_CHECK enum wb_status wb_align_load(struct wb_align *align, const void *context);
WB_MUST_CHECK enum wb_status wb_align_times(struct wb_align *align);
WB_MUST_CHECK enum wb_status wb_align_markers(struct wb_align *align);
WB_MUST_CHECK enum wb_status wb_align_rows(struct wb_align *align);
WB_MUST_CHECK enum wb_status wb_align_cycles(struct wb_align *align);
void wb_align_stage(struct wb_align *align);
WB_MUST_CHECK enum wb_status wb_align_force(struct wb_align *align);
void wb_align_natural(struct wb_align *align);

/* wb_align_run_signals() from any source: `load` is wb_align_load(), or replaces it in tests, which
 * make specimens without a recording. `signals` may be NULL. */
WB_MUST_CHECK enum wb_status
wb_align_run_from(struct wb_dataset *dataset, struct wb_align_signals *signals,
                  const struct wb_align_settings *settings,
                  enum wb_status (*load)(struct wb_align *align, const void *context),
                  const void *context, struct wb_reason *why);

/* Bench time of a host time, s. */
double wb_align_bench_time(const struct wb_align *align, int64_t host_ns);

/* Mean time between two readings, s; 1 s if there is only one. */
double wb_align_reading_period(const struct wb_align *align);

/* Whether the operator held the test at any time between two bench times. */
bool wb_align_is_held(const struct wb_align *align, double from, double to);

/* Writes the holds into the checks, and warns of holds with a bent wire. */
void wb_align_describe_holds(struct wb_align *align);

/* Uncertainty of zero deflection, m: from the offsets of the clamp's and the tip's marker, and from
 * the vertical over the wire's length. */
double wb_align_level_uncertainty(const struct wb_align *align);

/* --- the document --- */

/* Keys of `bending_plane` of the checks. */
extern const struct wb_keys wb_align_plane_keys;

/* Logs a warning and lists it in the dataset. */
void wb_align_warn(struct wb_align *align, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Adds one correction as "value_UNIT" and "uncertainty_UNIT"; NaN is written as null. `factor`
 * converts that unit to SI. */
struct wb_align_correction {
    const char *name, *unit;
    double factor, value, uncertainty; /* SI */
};
void wb_align_correct(struct wb_align *align, const struct wb_align_correction *correction,
                      const char *note, ...) __attribute__((format(printf, 3, 4)));

/* Sets a number rounded to six digits, for readability. */
void wb_align_set(struct wb_json *object, const char *key, double value);

/* Reads the recording's meta `key` ("rig", "specimen"), or the file `given` if not NULL, into an
 * allocated string; `origin` names the source in messages. */
WB_MUST_CHECK enum wb_status wb_align_given_text(const struct wb_align *align,
                                                 struct wb_recording *recording, const char *key,
                                                 const char *given, char **text,
                                                 char origin[WB_PATH]);

/* Writes the keys in which the given files differ from the recording's own into the recording's
 * entry of dataset.json, and warns of each. */
WB_MUST_CHECK enum wb_status wb_align_given_describe(struct wb_align *align,
                                                     struct wb_recording *recording,
                                                     struct wb_json *entry);

/* Computes the tare again from its readings: the recorded value was read with the unit and scale of
 * the recorded rig. */
WB_MUST_CHECK enum wb_status wb_align_given_tare(struct wb_align *align);

/* Provenance: recording, settings, specimen, rig. */
void wb_align_describe(struct wb_align *align);

#endif
