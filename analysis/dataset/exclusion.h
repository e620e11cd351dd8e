/* What a person left out of a series is no data for properties either: for the command and the
 * library. */
#ifndef WB_ANALYSIS_DATASET_EXCLUSION_H
#define WB_ANALYSIS_DATASET_EXCLUSION_H

#include "analysis/dataset/dataset.h"
#include "base/status.h"

/* WB_ERR_DATA where one of the dataset's recordings was excluded, with who did it and why; `name`
 * is the dataset's in the message. */
WB_MUST_CHECK enum wb_status wb_exclusion_check(const struct wb_dataset *dataset, const char *name);

#endif
