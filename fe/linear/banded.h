/* Symmetric block tridiagonal systems of 3 x 3 blocks, eliminated from the first block towards the
 * last.
 *
 * A beam clamped at one end and controlled at the other is such a chain. The elimination leaves the
 * last block's own 3 x 3 system, its stiffness seen from the tip; whatever holds and loads the tip
 * (constraints, an unknown tension, follower forces) is added to that by the caller, who solves it
 * and hands the tip's increment back to be expanded. This costs about a tenth of a general banded
 * solve (LAPACK's dgbsv, against which tests/fe/linear/test_banded.c holds it).
 */
#ifndef WB_FE_LINEAR_BANDED_H
#define WB_FE_LINEAR_BANDED_H

/* Blocks are 3 x 3, row-major. One factored matrix may serve several right-hand sides. */
struct wb_banded {
    int n;                 /* blocks */
    double (*diagonal)[9]; /* (n); symmetric; becomes S_i^-1, the last the condensed block */
    double (*upper)[9];    /* (n - 1) block (i, i + 1); becomes S_i^-1 U_i */
    double (*right)[3];    /* (n); right-hand sides */
};

/* Eliminates blocks 0 .. n - 2 of the matrix. A singular block gives non-finite numbers. */
void wb_banded_factor(struct wb_banded *banded);

/* Eliminates them of the right-hand side, with the factored matrix: `right` becomes S_i^-1 g_i, the
 * last the condensed one. */
void wb_banded_reduce(const struct wb_banded *banded);

/* With the solution of the last block in right[n - 1], replaces `right` by the whole solution. */
void wb_banded_expand(const struct wb_banded *banded);

/* Inverse of a symmetric 3 x 3 matrix; non-finite when singular. */
void wb_banded_invert(const double *restrict A, double *restrict inverse);

/* Solves a small dense system by elimination with scaled partial pivoting, at most 8 unknowns; A is
 * n x n row-major with `stride` doubles a row and is destroyed, b becomes the solution. Non-finite
 * when singular. */
void wb_banded_solve_small(int n, int stride, double *restrict A, double *restrict b);

#endif
