/* A drawing of dots in a block of character cells: 2 x 4 dots per cell as Braille patterns or, in
 * ASCII, 1 x 2 dots as the characters ' . and : . Dots are about square. */
#ifndef WB_LIVE_LIVE_RASTER_H
#define WB_LIVE_LIVE_RASTER_H

#include <stdbool.h>
#include <stdint.h>

/* A cell has the colour of its highest layer. */
enum wb_live_raster_layer {
    WB_LIVE_RASTER_NONE,
    WB_LIVE_RASTER_LIMIT,
    WB_LIVE_RASTER_PREDICTED,
    WB_LIVE_RASTER_EARLIER,
    WB_LIVE_RASTER_NOW
};

#define WB_LIVE_RASTER_COLUMNS 256
#define WB_LIVE_RASTER_ROWS 96

struct wb_live_raster {
    int columns, rows; /* cells */
    int width, height; /* dots */
    bool is_unicode;   /* Braille */
    uint8_t bits[WB_LIVE_RASTER_ROWS][WB_LIVE_RASTER_COLUMNS];
    uint8_t layer[WB_LIVE_RASTER_ROWS][WB_LIVE_RASTER_COLUMNS];
};

/* Begins an empty drawing; its size is limited to the largest. */
void wb_live_raster_init(struct wb_live_raster *raster, int columns, int rows, bool is_unicode);

/* Draws a line between two points given in dots, x from the left, y from the bottom, clipped to the
 * drawing; sets one of every `period` dots (1: all). */
void wb_live_raster_line(struct wb_live_raster *raster, const double from[2], const double to[2],
                         enum wb_live_raster_layer layer, int period);

/* The character of a cell as UTF-8 text, row 0 at the top; "": empty cell. */
const char *wb_live_raster_text(const struct wb_live_raster *raster, int column, int row,
                                char text[4]);

#endif
