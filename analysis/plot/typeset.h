/* Text on a Cairo surface, set by Pango in the DejaVu fonts: the one place that knows fonts.
 *
 * Text is Pango markup; what is not well-formed markup is set as it stands. Hinting and subpixel
 * colours are off, so that the same text takes the same room and the same bytes on every surface.
 */
#ifndef WB_ANALYSIS_PLOT_TYPESET_H
#define WB_ANALYSIS_PLOT_TYPESET_H

#include <stdbool.h>

#include <cairo.h>

#include "analysis/plot/palette.h"

enum wb_typeset_align {
    WB_ALIGN_LEFT,
    WB_ALIGN_CENTRE,
    WB_ALIGN_RIGHT
};

struct wb_typeset_style {
    double size; /* pt */
    bool bold, monospace;
    struct wb_colour colour;
    enum wb_typeset_align align;
    double width;        /* pt, where lines are broken; 0: one line */
    double line_spacing; /* times the font's own; 0: 1.25 for broken lines, 1 for one */
};

struct wb_typeset_size {
    double width, height; /* pt, of the whole text */
};

/* The size that a text would take; draws nothing. */
struct wb_typeset_size wb_typeset_measure(cairo_t *cairo, const char *markup,
                                          const struct wb_typeset_style *style);

/* Draws with the top of the text at y. x is the text's left end, middle or right end by `align`
 * when `width` is 0, else the left end of the column. Returns the size. */
struct wb_typeset_size wb_typeset_draw(cairo_t *cairo, double x, double y, const char *markup,
                                       const struct wb_typeset_style *style);

/* Sets the colour of what is drawn next. */
void wb_typeset_set_colour(cairo_t *cairo, struct wb_colour colour);

/* The files of the fonts that texts are set in, plain, bold and monospaced: paths into `path`,
 * whose names tell nothing of their versions. Returns how many were found. */
enum {
    WB_TYPESET_FONTS = 3
};
int wb_typeset_font_files(char path[WB_TYPESET_FONTS][4096]);

#endif
