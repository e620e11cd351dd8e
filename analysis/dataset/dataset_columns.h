/* A dataset's rows as tables in memory: those of force_deflection.csv and shape.csv, with lengths
 * in metres. */
#ifndef WB_ANALYSIS_DATASET_DATASET_COLUMNS_H
#define WB_ANALYSIS_DATASET_DATASET_COLUMNS_H

#include "analysis/dataset/dataset.h"
#include "base/columns.h"

enum {
    WB_DATASET_COLUMNS_FORCE_DEFLECTION,
    WB_DATASET_COLUMNS_SHAPE,
    WB_DATASET_COLUMNS_TABLES
};

/* The table's name, "force_deflection" or "shape"; -1 for another one. */
int wb_dataset_columns_find(const char *name);

/* The caller releases each table. */
void wb_dataset_columns_make(struct wb_columns tables[WB_DATASET_COLUMNS_TABLES],
                             const struct wb_dataset *dataset);

#endif
