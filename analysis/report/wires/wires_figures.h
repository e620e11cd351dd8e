/* The figures of a comparison, after the paper's Figs. 3, 4 and 5. A figure whose data are missing
 * is NULL.
 */
#ifndef WB_ANALYSIS_REPORT_WIRES_WIRES_FIGURES_H
#define WB_ANALYSIS_REPORT_WIRES_WIRES_FIGURES_H

#include "analysis/plot/figure.h"
#include "analysis/report/wires/wires_results.h"
#include "base/status.h"

struct wb_wires_figures {
    struct wb_figure *elastic, *elastoplastic;      /* Fig. 3: stress on two sections */
    struct wb_figure *elastic_shapes, *shapes;      /* Fig. 4, with distances along the wire */
    struct wb_figure *loading;                      /* force against deflection and angle */
    struct wb_figure *residual[WB_WIRES_RESIDUALS]; /* Fig. 5a: residual stress */
    struct wb_figure *residual_stress;              /* Fig. 5b: stress under the force */
    struct wb_figure *residual_shapes;              /* Fig. 5b: axes, and how tips differ */
};

/* Draws all figures that the results give; on a failure nothing needs a release. */
WB_MUST_CHECK enum wb_status wb_wires_figures_create(struct wb_wires_figures *figures,
                                                     const struct wb_wires_results *results);
void wb_wires_figures_release(struct wb_wires_figures *figures); /* accepts a zeroed one */

#define WB_WIRES_FIGURES (7 + WB_WIRES_RESIDUALS)

/* All figures there are, in the report's order; returns how many. */
int wb_wires_figures_list(const struct wb_wires_figures *figures,
                          const struct wb_figure *list[WB_WIRES_FIGURES]);

/* For the files that draw them. */
WB_MUST_CHECK enum wb_status wb_wires_figures_draw_stress(struct wb_figure **figure,
                                                          const struct wb_wires_results *results,
                                                          int index);
WB_MUST_CHECK enum wb_status wb_wires_figures_draw_residual(struct wb_figure **figure,
                                                            const struct wb_wires_results *results,
                                                            int index);
WB_MUST_CHECK enum wb_status
wb_wires_figures_draw_residual_stress(struct wb_figure **figure,
                                      const struct wb_wires_results *results);

/* Starts a figure that says that it shows simulations. */
WB_MUST_CHECK enum wb_status wb_wires_figures_start(struct wb_figure **figure, const char *name,
                                                    double height);

#endif
