/* How the tape holds the wires of a bundle.
 *
 * A node of the tape's ring that faces a wire is bonded to it by a cohesive interface
 * (fe/swept/swept_cohesion.h). Elsewhere tape and wires touch and rub
 * (fe/swept/swept_tape_contact.h): where the tape spans a gap between wires and comes to lie on one
 * of them, and where damage has broken the bond. The windings of a helix are bonded to each other;
 * these bonds do not break. All have the stiffnesses of the interface.
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

/* Makes bonds and contact for bodies whose wires and ring are made. When a step fails, `reason`
 * holds the reason. Both must outlive the bond. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out,
                                                   struct wb_bundle_bodies *bodies,
                                                   struct wb_reason *reason);
void wb_bundle_bond_destroy(struct wb_bundle_bond *bond); /* accepts NULL */

/* Adds the forces of interface and contact at the present positions to the fields of ring and
 * wires. WB_ERR_DATA if the tape passes through a wire. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                                       struct wb_bundle_bond_energies *energies);

/* Adds two areas, m2, of the bodies' own stations: what was bonded at first, and of that what has
 * lost its bond. */
void wb_bundle_bond_add_areas(const struct wb_bundle_bond *bond, double area[2]);

/* Saves or restores damage and friction. */
void wb_bundle_bond_visit(struct wb_bundle_bond *bond, struct wb_checkpoint *checkpoint);

/* Upper bounds of what bonds and contact add to the largest squared frequency, 1/s2: of a wire,
 * whose section nodes have the masses given (kg at an inner station, scaled), and of the ring. */
double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass);
double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond);

#endif
