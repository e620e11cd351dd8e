/* The table by which kernels of swept bodies return stresses to yield.
 *
 * Radially returned, the plastic strain p at which a point yields solves p + K / (3 mu) p^n = x,
 * where x = e - sigma_Y / (3 mu) + p0 with the trial's equivalent elastic strain e (its stress over
 * 3 mu) and the plastic strain p0 before. The table has p / x: in each octave of x, from 2^-31 to
 * 2, a polynomial in t = m - 3/2 of the mantissa m (1 to 2).
 */
#ifndef WB_FE_SWEPT_SWEPT_HARDENING_H
#define WB_FE_SWEPT_SWEPT_HARDENING_H

#include "base/status.h"
#include "fe/material/material.h"

enum {
    WB_SWEPT_HARDENING_TERMS = 6,
    WB_SWEPT_HARDENING_OCTAVES = 32,
    WB_SWEPT_HARDENING_LOWEST_OCTAVE = -31
};

/* WB_ERR_UNSUPPORTED when it is not as good as 1e-5 of the stress (some exponents below 0.4). Of
 * an elastic material it is zero. */
WB_MUST_CHECK enum wb_status
wb_swept_hardening_tabulate(const struct wb_material *material,
                            double table[WB_SWEPT_HARDENING_TERMS][WB_SWEPT_HARDENING_OCTAVES]);

#endif
