#include "analysis/predict/specimens.h"
#include "analysis/predict/specimens_private.h"

#include <math.h>

#include <gsl/gsl_cdf.h>

enum {
    QUANTITIES = WB_SPECIMENS_QUANTITIES
};

static const double strain[2] = {1e-3, 1e-2}; /* plastic strains of the two stresses */
static const double least_exponent = 1e-3;
static const double most_of_exponents = 2.0, most_straight = 1.0; /* largest n */
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

bool wb_specimens_take(struct wb_specimens *specimens, const struct wb_properties *properties)
{
    const struct wb_material *law[WB_SPECIMENS_MOST];
    if (properties->n_specimens < WB_SPECIMENS_LEAST)
        return false;
    for (int i = 0; i < properties->n_specimens; i++)
        law[i] = &properties->specimens[i].ludwik;
    wb_specimens_init(specimens, properties->n_specimens, law);
    return true;
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

/* --- laws of other forms --- */

double wb_specimens_most_exponent(double isotropic_share, bool is_combined)
{
    return isotropic_share == 1.0 || is_combined ? most_of_exponents : most_straight;
}

/* Two Ludwik laws, from the specimens' mean and from a draw. */
struct change {
    struct wb_law from, to;
};

static double modulus_ratio(const struct change *change)
{
    return change->to.material.youngs_modulus / change->from.material.youngs_modulus;
}

static double stress_ratio(const struct change *change, double e)
{
    return wb_law_virgin_stress(&change->to, e, NULL) /
           wb_law_virgin_stress(&change->from, e, NULL);
}

/* Slope of the changed curve up to the yield strain of part `i`, from that of the part before. */
static double changed_slope(const struct change *change, const struct wb_law *nominal, int i)
{
    double at[2] = {0.0, nominal->parts[i].yield_strain}, stress[2] = {0.0, 0.0}, tangent[2];
    if (i > 0)
        at[0] = nominal->parts[i - 1].yield_strain;
    for (int k = 0; k < 2; k++)
        if (at[k] > 0.0 && isfinite(at[k]))
            stress[k] =
                wb_law_virgin_stress(nominal, at[k], &tangent[k]) * stress_ratio(change, at[k]);
    if (isfinite(at[1]))
        return (stress[1] - stress[0]) / (at[1] - at[0]);
    return i > 0 ? tangent[0] * stress_ratio(change, at[0])
                 : nominal->material.youngs_modulus * modulus_ratio(change);
}

/* A part has the drop of the slope at its yield strain; none where the changed slope rises. */
static void change_parts(const struct change *change, struct wb_law *law)
{
    const struct wb_law nominal = *law;
    const double kept = law->is_combined ? law->isotropic_share : 0.0;
    const int last = law->n_parts - 1;
    double slope = changed_slope(change, &nominal, 0), others = 0.0;

    for (int i = 0; i < last; i++) {
        const double drop = fmax(slope - changed_slope(change, &nominal, i + 1), 0.0);
        law->parts[i].modulus = drop / (1.0 - kept);
        others += law->parts[i].modulus;
        slope -= drop;
    }
    law->parts[last].modulus = fmax(slope - kept * others, 0.0);
    law->material.youngs_modulus = others + law->parts[last].modulus;
}

/* Stress beyond sigma_Y on a first loading, at a plastic strain. */
static double chaboche_hardening(const struct wb_law *law, double plastic)
{
    double stress = -law->saturation * expm1(-law->rate * plastic);
    for (int i = 0; i < law->n_backs; i++) {
        const struct wb_law_back *const back = &law->backs[i];
        stress += back->recovery > 0.0
                      ? -back->modulus / back->recovery * expm1(-back->recovery * plastic)
                      : back->modulus * plastic;
    }
    return stress;
}

static void change_chaboche(const struct change *change, struct wb_law *law)
{
    const double stress =
        wb_law_virgin_stress(law, strain[1], NULL) * stress_ratio(change, strain[1]);
    law->material.youngs_modulus *= modulus_ratio(change);
    law->material.yield_stress *=
        change->to.material.yield_stress / change->from.material.yield_stress;
    const double plastic = strain[1] - stress / law->material.youngs_modulus;
    const double before = plastic > 0.0 ? chaboche_hardening(law, plastic) : 0.0;
    if (!(before > 0.0))
        return;
    const double factor = fmax(stress - law->material.yield_stress, 0.0) / before;
    law->saturation *= factor;
    for (int i = 0; i < law->n_backs; i++)
        law->backs[i].modulus *= factor;
}

bool wb_specimens_shift(const struct wb_specimens *specimens, const double q[QUANTITIES],
                        struct wb_law *law)
{
    const double most = wb_specimens_most_exponent(law->isotropic_share, law->is_combined);
    struct wb_material material = {.hardening = WB_HARDENING_ISOTROPIC_POWER};
    struct change change;
    double own[QUANTITIES];
    if (law->form == WB_LAW_LUDWIK) {
        wb_specimens_quantities(&law->material, own);
        for (int k = 0; k < QUANTITIES; k++)
            own[k] += q[k] - specimens->mean[k];
        for (int i = 0; i < law->n_maxwell; i++)
            law->maxwell[i].modulus *= exp(q[0] - specimens->mean[0]);
        return wb_specimens_law(own, most, &law->material);
    }
    (void)wb_specimens_law(specimens->mean, most_of_exponents, &material);
    wb_law_init_ludwik(&change.from, &material);
    const bool is_law = wb_specimens_law(q, most_of_exponents, &material);
    wb_law_init_ludwik(&change.to, &material);
    if (law->form == WB_LAW_PARALLEL)
        change_parts(&change, law);
    else
        change_chaboche(&change, law);
    for (int i = 0; i < law->n_maxwell; i++)
        law->maxwell[i].modulus *= modulus_ratio(&change);
    return is_law;
}
