/* Draws fields and their colour bars. */
#ifndef WB_ANALYSIS_PLOT_SHADING_H
#define WB_ANALYSIS_PLOT_SHADING_H

#include <cairo.h>

#include "analysis/plot/layout.h"

/* A series of the kind WB_SERIES_FIELD, within the panel's scales. */
void wb_shading_draw_field(cairo_t *cairo, const struct wb_layout_panel *layout,
                           const struct wb_series *series);

/* A panel that is a colour bar. */
void wb_shading_draw_bar(cairo_t *cairo, const struct wb_layout_panel *layout);

#endif
