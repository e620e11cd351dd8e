/* The two tables of a dataset as CSV text. Used by dataset.c, its numbers by fields.c too.
 *
 * Strict: comma-separated, no quotes, comment lines ('#') only at the begin ("# virtual rig" where
 * the data come from it), a header line with the columns' names, every line with as
 * many fields as the header, numbers as plain decimals. Errors name file, line and column. Lengths
 * stand in millimetres; the decimal point is moved in the text, not in binary, so that every
 * double comes back bit for bit.
 */
#ifndef WB_ANALYSIS_DATASET_CSV_H
#define WB_ANALYSIS_DATASET_CSV_H

#include <stdbool.h>
#include <stddef.h>

#include "analysis/dataset.h"
#include "base/status.h"
#include "base/text.h"

/* Appends both tables. WB_ERR_ARGUMENT when a row lacks time, deflection or force. */
WB_MUST_CHECK enum wb_status wb_dataset_csv_format(const struct wb_dataset *dataset,
                                                   struct wb_text *rows, struct wb_text *shapes);

/* Appends the rows of a table's text, which is taken apart in place; `path` is for messages. */
WB_MUST_CHECK enum wb_status wb_dataset_csv_parse_rows(struct wb_dataset *dataset, const char *path,
                                                       char *text, size_t n);
WB_MUST_CHECK enum wb_status wb_dataset_csv_parse_shapes(struct wb_dataset *dataset,
                                                         const char *path, char *text, size_t n);

/* A finite double times 10^shift as shortest decimal text that wb_dataset_csv_parse_number() turns
 * back into the same double; `text` needs WB_DATASET_CSV_NUMBER bytes. */
#define WB_DATASET_CSV_NUMBER 64
void wb_dataset_csv_format_number(double value, int shift, char *text);
/* False when the whole text is not one finite decimal number. */
bool wb_dataset_csv_parse_number(const char *text, int shift, double *value);

#endif
