#include "live/live_raster.h"

#include <math.h>
#include <string.h>

void wb_live_raster_init(struct wb_live_raster *raster, int columns, int rows, bool is_unicode)
{
    memset(raster, 0, sizeof *raster);
    raster->columns = columns < WB_LIVE_RASTER_COLUMNS ? columns : WB_LIVE_RASTER_COLUMNS;
    raster->rows = rows < WB_LIVE_RASTER_ROWS ? rows : WB_LIVE_RASTER_ROWS;
    raster->is_unicode = is_unicode;
    raster->width = raster->columns * (is_unicode ? 2 : 1);
    raster->height = raster->rows * (is_unicode ? 4 : 2);
}

/* Sets a dot; ignored if outside the drawing or NaN. */
static void set_dot(struct wb_live_raster *raster, double x, double y,
                    enum wb_live_raster_layer layer)
{
    /* Bits of the Braille patterns, by row and column of the dot (Unicode, block U+2800). */
    static const uint8_t braille[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    if (!(x >= 0.0 && x < raster->width && y >= 0.0 && y < raster->height))
        return;
    const int across = (int)x, down = raster->height - 1 - (int)y;
    const int per_column = raster->is_unicode ? 2 : 1, per_row = raster->is_unicode ? 4 : 2;
    const int column = across / per_column, row = down / per_row;
    const uint8_t bit =
        raster->is_unicode ? braille[down % 4][across % 2] : (uint8_t)(1u << (down % 2));
    raster->bits[row][column] |= bit;
    if (layer > raster->layer[row][column])
        raster->layer[row][column] = (uint8_t)layer;
}

void wb_live_raster_line(struct wb_live_raster *raster, const double from[2], const double to[2],
                         enum wb_live_raster_layer layer, int period)
{
    const double across = to[0] - from[0], up = to[1] - from[1];
    const double longest = fmax(fabs(across), fabs(up));
    /* Skip lines that are far outside or not a number. */
    if (!(longest <= 8.0 * (raster->width + raster->height)))
        return;
    const int steps = (int)ceil(longest);
    for (int i = 0; i <= steps; i += period) {
        const double part = steps > 0 ? (double)i / steps : 0.0;
        set_dot(raster, from[0] + part * across, from[1] + part * up, layer);
    }
}

const char *wb_live_raster_text(const struct wb_live_raster *raster, int column, int row,
                                char text[4])
{
    static const char ascii[] = {' ', '\'', '.', ':'};
    const uint8_t bits = raster->bits[row][column];
    memset(text, 0, 4);
    if (bits == 0)
        return text;
    if (!raster->is_unicode) {
        text[0] = ascii[bits & 3];
        return text;
    }
    /* U+2800 + bits in UTF-8. */
    text[0] = (char)0xe2;
    text[1] = (char)(0xa0 | bits >> 6);
    text[2] = (char)(0x80 | (bits & 0x3f));
    return text;
}
