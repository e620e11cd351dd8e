#include "fe/material/material.h"

#include <math.h>

#include "fe/material/hardening.h"

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
