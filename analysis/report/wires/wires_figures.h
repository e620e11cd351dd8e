/* The figures of a comparison of wires, after the paper's Figs. 3, 4 and 5. */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_FIGURES_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_FIGURES_H

#include "analysis/report/figures.h"
#include "analysis/report/wires/wires_results.h"

enum {
    WB_WIRES_FIGURES = 8
};

/* Of struct wb_wires_results. Places: "elastic", "elastic-shapes", "elastoplastic", "loading",
 * "residual" of each case with residual stress, "residual-effect". */
extern const struct wb_figures_row wb_wires_figures[WB_WIRES_FIGURES];

#endif
