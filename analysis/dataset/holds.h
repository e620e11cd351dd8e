/* Holds of a test by its operator, from `checks.holds` of dataset.json. */
#ifndef WB_ANALYSIS_DATASET_HOLDS_H
#define WB_ANALYSIS_DATASET_HOLDS_H

#include "analysis/dataset/dataset.h"

/* Number of holds while the wire was bent, during loading or unloading; *seconds (bench time)
 * receives their total duration. Holds at rest, without load, do not count. */
int wb_holds_of_bent_wire(const struct wb_dataset *dataset, double *seconds);

#endif
