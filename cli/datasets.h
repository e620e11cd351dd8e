/* Datasets of the command line: folders that it names, read together, and what is said of a dataset
 * that was written. */
#ifndef WB_CLI_DATASETS_H
#define WB_CLI_DATASETS_H

#include "analysis/dataset/dataset.h"
#include "base/status.h"

struct wb_datasets {
    int n;
    struct wb_dataset *items;           /* (n), owned */
    const struct wb_dataset **pointers; /* (n) to the items, as the library wants them; owned */
};

/* Reads those of the names (n); `kinds` of test as of wb_dataset_read_kinds(), others are refused,
 * and so are those of a test that was excluded, with who and why. */
WB_MUST_CHECK enum wb_status wb_datasets_read(struct wb_datasets *datasets,
                                              const char *const *names, int n, unsigned kinds);

void wb_datasets_release(struct wb_datasets *datasets); /* accepts a zeroed one */

/* Prints a dataset's summary and its folder; the same as members of an object. */
WB_MUST_CHECK enum wb_status wb_datasets_print(const struct wb_dataset *dataset,
                                               const char *folder);
void wb_datasets_describe(struct wb_json *object, const struct wb_dataset *dataset,
                          const char *folder);

#endif
