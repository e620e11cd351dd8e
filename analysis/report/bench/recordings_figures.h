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

/* Largest deflection of the first loading, m, and when it was reached, s (infinite without one). */
double wb_recordings_figures_turn(const struct wb_dataset *dataset, double *t);

#endif
