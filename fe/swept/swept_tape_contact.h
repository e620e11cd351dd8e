/* Contact with friction between a tape and the wires it is not bonded to, or no longer: where it
 * spans a gap and comes to lie on a wire, and after its bond broke (fe/swept/swept_cohesion.h).
 *
 * A node of the ring touches the nearest wire, a circle of its contact radius round the centre of
 * its surface nodes. Pressure is K_nn times the depth, which is half the tape's thickness and the
 * radius less the distance from that centre. It is the derivative of an energy: it acts along the
 * radius, and its work is what is stored, wherever the tape slides. The node faces a place y
 * between two surface nodes and between stations, at a distance o from the tape's middle surface.
 * Both are found when the node comes near, and again whenever it has slid by a fiftieth of the
 * radius, which is checked every refresh_interval steps. Until then the centre is found from these
 * two surface nodes. Friction is that of an elastic spring between the surfaces, stretched by the
 * part of g = x - o d - y across d and returned to
 *
 *     mu = mu_k + (mu_s - mu_k) exp(-decay slip rate)                               (eq. 20).
 *
 * Forces on both sides balance exactly, moments of pressure to the round-off of places that are
 * found again, moments of friction as far as g is small beside o. A node may slip by four stations
 * along a wire; then it is in contact with it no more.
 */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_CONTACT_H
#define WB_FE_SWEPT_SWEPT_TAPE_CONTACT_H

#include <stddef.h>

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/friction.h"
#include "fe/swept/swept_cohesion.h"

struct wb_swept_tape_contact_settings {
    double normal_stiffness;     /* Pa/m; 30 N/mm3 */
    double shear_stiffness;      /* of sticking, Pa/m; a third of it */
    struct wb_friction friction; /* 0.4 at any rate */
    double margin;        /* m: gap within which a node is looked after; 0: a twentieth of the
                             smallest radius. Nodes must not come nearer by more between
                             refreshes */
    int refresh_interval; /* steps; 0: 100 */

    struct wb_reason *reason; /* borrowed; holds why a step failed. NULL: that is logged */
};

void wb_swept_tape_contact_default_settings(struct wb_swept_tape_contact_settings *settings);

struct wb_swept_tape_contact; /* opaque */

/* Of wires with a radius of contact. `cohesion` says what is bonded, NULL: nothing; it and the
 * tape, whose precision and instructions are used, must outlive the contact. */
WB_MUST_CHECK enum wb_status
wb_swept_tape_contact_create(struct wb_swept_tape_contact **out, const struct wb_swept_tape *tape,
                             const struct wb_swept_cohesion *cohesion,
                             const struct wb_swept_tape_contact_settings *settings, int n_wires,
                             const struct wb_swept_cohesion_wire *wires);
void wb_swept_tape_contact_destroy(struct wb_swept_tape_contact *contact);

struct wb_swept_tape_contact_sums {
    double normal, tangential; /* J, stored in the springs */
    double friction;           /* J, dissipated in this step */
    double deepest;            /* m, penetration */
};

/* One step: adds forces. `time_step` (s) is the time since the positions of the step before.
 * WB_ERR_DATA when positions are not finite or a node is deeper in a wire than half its radius: the
 * run is lost. */
WB_MUST_CHECK enum wb_status
wb_swept_tape_contact_add_forces(struct wb_swept_tape_contact *contact,
                                 const struct wb_swept_cohesion_fields *fields, double time_step,
                                 struct wb_swept_tape_contact_sums *sums);

/* Saves or restores what a contact of the same tape, wires and settings needs to continue bit for
 * bit. */
void wb_swept_tape_contact_visit(struct wb_swept_tape_contact *contact,
                                 struct wb_checkpoint *checkpoint);

/* Bounds of what contact adds to the largest eigenvalue of M^-1 K, as of cohesion, if all nodes of
 * the ring touched. */
double wb_swept_tape_contact_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                const double *mass, const double *inertia);
double wb_swept_tape_contact_wire_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                     int wire, const double *mass);

#endif
