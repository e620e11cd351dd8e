/* Tables of validations, as CSV. */
#ifndef WB_ANALYSIS_VALIDATION_VALIDATE_TABLES_H
#define WB_ANALYSIS_VALIDATION_VALIDATE_TABLES_H

#include "analysis/dataset/dataset.h"
#include "base/text.h"

/* A number, or an empty field when there is none, and what stands behind it. */
void wb_validate_tables_put(struct wb_text *text, double value, char end);

/* The first line: whose data they are, of n samples. */
void wb_validate_tables_put_origin(struct wb_text *text, const struct wb_test_info *info, int n);

/* A row of scores.csv: wire,length_mm,score,measured,computed,error,unit, with the three values;
 * and the line above all rows. */
void wb_validate_tables_put_score(struct wb_text *text, const struct wb_test_info *info,
                                  const char *score, const double values[3], const char *unit);
void wb_validate_tables_put_heading(struct wb_text *text);

#endif
