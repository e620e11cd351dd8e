/* A simulated test as a dataset: the same rows and shapes as a measured one.
 *
 * Bench time is the time in which a stage at 1 mm/s would have made the way. Shapes hold as many
 * equally spaced positions as the history recorded, as if they were markers.
 */
#ifndef WB_ANALYSIS_SIMULATED_H
#define WB_ANALYSIS_SIMULATED_H

#include "analysis/dataset.h"
#include "base/status.h"
#include "fe/history.h"

/* How the simulation was made, for dataset.json. */
struct wb_simulated_origin {
    const char *model;  /* "cantilever" */
    const char *law;    /* "elastic" or "elastoplastic" */
    const char *source; /* where the properties come from */
    const struct wb_material *material;
    double wall, cpu; /* s */
};

/* Fills an initialised dataset. `shape_s` are the arc lengths of the history's plan, m. */
WB_MUST_CHECK enum wb_status wb_simulated_fill(struct wb_dataset *dataset,
                                               const struct wb_test_info *info,
                                               const struct wb_history *history,
                                               const double *shape_s,
                                               const struct wb_simulated_origin *origin);

#endif
