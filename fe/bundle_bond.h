/* The tape's hold on the wires of a bundle: which ring node faces which wire, and the interface
 * between them (fe/swept_cohesion.h).
 */
#ifndef WB_FE_BUNDLE_BOND_H
#define WB_FE_BUNDLE_BOND_H

#include "base/status.h"
#include "fe/bundle.h"

struct wb_bundle_bond; /* opaque */

struct wb_bundle_bond_energies {
    double stored, dissipated; /* J: of the interface; the latter in this step */
};

/* For a bundle whose wires and ring are made. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out,
                                                   struct wb_bundle *bundle);
void wb_bundle_bond_destroy(struct wb_bundle_bond *bond); /* accepts NULL */

/* Adds the interface's forces to the ring's and the wires' at their present positions. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                                       struct wb_bundle_bond_energies *energies);

/* Bounds of what it adds to the largest squared frequency, 1/s2: of a wire whose section nodes have
 * the masses given (kg at an inner station, scaled), and of the ring. */
double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass);
double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond);

#endif
