/* Dataset folders named on the command line, read together. */
#ifndef WB_CLI_DATASETS_H
#define WB_CLI_DATASETS_H

#include "analysis/dataset.h"
#include "base/status.h"

struct wb_datasets {
    int n;
    const char **names;                 /* (n) as given; borrowed texts, owned array */
    struct wb_dataset *items;           /* (n), owned */
    const struct wb_dataset **pointers; /* (n) to the items, as the library wants them; owned */
};

/* Remembers one more name. */
WB_MUST_CHECK enum wb_status wb_datasets_add(struct wb_datasets *datasets, const char *name);

/* Reads all of them. */
WB_MUST_CHECK enum wb_status wb_datasets_read(struct wb_datasets *datasets);

void wb_datasets_release(struct wb_datasets *datasets); /* accepts a zeroed one */

#endif
