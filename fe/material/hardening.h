/* The inverse of the power law, and a table of it for the fibres' inner loop.
 *
 * A yielding point whose trial stress is s obeys s - E (p - p0) = sigma_Y + K p^n, where p0 and p
 * are the accumulated plastic strains before and after. With the overstress c = s - sigma_Y + E p0
 * this is E p + K p^n = c: one function p(c) of one variable for all points of a material. The
 * ratio r = E p / c lies in [0, 1] and gives everything else without a power:
 *
 *     p = r c / E,  sigma = sigma_Y + (1 - r) c,  E_t = E n (1 - r) / (r + n (1 - r)).
 *
 * The table holds r over c / sigma_Y in piecewise polynomials, several pieces an octave, exact to
 * round-off; outside its range the equation is solved.
 */
#ifndef WB_FE_MATERIAL_HARDENING_H
#define WB_FE_MATERIAL_HARDENING_H

#include <stdbool.h>
#include <string.h>

#include "fe/material/material.h"

enum {
    WB_HARDENING_TERMS = 8,          /* coefficients of a piece; one cache line */
    WB_HARDENING_LOWEST_OCTAVE = -6, /* the table begins at c / sigma_Y = 2^-6 */
    WB_HARDENING_OCTAVES = 18,
    WB_HARDENING_MAX_PIECES = 64 /* in an octave, as a power of two */
};

struct wb_hardening_table {
    int shift;       /* 52 - log2(pieces in an octave) */
    long long first; /* (bits of the table's begin) >> shift */
    long long pieces;
    double coefficients[WB_HARDENING_OCTAVES * WB_HARDENING_MAX_PIECES][WB_HARDENING_TERMS];
};

/* r for overstress c > 0 (Pa) of an isotropic power law, solved to round-off. */
double wb_hardening_ratio(const struct wb_material *material, double overstress);

/* Fills the table for a material. A material that the law does not fit (K infinite, E not
 * positive) gives a table of NaN, which the solver's finite checks find. */
void wb_hardening_tabulate(struct wb_hardening_table *table, const struct wb_material *material);

/* r from the table; `scaled` is c / sigma_Y. Outside the table, and for what is not a number, it is
 * some finite number of no meaning: check with wb_hardening_covers() first or later. Branch-free,
 * so that a loop over it vectorises. */
static inline double wb_hardening_lookup(const struct wb_hardening_table *table, double scaled)
{
    unsigned long long bits;
    memcpy(&bits, &scaled, sizeof bits);
    long long piece = (long long)(bits >> table->shift) - table->first;
    piece = piece < 0 ? 0 : piece;
    piece = piece < table->pieces ? piece : table->pieces - 1;

    /* The remaining bits of the mantissa are the place within the piece, from -1/2 to 1/2. */
    const unsigned long long rest = (bits << (52 - table->shift)) & 0x000FFFFFFFFFFFFFULL;
    const unsigned long long place = rest | 0x3FF0000000000000ULL;
    double t;
    memcpy(&t, &place, sizeof t);
    t -= 1.5;

    const double *a = table->coefficients[piece];
    const double t2 = t * t;
    const double t4 = t2 * t2;
    return ((a[0] + a[1] * t) + (a[2] + a[3] * t) * t2) +
           ((a[4] + a[5] * t) + (a[6] + a[7] * t) * t2) * t4;
}

/* Whether c / sigma_Y lies in the table. */
static inline bool wb_hardening_covers(double scaled)
{
    const double begin = 1.0 / (1 << -WB_HARDENING_LOWEST_OCTAVE);
    return scaled >= begin && scaled < begin * (1 << WB_HARDENING_OCTAVES);
}

#endif
