/* Contact with friction between neighbouring wires of a bundle, for explicit dynamics.
 *
 * Wires are swept bodies with the same stations, about parallel to their neighbours. At each
 * station a wire is a rigid circle of its contact radius round the centre of its surface nodes,
 * turning as these do (see fe/swept/swept_contact_kernel.h). For every pair of neighbours and every
 * station j there is one point of contact, between the place j - s/2 on one centre line and j + s/2
 * on the other, which are linear between stations; the shift s, updated every refresh_interval
 * steps, puts them opposite each other. Both wires are treated alike: curvature then cuts the
 * corners of both lines by the same amount. Points of contact stand for the length between them,
 * that at the ends for half of it; of wires that have slipped past each other, only what lies side
 * by side is in contact.
 *
 * Normal force per length: k (r_a + r_b - distance) where positive, along the line between the two
 * places: exactly the derivative of an energy of the nodes' positions while s rests, and s rests
 * where that energy is stationary. Slip d along the wires between two refreshes tilts that line by
 * d / (r_a + r_b) until the next; keep it far below mu times that. Friction per length: an elastic
 * spring for the slip of the surfaces since they touched, k_t, returned to mu N (Coulomb), with
 *
 *     mu = mu_k + (mu_s - mu_k) exp(-decay slip rate)                               (eq. 20),
 *
 * the rate being that of the surfaces' relative tangential motion in the model's own time. Slip
 * includes what the wires' turning, twisting and rolling do. Forces on either wire act at one point
 * of space: they cancel in sum and moment to round-off, and a rigid motion of wires that touch
 * makes neither slip nor force.
 *
 * Sections are not squeezed: a normal force goes to all surface nodes alike, a couple by least
 * squares. The stiffness k stands for the flattening of two cylinders.
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

struct wb_swept_contact_wire {
    int n_nodes;             /* of the section */
    int n_surface;           /* at least 3 */
    const int *surface;      /* (n_surface): nodes that carry contact; copied */
    const double (*node)[2]; /* (n_nodes): y, z in the section, m; copied */
    double radius;           /* of contact, m */
    double youngs_modulus;   /* Pa */
};

struct wb_swept_contact_settings {
    double stiffness;        /* k / E, with the harmonic mean of the two wires' moduli; 0.25, about
                                that of two cylinders pressed together */
    double tangential_ratio; /* k_t / k; 0.5 */
    struct wb_friction friction; /* 0.4 at any rate */
    double damping_time;  /* s; 0: none. The normal force is k (depth + damping_time d(depth)/dt),
                             never a pull */
    double reach;         /* gap at which wires become neighbours, of the smallest radius; 0.5 */
    int refresh_interval; /* steps between refreshes of the shifts; 50 */
    struct wb_swept_range counted; /* points of contact, in energies; all are computed */
    struct wb_reason *reason;      /* borrowed; holds why a step failed. NULL: that is logged */
    int most_pairs;        /* of neighbours; 0: 4 a wire (touching circles have at most 3) */
    bool double_precision; /* of the forces; else float */
    enum wb_swept_instructions instructions;
};

void wb_swept_contact_default_settings(struct wb_swept_contact_settings *settings);

struct wb_swept_contact; /* opaque */

/* Of wires with `n_stations` (at least 2) stations, `spacing` (m) apart in the reference state.
 * WB_ERR_UNSUPPORTED when the processor does not have the instructions. */
WB_MUST_CHECK enum wb_status
wb_swept_contact_create(struct wb_swept_contact **out,
                        const struct wb_swept_contact_settings *settings, int n_wires,
                        const struct wb_swept_contact_wire *wires, int n_stations, double spacing);
void wb_swept_contact_destroy(struct wb_swept_contact *contact);

struct wb_swept_contact_energies {
    double normal, tangential; /* J, stored in the springs */
    double friction, damping;  /* J, dissipated in this step */
    double deepest;            /* penetration, m */
};

/* One step: adds to `force` (of each wire; float, or double of double precision) what contact does
 * at the positions given (of each wire). `time_step` (s) is the time since the positions of the
 * step before; between them friction follows slip. The first step after creation has none.
 *
 * WB_ERR_DATA when a surface node's position is not finite or wires penetrate by half the smallest
 * radius (too soft, or too long a step): the run is lost. WB_ERR_MEMORY when more pairs of wires
 * are neighbours than there is room for. */
WB_MUST_CHECK enum wb_status
wb_swept_contact_add_forces(struct wb_swept_contact *contact, const double *const *position,
                            void *const *force, double time_step,
                            struct wb_swept_contact_energies *energies);

/* For the stable step: a bound of what contact of a wire adds to the largest eigenvalue of M^-1 K,
 * 1/s2. So omega_max^2 is at most that of the wires' elements + the largest of these. `node_mass`
 * is kg/m, one a section node; `selective` is beta of fe/swept/swept_step.h, 1 is none; mass
 * scaling by f_m divides it by f_m. Of the neighbours there are, and at least six, all round the
 * wire. Infinite where a mass is not positive. */
double wb_swept_contact_stiffness_per_mass(const struct wb_swept_contact *contact, int wire,
                                           const double *node_mass, double selective);

/* Neighbours, and what acts between them at the last step's positions. */
struct wb_swept_contact_point {
    double gap;    /* m */
    double length; /* that it stands for, m; 0 where one wire has no neighbour opposite */
    double shift;  /* s, in stations */
    double normal; /* N/m, without damping */
    double normal_direction[3]; /* from the first wire to the second */
    double friction[3];         /* on the first wire, N/m */
};
int wb_swept_contact_pairs(const struct wb_swept_contact *contact);
void wb_swept_contact_get_point(const struct wb_swept_contact *contact, int pair, int station,
                                struct wb_swept_contact_point *out);

/* Saves or restores what a contact of the same wires and settings needs to continue bit for bit. */
void wb_swept_contact_visit(struct wb_swept_contact *contact, struct wb_checkpoint *checkpoint);

#endif
