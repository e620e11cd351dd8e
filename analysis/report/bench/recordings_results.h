/* The results of a campaign of recordings: each recording aligned, each wire calibrated and
 * validated. Recordings and wires are computed in parallel on several threads; the numbers do not
 * depend on how many.
 */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_H

#include <stdbool.h>

#include "analysis/calibration/paper/calibrate.h"
#include "analysis/dataset/dataset.h"
#include "analysis/report/bench/recordings.h"
#include "analysis/report/bench/recordings_cycle.h"
#include "analysis/report/kind.h"
#include "analysis/validation/validate.h"
#include "base/status.h"
#include "base/text.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"

/* One recording as the report knows it. */
struct wb_recordings_results_test {
    const struct wb_recordings_test *wanted; /* borrowed from the campaign */
    bool usable;                             /* aligned: `dataset` and `sha256` are there */
    struct wb_text problem;                  /* why not: missing, damaged, altered, ... */
    struct wb_dataset dataset;
    char sha256[WB_SHA256_TEXT]; /* of the uncompressed recording */
    char start_utc[40], tool_revision[64], operator_name[128];
    bool is_virtual;
    struct wb_rig rig; /* of its own meta; name "" when it could not be read */
    struct wb_specimen specimen;
};

struct wb_recordings_results_tests {
    int n, n_usable;
    struct wb_recordings_results_test *items; /* (n), owned */
};

/* How a step of a wire ended. */
enum wb_recordings_results_state {
    WB_RECORDINGS_NOT_WANTED, /* the campaign has no such step */
    WB_RECORDINGS_MISSING,    /* no usable recordings, or the step before it failed */
    WB_RECORDINGS_FAILED,     /* refused, with the reason in `problem` */
    WB_RECORDINGS_DONE
};

struct wb_recordings_results_step {
    enum wb_recordings_results_state state;
    struct wb_text problem;
    struct wb_recordings_results_tests tests;
    struct wb_validate_result result; /* the calibrated beam on the curves of `tests`, when done */
};

struct wb_recordings_results_wire {
    const struct wb_recordings_wire *wanted; /* borrowed */
    struct wb_recordings_results_step steps[WB_RECORDINGS_PURPOSES];
    struct wb_calibrate_result calibration; /* when it is done, as the next */
    struct wb_properties properties;
    /* The same on whole cycles: the calibration, and what its law predicts of the other length. */
    enum wb_recordings_results_state cycle_states[WB_RECORDINGS_PURPOSES];
    struct wb_text cycle_problems[WB_RECORDINGS_PURPOSES];
    struct wb_recordings_cycle cycle;     /* when it is done */
    struct wb_validate_result prediction; /* zeroed until it is done */
};

struct wb_recordings_results {
    struct wb_kind_outcome outcome;
    const struct wb_recordings *campaign; /* borrowed; must outlive the results */
    int n_wires;
    struct wb_recordings_results_wire *wires; /* (n_wires), owned */
    struct wb_recordings_cycle_pool pool;     /* degrees 0 where the campaign asks for none */
    bool any_virtual, all_virtual;            /* of the recordings that were used */
    char latest_utc[40];                      /* start of the latest recording; "" without any */
};

/* Prepares zeroed results: all places, with nothing in them. */
wb_kind_load wb_recordings_results_load;
/* Computes everything, on `n_threads` threads (0: as many as cores, 4 at most). WB_OK also when
 * recordings are missing or steps failed: the results say so. */
wb_kind_compute wb_recordings_results_compute;
wb_kind_release wb_recordings_results_release;

/* The recording at an index, over all wires, of each those of the calibration first, with its wire
 * and purpose (NULL: not asked for); NULL after the last. */
struct wb_recordings_results_test *
wb_recordings_results_at(const struct wb_recordings_results *results, int index,
                         const struct wb_recordings_results_wire **wire,
                         enum wb_recordings_purpose *purpose);

/* What a step of a wire gave; NULL unless it is done. */
const struct wb_validate_result *
wb_recordings_results_of(const struct wb_recordings_results_wire *wire,
                         enum wb_recordings_purpose purpose);

/* The whole-cycle calibration of a wire; NULL unless it is done. */
const struct wb_recordings_cycle *
wb_recordings_results_cycle(const struct wb_recordings_results_wire *wire);

/* What its law predicts of the validation's recordings; NULL unless it is done. */
const struct wb_validate_result *
wb_recordings_results_prediction(const struct wb_recordings_results_wire *wire);

/* The RMS error over F_max of a step that is done: what limits bound. */
double wb_recordings_results_rms(const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose);

/* Its uncertainty U by the scatter between specimens, of a coverage of 95 % (Student's t); NaN with
 * one specimen. An RMS is a norm of the difference of two curves, so it is off by no more than the
 * RMS of what the means of a few specimens are off: that is U. */
double wb_recordings_results_uncertainty(const struct wb_recordings_results_wire *wire,
                                         enum wb_recordings_purpose purpose);

/* Whether it keeps the campaign's limit, which is above 0, by the campaign's decision rule. */
bool wb_recordings_results_keeps(const struct wb_recordings *campaign,
                                 const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose);

/* Capacity of a rig's load cell as its maker states it: the mass, kg, that weighs so much under the
 * rig's gravity; NaN when that is not known. */
double wb_recordings_results_capacity(const struct wb_rig *rig);

/* How much of a validation's mean square error the scatter between samples explains at most, 0 to
 * 1; NaN where it is not known. Both means scatter: that of the curve it is compared with and that
 * of the curves the model was calibrated on. With r the smaller of the RMS over deflection of the
 * samples' standard deviation and of what remains of it when each is predicted with its own natural
 * shape, over F_max, and n samples, it is (r_v^2/n_v + r_c^2/n_c) / RMS^2, at most 1. What remains
 * holds the model's own error with the bow, hence the bound. A calibration has none: its curve is
 * fitted, whatever its scatter. */
double wb_recordings_results_validation_share(const struct wb_recordings_results_wire *wire);

#endif
