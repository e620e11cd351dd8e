/* Functions of fe/rod/rod.c that only tests use. */
#ifndef WB_FE_ROD_ROD_PRIVATE_H
#define WB_FE_ROD_ROD_PRIVATE_H

#include "fe/rod/rod.h"

/* Rotates the clamp (unit quaternion, scalar first) and the trial state with it. */
void wb_rod_set_clamp(struct wb_rod *rod, const double rotation[4]);

/* Gauss point `g` (0 .. 2 n_elements - 1), from the clamp, in the state last evaluated. */
const struct wb_rod_point *wb_rod_point(const struct wb_rod *rod, int g);

#endif
