/* What tests of fe/solid/solid.h ask beside it. */
#ifndef WB_FE_SOLID_SOLID_PRIVATE_H
#define WB_FE_SOLID_SOLID_PRIVATE_H

#include "fe/solid/solid.h"

/* Of the last equilibrium, (3 n_nodes), N: at supports the reactions plus loads. */
const double *wb_solid_internal_force(const struct wb_solid *solid);

#endif
