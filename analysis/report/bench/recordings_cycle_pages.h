/* What a report of recordings says of calibrations on whole cycles: on its first page of all wires,
 * and on the pages of each. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_PAGES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_PAGES_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* A sentence for each wire, which method to use, what to test next, and the moments of all wires as
 * a figure; nothing where the campaign does not calibrate on whole cycles. False where a prediction
 * of another length is beyond its bound. */
bool wb_recordings_cycle_pages_found(struct wb_document *document,
                                     const struct wb_recordings_results *results,
                                     const struct wb_figures *figures);

/* EI, M(kappa), residual curvature ratio and the verdict on the hardening rule of every wire;
 * nothing where the campaign does not calibrate on whole cycles. */
void wb_recordings_cycle_pages_summary(struct wb_document *document,
                                       const struct wb_recordings_results *results);

/* The chapter of one wire, below its heading; nothing where there is no such calibration. */
void wb_recordings_cycle_pages_wire(struct wb_document *document,
                                    const struct wb_recordings_results *results, int index,
                                    const struct wb_figures *figures);

#endif
