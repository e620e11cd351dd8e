/* The kernels behind fe/swept/swept_contact.h: frames of wires, and the forces of
 * contact between them. Lanes are stations.
 *
 * A wire is known to its neighbours by frames, one at each station, linear in its surface nodes:
 *
 *     c = sum a_k x_k,   p = sum b_k x_k,   q = sum e_k x_k,
 *
 * the centre and two vectors that a rigid section turns with it (a, b, e: least squares, so that c,
 * p, q of the section's own y, z are 0, e_y, e_z). The turn of a step is that of least squares,
 *
 *     theta = J^-1 (p x dp + q x dq),   J = |p|^2 I - p p' + |q|^2 I - q q',
 *
 * with p and q in the middle of the step: of a rigid rotation, 2 tan(angle / 2) times its axis.
 *
 * A force F at c with a couple M goes to the nodes as
 *
 *     f_k = a_k F + b_k (m x p) + e_k (m x q),   m = J^-1 M,
 *
 * whose work in a step is F dc + M theta, whose sum is F and whose moment is c x F + M, whatever
 * the section's deformation.
 *
 * Positions and their differences are double; the rest is of the kernel's type.
 */
#ifndef WB_FE_SWEPT_SWEPT_CONTACT_KERNEL_H
#define WB_FE_SWEPT_SWEPT_CONTACT_KERNEL_H

#include <stdbool.h>
#include <stddef.h>

#include "fe/material/friction.h"
#include "fe/swept/swept_kernel.h"

/* Rows of numbers at stations. Those read between stations have a stride of zeros before and after.
 * Of a wire: */
enum {
    WB_SWEPT_CONTACT_CENTRE = 0, /* c, with guards */
    WB_SWEPT_CONTACT_CENTRES = 3,

    WB_SWEPT_CONTACT_BEFORE = 0,  /* c in the step before */
    WB_SWEPT_CONTACT_P = 3,       /* p, then q */
    WB_SWEPT_CONTACT_TANGENT = 9, /* of the centre line, a station's difference; when refreshed */
    WB_SWEPT_CONTACT_FIXED = 12,

    WB_SWEPT_CONTACT_TURN = 0, /* theta; kernel's type, with guards */
    WB_SWEPT_CONTACT_TURNS = 3,

    WB_SWEPT_CONTACT_INVERSE = 0, /* of J: xx, yy, zz, xy, xz, yz; kernel's type */
    WB_SWEPT_CONTACT_INVERSES = 6
};

/* Of a pair, at its own stations: */
enum {
    WB_SWEPT_CONTACT_OFFSET = 0,  /* from station j to the places in contact on either wire */
    WB_SWEPT_CONTACT_BETWEEN = 2, /* from place to place in the step before, m */
    WB_SWEPT_CONTACT_PAIR = 5,

    /* These are of the kernel's type, with guards. */
    WB_SWEPT_CONTACT_SHIFT = 0,   /* the offsets again */
    WB_SWEPT_CONTACT_FORCE = 2,   /* on the first wire, N */
    WB_SWEPT_CONTACT_COUPLE = 5,  /* to be shared by both, N m */
    WB_SWEPT_CONTACT_DRAG = 8,    /* force of friction on the first wire, N/m */
    WB_SWEPT_CONTACT_LOST = 11,   /* what its sum over time has lost by rounding */
    WB_SWEPT_CONTACT_LENGTH = 14, /* that the station stands for, m */
    WB_SWEPT_CONTACT_LOAD = 15
};

/* Whole offsets, both included; empty when first > last. */
struct wb_swept_contact_window {
    int first, last;
};

/* Rows are given at station 0 of their first; `stride` apart, with guards `row`. */
struct wb_swept_contact_frames {
    int n_nodes, n_surface;
    const int *node;           /* (n_surface) */
    const double (*weight)[3]; /* (n_surface): a, b, e */
    const void *narrow_weight; /* the same in the kernel's type */
    double *centre, *fixed;
    void *turn, *inverse;
    int n_sides;
    int *side; /* (n_sides): 2 pair + which of its wires this is */
};

struct wb_swept_contact_pair_rows {
    int wire[2];
    double share[2];                       /* r_a / (r_a + r_b), r_b / (r_a + r_b) */
    double reach;                          /* r_a + r_b, m */
    double normal, tangential, compliance; /* stiffnesses, N/m2, and 1 / tangential */
    double *rows;                          /* (PAIR), stride apart */
    void *load;                            /* (LOAD), row apart */
    unsigned char *active;                 /* (n_blocks) */
    struct wb_swept_contact_window
        *from[2];                          /* (n_blocks): from the pair's stations in the block, */
    struct wb_swept_contact_window *to[2]; /* and to the wire's stations in the block */
};

struct wb_swept_contact_sums {
    double normal, tangential; /* J, stored */
    double friction, damping;  /* J, dissipated in this step */
    double deepest;            /* m */
    double check;              /* not finite if a surface node's position is not */
};

struct wb_swept_contact_model {
    int n_wires, n_stations, n_blocks;
    int stride, row;
    int n_pairs;
    struct wb_swept_contact_frames *wire;
    struct wb_swept_contact_pair_rows *pair;
    struct wb_friction friction;
    double damping_time;
    struct wb_swept_range counted;      /* stations, in energies */
    bool started;                       /* there was a step before */
    struct wb_swept_contact_sums *sums; /* (n_blocks), of this step */
};

struct wb_swept_contact_call {
    const struct wb_swept_contact_model *model;
    const double *const *position; /* (n_wires) */
    void *const *force;            /* (n_wires), kernel's type */
    double time_step;
    int first_block, end_block;
};

struct wb_swept_contact_kernel {
    void (*gather)(const struct wb_swept_contact_call *call);
    void (*press)(const struct wb_swept_contact_call *call);
    void (*scatter)(const struct wb_swept_contact_call *call);
};

WB_SWEPT_KERNEL_DECLARE(wb_swept_contact_kernel);

#endif
