/* Figures of calibrations on whole cycles, each of one wire: rows of the table in
 * recordings_figures.c have them. They draw nothing where there is no such calibration. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_FIGURES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_CYCLE_FIGURES_H

#include "analysis/report/figures.h"
#include "base/status.h"

/* Both ways of the samples, measured and computed; what remains between them. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_ways(struct wb_figures_item *item);
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_residuals(struct wb_figures_item *item);
/* Cycles after the first, predicted. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_later(struct wb_figures_item *item);
/* Both ways at the other length, predicted. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_prediction(struct wb_figures_item *item);
/* EI of each sample; M(kappa), also of all wires in one. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_all_moments(struct wb_figures_item *item);
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_forest(struct wb_figures_item *item);
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_moments(struct wb_figures_item *item);
/* K and n of the loading alone. */
WB_MUST_CHECK enum wb_status wb_recordings_cycle_figures_valley(struct wb_figures_item *item);

#endif
