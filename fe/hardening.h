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
#ifndef WB_FE_HARDENING_H
#define WB_FE_HARDENING_H

#include "fe/material.h"

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

/* r from the table; `scaled` is c / sigma_Y. Returns a negative number outside the table. */
double wb_hardening_lookup(const struct wb_hardening_table *table, double scaled);

#endif
