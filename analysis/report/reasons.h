/* Why a step of a report failed, as the report prints it. */
#ifndef WB_ANALYSIS_REPORT_REASONS_H
#define WB_ANALYSIS_REPORT_REASONS_H

#include "base/reason.h"
#include "base/text.h"

/* Where the reason of a step that failed is kept: it is appended to `problem`, or where there is
 * none and nothing was heard, the text of the status. No path of this machine may reach the report:
 * `path` is replaced by `name`; NULL: nothing is. */
struct wb_reasons {
    struct wb_text *problem;
    const char *path, *name;
};

/* Shows the reason as an error. */
void wb_reasons_fail(const struct wb_reasons *reasons, enum wb_status status,
                     const struct wb_reason *why);

/* Shows it as a warning that begins with the name: the report is made without that part. */
void wb_reasons_warn(const struct wb_reasons *reasons, enum wb_status status,
                     const struct wb_reason *why);

#endif
