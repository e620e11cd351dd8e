/* Stresses of a tape of swept shells (fe/swept/swept_tape.h), asked one element at a time: the
 * kernels' law once more, slowly and in double, from positions, directors and the plastic strains
 * kept.
 *
 * Positions must be those of the last forces, or of the step after them. Then the plastic strains
 * go with them but for a step's strain (some 1e-7).
 */
#ifndef WB_FE_SWEPT_SWEPT_TAPE_STRESS_H
#define WB_FE_SWEPT_SWEPT_TAPE_STRESS_H

#include "fe/swept/swept_tape.h"

enum {
    WB_SWEPT_TAPE_STRESS_MOST = 5 /* points through the thickness */
};

struct wb_swept_tape_stress {
    double stress[3]; /* Pa, per reference area (of Kirchhoff): 11, 22, 12 in the element's frame,
                         1 along the tape's stations; without the transverse shear */
    double plastic;   /* accumulated plastic strain */
};

/* Points through the thickness. */
int wb_swept_tape_stress_points(const struct wb_swept_tape *tape);

/* Of the element between nodes `element` and the next of the ring, stations `along` and the next:
 * its points from the inside. `state` is not changed. */
void wb_swept_tape_stress_find(const struct wb_swept_tape *tape, struct wb_swept_tape_state *state,
                               const double *position, const double *director, int element,
                               int along,
                               struct wb_swept_tape_stress out[WB_SWEPT_TAPE_STRESS_MOST]);

/* Von Mises stress of plane stress, Pa. */
double wb_swept_tape_stress_von_mises(const double stress[3]);

#endif
