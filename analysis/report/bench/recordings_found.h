/* The first page of a report of recordings: of each wire what was calibrated and whether it
 * predicts the other length, by loading and unloading where the campaign calibrates on whole
 * cycles, else by the paper's route.
 */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_FOUND_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_FOUND_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

void wb_recordings_found_put(struct wb_document *document,
                             const struct wb_recordings_results *results,
                             const struct wb_figures *figures);

#endif
