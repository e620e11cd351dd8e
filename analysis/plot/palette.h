/* Colours that colour-blind readers can tell apart (Okabe and Ito), the same in every figure:
 * one for each wire of a campaign, one for each sample, and fixed ones for roles. Lines that share
 * a figure differ in dash as well, so that a print in grey stays readable.
 */
#ifndef WB_ANALYSIS_PLOT_PALETTE_H
#define WB_ANALYSIS_PLOT_PALETTE_H

/* Each from 0 to 1; alpha 1 is opaque. */
struct wb_colour {
    double red, green, blue, alpha;
};

/* Colour maps for fields, of even steps in perceived lightness (interpolated in OKLab). */
enum wb_palette_map {
    WB_PALETTE_SEQUENTIAL, /* viridis: dark violet to yellow */
    WB_PALETTE_DIVERGING   /* blue, white in the middle, red (ColorBrewer's RdBu) */
};
/* The colour at `part`, 0 to 1, of a map; beyond that the end's. */
struct wb_colour wb_palette_map(enum wb_palette_map map, double part);

/* The colour of a wire by its place in the campaign, from 0; repeats after six. */
struct wb_colour wb_palette_wire(int index);
/* The colour of a sample by its number, from 1; repeats after four. */
struct wb_colour wb_palette_sample(int sample);
/* The colour of step `index` of `n` in time or cycles: dark blue to light. */
struct wb_colour wb_palette_sequence(int index, int n);

struct wb_colour wb_palette_ink(void);     /* text, frames, the computed curve */
struct wb_colour wb_palette_grey(void);    /* notes, ticks, the elastic contrast */
struct wb_colour wb_palette_rule(void);    /* grid lines and table rules */
struct wb_colour wb_palette_warning(void); /* what exceeds a limit or is missing */
struct wb_colour wb_palette_good(void);    /* what keeps a limit */

/* As values of constants: the ink, and the pale blue of bands and of broad lines on which others
 * lie. */
#define WB_PALETTE_INK                                                                             \
    {                                                                                              \
        0x1d / 255.0, 0x27 / 255.0, 0x33 / 255.0, 1.0                                              \
    }
#define WB_PALETTE_PALE(alpha)                                                                     \
    {                                                                                              \
        0.34, 0.71, 0.91, (alpha)                                                                  \
    }

/* The same colour with channels in proportion to light, which shading takes. */
struct wb_colour wb_palette_linear(struct wb_colour colour);

/* The same colour with another alpha. */
struct wb_colour wb_palette_fade(struct wb_colour colour, double alpha);

#endif
