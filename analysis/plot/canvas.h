/* Draws figures on any Cairo surface: for pages, which have their own. */
#ifndef WB_ANALYSIS_PLOT_CANVAS_H
#define WB_ANALYSIS_PLOT_CANVAS_H

#include <cairo.h>

#include "analysis/plot/figure.h"
#include "base/status.h"

/* Draws with the figure's upper left corner at (x, y) points. */
WB_MUST_CHECK enum wb_status wb_canvas_draw_figure(cairo_t *cairo, const struct wb_figure *figure,
                                                   double x, double y);

/* Maps a Cairo status to ours, with a message that names what was drawn. */
WB_MUST_CHECK enum wb_status wb_canvas_status(cairo_status_t status, const char *what);

/* A cairo_write_func_t that appends to the struct wb_text in `closure`. */
cairo_status_t wb_canvas_append(void *closure, const unsigned char *bytes, unsigned int n);

#endif
