/* Where the fibres of a round section in space lie: in rings at Gauss-Legendre points of r^2, so
 * that area and second moments are exact, equally spaced in each ring. Every other ring is turned
 * by half the angle between two fibres.
 */
#ifndef WB_FE_ROD_RING_H
#define WB_FE_ROD_RING_H

#include <stdbool.h>

#include "base/status.h"

enum {
    WB_RING_MOST = 64,        /* rings */
    WB_RING_MOST_AROUND = 256 /* fibres in a ring, a multiple of 4 */
};

/* WB_ERR_ARGUMENT if the numbers of rings and of fibres in a ring are not possible. */
WB_MUST_CHECK enum wb_status wb_ring_check(int n_rings, int n_around);

/* Gauss-Legendre points and weights of [0, 1], by Newton's method on the Legendre polynomials. */
void wb_ring_rule(int n, double *point, double *weight);

/* Direction of fibre i of a ring, which may be turned by half the spacing; mirrored from the first
 * octant so that the ring is symmetric to the last bit. */
void wb_ring_direction(int i, int n_around, bool turned, double *c, double *s);

#endif
