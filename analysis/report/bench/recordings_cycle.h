/* The whole-cycle calibration of a wire as a report has it: what analysis/cycle_calibrate.h gives,
 * and what its figures need beyond that.
 *
 * It stands beside the paper's route, which other struct wb_recordings_results_step hold. That it
 * fails is a result, with the reason.
 */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_H

#include <stdbool.h>

#include "analysis/calibration/cycle/cycle_calibrate.h"
#include "analysis/calibration/cycle/cycle_check.h"
#include "analysis/calibration/cycle/cycle_later.h"
#include "analysis/calibration/cycle/cycle_valley.h"
#include "analysis/calibration/cycle/moment_curvature.h"
#include "analysis/dataset/dataset.h"
#include "analysis/keys/keys.h"
#include "base/json.h"
#include "base/reason.h"
#include "base/status.h"

enum {
    WB_RECORDINGS_CYCLE_CURVE = 41 /* curvatures of the law's line, from 0 to the largest */
};

/* M(kappa) of the chosen law: as struct wb_estimate of each curvature. */
struct wb_recordings_cycle_curve {
    double curvature[WB_RECORDINGS_CYCLE_CURVE];                            /* 1/m */
    double moment[WB_RECORDINGS_CYCLE_CURVE];                               /* N m */
    double low[WB_RECORDINGS_CYCLE_CURVE], high[WB_RECORDINGS_CYCLE_CURVE]; /* NaN: one specimen */
};

struct wb_recordings_cycle {
    struct wb_cycle_calibration calibration;
    struct wb_cycle_remarks remarks; /* on the data and what was made of them */
    struct wb_recordings_cycle_curve curve;
    /* Of the specimen with the most cycles; n 0 where none has a second one. */
    struct wb_cycle_later later;
    bool has_valley;
    struct wb_cycle_valley valley; /* of the first specimen */
    /* Of the members: moment over curvature as measured; empty where there are no shapes. */
    struct wb_moment_cloud *clouds; /* (calibration.n_members), owned */
    bool has_comparison;
    struct wb_moment_comparison comparison; /* of the clouds with the law */
};

/* Calibrates on n datasets of a wire, on the calling thread alone. On a failure nothing needs a
 * release; `why` receives the reason. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_run(struct wb_recordings_cycle *cycle,
                                                     const struct wb_dataset *const *datasets,
                                                     int n, struct wb_reason *why);
void wb_recordings_cycle_release(struct wb_recordings_cycle *cycle);

/* Whether no law fits loading and unloading. */
bool wb_recordings_cycle_is_refuted(const struct wb_recordings_cycle *cycle);

/* Keys of a calibration that is done. */
extern const struct wb_keys wb_recordings_cycle_keys;

/* All numbers into an object of report.json. */
void wb_recordings_cycle_put(struct wb_json *object, const struct wb_recordings_cycle *cycle);

/* s of ln EI pooled over wires: that of each specimen about the mean of its own wire. */
struct wb_recordings_cycle_pool {
    double deviation; /* of ln EI; NaN unknown */
    int degrees;      /* of freedom; 0: no wire has two specimens */
};

/* Adds a wire's specimens to sums that begin at zero; then wb_recordings_cycle_close() makes the
 * deviation of them. */
void wb_recordings_cycle_pool(struct wb_recordings_cycle_pool *pool,
                              const struct wb_recordings_cycle *cycle);
void wb_recordings_cycle_close(struct wb_recordings_cycle_pool *pool);

/* What is called stiffness in short: over the first 1 /m during unloading, without unloading from
 * straight to 1 /m; of tests that do not go so far, at the largest curvature that is stated. */
const struct wb_estimate *
wb_recordings_cycle_stiffness(const struct wb_cycle_calibration *calibration);

/* The interval of 95 % that EI has with the pooled deviation; NaN where that is unknown. */
void wb_recordings_cycle_interval(const struct wb_recordings_cycle_pool *pool,
                                  const struct wb_recordings_cycle *cycle, double *low,
                                  double *high);

#endif
