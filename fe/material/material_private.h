/* Functions for the tests of fe/material/material.h. */
#ifndef WB_FE_MATERIAL_MATERIAL_PRIVATE_H
#define WB_FE_MATERIAL_MATERIAL_PRIVATE_H

#include "fe/material/material.h"

/* Stress and consistent tangent of one point at a total strain, from the history `before`;
 * `after` receives the history if the step is accepted (it may alias `before`). Exact return
 * mapping to round-off; backward Euler. Pure. */
void wb_material_stress(const struct wb_material *material, double strain,
                        const struct wb_material_state *before, struct wb_material_state *after,
                        double *stress, double *tangent);

#endif
