/* What tests of fe/rod/rod.h ask beside it. */
#ifndef WB_FE_ROD_ROD_PRIVATE_H
#define WB_FE_ROD_ROD_PRIVATE_H

#include "fe/rod/rod.h"

/* Turns the clamp: a unit quaternion, scalar first. The trial state turns with it. */
void wb_rod_set_clamp(struct wb_rod *rod, const double rotation[4]);

/* Gauss point `g` (0 .. 2 n_elements - 1), from the clamp, of the state last evaluated. */
const struct wb_rod_point *wb_rod_point(const struct wb_rod *rod, int g);

/* Elastic energy of the committed state, and plastic work dissipated since the virgin one, J. Needs
 * has_balance; zero without. */
void wb_rod_energy(const struct wb_rod *rod, double *stored, double *dissipated);

#endif
