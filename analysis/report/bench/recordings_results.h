/* The results of a campaign of recordings: each recording aligned, each wire calibrated and
 * validated. Recordings and wires are computed in parallel; the numbers do not depend on the number
 * of threads.
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
#include "base/text.h"
#include "daq/protocol/rig.h"
#include "daq/protocol/specimen.h"

/* Data of one recording. */
struct wb_recordings_results_test {
    const struct wb_recordings_test *wanted; /* borrowed from the campaign */
    bool usable;                             /* it was aligned: `dataset` and `sha256` are valid */
    struct wb_text problem; /* why it is not usable: missing, damaged, altered, ... */
    struct wb_dataset dataset;
    char sha256[WB_SHA256_TEXT]; /* of the uncompressed recording */
    char start_utc[40], tool_revision[64], operator_name[128];
    bool is_virtual;
    struct wb_rig rig; /* of the recording, or its correction; name "" if it could not be read */
    struct wb_specimen specimen;
};

struct wb_recordings_results_tests {
    int n, n_usable;
    struct wb_recordings_results_test *items; /* (n), owned */
};

/* State of a step, the calibration or the validation of a wire. */
enum wb_recordings_results_state {
    WB_RECORDINGS_NOT_WANTED, /* the campaign has no such step */
    WB_RECORDINGS_MISSING,    /* no usable recordings, or no calibration to validate */
    WB_RECORDINGS_FAILED,     /* failed, with the reason in `problem` */
    WB_RECORDINGS_DONE
};

struct wb_recordings_results_step {
    enum wb_recordings_results_state state;
    struct wb_text problem;
    struct wb_recordings_results_tests tests;
    struct wb_validate_result result; /* error of the calibrated beam on `tests`; if done */
};

struct wb_recordings_results_wire {
    const struct wb_recordings_wire *wanted; /* borrowed */
    struct wb_recordings_results_step steps[WB_RECORDINGS_PURPOSES];
    struct wb_calibrate_result calibration; /* by the paper's route, if done */
    struct wb_properties properties;        /* of that calibration, if done */
    /* Calibration on loading and unloading, and its prediction of the validation length. */
    enum wb_recordings_results_state cycle_states[WB_RECORDINGS_PURPOSES];
    struct wb_text cycle_problems[WB_RECORDINGS_PURPOSES];
    struct wb_recordings_cycle cycle;     /* if done */
    struct wb_validate_result prediction; /* zeroed until done */
};

struct wb_recordings_results {
    struct wb_kind_outcome outcome;
    const struct wb_recordings *campaign; /* borrowed; must outlive the results */
    int n_wires;
    struct wb_recordings_results_wire *wires; /* (n_wires), owned */
    struct wb_recordings_cycle_pool pool;     /* degrees 0: not requested, or too few specimens */
    bool any_virtual, all_virtual;            /* of the usable recordings */
    char latest_utc[40];                      /* start of the latest usable recording; "": none */
};

/* Allocates the entries for all recordings, wires and steps, without computing any. */
wb_kind_load wb_recordings_results_load;
/* Aligns, calibrates and validates on `n_threads` threads (0: as many as cores, at most 4). WB_OK
 * even if recordings are missing or steps fail: their entries contain the reasons. */
wb_kind_compute wb_recordings_results_compute;
wb_kind_release wb_recordings_results_release;

/* Returns the recording at an index, NULL after the last. The order is: wire by wire, calibration
 * before validation. Also returns its wire and purpose, unless these pointers are NULL. */
struct wb_recordings_results_test *
wb_recordings_results_at(const struct wb_recordings_results *results, int index,
                         const struct wb_recordings_results_wire **wire,
                         enum wb_recordings_purpose *purpose);

/* The result of a step of a wire; NULL unless it is done. */
const struct wb_validate_result *
wb_recordings_results_of(const struct wb_recordings_results_wire *wire,
                         enum wb_recordings_purpose purpose);

/* The whole-cycle calibration of a wire; NULL unless it is done. */
const struct wb_recordings_cycle *
wb_recordings_results_cycle(const struct wb_recordings_results_wire *wire);

/* The prediction of the validation recordings by the whole-cycle law; NULL unless it is done. */
const struct wb_validate_result *
wb_recordings_results_prediction(const struct wb_recordings_results_wire *wire);

/* The RMS error of a step that is done, relative to F_max; the campaign's limits apply to it. */
double wb_recordings_results_rms(const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose);

/* Uncertainty U (95 %) of that RMS error from the scatter between specimens; NaN if the scatter is
 * unknown. An RMS error is a norm of the difference between two mean curves, so its own error is at
 * most the RMS error of these means. Calibration: Student's t for n - 1 degrees of freedom times
 * the smaller of scatter and residual scatter over sqrt(n). Validation: expected_rms_95 of
 * validate.h. */
double wb_recordings_results_uncertainty(const struct wb_recordings_results_wire *wire,
                                         enum wb_recordings_purpose purpose);

/* Whether the RMS error of a step that is done keeps the campaign's limit, which must be above 0,
 * by the campaign's decision rule. */
bool wb_recordings_results_keeps(const struct wb_recordings *campaign,
                                 const struct wb_recordings_results_wire *wire,
                                 enum wb_recordings_purpose purpose);

/* Capacity of a rig's load cell as a mass, kg, as manufacturers state it; NaN if the rig's gravity
 * is unknown. */
double wb_recordings_results_capacity(const struct wb_rig *rig);

#endif
