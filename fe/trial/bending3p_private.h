/* What tests of fe/trial/bending3p.h ask beside it. */
#ifndef WB_FE_TRIAL_BENDING3P_PRIVATE_H
#define WB_FE_TRIAL_BENDING3P_PRIVATE_H

#include "fe/trial/bending3p.h"

/* Back to the virgin wire at rest. Keeps all memory. */
void wb_bending3p_reset(struct wb_bending3p *bending);

/* Positions of the axis at n arc lengths from the middle (m), in the frame above. */
void wb_bending3p_shape(const struct wb_bending3p *bending, int n, const double *from_middle,
                        double *x, double *y, double *angle);

#endif
