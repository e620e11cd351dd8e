/* The kernels behind fe/swept/swept_cohesion.h: the forces of the bonds. Lanes are stations.
 *
 * A strip contains the bonds of a ring node in one block of stations to the same pair of surface
 * nodes; at the other stations of the block its area is zero.
 */
#ifndef WB_FE_SWEPT_SWEPT_COHESION_KERNEL_H
#define WB_FE_SWEPT_SWEPT_COHESION_KERNEL_H

#include <stdbool.h>

#include "fe/swept/swept_cohesion.h"
#include "fe/swept/swept_kernel.h"

/* Rows of a strip, WB_SWEPT_LANES each. */
enum {
    WB_SWEPT_COHESION_WEIGHT = 0, /* w */
    WB_SWEPT_COHESION_OFFSET,     /* o, m */
    WB_SWEPT_COHESION_BONDED,     /* area, m2 */
    WB_SWEPT_COHESION_ROWS
};

struct wb_swept_cohesion_strip {
    int node;        /* of the ring */
    int to;          /* a wire or WB_SWEPT_COHESION_TAPE */
    int partner[2];  /* nodes a and b there */
    double outwards; /* 1 or -1: direction of directors */
};

struct wb_swept_cohesion_kernel_model {
    int stride;
    const int *first; /* (n_blocks + 1): strips of a block */
    const struct wb_swept_cohesion_strip *strip;
    const void *rows; /* of each strip (ROWS x LANES) */
    double normal, shear;
    bool breaks;
    double per_strength, per_shear_strength; /* K_nn / strength, K_ss / shear_strength, 1/m */
    double fracture_energy;
    struct wb_swept_range counted; /* stations, in sums */
};

struct wb_swept_cohesion_kernel {
    /* Adds the forces of blocks `first` to `end` - 1; `damage` is that of each strip (LANES),
     * `sums` may be NULL. */
    void (*add_forces)(const struct wb_swept_cohesion_kernel_model *model,
                       const struct wb_swept_cohesion_fields *fields, void *damage, int first,
                       int end, struct wb_swept_cohesion_sums *sums);
};

WB_SWEPT_KERNEL_DECLARE(wb_swept_cohesion_kernel);

#endif
