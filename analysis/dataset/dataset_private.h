/* Parts of dataset.c that tests call by themselves. */
#ifndef WB_ANALYSIS_DATASET_DATASET_PRIVATE_H
#define WB_ANALYSIS_DATASET_DATASET_PRIVATE_H

#include <stddef.h>

#include "analysis/dataset/dataset.h"
#include "base/reason.h"
#include "base/status.h"

/* Appends the rows of a table's text of n bytes and a NUL, which is taken apart in place; `path` is
 * for messages. */
WB_MUST_CHECK enum wb_status wb_dataset_parse_rows(struct wb_dataset *dataset, const char *path,
                                                   char *text, size_t n, struct wb_reason *why);
WB_MUST_CHECK enum wb_status wb_dataset_parse_shapes(struct wb_dataset *dataset, const char *path,
                                                     char *text, size_t n, struct wb_reason *why);

#endif
