/* The findings of a computed harness: largest force, least radius, residual shape, limits, and
 * what the results cannot be trusted for. One loop over all steps, for the terminal and the report.
 */
#ifndef WB_ANALYSIS_HARNESS_HARNESS_FOUND_H
#define WB_ANALYSIS_HARNESS_HARNESS_FOUND_H

#include <stdbool.h>

#include "analysis/harness/harness_run.h"

/* Where and when a value is found. */
struct wb_harness_extreme {
    double value; /* SI */
    int of;       /* item or branch */
    int step;
    double at; /* m, along the branch; of an item 0 */
};

struct wb_harness_found {
    struct wb_harness_extreme force;    /* largest during a step, N */
    struct wb_harness_extreme radius;   /* least at the end of a step, m; INFINITY: straight */
    bool is_taken_off;                  /* the last step was computed and took the harness off */
    struct wb_harness_extreme residual; /* then: largest distance from the stress-free shape, m */
    int n_limits, n_exceeded;           /* that the file states */
    int n_snaps;
    int n_beyond; /* branches bent beyond the calibration of their wire */
    int n_twist;  /* items with a force that depends on an unmeasured torsional stiffness */
};

void wb_harness_found_collect(struct wb_harness_found *found,
                              const struct wb_harness_result_set *set);

/* The place that is farthest from the stress-free shape after a step. */
int wb_harness_found_farthest(const struct wb_harness_result_set *set, int step);

/* Whether a branch was bent beyond the calibration in any step. */
bool wb_harness_found_is_beyond(const struct wb_harness_result_set *set, int branch);

/* Largest force and moment on an item during any step, N and N m. */
void wb_harness_found_largest(const struct wb_harness_result_set *set, int item,
                              struct wb_harness_extreme *force, struct wb_harness_extreme *moment);

/* Least radius of a branch at the end of a step, m; INFINITY: it is straight in all. */
struct wb_harness_extreme wb_harness_found_radius(const struct wb_harness_result_set *set,
                                                  int branch);

/* The first step in which the limit of a branch's radius was exceeded; -1: none. */
int wb_harness_found_exceeds_radius(const struct wb_harness_result_set *set, int branch);

/* Whether a force depends on a torsional stiffness that is not measured: at a fifth of it the force
 * differs by more than 10 %. */
bool wb_harness_found_is_twist_sensitive(const struct wb_harness_force *force);

#endif
