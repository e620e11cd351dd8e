/* Contact forces between the wires of a section, from the transverse loads on the wires.
 *
 * Forces p >= 0 of the contacts (N/m along the bundle) balance the load f of each wire in the
 * plane, G p + f = 0. There are more contacts than equations, so equilibrium does not determine
 * them: of all p that balance the loads, the one with the smallest sum of p^2 is taken, which equal
 * springs in the contacts would give. If no p >= 0 balances the loads, the sum of squares of the
 * imbalance is minimised.
 *
 * Method: non-negative least squares by block principal pivoting, starting with the contacts that
 * were pressed at the last call. Source: L. F. Portugal, J. J. Judice, L. N. Vicente, Math. Comp.
 * 63 (1994) 625.
 */
#ifndef WB_FE_SECTION_SECTION_PRESSURE_H
#define WB_FE_SECTION_SECTION_PRESSURE_H

#include "fe/section/section_layout.h"

struct wb_section_pressure; /* opaque */

/* For n places along the bundle, each with its own contacts. The layout is copied. */
struct wb_section_pressure *wb_section_pressure_create(const struct wb_section_layout *layout,
                                                       int n_places);
void wb_section_pressure_destroy(struct wb_section_pressure *pressure); /* accepts NULL */

/* Computes the forces (n_contacts) for the loads (2 n_wires: of each wire upwards and sideways) at
 * a place. Returns the root of the sum of squares, over all wires, of the imbalance (N/m). */
double wb_section_pressure_solve(struct wb_section_pressure *pressure, int place,
                                 const double *load, double *force);

#endif
