/* Calibrations on whole cycles in a report of recordings: tables of all wires, the chapter of each,
 * and sentences that the first page has, too. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_PAGES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_PAGES_H

#include "analysis/calibration/properties/quantity.h"
#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/document.h"
#include "analysis/report/figures.h"

/* Appends "NAME = 35.2 N mm2 (31.0 to 40.1)", in the quantity's unit and with its interval. */
void wb_recordings_cycle_pages_append(struct wb_text *text, const char *name,
                                      enum wb_quantity_id id, const struct wb_estimate *estimate);

/* Appends unloading stiffness and residual curvature ratio between their ends over the laws. */
void wb_recordings_cycle_pages_append_ranges(struct wb_text *text,
                                             const struct wb_cycle_calibration *calibration);

/* EI, M(kappa), residual curvature ratio and the verdict on the hardening rule of every wire;
 * nothing where the campaign does not calibrate on whole cycles. */
void wb_recordings_cycle_pages_summary(struct wb_document *document,
                                       const struct wb_recordings_results *results);

/* The chapter of one wire, below its heading; nothing where there is no such calibration. */
void wb_recordings_cycle_pages_wire(struct wb_document *document,
                                    const struct wb_recordings_results *results, int index,
                                    const struct wb_figures *figures);

#endif
