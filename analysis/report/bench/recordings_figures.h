/* The figures of a report of recordings, after the paper's Figs. 9, 10, 13, 14 and 15. */
#ifndef WB_ANALYSIS_REPORT_BENCH_RECORDINGS_FIGURES_H
#define WB_ANALYSIS_REPORT_BENCH_RECORDINGS_FIGURES_H

#include "analysis/report/bench/recordings_results.h"
#include "analysis/report/figures.h"

enum {
    WB_RECORDINGS_FIGURES = 19
};

/* Of struct wb_recordings_results. Places: "bending", "bench", "overview"; of each wire
 * "cycle", "later", "prediction", "law", "valley", "measured", "compared", "search". */
extern const struct wb_figures_row wb_recordings_figures[WB_RECORDINGS_FIGURES];

/* Figures of calibrations on whole cycles, each of one wire; they draw nothing where there is no
 * such calibration. */
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

/* Largest deflection of the first loading, m, and when it was reached, s (infinite without one). */
double wb_recordings_figures_turn(const struct wb_dataset *dataset, double *t);

#endif
