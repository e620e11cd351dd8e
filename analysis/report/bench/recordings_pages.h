/* What the report of recordings says. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_PAGES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_PAGES_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* Builds the document; release it before the figures. */
void wb_recordings_pages_build(struct wb_document *document,
                               const struct wb_recordings_results *results,
                               const struct wb_figures *figures);

#endif
