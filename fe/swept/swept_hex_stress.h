/* Stresses of a wire of swept hexahedra (fe/swept/swept_hex.h), one element at a time: the kernels'
 * law, implemented simply and in double, from positions and stored plastic strains.
 *
 * Positions must be those of the last force computation, or of the step after it. The plastic
 * strains then lag by at most one step's strain (about 1e-7).
 */
#ifndef WB_FE_SWEPT_SWEPT_HEX_STRESS_H
#define WB_FE_SWEPT_SWEPT_HEX_STRESS_H

#include "fe/swept/swept_hex.h"

struct wb_swept_hex_stress {
    double stress[6]; /* Cauchy stress, Pa: xx, yy, zz, xy, xz, yz in axes that rotate with the
                         wire: x along it, y and z those of its section */
    double plastic;   /* accumulated plastic strain */
};

/* Stresses at the points of the section's element `quad`, `element` along the wire, into `out`,
 * which has room for 4. */
void wb_swept_hex_stress_find(const struct wb_swept_hex *hex,
                              const struct wb_swept_hex_state *state, const double *position,
                              int quad, int element, struct wb_swept_hex_stress *out);

/* Stresses at the four corners of the section: bilinear through the points, or the single
 * point's. */
void wb_swept_hex_stress_at_corners(const struct wb_swept_hex *hex,
                                    const struct wb_swept_hex_stress *points,
                                    struct wb_swept_hex_stress corners[4]);

#endif
