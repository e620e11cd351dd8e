/* The report: report.pdf, report.html, report.json and figures/ of a campaign's results.
 *
 * The same results of the same revision give the same bytes: nothing in them depends on the time of
 * the run, on how long it took, on the folder or on this machine's paths.
 */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_REPORT_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_REPORT_H

#include <stdbool.h>

#include "analysis/report/bench/recordings_results.h"
#include "base/status.h"

/* Writes everything into `folder`, as wb_files_write() does. */
WB_MUST_CHECK enum wb_status wb_recordings_report_write(const struct wb_recordings_results *results,
                                                        const char *folder, bool force);

#endif
