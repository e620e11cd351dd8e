/* Loading curves on a common grid, their average and band (the paper's Figs. 9b, 13).
 *
 * The curve of a test that raises the tip by a strand or a vertical force is force over equally
 * spaced deflections. The curve of a follower test is deflection over equally spaced forces: the
 * force stays normal to the tip, so the wire curls up and the deflection has a maximum. Near the
 * maximum the force is ill-conditioned as a function of the deflection, and beyond it not unique.
 */
#ifndef WB_ANALYSIS_DATASET_CURVE_H
#define WB_ANALYSIS_DATASET_CURVE_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"

/* The first loading, at 0, h, 2h, ... of deflection, or of the force of a follower test. */
struct wb_curve {
    bool is_follower;
    int n;
    double step; /* m between deflections; N between a follower's forces */
    union {      /* (n) mean over the samples; owned */
        double *value;
        double *force;      /* N, not of a follower test */
        double *deflection; /* m, of a follower test */
    };
    double *low, *high; /* (n) as value: smallest and largest sample; owned */
    double *deviation;  /* (n) as value: standard deviation over the samples (n - 1); 0 for one */
    int n_samples;
    double max_deflection; /* m, the largest that every sample reaches; the largest of a follower's
                              `deflection` */
    double max_force;      /* N, the largest of `force`: F_max of eq. 18; a follower's largest */
};

/* 0 in a field: its default. */
struct wb_curve_grid {
    double step;               /* m; 0.5 mm */
    double force_step;         /* N, of follower tests; as the rows of the first sample lie on
                                  average, but at most 100 steps in all */
    double largest_deflection; /* m: loading beyond it is left out; default: nothing */
};

/* Averages the first loading of `n` datasets of one kind (same length, wire and loading; others are
 * rejected). The rows of a sample within a bin are averaged by a local straight-line fit, which
 * reduces noise without bias by the slope. Slack rows, gaps, and rows of a follower test after its
 * largest force are left out. A bin without rows is interpolated if the rows around it are within 4
 * steps; otherwise the dataset is rejected. `why` receives the reason; NULL: it is logged. `grid`
 * NULL: defaults. */
WB_MUST_CHECK enum wb_status wb_curve_average_on(struct wb_curve *curve,
                                                 const struct wb_dataset *const *datasets, int n,
                                                 const struct wb_curve_grid *grid,
                                                 struct wb_reason *why);
/* Converts the curve of a follower test to force over deflection: its rising part, from zero
 * deflection, where the force is set to zero. It is linear between the grid's points and before the
 * first. WB_ERR_DATA where the deflection does not rise. */
WB_MUST_CHECK enum wb_status wb_curve_turn(struct wb_curve *turned, const struct wb_curve *curve,
                                           double step, struct wb_reason *why);
void wb_curve_release(struct wb_curve *curve);

/* Reference for relative errors: max_force, or max_deflection of a follower test. */
double wb_curve_scale(const struct wb_curve *curve);

/* Scatter between samples: root mean square over the grid of the standard deviation, over
 * wb_curve_scale(); 0 for one sample. */
double wb_curve_scatter(const struct wb_curve *curve);

/* Number of rows up to the end of the first loading: up to the largest force of a follower test, or
 * up to the given largest deflection (0: any). */
size_t wb_curve_end_of_loading(const struct wb_dataset *dataset, double largest_deflection);

/* Numbers datasets by kind (wire, length, loading; bench of three-point tests) in the order of
 * their first appearance: group[i] from 0. Returns the number of groups. */
int wb_curve_group(const struct wb_dataset *const *datasets, int n, int *group);

/* Returns the `info` of the first sample with the mean of the known natural shapes. */
void wb_curve_mean_info(const struct wb_dataset *const *datasets, int n, struct wb_test_info *info);

/* Warns when some samples have a natural shape and others do not. */
void wb_curve_warn_unknown_shapes(const struct wb_dataset *const *datasets, int n);

#endif
