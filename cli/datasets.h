/* Datasets of the command line: reads the folders that it names, and prints a dataset that was
 * written. */
#ifndef WB_CLI_DATASETS_H
#define WB_CLI_DATASETS_H

#include "analysis/dataset/dataset.h"
#include "base/status.h"

struct wb_datasets {
    int n;
    struct wb_dataset *items;           /* (n), owned */
    const struct wb_dataset **pointers; /* (n) to the items, for library calls; owned */
};

/* Reads the datasets of these names (n). Rejects tests of other `kinds` (see
 * wb_dataset_read_kinds()) and excluded tests, with name and reason. */
WB_MUST_CHECK enum wb_status wb_datasets_read(struct wb_datasets *datasets,
                                              const char *const *names, int n, unsigned kinds);

void wb_datasets_release(struct wb_datasets *datasets); /* accepts a zeroed one */

/* Prints a dataset's summary and its folder; the same as members of an object. */
void wb_datasets_print(const struct wb_dataset *dataset, const char *folder);
void wb_datasets_describe(struct wb_json *object, const struct wb_dataset *dataset,
                          const char *folder);

#endif
