/* The last step of wb_report_make(), for tests that compute results themselves. */
#ifndef WB_ANALYSIS_REPORT_REPORT_PRIVATE_H
#define WB_ANALYSIS_REPORT_REPORT_PRIVATE_H

#include "analysis/report/report.h"

/* Writes computed results into `folder`, as wb_files_write() does. */
WB_MUST_CHECK enum wb_status wb_report_write(const struct wb_kind *kind, const void *results,
                                             const char *folder, bool force);

#endif
