/* Functions of fe/solid/solid.c that only tests use. */
#ifndef WB_FE_SOLID_SOLID_PRIVATE_H
#define WB_FE_SOLID_SOLID_PRIVATE_H

#include "fe/solid/solid.h"

/* Internal forces of the last equilibrium, (3 n_nodes), N: at supports the reactions plus loads. */
const double *wb_solid_internal_force(const struct wb_solid *solid);

#endif
