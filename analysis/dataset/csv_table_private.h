/* A part of csv_table.c that tests call by itself. */
#ifndef WB_ANALYSIS_DATASET_CSV_TABLE_PRIVATE_H
#define WB_ANALYSIS_DATASET_CSV_TABLE_PRIVATE_H

#include "analysis/dataset/csv_table.h"

/* Reads a table's text, which is taken apart in place. */
WB_MUST_CHECK enum wb_status wb_csv_table_parse(struct wb_csv_table *table, char *text,
                                                size_t size);

#endif
