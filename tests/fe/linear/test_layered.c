#include "fe/linear/layered.h"

#include <lapacke.h>
#include <stdlib.h>

#include "fe/linear/layered_private.h"
#include "tests/check.h"

enum {
    MAX_BLOCKS = 8,
    MOST = 160, /* unknowns */
    ELEMENT = 24,
    BAND = 40 /* bandwidth of layouts for LAPACK's band storage */
};

#define WB_LOG_DOMAIN "test"

/* A layered system and the same matrix as a dense square, row-major. */
struct twin {
    int n_blocks, first[MAX_BLOCKS + 1], link[MAX_BLOCKS];
    int n;
    bool symmetric;
    struct wb_layered *layered;
    double *square;                 /* (n x n) */
    double right[MOST], left[MOST]; /* right-hand side, solution */
};

static uint64_t seed;

static double random_number(void)
{
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(seed >> 11) * 0x1p-53;
}

static int random_integer(int below)
{
    return (int)(random_number() * below);
}

static void twin_init(struct twin *twin, bool symmetric, int n_blocks, const int *sizes)
{
    memset(twin, 0, sizeof *twin);
    twin->symmetric = symmetric;
    twin->n_blocks = n_blocks;
    for (int b = 0; b < n_blocks; b++) {
        twin->first[b + 1] = twin->first[b] + sizes[b];
        twin->link[b] = twin->first[b] + random_integer(sizes[b] + 1);
    }
    twin->link[n_blocks - 1] = -7; /* without meaning */
    twin->n = twin->first[n_blocks];
    assert_true(twin->n <= MOST);
    twin->square = calloc((size_t)twin->n * (size_t)twin->n, sizeof(double));
    assert_non_null(twin->square);
    assert_int_equal(
        wb_layered_create(&twin->layered, n_blocks, twin->first, twin->link, symmetric), WB_OK);
}

static void twin_release(struct twin *twin)
{
    wb_layered_destroy(twin->layered);
    free(twin->square);
}

static void twin_add(struct twin *twin, int n, const int *index, const double *matrix)
{
    wb_layered_add(twin->layered, n, index, matrix);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            if (index[i] >= 0 && index[j] >= 0)
                twin->square[index[i] * twin->n + index[j]] += matrix[i * n + j];
        }
    }
}

/* Distinct unknowns of block b starting at `from`, in any order, some of them fixed (-1). */
static int pick(const struct twin *twin, int from, int b, int n, int *index)
{
    const int size = twin->first[b + 1] - from;
    int picked = 0;
    for (int k = 0; k < n && picked < size; k++) {
        int unknown = from + random_integer(size);
        for (int i = 0; i < picked; i++) {
            if (index[i] == unknown)
                unknown = -1;
        }
        if (unknown >= 0)
            index[picked++] = unknown;
    }
    return picked;
}

/* Adds elements within blocks and across them. */
static void twin_fill(struct twin *twin, int elements)
{
    double matrix[ELEMENT * ELEMENT];
    int index[ELEMENT];
    for (int e = 0; e < elements; e++) {
        const int b = random_integer(twin->n_blocks);
        const bool across = b + 1 < twin->n_blocks && random_number() < 0.6;
        int n = pick(twin, across ? twin->link[b] : twin->first[b], b, ELEMENT / 2, index);
        if (across)
            n += pick(twin, twin->first[b + 1], b + 1, ELEMENT / 2 - 1, index + n);
        index[n++] = -1;
        for (int k = n - 1; k > 0; k--) { /* in any order */
            const int other = random_integer(k + 1), swap = index[k];
            index[k] = index[other];
            index[other] = swap;
        }
        for (int i = 0; i < n; i++) {
            for (int j = 0; j <= i; j++) {
                matrix[i * n + j] = random_number() - 0.5;
                matrix[j * n + i] = twin->symmetric ? matrix[i * n + j] : random_number() - 0.5;
            }
        }
        twin_add(twin, n, index, matrix);
    }
}

/* Makes every row diagonally dominant, by a factor. */
static void twin_strengthen(struct twin *twin, double factor)
{
    for (int i = 0; i < twin->n; i++) {
        double sum = 1.0;
        for (int j = 0; j < twin->n; j++)
            sum += fabs(twin->square[i * twin->n + j]) + fabs(twin->square[j * twin->n + i]);
        const double more = factor * sum;
        twin_add(twin, 1, &i, &more);
    }
}

/* Largest residual |A x - b| over (|A| |x| + |b|). */
static double residual(const struct twin *twin, const double *x, const double *b)
{
    double largest = 0.0;
    for (int i = 0; i < twin->n; i++) {
        double sum = -b[i], size = fabs(b[i]) + 1e-300;
        for (int j = 0; j < twin->n; j++) {
            sum += twin->square[i * twin->n + j] * x[j];
            size += fabs(twin->square[i * twin->n + j] * x[j]);
        }
        if (!(fabs(sum) <= largest * size))
            largest = fabs(sum) / size;
    }
    return largest;
}

/* Solves by LAPACK's dense elimination; returns the condition number's estimate. */
static double dense_solve(const struct twin *twin, double *x)
{
    const int n = twin->n;
    double *copy = malloc(sizeof(double) * (size_t)n * (size_t)n), inverse = 0.0;
    lapack_int pivots[MOST];
    assert_non_null(copy);
    memcpy(copy, twin->square, sizeof(double) * (size_t)n * (size_t)n);
    const double norm = LAPACKE_dlange(LAPACK_ROW_MAJOR, 'I', n, n, copy, n);
    assert_int_equal(LAPACKE_dgetrf(LAPACK_ROW_MAJOR, n, n, copy, n, pivots), 0);
    assert_int_equal(LAPACKE_dgecon(LAPACK_ROW_MAJOR, 'I', n, copy, n, norm, &inverse), 0);
    assert_int_equal(LAPACKE_dgetrs(LAPACK_ROW_MAJOR, 'N', n, 1, copy, n, pivots, x, 1), 0);
    free(copy);
    return 1.0 / inverse;
}

/* Factors and solves; the solution must agree with the dense one within its condition. Pivot growth
 * between blocks may cost some digits of indefinite systems. */
static struct wb_layered_pivots twin_check(struct twin *twin, double digits)
{
    struct wb_layered_pivots pivots;
    double x[MOST], dense[MOST], largest = 0.0;
    for (int i = 0; i < twin->n; i++)
        x[i] = dense[i] = twin->right[i] = random_number() - 0.5;
    wb_layered_factor(twin->layered, &pivots);
    assert_false(pivots.singular);
    wb_layered_solve(twin->layered, 1, x);
    assert_true(residual(twin, x, twin->right) <= digits);

    const double condition = dense_solve(twin, dense);
    for (int i = 0; i < twin->n; i++)
        largest = fmax(largest, fabs(dense[i]));
    for (int i = 0; i < twin->n; i++)
        assert_close(x[i], dense[i], digits * condition * largest);
    return pivots;
}

/* Number of negative eigenvalues of the square. */
static int negative_eigenvalues(const struct twin *twin)
{
    const int n = twin->n;
    double *copy = malloc(sizeof(double) * (size_t)n * (size_t)n), values[MOST];
    int negative = 0;
    assert_non_null(copy);
    memcpy(copy, twin->square, sizeof(double) * (size_t)n * (size_t)n);
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', n, copy, n, values), 0);
    for (int i = 0; i < n; i++)
        negative += values[i] < 0.0;
    free(copy);
    return negative;
}

/* Sign of the determinant: 1 when negative. */
static int negative_determinant(const struct twin *twin)
{
    const int n = twin->n;
    double *copy = malloc(sizeof(double) * (size_t)n * (size_t)n);
    lapack_int pivots[MOST];
    int negative = 0;
    assert_non_null(copy);
    memcpy(copy, twin->square, sizeof(double) * (size_t)n * (size_t)n);
    assert_int_equal(LAPACKE_dgetrf(LAPACK_ROW_MAJOR, n, n, copy, n, pivots), 0);
    for (int i = 0; i < n; i++)
        negative += (copy[i * n + i] < 0.0) + (pivots[i] != i + 1);
    free(copy);
    return negative % 2;
}

/* Sizes of blocks, some empty, some a single unknown. */
static int random_sizes(int *sizes)
{
    const int n = 1 + random_integer(MAX_BLOCKS);
    for (int b = 0; b < n; b++)
        sizes[b] = random_number() < 0.15 ? 0 : 1 + random_integer(MOST / MAX_BLOCKS);
    sizes[n - 1] += sizes[0] == 0;
    return n;
}

static void dominant_systems_agree_with_dense_ones(void **unused)
{
    (void)unused;
    seed = 1;
    for (int trial = 0; trial < 60; trial++) {
        struct twin twin;
        int sizes[MAX_BLOCKS];
        const int n_blocks = random_sizes(sizes);
        twin_init(&twin, trial % 2 == 0, n_blocks, sizes);
        twin_fill(&twin, 40);
        twin_strengthen(&twin, 1.0);
        const struct wb_layered_pivots pivots = twin_check(&twin, 1e-15);
        assert_int_equal(pivots.negative, 0);
        twin_release(&twin);
    }
}

static void indefinite_systems_agree_with_dense_ones(void **unused)
{
    (void)unused;
    int with_negative = 0;
    seed = 2;
    for (int trial = 0; trial < 100; trial++) {
        struct twin twin;
        int sizes[MAX_BLOCKS];
        const int n_blocks = random_sizes(sizes);
        twin_init(&twin, trial % 2 == 0, n_blocks, sizes);
        twin_fill(&twin, 60);
        for (int i = 0; i < twin.n; i++) { /* each unknown has an entry of its own */
            const double entry = random_number() - 0.5;
            twin_add(&twin, 1, &i, &entry);
        }
        const struct wb_layered_pivots pivots = twin_check(&twin, 1e-11);
        assert_int_equal(pivots.negative, twin.symmetric ? negative_eigenvalues(&twin)
                                                         : negative_determinant(&twin));
        with_negative += pivots.negative > 0;
        twin_release(&twin);
    }
    assert_true(with_negative > 50);
}

static void one_negative_direction_is_counted(void **unused)
{
    (void)unused;
    const int sizes[] = {9, 14, 11};
    for (int trial = 0; trial < 34; trial++) {
        struct twin twin;
        seed = 3 + (uint64_t)trial;
        twin_init(&twin, true, 3, sizes);
        twin_fill(&twin, 20);
        twin_strengthen(&twin, 1.0);
        const double soft = -1000.0;
        twin_add(&twin, 1, &trial, &soft);
        assert_int_equal(negative_eigenvalues(&twin), 1);
        assert_int_equal(twin_check(&twin, 1e-13).negative, 1);
        twin_release(&twin);
    }
}

static void general_systems_agree_with_lapacks_band(void **unused)
{
    (void)unused;
    enum {
        SIZE = 19,
        ROWS = 3 * BAND + 1
    };
    const int sizes[] = {SIZE, SIZE, SIZE, SIZE, SIZE, SIZE, SIZE};
    seed = 4;
    for (int trial = 0; trial < 20; trial++) {
        struct twin twin;
        struct wb_layered_pivots pivots;
        twin_init(&twin, false, 7, sizes);
        twin_fill(&twin, 80);
        twin_strengthen(&twin, 0.05);

        double *band = calloc((size_t)twin.n * ROWS, sizeof *band), x[MOST], y[MOST];
        lapack_int rows[MOST];
        assert_non_null(band);
        for (int i = 0; i < twin.n; i++) {
            x[i] = y[i] = random_number() - 0.5;
            for (int j = 0; j < twin.n; j++) {
                if (abs(i - j) <= BAND)
                    band[j * ROWS + 2 * BAND + i - j] = twin.square[i * twin.n + j];
                else
                    assert_true(twin.square[i * twin.n + j] == 0.0);
            }
        }
        assert_int_equal(
            LAPACKE_dgbsv(LAPACK_COL_MAJOR, twin.n, BAND, BAND, 1, band, ROWS, rows, y, twin.n), 0);
        wb_layered_factor(twin.layered, &pivots);
        wb_layered_solve(twin.layered, 1, x);
        for (int i = 0; i < twin.n; i++)
            assert_close(x[i], y[i], 1e-11 * (1.0 + fabs(y[i])));
        free(band);
        twin_release(&twin);
    }
}

/* Several right-hand sides at once, more than a block is wide, and some that are nonzero in the
 * last block only. */
static void many_right_hand_sides_give_what_each_gives(void **unused)
{
    (void)unused;
    enum {
        RIGHT = 23
    };
    const int sizes[] = {12, 20, 0, 15, 8};
    for (int kind = 0; kind < 4; kind++) {
        struct twin twin;
        struct wb_layered_pivots pivots;
        seed = 5 + (uint64_t)kind;
        twin_init(&twin, kind < 2, 5, sizes);
        twin_fill(&twin, 50);
        twin_strengthen(&twin, kind % 2 == 0 ? 1.0 : 0.02);
        wb_layered_factor(twin.layered, &pivots);
        assert_false(pivots.singular);
        if (kind == 1)
            assert_true(pivots.negative > 0); /* with blocks that are not positive definite */

        const int n = twin.n, tail = twin.first[twin.n_blocks - 1];
        double together[RIGHT * MOST], last[RIGHT * MOST], right[RIGHT * MOST] = {0.0}, x[MOST];
        for (int c = 0; c < RIGHT; c++) {
            for (int i = c % 7 == 3 ? tail : 0; i < n; i++)
                right[c * n + i] = random_number() - 0.5;
        }
        memcpy(together, right, sizeof right);
        wb_layered_solve(twin.layered, RIGHT, together);
        for (int c = 0; c < RIGHT; c++) {
            memcpy(x, right + c * n, sizeof(double) * (size_t)n);
            wb_layered_solve(twin.layered, 1, x);
            assert_true(residual(&twin, together + c * n, right + c * n) <= 1e-12);
            for (int i = 0; i < n; i++)
                assert_close(together[c * n + i], x[i], 1e-10 * (1.0 + fabs(x[i])));
        }

        for (int c = 0; c < RIGHT; c++) {
            memset(right + c * n, 0, sizeof(double) * (size_t)tail);
            memcpy(together + c * n, right + c * n, sizeof(double) * (size_t)n);
            memcpy(last + c * n, right + c * n, sizeof(double) * (size_t)n);
        }
        wb_layered_solve(twin.layered, RIGHT, together);
        wb_layered_solve_last(twin.layered, RIGHT, last);
        for (int i = 0; i < RIGHT * n; i++)
            assert_close(last[i], together[i], 1e-12 * (1.0 + fabs(together[i])));
        memcpy(x, right, sizeof(double) * (size_t)n);
        wb_layered_solve_last(twin.layered, 1, x);
        assert_true(residual(&twin, x, right) <= 1e-12);
        twin_release(&twin);
    }
}

static void cleared_system_starts_again(void **unused)
{
    (void)unused;
    const int sizes[] = {10, 14, 9};
    for (int kind = 0; kind < 2; kind++) {
        struct twin twin;
        seed = 6;
        twin_init(&twin, kind == 0, 3, sizes);
        twin_fill(&twin, 30);
        twin_strengthen(&twin, 0.02); /* not definite */
        twin_check(&twin, 1e-12);
        for (int round = 0; round < 2; round++) {
            wb_layered_clear(twin.layered);
            memset(twin.square, 0, sizeof(double) * (size_t)twin.n * (size_t)twin.n);
            twin_fill(&twin, 30);
            twin_strengthen(&twin, 1.0);
            assert_int_equal(twin_check(&twin, 1e-15).negative, 0);
        }

        /* A block to which nothing is added again is zero. */
        struct wb_layered_pivots pivots;
        const double one = 1.0;
        wb_layered_clear(twin.layered);
        for (int i = 0; i < twin.first[1]; i++)
            wb_layered_add(twin.layered, 1, &i, &one);
        wb_layered_factor(twin.layered, &pivots);
        assert_true(pivots.singular);
        twin_release(&twin);
    }
}

static void singular_systems_are_reported(void **unused)
{
    (void)unused;
    const int sizes[] = {6, 7, 5};
    const double bad[] = {0.0, (double)NAN, (double)INFINITY, 0.0};
    for (int kind = 0; kind < 8; kind++) {
        const bool symmetric = kind % 2 == 0;
        for (int place = 0; place < 18; place++) {
            struct twin twin;
            struct wb_layered_pivots pivots = {0};
            double x[MOST];
            seed = 7;
            twin_init(&twin, symmetric, 3, sizes);
            twin_fill(&twin, 12);
            twin_strengthen(&twin, 1.0);
            if (kind / 2 == 0) { /* an unknown without stiffness */
                wb_layered_clear(twin.layered);
                for (int i = 0; i < twin.n; i++) {
                    const double one = i == place ? 0.0 : 1.0;
                    wb_layered_add(twin.layered, 1, &i, &one);
                }
            } else if (kind / 2 == 3) { /* a NaN beside the diagonal */
                const int index[2] = {place, place == 17 ? 16 : 17};
                const double matrix[4] = {0.0, (double)NAN, (double)NAN, 0.0};
                if (place < twin.first[2])
                    wb_layered_add(twin.layered, 1, &place, matrix + 1);
                else
                    wb_layered_add(twin.layered, 2, index, matrix);
            } else {
                wb_layered_add(twin.layered, 1, &place, &bad[kind / 2]);
            }
            wb_layered_factor(twin.layered, &pivots);
            assert_true(pivots.singular);
            for (int i = 0; i < twin.n; i++)
                x[i] = 1.0;
            wb_layered_solve(twin.layered, 1, x);
            for (int i = 0; i < twin.n; i++)
                assert_true(isnan(x[i]));
            twin_release(&twin);
        }
    }
}

static void same_matrix_gives_the_same_bytes(void **unused)
{
    (void)unused;
    const int sizes[] = {30, 40, 40, 30};
    double x[2][MOST];
    for (int round = 0; round < 2; round++) {
        struct twin twin;
        struct wb_layered_pivots pivots;
        seed = 8;
        twin_init(&twin, true, 4, sizes);
        twin_fill(&twin, 90);
        twin_strengthen(&twin, 0.3);
        wb_layered_factor(twin.layered, &pivots);
        for (int i = 0; i < twin.n; i++)
            x[round][i] = random_number();
        wb_layered_solve(twin.layered, 1, x[round]);
        twin_release(&twin);
    }
    assert_memory_equal(x[0], x[1], sizeof(double) * 140);
}

static void invalid_layouts_are_rejected(void **unused)
{
    (void)unused;
    struct wb_layered *layered = NULL;
    const int first[] = {0, 4, 9}, link[] = {2, 4};
    const int backward[] = {0, 4, 3}, shifted[] = {1, 4, 9}, nothing[] = {0, 0, 0};
    const int below[] = {-1, 4}, beyond[] = {5, 4}, zero[] = {0, 0};
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_layered_create(&layered, 0, first, link, true), WB_ERR_ARGUMENT);
    assert_int_equal(wb_layered_create(&layered, 2, backward, link, true), WB_ERR_ARGUMENT);
    assert_int_equal(wb_layered_create(&layered, 2, shifted, link, true), WB_ERR_ARGUMENT);
    assert_int_equal(wb_layered_create(&layered, 2, nothing, zero, true), WB_ERR_ARGUMENT);
    assert_int_equal(wb_layered_create(&layered, 2, first, below, true), WB_ERR_ARGUMENT);
    assert_int_equal(wb_layered_create(&layered, 2, first, beyond, true), WB_ERR_ARGUMENT);
    assert_null(layered);
    wb_log_set_sink(NULL, NULL);
    wb_layered_destroy(NULL);

    assert_int_equal(wb_layered_create(&layered, 2, first, link, true), WB_OK);
    assert_true(wb_layered_memory(layered) > sizeof(double) * (16 + 25 + 10));
    /* 4^3/3 + 5 2^2 + 5^2 2 and 5^3/3 */
    assert_close(wb_layered_operations(layered), 64.0 / 3.0 + 70.0 + 125.0 / 3.0, 1e-9);
    wb_layered_destroy(layered);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dominant_systems_agree_with_dense_ones),
        cmocka_unit_test(indefinite_systems_agree_with_dense_ones),
        cmocka_unit_test(one_negative_direction_is_counted),
        cmocka_unit_test(general_systems_agree_with_lapacks_band),
        cmocka_unit_test(many_right_hand_sides_give_what_each_gives),
        cmocka_unit_test(cleared_system_starts_again),
        cmocka_unit_test(singular_systems_are_reported),
        cmocka_unit_test(same_matrix_gives_the_same_bytes),
        cmocka_unit_test(invalid_layouts_are_rejected),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
