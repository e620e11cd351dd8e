/* Symmetric block tridiagonal systems of 3 x 3 blocks, eliminated from the first block towards the
 * last.
 *
 * A beam clamped at one end and controlled at the other is such a chain. Elimination leaves the 3 x
 * 3 system of the last block, the stiffness condensed to the tip. The caller adds constraints, an
 * unknown tension and follower forces at the tip, solves it, and passes the tip's increment back to
 * be expanded. This costs about a tenth of a general banded solve (LAPACK's dgbsv, the reference in
 * tests/fe/linear/test_banded.c).
 */
#ifndef WB_FE_LINEAR_BANDED_H
#define WB_FE_LINEAR_BANDED_H

/* Blocks are 3 x 3, row-major. A factored matrix can be used for several right-hand sides. */
struct wb_banded {
    int n;                 /* blocks */
    double (*diagonal)[9]; /* (n); symmetric; becomes S_i^-1, the last one the condensed block */
    double (*upper)[9];    /* (n - 1) block (i, i + 1); becomes S_i^-1 U_i */
    double (*right)[3];    /* (n); right-hand sides */
};

/* Eliminates blocks 0 .. n - 2 of the matrix. A singular block gives non-finite values. */
void wb_banded_factor(struct wb_banded *banded);

/* Eliminates the same blocks of the right-hand side, with the factored matrix: `right` becomes
 * S_i^-1 g_i, the last one the condensed right-hand side. */
void wb_banded_reduce(const struct wb_banded *banded);

/* Replaces `right` by the complete solution, given the solution of the last block in right[n -
 * 1]. */
void wb_banded_expand(const struct wb_banded *banded);

/* Inverse of a symmetric 3 x 3 matrix; not finite if singular. */
void wb_banded_invert(const double *restrict A, double *restrict inverse);

/* Solves a small dense system, at most 8 unknowns, by elimination with scaled partial pivoting. A
 * is n x n row-major with `stride` doubles per row and is destroyed; b becomes the solution. Not
 * finite if singular. */
void wb_banded_solve_small(int n, int stride, double *restrict A, double *restrict b);

#endif
