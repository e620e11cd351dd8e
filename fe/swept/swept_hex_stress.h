/* Stresses of a wire of swept hexahedra (fe/swept/swept_hex.h), asked one element at a time: the
 * kernels' law once more, slowly and in double, from positions and the plastic strains kept.
 *
 * Positions must be those of the last forces, or of the step after them. Then the plastic strains
 * go with them but for a step's strain (some 1e-7).
 */
#ifndef WB_FE_SWEPT_SWEPT_HEX_STRESS_H
#define WB_FE_SWEPT_SWEPT_HEX_STRESS_H

#include "fe/swept/swept_hex.h"

struct wb_swept_hex_stress {
    double stress[6]; /* Pa, of Cauchy: xx, yy, zz, xy, xz, yz in axes that turn with the wire: x
                         along it, y and z those of its section */
    double plastic;   /* accumulated plastic strain */
};

/* Of the points of the section's element `quad`, `element` along: as many as there are into `out`,
 * which has room for 4. `state` is not changed. */
void wb_swept_hex_stress_find(const struct wb_swept_hex *hex, struct wb_swept_hex_state *state,
                              const double *position, int quad, int element,
                              struct wb_swept_hex_stress *out);

/* The same at the four corners of the section: bilinear through the points, or the point's own. */
void wb_swept_hex_stress_at_corners(const struct wb_swept_hex *hex,
                                    const struct wb_swept_hex_stress *points,
                                    struct wb_swept_hex_stress corners[4]);

#endif
