/* Shared by swept_tape_contact.c and swept_tape_contact_query.c; nobody else. */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_CONTACT_PRIVATE_H
#define WB_FE_SWEPT_SWEPT_TAPE_CONTACT_PRIVATE_H

#include "fe/swept/swept_tape_contact.h"
#include "fe/swept/swept_tape_contact_kernel.h"
#include "fe/swept/swept_tape_private.h"

struct wb_swept_tape_contact_surface {
    int n;
    int *node;     /* (n) */
    double radius; /* m */
};

/* Where a node is near a wire. */
struct wb_swept_tape_contact_near_place {
    int wire, partner[2], station;
    double gap, round, along, offset;
    double aside, inwards; /* the centre, seen from between the partners */
};

struct wb_swept_tape_contact {
    const struct wb_swept_tape *tape;         /* borrowed */
    const struct wb_swept_cohesion *cohesion; /* borrowed; NULL: nothing is bonded */
    struct wb_swept_tape_contact_settings settings;
    const struct wb_swept_tape_contact_kernel *kernel;
    struct wb_swept_tape_contact_kernel_model model;
    int n_wires;
    struct wb_swept_tape_contact_surface *surface; /* (n_wires) */
    int *surface_nodes;                            /* of all wires */
    double *centre, *axis;                         /* (n_wires x 3 x n_stations), when refreshed */
    int *first;                                    /* (n_blocks + 1) */
    struct wb_swept_tape_contact_strip *strip;     /* room for one a node and station */
    void *rows, *history;
    struct wb_swept_tape_contact_near_place *near; /* (n_nodes x n_stations); wire -1: none */
    int n_strips, n_near;
    long long steps;
};

#endif
