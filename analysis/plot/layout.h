/* Where everything of a figure stands: plots, scales, legends and insets, before it is drawn.
 * All boxes in points from the figure's upper left corner.
 */
#ifndef WB_ANALYSIS_PLOT_LAYOUT_H
#define WB_ANALYSIS_PLOT_LAYOUT_H

#include <cairo.h>

#include "analysis/plot/figure_private.h"
#include "analysis/plot/place.h"
#include "analysis/plot/scale.h"
#include "analysis/plot/typeset.h"

struct wb_layout_panel {
    const struct wb_panel *panel;
    double text_size;         /* pt of tick labels */
    struct wb_place_box room; /* all the panel has, labels included */
    struct wb_place_box plot; /* the frame */
    struct wb_scale x, y, right;
    bool has_legend, legend_outside;
    struct wb_place_box legend;
};

struct wb_layout {
    int n_panels;
    struct wb_layout_panel panels[WB_FIGURE_PANELS];
    struct wb_layout_panel insets[WB_FIGURE_PANELS]; /* panel NULL: none */
    double footer_y;                                 /* pt, top of the footer */
};

/* Text styles that layout and drawing share. */
struct wb_typeset_style wb_layout_tick_style(const struct wb_layout_panel *panel);
struct wb_typeset_style wb_layout_label_style(const struct wb_layout_panel *panel);
struct wb_typeset_style wb_layout_title_style(const struct wb_layout_panel *panel);
struct wb_typeset_style wb_layout_footer_style(void);

/* Room of one legend entry's sample of the line, and around the box' content, pt. */
#define WB_LAYOUT_SWATCH 20.0
#define WB_LAYOUT_PADDING 4.0

/* Lays out a figure; `cairo` only measures text. */
void wb_layout_compute(struct wb_layout *layout, const struct wb_figure *figure, cairo_t *cairo);

/* A value's place in points. */
double wb_layout_x(const struct wb_layout_panel *panel, double value);
double wb_layout_y(const struct wb_layout_panel *panel, double value);

/* Walks the legend's entries in order, at the places they have within its box: `row_height` and the
 * upper left corner of each. Returns the number of entries; `visit` may be NULL. */
int wb_layout_legend(const struct wb_layout_panel *panel, cairo_t *cairo,
                     void (*visit)(void *context, const struct wb_series *series, double x,
                                   double y),
                     void *context, struct wb_typeset_size *size);

#endif
