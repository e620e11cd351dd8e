/* The force kernels behind fe/swept/swept_hex.h. Lanes are elements along the wire.
 *
 * All factors are prepared in the kernel's type: the constants of the section's elements, a row of
 * WB_SWEPT_HEX_KERNEL_CONSTANTS each, and the table of the hardening law. Histories are in blocks
 * of WB_SWEPT_LANES elements along the wire:
 *
 *     history[(((block n_quads + quad) n_points + point) 6 + component) WB_SWEPT_LANES + lane],
 *
 * components: plastic strain 11, 22, 12, 13, 23 (a deviator) and accumulated plastic strain.
 */
#ifndef WB_FE_SWEPT_SWEPT_HEX_KERNEL_H
#define WB_FE_SWEPT_SWEPT_HEX_KERNEL_H

#include <stdbool.h>

#include "fe/swept/swept_hex.h"
#include "fe/swept/swept_kernel.h"

enum {
    WB_SWEPT_HEX_KERNEL_CONSTANTS = 48, /* a row */
    WB_SWEPT_HEX_KERNEL_HISTORY = 6,    /* numbers of a point */
    WB_SWEPT_HEX_KERNEL_NODE = 12,      /* vectors of a node in the workspace */
    WB_SWEPT_HEX_KERNEL_CARRY = 3,      /* vectors of a node carried from block to block */
    WB_SWEPT_HEX_KERNEL_TERMS = 7       /* terms per octave of the hardening law's table */
};

/* Positions in a row of constants. h is the element's length, V its volume, mu the shear modulus,
 * kappa the bulk modulus. */
enum {
    WB_SWEPT_HEX_B = 0,          /* half the mean dN/dy at corners 2 and 3, then of dN/dz; 1/m */
    WB_SWEPT_HEX_GAMMA = 4,      /* 2 g.y and 2 g.z with g = (1, -1, 1, -1), m */
    WB_SWEPT_HEX_K_PLANE = 6,    /* stiffness of the section's hourglass field / 64, N/m */
    WB_SWEPT_HEX_K_VOLUME = 7,   /* kappa V, N m */
    WB_SWEPT_HEX_MEAN = 8,       /* mean N_a / h (4), 1/m */
    WB_SWEPT_HEX_K_ALONG = 12,   /* one point: stiffness of the fields xi, eta, xi eta of d, N/m */
    WB_SWEPT_HEX_STIFFNESS = 15, /* one point: 2 mu V, N m */
    WB_SWEPT_HEX_POINT = 16,     /* four points: N_a / h (4), 2 mu V weight; 3 of padding */
    WB_SWEPT_HEX_POINT_STRIDE = 8
};

struct wb_swept_hex_kernel_model {
    struct wb_swept_layout layout;
    int n_quads;
    int n_elements;                /* along */
    int centre, beside;            /* two nodes whose line rotates with the section */
    int first_added;               /* first node whose forces are added to existing ones */
    const int (*quad)[4];          /* (n_quads) */
    const double (*node)[2];       /* (layout.n_nodes) */
    double length;                 /* h, m */
    double yield_strain;           /* sigma_Y / (3 mu); infinite if elastic */
    struct wb_swept_range counted; /* elements, in sums */
    double strain_limit;           /* elements with larger strains are counted */
    const void *constants;         /* (n_quads x WB_SWEPT_HEX_KERNEL_CONSTANTS) */
    const void *table;             /* of the hardening law (fe/material/hardening.h) */
};

struct wb_swept_hex_kernel_call {
    const struct wb_swept_hex_kernel_model *model;
    struct wb_swept_hex_fields fields;
    void *history;
    void *workspace; /* ((NODE + CARRY) x n_nodes x WB_SWEPT_LANES), kept between calls */
    int first_block, end_block;
    struct wb_swept_hex_sums *sums; /* added to; may be NULL */
};

struct wb_swept_hex_kernel {
    void (*four_points)(const struct wb_swept_hex_kernel_call *call);
    void (*one_point)(const struct wb_swept_hex_kernel_call *call);
};

WB_SWEPT_KERNEL_DECLARE(wb_swept_hex_kernel);

#endif
