/* Stability of an equilibrium from its small tangent matrices: how many of their eigenvalues are
 * below zero. Rows are `stride` apart; n is at most 6. Both count what is zero but for round-off as
 * not negative: a section that yields through has hardly any stiffness, but no negative one.
 */
#ifndef WB_FE_LINEAR_SIGNATURE_H
#define WB_FE_LINEAR_SIGNATURE_H

#include <stdbool.h>

enum {
    WB_SIGNATURE_MOST = 6
};

/* Eigenvalues below zero of the symmetric part: negative pivots of its elimination (Sylvester). */
int wb_signature_negative(int n, int stride, const double *matrix);

/* Whether the determinant is negative: an odd number of real eigenvalues below zero, also of a
 * matrix that is not symmetric. */
bool wb_signature_is_odd(int n, int stride, const double *matrix);

#endif
