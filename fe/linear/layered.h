/* Block tridiagonal systems with dense blocks: the stiffness of a mesh numbered in layers along the
 * wire (fe/solid/solid_mesh.h).
 *
 * Unknowns are split in `n_blocks` consecutive blocks; block b couples to b - 1, b and b + 1.
 * Within block b only the unknowns from link[b] on couple to block b + 1 (those before couple to b
 * - 1 and b only), which elimination exploits. Symmetric systems are factored block by block by
 *   Cholesky, and by L D L^T with pivoting within the block where a block is not positive definite;
 *   general ones by LU with pivoting within the block. LAPACKE and CBLAS do the dense operations,
 *   on one thread.
 *
 * Use: clear, add elements, factor, solve any number of times.
 */
#ifndef WB_FE_LINEAR_LAYERED_H
#define WB_FE_LINEAR_LAYERED_H

#include <stdbool.h>

#include "base/status.h"

enum {
    WB_LAYERED_MOST = 64 /* unknowns of an element's matrix */
};

struct wb_layered; /* opaque */

/* `first` (n_blocks + 1) and `link` (n_blocks) are unknown numbers; link[b] lies in first[b] ..
 * first[b + 1] and is ignored for the last block. Blocks may be empty. Both arrays are copied.
 * `symmetric` systems store half. Sets OpenBLAS to one thread. */
WB_MUST_CHECK enum wb_status wb_layered_create(struct wb_layered **out, int n_blocks,
                                               const int *first, const int *link, bool symmetric);
void wb_layered_destroy(struct wb_layered *layered); /* accepts NULL */

/* All entries zero. */
void wb_layered_clear(struct wb_layered *layered);

/* Adds an n x n matrix (row-major, n <= WB_LAYERED_MOST) at the distinct unknowns `index` (n);
 * negative indices are skipped. In a symmetric system `matrix` must be symmetric. Entries must fall
 * into diagonal blocks or blocks next to them; other couplings are a defect of the caller
 * (assert). */
void wb_layered_add(struct wb_layered *layered, int n, const int *index, const double *matrix);

struct wb_layered_pivots {
    int negative;  /* symmetric: number of negative eigenvalues, 0 in a stable state; general: 0 or
                      1, the sign of the determinant */
    bool singular; /* a pivot is zero or not finite; no solution */
};

/* Factors in place. */
void wb_layered_factor(struct wb_layered *layered, struct wb_layered_pivots *pivots);

/* Solves for n_right right-hand sides in columns, `right` (unknowns x n_right), and replaces them
 * by the solutions; by NaN if the matrix is singular. */
void wb_layered_solve(struct wb_layered *layered, int n_right, double *right);

/* As wb_layered_solve(), cheaper, for right-hand sides that are zero except in the last block. */
void wb_layered_solve_last(struct wb_layered *layered, int n_right, double *right);

#endif
