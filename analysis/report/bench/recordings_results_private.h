/* Steps of wb_recordings_results_compute(), for tests. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_PRIVATE_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_RESULTS_PRIVATE_H

#include "analysis/report/bench/recordings_results.h"

/* The two ends of wb_recordings_results_compute(), for results that come from elsewhere: makes all
 * places with nothing in them, and after they were filled counts and decides what is complete,
 * where it comes from and whether it keeps the limits. */
WB_MUST_CHECK enum wb_status wb_recordings_results_init(struct wb_recordings_results *results,
                                                        const struct wb_recordings *campaign);
void wb_recordings_results_judge(struct wb_recordings_results *results);

#endif
