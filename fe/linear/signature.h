/* Signs of the eigenvalues of small tangent matrices, which decide whether an equilibrium is
 * stable.
 *
 * Rows of a matrix are `stride` apart; n is at most 6. An eigenvalue that is zero within round-off
 * counts as not negative: a section that has yielded completely has nearly zero stiffness, but no
 * negative stiffness.
 */
#ifndef WB_FE_LINEAR_SIGNATURE_H
#define WB_FE_LINEAR_SIGNATURE_H

#include <stdbool.h>

enum {
    WB_SIGNATURE_MOST = 6
};

/* Number of negative eigenvalues of the symmetric part: the negative pivots of its elimination
 * (Sylvester's law of inertia). */
int wb_signature_negative(int n, int stride, const double *matrix);

/* True if the determinant is negative: an odd number of negative real eigenvalues, also for a
 * matrix that is not symmetric. */
bool wb_signature_is_odd(int n, int stride, const double *matrix);

#endif
