/* Sections of bundles as drawings, after the paper's Figs. 17 and 23: wires coloured by their type,
 * lines of the mesh, the tape and where it lies on wires, the homogenised cylinder with its
 * diameter, a scale bar.
 */
#ifndef WB_ANALYSIS_REPORT_DRAW_FIGURES_BUNDLE_H
#define WB_ANALYSIS_REPORT_DRAW_FIGURES_BUNDLE_H

#include "analysis/plot/figure.h"
#include "base/status.h"
#include "fe/model/bundle_model.h"

enum {
    WB_FIGURES_BUNDLE_MOST = 3 /* beside each other */
};

/* Sections of n bundles beside each other, at the same scale, with the lines of the mesh of that
 * name; WB_ERR_NOT_FOUND when one of them has no such mesh. `figure_name` as of
 * wb_figure_create(). */
WB_MUST_CHECK enum wb_status wb_figures_bundle_draw(struct wb_figure **figure,
                                                    const char *figure_name, int n,
                                                    const struct wb_bundle_model *const *models,
                                                    const char *mesh);

#endif
