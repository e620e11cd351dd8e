/* Sensitivity of the result of many runs to their inputs: linear regression of its ranks on the
 * ranks of the inputs (Iman and Conover, Technometrics 21:499, 1979), which describes any monotonic
 * dependence.
 *
 * The share of a group is the decrease of R2 without the group's inputs. Groups are drawn
 * independently, so that shares nearly add up to R2; inputs within a group may depend on each
 * other, also linearly. Intervals come from resampled runs (Efron's bootstrap, percentiles of 5 and
 * 95 %).
 */
#ifndef WB_ANALYSIS_PREDICT_RANKING_H
#define WB_ANALYSIS_PREDICT_RANKING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"

enum {
    WB_RANKING_GROUPS = 32,
    WB_RANKING_COLUMNS = 96
};

struct wb_ranking_share {
    int group;
    double share, low, high; /* of the ranks' variance, 1 */
};

struct wb_ranking {
    double r2, low, high; /* of all inputs */
    bool is_valid;        /* R2 is at least 0.9; below, shares mean little */
    int n_groups;         /* groups that vary, in descending order of their shares */
    struct wb_ranking_share group[WB_RANKING_GROUPS];
};

/* n runs (at least four more than columns) with their inputs. */
struct wb_ranking_data {
    int n, n_columns, n_groups;
    const double *columns; /* (n x n_columns) */
    const int *group;      /* (n_columns) 0 to n_groups - 1 */
    const double *result;  /* (n) */
    uint64_t seed;         /* of the resampling */
};

/* Fails if there are too few runs or too many inputs. */
WB_MUST_CHECK enum wb_status wb_ranking_compute(struct wb_ranking *ranking,
                                                const struct wb_ranking_data *data);

#endif
