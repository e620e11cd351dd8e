/* The figures of a report of bundles, after the paper's Figs. 17 to 26. A figure whose data are
 * missing is NULL.
 */
#ifndef WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_FIGURES_H
#define WB_ANALYSIS_REPORT_BUNDLES_BUNDLES_FIGURES_H

#include "analysis/plot/figure.h"
#include "analysis/report/bundles/bundles_results.h"
#include "base/status.h"

struct wb_bundles_figures {
    /* Of a group: sections, forces over deflection, errors, energies; not WB_BUNDLES_SHAPE. */
    struct wb_figure *groups[WB_BUNDLES_GROUPS][WB_BUNDLES_FIGURES];
    struct wb_figure *shapes[WB_BUNDLES_BUNDLES];            /* a bent bundle in space */
    struct wb_figure *studies[(WB_BUNDLES_STUDIES + 1) / 2]; /* two studies beside each other */
    struct wb_figure *fit;                                   /* 3D and 1D */
};

/* Draws all figures that the results give; on a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_bundles_figures_create(struct wb_bundles_figures *figures,
                                                       const struct wb_bundles_results *results);
void wb_bundles_figures_release(struct wb_bundles_figures *figures); /* accepts a zeroed one */

#define WB_BUNDLES_FIGURES_MOST                                                                    \
    (WB_BUNDLES_GROUPS * WB_BUNDLES_FIGURES + WB_BUNDLES_BUNDLES + (WB_BUNDLES_STUDIES + 1) / 2 + 1)

/* All figures there are, those of one kind together; returns how many. */
int wb_bundles_figures_list(const struct wb_bundles_figures *figures,
                            const struct wb_figure *list[WB_BUNDLES_FIGURES_MOST]);

#endif
