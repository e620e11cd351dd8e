/* Forces between the wires of a section, from what presses them together.
 *
 * Forces p >= 0 of the contacts (N/m along the bundle) balance the load f of each wire in the
 * plane, G p + f = 0. There are more contacts than equations, so that equilibrium alone does not
 * say them; of all forces that balance the loads the model takes those with the least sum of p^2,
 * as equal springs in the contacts would. Where no forces p >= 0 balance the loads, the sum of the
 * squares of what is missing is the least.
 *
 * Method: non-negative least squares by block principal pivoting, begun with the contacts that were
 * pressed the last time. Source: L. F. Portugal, J. J. Judice, L. N. Vicente, Math. Comp. 63 (1994)
 * 625.
 */
#ifndef WB_FE_SECTION_SECTION_PRESSURE_H
#define WB_FE_SECTION_SECTION_PRESSURE_H

#include "fe/section/section_layout.h"

struct wb_section_pressure; /* opaque */

/* For n places along the bundle, each with contacts of its own. The layout is copied. */
struct wb_section_pressure *wb_section_pressure_create(const struct wb_section_layout *layout,
                                                       int n_places);
void wb_section_pressure_destroy(struct wb_section_pressure *pressure); /* accepts NULL */

/* Forces (n_contacts) of the loads (2 n_wires: of each wire upwards and across) at a place. Returns
 * the root of the sum of squares, over all wires, of what is missing (N/m). */
double wb_section_pressure_solve(struct wb_section_pressure *pressure, int place,
                                 const double *load, double *force);

#endif
