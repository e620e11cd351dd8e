/* Loading curves on a common grid, their average and band (the paper's Figs. 9b, 13).
 *
 * A test that raises the tip by strand or vertical force is a force over equally spaced
 * deflections. A follower test is a deflection over equally spaced forces: under a growing follower
 * force, which stays normal to the tip, the wire curls up and the deflection has a maximum. Near it
 * the force hardly follows from the deflection, and beyond it two forces have the same one.
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

/* Zero in each: the default. */
struct wb_curve_grid {
    double step;               /* m; 0.5 mm */
    double force_step;         /* N, of follower tests; as the rows of the first sample lie on
                                  average, but at most 100 steps in all */
    double largest_deflection; /* m: what comes later in the loading is left out; nothing */
};

/* Averages the first loading of `n` datasets of one kind (same length, wire and loading; refused
 * otherwise). Each sample's rows within a bin are averaged by a local straight-line fit, so that
 * noise is reduced and a slope makes no bias. Rows marked slack and gaps are left out, and rows of
 * a follower test after its largest force; a bin without rows is interpolated if the rows around it
 * are within 4 steps, else the dataset is refused, and `why` receives why; NULL: that is logged.
 * `grid` NULL: defaults. */
WB_MUST_CHECK enum wb_status wb_curve_average_on(struct wb_curve *curve,
                                                 const struct wb_dataset *const *datasets, int n,
                                                 const struct wb_curve_grid *grid,
                                                 struct wb_reason *why);
/* A follower's curve turned into force over deflection: its rising part, from zero deflection on,
 * where the force is set to zero. It is straight between the grid's points and before the first.
 * WB_ERR_DATA where the deflection does not rise. */
WB_MUST_CHECK enum wb_status wb_curve_turn(struct wb_curve *turned, const struct wb_curve *curve,
                                           double step, struct wb_reason *why);
void wb_curve_release(struct wb_curve *curve);

/* What errors are divided by: max_force, or max_deflection of a follower test. */
double wb_curve_scale(const struct wb_curve *curve);

/* What the scatter between samples is worth: root mean square over the grid of the standard
 * deviation, over wb_curve_scale(); 0 for one sample. */
double wb_curve_scatter(const struct wb_curve *curve);

/* How many rows there are up to the end of the first loading: up to the largest force of a follower
 * test, and up to the largest deflection that is wanted (0: any). */
size_t wb_curve_end_of_loading(const struct wb_dataset *dataset, double largest_deflection);

/* Numbers datasets by kind (wire, length, loading; bench of three-point tests) in the order of
 * their first appearance: group[i] from 0. Returns the number of groups. */
int wb_curve_group(const struct wb_dataset *const *datasets, int n, int *group);

/* Mean of the samples' natural shapes, as far as they are known, and everything else of `info` from
 * the first. */
void wb_curve_mean_info(const struct wb_dataset *const *datasets, int n, struct wb_test_info *info);

/* Warns when some of the samples have a natural shape and others none. */
void wb_curve_warn_unknown_shapes(const struct wb_dataset *const *datasets, int n);

#endif
