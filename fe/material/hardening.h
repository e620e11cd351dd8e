/* Hardening laws, one table row each, with the functions that solvers call.
 *
 * A material yields when its stress reaches a surface, which either grows or moves with the
 * accumulated plastic strain p: it grows by H(p) in isotropic hardening,
 *
 *     |stress| = sigma_Y + H(p),
 *
 * and moves by a back stress in kinematic hardening. Solvers ask the row of a material's law; they
 * know growing and moving surfaces, but no law. A new law that grows is an entry of enum
 * wb_hardening, a row in hardening.c with its functions, and a test.
 *
 * A yielding point whose trial stress is s obeys s - E (p - p0) = sigma_Y + H(p), where p0 and p
 * are the accumulated plastic strains before and after. With the overstress c = s - sigma_Y + E p0
 * this is E p + H(p) = c: one function p(c) of one variable for all points of a material. The
 * ratio r = E p / c lies in [0, 1] and gives everything else without another evaluation of H; with
 * the exponent n = d(ln H) / d(ln p), which is constant for a power law,
 *
 *     p = r c / E,  sigma = sigma_Y + (1 - r) c,  E_t = E n (1 - r) / (r + n (1 - r)).
 *
 * Two tables hold r. That of struct wb_hardening_table, for the fibres of beams and rods, is over
 * c / sigma_Y, in several polynomials an octave, exact to round-off. The octave table, for the
 * explicit kernels, is small enough for the registers of a processor.
 */
#ifndef WB_FE_MATERIAL_HARDENING_H
#define WB_FE_MATERIAL_HARDENING_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include "base/status.h"
#include "fe/material/material.h"

/* --- the laws --- */

/* A parameter of a hardening law: a field of struct wb_material. */
struct wb_hardening_parameter {
    const char *name, *unit, *expected; /* for messages; the unit with a space before it, or "" */
    double least, largest;              /* valid range of the computation */
    const char *key;                    /* in material files, */
    double factor, low, high;           /* its unit there, and its range in this unit */
    size_t offset;                      /* of the field */
};

enum wb_hardening_parameters {
    WB_HARDENING_STRENGTH,
    WB_HARDENING_EXPONENT,
    WB_HARDENING_PARAMETERS
};

extern const struct wb_hardening_parameter wb_hardening_parameters[WB_HARDENING_PARAMETERS];

struct wb_hardening_law {
    const char *name; /* in files; NULL: elastic, which a file says by giving no yield stress */
    bool yields;
    bool moves;                        /* the yield surface moves; false: it grows */
    bool has[WB_HARDENING_PARAMETERS]; /* the parameters that it needs */
    bool may_be_perfect;               /* without parameters the law is perfectly plastic */

    /* Of a surface that grows: H(p), Pa, at p >= 0; the mean of H from 0 to p; the exponent at p,
     * NULL where it is the material's own at any p; r, to round-off, at the logarithm of the strain
     * c / E that an overstress c > 0 has while it is elastic, with a guess of ln r to start from or
     * NaN. */
    double (*growth)(const struct wb_material *material, double p);
    double (*mean_growth)(const struct wb_material *material, double p);
    double (*exponent)(const struct wb_material *material, double p);
    double (*ratio)(const struct wb_material *material, double log_strain, double guess);
    /* Of a surface that moves: the modulus d(back stress) / dp, Pa. */
    double (*back_modulus)(const struct wb_material *material);
};

enum {
    WB_HARDENING_LAWS = 3
};

extern const struct wb_hardening_law
    wb_hardening_laws[WB_HARDENING_LAWS]; /* by enum wb_hardening */

static inline const struct wb_hardening_law *wb_hardening_law(const struct wb_material *material)
{
    return &wb_hardening_laws[material->hardening];
}

/* Whether the parameters of the hardening law are valid; if not, `why` names the invalid one. */
bool wb_hardening_is_possible(const struct wb_material *material, char *why, size_t size);

static inline double *wb_hardening_value(struct wb_material *material, int parameter)
{
    return (double *)((char *)material + wb_hardening_parameters[parameter].offset);
}

/* n = d(ln H) / d(ln p) of a surface that grows. */
static inline double wb_hardening_exponent(const struct wb_material *material, double p)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    return law->exponent ? law->exponent(material, p) : material->hardening_exponent;
}

/* 0 of a surface that does not move. */
static inline double wb_hardening_back_modulus(const struct wb_material *material)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    return law->back_modulus ? law->back_modulus(material) : 0.0;
}

/* The mean of the yield stress from 0 to p > 0, Pa: p times it is the plastic work, J/m3. */
double wb_hardening_mean_stress(const struct wb_material *material, double p);

/* r for overstress c > 0 (Pa), solved to round-off; 1 of a surface that does not grow. */
double wb_hardening_ratio(const struct wb_material *material, double overstress);

/* --- the table of the fibres --- */

enum {
    WB_HARDENING_TERMS = 8,          /* coefficients of a piece; one cache line */
    WB_HARDENING_LOWEST_OCTAVE = -6, /* the table begins at c / sigma_Y = 2^-6 */
    WB_HARDENING_OCTAVES = 14,
    WB_HARDENING_MAX_PIECES = 64 /* in an octave, as a power of two */
};

struct wb_hardening_table {
    int shift;       /* 52 - log2(pieces in an octave) */
    long long first; /* (bits of the table's begin) >> shift */
    long long pieces;
    double coefficients[WB_HARDENING_OCTAVES * WB_HARDENING_MAX_PIECES][WB_HARDENING_TERMS];
};

/* Fills the table for a material whose surface grows. A material that the law does not fit (H
 * infinite, E not positive) gives a table of NaN, which the solver's finite checks find. */
void wb_hardening_tabulate(struct wb_hardening_table *table, const struct wb_material *material);

/* r from the table; `scaled` is c / sigma_Y. Outside the table, and for NaN, the result is finite
 * but meaningless: check with wb_hardening_covers() before or after. Branch-free, so that a loop
 * over it vectorises. */
static inline double wb_hardening_lookup(const struct wb_hardening_table *table, double scaled)
{
    unsigned long long pattern;
    memcpy(&pattern, &scaled, sizeof pattern);
    long long piece = (long long)(pattern >> table->shift) - table->first;
    piece = piece < 0 ? 0 : piece;
    piece = piece < table->pieces ? piece : table->pieces - 1;

    /* The remaining bits of the mantissa are the place within the piece, from -1/2 to 1/2. */
    const unsigned long long rest = (pattern << (52 - table->shift)) & 0x000FFFFFFFFFFFFFULL;
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

/* --- the octave table --- */

enum {
    WB_HARDENING_TABLE_OCTAVES = 32,
    WB_HARDENING_TABLE_LOWEST = -31,
    WB_HARDENING_TABLE_MOST_TERMS = 8
};

/* Fills (terms x WB_HARDENING_TABLE_OCTAVES), of 1 to WB_HARDENING_TABLE_MOST_TERMS terms: in each
 * octave of x = c / E, from 2^-31 to 2, a polynomial in t = m - 3/2 of the mantissa m of x (1 to
 * 2), which is r. With 3 mu for E the table is that of stresses returned radially: then x = e -
 * sigma_Y / (3 mu) + p0, with the equivalent strain e of the elastic trial (its stress over 3 mu),
 * and the plastic strain after the step is p = r x.
 *
 * All zero when the surface does not grow. WB_ERR_UNSUPPORTED when the stress is not as good as
 * 1e-5: small exponents, below about 0.15 with 7 terms and 0.5 with 6. */
WB_MUST_CHECK enum wb_status wb_hardening_tabulate_octaves(const struct wb_material *radial,
                                                           int terms, double *table);

#endif
