/* Two batches compared, as one page of PDF: numbers, ratios with their intervals, verdicts. */
#ifndef WB_ANALYSIS_REPORT_COMPARED_H
#define WB_ANALYSIS_REPORT_COMPARED_H

#include <stdbool.h>

#include "analysis/compare/compare.h"
#include "base/hash.h"
#include "base/status.h"

struct wb_compared {
    const struct wb_compare *compare;
    const struct wb_properties *properties[WB_COMPARE_SIDES];
    const char *names[WB_COMPARE_SIDES];           /* of their files */
    char sha256[WB_COMPARE_SIDES][WB_SHA256_TEXT]; /* of those */
};

/* The verdict on all quantities in words, with how many specimens more it takes. */
void wb_compared_append_verdict(struct wb_text *text, const struct wb_compare *compare);

/* Writes the file, whole or not at all. The same input and revision give the same bytes.
 * WB_ERR_EXISTS when it is there, unless `force`. */
WB_MUST_CHECK enum wb_status wb_compared_write(const struct wb_compared *compared, const char *path,
                                               bool force);

#endif
