/* The adhesive between a tape and the wires it lies on, and between the windings of a tape:
 * tractions by opening (eqs. 21 and 22 of the paper), optionally with damage.
 *
 * A node of the tape's ring is bonded, by a share of the area that goes with it, to the place on a
 * surface that it faces in the reference state: against its director, between two nodes of the
 * surface at the same station. From the tape's middle surface to that place it is a distance o;
 * with position x, director d and the place y = (1 - w) x_a + w x_b the opening is
 *
 *     g = x - o d - y,  normal g_n = g.d,  shear g_s = g - g_n d.
 *
 * Tractions K_nn g_n d + K_ss g_s (K_tt = K_ss) and what the directors get are derivatives of an
 * energy that no rotation changes: forces and moments balance, also where the tape's thickness is a
 * lever for the shear. Normal opening and shear do not couple.
 *
 * Damage, bilinear: with the normal part of an opening only where it opens, and with
 * l = sqrt((K_nn g_n / strength)^2 + (K_ss |g_s| / shear_strength)^2), linear up to l = 1, then
 * falling so that the area below is the fracture energy, of any mode. Pressure is borne undamaged
 * until the bond is broken altogether; then fe/swept/swept_tape_contact.h takes over.
 */
#ifndef WB_FE_SWEPT_SWEPT_COHESION_H
#define WB_FE_SWEPT_SWEPT_COHESION_H

#include <stddef.h>

#include "base/status.h"
#include "fe/swept/swept_tape.h"

/* What a node of the ring is bonded to, else the number of a wire. */
enum {
    WB_SWEPT_COHESION_FREE = -1,
    WB_SWEPT_COHESION_TAPE = -2 /* another winding, farther inside */
};

struct wb_swept_cohesion_bond {
    int to;
    double share; /* of the node's area, above 0 to 1 */
};

/* A wire in the reference state, straight: its section's place in the bundle. */
struct wb_swept_cohesion_wire {
    double y, z;             /* m, of the section's origin */
    const double (*node)[2]; /* y, z in the section, m; read at creation only */
    int n_nodes;
    int n_surface;
    const int *surface; /* (n_surface) nodes, in turn */
    double radius;      /* m, of contact (fe/swept/swept_tape_contact.h); not used by cohesion */
};

struct wb_swept_cohesion_settings {
    double normal_stiffness; /* K_nn, Pa/m; 30 N/mm3 */
    double shear_stiffness;  /* K_ss = K_tt, Pa/m; a third of it */
    double strength;         /* Pa; 0: it never breaks, and the next two are not used */
    double shear_strength;   /* Pa */
    double fracture_energy;  /* J/m2; more than what is stored at either strength */
};

/* The paper's stiffnesses, no damage. */
void wb_swept_cohesion_default_settings(struct wb_swept_cohesion_settings *settings);

struct wb_swept_cohesion; /* opaque */

/* `bond` is (n_nodes x n_stations), of node k at station j in [k n_stations + j]. Precision and
 * instructions are the tape's, which must outlive it. WB_ERR_ARGUMENT when a node does not face
 * what it is to be bonded to. */
WB_MUST_CHECK enum wb_status
wb_swept_cohesion_create(struct wb_swept_cohesion **out, const struct wb_swept_tape *tape,
                         const struct wb_swept_cohesion_settings *settings, int n_wires,
                         const struct wb_swept_cohesion_wire *wires,
                         const struct wb_swept_cohesion_bond *bond);
void wb_swept_cohesion_destroy(struct wb_swept_cohesion *cohesion);

/* What a checkpoint keeps: `bytes` at the address returned. */
void *wb_swept_cohesion_data(struct wb_swept_cohesion *cohesion, size_t *bytes);

struct wb_swept_cohesion_fields {
    struct wb_swept_tape_fields tape; /* forces and moments are added to */
    const double *const *position;    /* of each wire */
    void *const *force;               /* the same, added to */
};

struct wb_swept_cohesion_sums {
    double stored;     /* J */
    double dissipated; /* J, in this step */
};

/* Adds forces at the stations of blocks `first` to `end` - 1. Blocks may be done at the same time
 * by several threads: places lie at the nodes' own stations. `sums` are added to. */
void wb_swept_cohesion_add_forces(struct wb_swept_cohesion *cohesion,
                                  const struct wb_swept_cohesion_fields *fields, int first, int end,
                                  struct wb_swept_cohesion_sums *sums);

/* What a node was bonded to, damaged or not. */
int wb_swept_cohesion_partner(const struct wb_swept_cohesion *cohesion, int node, int station);

/* Damage of a node's bond, 0 to 1 (broken); 1 of nodes that are not bonded. */
double wb_swept_cohesion_damage(const struct wb_swept_cohesion *cohesion, int node, int station);

/* Bounds of what cohesion adds to the largest eigenvalue of M^-1 K, 1/s2, of the tape and of each
 * wire on its own: omega_max^2 <= the largest of (a body's elements + this). With masses at inner
 * stations, kg, mass scaling included: of the ring's nodes (`mass`, and `inertia` of directors, kg
 * m2), of the nodes of a wire's section. */
double wb_swept_cohesion_tape_stiffness_per_mass(const struct wb_swept_cohesion *cohesion,
                                                 const double *mass, const double *inertia);
double wb_swept_cohesion_wire_stiffness_per_mass(const struct wb_swept_cohesion *cohesion, int wire,
                                                 const double *mass);

#endif
