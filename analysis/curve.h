/* Loading curves on a common deflection grid, their average and band (the paper's Figs. 9b, 13). */
#ifndef WB_ANALYSIS_CURVE_H
#define WB_ANALYSIS_CURVE_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/dataset.h"
#include "base/status.h"

/* Force at equally spaced deflections 0, h, 2h, ... of the first loading. */
struct wb_curve {
    int n;
    double step;        /* m between deflections */
    double *force;      /* (n) N, mean over the samples; owned */
    double *low, *high; /* (n) N, smallest and largest sample; owned */
    double *deviation;  /* (n) N, standard deviation over the samples (n - 1); 0 for one sample */
    int n_samples;
    double max_deflection; /* m, (n - 1) step: the largest that every sample reaches */
    double max_force;      /* N, the largest of `force`: F_max of eq. 18 */
};

/* Averages the first loading of `n` datasets of one kind (same length and wire; refused
 * otherwise). `step` 0 takes 0.5 mm. Each sample's rows within a bin are averaged by a local
 * straight-line fit, so that noise is reduced and a slope makes no bias. Rows marked slack and gaps
 * are left out; a bin without rows is interpolated if the rows around it are within 4 steps, else
 * the dataset is refused. */
WB_MUST_CHECK enum wb_status wb_curve_average(struct wb_curve *curve,
                                              const struct wb_dataset *const *datasets, int n,
                                              double step);
void wb_curve_release(struct wb_curve *curve);

/* Linear interpolation of the mean force at a deflection within 0..max_deflection; NaN outside. */
double wb_curve_force(const struct wb_curve *curve, double deflection);

/* What the scatter between samples is worth: root mean square over deflection of the standard
 * deviation, over max_force; 0 for one sample. */
double wb_curve_scatter(const struct wb_curve *curve);

/* Same wire and same length: tests that may be averaged. */
bool wb_curve_same_kind(const struct wb_test_info *a, const struct wb_test_info *b);

/* Numbers datasets by kind in the order of their first appearance: group[i] from 0. Returns the
 * number of groups. */
int wb_curve_group(const struct wb_dataset *const *datasets, int n, int *group);

/* Mean of the samples' natural shapes, and everything else of `info` from the first. */
/* The mean natural shape is that of the samples whose shape is known. */
void wb_curve_mean_info(const struct wb_dataset *const *datasets, int n, struct wb_test_info *info);

/* Warns when some of the samples have a natural shape and others none. */
void wb_curve_warn_unknown_shapes(const struct wb_dataset *const *datasets, int n);

#endif
