/* Stress of one material point under an axial strain: the slow reference of the fibres of beams and
 * rods, and of the points of solids. */
#ifndef WB_TESTS_TWIN_MATERIAL_STRESS_H
#define WB_TESTS_TWIN_MATERIAL_STRESS_H

#include <math.h>

#include "fe/material/hardening.h"
#include "fe/material/material.h"

/* Relative distance to the yield surface below which a point counts as elastic: a point that was
 * returned to the surface and did not move since must not see the plastic tangent by round-off. */
#define ON_SURFACE 1e-12

/* The yield surface grows. */
static inline void respond_growing(const struct wb_material *m, double trial,
                                   const struct wb_material_state *before,
                                   struct wb_material_state *after, double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double p0 = before->accumulated_plastic_strain;
    const double yield = wb_material_flow_stress(m, p0);
    if (!(fabs(trial) - yield > ON_SURFACE * yield))
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
static inline void respond_moving(const struct wb_material *m, double trial,
                                  struct wb_material_state *after, double *stress, double *tangent)
{
    const double E = m->youngs_modulus;
    const double H = wb_hardening_back_modulus(m);
    const double over = fabs(trial - after->back_stress) - m->yield_stress;
    if (!(over > ON_SURFACE * m->yield_stress))
        return;

    const double sign = trial < after->back_stress ? -1.0 : 1.0;
    const double increment = over / (E + H);

    *stress = trial - sign * E * increment;
    *tangent = E * H / (E + H);
    after->plastic_strain += sign * increment;
    after->accumulated_plastic_strain += increment;
    after->back_stress += sign * H * increment;
}

/* Stress and consistent tangent of one point at a total strain, from the history `before`; `after`
 * receives the history if the step is accepted (it may alias `before`). Exact return mapping to
 * round-off; backward Euler. */
static inline void wb_material_stress(const struct wb_material *material, double strain,
                                      const struct wb_material_state *before,
                                      struct wb_material_state *after, double *stress,
                                      double *tangent)
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

#endif
