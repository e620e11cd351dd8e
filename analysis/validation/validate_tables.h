/* Tables of validations, as CSV. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_TABLES_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_TABLES_H

#include "analysis/dataset/dataset.h"
#include "base/text.h"

/* Appends a row of n numbers; those that are not finite become empty fields. */
void wb_validate_tables_put_row(struct wb_text *text, const double *values, size_t n);

/* Appends the first line: origin of the data, of n samples. */
void wb_validate_tables_put_origin(struct wb_text *text, const struct wb_test_info *info, int n);

/* Appends a row of scores.csv with three values: wire,length_mm,score,measured,computed,error,unit;
 * and its heading. */
void wb_validate_tables_put_score(struct wb_text *text, const struct wb_test_info *info,
                                  const char *score, const double values[3], const char *unit);
void wb_validate_tables_put_heading(struct wb_text *text);

/* Writes the table to a file, replacing an existing one by an atomic rename, and releases it. */
WB_MUST_CHECK enum wb_status wb_validate_tables_write(struct wb_text *text, const char *path);

#endif
