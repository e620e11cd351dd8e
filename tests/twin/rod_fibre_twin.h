/* The slow twin of fe/rod/rod_fibre.h for isotropic hardening: the increment of plastic strain by
 * bisection, on the power law itself.
 */
#ifndef WB_TESTS_TWIN_ROD_FIBRE_TWIN_H
#define WB_TESTS_TWIN_ROD_FIBRE_TWIN_H

#include "fe/rod/rod_fibre.h"

/* As wb_rod_fibre_respond(). */
void wb_rod_fibre_twin_respond(const struct wb_material *material, const double strain[2],
                               const struct wb_rod_fibre_state *before,
                               struct wb_rod_fibre_state *after,
                               struct wb_rod_fibre_response *response);

#endif
