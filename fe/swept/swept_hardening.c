#include "fe/swept/swept_hardening.h"

#include <math.h>
#include <stdbool.h>

#include "fe/material/hardening.h"

#define WB_LOG_DOMAIN "swept"

enum {
    TERMS = WB_SWEPT_HARDENING_TERMS,
    OCTAVES = WB_SWEPT_HARDENING_OCTAVES
};

static const double tolerance = 1e-5;

/* Newton's divided differences at the nodes of Chebyshev, expanded to powers of t. */
static void tabulate_octave(const struct wb_material *radial, double begin, double *coefficient)
{
    double t[TERMS], d[TERMS];

    for (int i = 0; i < TERMS; i++) {
        t[i] = 0.5 * cos(M_PI * (i + 0.5) / TERMS);
        d[i] = wb_hardening_ratio(radial, begin * (t[i] + 1.5) * radial->youngs_modulus);
        coefficient[i] = 0.0;
    }
    for (int j = 1; j < TERMS; j++) {
        for (int i = TERMS - 1; i >= j; i--)
            d[i] = (d[i] - d[i - 1]) / (t[i] - t[i - j]);
    }
    for (int i = TERMS - 1; i >= 0; i--) {
        for (int j = TERMS - 1; j >= 1; j--)
            coefficient[j] = coefficient[j - 1] - t[i] * coefficient[j];
        coefficient[0] = d[i] - t[i] * coefficient[0];
    }
}

/* Largest error of the stress in an octave, as a part of the stress. */
static double octave_error(const struct wb_material *radial, double begin,
                           const double *coefficient)
{
    double worst = 0.0;

    for (int i = 0; i <= 16; i++) {
        const double t = (i - 8) / 16.0, c = begin * (t + 1.5) * radial->youngs_modulus;
        const double exact = wb_hardening_ratio(radial, c);
        double r = 0.0;
        for (int k = TERMS - 1; k >= 0; k--)
            r = r * t + coefficient[k];
        const double error = fabs(r - exact) * c / (radial->yield_stress + (1.0 - exact) * c);
        if (!(error <= worst))
            worst = error;
    }
    return worst;
}

enum wb_status wb_swept_hardening_tabulate(const struct wb_material *material,
                                           double table[TERMS][OCTAVES])
{
    struct wb_material radial = *material;
    double worst = 0.0;
    bool good = true;

    radial.youngs_modulus *= 1.5 / (1.0 + material->poissons_ratio);
    for (int i = 0; i < OCTAVES; i++) {
        const double begin = ldexp(1.0, WB_SWEPT_HARDENING_LOWEST_OCTAVE + i);
        double coefficient[TERMS] = {0.0};
        if (material->hardening == WB_HARDENING_ISOTROPIC_POWER) {
            tabulate_octave(&radial, begin, coefficient);
            const double error = octave_error(&radial, begin, coefficient);
            good &= error <= tolerance;
            worst = fmax(worst, error);
        }
        for (int k = 0; k < TERMS; k++)
            table[k][i] = coefficient[k];
    }
    if (!good)
        return wb_fail(WB_ERR_UNSUPPORTED,
                       "the hardening law (K = %g Pa, n = %g) cannot be tabulated: error %.1e",
                       radial.strength_coefficient, radial.hardening_exponent, worst);
    return WB_OK;
}
