/* A dataset of a campaign of bundles: read, checked against its bundle and the run's settings, with
 * the data of its computation; and the published curve for comparison.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_RUN_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_RUN_H

#include <stdbool.h>

#include "analysis/dataset/curve.h"
#include "analysis/dataset/dataset.h"
#include "analysis/dataset/surface.h"
#include "analysis/report/bundles/bundles.h"
#include "base/reason.h"

/* A row of energies.csv, J. */
struct wb_bundles_energy {
    double deflection, time; /* m; s, of the model */
    double external, kinetic, internal, artificial, friction;
};

/* Data of a dataset on its computation; NaN where it has none. */
struct wb_bundles_numbers {
    double elements, shells, steps, time_step, duration, ns; /* s, ns */
    double kinetic, artificial, imbalance, strain; /* largest ratios, see fe/bundle/bundle_run.h */
    double penetration;                            /* m */
};

struct wb_bundles_result {
    struct wb_simulation_result simulation;
    /* Of a usable run; a 1D beam has only its simulation: */
    struct wb_bundles_numbers numbers;
    bool beyond; /* a strain beyond the range of the elements' logarithm */
    int n_energies;
    struct wb_bundles_energy *energies; /* (n_energies), owned; none without energies.csv */
    struct wb_surface surface;          /* bent; no bodies without surface.csv */
    struct wb_curve curve;              /* the loading */
    /* The published beam under the run's own loading, where there is one; (curve.n), owned. */
    double *published; /* N; NaN from n_published on */
    int n_published;
    double published_max; /* N, its largest force: divisor of errors */
    double *error;        /* of the run from it, over published_max */
    double rms, max_error;
};

/* Reads the dataset of a run into a zeroed result. An error is kept in the result. */
void wb_bundles_run_load(struct wb_bundles_result *result, const struct wb_bundles_run *run);
void wb_bundles_run_release(struct wb_bundles_result *result); /* accepts a zeroed one */

/* The part of them that concerns the loading curve: averages the usable dataset's loading on the
 * fit's grid and computes the published curve on it. */
WB_MUST_CHECK enum wb_status wb_bundles_run_compare(struct wb_bundles_result *result,
                                                    const struct wb_bundles_run *run,
                                                    const struct wb_calibrate_settings *fit,
                                                    struct wb_reason *why);

/* Forces of the 1D beam of a material on the grid of the run's curve, N, (curve.n); NaN from
 * *n_reached on. Diameter and weight are those of `info`. */
WB_MUST_CHECK enum wb_status
wb_bundles_run_beam(double *force, int *n_reached, const struct wb_bundles_result *result,
                    const struct wb_test_info *info, const struct wb_material *material,
                    const struct wb_calibrate_settings *fit, struct wb_reason *why);

/* Cost of a run relative to others: its elements, twice as many where the duration must be found
 * first. */
double wb_bundles_run_cost(const struct wb_bundles_run *run);

#endif
