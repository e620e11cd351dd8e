/* Block tridiagonal systems of 6 x 6 blocks, not symmetric, eliminated from the first block towards
 * the last: for the rod in space, as fe/linear/banded.h for the planar beam.
 */
#ifndef WB_FE_LINEAR_ROD_CHAIN_H
#define WB_FE_LINEAR_ROD_CHAIN_H

enum {
    WB_ROD_CHAIN_BLOCK = 6,
    WB_ROD_CHAIN_ENTRIES = 36
};

/* Blocks are row-major. */
struct wb_rod_chain {
    int n;                                    /* blocks */
    double (*diagonal)[WB_ROD_CHAIN_ENTRIES]; /* (n); destroyed, the last one becomes the condensed
                                                 block */
    double (*upper)[WB_ROD_CHAIN_ENTRIES];    /* (n - 1) block (i, i + 1); becomes S_i^-1 U_i */
    double (*lower)[WB_ROD_CHAIN_ENTRIES];    /* (n - 1) block (i + 1, i) */
    double (*right)[WB_ROD_CHAIN_BLOCK];      /* (n); becomes S_i^-1 g_i, the last one the condensed
                                                 right-hand side */
    int negative; /* number of negative eigenvalues of the eliminated blocks (all but the last), if
                     symmetric */
};

/* Eliminates blocks 0 .. n - 2. A singular block gives non-finite values. */
void wb_rod_chain_condense(struct wb_rod_chain *chain);

/* Replaces `right` by the complete solution, given the solution of the last block in right[n -
 * 1]. */
void wb_rod_chain_expand(struct wb_rod_chain *chain);

/* Solves A X = B for a 6 x 6 matrix by elimination with scaled partial pivoting. Each row holds A,
 * then `columns` columns of B, which become X; A is destroyed. Not finite if singular. */
enum {
    WB_ROD_CHAIN_WIDTH = 26 /* doubles per row: 6 of A, at most 20 of B */
};
void wb_rod_chain_solve(double rows[WB_ROD_CHAIN_BLOCK][WB_ROD_CHAIN_WIDTH], int columns);

/* c += sign a b for 6 x 6 blocks, and for a block and a vector. */
void wb_rod_chain_multiply(double *restrict c, double sign, const double *restrict a,
                           const double *restrict b);
void wb_rod_chain_apply(double *restrict c, double sign, const double *restrict a,
                        const double *restrict b);

#endif
