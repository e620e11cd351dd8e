#include "fe/material/material.h"

#include <math.h>

#include "fe/material/hardening.h"

/* Relative distance to the yield surface below which a point counts as elastic: a point that was
 * returned to the surface and did not move since must not see the plastic tangent by round-off. */
static const double on_surface = 1e-12;

static void respond_isotropic(const struct wb_material *m, double trial,
                              const struct wb_material_state *before,
                              struct wb_material_state *after, double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double n = m->hardening_exponent;
    const double p0 = before->accumulated_plastic_strain;
    const double yield = m->yield_stress + (p0 > 0.0 ? m->strength_coefficient * pow(p0, n) : 0.0);
    if (!(fabs(trial) - yield > on_surface * yield))
        return;

    const double c = fabs(trial) - m->yield_stress + E * p0;
    const double r = wb_hardening_ratio(m, c);
    const double p = r * c / E;
    const double sign = trial < 0.0 ? -1.0 : 1.0;

    *stress = sign * (m->yield_stress + (1.0 - r) * c);
    *tangent = E * n * (1.0 - r) / (r + n * (1.0 - r));
    after->plastic_strain += sign * (p - p0);
    after->accumulated_plastic_strain = p;
}

static void respond_kinematic(const struct wb_material *m, double trial,
                              struct wb_material_state *after, double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double H = m->strength_coefficient;
    const double over = fabs(trial - after->back_stress) - m->yield_stress;
    if (!(over > on_surface * m->yield_stress))
        return;

    const double sign = trial < after->back_stress ? -1.0 : 1.0;
    const double increment = over / (E + H);

    *stress = trial - sign * E * increment;
    *tangent = E * H / (E + H);
    after->plastic_strain += sign * increment;
    after->accumulated_plastic_strain += increment;
    after->back_stress += sign * H * increment;
}

void wb_material_stress(const struct wb_material *material, double strain,
                        const struct wb_material_state *before, struct wb_material_state *after,
                        double *stress, double *tangent)
{
    const double E = material->youngs_modulus;
    const double trial = E * (strain - before->plastic_strain);

    *stress = trial;
    *tangent = E;
    const struct wb_material_state start = *before;
    *after = start;
    switch (material->hardening) {
    case WB_HARDENING_NONE_ELASTIC:
        break;
    case WB_HARDENING_ISOTROPIC_POWER:
        respond_isotropic(material, trial, &start, after, stress, tangent);
        break;
    case WB_HARDENING_KINEMATIC_LINEAR:
        respond_kinematic(material, trial, after, stress, tangent);
        break;
    }
}

double wb_material_flow_stress(const struct wb_material *material, double plastic_strain)
{
    if (material->hardening != WB_HARDENING_ISOTROPIC_POWER)
        return (double)INFINITY;
    const double p = fmax(0.0, plastic_strain);
    return material->yield_stress +
           (p > 0.0 ? material->strength_coefficient * pow(p, material->hardening_exponent) : 0.0);
}
