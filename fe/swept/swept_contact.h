/* Contact with friction between neighbouring wires of a bundle, for explicit dynamics.
 *
 * Wires are swept bodies with the same stations, about parallel to their neighbours. At each
 * station a wire is a rigid circle of its contact radius around the centre of its surface nodes,
 * which rotates with them (see fe/swept/swept_contact_kernel.h). For every pair of neighbours and
 * every station j there is one contact point, between the position j - s/2 on one centre line and j
 * + s/2 on the other, which are linear between stations; the shift s, updated every
 * refresh_interval steps, places them opposite each other. Both wires are treated alike, so the
 * chords of curved centre lines cause the same error on both. A contact point represents the length
 * of a station, half of it at the ends; if wires have slipped past each other, only their common
 * length is in contact.
 *
 * Normal force per length: k (r_a + r_b - distance) where positive, along the line between the two
 * positions: the exact derivative of an energy of the nodes' positions for constant s, and s makes
 * that energy stationary. Slip d along the wires between two refreshes tilts that line by the angle
 * d / (r_a + r_b); keep this angle far below mu. Friction per length: an elastic spring k_t for the
 * slip of the surfaces since first contact, returned to mu N (Coulomb), with
 *
 *     mu = mu_k + (mu_s - mu_k) exp(-decay slip rate)                               (eq. 20),
 *
 * where the slip rate is the surfaces' relative tangential velocity in model time. Slip includes
 * the contributions of rotation, twist and rolling. The forces on both wires act at one point of
 * space: their sum and moment vanish to round-off, and rigid motions of touching wires cause
 * neither slip nor force.
 *
 * Contact does not deform sections: a normal force is distributed equally over all surface nodes, a
 * couple by least squares. The stiffness k represents the flattening of two cylinders.
 *
 * Stations are numbered from 0; blocks are WB_SWEPT_LANES of them.
 */
#ifndef WB_FE_SWEPT_SWEPT_CONTACT_H
#define WB_FE_SWEPT_SWEPT_CONTACT_H

#include <stdbool.h>
#include <stddef.h>

#include "base/checkpoint.h"
#include "base/reason.h"
#include "base/status.h"
#include "fe/material/friction.h"
#include "fe/swept/swept.h"

struct wb_swept_contact_settings {
    double stiffness; /* k / E, with the harmonic mean of the two wires' moduli; default 0.25, about
                         that of two cylinders pressed together */
    double tangential_ratio;     /* k_t / k; default 0.5 */
    struct wb_friction friction; /* default: 0.4, static and kinetic */
    double damping_time;         /* s; 0: no damping. The normal force is k (depth + damping_time
                                    d(depth)/dt), never tensile */
    /* Gap below which wires become neighbours, over the smallest radius; default 0.5. */
    double reach;
    int refresh_interval;          /* steps between refreshes of the shifts; default 50 */
    struct wb_swept_range counted; /* contact points in energies; all are computed */
    /* Borrowed; receives the reason of a failed step. NULL: the reason is logged. */
    struct wb_reason *reason;
    int most_pairs;        /* of neighbours; 0: 4 per wire (touching circles have at most 3) */
    bool double_precision; /* forces are double instead of float */
    enum wb_swept_instructions instructions;
};

void wb_swept_contact_default_settings(struct wb_swept_contact_settings *settings);

struct wb_swept_contact; /* opaque */

/* For wires with `n_stations` (at least 2) stations, `spacing` (m) apart in the reference state.
 * WB_ERR_UNSUPPORTED if the processor does not have the instructions. */
WB_MUST_CHECK enum wb_status
wb_swept_contact_create(struct wb_swept_contact **out,
                        const struct wb_swept_contact_settings *settings, int n_wires,
                        const struct wb_swept_wire *wires, int n_stations, double spacing);
void wb_swept_contact_destroy(struct wb_swept_contact *contact);

struct wb_swept_contact_energies {
    double normal, tangential; /* J, stored in the springs */
    double friction, damping;  /* J, dissipated in this step */
    double deepest;            /* penetration, m */
};

/* One step: adds the contact forces at the given positions (of each wire) to `force` (of each wire;
 * float, or double in double precision). `time_step` (s) is the time since the positions of the
 * previous step, over which friction integrates slip. The first step after creation has no
 * friction.
 *
 * WB_ERR_DATA if a surface node's position is not finite or wires penetrate by half the smallest
 * radius (stiffness too low, or step too long): the run has failed. WB_ERR_MEMORY if more pairs of
 * wires are neighbours than most_pairs. */
WB_MUST_CHECK enum wb_status
wb_swept_contact_add_forces(struct wb_swept_contact *contact, const double *const *position,
                            void *const *force, double time_step,
                            struct wb_swept_contact_energies *energies);

/* For the stable step: an upper bound of the contribution of a wire's contact to the largest
 * eigenvalue of M^-1 K, 1/s2, so that omega_max^2 is at most that of the wires' elements + the
 * largest of these. `node_mass`, kg/m, one per section node; `selective` is beta of
 * fe/swept/swept_step.h, 1: none; mass scaling by f_m divides the bound by f_m. Uses the current
 * number of neighbours, but at least six, all around the wire. Infinite if a mass is not
 * positive. */
double wb_swept_contact_stiffness_per_mass(const struct wb_swept_contact *contact, int wire,
                                           const double *node_mass, double selective);

/* Contact between neighbours at the last step's positions. */
struct wb_swept_contact_point {
    int wire[2];
    double stiffness; /* k, N/m2 */
    double gap;       /* m */
    double length; /* length represented by the point, m; 0 if one wire has no position opposite */
    double shift;  /* s, in stations */
    double normal; /* N/m, without damping */
    double normal_direction[3]; /* from the first wire to the second */
    double friction[3];         /* on the first wire, N/m */
};
int wb_swept_contact_pairs(const struct wb_swept_contact *contact);
void wb_swept_contact_get_point(const struct wb_swept_contact *contact, int pair, int station,
                                struct wb_swept_contact_point *out);

/* Saves or restores the state that a contact of the same wires and settings needs to continue bit
 * for bit. */
void wb_swept_contact_visit(struct wb_swept_contact *contact, struct wb_checkpoint *checkpoint);

#endif
