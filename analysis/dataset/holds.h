/* Holds of a test by its operator, as its dataset tells them: `checks.holds` of dataset.json. */
#ifndef WB_ANALYSIS_DATASET_HOLDS_H
#define WB_ANALYSIS_DATASET_HOLDS_H

#include "analysis/dataset/dataset.h"

/* How often the wire was held while it was bent, on a way down or up; *seconds (bench time)
 * receives for how long in all. A hold at rest, where nothing is loaded, does not count. */
int wb_holds_of_bent_wire(const struct wb_dataset *dataset, double *seconds);

#endif
