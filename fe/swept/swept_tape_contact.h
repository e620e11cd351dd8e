/* Contact with friction between a tape and wires without a bond: where the tape spans a gap and
 * moves onto a wire, and after its bond broke (fe/swept/swept_cohesion.h).
 *
 * A node of the ring touches the nearest wire, a circle of its contact radius around the centre of
 * its surface nodes. Pressure is K_nn times the penetration: the radius plus half the tape's
 * thickness minus the distance from that centre. It is the derivative of an energy: it acts along
 * the radius, and its work is stored, for any sliding of the tape. The contact point y lies between
 * two surface nodes and between stations, at a distance o from the tape's middle surface. It is
 * determined when the node comes near, and again whenever it has slid by a fiftieth of the radius,
 * which is checked every refresh_interval steps. Until then the centre is computed from these two
 * surface nodes. Friction is that of an elastic spring between the surfaces, stretched by the
 * component of g = x - o d - y perpendicular to d and returned to
 *
 *     mu = mu_k + (mu_s - mu_k) exp(-decay slip rate)                               (eq. 20).
 *
 * Forces on both sides balance exactly, moments of pressure except for the small error of updated
 * contact points, moments of friction if g is small compared with o. A node may slip by up to four
 * stations along a wire; beyond that it loses contact.
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
    double normal_stiffness; /* Pa/m */
    double shear_stiffness;  /* of sticking, Pa/m */
    struct wb_friction friction;
    double margin; /* m: gap within which a node is tracked; 0: a twentieth of the smallest radius.
                      Nodes must not approach by more than this between refreshes */
    int refresh_interval; /* steps; 0: 100 */

    /* Borrowed; receives the reason of a failed step. NULL: the reason is logged. */
    struct wb_reason *reason;
};

struct wb_swept_tape_contact; /* opaque */

/* Creates contact with wires that have a contact radius. `cohesion` lists the bonds, NULL: no
 * bonds; it and the tape, whose precision and instructions are used, must outlive the contact. */
WB_MUST_CHECK enum wb_status
wb_swept_tape_contact_create(struct wb_swept_tape_contact **out, const struct wb_swept_tape *tape,
                             const struct wb_swept_cohesion *cohesion,
                             const struct wb_swept_tape_contact_settings *settings, int n_wires,
                             const struct wb_swept_wire *wires);
void wb_swept_tape_contact_destroy(struct wb_swept_tape_contact *contact);

struct wb_swept_tape_contact_sums {
    double normal, tangential; /* J, stored in the springs */
    double friction;           /* J, dissipated in this step */
    double deepest;            /* m, penetration */
};

/* One step: adds forces. `time_step` (s) is the time since the positions of the previous step.
 * WB_ERR_DATA if positions are not finite or a node penetrates a wire by more than half its radius:
 * the run has failed. */
WB_MUST_CHECK enum wb_status
wb_swept_tape_contact_add_forces(struct wb_swept_tape_contact *contact,
                                 const struct wb_swept_cohesion_fields *fields, double time_step,
                                 struct wb_swept_tape_contact_sums *sums);

/* Saves or restores the state that a contact of the same tape, wires and settings needs to continue
 * bit for bit. */
void wb_swept_tape_contact_visit(struct wb_swept_tape_contact *contact,
                                 struct wb_checkpoint *checkpoint);

/* Upper bounds of the contribution of contact to the largest eigenvalue of M^-1 K, as for cohesion,
 * if all nodes of the ring touch. */
double wb_swept_tape_contact_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                const double *mass, const double *inertia);
double wb_swept_tape_contact_wire_stiffness_per_mass(const struct wb_swept_tape_contact *contact,
                                                     int wire, const double *mass);

#endif
