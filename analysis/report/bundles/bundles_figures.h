/* The figures of a report of bundles, after the paper's Figs. 17 to 26. */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_FIGURES_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_FIGURES_H

#include "analysis/report/bundles/bundles_results.h"
#include "analysis/report/figures.h"

enum {
    WB_BUNDLES_FIGURE_ROWS = 7
};

/* Of struct wb_bundles_results. Places: of each group "sections", "curves" and "energies", of each
 * pair of studies "studies", of each bundle "shapes", and "fit". */
extern const struct wb_figures_row wb_bundles_figures[WB_BUNDLES_FIGURE_ROWS];

#endif
