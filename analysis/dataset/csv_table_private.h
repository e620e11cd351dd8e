/* Parts of csv_table.c that tests call by themselves. */
#ifndef WB_ANALYSIS_DATASET_CSV_TABLE_PRIVATE_H
#define WB_ANALYSIS_DATASET_CSV_TABLE_PRIVATE_H

#include "analysis/dataset/csv_table.h"

/* Formats a finite number as wb_csv_table_append_number() does; `text` needs WB_CSV_TABLE_NUMBER
 * bytes. */
void wb_csv_table_format_number(double value, int shift, char *text);

/* Reads a table's text, which is taken apart in place. */
WB_MUST_CHECK enum wb_status wb_csv_table_parse(struct wb_csv_table *table, char *text,
                                                size_t size);

#endif
