/* The tape's hold on the wires of a bundle: which ring node faces which wire, the interface between
 * them (fe/swept/swept_cohesion.h), and contact with friction where there is none, or none any more
 * (fe/swept/swept_tape_contact.h): where the tape spans a gap between wires and comes to lie on one
 * of them, and where damage has broken the bond.
 *
 * Contact has the interface's stiffnesses, and so has what bonds the windings of a helix to each
 * other; that does not break.
 */
#ifndef WB_FE_BUNDLE_BUNDLE_BOND_H
#define WB_FE_BUNDLE_BUNDLE_BOND_H

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/bundle/bundle_body.h"

struct wb_bundle_bond; /* opaque */

struct wb_bundle_bond_energies {
    double stored, dissipated; /* J: of the interface; the latter by damage, in this step */
    double contact;            /* J, stored in contact, normal and tangential */
    double friction;           /* J, dissipated in this step */
    double deepest;            /* m, penetration of the tape into a wire */
};

/* For bodies whose wires and ring are made. `reason` gets why a step was lost. Both must outlive
 * it.
 */
WB_MUST_CHECK enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out,
                                                   struct wb_bundle_bodies *bodies,
                                                   struct wb_reason *reason);
void wb_bundle_bond_destroy(struct wb_bundle_bond *bond); /* accepts NULL */

/* Adds the forces of interface and contact to the ring's and the wires' at their present positions.
 * WB_ERR_DATA when the tape passes through a wire. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                                       struct wb_bundle_bond_energies *energies);

/* Adds the areas that were bonded at first, and whose bond is broken, m2, of the bodies' own
 * stations. */
void wb_bundle_bond_add_areas(const struct wb_bundle_bond *bond, double area[2]);

/* Saves or restores damage and friction. */
void wb_bundle_bond_visit(struct wb_bundle_bond *bond, struct wb_checkpoint *checkpoint);

/* Bounds of what it adds to the largest squared frequency, 1/s2: of a wire whose section nodes have
 * the masses given (kg at an inner station, scaled), and of the ring. */
double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass);
double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond);

#endif
