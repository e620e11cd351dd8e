#include "analysis/predict/specimens.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

enum {
    QUANTITIES = WB_SPECIMENS_QUANTITIES
};

static const double strain[2] = {1e-3, 1e-2}; /* plastic strains of the two stresses */
static const double least_exponent = 1e-3;
static const double nothing = 1e-9; /* of sigma_Y: a smaller overstress counts as zero */

void wb_specimens_quantities(const struct wb_material *law, double q[QUANTITIES])
{
    q[0] = log(law->youngs_modulus);
    q[1] = log(law->yield_stress);
    for (int k = 0; k < 2; k++)
        q[2 + k] = log(law->yield_stress +
                       law->strength_coefficient * pow(strain[k], law->hardening_exponent));
}

bool wb_specimens_law(const double q[QUANTITIES], double most_exponent, struct wb_material *law)
{
    const double yield = exp(q[1]), least = nothing * yield;
    const double over[2] = {exp(q[2]) - yield, exp(q[3]) - yield};

    law->youngs_modulus = exp(q[0]);
    law->yield_stress = yield;
    if (over[1] < least) { /* ideal plasticity, or softening */
        law->strength_coefficient = 0.0;
        law->hardening_exponent = 1.0;
        return over[1] > -least;
    }
    const double n = log(over[1] / fmax(over[0], least)) / log(strain[1] / strain[0]);
    law->hardening_exponent = fmin(fmax(n, least_exponent), most_exponent);
    /* The stress at the larger strain is kept. */
    law->strength_coefficient = over[1] / pow(strain[1], law->hardening_exponent);
    return law->hardening_exponent == n;
}

void wb_specimens_init(struct wb_specimens *specimens, int n, const struct wb_material *const *law)
{
    *specimens = (struct wb_specimens){.n = n};
    for (int i = 0; i < n; i++) {
        wb_specimens_quantities(law[i], specimens->deviation[i]);
        for (int k = 0; k < QUANTITIES; k++)
            specimens->mean[k] += specimens->deviation[i][k] / n;
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < QUANTITIES; k++)
            specimens->deviation[i][k] -= specimens->mean[k];
}

int wb_specimens_dimensions(const struct wb_specimens *specimens)
{
    return specimens->n + 1;
}

void wb_specimens_draw(const struct wb_specimens *specimens, int wires, const double *u,
                       double q[QUANTITIES])
{
    const int n = specimens->n;
    const double chi_squared = gsl_cdf_chisq_Pinv(u[n], n - 1);
    const double scale = sqrt((1.0 / n + 1.0 / wires) / chi_squared);

    for (int k = 0; k < QUANTITIES; k++)
        q[k] = specimens->mean[k];
    for (int i = 0; i < n; i++) {
        const double z = gsl_cdf_ugaussian_Pinv(u[i]);
        for (int k = 0; k < QUANTITIES; k++)
            q[k] += scale * z * specimens->deviation[i][k];
    }
}
