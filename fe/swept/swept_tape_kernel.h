/* The force kernels behind fe/swept/swept_tape.h.
 *
 * An element lies between the ring's nodes k and k + 1 and the stations j and j + 1; lanes are
 * stations. Constants of the reference state and histories are in blocks of WB_SWEPT_LANES:
 *
 *     reference[((block n_elements + k) WB_SWEPT_TAPE_REFERENCE + component) WB_SWEPT_LANES + lane]
 *     history[(((block n_elements + k) n_points + point) WB_SWEPT_TAPE_HISTORY + component) ...]
 *
 * Components of history: plastic strain (11 + 22) / 2, (11 - 22) / 2, 12, and accumulated plastic
 * strain. In lanes without an element all constants are zero, so that there are no strains and no
 * forces.
 */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_KERNEL_H
#define WB_FE_SWEPT_SWEPT_TAPE_KERNEL_H

#include <stdbool.h>

#include "fe/swept/swept_kernel.h"
#include "fe/swept/swept_tape.h"

enum {
    WB_SWEPT_TAPE_MOST_POINTS = 5,
    WB_SWEPT_TAPE_HISTORY = 4,
    WB_SWEPT_TAPE_TERMS = 6, /* terms per octave of the hardening law's table */
    WB_SWEPT_TAPE_CARRY = 6  /* vectors of a node carried from block to block */
};

/* Constants of an element. B transforms derivatives with respect to the parameters to those along
 * its frame. */
enum {
    WB_SWEPT_TAPE_B11 = 0,
    WB_SWEPT_TAPE_B21,
    WB_SWEPT_TAPE_B22,
    WB_SWEPT_TAPE_C1, /* components of the hourglass vector of the reference state along the frame
                       */
    WB_SWEPT_TAPE_C2,
    WB_SWEPT_TAPE_VOLUME,   /* m3 */
    WB_SWEPT_TAPE_MEASURES, /* measures of the reference state, from here on */

    /* Indices of the measures. */
    WB_SWEPT_TAPE_MEMBRANE = 0,   /* (a11 + a22) / 4, (a11 - a22) / 4, a12 / 2 */
    WB_SWEPT_TAPE_BENDING = 3,    /* the same components of (11), (22), 2 (12) of a.d */
    WB_SWEPT_TAPE_SHEAR = 6,      /* mean, along the frame */
    WB_SWEPT_TAPE_WARP = 8,       /* half differences of shear between opposite edges, m */
    WB_SWEPT_TAPE_HOURGLASS = 10, /* membrane (2), m, and bending (2), 1 */
    WB_SWEPT_TAPE_N_MEASURES = 14,
    WB_SWEPT_TAPE_REFERENCE = WB_SWEPT_TAPE_MEASURES + WB_SWEPT_TAPE_N_MEASURES
};

struct wb_swept_tape_kernel_model {
    struct wb_swept_layout layout;
    int n_elements; /* around the ring */
    int n_along;
    bool closed;
    int n_points;
    double z[WB_SWEPT_TAPE_MOST_POINTS];      /* m */
    double weight[WB_SWEPT_TAPE_MOST_POINTS]; /* their sum is 1 */
    double sum_modulus, difference_modulus;   /* E / (1 - nu), E / (1 + nu), Pa */
    double shear;                             /* 5/6 mu, Pa */
    double membrane_hourglass;                /* coefficient times E / 3, Pa */
    double bending_hourglass;                 /* that times h^2 / 12, N */
    double yield_strain;                      /* sigma_Y / (3 mu); infinite if elastic */
    double exponent;   /* n of the hardening law; taken as constant by Newton's method */
    double mean_share; /* E / (1 - nu) / (3 mu), for a mean strain */
    double mean_slope; /* E / (2 (1 - nu)) / (3 mu) */
    double strain_limit;
    struct wb_swept_range counted; /* stations in sums; elements that begin there */
    const void *table;             /* of the hardening law, octaves of WB_SWEPT_TAPE_TERMS terms */
    void *reference;               /* written by measure() only */
    const void *length_stiffness;  /* (n_nodes x stride), of directors, N m */
};

struct wb_swept_tape_kernel_call {
    const struct wb_swept_tape_kernel_model *model;
    struct wb_swept_tape_fields fields;
    void *history;
    void *carry; /* (n_nodes x CARRY x WB_SWEPT_LANES), kept between calls */
    int first_block, end_block;
    struct wb_swept_tape_sums *sums; /* added to; may be NULL */
};

struct wb_swept_tape_kernel {
    void (*forces)(const struct wb_swept_tape_kernel_call *call);
    /* Stores the measures of the current state as those of the reference state. */
    void (*measure)(const struct wb_swept_tape_kernel_call *call);
};

WB_SWEPT_KERNEL_DECLARE(wb_swept_tape_kernel);

#endif
