#include "fe/material/hardening.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

#define WB_LOG_DOMAIN "hardening"

/* --- Ludwik's power law: H = K p^n --- */

static double power_growth(const struct wb_material *m, double p)
{
    return m->strength_coefficient * pow(p, m->hardening_exponent);
}

static double power_mean_growth(const struct wb_material *m, double p)
{
    return power_growth(m, p) / (m->hardening_exponent + 1.0);
}

/* q = ln r is found by Newton's method on h(q) = ln(e^q + k e^(n q)), which is increasing, nearly
 * straight and convex, so it converges from any start. k is the weight of the power term when all
 * of c were elastic strain e^x: K e^(n x) / c. */
static double power_ratio(const struct wb_material *m, double x, double q)
{
    const double n = m->hardening_exponent;
    const double log_k = log(m->strength_coefficient / m->youngs_modulus) + (n - 1.0) * x;

    /* At this start one of the two terms is 1 and the sum at least 1. */
    if (!isfinite(q))
        q = fmin(0.0, -log_k / n);
    for (int iteration = 0; iteration < 60; iteration++) {
        const double a = exp(q);
        const double b = exp(log_k + n * q);
        const double step = log(a + b) * (a + b) / (a + n * b);
        /* The remaining error is below the square of the step. */
        if (!(fabs(step) > 1e-8))
            return a - a * step;
        q -= step;
    }
    return exp(q);
}

/* --- linear kinematic hardening (Prager): the back stress moves by K d(ep) --- */

static double prager_back_modulus(const struct wb_material *m)
{
    return m->strength_coefficient;
}

/* --- the laws --- */

const struct wb_hardening_parameter wb_hardening_parameters[WB_HARDENING_PARAMETERS] = {
    [WB_HARDENING_STRENGTH] = {"strength_coefficient", " Pa", "0 or more", 0.0, DBL_MAX,
                               "strength_coefficient_MPa", WB_MPA, 0.0, 1e9,
                               offsetof(struct wb_material, strength_coefficient)},
    [WB_HARDENING_EXPONENT] = {"hardening_exponent", "", "above 0, at most 2", DBL_TRUE_MIN, 2.0,
                               "hardening_exponent", 1.0, 1e-3, 2.0,
                               offsetof(struct wb_material, hardening_exponent)},
};

const struct wb_hardening_law wb_hardening_laws[WB_HARDENING_LAWS] = {
    [WB_HARDENING_NONE_ELASTIC] = {.name = NULL},
    [WB_HARDENING_ISOTROPIC_POWER] =
        {.name = "isotropic",
         .yields = true,
         .has = {[WB_HARDENING_STRENGTH] = true, [WB_HARDENING_EXPONENT] = true},
         .may_be_perfect = true,
         .growth = power_growth,
         .mean_growth = power_mean_growth,
         .ratio = power_ratio},
    [WB_HARDENING_KINEMATIC_LINEAR] = {.name = "kinematic",
                                       .yields = true,
                                       .moves = true,
                                       .has = {[WB_HARDENING_STRENGTH] = true},
                                       .back_modulus = prager_back_modulus},
};

bool wb_hardening_is_possible(const struct wb_material *material, char *why, size_t size)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    struct wb_material copy = *material;

    if (law->yields && !(isfinite(material->yield_stress) && material->yield_stress > 0.0)) {
        snprintf(why, size, "yield_stress %g Pa: expected a number above 0",
                 material->yield_stress);
        return false;
    }
    for (int i = 0; i < WB_HARDENING_PARAMETERS; i++) {
        const struct wb_hardening_parameter *parameter = &wb_hardening_parameters[i];
        const double value = *wb_hardening_value(&copy, i);
        if (law->has[i] && !(value >= parameter->least && value <= parameter->largest)) {
            snprintf(why, size, "%s %g%s: expected %s", parameter->name, value, parameter->unit,
                     parameter->expected);
            return false;
        }
    }
    return true;
}

double wb_hardening_mean_stress(const struct wb_material *material, double p)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    return material->yield_stress + (law->mean_growth ? law->mean_growth(material, p) : 0.0);
}

double wb_hardening_ratio(const struct wb_material *material, double overstress)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    return law->ratio
               ? law->ratio(material, log(overstress / material->youngs_modulus), (double)NAN)
               : 1.0;
}

/* --- tables --- */

static uint64_t double_to_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* The Chebyshev nodes of [-1/2, 1/2], and one over what lies between node i and node i - j. */
struct nodes {
    int n;
    double at[WB_HARDENING_TABLE_MOST_TERMS];
    double over[WB_HARDENING_TABLE_MOST_TERMS][WB_HARDENING_TABLE_MOST_TERMS]; /* [j][i] */
};

static void find_nodes(struct nodes *nodes, int n)
{
    nodes->n = n;
    for (int i = 0; i < n; i++)
        nodes->at[i] = 0.5 * cos(M_PI * (i + 0.5) / n);
    for (int j = 1; j < n; j++) {
        for (int i = j; i < n; i++)
            nodes->over[j][i] = 1.0 / (nodes->at[i] - nodes->at[i - j]);
    }
}

/* Newton's divided differences at the nodes, in place of the values, expanded to powers. */
static void interpolate(const struct nodes *nodes, double *value, double *coefficient)
{
    const int n = nodes->n;
    for (int j = 1; j < n; j++) {
        for (int i = n - 1; i >= j; i--)
            value[i] = (value[i] - value[i - 1]) * nodes->over[j][i];
    }
    for (int i = 0; i < n; i++)
        coefficient[i] = 0.0;
    for (int i = n - 1; i >= 0; i--) {
        for (int j = n - 1; j >= 1; j--)
            coefficient[j] = coefficient[j - 1] - nodes->at[i] * coefficient[j];
        coefficient[0] = value[i] - nodes->at[i] * coefficient[0];
    }
}

/* ln r at x + h from r at x, to third order: of a power law d(ln p)/d(ln c) = 1 / (r + n (1 - r)).
 */
static double follow_ratio(double n, double r, double h)
{
    const double s = 1.0 / (n + (1.0 - n) * r);
    const double slope = s - 1.0, ds = (1.0 - n) * r * slope;
    const double second = -ds * s * s;
    const double third = (2.0 * ds * ds * s - (1.0 - n) * r * (slope * slope + second)) * s * s;
    return log(r) + h * (slope + 0.5 * h * (second + h * (1.0 / 3.0) * third));
}

void wb_hardening_tabulate(struct wb_hardening_table *table, const struct wb_material *material)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    const double n = wb_hardening_exponent(material, 1.0);
    /* The nearest singularity of a power law's r lies at an angle of about pi n / (1 - n) from the
     * real axis, so small exponents need finer pieces. */
    const int log2_pieces = n < 0.25 ? 6 : n < 0.4 ? 5 : 4, in_octave = 1 << log2_pieces;
    const double begin =
        log(material->yield_stress / material->youngs_modulus) + WB_HARDENING_LOWEST_OCTAVE * M_LN2;
    double log_mantissa[WB_HARDENING_MAX_PIECES][WB_HARDENING_TERMS];
    struct nodes nodes;

    table->shift = 52 - log2_pieces;
    table->first =
        (long long)(double_to_bits(ldexp(1.0, WB_HARDENING_LOWEST_OCTAVE)) >> table->shift);
    table->pieces = (long long)WB_HARDENING_OCTAVES << log2_pieces;
    find_nodes(&nodes, WB_HARDENING_TERMS);
    for (int piece = 0; piece < in_octave; piece++) {
        for (int i = 0; i < WB_HARDENING_TERMS; i++)
            log_mantissa[piece][i] = log1p((piece + 0.5 + nodes.at[i]) / in_octave);
    }

    double r = (double)NAN, last = 0.0;
    for (long long piece = 0; piece < table->pieces; piece++) {
        double value[WB_HARDENING_TERMS];
        for (int i = WB_HARDENING_TERMS - 1; i >= 0; i--) {
            const double x = begin + (double)(piece >> log2_pieces) * M_LN2 +
                             log_mantissa[piece & (in_octave - 1)][i];
            r = law->ratio(material, x, follow_ratio(n, r, x - last));
            last = x;
            value[i] = r;
        }
        interpolate(&nodes, value, table->coefficients[piece]);
    }
}

/* Largest error of the stress in an octave, as a part of the stress. */
static double octave_error(const struct wb_material *radial, double begin, int terms,
                           const double *coefficient)
{
    double worst = 0.0;

    for (int i = 0; i <= 16; i++) {
        const double t = (i - 8) / 16.0, c = begin * (t + 1.5) * radial->youngs_modulus;
        const double exact = wb_hardening_ratio(radial, c);
        double r = 0.0;
        for (int k = terms - 1; k >= 0; k--)
            r = r * t + coefficient[k];
        const double error = fabs(r - exact) * c / (radial->yield_stress + (1.0 - exact) * c);
        if (!isfinite(error))
            return (double)INFINITY;
        worst = fmax(worst, error);
    }
    return worst;
}

enum wb_status wb_hardening_tabulate_octaves(const struct wb_material *radial, int terms,
                                             double *table)
{
    static const double tolerance = 1e-5;
    double value[WB_HARDENING_TABLE_MOST_TERMS];
    double coefficient[WB_HARDENING_TABLE_MOST_TERMS], worst = 0.0;
    struct nodes nodes;
    bool is_good = true;

    memset(table, 0, (size_t)terms * WB_HARDENING_TABLE_OCTAVES * sizeof *table);
    if (!wb_hardening_law(radial)->growth)
        return WB_OK;
    find_nodes(&nodes, terms);
    for (int octave = 0; octave < WB_HARDENING_TABLE_OCTAVES; octave++) {
        const double begin = ldexp(1.0, WB_HARDENING_TABLE_LOWEST + octave);
        for (int i = 0; i < terms; i++)
            value[i] =
                wb_hardening_ratio(radial, begin * (nodes.at[i] + 1.5) * radial->youngs_modulus);
        interpolate(&nodes, value, coefficient);
        const double error = octave_error(radial, begin, terms, coefficient);
        is_good = is_good && error <= tolerance;
        worst = fmax(worst, error);
        for (int k = 0; k < terms; k++)
            table[k * WB_HARDENING_TABLE_OCTAVES + octave] = coefficient[k];
    }
    if (!is_good)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the hardening law (K = %g Pa, n = %g) cannot be tabulated: error %.1e",
                       radial->strength_coefficient, radial->hardening_exponent, worst);
    return WB_OK;
}
