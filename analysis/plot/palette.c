#include "analysis/plot/palette.h"

#include <math.h>

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

/* --- maps --- */

static double linear_of(double channel)
{
    return channel <= 0.04045 ? channel / 12.92 : pow((channel + 0.055) / 1.055, 2.4);
}

static double channel_of(double linear)
{
    const double value =
        linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1.0 / 2.4) - 0.055;
    return fmin(fmax(value, 0.0), 1.0);
}

struct wb_colour wb_palette_linear(struct wb_colour colour)
{
    return (struct wb_colour){linear_of(colour.red), linear_of(colour.green),
                              linear_of(colour.blue), colour.alpha};
}

/* OKLab (Ottosson 2020): equal distances look equally far apart. */
static void lab_of(struct wb_colour colour, double lab[3])
{
    const double r = linear_of(colour.red), g = linear_of(colour.green), b = linear_of(colour.blue);
    const double l = cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    lab[0] = 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
    lab[1] = 1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s;
    lab[2] = 0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s;
}

static struct wb_colour colour_of_lab(const double lab[3])
{
    const double l = pow(lab[0] + 0.3963377774 * lab[1] + 0.2158037573 * lab[2], 3.0);
    const double m = pow(lab[0] - 0.1055613458 * lab[1] - 0.0638541728 * lab[2], 3.0);
    const double s = pow(lab[0] - 0.0894841775 * lab[1] - 1.2914855480 * lab[2], 3.0);
    return (struct wb_colour){channel_of(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
                              channel_of(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
                              channel_of(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s),
                              1.0};
}

struct wb_colour wb_palette_map(enum wb_palette_map map, double part)
{
    static const unsigned int hex[2][9] = {
        {0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21908c, 0x27ad81, 0x5dc863, 0xaadc32, 0xfde725},
        {0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b}};
    const double place = 8.0 * fmin(fmax(part, 0.0), 1.0);
    const int below = place < 7.0 ? (int)place : 7;
    double a[3], b[3];
    lab_of(colour_of(hex[map][below]), a);
    lab_of(colour_of(hex[map][below + 1]), b);
    for (int i = 0; i < 3; i++)
        a[i] += (place - below) * (b[i] - a[i]);
    return colour_of_lab(a);
}

/* --- roles --- */

struct wb_colour wb_palette_ink(void)
{
    return (struct wb_colour)WB_PALETTE_INK;
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
