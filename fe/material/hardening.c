#include "fe/material/hardening.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* ln r is found by Newton's method on h(q) = ln(e^q + k e^(n q)), which is increasing, nearly
 * straight and convex, so it converges from any start; `q` holds the start and the result. */
static double solve_log_ratio(double k, double n, double q)
{
    for (int iteration = 0; iteration < 60; iteration++) {
        const double a = exp(q);
        const double b = k * exp(n * q);
        const double step = log(a + b) * (a + b) / (a + n * b);
        q -= step;
        if (!(fabs(step) > 1e-15 * (1.0 + fabs(q))))
            break;
    }
    return q;
}

/* The weight of the power term when all of c were elastic strain: K (c / E)^n / c. */
static double power_weight(const struct wb_material *m, double c)
{
    return m->strength_coefficient * pow(c / m->youngs_modulus, m->hardening_exponent) / c;
}

double wb_hardening_ratio(const struct wb_material *material, double overstress)
{
    const double n = material->hardening_exponent;
    const double k = power_weight(material, overstress);
    if (k == 0.0)
        return 1.0;

    /* At this start one of the two terms is 1 and the sum at least 1. */
    const double q = fmin(0.0, -log(k) / n);
    return exp(solve_log_ratio(k, n, q));
}

static double bits_to_double(uint64_t bits)
{
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint64_t double_to_bits(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Newton's divided differences at the Chebyshev nodes of [-1/2, 1/2], expanded to powers. */
static void interpolate(const double *node, const double *value, double *coefficient)
{
    enum {
        N = WB_HARDENING_TERMS
    };
    double d[N];

    for (int i = 0; i < N; i++)
        d[i] = value[i];
    for (int j = 1; j < N; j++) {
        for (int i = N - 1; i >= j; i--)
            d[i] = (d[i] - d[i - 1]) / (node[i] - node[i - j]);
    }

    for (int i = 0; i < N; i++)
        coefficient[i] = 0.0;
    for (int i = N - 1; i >= 0; i--) {
        for (int j = N - 1; j >= 1; j--)
            coefficient[j] = coefficient[j - 1] - node[i] * coefficient[j];
        coefficient[0] = d[i] - node[i] * coefficient[0];
    }
}

void wb_hardening_tabulate(struct wb_hardening_table *table, const struct wb_material *material)
{
    const double n = material->hardening_exponent;
    /* The nearest singularity of r lies at an angle of about pi n / (1 - n) from the real axis, so
     * small exponents need finer pieces. */
    const int log2_pieces = n < 0.25 ? 6 : n < 0.4 ? 5 : 4;
    const double begin = ldexp(1.0, WB_HARDENING_LOWEST_OCTAVE);

    table->shift = 52 - log2_pieces;
    table->first = (long long)(double_to_bits(begin) >> table->shift);
    table->pieces = (long long)WB_HARDENING_OCTAVES << log2_pieces;

    double node[WB_HARDENING_TERMS];
    for (int i = 0; i < WB_HARDENING_TERMS; i++)
        node[i] = 0.5 * cos(M_PI * (i + 0.5) / WB_HARDENING_TERMS);

    double q = (double)NAN;
    for (long long piece = 0; piece < table->pieces; piece++) {
        const uint64_t low_bits = (uint64_t)(table->first + piece) << table->shift;
        const uint64_t high_bits = (uint64_t)(table->first + piece + 1) << table->shift;
        const double low = bits_to_double(low_bits);
        const double width = bits_to_double(high_bits) - low;

        double value[WB_HARDENING_TERMS];
        for (int i = WB_HARDENING_TERMS - 1; i >= 0; i--) {
            const double c = (low + (node[i] + 0.5) * width) * material->yield_stress;
            const double k = power_weight(material, c);
            if (k == 0.0) {
                value[i] = 1.0;
                continue;
            }
            /* The neighbouring node is a good start. */
            if (!isfinite(q))
                q = fmin(0.0, -log(k) / n);
            q = solve_log_ratio(k, n, q);
            value[i] = exp(q);
        }
        interpolate(node, value, table->coefficients[piece]);
    }
}
