/* What a figure's description is made of, for the files that build and draw it. */
#ifndef WB_ANALYSIS_PLOT_FIGURE_PRIVATE_H
#define WB_ANALYSIS_PLOT_FIGURE_PRIVATE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analysis/plot/figure.h"
#include "analysis/plot/scale.h"

#define WB_FIGURE_PANELS 6

/* wb_figure_draw() and wb_figure_pixels_png(). */
WB_MUST_CHECK enum wb_status wb_figure_png(const struct wb_figure *figure, double scale,
                                           struct wb_text *png);

enum wb_series_kind {
    WB_SERIES_IMAGE,
    WB_SERIES_FIELD,
    WB_SERIES_BAND,
    WB_SERIES_AREA,
    WB_SERIES_LINE, /* and points */
    WB_SERIES_TEXT
};

struct wb_series {
    enum wb_series_kind kind;
    char *label; /* NULL: not in the legend; the text itself of WB_SERIES_TEXT; owned */
    size_t n;
    double *x, *y, *high; /* (n), owned; `high` of a band, whose low edge is y */
    struct wb_figure_style style;
    int side; /* of a text */
    /* Of an image, whose x and y are its two edges. */
    int pixels_across, pixels_down;
    uint32_t *pixels; /* owned */
    /* Of a field, whose x and y are the nodes of its faces, eight each. */
    struct wb_contour contour; /* owned */
    struct wb_figure_colours colours;
};

struct wb_panel {
    struct wb_figure *figure;
    struct wb_panel *inset; /* owned */
    char *x_label, *y_label, *right_label, *title;
    double right_factor;
    double x_range[2], y_range[2]; /* NaN: from the data */
    bool logarithmic_y, equal_aspect, hidden_axes, is_inset;
    int n_y_names;
    char y_names[WB_SCALE_TICKS][WB_SCALE_TEXT];
    double width;                     /* pt; 0: a share of what is left */
    bool is_bar;                      /* of colours: */
    struct wb_figure_colours colours; /* those; the label is y_label */
    int n_series;
    size_t capacity;
    struct wb_series *series;
};

struct wb_figure {
    char *name, *footer;
    double width, height;
    int n_panels;
    struct wb_panel *panels[WB_FIGURE_PANELS];
    bool failed; /* too many panels or insets, no field's colours, or an empty image */
};

WB_MUST_CHECK enum wb_status wb_figure_pdf(const struct wb_figure *figure, const char *date_utc,
                                           struct wb_text *pdf);

#endif
