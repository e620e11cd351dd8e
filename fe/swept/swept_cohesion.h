/* The adhesive between a tape and the wires it lies on, and between the windings of a tape:
 * tractions by opening (eqs. 21 and 22 of the paper), optionally with damage.
 *
 * A node of the tape's ring is bonded, with a share of its tributary area, to a point of a surface.
 * In the reference state that point lies on the line along the node's director, inwards, between
 * two nodes of the surface at the same station. Its distance from the tape's middle surface is o;
 * with position x, director d and the point y = (1 - w) x_a + w x_b the opening is
 *
 *     g = x - o d - y,  normal g_n = g.d,  shear g_s = g - g_n d.
 *
 * Tractions K_nn g_n d + K_ss g_s (K_tt = K_ss) and the moments on directors are derivatives of an
 * energy that is invariant to rotations: forces and moments balance, including the moment of the
 * shear over half the tape's thickness. Normal opening and shear are uncoupled.
 *
 * Damage is bilinear in l = sqrt((K_nn g_n / strength)^2 + (K_ss |g_s| / shear_strength)^2), with
 * g_n = 0 for compression. Tractions are linear up to l = 1 and then decrease, so that the area
 * below them is the fracture energy for any mix of opening and shear. Compression has the undamaged
 * stiffness until the bond is completely broken; then fe/swept/swept_tape_contact.h applies.
 */
#ifndef WB_FE_SWEPT_SWEPT_COHESION_H
#define WB_FE_SWEPT_SWEPT_COHESION_H

#include <stddef.h>

#include "base/status.h"
#include "fe/swept/swept_tape.h"

/* Bond partner of a ring node: one of these, or the number of a wire. */
enum {
    WB_SWEPT_COHESION_FREE = -1,
    WB_SWEPT_COHESION_TAPE = -2 /* another winding, on the inner side */
};

struct wb_swept_cohesion_bond {
    int to;
    double share; /* of the node's area, above 0, at most 1 */
};

struct wb_swept_cohesion_settings {
    double normal_stiffness; /* K_nn, Pa/m */
    double shear_stiffness;  /* K_ss = K_tt, Pa/m */
    double strength;         /* Pa; 0: bonds never break, and the next two are not used */
    double shear_strength;   /* Pa */
    double fracture_energy;  /* J/m2; more than the energy stored at either strength */
};

struct wb_swept_cohesion; /* opaque */

/* `bond` is (n_nodes x n_stations), with node k at station j in [k n_stations + j]. Precision and
 * instructions are the tape's, which must outlive the cohesion. WB_ERR_ARGUMENT if a node does not
 * face its bond partner. */
WB_MUST_CHECK enum wb_status
wb_swept_cohesion_create(struct wb_swept_cohesion **out, const struct wb_swept_tape *tape,
                         const struct wb_swept_cohesion_settings *settings, int n_wires,
                         const struct wb_swept_wire *wires,
                         const struct wb_swept_cohesion_bond *bond);
void wb_swept_cohesion_destroy(struct wb_swept_cohesion *cohesion);

/* State for a checkpoint: `bytes` at the returned address. */
void *wb_swept_cohesion_data(struct wb_swept_cohesion *cohesion, size_t *bytes);

struct wb_swept_cohesion_fields {
    struct wb_swept_tape_fields tape; /* forces and moments are added */
    const double *const *position;    /* of each wire */
    void *const *force;               /* of each wire; forces are added */
};

struct wb_swept_cohesion_sums {
    double stored;     /* J */
    double dissipated; /* J, in this step */
};

/* Adds forces at the stations of blocks `first` to `end` - 1. Threads may compute different blocks
 * at the same time, because bond points lie at the nodes' own stations. `sums` are added to. */
void wb_swept_cohesion_add_forces(struct wb_swept_cohesion *cohesion,
                                  const struct wb_swept_cohesion_fields *fields, int first, int end,
                                  struct wb_swept_cohesion_sums *sums);

/* The initial bond partner of a node, damaged or not. */
int wb_swept_cohesion_partner(const struct wb_swept_cohesion *cohesion, int node, int station);

/* Damage of a node's bond, 0 to 1 (broken); 1 for nodes that are not bonded. */
double wb_swept_cohesion_damage(const struct wb_swept_cohesion *cohesion, int node, int station);

/* Upper bounds of the contribution of cohesion to the largest eigenvalue of M^-1 K, 1/s2, for the
 * tape and for each wire alone: omega_max^2 <= the largest of (a body's elements + this). Masses at
 * inner stations, kg, mass scaling included: of the ring's nodes (`mass`, and `inertia` of
 * directors, kg m2), of the nodes of a wire's section. */
double wb_swept_cohesion_tape_stiffness_per_mass(const struct wb_swept_cohesion *cohesion,
                                                 const double *mass, const double *inertia);
double wb_swept_cohesion_wire_stiffness_per_mass(const struct wb_swept_cohesion *cohesion, int wire,
                                                 const double *mass);

#endif
