/* Functions of fe/trial/three_point_bending.c that only tests use. */
#ifndef WB_FE_TRIAL_THREE_POINT_BENDING_PRIVATE_H
#define WB_FE_TRIAL_THREE_POINT_BENDING_PRIVATE_H

#include "fe/trial/three_point_bending.h"

/* Returns to the virgin wire at rest. Keeps all memory. */
void wb_three_point_bending_reset(struct wb_three_point_bending *bending);

/* Positions of the axis at n arc lengths from the middle (m), in the frame of
 * three_point_bending.h. */
void wb_three_point_bending_shape(const struct wb_three_point_bending *bending, int n,
                                  const double *from_middle, double *x, double *y, double *angle);

#endif
