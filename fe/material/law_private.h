/* Functions for the tests of fe/material/law.h. */
#ifndef WB_FE_MATERIAL_LAW_PRIVATE_H
#define WB_FE_MATERIAL_LAW_PRIVATE_H

#include "fe/material/law.h"

/* As wb_law_virgin_stress(), of an overlay. */
double wb_law_overlay_stress(const struct wb_overlay *overlay, double strain, double *tangent);

#endif
