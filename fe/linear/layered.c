#include "fe/linear/layered.h"

#include <assert.h>
#include <cblas.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "fe/linear/layered_private.h"

#define WB_LOG_DOMAIN "layered"

enum factors {
    CHOLESKY,   /* D = L L^T */
    INDEFINITE, /* D = L B L^T with blocks B of 1 or 2 (Bunch and Kaufman) */
    GENERAL     /* D = P L U */
};

/* Block b of the matrix, all column-major: the diagonal one (n x n, lower half when symmetric), the
 * one below (next x linked: the columns from link[b] on), and for general matrices the one on its
 * right (n x next; rows before link[b] are zero until it is factored). With S the diagonal block
 * after elimination of all blocks before, and C and B the blocks below and on the right, the next
 * diagonal block becomes S_next - C S^-1 B. After factorisation the blocks contain
 *     Cholesky:    L,     C L^-T (zero in the columns before link[b], which are not stored)
 *     indefinite:  L B L^T, C
 *     general: L U, C U^-1 (same columns), L^-1 P B. */
struct block {
    int first, n; /* unknowns */
    int before;   /* unknowns before link[b] */
    int linked;   /* unknowns from `linked` on couple to the next block; 0 in the last block */
    int next;     /* number of unknowns of the next block; 0 in the last one */
    double *diagonal, *below, *right;
    lapack_int *pivot; /* (n) */
    enum factors factors;
    bool stale, stale_links; /* not yet zeroed: the diagonal block; the blocks beside it */
};

struct wb_layered {
    int n_blocks, n_unknowns, n_most; /* n_most: of a block */
    bool symmetric, singular;
    struct block *blocks; /* (n_blocks) */
    int *block_of;        /* (n_unknowns) */
    lapack_int *pivots;   /* (n_unknowns) */
    size_t n_entries;     /* of all blocks */
    double *work;         /* (n_most x n_most): copy of a block, or a block column */
    double *bunch;        /* (n_bunch), of dsytrf */
    lapack_int n_bunch;
    struct wb_memory memory; /* of all arrays */
};

/* --- layout --- */

static bool layout_is_possible(int n_blocks, const int *first, const int *link)
{
    if (n_blocks < 1 || !first || !link || first[0] != 0 || first[n_blocks] < 1)
        return false;
    for (int b = 0; b < n_blocks; b++) {
        if (first[b + 1] < first[b])
            return false;
        if (b + 1 < n_blocks && (link[b] < first[b] || link[b] > first[b + 1]))
            return false;
    }
    return true;
}

static double *take_entries(struct wb_layered *layered, int rows, int columns)
{
    const size_t n = (size_t)rows * (size_t)columns;
    layered->n_entries += n;
    return wb_memory_take(&layered->memory, n, sizeof(double));
}

static void lay_out(struct wb_layered *layered, const int *first, const int *link)
{
    for (int b = 0; b < layered->n_blocks; b++) {
        struct block *block = &layered->blocks[b];
        const bool last = b + 1 == layered->n_blocks;
        block->first = first[b];
        block->n = first[b + 1] - first[b];
        block->before = last ? block->n : link[b] - first[b];
        block->linked = block->n - block->before;
        block->next = last ? 0 : first[b + 2] - first[b + 1];
        block->pivot = layered->pivots + block->first;
        if (block->n > layered->n_most)
            layered->n_most = block->n;
        block->diagonal = take_entries(layered, block->n, block->n);
        block->below = take_entries(layered, block->next, block->linked);
        if (!layered->symmetric)
            block->right = take_entries(layered, block->n, block->next);
        for (int i = block->first; i < first[b + 1]; i++)
            layered->block_of[i] = b;
    }
}

enum wb_status wb_layered_create(struct wb_layered **out, int n_blocks, const int *first,
                                 const int *link, bool symmetric)
{
    *out = NULL;
    if (!layout_is_possible(n_blocks, first, link))
        return wb_fail(WB_ERR_ARGUMENT, "layered system: expected the first unknowns of the blocks "
                                        "in ascending order, and each link within its block");

    /* One thread: the split of sums over threads would make the last bits depend on the machine's
     * load, and the blocks are too small for threads to help. */
    openblas_set_num_threads(1);

    struct wb_layered *const layered = wb_memory_new(1, sizeof *layered);
    layered->n_blocks = n_blocks;
    layered->n_unknowns = first[n_blocks];
    layered->symmetric = symmetric;

    const size_t n = (size_t)layered->n_unknowns;
    layered->blocks = wb_memory_take(&layered->memory, (size_t)n_blocks, sizeof *layered->blocks);
    layered->block_of = wb_memory_take(&layered->memory, n, sizeof *layered->block_of);
    layered->pivots = wb_memory_take(&layered->memory, n, sizeof *layered->pivots);

    lay_out(layered, first, link);
    double wanted = 1.0;
    if (symmetric && LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', layered->n_most, NULL,
                                         layered->n_most, NULL, &wanted, -1) != 0)
        wanted = layered->n_most;
    layered->n_bunch = (lapack_int)wanted;
    layered->work = wb_memory_take(
        &layered->memory, (size_t)layered->n_most * (size_t)layered->n_most, sizeof(double));
    layered->bunch =
        wb_memory_take(&layered->memory, (size_t)layered->n_bunch, sizeof *layered->bunch);
    *out = layered;
    return WB_OK;
}

void wb_layered_destroy(struct wb_layered *layered)
{
    if (!layered)
        return;
    wb_memory_release(&layered->memory);
    free(layered);
}

size_t wb_layered_memory(const struct wb_layered *layered)
{
    const size_t n_most = (size_t)layered->n_most, n = (size_t)layered->n_unknowns;
    return sizeof(double) * (layered->n_entries + n_most * n_most + (size_t)layered->n_bunch) +
           n * (sizeof *layered->block_of + sizeof *layered->pivots) +
           (size_t)layered->n_blocks * sizeof *layered->blocks + sizeof *layered;
}

double wb_layered_operations(const struct wb_layered *layered)
{
    double operations = 0.0;
    for (int b = 0; b < layered->n_blocks; b++) {
        const struct block *block = &layered->blocks[b];
        const double n = block->n, linked = block->linked, next = block->next;
        if (layered->symmetric)
            operations += n * n * n / 3.0 + next * linked * linked + next * next * linked;
        else
            operations += 2.0 * n * n * n / 3.0 + next * linked * linked + next * n * n +
                          2.0 * next * next * linked;
    }
    return operations;
}

/* --- assembly --- */

void wb_layered_clear(struct wb_layered *layered)
{
    layered->singular = false;
    for (int b = 0; b < layered->n_blocks; b++)
        layered->blocks[b].stale = layered->blocks[b].stale_links = true;
}

/* Zeroes blocks just before an element is added: they are then in the cache, and adding takes half
 * the time. */
static void zero_if_stale(bool symmetric, struct block *block)
{
    const size_t n = (size_t)block->n;
    if (!block->stale)
        return;
    block->stale = false;
    for (size_t j = 0; j < n; j++) {
        const size_t from = symmetric ? j : 0;
        memset(block->diagonal + j * n + from, 0, (n - from) * sizeof(double));
    }
}

static void freshen_links(bool symmetric, struct block *block)
{
    const size_t n = (size_t)block->n, linked = (size_t)block->linked, next = (size_t)block->next;
    if (!block->stale_links)
        return;
    block->stale_links = false;
    memset(block->below, 0, next * linked * sizeof(double));
    if (!symmetric)
        memset(block->right, 0, n * next * sizeof(double));
}

/* Free unknowns, ascending, and their rows in the matrix to be added. */
struct sorted {
    int n;
    int unknown[WB_LAYERED_MOST], row[WB_LAYERED_MOST];
};

static void sort_unknowns(int n, const int *index, struct sorted *sorted)
{
    sorted->n = 0;
    for (int i = 0; i < n; i++) {
        const int unknown = index[i];
        if (unknown < 0)
            continue;
        int k = sorted->n++;
        for (; k > 0 && sorted->unknown[k - 1] > unknown; k--) {
            sorted->unknown[k] = sorted->unknown[k - 1];
            sorted->row[k] = sorted->row[k - 1];
        }
        sorted->unknown[k] = unknown;
        sorted->row[k] = i;
    }
}

/* column[place[k]] += source[stride * row[k]] */
static inline void scatter(int n, const int *restrict place, const int *restrict row, int stride,
                           const double *restrict source, double *restrict column)
{
    for (int k = 0; k < n; k++)
        column[place[k]] += source[stride * row[k]];
}

void wb_layered_add(struct wb_layered *layered, int n, const int *index, const double *matrix)
{
    struct sorted s;
    int place[WB_LAYERED_MOST];
    assert(n <= WB_LAYERED_MOST);
    sort_unknowns(n, index, &s);
    if (s.n == 0)
        return;

    /* The first `here` unknowns are in the first block, the others in the next one. */
    assert(s.unknown[s.n - 1] < layered->n_unknowns);
    const int b = layered->block_of[s.unknown[0]];
    struct block *block = &layered->blocks[b];
    int here = 0;
    for (; here < s.n && s.unknown[here] < block->first + block->n; here++)
        place[here] = s.unknown[here] - block->first;
    for (int k = here; k < s.n; k++)
        place[k] = s.unknown[k] - block->first - block->n;
    assert(here == s.n || place[s.n - 1] < block->next);

    const bool symmetric = layered->symmetric;
    const int there = s.n - here;
    zero_if_stale(symmetric, block);
    if (there > 0) {
        freshen_links(symmetric, block);
        zero_if_stale(symmetric, block + 1);
    }
    for (int k = 0; k < s.n; k++) {
        /* Entry (i, j) is matrix[n i + j]; in a symmetric matrix also matrix[n j + i], which is
         * contiguous. Rows above the diagonal are not stored. */
        const double *source = symmetric ? matrix + n * s.row[k] : matrix + s.row[k];
        const int stride = symmetric ? 1 : n, from = symmetric ? k : 0;
        const ptrdiff_t j = place[k];
        if (k < here) {
            scatter(here - from, place + from, s.row + from, stride, source,
                    block->diagonal + j * block->n);
            if (there == 0)
                continue;
            assert(j >= block->before);
            scatter(there, place + here, s.row + here, stride, source,
                    block->below + (j - block->before) * block->next);
        } else {
            const int start = symmetric ? k : here;
            scatter(s.n - start, place + start, s.row + start, stride, source,
                    block[1].diagonal + j * block[1].n);
            if (!symmetric)
                scatter(here, place, s.row, stride, source, block->right + j * block->n);
        }
    }
}

/* --- factorisation --- */

static bool is_finite(size_t n, const double *values)
{
    /* Do not skip zeros: zero times a non-finite value is NaN. Four sums for instruction-level
     * parallelism. */
    double sum[4] = {0.0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        for (int k = 0; k < 4; k++)
            sum[k] += 0.0 * values[i + (size_t)k];
    }
    for (; i < n; i++)
        sum[0] += 0.0 * values[i];
    return sum[0] + sum[1] + sum[2] + sum[3] == 0.0;
}

static void copy_lower(int n, const double *from, double *to)
{
    for (ptrdiff_t j = 0; j < n; j++)
        memcpy(to + j * n + j, from + j * n + j, (size_t)(n - j) * sizeof *to);
}

static bool lower_is_finite(int n, const double *matrix)
{
    for (ptrdiff_t j = 0; j < n; j++) {
        if (!is_finite((size_t)(n - j), matrix + j * n + j))
            return false;
    }
    return true;
}

/* Checks diagonal entries of factors: a zero is a singular block, and a NaN or infinity anywhere in
 * the block propagates to one of them. */
static bool diagonal_is_sound(const struct block *block)
{
    for (ptrdiff_t i = 0; i < block->n; i++) {
        const double pivot = block->diagonal[i * block->n + i];
        if (!isfinite(pivot) || (pivot == 0.0 && block->factors != INDEFINITE))
            return false;
    }
    return true;
}

/* Number of negative eigenvalues of B in L B L^T, which equals that of the block (Sylvester). A 2 x
 * 2 block has a negative and a positive one, because of the pivoting rule. */
static int count_negative(const struct block *block)
{
    int negative = 0;
    for (ptrdiff_t i = 0; i < block->n; i++) {
        if (block->pivot[i] < 0) {
            negative++;
            i++;
        } else if (block->diagonal[i * block->n + i] < 0.0) {
            negative++;
        }
    }
    return negative;
}

static bool factor_symmetric(struct wb_layered *layered, struct block *block, int *negative)
{
    const int n = block->n;
    copy_lower(n, block->diagonal, layered->work);
    block->factors = CHOLESKY;
    if (LAPACKE_dpotrf_work(LAPACK_COL_MAJOR, 'L', n, block->diagonal, n) == 0)
        return diagonal_is_sound(block);

    block->factors = INDEFINITE;
    copy_lower(n, layered->work, block->diagonal);
    /* The pivot search is undefined for NaN: check first. */
    if (!lower_is_finite(n, block->diagonal) ||
        LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, block->diagonal, n, block->pivot,
                            layered->bunch, layered->n_bunch) != 0)
        return false;
    *negative += count_negative(block);
    return diagonal_is_sound(block);
}

static bool factor_general(struct block *block, int *negative)
{
    const int n = block->n;
    block->factors = GENERAL;
    if (!is_finite((size_t)n * (size_t)n, block->diagonal) ||
        LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, block->diagonal, n, block->pivot) != 0)
        return false;
    for (ptrdiff_t i = 0; i < n; i++)
        *negative += (block->diagonal[i * n + i] < 0.0) + (block->pivot[i] != i + 1);
    return diagonal_is_sound(block);
}

static void eliminate(struct wb_layered *layered, struct block *block, double *next_diagonal)
{
    const int n = block->n, before = block->before, linked = block->linked, next = block->next;
    const double *corner = block->diagonal + (ptrdiff_t)before * n + before;
    double *work = layered->work;

    switch (block->factors) {
    case CHOLESKY:
        cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, next, linked,
                    1.0, corner, n, block->below, next);
        cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, next, linked, -1.0, block->below, next,
                    1.0, next_diagonal, next);
        break;
    case INDEFINITE:
        /* work = S^-1 (0, C^T) */
        for (ptrdiff_t j = 0; j < next; j++) {
            memset(work + j * n, 0, (size_t)before * sizeof *work);
            for (ptrdiff_t i = 0; i < linked; i++)
                work[j * n + before + i] = block->below[i * next + j];
        }
        LAPACKE_dsytrs_work(LAPACK_COL_MAJOR, 'L', n, next, block->diagonal, n, block->pivot, work,
                            n);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, next, next, linked, -1.0,
                    block->below, next, work + before, n, 1.0, next_diagonal, next);
        break;
    case GENERAL:
        cblas_dtrsm(CblasColMajor, CblasRight, CblasUpper, CblasNoTrans, CblasNonUnit, next, linked,
                    1.0, corner, n, block->below, next);
        LAPACKE_dlaswp_work(LAPACK_COL_MAJOR, next, block->right, n, 1, n, block->pivot, 1);
        cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasUnit, n, next, 1.0,
                    block->diagonal, n, block->right, n);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, next, next, linked, -1.0,
                    block->below, next, block->right + before, n, 1.0, next_diagonal, next);
        break;
    }
}

void wb_layered_factor(struct wb_layered *layered, struct wb_layered_pivots *pivots)
{
    int negative = 0;
    layered->singular = false;
    for (int b = 0; b < layered->n_blocks; b++) {
        zero_if_stale(layered->symmetric, &layered->blocks[b]);
        freshen_links(layered->symmetric, &layered->blocks[b]);
    }
    for (int b = 0; b < layered->n_blocks && !layered->singular; b++) {
        struct block *block = &layered->blocks[b];
        if (block->n == 0)
            continue;
        layered->singular = layered->symmetric ? !factor_symmetric(layered, block, &negative)
                                               : !factor_general(block, &negative);
        if (!layered->singular && block->linked > 0 && block->next > 0)
            eliminate(layered, block, block[1].diagonal);
    }
    pivots->negative = layered->symmetric ? negative : negative % 2;
    pivots->singular = layered->singular;
}

/* --- solution --- */

/* x := op(T)^-1 x for k columns of length n and a triangular matrix T. */
static void solve_triangle(enum CBLAS_UPLO half, enum CBLAS_TRANSPOSE transpose,
                           enum CBLAS_DIAG diagonal, const struct block *block, int k, double *x,
                           int stride)
{
    if (k == 1)
        cblas_dtrsv(CblasColMajor, half, transpose, diagonal, block->n, block->diagonal, block->n,
                    x, 1);
    else
        cblas_dtrsm(CblasColMajor, CblasLeft, half, transpose, diagonal, block->n, k, 1.0,
                    block->diagonal, block->n, x, stride);
}

/* y -= op(A) x for k columns; A has `rows` x `columns`. */
static void subtract_product(enum CBLAS_TRANSPOSE transpose, int rows, int columns, const double *A,
                             int k, const double *x, double *y, int stride)
{
    const bool plain = transpose == CblasNoTrans;
    if (rows == 0 || columns == 0)
        return;
    if (k == 1)
        cblas_dgemv(CblasColMajor, transpose, rows, columns, -1.0, A, rows, x, 1, 1.0, y, 1);
    else
        cblas_dgemm(CblasColMajor, transpose, CblasNoTrans, plain ? rows : columns, k,
                    plain ? columns : rows, -1.0, A, rows, x, stride, 1.0, y, stride);
}

/* Right-hand sides of an indefinite block are kept for the backward substitution; their
 * contribution to the next block uses the workspace, as many columns at a time as fit. */
static void forward_indefinite(struct wb_layered *layered, const struct block *block, int k,
                               const double *x, double *next)
{
    const ptrdiff_t n = block->n, stride = layered->n_unknowns;
    if (block->linked == 0 || block->next == 0)
        return;
    for (int j = 0; j < k; j += layered->n_most) {
        const int count = k - j < layered->n_most ? k - j : layered->n_most;
        double *work = layered->work;
        for (ptrdiff_t c = 0; c < count; c++)
            memcpy(work + c * n, x + (j + c) * stride, (size_t)n * sizeof *work);
        LAPACKE_dsytrs_work(LAPACK_COL_MAJOR, 'L', block->n, count, block->diagonal, block->n,
                            block->pivot, work, block->n);
        cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, block->next, count, block->linked,
                    -1.0, block->below, block->next, work + block->before, block->n, 1.0,
                    next + j * stride, layered->n_unknowns);
    }
}

static void forward(struct wb_layered *layered, const struct block *block, int k, double *right)
{
    const int stride = layered->n_unknowns;
    double *x = right + block->first, *next = x + block->n;
    if (block->n == 0)
        return;
    if (block->factors == INDEFINITE) {
        forward_indefinite(layered, block, k, x, next);
        return;
    }
    if (block->factors == GENERAL)
        LAPACKE_dlaswp_work(LAPACK_COL_MAJOR, k, x, stride, 1, block->n, block->pivot, 1);
    solve_triangle(CblasLower, CblasNoTrans, block->factors == GENERAL ? CblasUnit : CblasNonUnit,
                   block, k, x, stride);
    subtract_product(CblasNoTrans, block->next, block->linked, block->below, k, x + block->before,
                     next, stride);
}

static void backward(const struct wb_layered *layered, const struct block *block, int k,
                     double *right)
{
    const int stride = layered->n_unknowns;
    double *x = right + block->first, *next = x + block->n;
    if (block->n == 0)
        return;
    if (block->factors == GENERAL) {
        subtract_product(CblasNoTrans, block->n, block->next, block->right, k, next, x, stride);
        solve_triangle(CblasUpper, CblasNoTrans, CblasNonUnit, block, k, x, stride);
        return;
    }
    subtract_product(CblasTrans, block->next, block->linked, block->below, k, next,
                     x + block->before, stride);
    if (block->factors == INDEFINITE)
        LAPACKE_dsytrs_work(LAPACK_COL_MAJOR, 'L', block->n, k, block->diagonal, block->n,
                            block->pivot, x, stride);
    else
        solve_triangle(CblasLower, CblasTrans, CblasNonUnit, block, k, x, stride);
}

/* Solves for right-hand sides that are zero in all blocks before `first`. */
static void solve_from(struct wb_layered *layered, int first, int n_right, double *right)
{
    if (layered->singular) {
        for (ptrdiff_t i = 0; i < (ptrdiff_t)layered->n_unknowns * n_right; i++)
            right[i] = (double)NAN;
        return;
    }
    if (n_right < 1)
        return;
    for (int b = first; b < layered->n_blocks; b++)
        forward(layered, &layered->blocks[b], n_right, right);
    for (int b = layered->n_blocks - 1; b >= 0; b--)
        backward(layered, &layered->blocks[b], n_right, right);
}

void wb_layered_solve(struct wb_layered *layered, int n_right, double *right)
{
    solve_from(layered, 0, n_right, right);
}

void wb_layered_solve_last(struct wb_layered *layered, int n_right, double *right)
{
    solve_from(layered, layered->n_blocks - 1, n_right, right);
}
