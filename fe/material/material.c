#include "fe/material/material.h"
#include "fe/material/material_private.h"

#include <math.h>

#include "fe/material/hardening.h"

/* Relative distance to the yield surface below which a point counts as elastic: a point that was
 * returned to the surface and did not move since must not see the plastic tangent by round-off. */
static const double on_surface = 1e-12;

/* The yield surface grows. */
static void respond_growing(const struct wb_material *m, double trial,
                            const struct wb_material_state *before, struct wb_material_state *after,
                            double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double p0 = before->accumulated_plastic_strain;
    const double yield = wb_material_flow_stress(m, p0);
    if (!(fabs(trial) - yield > on_surface * yield))
        return;

    const double c = fabs(trial) - m->yield_stress + E * p0;
    const double r = wb_hardening_ratio(m, c);
    const double p = r * c / E, n = wb_hardening_exponent(m, p);
    const double sign = trial < 0.0 ? -1.0 : 1.0;

    *stress = sign * (m->yield_stress + (1.0 - r) * c);
    *tangent = E * n * (1.0 - r) / (r + n * (1.0 - r));
    after->plastic_strain += sign * (p - p0);
    after->accumulated_plastic_strain = p;
}

/* The yield surface moves. */
static void respond_moving(const struct wb_material *m, double trial,
                           struct wb_material_state *after, double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double H = wb_hardening_back_modulus(m);
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
    const struct wb_hardening_law *law = wb_hardening_law(material);
    if (law->yields && law->moves)
        respond_moving(material, trial, after, stress, tangent);
    else if (law->yields)
        respond_growing(material, trial, &start, after, stress, tangent);
}

double wb_material_shear_modulus(const struct wb_material *material)
{
    return material->youngs_modulus / (2.0 * (1.0 + material->poissons_ratio));
}

double wb_material_von_mises(const double s[6])
{
    const double a = s[0] - s[1], b = s[1] - s[2], c = s[2] - s[0];
    return sqrt(0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

double wb_material_flow_stress(const struct wb_material *material, double plastic_strain)
{
    const struct wb_hardening_law *law = wb_hardening_law(material);
    if (!law->growth)
        return (double)INFINITY;
    return material->yield_stress +
           (plastic_strain > 0.0 ? law->growth(material, plastic_strain) : 0.0);
}
