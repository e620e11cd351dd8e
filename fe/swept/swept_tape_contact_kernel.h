/* The kernels behind fe/swept/swept_tape_contact.h: forces between tape and wires. Lanes are
 * stations.
 *
 * A strip contains the stations of a ring node in one block whose contact points lie between the
 * same pair of surface nodes of a wire, with the same offset of stations; at the other stations of
 * the block its area is zero.
 */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_CONTACT_KERNEL_H
#define WB_FE_SWEPT_SWEPT_TAPE_CONTACT_KERNEL_H

#include <stdbool.h>

#include "fe/material/friction.h"
#include "fe/swept/swept_kernel.h"
#include "fe/swept/swept_tape_contact.h"

/* Rows of a strip, WB_SWEPT_LANES each. */
enum {
    WB_SWEPT_TAPE_CONTACT_ROUND = 0, /* weight of the second node */
    WB_SWEPT_TAPE_CONTACT_ALONG,     /* weight of the second station */
    WB_SWEPT_TAPE_CONTACT_OFFSET,    /* o, m */
    WB_SWEPT_TAPE_CONTACT_AREA,      /* m2 */
    WB_SWEPT_TAPE_CONTACT_ASIDE, /* the centre from the middle between the two nodes, m: towards the
                                    second */
    WB_SWEPT_TAPE_CONTACT_INWARDS, /* and perpendicular, by the axis times that direction */
    WB_SWEPT_TAPE_CONTACT_ROWS
};

/* Rows of a ring node, a stride each. */
enum {
    WB_SWEPT_TAPE_CONTACT_DRAG = 0, /* friction, Pa, and the rounding error of its sum (Kahan) */
    WB_SWEPT_TAPE_CONTACT_LOST = 3,
    WB_SWEPT_TAPE_CONTACT_BEFORE = 6, /* g perpendicular to the director in the previous step, m */
    WB_SWEPT_TAPE_CONTACT_HISTORY = 9
};

struct wb_swept_tape_contact_strip {
    int node, wire, partner[2];
    int station;   /* of the first, relative to the node's own station */
    double radius; /* distance from the wire's centre to the tape's middle surface in contact, m */
};

struct wb_swept_tape_contact_kernel_model {
    int n_stations, stride;
    int n_blocks;
    const int *first; /* (n_blocks + 1): strips of a block */
    const struct wb_swept_tape_contact_strip *strip;
    const void *rows; /* of each strip (ROWS x LANES) */
    double normal, shear;
    struct wb_friction friction;
    struct wb_swept_range counted; /* stations, in sums */
};

struct wb_swept_tape_contact_kernel {
    /* Adds the forces of a step; `history` is (n_nodes x HISTORY x stride). */
    void (*add_forces)(const struct wb_swept_tape_contact_kernel_model *model,
                       const struct wb_swept_cohesion_fields *fields, void *history,
                       double time_step, struct wb_swept_tape_contact_sums *sums);
};

WB_SWEPT_KERNEL_DECLARE(wb_swept_tape_contact_kernel);

#endif
