/* The last step of wb_recordings_results_compute(), for tests. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_PRIVATE_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_PRIVATE_H

#include "analysis/report/bench/recordings_results.h"

/* For results that come from elsewhere: counts and decides what is complete, where it comes from
 * and whether it keeps the limits. */
void wb_recordings_results_judge(struct wb_recordings_results *results);

#endif
