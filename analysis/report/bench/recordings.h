/* A campaign of recordings: which wires were tested, in which recordings, how they are calibrated
 * and validated, and within which limits. Its YAML file:
 *
 *     kind: recordings                            # optional, this by default
 *     title: Single wires, types 1 to 3
 *     notes: what a reader should know            # optional
 *     index: ../../recordings/index.yaml          # optional, this by default as shipped data
 *     calibration_length_mm: 85
 *     validation_length_mm: 100                   # optional, absent: no validation
 *     samples: 3                                  # recordings expected for each wire and length
 *     whole_cycle: true                           # optional, false: the paper's route alone
 *     pooled_scatter: false                       # optional, true: intervals of EI also from the
 *                                                 # scatter of all wires' specimens together
 *     settings:                                   # optional, as all of its keys
 *       elastic_zone: 0.05
 *       yield_point: 0.04
 *       step_mm: 0.5
 *       straight: false
 *       restart: true
 *       elements: 50
 *       fibres: 20
 *     limits:                                     # optional, absent: none
 *       calibration_rms_max: 1e-2
 *       validation_rms_max: 3.65e-2
 *     reference:                                  # optional: published figures of merit
 *       source: Fig. 15 of the paper
 *       validation_rms: [1.26e-2, 3.65e-2]
 *     wires:
 *       - wire: type1                             # name in fixtures/wires, or a path
 *         label: Type 1                           # optional, the wire's name by default
 *         reference:                              # optional, the wire file's properties by default
 *           source: Table 3 of the paper
 *           youngs_modulus_MPa: 5021
 *           yield_stress_MPa: 3.90
 *           strength_coefficient_MPa: 3222
 *           hardening_exponent: 0.99
 *         calibration: [my-test.wbr, "S?.wbr.zst"]   # optional: names in the index, paths or
 *         validation: []                          # globs relative to this file; by default the
 *                                                 # index' recordings of this wire and length
 *     excluded:                                   # optional: recordings that are not used
 *       - recording: type1-L85-2.wbr.zst          # its name, as the report has it
 *         by: N. N.
 *         reason: the clamp slipped at 12 mm
 *
 * Reading a campaign finds its recordings. A missing recording is not an error: it is listed with
 * the reason, also in the report. A recording that is excluded by the campaign, its index or the
 * index in the recording's folder is not used; the report states by whom and why.
 */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_H

#include <stdbool.h>

#include "analysis/report/campaign.h"
#include "analysis/validation/validate.h"
#include "base/config.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/status.h"
#include "daq/recording/index.h"
#include "fe/model/wire.h"

/* One recording that the campaign wants. */
struct wb_recordings_test {
    char name[256];     /* file name without folder, or what is missing: "sample 2" */
    char path[WB_PATH]; /* "" when missing */
    char missing[320];  /* why it is missing; "": it exists */
    struct wb_index_exclusion excluded; /* by the campaign or an index; it is reported, but not
                                           used */
    int sample;                         /* number, from the index or by counting; 0 unknown */
    int seed;                           /* from the index; -1 unknown */
    char sha256[WB_SHA256_TEXT];        /* from the index; "": not in the index */
    /* Paths of files that replace the recorded specimen and rig; "": those of the recording. */
    char corrected_specimen[WB_PATH], corrected_rig[WB_PATH];
};

struct wb_recordings_tests {
    int n;
    struct wb_recordings_test *items; /* (n), owned */
};

/* Purpose of recordings. */
enum wb_recordings_purpose {
    WB_RECORDINGS_CALIBRATION,
    WB_RECORDINGS_VALIDATION, /* the campaign may have none */
    WB_RECORDINGS_PURPOSES
};
extern const char *const wb_recordings_purposes[WB_RECORDINGS_PURPOSES]; /* "calibration", ... */

struct wb_recordings_wire {
    char label[64], markup[400];            /* for readers, plain and escaped */
    char file[300], sha256[WB_SHA256_TEXT]; /* of the wire's file, as readers name it */
    struct wb_wire product;
    bool has_reference;
    char reference_source[160];
    struct wb_material reference; /* E, sigma_Y, K and n of it */
    struct wb_recordings_tests tests[WB_RECORDINGS_PURPOSES];
};

struct wb_recordings {
    struct wb_campaign head;
    double length[WB_RECORDINGS_PURPOSES]; /* m; of the validation 0: there is none */
    double limit[WB_RECORDINGS_PURPOSES];  /* of the RMS over F_max; 0: none */
    int samples;
    bool whole_cycle;    /* loading and unloading are calibrated on, beside the paper's route */
    bool pooled_scatter; /* s of ln EI is also pooled over the wires */
    char reference_source[160];
    double reference_rms[2]; /* published range of the validation's RMS; 0: none */
    int n_wires;
    struct wb_recordings_wire *wires; /* (n_wires), owned */
};

/* Reading and release, as wb_kind_keys and wb_kind_release have it. */
WB_MUST_CHECK enum wb_status wb_recordings_keys(void *context, const struct wb_config_node *root);
void wb_recordings_release(void *context);

/* Number of recordings that the campaign requires, and how many of them are missing; excluded ones
 * are not counted. */
int wb_recordings_count(const struct wb_recordings *campaign, int *n_missing);

#endif
