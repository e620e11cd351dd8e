/* Bent bundles in space, after the paper's Figs. 21 and 24: wires coloured by their von Mises
 * stress, the tape as glass over them, the straight bundle's axis, the tip from nearby.
 *
 *     struct wb_surface surface;
 *     WB_TRY(wb_surface_read(&surface, "simulations/7-type3"));
 *     status = wb_figures_surface_draw(&figure, "7-type3-bent", &surface, NULL);
 *     wb_surface_release(&surface);
 */
#ifndef WB_ANALYSIS_REPORT_DRAW_FIGURES_SURFACE_H
#define WB_ANALYSIS_REPORT_DRAW_FIGURES_SURFACE_H

#include "analysis/dataset/surface.h"
#include "analysis/plot/figure.h"
#include "base/status.h"

/* Zero is the default of each. */
struct wb_figures_surface_style {
    double width, height; /* pt; 470 and 215 */
    double most_stress;   /* Pa, where the colours end; the wires' largest, rounded up. Figures that
                             are compared have the same */
    const char *title;    /* markup; none */
};

/* The wires' largest stress, Pa: of the whole surface. */
double wb_figures_surface_most_stress(const struct wb_surface *surface);

/* `style` may be NULL; `figure_name` as of wb_figure_create(). WB_ERR_ARGUMENT when the surface has
 * no body. */
WB_MUST_CHECK enum wb_status wb_figures_surface_draw(struct wb_figure **figure,
                                                     const char *figure_name,
                                                     const struct wb_surface *surface,
                                                     const struct wb_figures_surface_style *style);

#endif
