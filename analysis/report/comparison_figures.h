/* The figures of a comparison, after the paper's Figs. 3, 4 and 5. A figure whose data are missing
 * is NULL.
 */
#ifndef WB_ANALYSIS_REPORT_COMPARISON_FIGURES_H
#define WB_ANALYSIS_REPORT_COMPARISON_FIGURES_H

#include "analysis/plot/figure.h"
#include "analysis/report/comparison_results.h"
#include "base/status.h"

struct wb_comparison_figures {
    struct wb_figure *elastic, *elastoplastic;           /* Fig. 3: stress on two sections */
    struct wb_figure *elastic_shapes, *shapes;           /* Fig. 4, with distances along the wire */
    struct wb_figure *loading;                           /* force against deflection and angle */
    struct wb_figure *residual[WB_COMPARISON_RESIDUALS]; /* Fig. 5a: residual stress */
    struct wb_figure *residual_stress;                   /* Fig. 5b: stress under the force */
    struct wb_figure *residual_shapes;                   /* Fig. 5b: axes, and how tips differ */
};

/* Draws all figures that the results give; on a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status
wb_comparison_figures_create(struct wb_comparison_figures *figures,
                             const struct wb_comparison_results *results);
void wb_comparison_figures_release(
    struct wb_comparison_figures *figures); /* accepts a zeroed one */

#define WB_COMPARISON_FIGURES (7 + WB_COMPARISON_RESIDUALS)

/* All figures there are, in the report's order; returns how many. */
int wb_comparison_figures_list(const struct wb_comparison_figures *figures,
                               const struct wb_figure *list[WB_COMPARISON_FIGURES]);

/* For the files that draw them. */
WB_MUST_CHECK enum wb_status
wb_comparison_figures_draw_stress(struct wb_figure **figure,
                                  const struct wb_comparison_results *results, int index);
WB_MUST_CHECK enum wb_status
wb_comparison_figures_draw_residual(struct wb_figure **figure,
                                    const struct wb_comparison_results *results, int index);
WB_MUST_CHECK enum wb_status
wb_comparison_figures_draw_residual_stress(struct wb_figure **figure,
                                           const struct wb_comparison_results *results);

/* Starts a figure that says that it shows simulations. */
WB_MUST_CHECK enum wb_status wb_comparison_figures_start(struct wb_figure **figure,
                                                         const char *name, double height);

#endif
