#include "analysis/plot/palette.h"

/* 0xRRGGBB as a colour. */
static struct wb_colour colour_of(unsigned int hex)
{
    return (struct wb_colour){(double)(hex >> 16 & 0xff) / 255.0, (double)(hex >> 8 & 0xff) / 255.0,
                              (double)(hex & 0xff) / 255.0, 1.0};
}

struct wb_colour wb_palette_wire(int index)
{
    static const unsigned int hex[] = {0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9};
    return colour_of(hex[(index % 6 + 6) % 6]);
}

struct wb_colour wb_palette_sample(int sample)
{
    static const unsigned int hex[] = {0x3a9bdc, 0xe08a00, 0xb8578f, 0x5a7d2a};
    return colour_of(hex[((sample - 1) % 4 + 4) % 4]);
}

struct wb_colour wb_palette_sequence(int index, int n)
{
    /* Equal steps of lightness, after the viridis family without its pale yellow. */
    static const unsigned int hex[] = {0x2c1e5c, 0x33568f, 0x1f8a8c, 0x4fb36b, 0xc0c92e};
    const double place = n > 1 ? 4.0 * index / (n - 1) : 0.0;
    int below = (int)place;
    if (below > 3)
        below = 3;
    const double part = place - below;
    const struct wb_colour a = colour_of(hex[below]), b = colour_of(hex[below + 1]);
    return (struct wb_colour){a.red + part * (b.red - a.red), a.green + part * (b.green - a.green),
                              a.blue + part * (b.blue - a.blue), 1.0};
}

struct wb_colour wb_palette_ink(void)
{
    return colour_of(0x1d2733);
}

struct wb_colour wb_palette_grey(void)
{
    return colour_of(0x5d6875);
}

struct wb_colour wb_palette_rule(void)
{
    return colour_of(0xdde2e8);
}

struct wb_colour wb_palette_warning(void)
{
    return colour_of(0xb3261e);
}

struct wb_colour wb_palette_good(void)
{
    return colour_of(0x1b6e4b);
}

struct wb_colour wb_palette_fade(struct wb_colour colour, double alpha)
{
    colour.alpha = alpha;
    return colour;
}
