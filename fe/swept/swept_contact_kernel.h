/* The kernels behind fe/swept/swept_contact.h: frames of wires, and the forces of contact between
 * them. Lanes are stations.
 *
 * Neighbours use only a wire's frames, one at each station, linear in its surface nodes:
 *
 *     c = sum a_k x_k,   p = sum b_k x_k,   q = sum e_k x_k,
 *
 * the centre and two vectors that rotate with a rigid section (a, b, e: least-squares weights, with
 * which c, p, q of the reference section are 0, e_y, e_z). The rotation in a step is that of least
 * squares,
 *
 *     theta = J^-1 (p x dp + q x dq),   J = |p|^2 I - p p' + |q|^2 I - q q',
 *
 * with p and q at the middle of the step: for a rigid rotation, 2 tan(angle / 2) times its axis.
 *
 * A force F at c with a couple M is distributed to the nodes as
 *
 *     f_k = a_k F + b_k (m x p) + e_k (m x q),   m = J^-1 M,
 *
 * whose work in a step is F dc + M theta, whose sum is F and whose moment is c x F + M for any
 * deformation of the section.
 *
 * Positions and their differences are double; everything else has the kernel's type.
 */
#ifndef WB_FE_SWEPT_SWEPT_CONTACT_KERNEL_H
#define WB_FE_SWEPT_SWEPT_CONTACT_KERNEL_H

#include <stdbool.h>
#include <stddef.h>

#include "fe/material/friction.h"
#include "fe/swept/swept_kernel.h"

/* Rows of values at stations. Rows that are read between stations have one stride of zeros before
 * and after them. Rows of a wire: */
enum {
    WB_SWEPT_CONTACT_CENTRE = 0, /* c, with guards */

    WB_SWEPT_CONTACT_BEFORE = 0,  /* c of the previous step */
    WB_SWEPT_CONTACT_P = 3,       /* p, then q */
    WB_SWEPT_CONTACT_TANGENT = 9, /* of the centre line, per station; updated by a refresh */
    WB_SWEPT_CONTACT_FIXED = 12,

    WB_SWEPT_CONTACT_TURN = 0, /* theta; kernel's type, with guards */
    WB_SWEPT_CONTACT_TURNS = 3,

    WB_SWEPT_CONTACT_INVERSE = 0, /* of J: xx, yy, zz, xy, xz, yz; kernel's type */
    WB_SWEPT_CONTACT_INVERSES = 6
};

/* Rows of a pair, at its own stations: */
enum {
    WB_SWEPT_CONTACT_OFFSET = 0,  /* from station j to the contact positions on either wire */
    WB_SWEPT_CONTACT_BETWEEN = 2, /* vector between them in the previous step, m */
    WB_SWEPT_CONTACT_PAIR = 5,

    /* The following rows have the kernel's type, with guards. */
    WB_SWEPT_CONTACT_SHIFT = 0,   /* the offsets again */
    WB_SWEPT_CONTACT_FORCE = 2,   /* on the first wire, N */
    WB_SWEPT_CONTACT_COUPLE = 5,  /* shared by both wires, N m */
    WB_SWEPT_CONTACT_DRAG = 8,    /* friction force on the first wire, N/m */
    WB_SWEPT_CONTACT_LOST = 11,   /* rounding error of its sum over time (Kahan) */
    WB_SWEPT_CONTACT_LENGTH = 14, /* represented by the station, m */
    WB_SWEPT_CONTACT_LOAD = 15
};

/* Integer offsets, first and last included; empty if first > last. */
struct wb_swept_contact_window {
    int first, last;
};

/* Pointers to station 0 of the first row; rows are `stride` apart, rows with guards `row`. */
struct wb_swept_contact_frames {
    int n_nodes, n_surface;
    const int *node;           /* (n_surface) */
    const double (*weight)[3]; /* (n_surface): a, b, e */
    const void *narrow_weight; /* the same in the kernel's type */
    double *centre, *fixed;
    void *turn, *inverse;
    int n_sides;
    int *side; /* (n_sides): 2 pair + index of this wire in the pair */
};

struct wb_swept_contact_pair_rows {
    int wire[2];
    double share[2]; /* r_a / (r_a + r_b), r_b / (r_a + r_b) */
    double reach;    /* r_a + r_b, m */
    /* Normal, tangential: stiffnesses, N/m2; compliance: 1 / tangential. */
    double normal, tangential, compliance;
    double *rows;          /* (PAIR), stride apart */
    void *load;            /* (LOAD), row apart */
    unsigned char *active; /* (n_blocks) */
    /* (n_blocks): offsets from the pair's stations in the block. */
    struct wb_swept_contact_window *from[2];
    struct wb_swept_contact_window *to[2]; /* offsets to the wire's stations in the block */
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
    bool started;                       /* false in the first step */
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
