/* Prediction of a test beyond its first loading: the unloading, the residual deflection, and the
 * work lost in later cycles.
 *
 * Each sample is computed separately (analysis/calibration/cycle/cycle_model.h) with the bow of its
 * dataset, over the deflections of all its cycles. Measured and computed tensions are each compared
 * less their own value at zero deflection on the first loading, so that an error of the bow does
 * not count as an error of the law. The mean over the samples is scored, as for the loading curve,
 * because a law describes the product.
 */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_CYCLE_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_CYCLE_H

#include <stdbool.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/law.h"

enum {
    WB_VALIDATE_MOST_LOOPS = 16
};

/* A cycle after the first. `measured` and `computed` are the work of the tension over the
 * deflections that both branches have, J, mean over the samples. */
struct wb_validate_loop {
    int cycle, n_samples;
    double measured, computed;
};

struct wb_validate_cycles {
    double clamp_curvature; /* 1/m: largest computed one of all samples; NaN: unknown */
    int n_samples;          /* samples with an unloading that was computed to its end */
    struct wb_reason why;   /* why a sample was not computed; empty if all were */

    /* The mean unloading, downwards at every mm that all samples have. */
    int n;
    double *deflection;        /* (n) m; owned, and its memory also holds: */
    double *measured;          /* (n) N, */
    double *computed;          /* (n) N, both less the tension at zero deflection */
    double rms, largest_error; /* of their differences over F_max */
    double sample_rms;         /* pooled over the points of all samples, over F_max */
    /* With the law as stiff as each sample's own first loading, of n_adapted samples: root mean
     * square over the unloading of the mean difference over the samples, and of the standard
     * deviation between them, over F_max; NaN unknown. */
    double adapted_rms, adapted_scatter;
    int n_adapted;

    /* Deflection at which the tension during unloading has fallen to that at zero deflection, m:
     * means over the samples that reach it; NaN: none does. */
    double residual_measured, residual_computed;
    /* As above, of n_residuals samples, at least two: mean of computed less measured, and standard
     * deviation between them, m; NaN unknown. */
    double adapted_residual, residual_scatter;
    int n_residuals;

    int n_loops;
    struct wb_validate_loop loops[WB_VALIDATE_MOST_LOOPS];
};

/* The change of ln(stiffness) for difference quotients; forces are linear over it. */
extern const double wb_validate_stiffer_by;

/* The law of a stiffer wire: its moment at any curvature is exp(ln_factor) times as large. */
struct wb_law wb_validate_stiffer(const struct wb_law *law, double ln_factor);

struct wb_validate_cycle_settings {
    bool straight;            /* ignore the bows */
    int n_elements, n_fibres; /* 0: 50, 20 */
    double max_force;         /* N: F_max, by which errors are divided */
};

/* Predicts the cycles of n datasets of one kind; follower tests have no cycles. A sample that
 * cannot be computed is left out, see `why`. Fails only for an invalid law. */
WB_MUST_CHECK enum wb_status
wb_validate_cycles_run(struct wb_validate_cycles *cycles, const struct wb_law *law,
                       const struct wb_dataset *const *datasets, int n,
                       const struct wb_validate_cycle_settings *settings);
void wb_validate_cycles_release(struct wb_validate_cycles *cycles); /* accepts a zeroed one */

#endif
