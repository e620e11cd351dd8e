/* A campaign of predictions: bundles with their bands (analysis/predict/bands.h), and tests that
 * are compared with them. Its YAML file:
 *
 *     kind: prediction
 *     title: The harness before it is bent
 *     notes: what a reader should know       # optional
 *     runs: 500                              # optional: of each case
 *     seed: 1                                # optional: of the draws
 *     bundles:
 *       - bundle: template                   # name in fixtures/bundles, or a path; its file states
 *                                            # what is uncertain
 *         label: Seven wires                 # optional, the file's title by default
 *         tests:                             # optional: datasets of such bundles
 *           - {dataset: ./bundle-1, label: first, case: one-layer}   # case: the file by default
 *
 * A test that is not there is no error: the report says so.
 */
#ifndef WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_H
#define WB_ANALYSIS_REPORT_PREDICTIONS_PREDICTIONS_H

#include "analysis/dataset/dataset.h"
#include "analysis/predict/bands.h"
#include "analysis/report/campaign.h"
#include "analysis/report/kind.h"
#include "analysis/report/simulation.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "fe/model/bundle_model.h"

enum {
    WB_PREDICTIONS_BUNDLES = 16,
    WB_PREDICTIONS_TESTS = 16, /* of a bundle */
    WB_PREDICTIONS_PLACES = 4  /* force at a third, two thirds and all of the way; springback */
};

/* --- the file --- */

struct wb_predictions_test {
    char label[64], case_name[64];
    char given[300], path[WB_PATH]; /* of its dataset; given: as the file has it */
};

struct wb_predictions_bundle {
    char label[160], model_name[300];
    struct wb_bundle_model *model; /* owned */
    int n_tests;
    struct wb_predictions_test tests[WB_PREDICTIONS_TESTS];
};

struct wb_predictions {
    struct wb_campaign head;
    int runs, seed;
    int n_bundles;
    struct wb_predictions_bundle bundles[WB_PREDICTIONS_BUNDLES];
};

wb_kind_keys wb_predictions_keys;
wb_kind_release wb_predictions_release;

/* --- results --- */

enum wb_predictions_side {
    WB_PREDICTIONS_BELOW = -1,
    WB_PREDICTIONS_WITHIN = 0,
    WB_PREDICTIONS_ABOVE = 1,
    WB_PREDICTIONS_UNKNOWN = 2 /* the test or the band does not reach this place */
};

/* A number of a test beside its band. */
struct wb_predictions_place {
    double at; /* m; NaN: springback */
    double measured;
    struct wb_bands_interval band;
    enum wb_predictions_side side;
};

struct wb_predictions_verdict {
    enum wb_simulation_state state;
    struct wb_text problem;
    char sha256[WB_SHA256_TEXT]; /* of its force_deflection.csv */
    struct wb_dataset dataset;   /* of a usable one, as all that follows */
    const struct wb_bands_case *against;
    struct wb_predictions_place places[WB_PREDICTIONS_PLACES];
    int n_outside;     /* places outside their bands */
    const char *words; /* judgement from all places */
};

struct wb_predictions_prediction {
    struct wb_bands *bands; /* NULL: none, see `problem` */
    struct wb_text problem;
    struct wb_predictions_verdict tests[WB_PREDICTIONS_TESTS];
};

struct wb_predictions_results {
    struct wb_kind_outcome outcome;
    const struct wb_predictions *campaign; /* borrowed */
    struct wb_predictions_prediction bundles[WB_PREDICTIONS_BUNDLES];
};

wb_kind_load wb_predictions_results_load;
wb_kind_compute wb_predictions_results_compute;
wb_kind_release wb_predictions_results_release;

#endif
