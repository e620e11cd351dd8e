/* Connection between the tape and the wires of a bundle.
 *
 * A node of the tape's ring that faces a wire is bonded to it by a cohesive interface
 * (fe/swept/swept_cohesion.h). Elsewhere tape and wires have contact with friction
 * (fe/swept/swept_tape_contact.h): where the tape spans a gap between wires and moves onto one of
 * them, and where damage has broken the bond. The windings of a helix are bonded to each other;
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
    double stored, dissipated; /* J: of the interface; dissipated: by damage, in this step */
    double contact;            /* J, stored in contact, normal and tangential */
    double friction;           /* J, dissipated in this step */
    double deepest;            /* m, penetration of the tape into a wire */
};

/* Creates bonds and contact for bodies that already have wires and ring. When a step fails,
 * `reason` receives the reason. Both must outlive the bond. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_create(struct wb_bundle_bond **out,
                                                   struct wb_bundle_bodies *bodies,
                                                   struct wb_reason *reason);
void wb_bundle_bond_destroy(struct wb_bundle_bond *bond); /* accepts NULL */

/* Adds the forces of interface and contact at the current positions to the fields of ring and
 * wires. WB_ERR_DATA if the tape passes through a wire. */
WB_MUST_CHECK enum wb_status wb_bundle_bond_add_forces(struct wb_bundle_bond *bond,
                                                       struct wb_bundle_bond_energies *energies);

/* Adds two areas of the bodies' own stations, m2: the initially bonded area, and the part of it
 * whose bond is broken. */
void wb_bundle_bond_add_areas(const struct wb_bundle_bond *bond, double area[2]);

/* Saves or restores damage and friction. */
void wb_bundle_bond_visit(struct wb_bundle_bond *bond, struct wb_checkpoint *checkpoint);

/* Upper bounds of the contributions of bonds and contact to the largest squared frequency, 1/s2:
 * for a wire, whose section nodes have the given masses (kg at an inner station, scaled), and for
 * the ring. */
double wb_bundle_bond_wire_stiffness(const struct wb_bundle_bond *bond, int wire,
                                     const double *mass);
double wb_bundle_bond_ring_stiffness(const struct wb_bundle_bond *bond);

#endif
