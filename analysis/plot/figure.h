/* Figures: described once, drawn on any surface (a part of a PDF page, an SVG, a PNG).
 *
 *     struct wb_figure *figure;
 *     WB_TRY(wb_figure_create(&figure, "type1-cycles", 480.0, 240.0));
 *     struct wb_panel *panel = wb_figure_add_panel(figure);
 *     wb_figure_set_axes(panel, "Deflection (mm)", "Force (mN)");
 *     wb_figure_add_line(panel, "cycle 1", n, x, y, &style);
 *     status = wb_figure_write_svg(figure, "curve.svg");
 *     wb_figure_destroy(figure);
 *
 * Values are given in the units that the axes' labels name. Labels, titles and legend entries are
 * Pango markup (<i>, <sub>, <sup>, <b>; &amp; for &). A NaN in a series breaks its line. Builders
 * copy what they are given, return nothing and never fail visibly: a panel too many or a field
 * without a range of colours is reported when the figure is drawn. The same description gives the
 * same bytes.
 *
 * Fields on 8-node faces are drawn as filled contours, see contour.h; a colour bar is a panel of
 * its own. Scenes in space are images, see view.h.
 *
 * Legends and insets are placed where they cover no data: in the emptiest corner, else as near to a
 * corner as they fit, else outside of the axes. A figure is used by one thread at a time.
 */
#ifndef WB_ANALYSIS_PLOT_FIGURE_H
#define WB_ANALYSIS_PLOT_FIGURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "analysis/plot/contour.h"
#include "analysis/plot/palette.h"
#include "base/status.h"
#include "base/text.h"

struct wb_figure; /* opaque; owns its panels */
struct wb_panel;  /* one pair of axes; owned by its figure */

enum wb_figure_dash {
    WB_DASH_SOLID,
    WB_DASH_DASHED,
    WB_DASH_DOTTED,
    WB_DASH_MIXED
};

enum wb_figure_marker {
    WB_MARKER_NONE,
    WB_MARKER_CIRCLE,
    WB_MARKER_SQUARE,
    WB_MARKER_TRIANGLE,
    WB_MARKER_DIAMOND,
    WB_MARKER_RING
};

/* How a series looks; lengths in points of 1/72 inch. */
struct wb_figure_style {
    struct wb_colour colour;
    double width; /* of the line; 0: no line */
    enum wb_figure_dash dash;
    enum wb_figure_marker marker;
    double marker_size; /* 0: 4 */
};

/* The line around the faces of a field, also between those that do not share their nodes. */
enum wb_figure_outline {
    WB_OUTLINE_INK,
    WB_OUTLINE_LIGHT /* for a field that lies within another */
};

/* How the values of a field become colours. Values beyond the ends have the end's colour. */
struct wb_figure_colours {
    enum wb_palette_map map;
    double low, high; /* low < high */
    int n;            /* of different colours; 0: 48 */
    enum wb_figure_outline outline;
};

/* `name` is a file name without ending: letters, digits, '-' and '_'. Size in points. */
WB_MUST_CHECK enum wb_status wb_figure_create(struct wb_figure **out, const char *name,
                                              double width, double height);
void wb_figure_destroy(struct wb_figure *figure); /* accepts NULL */

/* As given at creation; the size in points. */
const char *wb_figure_name(const struct wb_figure *figure);
double wb_figure_width(const struct wb_figure *figure);
double wb_figure_height(const struct wb_figure *figure);

/* A small line below the axes that says where the data come from ("measured (virtual rig)"). */
void wb_figure_set_footer(struct wb_figure *figure, const char *markup);

/* Panels stand side by side in the order they were added, each with equal width. */
struct wb_panel *wb_figure_add_panel(struct wb_figure *figure);
/* A width in points instead; the others share what is left. */
void wb_figure_set_width(struct wb_panel *panel, double width);
/* A narrow panel with the scale of a field's colours, as high as the panel before it. */
void wb_figure_add_colour_bar(struct wb_figure *figure, const struct wb_figure_colours *colours,
                              const char *label);
/* A small panel within another; one at most. */
struct wb_panel *wb_figure_add_inset(struct wb_panel *panel);

/* Labels of the axes with their units, and a title above the panel; markup, copied. */
void wb_figure_set_axes(struct wb_panel *panel, const char *x_label, const char *y_label);
void wb_figure_set_title(struct wb_panel *panel, const char *markup);
/* Ranges of the axes; NaN chooses that bound from the data. */
void wb_figure_set_x_range(struct wb_panel *panel, double low, double high);
void wb_figure_set_y_range(struct wb_panel *panel, double low, double high);
void wb_figure_set_logarithmic_y(struct wb_panel *panel);
/* Names (markup, cut behind 31 bytes) in the place of the numbers of the y axis: at 0, 1, 2, ... Of
 * more than 24 the last ones have none. */
void wb_figure_set_y_names(struct wb_panel *panel, int n, const char *const *names);
/* The same length for a unit on both axes (shapes). */
void wb_figure_set_equal_aspect(struct wb_panel *panel);
/* A second scale on the right whose values are those of y times `factor` (> 0). */
void wb_figure_set_right_axis(struct wb_panel *panel, const char *label, double factor);
/* No frame, ticks and labels: a drawing. */
void wb_figure_hide_axes(struct wb_panel *panel);

/* Series, drawn in the order images, fields, bands, areas, lines, points. `label` NULL: not in the
 * legend.
 */
void wb_figure_add_line(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *y, const struct wb_figure_style *style);
/* `edges`: the lower and the upper one, each of n values. */
void wb_figure_add_band(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *const edges[2], struct wb_colour colour);
/* The inside of an outline, which closes itself. A NaN begins another; what lies within two of them
 * is outside again (a ring). */
void wb_figure_add_area(struct wb_panel *panel, const char *label, size_t n, const double *x,
                        const double *y, struct wb_colour colour);
/* A field with the outline of its faces; copied. Faces that are not finite are left out. */
void wb_figure_add_field(struct wb_panel *panel, int n_faces, const struct wb_contour_face *faces,
                         const struct wb_figure_colours *colours);
/* An image from `low` to `high` of the axes: alpha, red, green, blue from the highest byte of a
 * pixel down, colours times alpha; the upper left pixel first. Copied; drawn before all else. */
struct wb_figure_image {
    int width, height;      /* pixels */
    const uint32_t *pixels; /* (height x width) */
    double low[2], high[2];
};
void wb_figure_add_image(struct wb_panel *panel, const struct wb_figure_image *image);
/* A text whose left (-1), middle (0) or right (1) end stands at a point. */
void wb_figure_add_text(struct wb_panel *panel, double x, double y, int side, const char *markup);

/* Draws into memory. SVG: texts are outlines, but the footer is also the file's <desc>; ids are
 * made of the figure's name, so several may stand in one HTML page. PNG: `scale` pixels for a
 * point; only one thread at a time may draw, any may then make the file's bytes. PDF: one page of
 * the figure's size; `date_utc` (ISO 8601) becomes the file's date, NULL a fixed one. */
WB_MUST_CHECK enum wb_status wb_figure_svg(const struct wb_figure *figure, struct wb_text *svg);
struct wb_figure_pixels {
    struct _cairo_surface *surface; /* owned */
    const char *name;               /* the figure's, borrowed */
};
WB_MUST_CHECK enum wb_status wb_figure_draw(const struct wb_figure *figure, double scale,
                                            struct wb_figure_pixels *pixels);
WB_MUST_CHECK enum wb_status wb_figure_pixels_png(const struct wb_figure_pixels *pixels,
                                                  struct wb_text *png);
void wb_figure_pixels_release(struct wb_figure_pixels *pixels); /* accepts a zeroed one */

/* An SVG file, written atomically. */
WB_MUST_CHECK enum wb_status wb_figure_write_svg(const struct wb_figure *figure, const char *path);

/* Whether a file's name ends in .svg, .png or .pdf, and the figure written as that ending says (PNG
 * where it is another one); a PDF has the fixed date. */
bool wb_figure_is_file(const char *path);
WB_MUST_CHECK enum wb_status wb_figure_write_file(const struct wb_figure *figure, double scale,
                                                  const char *path);

#endif
