#include "analysis/plot/scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void fit_logarithmic(struct wb_scale *scale, double low, double high)
{
    if (!(low > 0.0) || !(high > 0.0)) {
        low = 0.1;
        high = 1.0;
    }
    const double room = fmax(0.03 * log10(high / low), 0.05);
    scale->low = low * pow(10.0, -room);
    scale->high = high * pow(10.0, room);
    /* At least one power of ten must be seen, or the axis has no label. */
    const double decade = pow(10.0, floor(log10(scale->high)));
    if (decade < scale->low) {
        const double above = 10.0 * decade;
        if (scale->low / decade < above / scale->high)
            scale->low = decade;
        else
            scale->high = above;
    }
}

void wb_scale_fit(struct wb_scale *scale, double low, double high, bool logarithmic)
{
    memset(scale, 0, sizeof *scale);
    scale->logarithmic = logarithmic;
    if (!isfinite(low) || !isfinite(high) || low > high) {
        low = 0.0;
        high = 1.0;
    }
    if (logarithmic) {
        fit_logarithmic(scale, low, high);
        return;
    }
    if (low >= 0.0 && low < 0.35 * high)
        low = 0.0;
    if (high <= 0.0 && high > 0.35 * low)
        high = 0.0;
    if (!(high - low > 1e-12 * fmax(fabs(low), fabs(high)))) {
        const double half = low == 0.0 ? 1.0 : 0.5 * fabs(low);
        low -= half;
        high += half;
    }
    const double room = 0.04 * (high - low);
    /* Noise around zero should not push zero far from the corner. */
    const bool is_noise = low < 0.0 && -low < 0.5 * room;
    scale->low = low == 0.0 ? 0.0 : is_noise ? -0.6 * room : low - room;
    scale->high = high == 0.0 ? 0.0 : high + room;
}

/* 1, 2, 2.5 or 5 times a power of ten, the smallest that is not below `least`. */
static double nice_step(double least, int *decimals)
{
    static const double factors[] = {1.0, 2.0, 2.5, 5.0, 10.0};
    int exponent = (int)floor(log10(least));
    const double power = pow(10.0, exponent);
    int i = 0;
    while (i < 4 && factors[i] * power < least * (1.0 - 1e-9))
        i++;
    if (i == 4)
        exponent++;
    *decimals = exponent < 0 ? -exponent : 0;
    if (i == 2 && exponent < 1)
        (*decimals)++;
    return factors[i] * power;
}

static void add_power(struct wb_scale *scale, int factor, int exponent)
{
    const double value = factor * pow(10.0, exponent);
    if (scale->n_ticks == WB_SCALE_TICKS || value < scale->low * (1.0 - 1e-9) ||
        value > scale->high * (1.0 + 1e-9))
        return;
    scale->ticks[scale->n_ticks] = value;
    char *const label = scale->labels[scale->n_ticks++];
    if (exponent >= -3 && exponent <= 3)
        snprintf(label, WB_SCALE_TEXT, "%.*f", exponent < 0 ? -exponent : 0, value);
    else
        snprintf(label, WB_SCALE_TEXT,
                 "%d\xc2\xb7"
                 "10<sup>%s%d</sup>",
                 factor, exponent < 0 ? "\xe2\x88\x92" : "", exponent < 0 ? -exponent : exponent);
}

/* Powers of ten, thinned to `most`; with `finer` also twice and five times each. */
static void place_powers_of(struct wb_scale *scale, int first, int last, int stride, bool finer)
{
    scale->n_ticks = 0;
    for (int i = first; i <= last; i += stride) {
        add_power(scale, 1, i);
        if (finer) {
            add_power(scale, 2, i);
            add_power(scale, 5, i);
        }
    }
}

/* Finer where fewer than three powers leave room, or where an axis would have one label. */
static void place_powers(struct wb_scale *scale, int most)
{
    const int first = (int)floor(log10(scale->low) + 1e-9);
    const int last = (int)floor(log10(scale->high) + 1e-9);
    int stride = 1;
    while ((last - first) / stride + 1 > most)
        stride++;
    place_powers_of(scale, first, last, stride,
                    last - first < 3 && 3 * (last - first + 1) <= most + 3);
    if (scale->n_ticks < 2)
        place_powers_of(scale, first, last, stride, true);
}

static void place_steps(struct wb_scale *scale, int most)
{
    const double span = scale->high - scale->low;
    int decimals = 0;
    const double step = nice_step(span / most, &decimals);
    const double slack = 1e-9 * span;
    scale->n_ticks = 0;
    for (double k = ceil((scale->low - slack) / step);
         k * step <= scale->high + slack && scale->n_ticks < WB_SCALE_TICKS; k += 1.0) {
        const double value = k == 0.0 ? 0.0 : k * step;
        scale->ticks[scale->n_ticks] = value;
        char *const label = scale->labels[scale->n_ticks++];
        char digits[WB_SCALE_TEXT - 4];
        if (decimals > 6 || fabs(value) >= 1e7)
            snprintf(digits, sizeof digits, "%.3g", fabs(value));
        else
            snprintf(digits, sizeof digits, "%.*f", decimals, fabs(value));
        /* A true minus sign is as wide as a figure. */
        snprintf(label, WB_SCALE_TEXT, "%s%s", value < 0.0 ? "\xe2\x88\x92" : "", digits);
    }
}

void wb_scale_place_ticks(struct wb_scale *scale, int most)
{
    if (most < 2)
        most = 2;
    if (most > WB_SCALE_TICKS - 2)
        most = WB_SCALE_TICKS - 2;
    if (scale->logarithmic) {
        place_powers(scale, most);
    } else {
        place_steps(scale, most);
    }
    /* One label alone does not show the scale of an axis. */
    for (int more = most + 1; scale->n_ticks < 2 && more <= WB_SCALE_TICKS - 2; more++)
        place_steps(scale, more);
}

double wb_scale_position(const struct wb_scale *scale, double value)
{
    if (!scale->logarithmic)
        return (value - scale->low) / (scale->high - scale->low);
    if (!(value > 0.0))
        return (double)NAN;
    return log(value / scale->low) / log(scale->high / scale->low);
}
