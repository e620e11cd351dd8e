/* Rejects datasets of excluded tests, for the calibration by the command and by the library. */
#ifndef WB_ANALYSIS_DATASET_EXCLUSION_H
#define WB_ANALYSIS_DATASET_EXCLUSION_H

#include "analysis/dataset/dataset.h"
#include "base/status.h"

/* WB_ERR_DATA, with who excluded the test and why, where a recording of the dataset is excluded.
 * `name` is the dataset's name in the message. */
WB_MUST_CHECK enum wb_status wb_exclusion_check(const struct wb_dataset *dataset, const char *name);

#endif
